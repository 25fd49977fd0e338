"""Primvars of a mesh, expanded from their indices."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from umber.description import Primvar
from umber.stage_reader.reading import Reading, floats

# What the renderer looks at, and the number of components it wants there.
COMPONENTS = {"displayColor": 3, "displayOpacity": 1, "st": 2}


def from_usd(reading: Reading, primvar: UsdGeom.Primvar, components: int) -> Primvar | None:
    """The values of a primvar; None where it has none, or of another kind than wanted."""
    prim, name = primvar.GetAttr().GetPrim(), primvar.GetPrimvarName()
    value = primvar.ComputeFlattened(reading.time)
    if value is None:
        if primvar.HasValue():
            reading.warn(prim, f"primvar '{name}' is left out: its indices do not fit its values")
        return None
    try:
        values = floats(value)
    except (TypeError, ValueError):
        reading.warn(prim, f"primvar '{name}' is left out: {primvar.GetTypeName()} is not numeric")
        return None
    if not primvar.GetTypeName().isArray:
        values = values.reshape(1, -1)
    wanted: tuple[int, ...] = (len(values), components)
    if components == 1:
        values, wanted = values.reshape(len(values), -1)[:, 0], (len(values),)
    if values.size == 0:
        return None
    if values.shape != wanted:
        reading.warn(prim, f"primvar '{name}' is left out: {primvar.GetTypeName()} has not {components} components")
        return None
    stride = primvar.GetElementSize()
    if stride > 1:
        values = np.ascontiguousarray(values[::stride])
    return Primvar(values, primvar.GetInterpolation())


def inherited(reading: Reading, prim: Usd.Prim) -> dict[str, Primvar]:
    """The primvars that the renderer looks at, the prim's own or inherited."""
    found = {}
    api = UsdGeom.PrimvarsAPI(prim)
    for name, components in COMPONENTS.items():
        primvar = api.FindPrimvarWithInheritance(name)
        if primvar and primvar.HasValue():
            converted = from_usd(reading, primvar, components)
            if converted is not None:
                found[name] = converted
    return found


def normals(reading: Reading, prim: Usd.Prim) -> Primvar | None:
    """Authored normals of a polygonal mesh: `primvars:normals`, own or inherited, before `normals`."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("normals")
    if primvar and primvar.HasValue():
        return from_usd(reading, primvar, 3)
    values = reading.value(prim, "normals")
    if values is None or len(values) == 0:
        return None
    return Primvar(floats(values), UsdGeom.PointBased(prim).GetNormalsInterpolation())
