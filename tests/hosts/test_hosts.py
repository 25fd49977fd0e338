"""The same stage through every host: usd-core and Hydra give one picture, Blender gives one at all.

Started by `cargo xtask test`, which sets up the environment.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from images import read_colour, read_exr

HERE = Path(__file__).parent
CORNELL = HERE.parents[2] / "shared/scenes/cornell.usda"
USD_CORE_PYTHON = os.environ.get("UMBER_USD_CORE_PYTHON")
FLAGS = ["--camera", "Camera", "--disableCameraLight", "--imageWidth", "128"]
FEW_SAMPLES = ["--set", "convergedSamplesPerPixel=8"]
IDS = ("primId", "instanceId", "elementId")
AOVS = ("color", "depth", "normal", *IDS)

pytestmark = pytest.mark.skipif(not CORNELL.exists(), reason="the shared scenes are absent (../shared/scenes)")


def through_hydra(output: Path, *flags: str) -> Path:
    """Renders the box through OpenUSD's imaging with the delegate."""
    run([sys.executable, HERE / "hydra_record.py", CORNELL, output, *FLAGS, *flags])
    return output


def through_usd_core(output: Path, *flags: str) -> Path:
    """Renders the box through the Python front end."""
    if not USD_CORE_PYTHON:
        pytest.skip("UMBER_USD_CORE_PYTHON names no interpreter with the package umber")
    apart = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PXR_PLUGINPATH_NAME")}
    run([USD_CORE_PYTHON, "-m", "umber", "record", CORNELL, output, *FLAGS, *flags], apart)
    return output


def run(command: list[str | Path], environment: dict[str, str] | None = None, code: int = 0) -> str:
    """Runs a host to its end; what it said."""
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600, check=False)
    said = done.stdout + done.stderr
    assert done.returncode == code, said
    return said


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Channels of the box through usd-core and through Hydra, with the same seed."""
    folder = tmp_path_factory.mktemp("pictures")
    flags = [*FEW_SAMPLES, "--aovs", ",".join(AOVS)]
    return (
        read_exr(through_usd_core(folder / "usd_core.exr", *flags)),
        read_exr(through_hydra(folder / "hydra.exr", *flags)),
    )


@pytest.mark.parametrize("channel", ["R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z"])
def test_usd_core_and_hydra_agree(channel: str, pictures: tuple[dict[str, np.ndarray], dict[str, np.ndarray]]) -> None:
    """Every pixel is the same, within what a half-float keeps."""
    usd_core, hydra = (picture[channel].astype(np.float32) for picture in pictures)
    assert usd_core.any(), "nothing is there to compare"
    np.testing.assert_allclose(hydra, usd_core, rtol=2**-10, atol=1e-6)


@pytest.mark.parametrize("name", IDS)
def test_ids_of_usd_core_and_hydra_name_the_same_things(
    name: str, pictures: tuple[dict[str, np.ndarray], dict[str, np.ndarray]]
) -> None:
    """Hosts may number as they like: one host's ids map one to one to the other's."""
    usd_core, hydra = (picture[f"{name}.id"] for picture in pictures)
    pairs = np.unique(np.stack([usd_core.ravel(), hydra.ravel()]), axis=1)
    assert pairs.shape[1] == len(np.unique(usd_core)) == len(np.unique(hydra))
    nothing = np.uint32(0xFFFFFFFF)
    assert np.array_equal(usd_core == nothing, hydra == nothing)


def test_all_prims_are_seen(pictures: tuple[dict[str, np.ndarray], dict[str, np.ndarray]]) -> None:
    """The box has seven meshes, and room around them."""
    assert [len(np.unique(picture["primId.id"])) for picture in pictures] == [8, 8]


def test_frame_recorder_agrees_with_the_engine(tmp_path: Path) -> None:
    """OpenUSD's own recorder, which knows no settings, gives what the engine gives with default ones."""
    recorded = read_colour(through_hydra(tmp_path / "recorded.exr"))
    engine = read_colour(through_hydra(tmp_path / "engine.exr", "--aovs", "color"))
    np.testing.assert_allclose(recorded, engine, rtol=2**-10, atol=1e-6)


def test_hydra_takes_the_height(tmp_path: Path) -> None:
    """A height beside the camera's own."""
    picture = read_colour(through_hydra(tmp_path / "wide.exr", *FEW_SAMPLES, "--imageHeight", "64"))
    assert picture.shape == (64, 128, 3)


def test_hydra_refuses_an_unknown_setting(tmp_path: Path) -> None:
    """A bad argument, and it is named."""
    command = [sys.executable, HERE / "hydra_record.py", CORNELL, tmp_path / "no.exr", "--set", "umber:nonsense=1"]
    assert "umber:nonsense" in run(command, code=2)
    assert not (tmp_path / "no.exr").exists()


def test_hydra_reports_a_missing_stage(tmp_path: Path) -> None:
    """No picture, and the exit code says so."""
    command = [sys.executable, HERE / "hydra_record.py", tmp_path / "none.usda", tmp_path / "no.exr"]
    assert "none.usda" in run(command, code=1)


def test_blender_renders(tmp_path: Path) -> None:
    """Blender's picture is finite, not black, and red on the left, green on the right."""
    probe = [sys.executable, "-c", "import importlib.util, sys; sys.exit(not importlib.util.find_spec('bpy'))"]
    if subprocess.run(probe, check=False).returncode:
        pytest.skip("this OpenUSD comes without Blender")
    output = tmp_path / "blender.exr"
    run([sys.executable, HERE / "blender_render.py", CORNELL, output, "--imageWidth", "128", *FEW_SAMPLES])
    picture = read_colour(output)
    assert picture.shape == (128, 128, 3)
    assert np.isfinite(picture).all()
    assert picture.mean() > 1e-3
    left, right = picture[:, :24].mean(axis=(0, 1)), picture[:, -24:].mean(axis=(0, 1))
    assert left[0] > 2 * left[1]
    assert right[1] > 1.5 * right[0]


def test_settings_that_are_words_reach_the_delegate(tmp_path: Path) -> None:
    """The rasteriser shows the same through both hosts; a word that is no choice is named, with those that are."""
    flags = ["--set", "umber:integrator=raster", "--set", "umber:rasterColor=shaded", "--aovs", "color,primId"]
    usd_core = read_exr(through_usd_core(tmp_path / "usd_core.exr", *flags))
    hydra = read_exr(through_hydra(tmp_path / "hydra.exr", *flags))
    assert usd_core["R"].any()
    for channel in "RGBA":
        np.testing.assert_allclose(hydra[channel].astype(np.float32), usd_core[channel].astype(np.float32), atol=1e-3)
    script = [sys.executable, HERE / "hydra_record.py", CORNELL, tmp_path / "none.exr", *FLAGS]
    done = subprocess.run(
        [*script, "--set", "umber:integrator=sketch", *FEW_SAMPLES],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    said = done.stdout + done.stderr
    for word in ("umber:integrator", "sketch", "path, direct, raster, mirror"):
        assert word in said, said
