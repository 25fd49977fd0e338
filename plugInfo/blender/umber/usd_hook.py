"""Hooks of Blender's USD import and export: light that Blender has no place for goes through unharmed.

They run in every import and export, and in renders where the scene's Hydra export method is USD.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import bpy
from pxr import Sdf, Usd, UsdGeom, UsdLux

from . import exported, lights, links, lux, meshes, world
from .report import forget, guarded, never_raises, warn


class UmberUsdHook(bpy.types.USDHook):
    """Keeps light at import, restores it at export."""

    bl_idname = "umber_usd_hook"
    bl_label = "Umber"
    bl_description = "Lights of every kind, shaping, shadows, linking and portals"

    @staticmethod
    @never_raises
    def on_import(context: object) -> None:
        """Keeps what Blender's importer dropped."""
        forget()
        stage, items = context.get_stage(), context.get_prim_map()
        keep_lights(stage, find_imported(items), bpy.context.scene)
        for path, found in items.items():
            with guarded(str(path)):
                for mesh in (item for item in found if isinstance(item, bpy.types.Mesh)):
                    meshes.keep_facets(stage.GetPrimAtPath(path), mesh)

    @staticmethod
    @never_raises
    def on_export(context: object) -> None:
        """Restores it in the stage that Blender exported."""
        stage = context.get_stage()
        if not exported.is_temporary(stage):
            forget()
        restore_lights(stage, context.get_depsgraph().scene)


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
    has_domes, is_first = True, True
    geometry = links.find_geometry(stage, imported)
    bpy.context.view_layer.update()
    for prim in find_lights(stage):
        with guarded(str(prim.GetPath())):
            holders = imported.get(prim.GetPath(), [])
            if world.is_dome(prim):
                # Blender makes an object of a dome only where it was told to import no lights.
                if holders or not has_domes or not is_visible(prim):
                    continue
                if is_first:
                    is_first, kept = False, world.keep(prim, scene)
                    has_domes = kept is not None
                    holders = [kept] if kept else []
                else:
                    holders = [keep_dome(prim, scene)]
                    portals |= dict.fromkeys(prim.GetRelationship("portals").GetTargets(), holders[0])
            else:
                for holder in holders:
                    lights.keep(prim, holder)
            for holder in holders:
                links.keep(prim, holder, geometry)
    for path, dome in portals.items():
        with guarded(str(path)):
            for portal in imported.get(path, []):
                portal[lux.DOME] = dome


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
    prims_by_name = exported.find_exported(stage)
    if not prims_by_name and any(lights.says_more(item) for item in scene.objects):
        warn(
            scene.name, "lights are exported without what Blender's exporter leaves out, as Author Blender Names is off"
        )
    lit: list[tuple[bpy.types.ID, Usd.Prim]] = []
    for name, prims in prims_by_name.items():
        holder = scene.objects.get(name) or bpy.data.objects.get(name)
        for prim in prims if holder else ():
            with guarded(name):
                if restored := lights.restore(holder, prim):
                    lit.append((holder, restored))
    if scene.world and (dome := exported.find_world_dome(stage)):
        with guarded(scene.world.name):
            world.restore(scene.world, dome)
            if any(world.is_dome(prim) for _, prim in lit):
                # An import takes the first dome for the World.
                others = [name for name in dome.GetParent().GetAllChildrenNames() if name != dome.GetName()]
                dome.GetParent().SetChildrenReorder([dome.GetName(), *others])
            lit.append((scene.world, dome))
    drawn = exported.find_drawn(prims_by_name)
    for holder, prim in lit:
        with guarded(holder.name):
            links.restore(holder, prim, drawn)
    connect_portals(lit)


def connect_portals(lit: list[tuple[bpy.types.ID, Usd.Prim]]) -> None:
    """Tells every dome its portals."""
    portals = defaultdict(list)
    for holder, prim in lit:
        if prim.IsA(UsdLux.PortalLight):
            dome = holder.get(lux.DOME)
            portals[dome.name if isinstance(dome, bpy.types.Object) else None].append(prim.GetPath())
    for holder, prim in lit:
        targets = portals.get(holder.name if isinstance(holder, bpy.types.Object) else None)
        if targets and world.is_dome(prim):
            prim.GetRelationship("portals").SetTargets(targets)


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    """What was said of one file may be said of the next."""
    forget()


def register() -> None:
    """Registers the hooks."""
    bpy.utils.register_class(UmberUsdHook)
    bpy.app.handlers.load_post.append(on_load)


def unregister() -> None:
    """Takes the hooks back."""
    bpy.app.handlers.load_post.remove(on_load)
    bpy.utils.unregister_class(UmberUsdHook)
