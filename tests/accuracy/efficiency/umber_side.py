"""Umber's side: see `side.py`. A request's `set` is a table of settings."""

from __future__ import annotations

import sys
from typing import Any

import umber
from numpy.typing import NDArray
from pxr import Usd, UsdGeom
from side import BOUNCES, serve
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage


def load(file: str, width: int, height: int) -> Session:
    """A session that has the stage, seen by its first camera."""
    stage = Usd.Stage.Open(file)
    time = Usd.TimeCode.EarliestTime()
    camera = next(UsdGeom.Camera(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera))
    session = Session()
    session.set("enableInteractive", "false")
    session.set("domeLightCameraVisibility", "true")
    session.set("umber:maxBounces", str(BOUNCES))
    session.camera(read_camera(camera, time))
    session.purposes(["render"])
    feed(session, read_stage(stage, time, frozenset({"render"}), lambda text: print(text, file=sys.stderr)))
    session.set_film(width, height, ["color"])
    return session


def main() -> None:
    """Serves."""
    file, width, height = sys.argv[1:]
    session = load(file, int(width), int(height))

    def take(request: dict[str, Any]) -> tuple[NDArray[Any], dict[str, float]]:
        session.set("umber:seed", str(request["seed"]))
        session.set("convergedSamplesPerPixel", str(request["samples"]))
        for key, value in request["set"].items():
            session.set(key, str(value))
        session.start()
        while not session.wait(10.0):
            pass
        stats = session.stats()
        figures = {"seconds": float(stats["renderSeconds"]), "samples": float(stats["meanSamples"])}
        return session.resolve("color")[..., :3], figures

    serve(f"Umber {umber.__version__}", take)


if __name__ == "__main__":
    main()
