"""UsdGeomMesh, and the shapes that Hydra turns into meshes."""

from __future__ import annotations

from pxr import Sdf, Usd, UsdGeom, UsdShade

from umber.description import Mesh, Subset
from umber.stage_reader import implicit, primvars
from umber.stage_reader.placement import Space
from umber.stage_reader.reading import Reading, floats, ints, matrix

SCHEMES = ("none", "catmullClark", "loop", "bilinear")


def subset_prims(prim: Usd.Prim) -> list[Usd.Prim]:
    """Subsets of the mesh's faces that materials are bound to."""
    if not prim.GetAllChildrenNames():
        return []
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    return [s.GetPrim() for s in subsets if s.GetElementTypeAttr().Get() == UsdGeom.Tokens.face]


def read_mesh(
    reading: Reading, prim: Usd.Prim, space: Space, purpose: str, materials: dict[Sdf.Path, str | None]
) -> Mesh | None:
    """A mesh or implicit shape; None where it has nothing to show. ValueError says what keeps it from being one.

    `materials`: path of each bound material, by the path of the mesh or subset.
    """
    shape = implicit.shape(reading, prim)
    if shape is None:
        points = reading.value(prim, "points")
        counts = ints(reading.value(prim, "faceVertexCounts"))
        if points is None or not len(points) or not counts.size:
            return None
        kind, points = type(points).__name__, floats(points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"its points are a {kind}, not triples")
        indices, holes = (ints(reading.value(prim, name)) for name in ("faceVertexIndices", "holeIndices"))
        scheme = reading.value(prim, "subdivisionScheme")
        if scheme not in SCHEMES:
            reading.warn(prim, f"subdivision scheme '{scheme}' is not known; taken as 'none'")
            scheme = "none"
        orientation = reading.value(prim, "orientation")
        normals = primvars.normals(reading, prim) if scheme == "none" else None
    else:
        points, counts, indices, scheme = shape
        holes, orientation, normals = ints(None), "rightHanded", None
    return Mesh(
        path=reading.unique_path(prim.GetPath()),
        points=points,
        face_vertex_counts=counts,
        face_vertex_indices=indices,
        hole_indices=holes,
        subdivision_scheme=scheme,
        orientation=orientation,
        normals=normals,
        primvars=primvars.inherited(reading, prim),
        subsets=_subsets(reading, prim, materials) if shape is None else [],
        transform=matrix(space.from_object(reading, prim)),
        purpose=purpose,
        # of the implicit shapes, Hydra asks planes alone
        double_sided=(shape is None or prim.GetTypeName() == "Plane") and bool(reading.value(prim, "doubleSided")),
        material=materials.get(prim.GetPath()),
        instancer=space.instancer,
        instance_indices=space.indices,
    )


def _subsets(reading: Reading, prim: Usd.Prim, materials: dict[Sdf.Path, str | None]) -> list[Subset]:
    found = []
    for subset in subset_prims(prim):
        faces = reading.value(subset, "indices")
        if faces is not None:
            found.append(Subset(materials.get(subset.GetPath()), ints(faces)))
    return found
