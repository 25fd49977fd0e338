"""Walks a stage as Hydra's scene delegate does: what is shown, where, and instanced by what."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel

from umber.description import Instancer
from umber.stage_reader import implicit, point_instancer
from umber.stage_reader.placement import Space, stack
from umber.stage_reader.primvars import COMPONENTS
from umber.stage_reader.reading import Reading

CHILDREN = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
# Prototypes of a point instancer may stand below an `over`, which hides them from all but instancers.
PROTOTYPE_CHILDREN = Usd.TraverseInstanceProxies(
    Usd.PrimIsActive & Usd.PrimHasDefiningSpecifier & ~Usd.PrimIsAbstract & Usd.PrimIsLoaded
)
NOT_DRAWN = ("BasisCurves", "NurbsCurves", "HermiteCurves", "NurbsPatch", "Points", "Volume", "TetMesh")


@dataclass
class Found:
    """What a walk found."""

    meshes: list[tuple[Usd.Prim, Space, str]] = field(default_factory=list)
    """Meshes and implicit shapes, where they stand, and their purpose."""
    lights: list[tuple[Usd.Prim, Space]] = field(default_factory=list)
    skel_roots: list[Usd.Prim] = field(default_factory=list)
    instancers: list[Instancer] = field(default_factory=list)
    instance_paths: dict[str, list[Sdf.Path]] = field(default_factory=dict)
    """By outermost instancer: paths of its native instances, or of the point instancer itself."""


@dataclass
class _Group:
    """Native instances that show the same: one prototype, under the same inherited values."""

    representative: Usd.Prim
    purpose: str | None
    members: list[tuple[Sdf.Path, Gf.Matrix4d]] = field(default_factory=list)


def walk(reading: Reading) -> Found:
    """Finds everything that is shown at the reading's time code."""
    walker = _Walker(reading)
    walker.subtrees(reading.stage.GetPseudoRoot().GetFilteredChildren(CHILDREN), Space(), None, CHILDREN)
    return walker.found


class _Walker:
    def __init__(self, reading: Reading) -> None:
        self.reading = reading
        self.found = Found()

    def subtrees(self, roots: Iterable[Usd.Prim], space: Space, purpose: str | None, predicate: object) -> None:
        """Walks subtrees of one space. `purpose`: what they inherit, None where nobody above said any."""
        groups: dict[tuple[object, ...], _Group] = {}
        pending = [(prim, purpose) for prim in reversed(list(roots))]
        while pending:
            prim, outer = pending.pop()
            kind = prim.GetTypeName()
            if kind:
                # typeless prims group others, and have neither visibility nor purpose
                if not prim.IsA(UsdGeom.Imageable):
                    continue
                if self.reading.value(prim, "visibility") == UsdGeom.Tokens.invisible:
                    continue
                outer = _authored_purpose(prim) or outer
            if prim.IsInstance():
                self._join_group(groups, prim, space, outer)
                continue
            if kind == "PointInstancer":
                self._point_instancer(prim, space)
                continue
            self._gather(prim, kind, space, outer or UsdGeom.Tokens.default_)
            pending += [(child, outer) for child in reversed(prim.GetFilteredChildren(predicate))]
        for group in groups.values():
            self._native_instancer(group, space, predicate)

    def _gather(self, prim: Usd.Prim, kind: str, space: Space, purpose: str) -> None:
        if kind == "Mesh" or kind in implicit.SHAPES:
            if purpose == UsdGeom.Tokens.default_ or purpose in self.reading.purposes:
                self.found.meshes.append((prim, space, purpose))
        elif kind == "SkelRoot":
            self.found.skel_roots.append(prim)
        elif prim.HasAPI(UsdLux.LightAPI):
            self.found.lights.append((prim, space))
        elif kind in NOT_DRAWN:
            self.reading.warn(prim, f"prims of type {kind} are not rendered yet; left out")

    def _join_group(
        self, groups: dict[tuple[object, ...], _Group], prim: Usd.Prim, space: Space, purpose: str | None
    ) -> None:
        inherited = UsdGeom.PrimvarsAPI(prim).FindInheritablePrimvars()
        values = tuple(
            (p.GetPrimvarName(), str(p.ComputeFlattened(self.reading.time)))
            for p in inherited
            if p.GetPrimvarName() in COMPONENTS
        )
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)
        key = (prim.GetPrototype().GetPath(), purpose, values, material.GetPath())
        group = groups.setdefault(key, _Group(prim, purpose))
        group.members.append((prim.GetPath(), space.from_object(self.reading, prim)))

    def _native_instancer(self, group: _Group, space: Space, predicate: object) -> None:
        members = sorted(group.members, key=lambda member: member[0])
        name = self.reading.unique_path(group.representative.GetPath())
        transforms = stack([transform for _, transform in members])
        self.found.instancers.append(Instancer(name, transforms, space.instancer, space.indices))
        if space.instancer is None:
            self.found.instance_paths[name] = [path for path, _ in members]
        inner = space.within(name, np.arange(len(members), dtype=np.int32), transforms)
        root = group.representative
        if root.IsA(UsdGeom.Gprim):
            self.reading.warn(root, "a gprim cannot be instanced itself; left out (instance an Xform above it)")
        if root.IsA(UsdSkel.Root):
            self.found.skel_roots.append(root)
        self.subtrees(root.GetFilteredChildren(predicate), inner, group.purpose, predicate)

    def _point_instancer(self, prim: Usd.Prim, space: Space) -> None:
        placed = point_instancer.read(self.reading, prim, space)
        if placed is None:
            return
        name = self.reading.unique_path(prim.GetPath())
        self.found.instancers.append(Instancer(name, placed.transforms, space.instancer, space.indices))
        if space.instancer is None:
            self.found.instance_paths[name] = [prim.GetPath()]
        for prototype, indices in placed.prototypes:
            inner = space.within(name, indices, placed.transforms, prototype.GetParent())
            self.subtrees([prototype], inner, _inherited_purpose(prototype), PROTOTYPE_CHILDREN)


def _authored_purpose(prim: Usd.Prim) -> str | None:
    purpose = prim.GetAttribute("purpose")
    return str(purpose.Get()) if purpose.HasAuthoredValue() else None


def _inherited_purpose(prim: Usd.Prim) -> str | None:
    """The purpose that a prim inherits from those above it in namespace."""
    above = prim.GetParent()
    while above:
        if above.IsA(UsdGeom.Imageable) and (purpose := _authored_purpose(above)):
            return purpose
        above = above.GetParent()
    return None
