"""Warnings, each said once by all renders of a file: an export runs at every edit of the viewport."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any

LOG = logging.getLogger("umber")
_said: set[str] = set()


def warn(name: str, what: str) -> None:
    """Says `what` is wrong with the object or prim `name`, unless it was said since the last `forget`."""
    message = f"umber: {name}: {what}"
    if message not in _said:
        _said.add(message)
        LOG.warning(message)


def forget() -> None:
    """Lets everything be said again."""
    _said.clear()


@contextmanager
def guarded(name: str) -> Iterator[None]:
    """Whatever goes wrong inside becomes a warning about `name`: the others still get theirs."""
    try:
        yield
    except Exception as error:
        warn(name, f"{type(error).__name__}: {error}")


def never_raises(hook: Callable[..., None]) -> Callable[..., bool]:
    """Makes a hook that ends well whatever happens, as an import or export must go on."""

    @wraps(hook)
    def guard(*arguments: Any) -> bool:  # noqa: ANN401
        with guarded(hook.__name__):
            hook(*arguments)
        return True

    return guard
