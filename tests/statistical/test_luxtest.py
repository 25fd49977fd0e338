"""Frames of ASWF's luxtest against UsdLux's formulas, integrated numerically: see `make_luxtest.py`.

Direct light alone, as the stages ask for. Compared are the pixels that hold neither an edge nor the light: each of
them, within one per cent of its own value (five under the stripes of an IES profile, which no grid hits
exactly), 0.2 % of the frame's mean and four standard errors, but for one in a hundred; and their mean, within half a
per cent (one and a half). Figures are printed: `pytest -rP tests/statistical`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pictures import load, open_stage, render, seeds
from pxr import Usd, UsdLux
from umber import description

HERE = Path(__file__).parent
LUXTEST = HERE.parents[2] / "shared/assets/luxtest"
with np.load(HERE / "luxtest.npz") as file:
    REFERENCES = {name: file[name] for name in file.files}
NAMES = sorted(name for name in REFERENCES if not name.endswith("_usable"))
PICTURES = 4
SAMPLES = 256


def is_shaped(stage: Usd.Stage, time: Usd.TimeCode) -> bool:
    """Whether a light has a cone, a focus or a profile."""
    lights = [UsdLux.ShapingAPI(prim) for prim in stage.Traverse() if prim.HasAPI(UsdLux.ShapingAPI)]
    files = [light.GetShapingIesFileAttr().Get(time) for light in lights]
    cones = any(light.GetShapingConeAngleAttr().Get(time) < 180 for light in lights)
    focuses = any((light.GetShapingFocusAttr().Get(time) or 0) > 0 for light in lights)
    return cones or focuses or any(file is not None and file.path for file in files)


def test_there_are_frames() -> None:
    assert len(NAMES) >= 20


@pytest.mark.parametrize("name", NAMES)
def test_frame(name: str) -> None:
    stage_name, frame = name.rsplit("_", 1)
    path = LUXTEST / "usd" / f"{stage_name}.usda"
    if not path.exists():
        pytest.skip("no ../shared/assets/luxtest beside the project")
    truth, usable = REFERENCES[name].astype(np.float64), REFERENCES[f"{name}_usable"]
    stage, time = open_stage(path), Usd.TimeCode(int(frame))
    if is_shaped(stage, time) and not hasattr(description, "Shaping"):
        pytest.skip("the stage reader does not read ShapingAPI yet")
    session = load(stage, (truth.shape[1], truth.shape[0]), time)
    session.set("umber:maxBounces", "1")
    of_pixel, of_mean = (0.05, 0.015) if stage_name.startswith("ies") else (0.01, 0.005)
    for seed in seeds():
        made = np.stack([render(session, SAMPLES, PICTURES * seed + i) for i in range(PICTURES)])
        ours, theirs = made.mean(axis=0)[usable], truth[usable]
        error = np.sqrt(made.var(axis=0, ddof=1)[usable].mean(axis=-1, keepdims=True) / PICTURES)
        allowed = of_pixel * theirs + 0.002 * theirs.mean() + 4 * error
        off = (np.abs(ours - theirs) > allowed).any(axis=1)
        bias = ours.sum() / theirs.sum() - 1
        worst = np.abs(ours - theirs).max() / theirs.mean()
        rms = np.sqrt(((ours - theirs) ** 2).mean()) / theirs.mean()
        print(
            f"{name}, seed {seed}: mean {100 * bias:+.3f} %, RMS {100 * rms:.3f} %, "
            f"largest difference {100 * worst:.2f} % of the mean, {off.sum()} of {off.size} pixels off"
        )
        assert np.isfinite(made).all()
        assert abs(bias) < of_mean
        assert off.sum() <= off.size // 100
