"""Light and shadow linking: UsdLux's collections of prims against Blender's collections of objects.

Blender links single objects, and knows lists of what is in and lists of what is out; of both the shorter is made.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from pxr import Sdf, Usd, UsdGeom

from . import lux

BLENDER_NAMES = {"lightLink": "receiver_collection", "shadowLink": "blocker_collection"}
TITLES = {"lightLink": "Light", "shadowLink": "Shadow"}


def keep(prim: Usd.Prim, holder: bpy.types.ID, geometry: dict[Sdf.Path, list[bpy.types.Object]]) -> None:
    """Makes Blender's collections of the `geometry` that the light `prim` reaches and that casts shadows in it."""
    for name, property_name in BLENDER_NAMES.items():
        collection_api = Usd.CollectionAPI(prim, name)
        if holds_all(collection_api):
            continue
        query = collection_api.ComputeMembershipQuery()
        lists: dict[str, list[bpy.types.Object]] = {"INCLUDE": [], "EXCLUDE": []}
        for path, found in geometry.items():
            lists["INCLUDE" if query.IsPathIncluded(path) else "EXCLUDE"].extend(found)
        if not lists["EXCLUDE"]:
            continue
        state = "INCLUDE" if 0 < len(lists["INCLUDE"]) < len(lists["EXCLUDE"]) else "EXCLUDE"
        collection = bpy.data.collections.new(f"{TITLES[name]} Linking for {holder.name}")
        for item in sorted(set(lists[state]), key=lambda item: item.name):
            collection.objects.link(item)
        for member in collection.collection_objects:
            member.light_linking.link_state = state
        if isinstance(holder, bpy.types.Object):
            setattr(holder.light_linking, property_name, collection)
        else:
            holder[lux.COLLECTION + name] = collection


def holds_all(collection: Usd.CollectionAPI) -> bool:
    """Whether the collection says of itself that everything is in, as those of lights do where nothing is authored."""
    lists = (collection.GetIncludesRel(), collection.GetExcludesRel())
    return collection.GetIncludeRootAttr().Get() is True and not any(found.GetTargets() for found in lists)


def find_geometry(
    stage: Usd.Stage, imported: dict[Sdf.Path, list[bpy.types.Object]]
) -> dict[Sdf.Path, list[bpy.types.Object]]:
    """Those of the imported objects that light can fall on, by their prims."""
    return {path: found for path, found in imported.items() if is_geometry(stage.GetPrimAtPath(path))}


def is_geometry(prim: Usd.Prim) -> bool:
    """Whether light can reach the prim, as far as Blender makes one object of it."""
    drawn = prim and (prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.PointInstancer) or prim.IsInstance())
    return drawn and not prim.IsInPrototype()


def restore(holder: bpy.types.ID, light: Usd.Prim, drawn: dict[str, list[Usd.Prim]]) -> None:
    """Writes Blender's collections to the light; one that holds nothing says nothing."""
    for name, property_name in BLENDER_NAMES.items():
        if isinstance(holder, bpy.types.Object):
            collection = getattr(holder.light_linking, property_name)
        else:
            collection = holder.get(lux.COLLECTION + name)
        if not isinstance(collection, bpy.types.Collection):
            continue
        included, excluded = members(collection)
        api = Usd.CollectionAPI(light, name)
        if included:
            api.CreateIncludeRootAttr(False)
            api.CreateIncludesRel().SetTargets(paths_of(included - excluded, drawn))
        elif excluded:
            api.CreateExcludesRel().SetTargets(paths_of(excluded, drawn))


def members(collection: bpy.types.Collection) -> tuple[set[str], set[str]]:
    """Names of the objects that are in, and of those that are out, with those of nested collections."""
    included: set[str] = set()
    excluded: set[str] = set()
    for item, member in zip(collection.objects, collection.collection_objects, strict=True):
        (excluded if member.light_linking.link_state == "EXCLUDE" else included).add(item.name)
    for child, member in zip(collection.children, collection.collection_children, strict=True):
        if member.light_linking.link_state == "EXCLUDE":
            excluded |= {item.name for item in child.all_objects}
        else:
            inner_included, inner_excluded = members(child)
            included |= inner_included
            excluded |= inner_excluded
    return included, excluded


def paths_of(names: Iterable[str], drawn: dict[str, list[Usd.Prim]]) -> list[Sdf.Path]:
    """Paths of the prims that those objects became; none for objects that are not exported."""
    return sorted({prim.GetPath() for name in names for prim in drawn.get(name, [])})
