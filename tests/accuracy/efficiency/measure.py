"""Error over time, beside other path tracers: `cargo xtask bench efficiency`.

    measure.py OUT.json [--scene cornell ...] [--rounds 5] [--samples 4 16 64 256] [--mitsuba PYTHON] [--cycles PYTHON]

Every renderer loads a scene in a process of its own and stays; in every round each takes a picture at each sample
count, in turn, so that all meet the same moods of the machine. All have the same stage, camera and size, at most eight
scattering events, a box filter of one pixel, all cores, no clamps and no denoising. What counts is the median over the
rounds. Time is that of rendering alone, as each renderer's own call takes; `from_start_seconds` is that from the start
of a process until its first picture. Efficiency is 1 / (error x seconds). For errors see `errors.py`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import statistics
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from errors import Truth, own_truth
from processes import Picture, Renderer, Side, Taken

SHARED = Path(__file__).parents[4] / "shared"
SCENES = {"cornell": (256, 256), "metal": (320, 180), "many_lights": (320, 180)}
# Sample count whose time and error the renderers are compared at.
COMPARED = 64
# No adaptive picture has more.
LARGEST = 1 << 14
MITSUBA, CYCLES = "Mitsuba", "Cycles"
# Of Cycles' own reference, in two halves; and the most of its pictures, which take long.
OWN_REFERENCE_SAMPLES = 512
CYCLES_LARGEST = 64


@dataclass(frozen=True)
class Mode:
    """A way of Umber's to render. What its settings leave out is as a session has it."""

    name: str
    settings: dict[str, str] = field(default_factory=dict)
    # counts by `convergedVariance`: where equal counts of that number lead
    adaptive: bool = False
    # with fewer samples it would do the same as equal counts
    least_samples: int = 1


MODES = [
    Mode("Umber"),
    Mode("Umber, adaptive", adaptive=True, least_samples=32),
]


@dataclass
class Method:
    """A line of the chart: a renderer in one mode, and its pictures by sample count."""

    name: str
    side: Side
    truth: Truth
    counts: list[int]
    mode: Mode | None = None
    taken: dict[int, list[Taken]] = field(default_factory=dict)
    from_start_seconds: float = 0.0

    def median_error(self, count: int) -> float:
        """Over the rounds so far."""
        return statistics.median(self.truth.error(taken.picture) for taken in self.taken[count])

    def median_seconds(self, count: int) -> float:
        """Over the rounds so far."""
        return statistics.median(taken.seconds for taken in self.taken[count])

    def points(self) -> list[dict[str, Any]]:
        """For the record."""
        return [self._point(count) for count in self.counts if count in self.taken]

    def _point(self, count: int) -> dict[str, Any]:
        taken = self.taken[count]
        errors = [self.truth.error(t.picture) for t in taken]
        efficiencies = [1.0 / (error * t.seconds) for error, t in zip(errors, taken, strict=True)]
        pixels = taken[0].picture.shape[0] * taken[0].picture.shape[1]
        return {
            "nominal_samples": count,
            "samples": statistics.median(t.samples for t in taken),
            "seconds": statistics.median(t.seconds for t in taken),
            "error": statistics.median(errors),
            "rel_mse": statistics.median(self.truth.rel_mse(t.picture) for t in taken),
            "efficiency": statistics.median(efficiencies),
            "efficiency_by_round": efficiencies,
            "msamples_per_second": statistics.median(pixels * t.samples / t.seconds / 1e6 for t in taken),
        }


def error_after(method: Method, seconds: float) -> float:
    """A method's error after so long, on the line through its points on log axes; beyond its ends, that goes on."""
    known = sorted((method.median_seconds(c), method.median_error(c)) for c in method.taken)
    if len(known) == 1:
        return known[0][1] * known[0][0] / seconds  # error goes with one over the time
    times, errors = (np.log(column) for column in np.array(known).T)
    at = int(np.clip(np.searchsorted(times, np.log(seconds)), 1, len(known) - 1))
    slope = (errors[at] - errors[at - 1]) / (times[at] - times[at - 1])
    return float(np.exp(errors[at] + slope * (np.log(seconds) - times[at])))


