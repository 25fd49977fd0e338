"""Frames of ASWF's luxtest against UsdLux's formulas, integrated numerically: see `make_luxtest.py`.

Direct light alone, as the stages ask for. Compared are the pixels that hold neither an edge nor the light: each of
them, within one per cent of its own value (five under the stripes of an IES profile, which no grid hits
exactly), 0.2 % of the frame's mean and four standard errors, but for one in a hundred; and their mean, within half a
per cent (one and a half). So many samples are taken that the mean's own standard error is a fifth of that limit or
less: behind the edge of a hard cone few of them meet light. Figures are printed: `pytest -rP tests/statistical`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pictures import Picture, load, open_stage, render, seeds
from pxr import Usd, UsdLux
from umber import Session, description

HERE = Path(__file__).parent
LUXTEST = HERE.parents[2] / "shared/assets/luxtest"
with np.load(HERE / "luxtest.npz") as file:
    REFERENCES = {name: file[name] for name in file.files}
NAMES = sorted(name for name in REFERENCES if not name.endswith("_usable"))
PICTURES = 4
MANY_PICTURES = 64
SAMPLES = 256


def is_shaped(stage: Usd.Stage, time: Usd.TimeCode) -> bool:
    """Whether a light has a cone, a focus or a profile."""
    lights = [UsdLux.ShapingAPI(prim) for prim in stage.Traverse() if prim.HasAPI(UsdLux.ShapingAPI)]
    files = [light.GetShapingIesFileAttr().Get(time) for light in lights]
    cones = any(light.GetShapingConeAngleAttr().Get(time) < 180 for light in lights)
    focuses = any((light.GetShapingFocusAttr().Get(time) or 0) > 0 for light in lights)
    return cones or focuses or any(file is not None and file.path for file in files)


def variance(made: Picture, usable: NDArray[np.bool_]) -> Picture:
    """Of the mean of some pictures, as (usable pixels, channels)."""
    return np.asarray(made.var(axis=0, ddof=1)[usable] / len(made))


def pictures(session: Session, seed: int, usable: NDArray[np.bool_], relative_error: float) -> Picture:
    """As many as make the standard error of the usable pixels' mean so small, or `MANY_PICTURES`."""
    made: list[Picture] = []
    while len(made) < MANY_PICTURES:
        made += [render(session, SAMPLES, MANY_PICTURES * seed + len(made) + i) for i in range(PICTURES)]
        stack = np.stack(made)
        # a pixel's channels share their samples, pixels do not
        error = np.sqrt(variance(stack, usable).mean(axis=-1).sum()) / stack.mean(axis=0)[usable].mean(axis=-1).sum()
        if error <= relative_error:
            break
    return np.stack(made)


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
        made = pictures(session, seed, usable, of_mean / 5)
        ours, theirs = made.mean(axis=0)[usable], truth[usable]
        error = np.sqrt(variance(made, usable).mean(axis=-1, keepdims=True))
        allowed = of_pixel * theirs + 0.002 * theirs.mean() + 4 * error
        off = (np.abs(ours - theirs) > allowed).any(axis=1)
        bias = ours.sum() / theirs.sum() - 1
        worst = np.abs(ours - theirs).max() / theirs.mean()
        rms = np.sqrt(((ours - theirs) ** 2).mean()) / theirs.mean()
        print(
            f"{name}, seed {seed}, {len(made)} pictures: mean {100 * bias:+.3f} %, RMS {100 * rms:.3f} %, "
            f"largest difference {100 * worst:.2f} % of the mean, {off.sum()} of {off.size} pixels off"
        )
        assert np.isfinite(made).all()
        assert abs(bias) < of_mean
        assert off.sum() <= off.size // 100
