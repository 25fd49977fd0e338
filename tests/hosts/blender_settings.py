"""Prints settings as JSON: those of the add-on's properties, with their defaults, and those that the delegate lists.

Runs where blender_render.py does.
"""

from __future__ import annotations

import json
import sys

import blender_render as driver
import bpy


def main() -> int:
    """Prints them; the exit code."""
    add_on = driver.add_on()
    from pxr import UsdImagingGL  # noqa: PLC0415 (only there once the add-on is)

    parameters = UsdImagingGL.Engine.Parameters()
    parameters.rendererPluginId, parameters.gpuEnabled = add_on.engine.PLUGIN_ID, False
    delegate = {row.key: row.defValue for row in UsdImagingGL.Engine(parameters).GetRendererSettingsList()}
    groups = bpy.context.scene.umber
    shown = {name: add_on.properties.by_key(getattr(groups, name)) for name in ("final", "viewport")}
    print(json.dumps({"delegate": delegate, **shown}))
    add_on.unregister()
    return driver.DONE


if __name__ == "__main__":
    sys.exit(main())
