"""Times Umber's rasteriser and mirror beside the textbook methods of `method.py`, and the rasteriser on the chess set.

Started by `cargo xtask bench chapter`. Times are of rendering alone; of Umber's the median of some pictures, of the
others one picture each. Both pictures are compared: what is timed is right.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import time
from pathlib import Path
from typing import Any

import numpy as np
from method import rasterize, trace
from pxr import Gf, Usd, UsdGeom
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

SHARED = Path(__file__).parents[4] / "shared"
SPHERE = SHARED / "reference/seed/icosphere_80.usda"
CHESS = SHARED / "assets/usdwg/full_assets/OpenChessSet/chess_set_cam.usda"
SIZE = 256
THREADS = 2


def session_of(file: Path, size: tuple[int, int], **values: str) -> Session:
    """A session that has the stage, seen by its first camera."""
    stage = Usd.Stage.Open(str(file))
    moment = Usd.TimeCode.EarliestTime()
    camera = next(UsdGeom.Camera(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera))
    session = Session()
    fixed = {"enableInteractive": "false", "umber:threads": str(THREADS), "convergedSamplesPerPixel": "1"}
    for key, value in {**fixed, **{f"umber:{name}": value for name, value in values.items()}}.items():
        session.set(key, value)
    session.camera(read_camera(camera, moment))
    feed(session, read_stage(stage, moment, frozenset({"render"}), lambda _: None))
    session.set_film(*size, ["color"])
    return session


def seconds(session: Session, pictures: int) -> list[float]:
    """Time of rendering of each of some pictures; another one before them is not counted."""
    times = []
    for seed in range(pictures + 1):
        session.set("umber:seed", str(seed))
        session.start()
        while not session.wait(10.0):
            pass
        times.append(float(session.stats()["renderSeconds"]))
    return times[1:]


def triangles_of(file: Path) -> list[tuple[Gf.Vec3d, Gf.Vec3d, Gf.Vec3d]]:
    """The triangles of a stage's first mesh, in the world."""
    stage = Usd.Stage.Open(str(file))
    mesh = next(UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    world = UsdGeom.XformCache().GetLocalToWorldTransform(mesh.GetPrim())
    points = [world.Transform(Gf.Vec3d(p)) for p in mesh.GetPointsAttr().Get()]
    corners = [points[i] for i in mesh.GetFaceVertexIndicesAttr().Get()]
    return list(zip(corners[::3], corners[1::3], corners[2::3], strict=True))


def processor() -> str:
    """What it is measured on."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.processor()}, {os.cpu_count()} cores"


def beside_textbook(pictures: int) -> list[dict[str, Any]]:
    """Both methods on the icosphere."""
    triangles = triangles_of(SPHERE)
    rows = []
    for name, integrator in (("raster", "raster"), ("mirror", "mirror")):
        session = session_of(SPHERE, (SIZE, SIZE), integrator=integrator)
        times = seconds(session, pictures)
        color = session.resolve("color")
        begun = time.perf_counter()
        faces, picture = (rasterize(triangles, SIZE), None) if name == "raster" else trace(triangles, SIZE)
        textbook = time.perf_counter() - begun
        seen = np.array(faces) >= 0
        assert np.count_nonzero(seen != (color[..., 3] > 0)) < 200, "they do not see the same"
        if picture is not None:
            both = seen & (color[..., 3] > 0)
            close = np.abs(np.array(picture) - color[..., 0])[both] < 2e-3
            assert close.mean() > 0.999, "they do not show the same"
        own = statistics.median(times)
        row = {"method": name, "size": [SIZE, SIZE], "triangles": len(triangles), "umber_seconds": own}
        rows.append({**row, "textbook_seconds": textbook, "ratio": textbook / own, "pictures": pictures})
        print(f"{name}: Umber {own * 1e3:.3f} ms, textbook {textbook:.1f} s: {textbook / own:.0f} times as fast")
    return rows


def chess(pictures: int) -> dict[str, Any]:
    """The rasteriser at 1920 by 1080."""
    session = session_of(CHESS, (1920, 1080), integrator="raster")
    before = time.process_time()
    times = seconds(session, pictures)
    processor_seconds = (time.process_time() - before) / (pictures + 1)
    median = statistics.median(times)
    print(
        f"chess set: {1 / median:.1f} frames a second; {median * 1e3:.1f} ms a frame, least {min(times) * 1e3:.1f}; "
        f"processor {processor_seconds * 1e3:.1f} ms a frame with compiling the stage once"
    )
    figures = {"size": [1920, 1080], "pictures": pictures, "median_seconds": median, "least_seconds": min(times)}
    return {**figures, "frames_per_second": 1 / median, "stats": session.stats()}


def main() -> None:
    """Measures and writes."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("out", nargs="+", type=Path, help="folders for chapter.json")
    arguments.add_argument("--commit", default="unknown")
    arguments.add_argument("--pictures", type=int, default=21, help="pictures of Umber's each; the median counts")
    parsed = arguments.parse_args()
    report = {
        "command": "cargo xtask bench chapter",
        "commit": parsed.commit,
        "processor": processor(),
        "threads": THREADS,
        "method": "time of rendering alone: Umber's median of pictures, one picture of the textbook's",
        "icosphere": beside_textbook(parsed.pictures) if SPHERE.exists() else None,
        "chess": chess(parsed.pictures) if CHESS.exists() else None,
    }
    for folder in parsed.out:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "chapter.json").write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
