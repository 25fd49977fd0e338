"""Umber renders USD stages on the CPU: this package reads them with usd-core, without Hydra."""

from umber._umber import Session, __version__, aovs, settings

__all__ = ["Session", "__version__", "aovs", "settings"]
