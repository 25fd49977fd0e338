"""UsdLux attributes as Blender's custom properties, under the names that UsdLux has for them."""

from __future__ import annotations

import os
from numbers import Real
from pathlib import Path
from typing import Any

import bpy
from pxr import Ar, Gf, Sdf, Usd

from . import exported
from .report import warn

PREFIX = "usd:"
"""Before UsdLux's names, as Blender's exporter writes custom properties as they are called, in types of its own."""

SCHEMA = f"{PREFIX}light"
"""Custom property that names the UsdLux schema, where Blender has no such light: CylinderLight, MeshLightAPI …"""

DOME = f"{PREFIX}dome"
"""Custom property of a portal: the object that is its dome. The World where there is none."""

COLLECTION = f"{PREFIX}collection:"
"""Start of the custom properties of a World that are its collections for linking: Blender links objects alone."""

ATTRIBUTE_STARTS = ("inputs:", "light:materialSyncMode", "treatAs", "poleAxis", "guideRadius")
APIS_BY_START = {"inputs:shaping:": "ShapingAPI", "inputs:shadow:": "ShadowAPI"}

OF_EVERY_LIGHT = frozenset(
    {
        "inputs:color",
        "inputs:colorTemperature",
        "inputs:diffuse",
        "inputs:enableColorTemperature",
        "inputs:exposure",
        "inputs:intensity",
        "inputs:normalize",
        "inputs:shadow:enable",
        "inputs:shaping:ies:file",
        "inputs:specular",
    }
)
OF_ONE_LIGHT = {
    "RectLight": {"inputs:width", "inputs:height"},
    "DiskLight": {"inputs:radius"},
    "CylinderLight": {"inputs:radius"},
    "SphereLight": {"inputs:radius"},
    "DistantLight": {"inputs:angle"},
}
OF_SPOTS = {"inputs:shaping:cone:angle", "inputs:shaping:cone:softness"}


def has_place(schema: str, light: bpy.types.Light) -> frozenset[str]:
    """The attributes of a light of that schema that Blender's `light` has a place for: there the artist decides."""
    of_spots = OF_SPOTS if light.type == "SPOT" else set()
    return OF_EVERY_LIGHT | OF_ONE_LIGHT.get(schema, set()) | of_spots


def keep(prim: Usd.Prim, holder: bpy.types.ID, without: frozenset[str] = frozenset()) -> None:
    """Writes the authored attributes of a light to custom properties of `holder`, as they are at the first frame."""
    for attribute in prim.GetAuthoredAttributes():
        name = attribute.GetName()
        if not name.startswith(ATTRIBUTE_STARTS) or name in without:
            continue
        if attribute.GetNumTimeSamples() > 1:
            warn(holder.name, f"{name} is animated in {prim.GetPath()}; Blender keeps its first value")
        value = attribute.Get(Usd.TimeCode.EarliestTime())
        if value is not None:
            keep_value(holder, name, value)


def keep_value(holder: bpy.types.ID, name: str, value: Any) -> None:  # noqa: ANN401
    """Writes an attribute's value to a custom property of `holder`, and how Blender's panels show it."""
    key = PREFIX + name
    if isinstance(value, Sdf.AssetPath):
        holder[key] = value.resolvedPath or value.path
        holder.id_properties_ui(key).update(subtype="FILE_PATH")
    elif isinstance(value, Gf.Vec3f):
        holder[key] = tuple(value)
        holder.id_properties_ui(key).update(subtype="COLOR", min=0.0, soft_max=1.0)
    elif isinstance(value, bool | int | float | str):
        holder[key] = value
    else:
        warn(holder.name, f"{name} = {value!r} in the stage is of no type that is kept")


def restore(holder: bpy.types.ID, prim: Usd.Prim, without: frozenset[str] = frozenset()) -> None:
    """Writes the custom properties of `holder` that are attributes of the light `prim` back to it.

    One that the light has no attribute for, or whose value the attribute does not take, is named in a warning and left
    out.
    """
    for key in ours(holder):
        name = key.removeprefix(PREFIX)
        if not name.startswith(ATTRIBUTE_STARTS) or name in without:
            continue
        apply_api_of(prim, name)
        if prim.GetPrimDefinition().GetSchemaAttributeSpec(name):
            restore_value(holder.name, key, holder[key], prim.GetAttribute(name))
        else:
            warn(holder.name, f"{key}: a {prim.GetTypeName()} has no such attribute; left out")