def take(method: Method, count: int, seed: int, umber: Method) -> None:
    """One picture more of a method. `umber`: that of equal counts, which has had its turn."""
    if method.mode is None:
        made = method.side.take(count, seed)
    else:
        settings = {"convergedVariance": "-1", **method.mode.settings}
        samples = count
        if method.mode.adaptive:
            # the setting's estimate is a cautious one: about twice the error that comes out
            settings["convergedVariance"] = str(2.0 * umber.median_error(count))
            samples = LARGEST
        made = method.side.take(samples, seed, set=settings)
    method.taken.setdefault(count, []).append(made)


def methods_of(scene: str, renderers: list[Renderer], counts: list[int], cache: Path, own_samples: int) -> list[Method]:
    """Every line of a scene's chart, its renderers started; each has made a first picture."""
    stage, size = SHARED / "scenes" / f"{scene}.usda", SCENES[scene]
    truth = Truth(np.load(SHARED / "reference/mitsuba" / f"{scene}.npy")[..., :3].astype(np.float64))
    methods: list[Method] = []
    for renderer in renderers:
        side = Side.start(renderer, stage, size)
        if side is None:
            if not methods:
                sys.exit("there is nothing to measure without Umber")
            continue
        # the first picture ends what is done once: compiling the scene, or kernels
        first = side.take(COMPARED, 1, **({"set": {}} if renderer.name == "Umber" else {}))
        from_start = side.start_seconds + first.seconds
        print(f"{scene}: {side.about}: first picture after {from_start:.2f} s", flush=True)
        if renderer.name == "Umber":
            for mode in MODES:
                usable = [count for count in counts if count >= mode.least_samples]
                methods.append(Method(mode.name, side, truth, usable, mode, from_start_seconds=from_start))
        elif renderer.name == CYCLES:
            key = hashlib.sha256(stage.read_bytes() + side.about.encode()).hexdigest()[:12]
            own = own_truth(side, cache / f"{scene}-{own_samples}-{key}.npy", own_samples)
            usable = [count for count in counts if count <= CYCLES_LARGEST]
            methods.append(Method(renderer.name, side, own, usable, from_start_seconds=from_start))
        else:
            methods.append(Method(renderer.name, side, truth, counts, from_start_seconds=from_start))
    return methods


def measure(scene: str, renderers: list[Renderer], arguments: argparse.Namespace) -> dict[str, Any]:
    """All rounds of a scene."""
    counts = sorted({*arguments.samples, COMPARED})
    cache = Path(arguments.out).parent / "efficiency"
    methods = methods_of(scene, renderers, counts, cache, arguments.own_reference)
    umber = methods[0]
    for round_number in range(arguments.rounds):
        for count in counts:
            for method in methods:
                if count in method.counts:
                    take(method, count, 1000 * (round_number + 1) + count, umber)
    for side in {id(method.side): method.side for method in methods}.values():
        side.end()
    for method in methods:
        if method.name == MITSUBA:
            largest: list[Picture] = [taken.picture for taken in method.taken[method.counts[-1]]]
            umber.truth.learn_noise(largest)
    return {
        "name": scene,
        "width": SCENES[scene][0],
        "height": SCENES[scene][1],
        "reference_noise": umber.truth.noise,
        "methods": [
            {
                "name": method.name,
                "about": method.side.about,
                "own_reference": method.truth is not umber.truth,
                "reference_noise": method.truth.noise,
                "from_start_seconds": method.from_start_seconds,
                "points": method.points(),
            }
            for method in methods
        ],
        "ratios": ratios(methods),
        "absent": [renderer.name for renderer in renderers if all(m.side.renderer != renderer for m in methods)],
    }


