"""Every kind of lighting against another renderer, as tests of equal means.

For each scene, pictures of several seeds give the radiance and its standard error; the reference (Mitsuba 3, see
`make_references.py`) has its own, from independent batches. z is the difference over both errors together, and what
is asked is |z| < 4: of the mean of the picture, and of all but one in a thousand of its 8 x 8 blocks, over all scenes
together (at most one in a single scene). Every scene is so compared without shared paths, whose pixels are independent;
some with them, by more pictures. Some relative difference is allowed only where the reference's own material is another
by that much. Figures are printed: `pytest -rP tests/statistical`.

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
# Scenes in which neighbours mostly share paths, in groups of 4 (the first) and of 16 (the last): a trial decides.
SHARED = ["disk", "rect", "rect_away"]
# Neighbours' spreads say little of a block then: more pictures tell it. Groups keep within tiles.
SHARED_PICTURES = 32
TILE = 16
LIMIT = 4.0
# As improbable, where the error is that of 32 pictures: Student's t of 31 degrees of freedom.
SHARED_LIMIT = 4.62
# The converter's metal is Mitsuba's `principled`: the same lobe, up to its Fresnel term.
ALLOWED = {"metal": 0.003}
# Single precision, of sums of a thousand samples and of the reference; and what is so dark beside the picture's mean
# comes from paths so rare that few pictures do not know their variance.
ROUNDING = 1e-4

off_blocks: dict[tuple[str, bool], tuple[int, int]] = {}


def distances(ours: Picture, theirs: Picture, variance: Picture, error: Picture, allowed: float) -> Picture:
    """How far means are apart, in standard errors, beyond the relative difference that is allowed."""
    apart = np.maximum(np.abs(ours - theirs) - allowed * theirs - ROUNDING * np.maximum(theirs, theirs.mean()), 0.0)
    return apart / np.sqrt(variance + error**2 + 1e-30)


def test_every_scene_has_a_reference() -> None:
    assert len(SCENES) >= 12
    assert sorted(file.stem for file in (HERE / "references").glob("*.npz")) == SCENES


def variances(made: Picture, shares: bool) -> tuple[Picture, Picture]:
    """Of the mean of the picture, and of that of each block."""
    if shares:
        of_tiles, of_blocks = (blocks(made, edge).var(axis=0, ddof=1) / len(made) for edge in (TILE, BLOCK))
        return of_tiles.mean(axis=(0, 1)) / of_tiles[..., 0].size, of_blocks
    # pixels are independent, so their spreads may be added up: far more of them than there are pictures
    of_pixels = made.var(axis=0, ddof=1) / len(made)
    return of_pixels.mean(axis=(0, 1)) / of_pixels[..., 0].size, blocks(of_pixels) / BLOCK**2


@pytest.mark.parametrize(("name", "shares"), [(name, False) for name in SCENES] + [(name, True) for name in SHARED])
def test_agrees_with_mitsuba(name: str, shares: bool) -> None:
    with np.load(HERE / "references" / f"{name}.npz") as file:
        reference = {key: file[key].astype(np.float64) for key in file.files}
    truth = reference["mean"]
    session = load(open_stage(HERE / "scenes" / f"{name}.usda"), (truth.shape[1], truth.shape[0]), shares=shares)
    allowed = ALLOWED.get(name, 0.0)
    pictures, limit = (SHARED_PICTURES, SHARED_LIMIT) if shares else (PICTURES, LIMIT)
    off = count = 0
    for seed in seeds():
        made, in_groups = [], 0
        for i in range(pictures):
            made.append(render(session, SAMPLES, pictures * seed + i))
            in_groups += session.stats()["pathGroup"] > 1
        assert in_groups >= pictures / 2 if shares else in_groups == 0
        made = np.stack(made)
        variance, of_blocks_variance = variances(made, shares)
        of_mean = distances(
            made.mean(axis=(0, 1, 2)), truth.mean(axis=(0, 1)), variance, reference["mean_error"], allowed
        )
        ours, theirs = blocks(made.mean(axis=0)), blocks(truth)
        of_blocks = distances(ours, theirs, of_blocks_variance, reference["block_error"], allowed)
        worst = of_blocks.max(axis=2)
        off, count = off + int((worst >= limit).sum()), count + worst.size
        bias = made.mean() / truth.mean() - 1
        rms = float(np.sqrt(((ours - theirs) ** 2).mean()) / truth.mean())
        print(
            f"{name}{', shared' if shares else ''}, seed {seed}: mean {100 * bias:+.3f} %, z {of_mean.max():.2f}; "
            f"blocks: RMS {100 * rms:.3f} %, {int((worst >= limit).sum())} of {worst.size} off, "
            f"largest z {worst.max():.2f}"
        )
        assert np.isfinite(made).all()
        assert of_mean.max() < LIMIT
    off_blocks[name, shares] = (off, count)
    assert off <= max(1, count // 1000)


def test_few_blocks_differ_in_all() -> None:
    off, count = (sum(numbers) for numbers in zip(*off_blocks.values(), strict=True))
    print(f"{off} of {count} blocks off by the limit or more")
    assert off <= max(1, count // 1000)
