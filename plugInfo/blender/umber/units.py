"""Units of length: Blender scales what it imports to metres, and leaves the numbers of lights as they are.

That matters where a light is normalized, as its intensity then goes by the area in the world, and for the lengths
of shadows, which are the world's.
"""

from __future__ import annotations

import bpy
from pxr import Usd, UsdGeom, UsdLux

from . import lux

LENGTHS = ("inputs:shadow:distance", "inputs:shadow:falloff")
INTENSITY = "inputs:intensity"


def blender_per_stage(prim: Usd.Prim, holder: bpy.types.Object | bpy.types.World) -> float:
    """Blender's units in one of the stage's, as the importer took them: the importer has its own options.

    Metres for a World, which has no transform to read them from.
    """
    if isinstance(holder, bpy.types.World):
        return UsdGeom.GetStageMetersPerUnit(prim.GetStage())
    in_stage = abs(UsdGeom.XformCache().GetLocalToWorldTransform(prim).GetDeterminant())
    in_blender = abs(holder.matrix_world.determinant())
    return (in_blender / in_stage) ** (1.0 / 3.0) if in_stage > 0.0 else 1.0


def goes_by_area(prim: Usd.Prim) -> bool:
    """Whether the light's intensity goes by an area in the world."""
    anywhere = prim.IsA(UsdLux.DistantLight) or prim.IsA(UsdLux.DomeLight) or prim.IsA(UsdLux.DomeLight_1)
    return not anywhere and UsdLux.LightAPI(prim).GetNormalizeAttr().Get(Usd.TimeCode.EarliestTime()) is True


def scale_kept(prim: Usd.Prim, holder: bpy.types.Object | bpy.types.World) -> None:
    """Turns what was kept of the light `prim` into Blender's units."""
    scale = blender_per_stage(prim, holder)
    if is_one(scale):
        return
    for key in (lux.PREFIX + name for name in LENGTHS):
        if key in holder:
            holder[key] *= scale
    if not goes_by_area(prim):
        return
    if isinstance(holder.data, bpy.types.Light):
        holder.data.energy *= scale**2
    else:
        key = lux.PREFIX + INTENSITY
        holder[key] = holder.get(key, 1.0) * scale**2


def scale_restored(prim: Usd.Prim) -> None:
    """Turns the light `prim` of an exported stage from Blender's units into the stage's."""
    scale = 1.0 / UsdGeom.GetStageMetersPerUnit(prim.GetStage())
    if is_one(scale):
        return
    powers = dict.fromkeys(LENGTHS, 1) | ({INTENSITY: 2} if goes_by_area(prim) else {})
    for name, power in powers.items():
        attribute = prim.GetAttribute(name)
        for time in attribute.GetTimeSamples() or [Usd.TimeCode.Default()]:
            if attribute.HasAuthoredValue() or name == INTENSITY:
                attribute.Set(attribute.Get(time) * scale**power, time)


def is_one(scale: float) -> bool:
    """Whether the scale changes nothing, but for what single precision leaves of transforms."""
    return abs(scale - 1.0) < 1e-5
