"""Shading of meshes as far as it decides about light."""

from __future__ import annotations

import bpy
from pxr import Usd, UsdGeom


def keep_facets(prim: Usd.Prim, mesh: bpy.types.Mesh) -> None:
    """Shades a polygon mesh without normals flat, as OpenUSD has it: Blender's importer would smooth it."""
    schema = UsdGeom.Mesh(prim)
    if not schema or schema.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
        return
    if not schema.GetNormalsAttr().HasAuthoredValue() and not UsdGeom.PrimvarsAPI(prim).HasPrimvar("normals"):
        mesh.shade_flat()
