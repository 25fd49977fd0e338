"""Every kind of lighting against another renderer, as tests of equal means.

For each scene, pictures of several seeds give the radiance and its standard error; the reference (Mitsuba 3, see
`make_references.py`) has its own, from independent batches. z is the difference over both errors together, and what
is asked is |z| < 4: of the mean of the picture, and of all but one in a thousand of its 8 x 8 blocks, over all scenes
together (at most one in a single scene). Some relative difference is allowed only where the reference's own material
is another by that much. Figures are printed: `pytest -rP tests/statistical`.

`UMBER_SEEDS=10` does the whole ten times, with ten other seeds.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pictures import BLOCK, Picture, blocks, load, open_stage, render, seeds

HERE = Path(__file__).parent
SCENES = sorted(file.stem for file in (HERE / "scenes").glob("*.usda") if file.stem != "set")
PICTURES = 8
SAMPLES = 128
LIMIT = 4.0
# The converter's metal is Mitsuba's `principled`: the same lobe, up to its Fresnel term.
ALLOWED = {"metal": 0.003}
# Single precision, of sums of a thousand samples and of the reference; and what is so dark beside the picture's mean
# comes from paths so rare that few pictures do not know their variance.
ROUNDING = 1e-4

off_blocks: dict[str, tuple[int, int]] = {}


def distances(ours: Picture, theirs: Picture, variance: Picture, error: Picture, allowed: float) -> Picture:
    """How far means are apart, in standard errors, beyond the relative difference that is allowed."""
    apart = np.maximum(np.abs(ours - theirs) - allowed * theirs - ROUNDING * np.maximum(theirs, theirs.mean()), 0.0)
    return apart / np.sqrt(variance + error**2 + 1e-30)


def test_every_scene_has_a_reference() -> None:
    assert len(SCENES) >= 12
    assert sorted(file.stem for file in (HERE / "references").glob("*.npz")) == SCENES


@pytest.mark.parametrize("name", SCENES)
def test_agrees_with_mitsuba(name: str) -> None:
    with np.load(HERE / "references" / f"{name}.npz") as file:
        reference = {key: file[key].astype(np.float64) for key in file.files}
    truth = reference["mean"]
    session = load(open_stage(HERE / "scenes" / f"{name}.usda"), (truth.shape[1], truth.shape[0]))
    allowed = ALLOWED.get(name, 0.0)
    off = count = 0
    for seed in seeds():
        made = np.stack([render(session, SAMPLES, PICTURES * seed + i) for i in range(PICTURES)])

        # pixels are independent, so their spreads may be added up: far more of them than there are pictures
        spread = made.var(axis=0, ddof=1) / PICTURES
        of_mean = distances(
            made.mean(axis=(0, 1, 2)),
            truth.mean(axis=(0, 1)),
            spread.mean(axis=(0, 1)) / spread[..., 0].size,
            reference["mean_error"],
            allowed,
        )
        ours, theirs = blocks(made.mean(axis=0)), blocks(truth)
        of_blocks = distances(ours, theirs, blocks(spread) / BLOCK**2, reference["block_error"], allowed)
        worst = of_blocks.max(axis=2)
        off, count = off + int((worst >= LIMIT).sum()), count + worst.size
        bias = made.mean() / truth.mean() - 1
        rms = float(np.sqrt(((ours - theirs) ** 2).mean()) / truth.mean())
        print(
            f"{name}, seed {seed}: mean {100 * bias:+.3f} %, z {of_mean.max():.2f}; blocks: RMS {100 * rms:.3f} %, "
            f"{int((worst >= LIMIT).sum())} of {worst.size} off, largest z {worst.max():.2f}"
        )
        assert np.isfinite(made).all()
        assert of_mean.max() < LIMIT
    off_blocks[name] = (off, count)
    assert off <= max(1, count // 1000)


def test_few_blocks_differ_in_all() -> None:
    off, count = (sum(numbers) for numbers in zip(*off_blocks.values(), strict=True))
    print(f"{off} of {count} blocks off by {LIMIT:.0f} standard errors or more")
    assert off <= max(1, count // 1000)
