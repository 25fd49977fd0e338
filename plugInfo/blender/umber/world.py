"""Dome lights: one of them is Blender's World, where Blender has a place for its picture, colour and strength."""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix
from pxr import Usd, UsdGeom, UsdLux

from . import lux
from .report import warn

OF_WORLDS = frozenset({"inputs:intensity", "inputs:color", "inputs:texture:file", "poleAxis"})
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


def keep(dome: Usd.Prim, scene: bpy.types.Scene) -> list[bpy.types.World]:
    """The scene's World with the dome in it; none where the importer was told to leave the World alone.

    Blender's importer does it where there is a World already, and only for a DomeLight.
    """
    intensity = float(dome.GetAttribute("inputs:intensity").Get(Usd.TimeCode.EarliestTime()))
    if scene.world is None or not dome.IsA(UsdLux.DomeLight):
        if scene.world is not None:
            scene.world.use_fake_user = True
        scene.world = bpy.data.worlds.new(dome.GetName())
        fill(scene.world, dome, intensity)
    background = find_background(scene.world)
    if background is None or not math.isclose(background.inputs["Strength"].default_value, intensity, rel_tol=1e-5):
        return []
    for key in lux.ours(scene.world):
        del scene.world[key]
    lux.keep(dome, scene.world, OF_WORLDS)
    return [scene.world]


def fill(world: bpy.types.World, dome: Usd.Prim, intensity: float) -> None:
    """Makes the World's nodes say what the dome does, as Blender's importer would."""
    time = Usd.TimeCode.EarliestTime()
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = find_background(world)
    color = tuple(dome.GetAttribute("inputs:color").Get(time))
    background.inputs["Strength"].default_value = intensity
    background.inputs["Color"].default_value = (*color, 1.0)
    texture = dome.GetAttribute("inputs:texture:file").Get(time)
    if not texture or not texture.path:
        return
    environment = nodes.new("ShaderNodeTexEnvironment")
    try:
        environment.image = bpy.data.images.load(texture.resolvedPath or texture.path, check_existing=True)
    except RuntimeError:
        nodes.remove(environment)
        warn(world.name, f"inputs:texture:file = {texture.path!r}: there is no such picture")
        return
    multiply, mapping = nodes.new("ShaderNodeVectorMath"), nodes.new("ShaderNodeMapping")
    multiply.operation = "MULTIPLY"
    multiply.inputs[1].default_value = color
    dome_from_blender = blender_from_light(dome).to_3x3().normalized().inverted()
    mapping.inputs["Rotation"].default_value = (TEXTURE_FROM_DOME @ dome_from_blender).to_euler("XYZ")
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], environment.inputs["Vector"])
    links.new(environment.outputs["Color"], multiply.inputs[0])
    links.new(multiply.outputs["Vector"], background.inputs["Color"])


def find_background(world: bpy.types.World) -> bpy.types.Node | None:
    """The World's first background node."""
    nodes = world.node_tree.nodes if world.node_tree else ()
    return next((node for node in nodes if node.bl_idname == "ShaderNodeBackground"), None)


def restore(world: bpy.types.World, dome: Usd.Prim) -> None:
    """Writes to the exported dome what Blender leaves out: strength, an even colour in full, and what was kept."""
    background = find_background(world)
    if background is not None:
        strength, color = background.inputs["Strength"], background.inputs["Color"]
        if not strength.is_linked:
            lux.author(dome.GetAttribute("inputs:intensity"), strength.default_value)
        if not color.is_linked:
            # Blender writes a picture of eight bits a channel.
            dome.RemoveProperty("inputs:texture:file")
            lux.author(dome.GetAttribute("inputs:color"), tuple(color.default_value)[:3])
    lux.restore(world, dome, OF_WORLDS)
