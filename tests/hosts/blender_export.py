"""Exports a scene that came from no stage, first as Blender alone does it and then with Umber's add-on.

    blender_export.py ALONE WITH

Runs where blender_render.py does.
"""

from __future__ import annotations

import sys

import blender_render as driver
import bpy


def make_scene() -> None:
    """A mesh, a light of each kind, one of them without size and one without shadows, and an even World."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cube_add()
    for kind in ("POINT", "SUN", "SPOT", "AREA"):
        light = bpy.data.lights.new(kind.title(), kind)
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(kind.title(), light))
    bpy.data.lights["Point"].shadow_soft_size = 0.0
    bpy.data.lights["Spot"].use_shadow = False
    bpy.context.scene.world = bpy.data.worlds.new("World")


def main(alone: str, with_add_on: str) -> int:
    """Does it; the exit code."""
    make_scene()
    bpy.ops.wm.usd_export(filepath=alone)
    driver.add_on()
    bpy.ops.wm.usd_export(filepath=with_add_on)
    return driver.DONE


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
