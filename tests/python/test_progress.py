"""The progress bar: on terminals only, with samples, percent and time."""

import io

import pytest
from umber.command_line import progress


class Rendering:
    """Stands in for a session that needs three looks."""

    def __init__(self) -> None:
        self.looks = 0

    def wait(self, _seconds: float) -> bool:
        """Whether it is done."""
        self.looks += 1
        return self.looks > 3

    def stats(self) -> dict[str, float]:
        """How far it is."""
        return {"numCompletedSamples": self.looks, "targetSamples": 3, "percentDone": self.looks * 100 / 3}


class Terminal(io.StringIO):
    """Standard error on a terminal."""

    def isatty(self) -> bool:
        """It is one."""
        return True


def test_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = Terminal()
    monkeypatch.setattr("sys.stderr", screen)
    progress.wait(Rendering())  # type: ignore[arg-type]
    assert "2/3 samples" in screen.getvalue() and "67 %" in screen.getvalue() and "left" in screen.getvalue()


def test_silence_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    log = io.StringIO()
    monkeypatch.setattr("sys.stderr", log)
    progress.wait(Rendering())  # type: ignore[arg-type]
    assert log.getvalue() == ""
