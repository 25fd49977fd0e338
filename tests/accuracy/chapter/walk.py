"""What each step of docs/from-polygon-to-path.md costs: rays and milliseconds, 256 x 256 pixels.

    target/venv/usd-core/bin/python tests/accuracy/chapter/walk.py

Times are of rendering alone, medians of some pictures; into docs/charts/walk.json too.
"""

from __future__ import annotations

import argparse
import json
import statistics

from figures import ROOT, SIZE
from make import lit, textbook
from measure import THREADS, processor
from pxr import Usd, UsdGeom
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

SAMPLES = "convergedSamplesPerPixel"
# takes a minute: one picture tells enough
LONG = "path, smooth, 1024 samples"
# pictures that do not count, before those that do
WARM_UP = 5
# of what takes less, in seconds, there are so many times as many: it differs more
SHORT, MORE = 0.05, 9
RECORD = ROOT / "docs/charts/walk.json"


def steps() -> list[tuple[str, Usd.Stage, dict[str, str]]]:
    """Name, stage and settings of each step."""
    sphere, flat, smooth = textbook(), lit(smooth=False), lit(smooth=True)
    rough = {"umber:integrator": "mirror", "umber:mirrorRoughness": "1"}
    finer = [(splits, textbook(splits)) for splits in (3, 5, 7)]
    return [
        ("raster", sphere, {"umber:integrator": "raster"}),
        ("mirror", sphere, {"umber:integrator": "mirror", SAMPLES: "1"}),
        *[
            (f"{kind}, {20 * 4**splits} triangles", stage, {"umber:integrator": kind, SAMPLES: "1"})
            for kind in ("raster", "mirror")
            for splits, stage in finer
        ],
        ("mirror, roughness 1", sphere, {**rough, SAMPLES: "1"}),
        ("mirror, roughness 1, 50 samples", sphere, {**rough, SAMPLES: "50"}),
        ("direct, 64 samples", flat, {"umber:integrator": "direct", SAMPLES: "64"}),
        ("path, 64 samples", flat, {SAMPLES: "64"}),
        ("path, smooth, 64 samples", smooth, {SAMPLES: "64"}),
        (LONG, smooth, {SAMPLES: "1024"}),
    ]


def session_of(stage: Usd.Stage, settings: dict[str, str]) -> Session:
    """A session that has a stage, seen by its eye."""
    session = Session()
    for key, value in {"enableInteractive": "false", "umber:threads": str(THREADS), **settings}.items():
        session.set(key, value)
    moment = Usd.TimeCode.EarliestTime()
    session.camera(read_camera(UsdGeom.Camera.Get(stage, "/Eye"), moment))
    feed(session, read_stage(stage, moment, frozenset({"render"}), lambda _: None))
    session.set_film(SIZE, SIZE, ["color"])
    return session


def measured(stage: Usd.Stage, settings: dict[str, str], pictures: int) -> tuple[int, float]:
    """Rays of a picture, and milliseconds, the median; pictures while the processor wakes do not count."""
    session = session_of(stage, settings)

    def seconds(seed: int) -> float:
        session.set("umber:seed", str(seed))
        session.start()
        while not session.wait(10.0):
            pass
        return float(session.stats()["renderSeconds"])

    before = [seconds(seed) for seed in range(1 if pictures == 1 else WARM_UP)]
    count = pictures * (MORE if before[-1] < SHORT else 1)
    times = [seconds(len(before) + seed) for seed in range(count)]
    return int(session.stats()["rays"]), 1e3 * statistics.median(times)


def main() -> None:
    """Prints a table's rows, and writes them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pictures", type=int, default=9)
    parser.add_argument("--step", nargs="+", help="measured anew; the others stay as they were")
    arguments = parser.parse_args()
    known = json.loads(RECORD.read_text())["steps"] if arguments.step else []
    rows = {row["step"]: row for row in known}
    for name, stage, settings in steps():
        if arguments.step and name not in arguments.step:
            continue
        rays, milliseconds = measured(stage, settings, 1 if name == LONG else arguments.pictures)
        print(f"| {name} | {rays:,} | {milliseconds:.2f} |".replace(",", " "), flush=True)
        rows[name] = {"step": name, "rays": rays, "milliseconds": milliseconds}
    about = {"processor": processor(), "size": [SIZE, SIZE], "pictures": arguments.pictures}
    report = {**about, "steps": list(rows.values())}
    RECORD.write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