def ratios(methods: list[Method]) -> list[dict[str, Any]]:
    """Every mode of Umber's beside every peer: both errors in the time that the peer takes."""
    rows = []
    for peer in (method for method in methods if method.mode is None):
        seconds, error = peer.median_seconds(COMPARED), peer.median_error(COMPARED)
        for ours in (method for method in methods if method.mode is not None and method.taken):
            error_ours = error_after(ours, seconds)
            longest = max(ours.median_seconds(count) for count in ours.taken)
            rows.append(
                {
                    "mode": ours.name,
                    "peer": peer.name,
                    "seconds": seconds,
                    "error_peer": error,
                    "error": error_ours,
                    "ratio": error / error_ours,
                    "beyond_measured": seconds > longest,
                }
            )
    return rows


def show(scene: dict[str, Any]) -> None:
    """A scene's figures, as lines."""
    for method in scene["methods"]:
        own = " (error against its own reference)" if method["own_reference"] else ""
        print(f"{scene['name']}: {method['name']}{own}: first picture after {method['from_start_seconds']:.2f} s")
        for point in method["points"]:
            print(
                f"  {point['samples']:8.1f} samples {point['seconds']:8.3f} s   error {point['error']:.3e}   "
                f"efficiency {point['efficiency']:8.2f}   {point['msamples_per_second']:6.2f} M samples/s"
            )
    for row in scene["ratios"]:
        beyond = ", beyond what was measured" if row["beyond_measured"] else ""
        print(
            f"  {row['mode']} beside {row['peer']}: in its {row['seconds']:.2f} s for {COMPARED} samples, "
            f"{row['ratio']:.2f} times as efficient{beyond}"
        )
    sys.stdout.flush()


def processor() -> str:
    """Its name, and how many cores are there."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [line.split(": ", 1)[1] for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.processor() or platform.machine()}, {os.cpu_count()} cores"


def main() -> None:
    """Measures, prints, writes the record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", help="the record, JSON")
    parser.add_argument("--scene", nargs="+", choices=list(SCENES), default=list(SCENES))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--samples", nargs="+", type=int, default=[4, 16, 64, 256])
    parser.add_argument(
        "--own-reference",
        type=int,
        default=OWN_REFERENCE_SAMPLES,
        metavar="SAMPLES",
        help="of each half of Cycles' reference",
    )
    parser.add_argument("--mitsuba", metavar="PYTHON", help="an interpreter that has it")
    parser.add_argument("--cycles", metavar="PYTHON", help="an interpreter that has Blender as a module")
    parser.add_argument("--commit", default="unknown")
    arguments = parser.parse_args()
    if not (SHARED / "reference/mitsuba").exists():
        sys.exit(f"nothing to measure with: no {SHARED / 'reference/mitsuba'}")
    absent: list[str] = []
    renderers = [Renderer("Umber", "umber_side.py", sys.executable)]
    for name, script, python in [
        (MITSUBA, "mitsuba_side.py", arguments.mitsuba),
        (CYCLES, "cycles_side.py", arguments.cycles),
    ]:
        if python:
            renderers.append(Renderer(name, script, python))
        else:
            print(f"{name} takes no part: it is not installed", flush=True)
            absent.append(f"{name}: not installed")
    words = [f"--scene {' '.join(arguments.scene)}"] if arguments.scene != list(SCENES) else []
    words += [f"--rounds {arguments.rounds}", f"--samples {' '.join(map(str, arguments.samples))}"]
    if arguments.own_reference != OWN_REFERENCE_SAMPLES:
        words.append(f"--own-reference {arguments.own_reference}")
    record: dict[str, Any] = {
        "processor": processor(),
        "commit": arguments.commit,
        "command": f"cargo xtask bench efficiency {' '.join(words)}",
        "rounds": arguments.rounds,
        "scenes": [],
    }
    for scene in arguments.scene:
        measured = measure(scene, renderers, arguments)
        measured["absent"] = absent + [f"{name}: did not start" for name in measured["absent"]]
        record["scenes"].append(measured)
        show(record["scenes"][-1])
        Path(arguments.out).write_text(json.dumps(record, indent=2) + "\n")


if __name__ == "__main__":
    main()
