"""Which prims of an exported stage Blender's objects became: the exporter writes their names beside them."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import bpy
from pxr import Usd, UsdLux

OBJECT_NAME = "userProperties:blender:object_name"
DATA_NAME = "userProperties:blender:data_name"


def is_temporary(stage: Usd.Stage) -> bool:
    """Whether the stage is one that Blender makes for itself, as for a render, and not a file that somebody keeps."""
    root = stage.GetRootLayer().realPath
    return not root or Path(root).is_relative_to(Path(bpy.app.tempdir).resolve())


def object_name(prim: Usd.Prim) -> str | None:
    """Name of the object that became the prim; none where no object did by itself."""
    return prim.GetAttribute(OBJECT_NAME).Get() if prim.HasAttribute(OBJECT_NAME) else None


def find_exported(stage: Usd.Stage) -> dict[str, list[Usd.Prim]]:
    """What Blender's objects became, by their names: the prims with the data, else the objects' own."""
    exported = defaultdict(list)
    for prim in stage.Traverse():
        if name := object_name(prim):
            candidates = (prim, *(child for child in prim.GetChildren() if not child.HasAttribute(OBJECT_NAME)))
            exported[name].extend([found for found in candidates if found.HasAttribute(DATA_NAME)] or [prim])
    return exported


def find_drawn(exported: dict[str, list[Usd.Prim]]) -> dict[str, list[Usd.Prim]]:
    """The prims that light falls on, by objects: an object's data and its instances, but not other objects below it."""
    drawn = {}
    for name, prims in exported.items():
        merged = [prim for prim in prims if prim.HasAttribute(OBJECT_NAME)]
        beside = (child for prim in prims if prim not in merged for child in prim.GetParent().GetChildren())
        drawn[name] = merged + [child for child in beside if is_part(child, name)]
    return drawn


def is_part(prim: Usd.Prim, owner: str) -> bool:
    """Whether a prim below that of the object `owner` is its data or an instance, and not a child of its own."""
    name = object_name(prim)
    if name is None:
        return True
    item = bpy.data.objects.get(name)
    return item is not None and (item.parent is None or item.parent.name != owner)


def find_world_dome(stage: Usd.Stage) -> Usd.Prim | None:
    """The dome light that Blender made of the World: the one that no object became."""
    domes = (prim for prim in stage.Traverse() if prim.IsA(UsdLux.DomeLight) and not prim.HasAttribute(OBJECT_NAME))
    return next(domes, None)
