"""Hooks of Blender's USD import and export: light that Blender has no place for goes through unharmed.

They run in every import and export, and in renders where the scene's Hydra export method is USD.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import bpy
from pxr import Sdf, Usd, UsdGeom, UsdLux

from . import lights, links, lux, meshes, world
from .report import guarded, never_raises, warn

OBJECT_NAME = "userProperties:blender:object_name"
DATA_NAME = "userProperties:blender:data_name"
DOME = f"{lux.PREFIX}dome"
"""Custom property of a portal: the object that is its dome. The World where there is none."""


class UmberUsdHook(bpy.types.USDHook):
    """Keeps light at import, restores it at export."""

    bl_idname = "umber_usd_hook"
    bl_label = "Umber"
    bl_description = "Lights of every kind, shaping, shadows, linking and portals"

    @staticmethod
    @never_raises
    def on_import(context: object) -> None:
        """Keeps what Blender's importer dropped."""
        stage, items = context.get_stage(), context.get_prim_map()
        keep_lights(stage, find_imported(items), bpy.context.scene)
        for path, found in items.items():
            for mesh in (item for item in found if isinstance(item, bpy.types.Mesh)):
                meshes.keep_facets(stage.GetPrimAtPath(path), mesh)

    @staticmethod
    @never_raises
    def on_export(context: object) -> None:
        """Restores it in the stage that Blender exported."""
        restore_lights(context.get_stage(), context.get_depsgraph().scene)


def find_imported(items: dict[Sdf.Path, list[bpy.types.ID]]) -> dict[Sdf.Path, list[bpy.types.Object]]:
    """Objects by the prims that have their data, where the importer has merged those with their parents, too."""
    imported = {}
    for path, found in items.items():
        imported[path] = [item for item in found if isinstance(item, bpy.types.Object)]
        if not imported[path]:
            above = items.get(path.GetParentPath(), ())
            imported[path] = [item for item in above if isinstance(item, bpy.types.Object) and item.data in found]
    return imported


def keep_lights(stage: Usd.Stage, imported: dict[Sdf.Path, list[bpy.types.Object]], scene: bpy.types.Scene) -> None:
    """Keeps all lights of a stage: at the objects that Blender made of them, in the World, or at new empties."""
    portals: dict[Sdf.Path, bpy.types.Object] = {}
    world_is_taken = False
    bpy.context.view_layer.update()
    for prim in find_lights(stage):
        with guarded(str(prim.GetPath())):
            holders = imported.get(prim.GetPath(), [])
            for holder in holders:
                lights.keep(prim, holder)
            if world.is_dome(prim) and is_visible(prim):
                holders = [keep_dome(prim, scene)] if world_is_taken else world.keep(prim, scene)
                if world_is_taken:
                    portals |= dict.fromkeys(prim.GetRelationship("portals").GetTargets(), holders[0])
                world_is_taken = True
            for holder in holders:
                links.keep(prim, holder, imported)
    for path, dome in portals.items():
        for portal in imported.get(path, []):
            portal[DOME] = dome


