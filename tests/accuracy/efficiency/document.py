"""Writes docs/speed-and-accuracy.md from its template and what was measured.

    document.py CHARTS OUT.md

CHARTS holds report.json and stability.json. What was not measured is said to be so; no place is left unfilled.
"""

from __future__ import annotations

import json
import string
import sys
from pathlib import Path
from typing import Any

TEMPLATE = Path(__file__).with_name("speed-and-accuracy.template.md")
NO_MEASURE = "\N{EN DASH}"
NOT_YET = "*Not measured yet.*"
Record = dict[str, Any]


def caption(record: Record) -> str:
    """Machine, commit and command."""
    return f"*{record['processor']}; commit {record['commit']}; `{record['command']}`*"


def table(head: list[str], rows: list[list[str]]) -> str:
    """A Markdown table; the first column is text, the others are figures."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def machines(scenes: list[Record]) -> str:
    """Where, when and at which commits it was measured."""
    if not scenes:
        return NOT_YET
    groups: dict[tuple[str, str, str, int], list[str]] = {}
    for scene in scenes:
        key = (scene["processor"], scene["commit"], scene["date"], scene["rounds"])
        groups.setdefault(key, []).append(scene["name"])
    lines = [
        f"- {', '.join(names)}: {date}, {processor}, commit {commit}, median of {rounds} rounds"
        for (processor, commit, date, rounds), names in groups.items()
    ]
    return "What stands here was measured:\n\n" + "\n".join(lines)


def absent(scenes: list[Record]) -> str:
    """Who took no part where, and why."""
    groups: dict[str, list[str]] = {}
    for scene in scenes:
        for why in scene["absent"]:
            groups.setdefault(why, []).append(scene["name"])
    lines = [
        f"- {why} ({'all scenes' if len(names) == len(scenes) else ', '.join(names)})" for why, names in groups.items()
    ]
    return "Who takes no part:\n\n" + "\n".join(lines) if lines else "All peers take part everywhere."


def charts(scenes: list[Record]) -> str:
    """A heading, the chart and its caption a scene."""
    parts = []
    for scene in scenes:
        rounds = f"median of {scene['rounds']} rounds" if scene["rounds"] > 1 else "one round"
        parts.append(
            f"### {scene['name']}\n\n![{scene['name']}: error over time](charts/report_{scene['name']}.svg)\n\n"
            f"{caption(scene)}, {rounds}. Against {scene['reference']}; "
            f"its noise, {scene['reference_noise']:.1e}, is taken off."
        )
    return "\n\n".join(parts) if parts else NOT_YET


def ratios(scenes: list[Record]) -> str:
    """How Umber's modes stand beside the peers."""
    rows = [
        [
            scene["name"],
            row["mode"],
            row["peer"],
            f"{row['seconds']:.2f} s ({row['samples']})",
            # more error than picture: no measure of anything
            NO_MEASURE if row["error_peer"] > 1 else f"{row['ratio']:.2f}" + (" *" if row["beyond_measured"] else ""),
        ]
        for scene in scenes
        for row in scene["ratios"]
    ]
    if not rows:
        return NOT_YET
    head = ["scene", "mode", "beside", "its time (samples a pixel)", "its error over Umber's in that time"]
    note = (
        f"\n\n{NO_MEASURE}: the peer's error is larger than its picture. "
        "\\* beyond the times that were measured: the line goes on as it ends."
    )
    return table(head, rows) + (note if any(row[-1].endswith("*") for row in rows) else "")


def failures(stability: Record, name: str) -> str:
    """The worst of each series of a figure, as a sentence a panel."""
    figure = next((f for f in stability.get("figures", []) if f["name"] == name), None)
    if figure is None:
        return NOT_YET
    lines = []
    for panel in figure["panels"]:
        worst = []
        for series in panel["series"]:
            point = max(series["points"], key=lambda p: p["failures"] / max(p["rays"], 1))
            at = f", at {point['x']:.0e}" if point["failures"] else ""
            worst.append(f"{series['name']}: {point['failures']} of {point['rays']} rays{at}")
        lines.append(f"- {panel['title']} ({panel['x']}), at worst: {'; '.join(worst)}")
    return "\n".join([*lines, "", caption(stability)])


