"""The command line takes what usdrecord takes."""

import pytest
from pxr import Sdf
from umber.command_line.arguments import parser

# Flags of usdrecord 25.08, an argument for each, and where the value ends up.
FLAGS = [
    (["--mask", "/a,/b"], "populationMask", "/a,/b"),
    (["--purposes", "render,guide"], "purposes", "render,guide"),
    (["--sessionLayer", "s.usda"], "sessionLayerPath", "s.usda"),
    (["--disableGpu"], "gpuEnabled", False),
    (["--disableDrawMode"], "drawModeEnabled", False),
    (["--disableCameraLight"], "cameraLightEnabled", False),
    (["--camera", "/cam"], "camera", Sdf.Path("/cam")),
    (["-cam", "cam"], "camera", Sdf.Path("cam")),
    (["--camera", ""], "camera", Sdf.Path()),
    (["--defaultTime"], "defaultTime", True),
    (["-d"], "defaultTime", True),
    (["--frames", "1:2"], "frames", "1:2"),
    (["-f", "1"], "frames", "1"),
    (["--complexity", "veryhigh"], "complexity", "veryhigh"),
    (["-c", "low"], "complexity", "low"),
    (["--colorCorrectionMode", "disabled"], "colorCorrectionMode", "disabled"),
    (["-color", "openColorIO"], "colorCorrectionMode", "openColorIO"),
    (["--renderer", "Umber"], "rendererPlugin", "Umber"),
    (["-r", "Umber"], "rendererPlugin", "Umber"),
    (["--imageWidth", "17"], "imageWidth", 17),
    (["-w", "17"], "imageWidth", 17),
    (["--enableDomeLightVisibility"], "domeLightVisibility", True),
    (["--renderPassPrimPath", "/p"], "rpPrimPath", "/p"),
    (["-rp", "/p"], "rpPrimPath", "/p"),
    (["--renderSettingsPrimPath", "/s"], "rsPrimPath", "/s"),
    (["-rs", "/s"], "rsPrimPath", "/s"),
    (["--traceToFile", "t"], "traceToFile", "t"),
    (["--traceFormat", "trace"], "traceFormat", "trace"),
    (["--memstats"], "memstats", True),
]


@pytest.mark.parametrize(("flags", "name", "value"), FLAGS)
def test_flags_of_usdrecord(flags: list[str], name: str, value: object) -> None:
    parsed = parser().parse_args(["in.usda", "out.png", *flags])
    assert getattr(parsed, name) == value
    assert (parsed.usdFilePath, parsed.outputImagePath) == ("in.usda", "out.png")


def test_defaults_of_usdrecord() -> None:
    parsed = parser().parse_args(["in.usda", "out.png"])
    assert parsed.purposes == "proxy"
    assert (parsed.imageWidth, parsed.complexity, parsed.colorCorrectionMode) == (960, "low", "sRGB")
    assert parsed.cameraLightEnabled and parsed.gpuEnabled and parsed.drawModeEnabled
    assert not parsed.domeLightVisibility and parsed.camera is None


@pytest.mark.parametrize("wrong", [["-d", "-f", "1"], ["-r", "Storm"], ["-c", "extreme"], ["-w", "wide"]])
def test_refusals(wrong: list[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        parser().parse_args(["in.usda", "out.png", *wrong])
    assert ended.value.code == 2


def test_help_lists_every_setting() -> None:
    from umber import settings  # noqa: PLC0415

    text = parser().format_help()
    for row in settings():
        assert row["key"] in text and row["doc"] in text
