"""Imports a stage in Blender with Umber's add-on, edits the scene as an artist might, and exports or renders it.

    blender_edits.py STAGE OUTPUT EDIT

OUTPUT is a stage, or a picture where it ends in .exr; EDIT is one of `EDITS`. Runs where blender_render.py does.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import blender_render as driver
import bpy


def collection(name: str, states: dict[str, str], inside: dict[bpy.types.Collection, str]) -> bpy.types.Collection:
    """A collection for light linking: states of objects by their names, and of collections in it."""
    made = bpy.data.collections.new(name)
    for item in states:
        made.objects.link(bpy.data.objects[item])
    for item, member in zip(made.objects, made.collection_objects, strict=True):
        member.light_linking.link_state = states[item.name]
    for child, state in inside.items():
        made.children.link(child)
        made.collection_children[-1].light_linking.link_state = state
    return made


def link() -> None:
    """Links the light as Blender's panels do: the block is lit, the ball in a nested collection casts no shadow."""
    linking = bpy.data.objects["Light"].light_linking
    linking.receiver_collection = collection("Lit", {"Block": "INCLUDE"}, {})
    outer = collection("Shadows", {}, {collection("Inner", {"Ball": "EXCLUDE"}, {}): "INCLUDE"})
    linking.blocker_collection = outer


def scatter() -> None:
    """Balls at the corners of the floor, by geometry nodes; the light is for the floor and what is on it."""
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    kinds = ("NodeGroupInput", "GeometryNodeObjectInfo", "GeometryNodeInstanceOnPoints", "GeometryNodeJoinGeometry")
    floor, ball, instances, joined = (group.nodes.new(kind) for kind in kinds)
    ball.inputs["Object"].default_value = bpy.data.objects["Ball"]
    ball.inputs["As Instance"].default_value = True
    connect = group.links.new
    connect(floor.outputs[0], instances.inputs["Points"])
    connect(ball.outputs["Geometry"], instances.inputs["Instance"])
    connect(instances.outputs[0], joined.inputs[0])
    connect(floor.outputs[0], joined.inputs[0])
    connect(joined.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    bpy.data.objects["Floor"].modifiers.new("Scatter", "NODES").node_group = group
    bpy.data.objects["Light"].light_linking.receiver_collection = collection("Lit", {"Floor": "INCLUDE"}, {})


def double_power() -> None:
    """Twice the power."""
    bpy.data.lights["Light"].energy *= 2.0


def spoil() -> None:
    """Values of wrong types, as scripts and artists may leave them."""
    light = bpy.data.objects["Light"]
    light["usd:inputs:shaping:focus"] = "much"
    light["usd:inputs:shaping:focusTint"] = [1.0, 2.0]
    light["usd:light"] = 5
    bpy.data.objects["Ball"]["usd:light"] = "LavaLamp"


def lose_profile() -> None:
    """An IES profile that is not there."""
    nodes = bpy.data.lights["Light"].node_tree.nodes
    next(node for node in nodes if node.bl_idname == "ShaderNodeTexIES").filepath = "/nowhere/lost.ies"


def give_size() -> None:
    """A radius for a point."""
    bpy.data.lights["Light"].shadow_soft_size = 0.3


def profile_inside() -> None:
    """The IES profile as a text in the file, at a lamp without a cone or shadows."""
    lamp = bpy.data.lights["Light"]
    node = next(node for node in lamp.node_tree.nodes if node.bl_idname == "ShaderNodeTexIES")
    text = bpy.data.texts.load(node.filepath)
    node.mode, node.ies = "INTERNAL", text
    bpy.data.objects["Light"]["usd:inputs:shaping:focus"] = 2.0
    lamp.type, lamp.use_shadow = "POINT", False


def sky_in_world(*, is_mixed: bool) -> None:
    """A World that shows a picture: mixed with an even background by Light Path, or beside one that nothing uses."""
    world = bpy.context.scene.world = bpy.data.worlds.new("Sky")
    nodes, connect, output = world.node_tree.nodes, world.node_tree.links.new, world.node_tree.get_output_node("ALL")
    even = next(node for node in nodes if node.bl_idname == "ShaderNodeBackground")
    picture, sky = nodes.new("ShaderNodeTexEnvironment"), nodes.new("ShaderNodeBackground")
    picture.image = bpy.data.images.load(str(driver.ADD_ONS.parents[1] / "docs/scenes/lights/sky.hdr"))
    sky.inputs["Strength"].default_value = 2.5
    connect(picture.outputs["Color"], sky.inputs["Color"])
    if not is_mixed:
        connect(sky.outputs["Background"], output.inputs["Surface"])
        return
    mix = nodes.new("ShaderNodeMixShader")
    connect(nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    connect(sky.outputs["Background"], mix.inputs[1])
    connect(even.outputs["Background"], mix.inputs[2])
    connect(mix.outputs["Shader"], output.inputs["Surface"])


def tag() -> None:
    """Custom properties that are not ours, at the light and at its parent; one of ours with a slip of the pen."""
    light = bpy.data.objects["Light"]
    parent = bpy.data.objects.new("Rig", None)
    bpy.context.scene.collection.objects.link(parent)
    light.parent = parent
    light["usd:inputs:shaping:fokus"] = 2.0
    light["usd:inputs:shaping:focus"] = 0.5
    for item in (light, parent):
        item["usd:assetTag"] = "lamp"
    parent["usd:inputs:shaping:focus"] = 0.25


EDITS: dict[str, Callable[[], None]] = {
    "none": lambda: None,
    "link": link,
    "scatter": scatter,
    "double_power": double_power,
    "spoil": spoil,
    "lose_profile": lose_profile,
    "give_size": give_size,
    "profile_inside": profile_inside,
    "mixed_sky": lambda: sky_in_world(is_mixed=True),
    "lone_sky": lambda: sky_in_world(is_mixed=False),
    "tag": tag,
}


def main(stage: str, output: str, edit: str, *options: str) -> int:
    """Does it; the exit code. `options` are the exporter's, as NAME=VALUE, or as import.NAME=VALUE of the import."""
    driver.add_on()
    starts = [text.removeprefix("import.") for text in options if text.startswith("import.")]
    driver.import_stage(stage, **dict(driver.parse_setting(text) for text in starts))
    EDITS[edit]()
    if output.endswith(".exr"):
        flags = [stage, output, "--camera", "/Camera", "--imageWidth", "48"]
        driver.set_up(driver.argument_parser().parse_args(flags))
        bpy.ops.render.render(write_still=True)
    else:
        ends = [text for text in options if not text.startswith("import.")]
        bpy.ops.wm.usd_export(filepath=output, **dict(driver.parse_setting(text) for text in ends))
    return driver.DONE


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
