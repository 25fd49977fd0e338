"""UsdSkel: skinned meshes take the pose of the reading's time code."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom, UsdSkel, Vt

from umber.description import Doubles, Floats, Mesh
from umber.stage_reader.reading import Reading, floats, matrix

PREDICATE = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


class Skins:
    """Meshes that skeletons deform, by path."""

    def __init__(self, reading: Reading, roots: list[Usd.Prim]) -> None:
        self._reading = reading
        self._cache = UsdSkel.Cache()
        self._bound: dict[str, tuple[UsdSkel.SkeletonQuery, UsdSkel.SkinningQuery]] = {}
        for prim in roots:
            root = UsdSkel.Root(prim)
            self._cache.Populate(root, PREDICATE)
            for binding in self._cache.ComputeSkelBindings(root, PREDICATE):
                skeleton = self._cache.GetSkelQuery(binding.GetSkeleton())
                for query in binding.GetSkinningTargets():
                    self._bound[query.GetPrim().GetPath()] = (skeleton, query)

    def pose(self, prim: Usd.Prim, mesh: Mesh) -> None:
        """Moves points and normals of a skinned mesh; leaves any other as it is."""
        skeleton, query = self._bound.get(prim.GetPath(), (None, None))
        if skeleton is None or query is None:
            return
        points = Vt.Vec3fArray.FromNumpy(mesh.points)
        if query.HasBlendShapes():
            points = self._blend(prim, skeleton, query, points)
        if query.HasJointInfluences():
            if not self._skin(prim, skeleton, query, points, mesh):
                self._reading.warn(prim, "the mesh keeps its rest pose: UsdSkel could not skin it")
                return
        else:
            mesh.points = floats(points)

    def _skin(
        self,
        prim: Usd.Prim,
        skeleton: UsdSkel.SkeletonQuery,
        query: UsdSkel.SkinningQuery,
        points: Vt.Vec3fArray,
        mesh: Mesh,
    ) -> bool:
        time = self._reading.time
        joints = skeleton.ComputeSkinningTransforms(time)
        if joints is None or not query.ComputeSkinnedPoints(joints, points, time):
            return False
        world = UsdGeom.XformCache(time)
        back = world.GetLocalToWorldTransform(skeleton.GetPrim()) * (world.GetLocalToWorldTransform(prim).GetInverse())
        mesh.points = _moved(floats(points), matrix(back))
        # the authored normals belong to the rest pose
        mesh.normals = None
        return True

    def _blend(
        self, prim: Usd.Prim, skeleton: UsdSkel.SkeletonQuery, query: UsdSkel.SkinningQuery, points: Vt.Vec3fArray
    ) -> Vt.Vec3fArray:
        animation, mapper = skeleton.GetAnimQuery(), query.GetBlendShapeMapper()
        if not animation or mapper is None:
            return points
        weights = mapper.Remap(animation.ComputeBlendShapeWeights(self._reading.time))
        shapes = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(prim))
        parts = shapes.ComputeSubShapeWeights(weights)
        indices, offsets = shapes.ComputeBlendShapePointIndices(), shapes.ComputeSubShapePointOffsets()
        if not shapes.ComputeDeformedPoints(*parts, indices, offsets, points):
            self._reading.warn(prim, "the mesh keeps its rest shape: UsdSkel could not blend its shapes")
        return points


def _moved(points: Floats, transform: Doubles) -> Floats:
    """Points (n, 3) by a transform (4, 4) in USD's layout."""
    return floats(points.astype(np.float64) @ transform[:3, :3] + transform[3, :3])