def find_lights(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    """All lights of a stage, those in prototypes of instances among them."""
    for root in (stage.GetPseudoRoot(), *stage.GetPrototypes()):
        yield from (prim for prim in Usd.PrimRange(root) if prim.HasAPI(UsdLux.LightAPI))


def is_visible(prim: Usd.Prim) -> bool:
    """Whether the prim is shown: Blender imports no others."""
    return UsdGeom.Imageable(prim).ComputeVisibility() != UsdGeom.Tokens.invisible


def keep_dome(prim: Usd.Prim, scene: bpy.types.Scene) -> bpy.types.Object:
    """An empty that stands for a dome light beside the one in the World."""
    holder = bpy.data.objects.new(prim.GetName(), None)
    holder.empty_display_type = "SPHERE"
    holder.matrix_world = world.blender_from_light(prim)
    scene.collection.objects.link(holder)
    lights.keep(prim, holder)
    return holder


def restore_lights(stage: Usd.Stage, scene: bpy.types.Scene) -> None:
    """Restores all lights in an exported stage."""
    exported = find_exported(stage)
    if not exported and any(lux.ours(item) for item in scene.objects):
        warn(scene.name, "lights are exported without what their custom properties say, as Author Blender Names is off")
    lit: list[tuple[bpy.types.ID, Usd.Prim]] = []
    for name, prims in exported.items():
        holder = bpy.data.objects.get(name)
        for prim in prims if holder else ():
            with guarded(name):
                if restored := lights.restore(holder, prim):
                    lit.append((holder, restored))
    if scene.world and (dome := find_world_dome(stage)):
        with guarded(scene.world.name):
            world.restore(scene.world, dome)
            if any(world.is_dome(prim) for _, prim in lit):
                # An import takes the first dome for the World.
                others = [name for name in dome.GetParent().GetAllChildrenNames() if name != dome.GetName()]
                dome.GetParent().SetChildrenReorder([dome.GetName(), *others])
            lit.append((scene.world, dome))
    drawn = find_drawn(exported)
    for holder, prim in lit:
        with guarded(holder.name):
            links.restore(holder, prim, drawn)
    connect_portals(lit)


def find_exported(stage: Usd.Stage) -> dict[str, list[Usd.Prim]]:
    """What Blender's objects became, by their names: the prims with the data, else the objects' own."""
    exported = defaultdict(list)
    for prim in stage.Traverse():
        if name := prim.GetAttribute(OBJECT_NAME):
            candidates = (prim, *(child for child in prim.GetChildren() if not child.HasAttribute(OBJECT_NAME)))
            exported[name.Get()].extend([found for found in candidates if found.HasAttribute(DATA_NAME)] or [prim])
    return exported


def find_drawn(exported: dict[str, list[Usd.Prim]]) -> dict[str, list[Usd.Prim]]:
    """What of it light can reach: beside an object's data its instances, but not the objects that are its children."""
    drawn = {}
    for name, prims in exported.items():
        merged = [prim for prim in prims if prim.HasAttribute(OBJECT_NAME)]
        beside = (child for prim in prims if prim not in merged for child in prim.GetParent().GetChildren())
        drawn[name] = merged + [child for child in beside if is_part(child, name)]
    return drawn


def is_part(prim: Usd.Prim, owner: str) -> bool:
    """Whether a prim below that of the object `owner` is its data or an instance, and not a child of its own."""
    if not prim.HasAttribute(OBJECT_NAME):
        return True
    item = bpy.data.objects.get(prim.GetAttribute(OBJECT_NAME).Get())
    return item is not None and (item.parent is None or item.parent.name != owner)


def find_world_dome(stage: Usd.Stage) -> Usd.Prim | None:
    """The dome light that Blender made of the World: the one that no object became."""
    domes = (prim for prim in stage.Traverse() if prim.IsA(UsdLux.DomeLight) and not prim.HasAttribute(OBJECT_NAME))
    return next(domes, None)


def connect_portals(lit: list[tuple[bpy.types.ID, Usd.Prim]]) -> None:
    """Tells every dome its portals."""
    portals = defaultdict(list)
    for holder, prim in lit:
        if prim.IsA(UsdLux.PortalLight):
            dome = holder.get(DOME)
            portals[dome.name if isinstance(dome, bpy.types.Object) else None].append(prim.GetPath())
    for holder, prim in lit:
        targets = portals.get(holder.name if isinstance(holder, bpy.types.Object) else None)
        if targets and world.is_dome(prim):
            prim.GetRelationship("portals").SetTargets(targets)


def register() -> None:
    """Registers the hooks."""
    bpy.utils.register_class(UmberUsdHook)


def unregister() -> None:
    """Takes the hooks back."""
    bpy.utils.unregister_class(UmberUsdHook)
