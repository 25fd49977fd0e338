"""The renderer against another one: whole pictures by Mitsuba, thousands of samples a pixel.

Compared are means of 8 x 8 blocks: their RMS difference, relative to the picture's mean, and how many of them differ
by more than four standard errors. A block's standard error comes from the spread of the difference over its pixels,
so it holds the noise of both renderers. That takes pixels to be independent, so none share their paths; where they do,
a group of pixels counts as one. Figures are printed: `pytest -rP tests/accuracy`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from numpy.typing import NDArray
from umber.command_line import main

SHARED = Path(__file__).parents[3] / "shared"
BLOCK = 8
# As many a pixel as leave the reference's noise to decide.
SAMPLES = {"cornell": 1024, "metal": 1024, "many_lights": 2048}
# Shared paths leave as much noise with fewer.
SHARED_SAMPLES = 128
# Pixels of the largest group that shares paths.
LARGEST_GROUP = 16


def render(stage: Path, width: int, samples: int, shares: bool, out: Path) -> NDArray[np.float64]:
    """Radiance as (height, width, 3), row 0 at the top."""
    settings: dict[str, object] = {"convergedSamplesPerPixel": samples, "umber:maxBounces": 8}
    settings["umber:pathReuse"] = str(shares).lower()
    arguments = ["record", "--camera", "Camera", "--disableCameraLight", "--enableDomeLightVisibility"]
    arguments += ["--imageWidth", str(width)]
    for key, value in settings.items():
        arguments += ["--set", f"{key}={value}"]
    assert main([*arguments, str(stage), str(out)]) == 0
    with OpenEXR.File(str(out)) as file:
        pixels = file.channels()["RGBA"].pixels
    return pixels[..., :3].astype(np.float64)


def blocks(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pixels by block: (rows, columns, pixels, channels); what fills no block is left out."""
    height, width = (size // BLOCK * BLOCK for size in image.shape[:2])
    cut = image[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3)
    return cut.transpose(0, 2, 1, 3, 4).reshape(height // BLOCK, width // BLOCK, BLOCK * BLOCK, 3)


@pytest.mark.parametrize(
    ("scene", "width", "tolerance", "shares"),
    [
        ("cornell", 256, 0.01, False),
        ("cornell", 256, 0.01, True),
        ("metal", 320, 0.02, False),
        ("many_lights", 320, 0.02, False),
    ],
)
def test_agrees_with_mitsuba(scene: str, width: int, tolerance: float, shares: bool, tmp_path: Path) -> None:
    reference_file = SHARED / "reference/mitsuba" / f"{scene}.npy"
    if not reference_file.exists():
        pytest.skip("no ../shared/reference/mitsuba beside the project")
    reference = np.load(reference_file).astype(np.float64)
    samples = SHARED_SAMPLES if shares else SAMPLES[scene]
    image = render(SHARED / "scenes" / f"{scene}.usda", width, samples, shares, tmp_path / "out.exr")
    assert image.shape == reference.shape

    difference = blocks(image) - blocks(reference)
    means = difference.mean(axis=2)
    rms = float(np.sqrt((means**2).mean()) / reference.mean())
    # half-float rounding of the file is no noise, but it is there: 2^-11 of the value
    rounding = blocks(reference).mean(axis=2) * 2.0**-11 / BLOCK
    independent = BLOCK**2 / (LARGEST_GROUP if shares else 1)
    error = np.sqrt(difference.var(axis=2, ddof=1) / independent + rounding**2)
    z = np.abs(means) / np.maximum(error, 1e-12)
    off = int((z > 4).any(axis=2).sum())
    count = means.shape[0] * means.shape[1]
    bias = image.mean() / reference.mean() - 1
    print(f"{scene}: RMS of block means {100 * rms:.3f} %, mean {100 * bias:+.3f} %,", end=" ")
    print(f"{off} of {count} blocks off by more than 4 standard errors")
    assert rms <= tolerance
    assert off <= max(1, count // 1000)
