"""Spaces that prims are placed in: the world, or that of an instancer's prototypes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from pxr import Gf, Usd

from umber.description import NO_INTS, Doubles, Ints
from umber.stage_reader.reading import Reading, matrix


@dataclass(frozen=True)
class Space:
    """Where the prims of a subtree stand."""

    instancer: str | None = None
    """The instancer whose instances show this space; None for the world."""
    indices: Ints = field(default_factory=lambda: NO_INTS)
    """Which of its instances."""
    origin: Usd.Prim | None = None
    """The prim whose space this is, where it is not that of the stage or the native prototype."""
    parent: Space | None = None
    """The space that the instancer stands in."""
    transforms: Doubles = field(default_factory=lambda: np.empty((0, 4, 4)))
    """The instancer's transforms, shape (n, 4, 4): parent space from this space."""

    def from_object(self, reading: Reading, prim: Usd.Prim) -> Gf.Matrix4d:
        """Space of this from the prim's object space."""
        transform = reading.local_to_world(prim)
        if self.origin is not None:
            transform = transform * reading.local_to_world(self.origin).GetInverse()
        return transform

    def placements(self) -> list[Gf.Matrix4d]:
        """World from this space, once an instance."""
        if self.parent is None:
            return [Gf.Matrix4d(1)]
        own = [Gf.Matrix4d(*self.transforms[i].ravel()) for i in self.indices]
        return [transform * outer for outer in self.parent.placements() for transform in own]

    def within(self, instancer: str, indices: Ints, transforms: Doubles, origin: Usd.Prim | None = None) -> Space:
        """The space of an instancer's prototypes, where the instancer stands in this one."""
        return Space(instancer, indices, origin, self, transforms)


def stack(transforms: list[Gf.Matrix4d]) -> Doubles:
    """Transforms as an array of shape (n, 4, 4)."""
    return np.stack([matrix(t) for t in transforms]) if transforms else np.empty((0, 4, 4))
