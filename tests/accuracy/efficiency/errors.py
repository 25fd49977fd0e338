"""What is true of each scene, and how far pictures are from it.

Error is relMSE = mean((x - ref)^2 / (ref^2 + e^2)), e = 1 % of the reference's mean luminance. A reference of finitely
many samples adds its own noise to that; where it is known, it is taken off, so that long renders are not held for
worse than they are. Mitsuba's references: their noise is what two Mitsuba pictures of other seeds have in common when
the reference is taken off both. Cycles' references, of its own: from their two halves.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from processes import Picture, Side

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
HALF_SEEDS = (900_001, 1_900_001)
# samples a pixel
AT_ONCE = 256


@dataclass
class Truth:
    """A reference, and the relMSE that its own noise adds; zero where that is not known."""

    picture: Picture
    noise: float = 0.0

    @property
    def scale(self) -> Picture:
        """What squared differences are relative to."""
        floor = 0.01 * (self.picture @ LUMINANCE).mean()
        return self.picture**2 + floor**2

    def rel_mse(self, picture: Picture) -> float:
        """As it is defined, the reference's noise in it."""
        return float(((picture - self.picture) ** 2 / self.scale).mean())

    def error(self, picture: Picture) -> float:
        """The same without the reference's noise."""
        return max(self.rel_mse(picture) - self.noise, 1e-12)

    def learn_noise(self, pictures: list[Picture]) -> None:
        """From pictures of the renderer that made it, of other seeds: at least two."""
        differences = [picture - self.picture for picture in pictures]
        products = [float((a * b / self.scale).mean()) for a, b in itertools.combinations(differences, 2)]
        if products:
            self.noise = max(float(np.mean(products)), 0.0)


def half(side: Side, samples: int, seed: int) -> Picture:
    """A long picture, in parts whose samples a renderer can hold in memory at once."""
    more: dict[str, object] = {"set": {"convergedVariance": "-1"}} if side.renderer.name == "Umber" else {}
    parts = [(min(AT_ONCE, samples - done), seed + done) for done in range(0, samples, AT_ONCE)]
    total = sum(count * side.take(count, part_seed, **more).picture for count, part_seed in parts)
    return np.asarray(total / samples)


def own_truth(side: Side, cache: Path, samples: int) -> Truth:
    """A renderer's own reference: two halves, rendered once and kept in the file `cache`."""
    if not cache.exists():
        print(f"{side.renderer.name}: a reference, 2 x {samples} samples a pixel, once", flush=True)
        halves = np.stack([half(side, samples, seed) for seed in HALF_SEEDS]).astype(np.float32)
        cache.parent.mkdir(parents=True, exist_ok=True)
        np.save(cache, halves)
    first, second = np.load(cache).astype(np.float64)
    truth = Truth((first + second) / 2)
    truth.noise = float((((first - second) / 2) ** 2 / truth.scale).mean())
    return truth
