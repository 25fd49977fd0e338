"""The measure's own arithmetic, on pictures made up of a truth and noise."""

from __future__ import annotations

import numpy as np
import pytest
from errors import Truth
from measure import Method, error_after
from processes import Picture, Renderer, Side, Taken

SHAPE = (96, 96, 3)
TRUTH = np.linspace(0.5, 2.0, 96 * 96 * 3).reshape(SHAPE)


def noisy(seed: int, deviation: float) -> Picture:
    """The truth and noise that is relative to it."""
    return np.asarray(TRUTH * (1 + deviation * np.random.default_rng(seed).standard_normal(SHAPE)))


def test_noise_of_the_reference_is_taken_off() -> None:
    truth = Truth(noisy(0, 0.03))
    picture = noisy(9, 0.015)
    assert truth.rel_mse(picture) > 4 * 0.015**2
    truth.learn_noise([noisy(seed, 0.05) for seed in (1, 2, 3)])
    assert truth.noise == pytest.approx(0.03**2, rel=0.05)
    assert truth.error(picture) == pytest.approx(0.015**2, rel=0.2)


def test_one_picture_tells_no_noise() -> None:
    truth = Truth(noisy(0, 0.03))
    truth.learn_noise([noisy(1, 0.2)])
    assert truth.noise == 0.0


def test_error_at_a_time_lies_on_the_line() -> None:
    exact = Truth(TRUTH)
    side = Side.__new__(Side)
    side.renderer = Renderer("none", "", "")
    method = Method("none", side, exact, [1, 4, 16])
    assert method.points() == []
    for count in method.counts:
        # relMSE falls with the time, by one over it
        deviation = 0.1 / count**0.5
        method.taken[count] = [Taken(TRUTH * (1 + deviation), 0.5 * count, count)]
    known = error_after(method, 2.0)
    for seconds in (0.25, 1.0, 5.0, 40.0):
        assert error_after(method, seconds) == pytest.approx(known * 2.0 / seconds, rel=1e-6)
    method.taken = {4: method.taken[4]}
    assert error_after(method, 4.0) == pytest.approx(known / 2, rel=1e-6)
