"""Umber's ways to render: the lines that it has in charts."""

from __future__ import annotations

from dataclasses import dataclass, field

import umber


@dataclass(frozen=True)
class Mode:
    """A way of Umber's to render. What its settings leave out is as a session has it."""

    name: str
    settings: dict[str, str] = field(default_factory=dict)
    # counts by `convergedVariance`: where equal counts of that number lead
    adaptive: bool = False
    # with fewer samples it would do the same as equal counts
    least_samples: int = 1

    @property
    def is_known(self) -> bool:
        """Whether this Umber has every setting, and its choice, that the mode names."""
        known: dict[str, list[str]] = {row["key"]: row.get("choices") or [] for row in umber.settings()}
        return all(key in known and (not known[key] or value in known[key]) for key, value in self.settings.items())


# Those that this Umber does not know take no part.
MODES = [
    Mode("Umber"),
    Mode("Umber, adaptive", adaptive=True, least_samples=32),
    Mode("Umber, direct light alone", {"umber:integrator": "direct"}),
]


def plain_settings() -> dict[str, str]:
    """What one mode sets is set back for the next: the defaults of every setting that any mode names."""
    defaults = {row["key"]: str(row["default"]) for row in umber.settings()}
    return {"convergedVariance": "-1"} | {k: defaults[k] for m in MODES for k in m.settings if k in defaults}
