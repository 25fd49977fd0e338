"""The render engine: Blender's Hydra engine with Umber as the delegate."""

from __future__ import annotations

import os
from pathlib import Path

import bpy
from pxr import Plug

from . import properties

PLUGIN_ID = "HdUmberRendererPlugin"
PLUGIN_FOLDER = Path(__file__).parent / "plugin"
PLUGIN_VARIABLE = "UMBER_PLUGIN_PATH"
PREVIEW_SAMPLES = 32
"""Most samples a pixel for the small pictures of materials and lights in Blender's panels."""


class UmberEngine(bpy.types.HydraRenderEngine):
    """Umber among Blender's render engines."""

    bl_idname = "UMBER"
    bl_label = "Umber"
    bl_info = "Path tracer on the CPU, with every light of USD"
    bl_use_preview = True
    bl_use_gpu_context = False
    bl_delegate_id = PLUGIN_ID

    overrides: dict[str, object] = {}  # noqa: RUF012 (Blender makes the instances)
    """Settings by the delegate's keys that a script sets for all scenes, before what the panels say."""

    def get_render_settings(self, engine_type: str) -> dict[str, object]:
        """Settings for the delegate; for a final render, which AOV fills which of Blender's passes, too."""
        scene = bpy.context.scene
        viewport = engine_type == "VIEWPORT"
        settings = properties.by_key(scene.umber.viewport if viewport else scene.umber.final)
        if engine_type == "PREVIEW":
            key = "convergedSamplesPerPixel"
            settings[key] = min(settings[key], PREVIEW_SAMPLES)
        settings["enableInteractive"] = viewport
        settings["domeLightCameraVisibility"] = not scene.render.film_transparent
        settings |= self.overrides
        return settings if viewport else {**settings, "aovToken:Combined": "color", "aovToken:Depth": "depth"}

    def update_render_passes(self, scene: bpy.types.Scene, render_layer: bpy.types.ViewLayer) -> None:
        """Tells Blender which passes there are."""
        if render_layer.use_pass_combined:
            self.register_pass(scene, render_layer, "Combined", 4, "RGBA", "COLOR")
        if render_layer.use_pass_z:
            self.register_pass(scene, render_layer, "Depth", 1, "Z", "VALUE")


def find_plugin() -> Path:
    """The folder of OpenUSD's plugin manifest: in the add-on, else where the environment says.

    Raises RuntimeError where neither has one.
    """
    folders = [PLUGIN_FOLDER]
    if named := os.environ.get(PLUGIN_VARIABLE):
        folders.append(Path(named))
    for folder in folders:
        if (folder / "plugInfo.json").is_file():
            return folder
    looked = " and ".join(str(folder) for folder in folders)
    unset = "" if named else f" ({PLUGIN_VARIABLE} is not set)"
    raise RuntimeError(
        f"Umber's renderer is not here: no plugInfo.json in {looked}{unset}. Install the folder that "
        "`cargo xtask hydra` makes, or name the renderer's plugin folder in that variable."
    )


def register() -> None:
    """Loads the delegate's manifest and registers the engine. Raises RuntimeError where there is none."""
    registry = Plug.Registry()
    registry.RegisterPlugins([str(find_plugin())])
    if not any(kind.typeName == PLUGIN_ID for kind in registry.GetAllDerivedTypes("HdRendererPlugin")):
        raise RuntimeError(f"{find_plugin()} brings no {PLUGIN_ID}")
    bpy.utils.register_class(UmberEngine)


def unregister() -> None:
    """Takes the engine back."""
    bpy.utils.unregister_class(UmberEngine)
