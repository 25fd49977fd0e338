"""Renders a stage in Blender: imported as Blender imports USD, rendered by its Hydra engine with Umber behind it.

The add-on is loaded from its sources (plugInfo/blender/umber), as Blender loads it where it is installed. Geometry and
materials are Blender's reading of the stage; light is the stage's, by the add-on's hooks.

Runs in the Python that has Blender as the module `bpy`; UMBER_PLUGIN_PATH names the delegate's plugin folder.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from types import ModuleType

import bpy

ADD_ONS = Path(__file__).resolve().parents[2] / "plugInfo/blender"
DONE, COULD_NOT_RENDER, BAD_ARGUMENTS = 0, 1, 2


def main() -> int:
    """Renders what the command line says; the exit code."""
    arguments, others = argument_parser().parse_known_args()
    if others:
        print(f"blender_render: of no meaning to Blender, ignored: {' '.join(others)}", file=sys.stderr)
    try:
        settings = dict(parse_setting(text) for text in arguments.set)
    except ValueError as error:
        print(f"blender_render: {error}", file=sys.stderr)
        return BAD_ARGUMENTS
    try:
        add_on().engine.UmberEngine.overrides = settings
        import_stage(arguments.stage)
        set_up(arguments)
        if arguments.camera_light:
            add_camera_light(bpy.context.scene)
        bpy.ops.render.render(write_still=True)
    except (RuntimeError, LookupError) as error:
        print(f"blender_render: {error}", file=sys.stderr)
        return COULD_NOT_RENDER
    if not Path(arguments.output).exists():
        print(f"blender_render: {arguments.output} was not written", file=sys.stderr)
        return COULD_NOT_RENDER
    return DONE


def argument_parser() -> argparse.ArgumentParser:
    """The flags: those of usdrecord that mean something to Blender."""
    parser = argparse.ArgumentParser(prog="blender_render", description="Renders a USD stage in Blender with Umber.")
    add = parser.add_argument
    add("stage")
    add("output")
    add("--imageWidth", "-w", type=int, default=960)
    add("--imageHeight", type=int, help="from the camera's aspect ratio where not given")
    add("--camera", "-cam", help="name of the camera, or its prim path; the first one where not given")
    add("--frame", type=int, help="the frame to render")
    add("--disableCameraLight", action="store_false", dest="camera_light")
    add("--set", action="append", default=[], metavar="KEY=VALUE", help="a setting of the renderer")
    return parser


def parse_setting(text: str) -> tuple[str, object]:
    """A setting; its value as the first of bool, int, float and text that it can be."""
    key, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"--set {text}: KEY=VALUE is wanted")
    if value.lower() in ("true", "false"):
        return key, value.lower() == "true"
    for kind in (int, float):
        try:
            return key, kind(value)
        except ValueError:
            continue
    return key, value


def add_on() -> ModuleType:
    """Umber's add-on, registered. Raises RuntimeError where it finds no renderer."""
    sys.path.insert(0, str(ADD_ONS))
    import umber  # noqa: PLC0415 (only there now)

    umber.register()
    return umber


def import_stage(path: str, *, has_world: bool = False, **options: object) -> None:
    """An empty scene, or one that has Blender's grey World, with the stage in it; `options` are the importer's."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if has_world:
        bpy.context.scene.world = bpy.data.worlds.new("Grey")
    result = bpy.ops.wm.usd_import(filepath=str(Path(path).resolve()), **options)
    if "FINISHED" not in result:
        raise RuntimeError(f"Blender cannot import {path}")


def set_up(arguments: argparse.Namespace) -> None:
    """Engine, camera, size, and the file: linear, single precision where it is an EXR, else as displayed.

    The camera does not see dome lights, as in usdrecord.
    """
    scene = bpy.context.scene
    scene.render.engine = "UMBER"
    scene.hydra.export_method = "USD"
    scene.camera = find_camera(scene, arguments.camera)
    if arguments.frame is not None:
        scene.frame_set(arguments.frame)
    render = scene.render
    lens = scene.camera.data
    aspect = lens.sensor_width / lens.sensor_height if lens.sensor_height > 0 else 1.0
    render.resolution_x = max(arguments.imageWidth, 1)
    # rounded down as in usdrecord, but for what single precision leaves of a whole row
    render.resolution_y = arguments.imageHeight or max(int(render.resolution_x / aspect + 1e-3), 1)
    if not arguments.imageHeight and lens.type == "PERSP" and render.resolution_x > aspect * render.resolution_y:
        # what the rounding adds at the sides is in the picture, as in usdrecord
        lens.sensor_fit = "VERTICAL"
    render.resolution_percentage = 100
    render.film_transparent = True
    render.filepath = str(Path(arguments.output).resolve())
    render.use_file_extension = False
    image = render.image_settings
    if Path(arguments.output).suffix.lower() == ".exr":
        image.file_format, image.color_depth = "OPEN_EXR", "32"
        scene.view_settings.view_transform = "Raw"
    else:
        image.file_format = "PNG"
        scene.view_settings.view_transform = "Standard"
    image.color_mode = "RGBA"


def add_camera_light(scene: bpy.types.Scene) -> None:
    """A sun behind the camera, without shadows: what usdrecord's camera light is."""
    sun = bpy.data.lights.new("CameraLight", "SUN")
    sun.energy, sun.angle, sun.use_shadow = 1.0, math.radians(0.53), False
    light = bpy.data.objects.new("CameraLight", sun)
    light.matrix_world = scene.camera.matrix_world
    scene.collection.objects.link(light)


def find_camera(scene: bpy.types.Scene, named: str | None) -> bpy.types.Object:
    """The camera of that name, or the first."""
    cameras = [item for item in scene.objects if item.type == "CAMERA"]
    wanted = named.rstrip("/").rsplit("/", 1)[-1] if named else None
    for camera in cameras:
        if wanted in (None, camera.name, camera.data.name):
            return camera
    raise LookupError(f"the stage has no camera {named or ''}".rstrip())


if __name__ == "__main__":
    sys.exit(main())
