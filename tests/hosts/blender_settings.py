"""Prints settings as JSON: the add-on's properties, with defaults and limits, and those that the delegate lists.

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
    limits = {setting.key: find_limits(groups.final, setting.name) for setting in add_on.properties.SETTINGS}
    print(json.dumps({"delegate": delegate, "limits": limits, **shown}))
    add_on.unregister()
    return driver.DONE


def find_limits(group: bpy.types.PropertyGroup, name: str) -> list[float] | list[str] | None:
    """Smallest and largest value of a property, or its words; none of a switch."""
    declared = group.bl_rna.properties[name]
    if declared.type == "ENUM":
        return [item.identifier for item in declared.enum_items]
    return None if declared.type == "BOOLEAN" else [declared.hard_min, declared.hard_max]


if __name__ == "__main__":
    sys.exit(main())
