"""What the tests of the Python front end share."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from pxr import Usd
from umber.command_line import main
from umber.description import Instancer, Light, Material, Mesh, Prim
from umber.stage_reader import read_stage

SQUARE = """
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
"""


class Scene:
    """What a stage reads as, by kind and path."""

    def __init__(self, prims: list[Prim], warnings: list[str]) -> None:
        self.meshes = {p.path: p for p in prims if isinstance(p, Mesh)}
        self.instancers = {p.path: p for p in prims if isinstance(p, Instancer)}
        self.lights = {p.path: p for p in prims if isinstance(p, Light)}
        self.materials = {p.path: p for p in prims if isinstance(p, Material)}
        self.warnings = warnings


def layer_text(text: str) -> str:
    """A layer from text that may close a prim on the line of its last statement.

    `SQUARE` in the text stands for a mesh's topology and points.
    """
    return "#usda 1.0\n" + re.sub(r"(?<=\S)[ \t]+}", "\n}", text.replace("SQUARE", SQUARE))


def stage_of(text: str) -> Usd.Stage:
    """A stage in memory."""
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().ImportFromString(layer_text(text))
    return stage


@pytest.fixture
def read() -> Callable[..., Scene]:
    """Reads a stage, given as text, at a time code."""

    def read_text(text: str | Usd.Stage, time: float | None = None, purposes: tuple[str, ...] = ("proxy",)) -> Scene:
        stage = text if isinstance(text, Usd.Stage) else stage_of(text)
        code = Usd.TimeCode.Default() if time is None else Usd.TimeCode(time)
        warnings: list[str] = []
        return Scene(list(read_stage(stage, code, frozenset(purposes), warnings.append)), warnings)

    return read_text


@pytest.fixture
def umber(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Runs `umber record` in an empty folder, quickly; gives the exit code."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str, fast: bool = True) -> int:
        quick = ("--set", "convergedSamplesPerPixel=2", "-w", "24") if fast else ()
        try:
            return main(["record", *arguments, *quick])
        except SystemExit as ended:
            return int(ended.code or 0)

    return run


@pytest.fixture
def usda(tmp_path: Path) -> Callable[..., str]:
    """Writes a layer and gives its path."""

    def write(text: str, name: str = "stage.usda") -> str:
        path = tmp_path / name
        path.write_text(layer_text(text))
        return str(path)

    return write
