"""`umber record` from end to end: files, exit codes, what is said."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from umber import Session
from umber.command_line import main
from umber.images import quantized, srgb_from_linear

Run = Callable[..., int]
Write = Callable[..., str]

SCENE = """
def Camera "main_cam" {
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    float horizontalAperture = 20
    float verticalAperture = 10
}
def Mesh "m" { SQUARE
    color3f[] primvars:displayColor = [(0.5, 0.5, 0.5)] }
"""


def exr(path: str) -> dict[str, np.ndarray]:
    with OpenEXR.File(path, separate_channels=True) as file:
        return {name: np.array(channel.pixels) for name, channel in file.channels().items()}


def test_picture_and_words(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda(SCENE), "a.exr") == 0
    said = capsys.readouterr()
    assert said.out.splitlines()[:3] == ["Camera: /main_cam", "Renderer plugin: Umber", "Recording time code: 0.000000"]
    assert said.err == ""
    channels = exr("a.exr")
    assert set(channels) == {"R", "G", "B", "A"}
    assert channels["R"].shape == (12, 24)
    assert channels["A"][0, 0] == 0 and channels["A"].max() == 1 and channels["R"].max() > 0


def test_row_0_is_the_top(umber: Run, usda: Write) -> None:
    lifted = SCENE.replace("SQUARE", "SQUARE\n double3 xformOp:translate = (0, 0.4, 0)").replace(
        "(0, 0.4, 0)", '(0, 0.4, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]'
    )
    assert umber(usda(lifted), "a.exr") == 0
    alpha = exr("a.exr")["A"]
    assert alpha[:6].sum() > 3 * alpha[6:].sum()


def test_png_is_srgb_unless_disabled(umber: Run, usda: Write) -> None:
    stage = usda(SCENE)
    assert umber(stage, "a.exr") == 0 and umber(stage, "a.png") == 0
    assert umber(stage, "b.png", "--colorCorrectionMode", "disabled") == 0
    linear = exr("a.exr")
    color = np.stack([linear[c] for c in "RGBA"], axis=2)
    curved, straight = (np.asarray(Image.open(name)) for name in ("a.png", "b.png"))
    assert np.array_equal(curved[..., :3], quantized(srgb_from_linear(color[..., :3])))
    assert np.array_equal(straight, quantized(color))
    assert np.array_equal(curved[..., 3], straight[..., 3])


def test_srgb_curve() -> None:
    values = srgb_from_linear(np.array([-1.0, 0.0, 0.002, 0.5, 1.0], np.float32))
    assert np.allclose(values[1:], [0, 0.02584, 0.735357, 1.0], atol=1e-5)
    assert quantized(np.array([0.0, 0.5, 1.0, 7.0, -1.0, np.nan], np.float32)).tolist() == [0, 128, 255, 255, 0, 0]


@pytest.mark.parametrize("name", ["a.jpg", "a.hdr", "a.tif", "a.bmp"])
def test_other_formats(umber: Run, usda: Write, name: str) -> None:
    assert umber(usda(SCENE), name) == 0
    if name != "a.hdr":
        assert Image.open(name).size == (24, 12)
    else:
        assert Path(name).read_bytes().startswith(b"#?RADIANCE")


def test_aovs_are_layers(umber: Run, usda: Write) -> None:
    assert umber(usda(SCENE), "a.exr", "--aovs", "color,depth,normal,primId,st") == 0
    channels = exr("a.exr")
    layers = {"R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z", "primId.id"}
    assert layers | {"st.X", "st.Y", "st.Z"} == set(channels)
    assert channels["primId.id"].dtype == np.uint32
    seen = channels["primId.id"] == 0
    assert seen.any() and (channels["primId.id"][~seen] == 0xFFFFFFFF).all()
    assert np.allclose(channels["normal.Z"][seen], 1, atol=1e-3) and (channels["normal.Z"][~seen] == 0).all()
    assert (channels["depth.Z"][seen] < 1).all() and (channels["depth.Z"][~seen] == 1).all()


def test_size(umber: Run, usda: Write) -> None:
    assert umber(usda(SCENE), "a.png", "-w", "40", "--imageHeight", "30", fast=False) == 0
    assert Image.open("a.png").size == (40, 30)
    assert umber(usda(SCENE), "b.png", "--imageHeight", "7") == 0
    assert Image.open("b.png").size == (24, 7)


def test_frames(umber: Run, usda: Write) -> None:
    moving = (
        SCENE.replace("def Mesh", "# SQUARE\ndef Mesh")
        .replace("color3f[]", 'token visibility.timeSamples = { 1: "inherited", 2: "invisible" }\n color3f[]')
        .replace("# SQUARE\n", "")
    )
    assert umber(usda(moving), "a.##.exr", "--frames", "1:2") == 0
    assert exr("a.01.exr")["A"].max() == 1 and exr("a.02.exr")["A"].max() == 0


def test_the_same_twice(umber: Run, usda: Write) -> None:
    stage = usda(SCENE)
    assert umber(stage, "a.exr") == 0 and umber(stage, "b.exr") == 0
    for a, b in zip(exr("a.exr").values(), exr("b.exr").values(), strict=True):
        assert np.array_equal(a, b)


def test_stats(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda(SCENE), "a.exr", "--stats") == 0
    said = capsys.readouterr().out
    assert "numCompletedSamples: 2" in said and "triangles: 2" in said


def test_the_camera_light_can_be_left_out(umber: Run, usda: Write) -> None:
    assert umber(usda(SCENE), "a.exr", "--disableCameraLight") == 0
    assert exr("a.exr")["R"].max() == 0 and exr("a.exr")["A"].max() == 1


def test_without_a_camera_the_stage_is_framed(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda('def Mesh "m" { SQUARE }'), "a.exr") == 0
    alpha = exr("a.exr")["A"]
    assert alpha.max() == 1 and "frames the stage" in capsys.readouterr().out
    assert alpha.shape == (17, 24)


def test_an_unknown_camera_is_named(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda(SCENE), "a.exr", "--camera", "/nope") == 0
    assert "</nope>" in capsys.readouterr().err


def test_an_empty_stage_is_the_clear_color(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda(""), "a.exr") == 0
    assert exr("a.exr")["A"].max() == 0 and "no geometry" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "umber:maxBounce=3"], "umber:maxBounces"),
        (["--set", "umber:maxBounces=many"], "many"),
        (["--set", "umber:maxBounces"], "KEY=VALUE"),
        (["--set", "umber:maxBounces=-1"], "-1"),
        (["--aovs", "color,beauty"], "beauty"),
        (["--frames", "1:2"], "placeholder"),
        (["--frames", "x"], "FrameSpecs"),
        (["--renderer", "Storm"], "Storm"),
    ],
)
def test_bad_arguments(
    umber: Run, usda: Write, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert umber(usda(SCENE), "a.exr", *arguments) == 2
    assert words in capsys.readouterr().err and not Path("a.exr").exists()


def test_aovs_need_exr(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda(SCENE), "a.png", "--aovs", "color,depth") == 2
    assert ".exr" in capsys.readouterr().err


@pytest.mark.parametrize("output", ["nowhere/a.png", "a.xyz", "folder.png"])
def test_unwritable_output(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str], output: str) -> None:
    Path("folder.png").mkdir()
    assert umber(usda(SCENE), output) == 1
    said = capsys.readouterr()
    assert output in said.err and "Recording" not in said.out


def test_a_missing_file(umber: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber("gone.usda", "a.png") == 1
    assert "gone.usda" in capsys.readouterr().err


def test_a_layer_that_does_not_parse(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert umber(usda('def Mesh "m" {'), "a.png") == 1
    assert "stage.usda" in capsys.readouterr().err


BAD_MESHES = {
    "indices": ("[0, 1, 2, 99]", "[4]", "(1, 1, 0)"),
    "counts": ("[0, 1, 2, 3]", "[3, 4]", "(1, 1, 0)"),
    "nan": ("[0, 1, 2, 3]", "[4]", "(nan, 1, 0)"),
}


@pytest.mark.parametrize("what", BAD_MESHES)
def test_bad_meshes_are_named_and_the_rest_is_rendered(
    umber: Run, usda: Write, capsys: pytest.CaptureFixture[str], what: str
) -> None:
    indices, counts, point = BAD_MESHES[what]
    bad = f"""def Mesh "bad" {{
        int[] faceVertexCounts = {counts}
        int[] faceVertexIndices = {indices}
        point3f[] points = [(5, 0, 0), (6, 0, 0), {point}, (5, 1, 0)]
    }}"""
    assert umber(usda(SCENE + bad), "a.exr") == 0
    assert "</bad>" in capsys.readouterr().err and exr("a.exr")["A"].max() == 1


def test_a_broken_dome_texture_is_named(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    dome = 'def DomeLight "sky" { asset inputs:texture:file = @./gone.hdr@ }'
    assert umber(usda(SCENE + dome), "a.exr") == 0
    said = capsys.readouterr().err
    assert "</sky>" in said and "gone.hdr" in said


def test_mask_and_session_layer(umber: Run, usda: Write) -> None:
    stage = usda(SCENE)
    assert umber(stage, "a.exr", "--mask", "/main_cam") == 0
    assert exr("a.exr")["A"].max() == 0
    layer = usda('over "m" { token visibility = "invisible" }', "session.usda")
    assert umber(stage, "b.exr", "--sessionLayer", layer) == 0
    assert exr("b.exr")["A"].max() == 0


def test_render_settings_name_a_camera(umber: Run, usda: Write, capsys: pytest.CaptureFixture[str]) -> None:
    settings = """
        def Camera "other" {}
        def RenderSettings "rs" { rel camera = </other> }
        def RenderPass "pass" { rel renderSource = </rs> }"""
    stage = usda(SCENE + settings)
    assert umber(stage, "a.png", "-rs", "/rs") == 0
    assert umber(stage, "a.png", "-rp", "/pass") == 0
    assert capsys.readouterr().out.count("Camera: /other") == 2
    assert umber(stage, "a.png", "-rp", "/rs") == 1
    assert umber(stage, "a.png", "-rp", "/pass", "-rs", "/rs") == 1
    assert "</rs>" in capsys.readouterr().err


def test_an_interrupt_writes_nothing(
    umber: Run, usda: Write, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(session: Session) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("umber.command_line.progress.wait", interrupted)
    assert umber(usda(SCENE), "a.exr") == 130
    assert not Path("a.exr").exists() and "not written" in capsys.readouterr().err


def test_the_command_itself() -> None:
    assert main([]) == 2 and main(["-h"]) == 0
    run = subprocess.run([sys.executable, "-m", "umber", "record", "-h"], capture_output=True, text=True, check=False)
    assert run.returncode == 0 and "umber:maxBounces" in run.stdout
