"""Measures what docs/speed-and-accuracy.md shows, but for the stability of rays: `cargo xtask bench report`.

    report.py OUT.json --known docs/charts/report.json [--scene chess ...] [--rounds 3] [--only scenes] [...]

Every scene as in `measure.py`, then what its parts cost (`parsimony.py`), then what unused features cost. What is not
measured now is taken over from the record that is known. OUT.json is written after every scene.
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
from pathlib import Path
from typing import Any

import parsimony
from measure import add_arguments, find_renderers, measure, processor, show
from merge import merged
from processes import Renderer
from scenes import SCENES, SHARED, Scene

# The rest are `cargo xtask bench report`'s: it calls this for these two.
PARTS = ["scenes", "parsimony", "stability", "document"]
# Samples a pixel of each half of a reference that is rendered here: Mitsuba's, and Cycles' own.
OWN_REFERENCE_SAMPLES, CYCLES_REFERENCE_SAMPLES = 512, 128
# Seconds that one picture may take: larger counts of that method are left out. Three rounds of seven scenes then
# take a quarter of an hour at most.
LONGEST = 4.5
UNUSED_ROUNDS = 75
COST_SAMPLES, UNUSED_SAMPLES, UNUSED_SIZE = 4, 1, (128, 128)


def arguments_given() -> argparse.Namespace:
    """What the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_arguments(parser, SCENES, OWN_REFERENCE_SAMPLES, CYCLES_REFERENCE_SAMPLES)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--unused-rounds", type=int, default=UNUSED_ROUNDS, help="of the cost of unused features")
    parser.add_argument("--longest", type=float, default=LONGEST, metavar="SECONDS", help="that one picture may take")
    parser.add_argument("--only", choices=PARTS, nargs="+", default=PARTS)
    parser.add_argument("--known", type=Path, help="a record to take over what is not measured now")
    return parser.parse_args()


def command_of(arguments: argparse.Namespace) -> str:
    """What to call to measure the same again."""
    words = []
    if len(arguments.scene) < len(SCENES):
        words.append(f"--scene {' '.join(arguments.scene)}")
    words.append(f"--rounds {arguments.rounds}")
    if arguments.samples != [4, 16, 64, 256]:
        words.append(f"--samples {' '.join(map(str, arguments.samples))}")
    if arguments.own_reference != OWN_REFERENCE_SAMPLES:
        words.append(f"--own-reference {arguments.own_reference}")
    if arguments.cycles_reference != CYCLES_REFERENCE_SAMPLES:
        words.append(f"--cycles-reference {arguments.cycles_reference}")
    if arguments.longest != LONGEST:
        words.append(f"--longest {arguments.longest:g}")
    if arguments.unused_rounds != UNUSED_ROUNDS:
        words.append(f"--unused-rounds {arguments.unused_rounds}")
    if arguments.only != PARTS:
        words.append(f"--only {' '.join(arguments.only)}")
    return f"cargo xtask bench report {' '.join(words)}"


class Recorder:
    """The record, written whenever a part is added."""

    def __init__(self, out: Path, known: Path | None) -> None:
        self._out = out
        self._record: dict[str, Any] = json.loads(known.read_text()) if known and known.exists() else {}

    def add(self, part: dict[str, Any]) -> None:
        """Takes a part in."""
        self._record = merged(self._record, part, [scene.name for scene in SCENES])
        self._out.write_text(json.dumps(self._record, indent=2) + "\n")


def measure_scene(
    scene: Scene, renderers: list[Renderer], absent: list[str], arguments: argparse.Namespace, about: dict[str, Any]
) -> dict[str, Any]:
    """A scene's part of the record."""
    cache = arguments.out.parent / "report"
    part: dict[str, Any] = {}
    if "scenes" in arguments.only:
        measured = measure(scene, renderers, arguments, cache) | about
        measured["absent"] = absent + measured["absent"]
        show(measured)
        part["scenes"] = [measured]
    if "parsimony" in arguments.only:
        stage = scene.stage(cache / "stages")
        part["costs"] = [
            {"name": scene.name, **parsimony.costs(stage, scene.size, COST_SAMPLES, arguments.rounds), **about}
        ]
    return part


def main() -> None:
    """Measures, prints, writes the record."""
    arguments = arguments_given()
    renderers, absent = find_renderers(arguments)
    about = {
        "processor": processor(),
        "commit": arguments.commit,
        "command": command_of(arguments),
        "rounds": arguments.rounds,
        "date": datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
    }
    recorder = Recorder(arguments.out, arguments.known)
    recorder.add({})
    for scene in (scene for scene in SCENES if scene.name in arguments.scene):
        if scene.source is not None and not scene.source.exists():
            print(f"{scene.name} is not measured, for want of {scene.source}", flush=True)
            continue
        recorder.add(measure_scene(scene, renderers, absent, arguments, about))
    room = SHARED / "scenes/cornell.usda"
    if "parsimony" in arguments.only and room.exists():
        rooms = arguments.out.parent / "report/rooms"
        unused = parsimony.unused(room, rooms, UNUSED_SIZE, UNUSED_SAMPLES, arguments.unused_rounds)
        recorder.add({"unused": unused | {**about, "rounds": arguments.unused_rounds}})
        for row in unused["features"]:
            print(f"unused: {row['name']}: {row['ratio']:.3f} ({row['quartiles'][0]:.3f} to {row['quartiles'][1]:.3f})")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
