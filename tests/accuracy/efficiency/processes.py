"""The sides, as the measure sees them: processes that take pictures on request."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
Picture = NDArray[np.float64]


@dataclass(frozen=True)
class Renderer:
    """One that takes part: its name, its side's script, and the interpreter that has its modules."""

    name: str
    script: str
    python: str


@dataclass
class Taken:
    """A picture and what it took."""

    picture: Picture
    seconds: float
    samples: float


@dataclass
class Side:
    """A renderer's process that has a scene."""

    renderer: Renderer
    about: str
    start_seconds: float
    process: subprocess.Popen[str]
    folder: tempfile.TemporaryDirectory[str] = field(default_factory=tempfile.TemporaryDirectory)

    @staticmethod
    def start(renderer: Renderer, stage: Path, size: tuple[int, int]) -> Side | None:
        """Starts one and waits for its scene; None, and a line that says why, where it cannot."""
        started = time.perf_counter()
        command = [renderer.python, str(HERE / renderer.script), str(stage), *map(str, size)]
        try:
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        except OSError as error:
            print(f"{renderer.name} takes no part: {error}", flush=True)
            return None
        about = _answer(process, "READY")
        if about is None:
            print(f"{renderer.name} takes no part: it ended with code {process.wait()}", flush=True)
            return None
        return Side(renderer, about, time.perf_counter() - started, process)

    def take(self, samples: int, seed: int, **more: object) -> Taken:
        """A picture."""
        file = Path(self.folder.name) / "picture.npy"
        request = {"samples": samples, "seed": seed, "out": str(file), **more}
        if self.process.stdin is None or self.process.poll() is not None:
            sys.exit(f"{self.renderer.name} ended unasked")
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        figures = _answer(self.process, "DONE")
        if figures is None:
            sys.exit(f"{self.renderer.name} ended with code {self.process.wait()} over {request}")
        return Taken(np.load(file).astype(np.float64), float(figures["seconds"]), float(figures["samples"]))

    def end(self) -> None:
        """Ends it."""
        if self.process.stdin is not None:
            self.process.stdin.close()
        try:
            self.process.wait(20.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.folder.cleanup()


def _answer(process: subprocess.Popen[str], word: str) -> Any:  # noqa: ANN401 - JSON
    """What follows the word on the next line that begins with it; None where the output ends before."""
    if process.stdout is None:
        return None
    for line in process.stdout:
        if line.startswith(word + " "):
            return json.loads(line.removeprefix(word))
    return None
