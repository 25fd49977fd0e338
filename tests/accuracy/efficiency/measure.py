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
import math
import os
import platform
import statistics
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from errors import Truth, own_truth
from front import on_front
from modes import MODES, Mode, plain_settings
from processes import Picture, Renderer, Side, Taken
from scenes import GIVEN, SHARED, Scene

# Sample count whose time and error the renderers are compared at.
COMPARED = 64
# The estimate of adaptive sampling is a cautious one: at least twice the error that comes out.
LEAST_CAUTION = 2.0
# Samples at which is found out how cautious it is.
CALIBRATED = 32
# No adaptive picture has more.
LARGEST = 1 << 14
UMBER, MITSUBA, CYCLES = "Umber", "Mitsuba", "Cycles"
# Of Cycles' own reference, in two halves; and the most of its pictures, which take long.
OWN_REFERENCE_SAMPLES = 512
CYCLES_LARGEST = 64
OWN_TRUTH = "Umber's own long picture of another seed: says nothing of bias"


@dataclass
class Method:
    """A line of the chart: a renderer in one mode, and its pictures by sample count."""

    name: str
    side: Side
    truth: Truth
    counts: list[int]
    reference: str = ""
    mode: Mode | None = None
    # adaptive: the variance that is asked for, over the error of equal counts of as many samples
    caution: float = LEAST_CAUTION
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
        settings = plain_settings() | method.mode.settings
        samples = count
        if method.mode.adaptive:
            settings["convergedVariance"] = str(method.caution * umber.median_error(count))
            samples = LARGEST
        made = method.side.take(samples, seed, set=settings)
    method.taken.setdefault(count, []).append(made)


def reference_of(scene: Scene, sides: list[Side], cache: Path, samples: int) -> tuple[Truth, str]:
    """What is true of a scene, and who says so.

    Mitsuba's picture that is kept, one that it renders now, or, where it takes no part, Umber's own of other seeds.
    """
    if scene.reference is not None:
        return Truth(np.load(scene.reference)[..., :3].astype(np.float64)), "Mitsuba's reference"
    mitsuba = [side for side in sides if side.renderer.name == MITSUBA]
    judge = mitsuba[0] if mitsuba else sides[0]
    samples = min(samples, scene.reference_samples)
    truth = own_truth(
        judge, cache / f"{scene.name}-{judge.renderer.name}-{samples}-{key_of(scene, judge, cache)}.npy", samples
    )
    return truth, f"{judge.about}, 2 x {samples} samples a pixel" if mitsuba else OWN_TRUTH


def key_of(scene: Scene, side: Side, folder: Path) -> str:
    """Another one for another stage, size or version of the renderer."""
    what = scene.stage(folder / "stages").read_bytes() + f"{side.about}{scene.size}".encode()
    return hashlib.sha256(what).hexdigest()[:12]


def start(scene: Scene, renderers: list[Renderer], cache: Path) -> list[Side]:
    """A process a renderer that takes part, Umber's first."""
    stage = scene.stage(cache / "stages")
    taking_part = [renderer for renderer in renderers if renderer.name not in scene.left_out]
    sides = [side for renderer in taking_part if (side := Side.start(renderer, stage, scene.size))]
    if not sides or sides[0].renderer.name != UMBER:
        sys.exit("there is nothing to measure without Umber")
    return sides


def methods_of(
    scene: Scene, sides: list[Side], counts: list[int], cache: Path, own_samples: int, cycles_samples: int
) -> list[Method]:
    """Every line of a scene's chart; each has made a first picture."""
    from_start: dict[str, float] = {}
    for side in sides:
        # the first picture ends what is done once: compiling the scene, or kernels
        first = side.take(COMPARED, 1, **({"set": {}} if side.renderer.name == UMBER else {}))
        from_start[side.renderer.name] = side.start_seconds + first.seconds
        print(f"{scene.name}: {side.about}: first picture after {from_start[side.renderer.name]:.2f} s", flush=True)
    truth, said = reference_of(scene, sides, cache, own_samples)
    methods: list[Method] = []
    for side in sides:
        name = side.renderer.name
        about = Method(name, side, truth, counts, reference=said, from_start_seconds=from_start[name])
        if name == UMBER:
            for mode in (mode for mode in MODES if mode.is_known):
                usable = [count for count in counts if count >= mode.least_samples]
                methods.append(replace(about, name=mode.name, mode=mode, counts=usable, taken={}))
        elif name == CYCLES and scene.same_in_cycles and said != OWN_TRUTH:
            methods.append(replace(about, counts=[count for count in counts if count <= CYCLES_LARGEST]))
        elif name == CYCLES:
            file = cache / f"{scene.name}-{name}-{cycles_samples}-{key_of(scene, side, cache)}.npy"
            usable = [count for count in counts if count <= CYCLES_LARGEST]
            own = own_truth(side, file, cycles_samples)
            said_own = f"its own, 2 x {cycles_samples} samples a pixel"
            methods.append(replace(about, truth=own, counts=usable, reference=said_own))
        else:
            methods.append(about)
    return methods


