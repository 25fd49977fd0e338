"""What a sample costs with ten lamps and with ten thousand.

    python tests/accuracy/light_count.py [10 100 1000 10000] [--rounds 5]

A floor with columns under lamps at random places, whose power is shared by however many there are. Prints the time that
one sample of one pixel takes, and the part that choosing among lamps has in it by `cargo run -p umber-shading
--example light_choice`, which also says how much smaller the error is than with an even choice.
"""

from __future__ import annotations

import argparse
import random
import statistics

from adaptive_gain import render
from pxr import Gf, Usd, UsdGeom, UsdLux
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

WIDTH, HEIGHT = 320, 180
SIZE = 80.0
POWER = 4000.0
COLUMNS = 200


def stage_of(lamps: int) -> Usd.Stage:
    """The scene with so many lamps."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    place = random.Random(1)
    floor = UsdGeom.Mesh.Define(stage, "/Floor")
    floor.CreatePointsAttr([(x, 0, z) for x in (-SIZE, SIZE) for z in (-SIZE, SIZE)])
    floor.CreateFaceVertexCountsAttr([4])
    floor.CreateFaceVertexIndicesAttr([0, 1, 3, 2])
    floor.CreateDoubleSidedAttr(True)
    for i in range(COLUMNS):
        column = UsdGeom.Cube.Define(stage, f"/Column{i}")
        height = place.uniform(1.0, 6.0)
        at = Gf.Vec3d(place.uniform(-SIZE, SIZE), 0.5 * height, place.uniform(-SIZE, SIZE))
        UsdGeom.XformCommonAPI(column).SetTranslate(at)
        UsdGeom.XformCommonAPI(column).SetScale(Gf.Vec3f(0.5, 0.5 * height, 0.5))
    for i in range(lamps):
        lamp = UsdLux.SphereLight.Define(stage, f"/Lamp{i}")
        lamp.CreateRadiusAttr(0.05)
        lamp.CreateIntensityAttr(POWER / lamps / 0.05**2)
        at = Gf.Vec3d(place.uniform(-SIZE, SIZE), place.uniform(1.0, 5.0), place.uniform(-SIZE, SIZE))
        UsdGeom.XformCommonAPI(lamp).SetTranslate(at)
    camera = UsdGeom.Camera.Define(stage, "/Camera")
    camera.CreateFocalLengthAttr(18.0)
    UsdGeom.XformCommonAPI(camera).SetTranslate(Gf.Vec3d(0, 12, SIZE))
    UsdGeom.XformCommonAPI(camera).SetRotate(Gf.Vec3f(-15, 0, 0))
    return stage


def session_of(lamps: int) -> Session:
    """A session that has the scene."""
    stage = stage_of(lamps)
    session = Session()
    session.set("enableInteractive", "false")
    session.camera(read_camera(UsdGeom.Camera.Get(stage, "/Camera"), Usd.TimeCode.EarliestTime()))
    session.purposes(["render"])
    feed(session, read_stage(stage, Usd.TimeCode.EarliestTime(), frozenset({"render"}), print))
    session.set_film(WIDTH, HEIGHT, ["color"])
    return session


def main() -> None:
    """Prints one line a count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", nargs="*", type=int, default=[10, 100, 1000, 10_000])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--samples", type=int, default=32)
    arguments = parser.parse_args()
    sessions = {count: session_of(count) for count in arguments.counts}
    seconds: dict[int, list[float]] = {count: [] for count in sessions}
    for seed in range(arguments.rounds):
        for count, session in sessions.items():
            _, stats = render(session, seed, arguments.samples, -1.0)
            seconds[count].append(stats["renderSeconds"])
    first = arguments.counts[0]
    for count, times in seconds.items():
        per_sample = statistics.median(times) / (WIDTH * HEIGHT * arguments.samples)
        ratio = statistics.median(t / of_first for t, of_first in zip(times, seconds[first], strict=True))
        print(f"{count} lamps: {per_sample * 1e9:.0f} ns a sample, {ratio:.2f} of the time with {first}", flush=True)


if __name__ == "__main__":
    main()
