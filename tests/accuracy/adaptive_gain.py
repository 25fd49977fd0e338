"""What adaptive sampling buys: time to the same error as with equal counts.

    python tests/accuracy/adaptive_gain.py [cornell metal chess] [--rounds 3] [--samples 64 128 256]

For every scene, renders with equal counts and with targets of the error (`convergedVariance`), in turn, and reads off
the time that equal counts would take to each adaptive picture's error, between the two nearest measured ones.
Error is relMSE = mean((x - ref)^2 / (ref^2 + e^2)), e = 1 % of the reference's mean luminance; time is that of
rendering alone. The references of cornell and metal are Mitsuba's; chess, whose materials it does not read, has one
of equal counts of another seed, rendered here once.
"""

from __future__ import annotations

import argparse
import statistics
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

SHARED = Path(__file__).parents[3] / "shared"
SCENES = {
    "cornell": ("scenes/cornell.usda", 256, 256),
    "many_lights": ("scenes/many_lights.usda", 320, 180),
    "metal": ("scenes/metal.usda", 320, 180),
    "chess": ("assets/usdwg/full_assets/OpenChessSet/chess_set_cam.usda", 320, 180),
}
REFERENCE_SAMPLES = 2048
REFERENCE_SEED = 4_000_000_000
LARGEST = 1 << 14
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
Picture = NDArray[np.float64]


def load(name: str) -> Session:
    """A session that has the scene."""
    path, width, height = SCENES[name]
    stage = Usd.Stage.Open(str(SHARED / path))
    cameras = [UsdGeom.Camera(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera)]
    session = Session()
    session.set("enableInteractive", "false")
    session.camera(read_camera(cameras[0], Usd.TimeCode.EarliestTime()))
    session.purposes(["render"])
    feed(session, read_stage(stage, Usd.TimeCode.EarliestTime(), frozenset({"render"}), print))
    session.set_film(width, height, ["color"])
    return session


def render(session: Session, seed: int, samples: int, variance: float) -> tuple[Picture, dict[str, float]]:
    """The picture and its figures. A negative variance: equal counts."""
    session.set("umber:seed", str(seed))
    session.set("convergedSamplesPerPixel", str(samples))
    session.set("convergedVariance", str(variance))
    session.start()
    while not session.wait(10.0):
        pass
    return session.resolve("color")[..., :3].astype(np.float64), session.stats()


def reference(name: str, session: Session) -> Picture:
    """What is held to be true."""
    file = SHARED / "reference/mitsuba" / f"{name}.npy"
    if file.exists():
        return np.load(file).astype(np.float64)
    return render(session, REFERENCE_SEED, REFERENCE_SAMPLES, -1.0)[0]


def rel_mse(picture: Picture, truth: Picture) -> float:
    """See the module's text."""
    floor = 0.01 * (truth @ LUMINANCE).mean()
    return float(((picture - truth) ** 2 / (truth**2 + floor**2)).mean())


def main() -> None:
    """Prints one line a scene and target."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", choices=[[], *SCENES], default=[])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--samples", nargs="+", type=int, default=[32, 64, 128, 256])
    arguments = parser.parse_args()
    for name in arguments.scenes or SCENES:
        session = load(name)
        truth = reference(name, session)
        counts = arguments.samples
        equal = [[(0.0, 0.0)] * arguments.rounds for _ in counts]
        for i, count in enumerate(counts):
            for seed in range(arguments.rounds):
                picture, stats = render(session, seed, count, -1.0)
                equal[i][seed] = (rel_mse(picture, truth), stats["renderSeconds"])
        errors = [statistics.fmean(e for e, _ in row) for row in equal]
        seconds = [statistics.median(s for _, s in row) for row in equal]
        for count, error, time in zip(counts, errors, seconds, strict=True):
            print(f"{name}: {count} samples a pixel: relMSE {error:.3e}, {time:.2f} s", flush=True)
        for target in errors[1:-1]:
            found = [render(session, seed, LARGEST, target) for seed in range(arguments.rounds)]
            error = statistics.fmean(rel_mse(picture, truth) for picture, _ in found)
            time = statistics.median(stats["renderSeconds"] for _, stats in found)
            samples = statistics.median(stats["meanSamples"] for _, stats in found)
            measured = statistics.fmean(stats["relativeVariance"] for _, stats in found)
            line = np.polyfit(np.log(errors), np.log(seconds), 1)
            wanted = float(np.exp(np.polyval(line, np.log(error))))
            print(
                f"{name}: target {target:.3e}: relMSE {error:.3e} (own estimate {measured:.3e}), "
                f"{samples:.1f} samples a pixel, {time:.2f} s: {time / wanted:.2f} of the time of equal counts",
                flush=True,
            )


if __name__ == "__main__":
    main()