def ours(holder: bpy.types.ID) -> list[str]:
    """Names of the custom properties that are for a light."""
    starts = (COLLECTION, *(PREFIX + start for start in ATTRIBUTE_STARTS))
    keys = holder.keys()
    return [key for key in keys if key in (SCHEMA, DOME) or key.startswith(starts)]


def restore_value(owner: str, name: str, value: Any, attribute: Usd.Attribute) -> None:  # noqa: ANN401
    """Writes what is called `name` at the object `owner` to `attribute`, or says why not."""
    try:
        converted = to_usd(value, attribute)
    except ValueError as error:
        shown = value.to_list() if hasattr(value, "to_list") else value
        warn(owner, f"{name} = {shown!r}: {error}; left out")
        return
    if isinstance(converted, Sdf.AssetPath) and converted.path and not Ar.GetResolver().Resolve(converted.path):
        warn(owner, f"{name} = {value!r}: there is no such file")
    elif isinstance(converted, Sdf.AssetPath):
        converted = beside(attribute.GetStage(), converted)
    author(attribute, converted)


def beside(stage: Usd.Stage, asset: Sdf.AssetPath) -> Sdf.AssetPath:
    """The asset as seen from the stage's file, so that both can be moved together; as it is where nobody keeps it."""
    if exported.is_temporary(stage) or not os.path.isabs(asset.path):
        return asset
    try:
        path = os.path.relpath(asset.path, Path(stage.GetRootLayer().realPath).parent)
    except ValueError:
        # on another drive
        return asset
    path = path.replace(os.sep, "/")
    return Sdf.AssetPath(path if path.startswith("../") else f"./{path}")


def author(attribute: Usd.Attribute, value: Any) -> None:  # noqa: ANN401
    """Sets the attribute for all frames, whatever was authored, in the type that its schema has."""
    prim, name = attribute.GetPrim(), attribute.GetName()
    prim.RemoveProperty(name)
    prim.GetAttribute(name).Set(value)


def apply_api_of(prim: Usd.Prim, name: str) -> None:
    """Applies the schema that the attribute `name` belongs to, where that is one to apply.

    ShapingAPI's cone is half a sphere wide where nothing says otherwise; here nothing said so.
    """
    for start, schema in APIS_BY_START.items():
        if name.startswith(start) and schema not in prim.GetAppliedSchemas():
            prim.ApplyAPI(schema)
            if schema == "ShapingAPI":
                prim.GetAttribute("inputs:shaping:cone:angle").Set(180.0)


def to_usd(value: Any, attribute: Usd.Attribute) -> Any:  # noqa: ANN401
    """The custom property's value as the attribute takes it.

    Raises ValueError, with what the attribute takes, where it is no such value.
    """
    kind = attribute.GetTypeName()
    words = attribute.GetMetadata("allowedTokens")
    if kind == Sdf.ValueTypeNames.Asset and isinstance(value, str):
        return Sdf.AssetPath(bpy.path.abspath(value))
    if kind in (Sdf.ValueTypeNames.Token, Sdf.ValueTypeNames.String) and isinstance(value, str):
        if words and value not in words:
            raise ValueError(f"one of {', '.join(words)} is wanted")
        return value
    if kind == Sdf.ValueTypeNames.Color3f:
        numbers = value.to_list() if hasattr(value, "to_list") else []
        if len(numbers) == 3 and all(isinstance(number, Real) for number in numbers):
            return Gf.Vec3f(*numbers)
    elif isinstance(value, Real):
        if kind == Sdf.ValueTypeNames.Bool:
            return bool(value)
        if kind in (Sdf.ValueTypeNames.Float, Sdf.ValueTypeNames.Double):
            return float(value)
        if kind == Sdf.ValueTypeNames.Int and float(value).is_integer():
            return int(value)
    raise ValueError(f"a value of type {kind} is wanted")