def calibrate(methods: list[Method]) -> None:
    """Finds what adaptive modes have to be asked for, to take about as many samples as equal counts do."""
    plain = replace(methods[0], taken={})
    for method in (method for method in methods if method.mode is not None and method.mode.adaptive):
        if not plain.taken:
            take(plain, CALIBRATED, 7, plain)
        tried = replace(method, taken={})
        take(tried, CALIBRATED, 7, plain)
        method.caution *= max(tried.taken[CALIBRATED][0].samples / CALIBRATED, 1.0)


def take_rounds(methods: list[Method], counts: list[int], rounds: int, longest: float) -> None:
    """All rounds. Counts that would take a method longer than `longest` seconds a picture are left out."""
    for count in counts:
        for method in methods:
            if (
                count in method.counts
                and _expected_seconds(method, count) <= longest
                and _has_target(method, count, methods)
            ):
                take(method, count, 1000 + count, methods[0])
    for round_number in range(1, rounds):
        for count in counts:
            for method in (method for method in methods if count in method.taken):
                take(method, count, 1000 * (round_number + 1) + count, methods[0])


def _has_target(method: Method, count: int, methods: list[Method]) -> bool:
    """Whether an adaptive mode knows the error to ask for."""
    return method.mode is None or not method.mode.adaptive or count in methods[0].taken


def _expected_seconds(method: Method, count: int) -> float:
    """From its pictures of the next smaller number of samples."""
    if not method.taken:
        return 0.0
    return method.median_seconds(max(method.taken)) * count / max(method.taken)


def measure(scene: Scene, renderers: list[Renderer], arguments: argparse.Namespace, cache: Path) -> dict[str, Any]:
    """All rounds of a scene."""
    counts = sorted({*arguments.samples, COMPARED})
    sides = start(scene, renderers, cache)
    methods = methods_of(scene, sides, counts, cache, arguments.own_reference, arguments.cycles_reference)
    calibrate(methods)
    take_rounds(methods, counts, arguments.rounds, arguments.longest)
    for side in sides:
        side.end()
    umber_method = methods[0]
    for method in methods:
        if method.name == MITSUBA and scene.reference is not None:
            largest: list[Picture] = [taken.picture for taken in method.taken[max(method.taken)]]
            umber_method.truth.learn_noise(largest)
    lines = [method.points() for method in methods]
    # what is measured against another truth is not compared
    for mine in {id(method.truth): method.truth for method in methods}.values():
        points = [p for method, line in zip(methods, lines, strict=True) if method.truth is mine for p in line]
        best = on_front([(point["seconds"], point["error"]) for point in points])
        for point, is_best in zip(points, best, strict=True):
            point["on_front"] = is_best and mine is umber_method.truth
    absent = [r.name for r in renderers if r.name not in scene.left_out and all(s.renderer != r for s in sides)]
    return {
        "name": scene.name,
        "width": scene.size[0],
        "height": scene.size[1],
        "reference": umber_method.reference,
        "reference_noise": umber_method.truth.noise,
        "methods": [
            {
                "name": method.name,
                "about": method.side.about,
                "own_reference": method.truth is not umber_method.truth,
                "reference": method.reference,
                "reference_noise": method.truth.noise,
                "from_start_seconds": method.from_start_seconds,
                "points": points,
            }
            for method, points in zip(methods, lines, strict=True)
        ],
        "ratios": ratios(methods),
        "absent": [f"{name}: {why}" for name, why in scene.left_out.items()]
        + [f"{name}: did not start" for name in absent],
    }


