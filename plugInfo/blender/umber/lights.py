"""Lights that are objects in Blender: what of a UsdLux light they hold, and how it gets back into a stage."""

from __future__ import annotations

from pathlib import Path

import bpy
from pxr import Usd, UsdGeom, UsdLux

from . import exported, lux, units
from .report import warn

STAND_INS = ("CylinderLight", "PortalLight", "GeometryLight")
"""Lights that Blender imports as points of no size."""

DOMES = ("DomeLight", "DomeLight_1")
"""Lights of which Blender makes no objects."""

SHAPING_FILE = "inputs:shaping:ies:file"
CONE_ANGLE = "inputs:shaping:cone:angle"
POINT_ATTRIBUTES = frozenset({"treatAsPoint", "inputs:radius"})


def keep(prim: Usd.Prim, holder: bpy.types.Object) -> None:
    """Keeps of the light what Blender's importer dropped, in Blender's light where that has a place for it."""
    schema = "MeshLightAPI" if prim.IsA(UsdGeom.Mesh) else prim.GetTypeName()
    if not isinstance(holder.data, bpy.types.Light):
        if schema not in ("MeshLightAPI", *DOMES):
            return
        # The pole of a DomeLight_1 is in the empty's transform.
        holder[lux.SCHEMA] = "DomeLight" if schema == "DomeLight_1" else schema
        lux.keep(prim, holder, frozenset({"poleAxis"}))
        units.scale_kept(prim, holder)
        return
    light = holder.data
    placed = lux.has_place(schema, light)
    if schema in STAND_INS:
        holder[lux.SCHEMA] = schema
    time = Usd.TimeCode.EarliestTime()
    if schema == "CylinderLight":
        light.shadow_soft_size = UsdLux.CylinderLight(prim).GetRadiusAttr().Get(time)
    if schema == "SphereLight" and UsdLux.SphereLight(prim).GetTreatAsPointAttr().Get(time):
        # Blender's points have no size; here the size still says how much light there is.
        placed -= POINT_ATTRIBUTES
    lux.keep(prim, holder, placed)
    if prim.HasAPI(UsdLux.ShadowAPI) and UsdLux.ShadowAPI(prim).GetShadowEnableAttr().Get(time) is False:
        light.use_shadow = False
    if prim.HasAPI(UsdLux.ShapingAPI):
        shaping = UsdLux.ShapingAPI(prim)
        if CONE_ANGLE not in placed:
            lux.keep_value(holder, CONE_ANGLE, shaping.GetShapingConeAngleAttr().Get(time))
        profile = shaping.GetShapingIesFileAttr().Get(time)
        if profile and profile.path:
            keep_profile(light, profile.resolvedPath or profile.path)
    units.scale_kept(prim, holder)


def keep_profile(light: bpy.types.Light, path: str) -> None:
    """Gives the light a node that reads the IES profile."""
    light.use_nodes = True
    nodes, links = light.node_tree.nodes, light.node_tree.links
    node = nodes.new("ShaderNodeTexIES")
    node.mode, node.filepath = "EXTERNAL", path
    for emission in (found for found in nodes if found.bl_idname == "ShaderNodeEmission"):
        node.location = emission.location.x - 200.0, emission.location.y
        links.new(node.outputs["Fac"], emission.inputs["Strength"])


def restore(holder: bpy.types.Object, prim: Usd.Prim) -> Usd.Prim | None:
    """Writes what was kept to the prim that the object became; the prim where it is a light then."""
    schema = holder.get(lux.SCHEMA)
    if isinstance(holder.data, bpy.types.Light):
        if not prim.HasAPI(UsdLux.LightAPI):
            return None
        remove_custom(holder, prim)
        if holder.data.type == "POINT" and schema is not None and change_type(holder, prim, schema, STAND_INS):
            # What Blender says of a point without size.
            prim.RemoveProperty("treatAsPoint")
            prim.RemoveProperty("extent")
        restore_light(holder, prim)
        units.scale_restored(prim)
        return prim
    if schema is None:
        return None
    remove_custom(holder, prim)
    if prim.IsA(UsdGeom.Mesh):
        if schema != "MeshLightAPI":
            warn(holder.name, f"{lux.SCHEMA} = {schema!r}: of a mesh MeshLightAPI is wanted; left out")
            return None
        prim.ApplyAPI(schema)
    elif not change_type(holder, prim, schema, DOMES + STAND_INS):
        return None
    lux.restore(holder, prim)
    units.scale_restored(prim)
    return prim