def curves(stability: Record) -> str:
    """The curves over roughness, as a table a plane."""
    if "curves" not in stability:
        return NOT_YET
    parts = []
    for plane in stability["curves"]["planes"]:
        head = [f"{plane['title']}: {plane['y']}; roughness", *[f"{x:g}" for x, _ in plane["curves"][0]["points"]]]
        rows = [[curve["name"], *[f"{y:.1e}" for _, y in curve["points"]]] for curve in plane["curves"]]
        parts.append(table(head, rows))
    return "\n\n".join([*parts, caption(stability)])


def costs(records: list[Record]) -> str:
    """What was reported of each scene, and what each part of its picture costs."""
    if not records:
        return NOT_YET
    shown = ["meshes", "triangles", "instances", "lights", "materials", "geometryBytes"]
    # what a stage reports as on or off, besides
    features = sorted(
        {k for r in records for k, v in r["reported"].items() if isinstance(v, bool) and not k.startswith("built")}
    )
    reported = [
        [r["name"], *[f"{r['reported'].get(k, 0):,}".replace(",", " ") for k in shown]]
        + ["on" if r["reported"].get(k) else "off" for k in features]
        for r in records
    ]
    names = [part["name"] for part in records[0]["parts"]]
    rows = [
        [r["name"], *[f"{part['ns_a_sample']:.0f} ({part['rays_a_sample']:.2f})" for part in r["parts"]]]
        for r in records
    ]
    first = table(["scene", *shown, *features], reported)
    second = table(["ns of the processor a sample (rays a sample)", *names], rows)
    return "\n\n".join([first, second, caption(records[0])])


def unused(record: Record | None) -> str:
    """The cost of features that no ray meets, and whether the bar holds."""
    if record is None:
        return NOT_YET
    bar = record["bar"]
    rows = [
        [
            row["name"],
            f"{row['ratio']:.3f} ({row['quartiles'][0]:.3f} to {row['quartiles'][1]:.3f})",
            "the measure's own noise" if row["name"] == "nothing" else "yes" if row["ratio"] <= bar else "**no**",
            "yes" if row["same_picture"] else "**no**",
        ]
        for row in record["features"]
    ]
    head = ["in the box", "time over that without", f"≤ {bar}", "same picture, bit by bit"]
    return "\n\n".join([table(head, rows), caption(record)])


def fill(report: Record, stability: Record, template: str) -> str:
    """The document.

    Raises:
        KeyError: The template has a place that nothing fills.
    """
    scenes, cost_records, bar = report.get("scenes", []), report.get("costs", []), report.get("unused")
    size = bar["size"] if bar else [0, 0]
    return string.Template(template).substitute(
        machine=machines(scenes),
        absent=absent(scenes),
        charts=charts(scenes),
        ratios=ratios(scenes),
        stability_about=f"Counted at commit {stability['commit']}." if stability else NOT_YET,
        stability_hits=failures(stability, "stability_hits"),
        stability_slivers=failures(stability, "stability_slivers"),
        stability_roughness=curves(stability),
        costs=costs(cost_records),
        cost_rounds=cost_records[0]["rounds"] if cost_records else 0,
        unused=unused(bar),
        unused_size=f"{size[0]} \N{MULTIPLICATION SIGN} {size[1]}",
        unused_rounds=bar["rounds"] if bar else 0,
    )


def main() -> None:
    """Writes it."""
    charts_folder, out = map(Path, sys.argv[1:])

    def record(name: str) -> Record:
        file = charts_folder / name
        return dict(json.loads(file.read_text())) if file.exists() else {}

    out.write_text(fill(record("report.json"), record("stability.json"), TEMPLATE.read_text()))


if __name__ == "__main__":
    main()
