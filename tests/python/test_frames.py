"""Frame specifications and placeholders."""

import math

import pytest
from conftest import stage_of
from umber.command_line.frames import frame_format, placeholder, plan

EMPTY = stage_of("(\n startTimeCode = 7\n)\n")


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("a.###.png", "###"),
        ("a.##.##.png", "##.##"),
        ("a.#.png", "#"),
        ("a.png", None),
        ("a.#.b.#.png", None),
        ("a.#.#.#.png", None),
        ("#", "#"),
    ],
)
def test_placeholder(path: str, found: str | None) -> None:
    assert placeholder(path) == found


@pytest.mark.parametrize(
    ("path", "frame", "name"),
    [
        ("a.####.png", 12, "a.0012.png"),
        ("a.#.png", 123, "a.123.png"),
        ("a.##.##.png", 1.5, "a.01.50.png"),
        ("a.###.png", -1, "a.-01.png"),
        ("{x}.##.png", 3, "{x}.03.png"),
    ],
)
def test_frame_names(path: str, frame: float, name: str) -> None:
    formatted = frame_format(path)
    assert formatted is not None
    assert formatted.format(frame=frame) == name


@pytest.mark.parametrize(
    ("frames", "times"),
    [
        ("5", [5]),
        ("1:3", [1, 2, 3]),
        ("3:1", [3, 2, 1]),
        ("1:5x2", [1, 3, 5]),
        ("1:3,10,20:22x2", [1, 2, 3, 10, 20, 22]),
    ],
)
def test_specs(frames: str, times: list[float]) -> None:
    assert [time for time, _ in plan(EMPTY, "a.##.png", frames, False)] == times


def test_fractional_strides_need_digits() -> None:
    assert [name for _, name in plan(EMPTY, "a.#.#.png", "1:2x0.5", False)] == ["a.1.0.png", "a.1.5.png", "a.2.0.png"]
    with pytest.raises(ValueError, match="minimum floating point precision of 1"):
        plan(EMPTY, "a.##.png", "1:2x0.5", False)


def test_placeholder_and_frames_go_together() -> None:
    with pytest.raises(ValueError, match="must contain exactly one"):
        plan(EMPTY, "a.png", "1:2", False)
    with pytest.raises(ValueError, match="cannot contain"):
        plan(EMPTY, "a.#.png", None, False)


def test_one_frame() -> None:
    assert plan(EMPTY, "a.png", None, False) == [(7.0, "a.png")]
    assert math.isnan(plan(EMPTY, "a.png", None, True)[0][0])


def test_a_single_frame_needs_no_placeholder() -> None:
    """One time code, one file."""
    assert plan(EMPTY, "a.png", "3:3", False) == [(3.0, "a.png")]
    with pytest.raises(ValueError, match="placeholder"):
        plan(EMPTY, "a.png", "3:4", False)
    with pytest.raises(ValueError, match="placeholder"):
        plan(EMPTY, "a.#.#.#.png", "3", False)
