"""Dumps the triangles of a USD stage, as `bench` reads them (see src/scenes/dump.rs).

`python dump_triangles.py STAGE OUT`: the world-space triangles of every visible mesh of purpose
default or render, control cages as they are, faces cut into fans, and the first camera.
"""

import sys

import numpy as np
from pxr import Gf, Usd, UsdGeom

SHOWN = (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


def fans(counts, indices):
    """Triangles of polygons, each cut from its first corner."""
    starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)
    triangles = []
    for size in np.unique(counts):
        first = starts[counts == size]
        for corner in range(1, size - 1):
            triangles.append(np.stack([indices[first], indices[first + corner], indices[first + corner + 1]], axis=1))
    return np.concatenate(triangles) if triangles else np.zeros((0, 3), np.uint32)


def meshes(stage):
    """Points (world) and triangles of each mesh."""
    cache = UsdGeom.XformCache()
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        mesh = UsdGeom.Mesh(prim)
        if not mesh or mesh.ComputeVisibility() == UsdGeom.Tokens.invisible or mesh.ComputePurpose() not in SHOWN:
            continue
        points = mesh.GetPointsAttr().Get()
        indices = np.asarray(mesh.GetFaceVertexIndicesAttr().Get() or [], np.uint32)
        counts = np.asarray(mesh.GetFaceVertexCountsAttr().Get() or [], np.int64)
        if not points or counts.sum() != len(indices):
            continue
        world = np.asarray(cache.GetLocalToWorldTransform(prim))
        yield np.asarray(points, np.float64) @ world[:3, :3] + world[3, :3], fans(counts, indices)


def view(stage, points):
    """The first camera's position, a point before it, about where the scene is, and the width of its picture
    at distance one; else as seen from a corner."""
    low, high = points.min(axis=0), points.max(axis=0)
    center, reach = (low + high) / 2, np.linalg.norm(high - low)
    for prim in stage.Traverse():
        camera = UsdGeom.Camera(prim)
        if camera:
            lens = camera.GetCamera()
            world = UsdGeom.XformCache().GetLocalToWorldTransform(prim)
            eye = np.asarray(world.Transform(Gf.Vec3d(0)))
            ahead = np.asarray(world.TransformDir(Gf.Vec3d(0, 0, -1)))
            ahead /= np.linalg.norm(ahead)
            return eye, eye + ahead * max(np.dot(center - eye, ahead), reach * 0.05), lens.horizontalAperture / lens.focalLength
    return center + np.array([0.3, 0.3, 0.5]) * reach, center, 1.2


def main(stage_path, out):
    stage = Usd.Stage.Open(stage_path)
    points, triangles, base = [], [], 0
    for mesh_points, mesh_triangles in meshes(stage):
        points.append(mesh_points)
        triangles.append(mesh_triangles + np.uint32(base))
        base += len(mesh_points)
    points, triangles = np.concatenate(points), np.concatenate(triangles)
    eye, target, width = view(stage, points)
    with open(out, "wb") as file:
        file.write(b"UMBERTRI")
        file.write(np.array([len(points), len(triangles)], "<u4").tobytes())
        file.write(np.concatenate([eye, target, [width]]).astype("<f4").tobytes())
        file.write(points.astype("<f4").tobytes())
        file.write(triangles.astype("<u4").tobytes())
    print(f"{out}: {len(triangles)} triangles")


if __name__ == "__main__":
    main(*sys.argv[1:3])
