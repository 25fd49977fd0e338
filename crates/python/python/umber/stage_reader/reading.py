"""What all parts of the reader share: the time code, what is said to the user, USD values as numpy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from umber.description import Doubles, Floats, Ints


@dataclass
class Reading:
    """One pass over a stage at one time code."""

    stage: Usd.Stage
    time: Usd.TimeCode
    purposes: frozenset[str]
    say: Callable[[str], None]
    transforms: UsdGeom.XformCache = field(init=False)
    _paths: dict[str, int] = field(default_factory=dict)
    _said: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.transforms = UsdGeom.XformCache(self.time)

    def warn(self, prim: Usd.Prim | Sdf.Path, text: str) -> None:
        """Tells the user about a prim, each thing once."""
        path = prim if isinstance(prim, Sdf.Path) else prim.GetPath()
        line = f"<{path}>: {text}"
        if line not in self._said:
            self._said.add(line)
            self.say(line)

    def unique_path(self, path: Sdf.Path) -> str:
        """The path, with a number behind it where that path was asked for before.

        A prototype that two instancers show is two prims of the scene.
        """
        count = self._paths.get(path.pathString, 0)
        self._paths[path.pathString] = count + 1
        return path.pathString if count == 0 else f"{path}{{instance={count}}}"

    def value(self, prim: Usd.Prim, name: str) -> Any:  # noqa: ANN401 - USD values have any type
        """Value of an attribute, or None where it has none."""
        return prim.GetAttribute(name).Get(self.time)

    def local_to_world(self, prim: Usd.Prim) -> Gf.Matrix4d:
        """World from object; for a prim in an instance, prototype from object."""
        if prim.IsInstanceProxy():
            prim = prim.GetPrimInPrototype()
        return self.transforms.GetLocalToWorldTransform(prim)


def floats(values: object) -> Floats:
    """A VtArray of numbers or vectors as single precision, without a copy where it is so already."""
    return np.ascontiguousarray(values, np.float32)


def ints(values: object) -> Ints:
    """A VtArray of integers; None is an empty one."""
    return np.empty(0, np.int32) if values is None else np.ascontiguousarray(values, np.int32)


def matrix(value: Gf.Matrix4d) -> Doubles:
    """A matrix in USD's layout, shape (4, 4)."""
    return np.array(value, np.float64)


def asset_file(asset: Sdf.AssetPath | None) -> str | None:
    """The file as the resolver found it; as it was written where it found none."""
    return (asset.resolvedPath or asset.path or None) if asset else None


def single(value: float) -> float:
    """Rounds to single precision."""
    return float(np.float32(value))
