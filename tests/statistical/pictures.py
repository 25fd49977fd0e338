"""Pictures of stages, without a detour through files; and what a test asks of them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pxr import Usd, UsdGeom
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

Picture = NDArray[np.float64]
BLOCK = 8
PURPOSES = frozenset({"render"})


def seeds() -> list[int]:
    """One fixed seed; `UMBER_SEEDS=10` asks for ten others."""
    count = int(os.environ.get("UMBER_SEEDS", "0"))
    return [1000 * (i + 1) for i in range(count)] or [0]


def load(stage: Usd.Stage, size: tuple[int, int], time: Usd.TimeCode | None = None, *, shares: bool = False) -> Session:
    """A session that has the stage, seen by its first camera. What the reader cannot read yet skips the test.

    `shares`: neighbours may share their paths, where that pays. Else pixels are independent.
    """
    when = time or Usd.TimeCode.EarliestTime()
    cameras = [UsdGeom.Camera(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera)]
    warnings: list[str] = []
    session = Session()
    session.set("enableInteractive", "false")
    session.set("domeLightCameraVisibility", "true")
    session.set("umber:maxBounces", "8")
    session.set("umber:pathReuse", str(shares).lower())
    session.camera(read_camera(cameras[0], when))
    session.purposes(sorted(PURPOSES))
    feed(session, read_stage(stage, when, PURPOSES, warnings.append))
    missing = [text for text in warnings if "not supported" in text]
    if missing:
        pytest.skip(f"{missing[0]}")
    assert warnings == []
    session.set_film(*size, ["color"])
    return session


def render(session: Session, samples: int, seed: int) -> Picture:
    """Radiance as (height, width, 3), row 0 at the top."""
    session.set("umber:seed", str(seed))
    session.set("convergedSamplesPerPixel", str(samples))
    session.start()
    assert session.wait(300.0)
    assert [text for _, text in session.messages()] == []
    return session.resolve("color")[..., :3].astype(np.float64)


def blocks(pictures: Picture, edge: int = BLOCK) -> Picture:
    """Means of blocks of (..., height, width, channels); what fills no block is left out."""
    *outer, height, width, channels = pictures.shape
    rows, columns = height // edge, width // edge
    cut = pictures[..., : rows * edge, : columns * edge, :]
    return cut.reshape(*outer, rows, edge, columns, edge, channels).mean(axis=(-4, -2))


def open_stage(file: Path) -> Usd.Stage:
    """The stage of a file."""
    return Usd.Stage.Open(str(file))
