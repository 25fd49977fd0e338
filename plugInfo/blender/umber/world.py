"""Dome lights: one of them is Blender's World, where Blender has a place for its picture, colour and strength."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
from mathutils import Euler, Matrix
from pxr import Usd, UsdGeom, UsdLux

from . import lux, units
from .report import warn

INTENSITY, COLOR, TEXTURE = "inputs:intensity", "inputs:color", "inputs:texture:file"
BACKGROUND, ENVIRONMENT, MAPPING = "ShaderNodeBackground", "ShaderNodeTexEnvironment", "ShaderNodeMapping"

IMPORTED_TIME = Usd.TimeCode(0.0)
"""Frame whose values Blender's importer puts into the World."""

OF_WORLDS = frozenset({INTENSITY, COLOR, TEXTURE, "poleAxis"})
"""What a World has a place for."""

TEXTURE_FROM_DOME = Matrix(((0, 0, 1), (1, 0, 0), (0, 1, 0)))
"""Axes of Blender's environment textures, whose middle is at +X and up at +Z, from those of a dome: +Z and +Y."""

Z_FROM_Y = Matrix.Rotation(math.radians(90.0), 4, "X")
"""Turns what has +Y up so that it has +Z up."""


def is_dome(prim: Usd.Prim) -> bool:
    """Whether the prim is a dome light of either kind."""
    return prim.IsA(UsdLux.DomeLight) or prim.IsA(UsdLux.DomeLight_1)


def blender_from_light(prim: Usd.Prim) -> Matrix:
    """The light's transform in Blender's world, whose up is +Z and whose unit is a metre."""
    stage = prim.GetStage()
    world_from_light = Matrix(UsdGeom.XformCache().GetLocalToWorldTransform(prim)).transposed()
    blender_from_world = Matrix.Scale(UsdGeom.GetStageMetersPerUnit(stage), 4)
    if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y:
        blender_from_world @= Z_FROM_Y
    return blender_from_world @ world_from_light @ (Z_FROM_Y if pole_is_z(prim) else Matrix())


def pole_is_z(dome: Usd.Prim) -> bool:
    """Whether the dome's up is its +Z instead of +Y, as only a DomeLight_1 can have it."""
    if not dome.IsA(UsdLux.DomeLight_1):
        return False
    axis = UsdLux.DomeLight_1(dome).GetPoleAxisAttr().Get()
    up = UsdGeom.GetStageUpAxis(dome.GetStage()) if axis == UsdLux.Tokens.scene else axis
    return up == UsdGeom.Tokens.z


def keep(dome: Usd.Prim, scene: bpy.types.Scene) -> bpy.types.World | None:
    """The scene's World with the dome in it; none, with a warning, where the importer left the scene's World alone.

    Blender's importer fills only a World that is there.
    """
    if scene.world is None:
        scene.world = bpy.data.worlds.new(dome.GetName())
        fill(scene.world, dome)
    elif is_filled(scene.world, dome):
        complete(scene.world, dome)
    else:
        warn(scene.world.name, f"it stays as it is: no dome lights are taken from the stage, {dome.GetPath()} neither")
        return None
    for key in lux.ours(scene.world):
        del scene.world[key]
    lux.keep(dome, scene.world, OF_WORLDS)
    units.scale_kept(dome, scene.world)
    return scene.world


def is_filled(world: bpy.types.World, dome: Usd.Prim) -> bool:
    """Whether Blender's importer has put the dome into the World, as far as the nodes tell.

    The importer writes to the last background node, and multiplies the strength by an option of its own.
    """
    backgrounds = [node for node in world.node_tree.nodes if node.bl_idname == BACKGROUND] if world.node_tree else []
    if not backgrounds:
        return False
    strength, color = backgrounds[-1].inputs["Strength"], backgrounds[-1].inputs["Color"]
    if dome.GetAttribute(TEXTURE).HasAuthoredValue():
        environment = find_environment(world, backgrounds[-1])
        # A picture from inside an archive is unpacked, under its own name.
        wanted = dome.GetAttribute(TEXTURE).Get(IMPORTED_TIME).resolvedPath.rstrip("]")
        found = environment.image.filepath if environment and environment.image else ""
        return environment is not None and (not found or Path(found).name == Path(wanted).name)
    if color.is_linked:
        return False
    if dome.GetAttribute(COLOR).HasAuthoredValue():
        wanted = dome.GetAttribute(COLOR).Get(IMPORTED_TIME)
        return all(map(is_close, color.default_value, wanted))
    return is_close(strength.default_value, dome.GetAttribute(INTENSITY).Get(IMPORTED_TIME))