def remove_custom(holder: bpy.types.Object, prim: Usd.Prim) -> None:
    """Removes what Blender's exporter made of our custom properties: they are the light's, with UsdLux's types."""
    owners = [prim]
    if exported.object_name(prim.GetParent()) == holder.name:
        owners.append(prim.GetParent())
    for owner in owners:
        for name in lux.ours(holder):
            owner.RemoveProperty(name)


def restore_light(holder: bpy.types.Object, prim: Usd.Prim) -> None:
    """Writes what Blender's light says and its exporter leaves out, and what was kept of the rest."""
    light = holder.data
    placed = lux.has_place(prim.GetTypeName(), light)
    if light.shadow_soft_size == 0.0 and prim.GetTypeName() == "SphereLight":
        placed -= POINT_ATTRIBUTES
        if any(lux.PREFIX + name in holder for name in POINT_ATTRIBUTES):
            # Blender's is of a point without size.
            prim.RemoveProperty("extent")
    else:
        placed |= {"treatAsPoint"}
    lux.author(prim.GetAttribute("inputs:enableColorTemperature"), light.use_temperature)
    if not light.use_shadow:
        UsdLux.ShadowAPI.Apply(prim).CreateShadowEnableAttr(False)
    if profile := find_profile(light, Path(prim.GetStage().GetRootLayer().realPath).parent / "textures"):
        lux.apply_api_of(prim, SHAPING_FILE)
        lux.restore_value(holder.name, SHAPING_FILE, profile, prim.GetAttribute(SHAPING_FILE))
    lux.restore(holder, prim, placed)


def says_more(item: bpy.types.Object) -> bool:
    """Whether Blender's exporter alone leaves out something of the object's light or links."""
    linking, light = item.light_linking, item.data if isinstance(item.data, bpy.types.Light) else None
    if lux.ours(item) or linking.receiver_collection or linking.blocker_collection:
        return True
    return light is not None and (not light.use_shadow or find_profile_node(light) is not None)


def find_profile_node(light: bpy.types.Light) -> bpy.types.Node | None:
    """The light's node with an IES profile."""
    nodes = light.node_tree.nodes if light.use_nodes and light.node_tree else ()
    return next(
        (node for node in nodes if node.bl_idname == "ShaderNodeTexIES" and node.outputs["Fac"].is_linked), None
    )


def find_profile(light: bpy.types.Light, folder: Path) -> str:
    """The file of the IES profile among the light's nodes; empty where there is none.

    One that is a text inside Blender is written to a file in `folder`.
    """
    node = find_profile_node(light)
    if node is None:
        return ""
    if node.mode == "EXTERNAL":
        return node.filepath
    if not node.ies:
        return ""
    file = folder / f"{bpy.path.clean_name(Path(node.ies.name).stem)}.ies"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file.write_text(node.ies.as_string(), encoding="utf-8")
    except OSError as error:
        warn(light.name, f"the IES profile {node.ies.name} is left out: {error}")
        return ""
    return str(file)


def change_type(holder: bpy.types.Object, prim: Usd.Prim, schema: object, known: tuple[str, ...]) -> bool:
    """Makes the prim a light of that schema; false, with a warning, where there is none such."""
    if schema in known:
        prim.SetTypeName(schema)
        return True
    warn(holder.name, f"{lux.SCHEMA} = {schema!r}: one of {', '.join(known)} is wanted; left out")
    return False
