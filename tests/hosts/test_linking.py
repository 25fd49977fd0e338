"""Light linking and portals: usd-core and both of Hydra's ways of reading a stage give one picture.

Started by `cargo xtask test`, which sets up the environment.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from images import read_colour
from test_hosts import HERE, USD_CORE_PYTHON, run

LINKING = HERE / "linking.usda"
PORTALS = HERE / "portals.usda"
SCENE_INDICES = "USDIMAGINGGL_ENGINE_ENABLE_SCENE_INDEX"
FLAGS = ["--camera", "Camera", "--disableCameraLight", "--imageWidth", "96", "--aovs", "color"]


def through_hydra(stage: Path, output: Path, samples: int, *, scene_indices: bool) -> np.ndarray:
    """Renders a stage through UsdImagingDelegate, or through UsdImaging's scene indices."""
    environment = {**os.environ, SCENE_INDICES: str(int(scene_indices))}
    run([sys.executable, HERE / "hydra_record.py", stage, output, *flags(samples)], environment)
    return read_colour(output)


def through_usd_core(stage: Path, output: Path, samples: int) -> np.ndarray:
    """Renders a stage through the Python front end."""
    if not USD_CORE_PYTHON:
        pytest.skip("UMBER_USD_CORE_PYTHON names no interpreter with the package umber")
    apart = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PXR_PLUGINPATH_NAME")}
    run([USD_CORE_PYTHON, "-m", "umber", "record", stage, output, *flags(samples)], apart)
    return read_colour(output)


def flags(samples: int) -> list[str]:
    """Flags that both hosts know."""
    return [*FLAGS, "--set", f"convergedSamplesPerPixel={samples}"]


def without(stage: Path, copy: Path, *words: str) -> Path:
    """A copy of a stage without the lines that hold one of the words."""
    lines = stage.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not any(word in line for word in words)]
    assert len(kept) < len(lines)
    copy.write_text("\n".join(kept), encoding="utf-8")
    return copy


@pytest.mark.parametrize("scene_indices", [False, True])
def test_links_of_usd_core_and_hydra_agree(tmp_path: Path, scene_indices: bool) -> None:
    """Linked meshes, native instances, a point instancer, and shadow links."""
    hydra = through_hydra(LINKING, tmp_path / "hydra.exr", 8, scene_indices=scene_indices)
    usd_core = through_usd_core(LINKING, tmp_path / "usd_core.exr", 8)
    np.testing.assert_allclose(hydra, usd_core, rtol=2**-10, atol=1e-6)
    # the links matter
    for kind in ("lightLink", "shadowLink"):
        unlinked = through_usd_core(without(LINKING, tmp_path / f"{kind}.usda", kind), tmp_path / f"{kind}.exr", 8)
        differ = np.abs(unlinked - usd_core).max(axis=2) > 0.01
        assert differ.mean() > 0.02, f"{kind} changes {differ.sum()} pixels"


def test_portals_of_usd_core_and_scene_indices_agree(tmp_path: Path) -> None:
    """The same samples through the window; without it, much more noise."""
    hydra = through_hydra(PORTALS, tmp_path / "hydra.exr", 8, scene_indices=True)
    usd_core = through_usd_core(PORTALS, tmp_path / "usd_core.exr", 8)
    np.testing.assert_allclose(hydra, usd_core, rtol=2**-10, atol=1e-6)
    plain = through_usd_core(without(PORTALS, tmp_path / "plain.usda", "rel portals"), tmp_path / "plain.exr", 8)
    noise = [np.abs(np.diff(picture, axis=1)).mean() for picture in (usd_core, plain)]
    assert noise[1] > 1.5 * noise[0]


def test_the_delegate_without_portals_gives_the_same_mean(tmp_path: Path) -> None:
    """UsdImagingDelegate passes no portals on: more noise, the same picture."""
    hydra = through_hydra(PORTALS, tmp_path / "hydra.exr", 256, scene_indices=False)
    usd_core = through_usd_core(PORTALS, tmp_path / "usd_core.exr", 64)
    blocks = [picture.reshape(4, 16, 4, 24, 3).mean(axis=(1, 3, 4)) for picture in (hydra, usd_core)]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.1)
    assert abs(hydra.mean() / usd_core.mean() - 1.0) < 0.02


@pytest.mark.parametrize("scene_indices", [False, True])
def test_edits_of_links_show(scene_indices: bool) -> None:
    """After each edit an engine shows what a new one does."""
    environment = {**os.environ, SCENE_INDICES: str(int(scene_indices))}
    run([sys.executable, HERE / "relink.py", LINKING], environment)
