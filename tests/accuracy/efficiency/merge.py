"""The report's record, where only a part of it was measured anew."""

from __future__ import annotations

from typing import Any


def by_name(old: list[dict[str, Any]], new: list[dict[str, Any]], order: list[str]) -> list[dict[str, Any]]:
    """Rows of both, the new ones in place of old ones of the same name; in that order, unknown names dropped."""
    rows = {row["name"]: row for row in [*old, *new]}
    return [rows[name] for name in order if name in rows]


def merged(old: dict[str, Any], new: dict[str, Any], scenes: list[str]) -> dict[str, Any]:
    """A record: what was measured now, and what was known of the rest."""
    lists = ["scenes", "costs"]
    record = {**old, **{key: value for key, value in new.items() if key not in lists}}
    for key in lists:
        record[key] = by_name(old.get(key, []), new.get(key, []), scenes)
    return record