def is_close(one: float, other: float) -> bool:
    """Whether two numbers are the same but for single precision."""
    return math.isclose(one, other, rel_tol=1e-5, abs_tol=1e-6)


def complete(world: bpy.types.World, dome: Usd.Prim) -> None:
    """Mends what Blender's importer does otherwise than OpenUSD: the colour of a plain dome, the turn of a Z pole."""
    background = [node for node in world.node_tree.nodes if node.bl_idname == BACKGROUND][-1]
    if not background.inputs["Color"].is_linked and not dome.GetAttribute(COLOR).HasAuthoredValue():
        background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    environment = find_environment(world, background)
    for link in environment.inputs["Vector"].links if environment else ():
        if link.from_node.bl_idname == MAPPING:
            link.from_node.inputs["Rotation"].default_value = texture_rotation(dome)


def fill(world: bpy.types.World, dome: Usd.Prim) -> None:
    """Makes the World's nodes say what the dome does, as Blender's importer would."""
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next(node for node in nodes if node.bl_idname == BACKGROUND)
    color = tuple(dome.GetAttribute(COLOR).Get(IMPORTED_TIME))
    background.inputs["Strength"].default_value = dome.GetAttribute(INTENSITY).Get(IMPORTED_TIME)
    background.inputs["Color"].default_value = (*color, 1.0)
    texture = dome.GetAttribute(TEXTURE).Get(IMPORTED_TIME)
    if not texture or not texture.path:
        return
    environment = nodes.new(ENVIRONMENT)
    try:
        environment.image = bpy.data.images.load(texture.resolvedPath or texture.path, check_existing=True)
    except RuntimeError:
        nodes.remove(environment)
        warn(world.name, f"{TEXTURE} = {texture.path!r}: there is no such picture")
        return
    multiply, mapping = nodes.new("ShaderNodeVectorMath"), nodes.new(MAPPING)
    multiply.operation = "MULTIPLY"
    multiply.inputs[1].default_value = color
    mapping.inputs["Rotation"].default_value = texture_rotation(dome)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], environment.inputs["Vector"])
    links.new(environment.outputs["Color"], multiply.inputs[0])
    links.new(multiply.outputs["Vector"], background.inputs["Color"])


def texture_rotation(dome: Usd.Prim) -> Euler:
    """Turn of the environment texture that shows the dome's picture."""
    dome_from_blender = blender_from_light(dome).to_3x3().normalized().inverted()
    return (TEXTURE_FROM_DOME @ dome_from_blender).to_euler("XYZ")


def upstream(world: bpy.types.World, node: bpy.types.Node) -> list[bpy.types.Node]:
    """The nodes that the node gets its inputs from, and theirs, each once, in the order of Blender's exporter."""
    found: list[bpy.types.Node] = []

    def visit(target: bpy.types.Node) -> None:
        for link in world.node_tree.links:
            if link.to_node == target and link.is_valid and link.from_node not in found:
                found.append(link.from_node)
                visit(link.from_node)

    visit(node)
    return found


def find_environment(world: bpy.types.World, node: bpy.types.Node) -> bpy.types.Node | None:
    """The first environment texture that the node gets its inputs from."""
    return next((found for found in upstream(world, node) if found.bl_idname == ENVIRONMENT), None)


def restore(world: bpy.types.World, dome: Usd.Prim) -> None:
    """Writes to the exported dome what Blender leaves out: strength, an even colour in full, and what was kept.

    Of several background nodes the one with a picture says the strength.
    """
    output = world.node_tree.get_output_node("ALL") if world.node_tree else None
    backgrounds = [node for node in upstream(world, output) if node.bl_idname == BACKGROUND] if output else []
    pictured = [node for node in backgrounds if find_environment(world, node)]
    for background in (pictured or backgrounds)[:1]:
        strength, color = background.inputs["Strength"], background.inputs["Color"]
        if not strength.is_linked:
            lux.author(dome.GetAttribute(INTENSITY), strength.default_value)
        if not color.is_linked and not find_environment(world, output):
            # Blender writes a picture of eight bits a channel.
            dome.RemoveProperty(TEXTURE)
            lux.author(dome.GetAttribute(COLOR), tuple(color.default_value)[:3])
    lux.restore(world, dome, OF_WORLDS)
    units.scale_restored(dome)