def ratios(methods: list[Method]) -> list[dict[str, Any]]:
    """Every mode of Umber's beside every peer: both errors in the time that the peer takes."""
    rows = []
    for peer in (method for method in methods if method.mode is None):
        compared = max((count for count in peer.taken if count <= COMPARED), default=0)
        if not compared:
            continue
        seconds, error = peer.median_seconds(compared), peer.median_error(compared)
        for ours in (method for method in methods if method.mode is not None and method.taken):
            error_ours = error_after(ours, seconds)
            longest = max(ours.median_seconds(count) for count in ours.taken)
            rows.append(
                {
                    "mode": ours.name,
                    "peer": peer.name,
                    "samples": compared,
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
            f"  {row['mode']} beside {row['peer']}: in its {row['seconds']:.2f} s for {row['samples']} samples, "
            f"{row['ratio']:.2f} times as efficient{beyond}"
        )
    sys.stdout.flush()


def processor() -> str:
    """Its name, and how many cores are there."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [line.split(": ", 1)[1] for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.processor() or platform.machine()}, {os.cpu_count()} cores"


def add_arguments(
    parser: argparse.ArgumentParser, scenes: list[Scene], own_reference: int, cycles_reference: int
) -> None:
    """What both this and the report take."""
    names = [scene.name for scene in scenes]
    parser.add_argument("out", type=Path, help="the record, JSON")
    parser.add_argument("--scene", nargs="+", choices=names, default=names)
    parser.add_argument("--samples", nargs="+", type=int, default=[4, 16, 64, 256])
    parser.add_argument(
        "--own-reference",
        type=int,
        default=own_reference,
        metavar="SAMPLES",
        help="of each half of a reference that is rendered here",
    )
    parser.add_argument(
        "--cycles-reference", type=int, default=cycles_reference, metavar="SAMPLES", help="of each half of Cycles' own"
    )
    parser.add_argument("--mitsuba", metavar="PYTHON", help="an interpreter that has it")
    parser.add_argument("--cycles", metavar="PYTHON", help="an interpreter that has Blender as a module")
    parser.add_argument("--commit", default="unknown")


def find_renderers(arguments: argparse.Namespace) -> tuple[list[Renderer], list[str]]:
    """Those that take part, Umber first, and what is to be said of the others."""
    absent: list[str] = []
    renderers = [Renderer(UMBER, "umber_side.py", sys.executable)]
    for name, script, python in [
        (MITSUBA, "mitsuba_side.py", arguments.mitsuba),
        (CYCLES, "cycles_side.py", arguments.cycles),
    ]:
        if python:
            renderers.append(Renderer(name, script, python))
        else:
            print(f"{name} takes no part: it is not installed", flush=True)
            absent.append(f"{name}: not installed")
    return renderers, absent


def main() -> None:
    """Measures, prints, writes the record."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_arguments(parser, GIVEN, OWN_REFERENCE_SAMPLES, OWN_REFERENCE_SAMPLES)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    arguments.longest = math.inf
    if not (SHARED / "reference/mitsuba").exists():
        sys.exit(f"nothing to measure with: no {SHARED / 'reference/mitsuba'}")
    renderers, absent = find_renderers(arguments)
    words = [f"--scene {' '.join(arguments.scene)}"] if len(arguments.scene) < len(GIVEN) else []
    words += [f"--rounds {arguments.rounds}", f"--samples {' '.join(map(str, arguments.samples))}"]
    if arguments.cycles_reference != OWN_REFERENCE_SAMPLES:
        words.append(f"--cycles-reference {arguments.cycles_reference}")
    about = {
        "processor": processor(),
        "commit": arguments.commit,
        "command": f"cargo xtask bench efficiency {' '.join(words)}",
        "rounds": arguments.rounds,
    }
    record: dict[str, Any] = {**about, "scenes": []}
    for scene in (scene for scene in GIVEN if scene.name in arguments.scene):
        measured = measure(scene, renderers, arguments, arguments.out.parent / "efficiency") | about
        measured["absent"] = absent + measured["absent"]
        record["scenes"].append(measured)
        show(record["scenes"][-1])
        arguments.out.write_text(json.dumps(record, indent=2) + "\n")


if __name__ == "__main__":
    main()
