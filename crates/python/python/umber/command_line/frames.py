"""Time codes to record, and the frame number placeholder of the output path."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice

from pxr import Tf, Usd, UsdUtils

PLACEHOLDER = re.compile(r"^[^#]*?(#+(?:\.#+)?)[^#]*$")


def decimals(text: str) -> int:
    """Digits behind the point of a number, or of a placeholder."""
    return len(text.partition(".")[2])


class FrameSpecs:
    """Comma-separated FrameSpecs (`101:105x2,120`): iterates over all their time codes.

    Raises ValueError for text that is none.
    """

    def __init__(self, text: str) -> None:
        specs = text.split(",")
        try:
            self._ranges = [UsdUtils.TimeCodeRange.CreateFromFrameSpec(spec) for spec in specs]
        except Tf.ErrorException as error:
            raise ValueError(f"argument --frames/-f: '{text}' is not a list of FrameSpecs") from error
        self.decimals = max((decimals(spec.split("x")[1]) for spec in specs if spec.count("x") == 1), default=0)
        """Digits behind the point that tell neighbouring frames apart."""

    def __iter__(self) -> Iterator[float]:
        for time_codes in self._ranges:
            for time_code in time_codes:
                yield time_code.GetValue()


def placeholder(path: str) -> str | None:
    """The one placeholder (`###` or `###.##`) of a path; None where there is none, or more than one."""
    found = PLACEHOLDER.match(path)
    return found.group(1) if found else None


def frame_format(path: str) -> str | None:
    """The path as a format string for `frame`; None where it has not exactly one placeholder."""
    found = placeholder(path)
    if found is None:
        return None
    before, after = (part.replace("{", "{{").replace("}", "}}") for part in path.split(found, 1))
    return f"{before}{{frame:0{len(found)}.{decimals(found)}f}}{after}"


def plan(stage: Usd.Stage, output: str, frames: str | None, default_time: bool) -> list[tuple[float, str]]:
    """Time codes to record and the file for each.

    A single frame needs no placeholder (usdrecord wants one even then).

    Raises ValueError where FrameSpecs and placeholder do not fit together.
    """
    formatted = frame_format(output)
    if frames is None:
        if formatted is not None:
            raise ValueError(
                "outputImagePath cannot contain a frame number placeholder when not operating on a frame range."
            )
        return [(Usd.TimeCode.Default().GetValue() if default_time else stage.GetStartTimeCode(), output)]
    specs = FrameSpecs(frames)
    if formatted is None:
        times = list(islice(specs, 2))
        if len(times) == 1 and "#" not in output:
            return [(times[0], output)]
        raise ValueError(
            'outputImagePath must contain exactly one frame number placeholder of the form "###" or "###.###". '
            "Note that the number of hash marks is variable in each group."
        )
    given = placeholder(output) or ""
    if decimals(given) < specs.decimals:
        raise ValueError(
            f"The given FrameSpecs require a minimum floating point precision of {specs.decimals}, but the frame "
            f"placeholder in outputImagePath only specified a precision of {decimals(given)} ({given}). The precision "
            f"of the frame placeholder must be equal to or greater than {specs.decimals}."
        )
    return [(time, formatted.format(frame=time)) for time in specs]
