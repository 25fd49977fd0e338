"""Stages that the report makes for itself, so that every renderer can read them alike.

What they share is a small part of USD: triangle meshes with flat normals, Lambertian or rough-metal UsdPreviewSurfaces
with constant inputs, one camera, lights that all peers know. A scene that has more is brought down to that (`plain`):
transforms and instances are written out, faces become triangles, subsets become meshes, materials keep their diffuse
colour alone. So a difference between two renderers is one of light transport, and not of how each reads a texture.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, Vt

Color = tuple[float, float, float]
Points = NDArray[np.float64]
Triangles = NDArray[np.int64]
Matrix = NDArray[np.float64]
# Of a mesh without a material, and of a mesh by its path where the asset's own colour is a texture.
GREY: Color = (0.18, 0.18, 0.18)
ColorOf = Callable[[Usd.Prim], Color]


def new_stage(file: Path) -> Usd.Stage:
    """An empty one, Y up, in metres."""
    file.parent.mkdir(parents=True, exist_ok=True)
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    return stage


def save(stage: Usd.Stage, file: Path) -> Path:
    """Written whole or not at all."""
    part = file.with_name("part_" + file.name)
    stage.GetRootLayer().Export(str(part))
    part.replace(file)
    return file


def lambert(stage: Usd.Stage, color: Color) -> UsdShade.Material:
    """A Lambertian material, one for each colour."""
    name = "Color_" + "_".join(f"{round(1000 * channel):04d}" for channel in color)
    path = Sdf.Path(f"/World/Looks/{name}")
    if known := UsdShade.Material.Get(stage, path):
        return known
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, path.AppendChild("Surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*color))
    shader.CreateInput("useSpecularWorkflow", Sdf.ValueTypeNames.Int).Set(1)
    shader.CreateInput("specularColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.0))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1.0)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return material


def add_mesh(stage: Usd.Stage, path: str, points: Points, triangles: Triangles, color: Color) -> UsdGeom.Mesh:
    """A mesh of triangles; points that none uses are left out."""
    used, corners = np.unique(triangles, return_inverse=True)
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points[used], dtype=np.float32)))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray([3] * len(triangles)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners.reshape(-1).astype(np.int32)))
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(lambert(stage, color))
    return mesh


def add_camera(stage: Usd.Stage, of: Usd.Prim) -> None:
    """The camera of another stage, at its place; without an offset, which not every peer reads."""
    camera = UsdGeom.Camera.Define(stage, "/World/Camera")
    seen = UsdGeom.Camera(of).GetCamera(Usd.TimeCode.EarliestTime())
    seen.horizontalApertureOffset = seen.verticalApertureOffset = 0.0
    seen.transform = UsdGeom.Xformable(of).ComputeLocalToWorldTransform(Usd.TimeCode.EarliestTime())
    camera.SetFromCamera(seen)


def look(stage: Usd.Stage, eye: Gf.Vec3d, target: Gf.Vec3d, aperture: tuple[float, float], focal_length: float) -> None:
    """A camera of this stage's own. The aperture has the picture's shape, so that no peer has to conform it."""
    camera = UsdGeom.Camera.Define(stage, "/World/Camera")
    view = Gf.Matrix4d().SetLookAt(eye, target, Gf.Vec3d(0, 1, 0))
    camera.MakeMatrixXform().Set(view.GetInverse())
    camera.CreateHorizontalApertureAttr(aperture[0])
    camera.CreateVerticalApertureAttr(aperture[1])
    camera.CreateFocalLengthAttr(focal_length)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1e5))


def add_sky(stage: Usd.Stage, sky: float, sun: float) -> None:
    """An even dome of that radiance, and a sun without a size of that irradiance."""
    dome = UsdLux.DomeLight.Define(stage, "/World/Sky")
    dome.CreateIntensityAttr(sky)
    dome.CreateColorAttr(Gf.Vec3f(1.0))  # Blender takes one that is left out for magenta
    light = UsdLux.DistantLight.Define(stage, "/World/Sun")
    light.CreateAngleAttr(0.0)
    light.CreateNormalizeAttr(True)
    light.CreateIntensityAttr(sun)
    light.AddRotateXYZOp().Set(Gf.Vec3f(-50, 30, 0))


def fan(counts: NDArray[np.int64], indices: NDArray[np.int64]) -> tuple[Triangles, NDArray[np.int64]]:
    """Triangles of a mesh's faces, by point, each face a fan from its first corner; and the face of each."""
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    faces = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
    within = np.arange(len(faces)) - np.repeat(np.cumsum(np.maximum(counts - 2, 0)), np.maximum(counts - 2, 0))
    within += np.repeat(np.maximum(counts - 2, 0), np.maximum(counts - 2, 0))
    first = starts[faces]
    return np.stack([indices[first], indices[first + within + 1], indices[first + within + 2]], axis=1), faces


def _shown(prim: Usd.Prim) -> bool:
    image = UsdGeom.Imageable(prim)
    return prim.IsA(UsdGeom.Mesh) and image.ComputeVisibility() != "invisible" and image.ComputePurpose() == "default"


def _world(prim: Usd.Prim) -> Matrix:
    """World from object, for row vectors."""
    return np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.EarliestTime()))


def _meshes(root: Usd.Prim) -> Iterator[tuple[Usd.Prim, Matrix]]:
    """Every mesh that is shown, with its place; one of a PointInstancer at each of its instances."""
    walk = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    for prim in walk:
        if prim.IsA(UsdGeom.PointInstancer):
            walk.PruneChildren()
            yield from _instanced(UsdGeom.PointInstancer(prim))
        elif _shown(prim):
            yield prim, _world(prim)


def _instanced(instancer: UsdGeom.PointInstancer) -> Iterator[tuple[Usd.Prim, Matrix]]:
    time, prim = Usd.TimeCode.EarliestTime(), instancer.GetPrim()
    prototypes = [prim.GetStage().GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetTargets()]
    exclude = UsdGeom.PointInstancer.ExcludeProtoXform
    places = instancer.ComputeInstanceTransformsAtTime(time, time, exclude)
    for which, place in zip(instancer.GetProtoIndicesAttr().Get(time), places, strict=True):
        outside = np.linalg.inv(_world(prototypes[which].GetParent()))
        for mesh, to_world in _meshes(prototypes[which]):
            yield mesh, to_world @ outside @ np.array(place) @ _world(prim)


def diffuse_color(prim: Usd.Prim) -> Color:
    """Of the UsdPreviewSurface that is bound; where there is none, or its colour is no constant, a grey."""
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    source = material.ComputeSurfaceSource()[0] if material else None
    value = source.GetInput("diffuseColor").Get() if source and source.GetInput("diffuseColor") else None
    return GREY if value is None else (float(value[0]), float(value[1]), float(value[2]))


def chess_color(prim: Usd.Prim) -> Color:
    """Of the chess set, whose own colours are textures: those of its sides."""
    path = str(prim.GetPath())
    if "/Black/" in path:
        return (0.06, 0.05, 0.045)
    return (0.65, 0.6, 0.5) if "/White/" in path else (0.3, 0.2, 0.12)


def plain(source: Path, file: Path, color_of: ColorOf, textures: Path) -> Path:
    """A stage brought down to what all renderers read alike: see the head of this file. Domes keep their textures."""
    asset = Usd.Stage.Open(str(source))
    stage = new_stage(file)
    time, number = Usd.TimeCode.EarliestTime(), 0
    for prim, to_world in _meshes(asset.GetPseudoRoot()):
        mesh = UsdGeom.Mesh(prim)
        points = np.array(mesh.GetPointsAttr().Get(time), dtype=np.float64)
        points = (np.c_[points, np.ones(len(points))] @ to_world)[:, :3]
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get(time), dtype=np.int64)
        indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(time), dtype=np.int64)
        triangles, faces = fan(counts, indices)
        rest = np.ones(len(counts), dtype=bool)
        parts = []
        for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
            chosen = np.array(subset.GetIndicesAttr().Get(time), dtype=np.int64)
            mask = np.zeros(len(counts), dtype=bool)
            mask[chosen], rest[chosen] = True, False
            parts.append((subset.GetPrim(), mask))
        for of, mask in [*parts, (prim, rest)]:
            if (chosen_triangles := triangles[mask[faces]]).size:
                add_mesh(stage, f"/World/Mesh_{number:04d}", points, chosen_triangles, color_of(of))
                number += 1
    add_camera(stage, next(prim for prim in asset.Traverse() if prim.IsA(UsdGeom.Camera)))
    for prim in (p for p in asset.Traverse() if p.IsA(UsdLux.DomeLight)):
        dome = UsdLux.DomeLight(prim)
        copy = UsdLux.DomeLight.Define(stage, "/World/Dome")
        copy.CreateIntensityAttr(dome.GetIntensityAttr().Get())
        copy.CreateColorAttr(dome.GetColorAttr().Get())
        texture = dome.GetTextureFileAttr().Get()
        # the assets name a folder that is not there; the pictures lie beside them
        if texture and (found := textures / Path(texture.path).name).exists():
            copy.CreateTextureFileAttr(Sdf.AssetPath(str(found.resolve())))
            copy.CreateTextureFormatAttr("latlong")
    return save(stage, file)


def icosphere(seed: Path, file: Path) -> Path:
    """The textbook's icosphere, Lambertian, under an even sky and a sun: an overlay of the stage as it is."""
    stage = new_stage(file)
    stage.GetRootLayer().subLayerPaths.append(str(seed.resolve()))
    sphere = stage.OverridePrim("/World/Icosphere")
    UsdShade.MaterialBindingAPI.Apply(sphere).Bind(lambert(stage, (0.6, 0.6, 0.6)))
    # half a pixel, which Mitsuba's converter does not read
    eye = UsdGeom.Camera(stage.GetPrimAtPath("/World/Eye"))
    eye.GetHorizontalApertureOffsetAttr().Set(0.0)
    eye.GetVerticalApertureOffsetAttr().Set(0.0)
    add_sky(stage, 0.5, 2.0)
    return save(stage, file)


def bumpy_sphere(levels: int) -> tuple[Points, Triangles]:
    """A unit sphere of `20 * 4^levels` triangles, with bumps of a tenth of its radius."""
    golden = (1 + math.sqrt(5)) / 2
    corners = [(s, t * golden, 0.0) for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    points = np.array([np.roll(corner, turn) for corner in corners for turn in range(3)])
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < 2.01
    number = len(points)
    triangles = np.array(
        [
            (a, b, c)
            for a in range(number)
            for b in range(a + 1, number)
            for c in range(b + 1, number)
            if near[a, b] and near[b, c] and near[a, c]
        ]
    )
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    for _ in range(levels):
        edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        unique, which = np.unique(edges, axis=0, return_inverse=True)
        middles = points[unique].sum(axis=1)
        middles /= np.linalg.norm(middles, axis=1, keepdims=True)
        ab, bc, ca = (which.reshape(-1).reshape(3, -1) + len(points))[:3]
        a, b, c = triangles.T
        split = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = np.concatenate([np.stack(part, axis=1) for part in split])
        points = np.concatenate([points, middles])
    first, second, third = (points[triangles[:, corner]] for corner in range(3))
    inwards = (np.cross(second - first, third - first) * first).sum(axis=1) < 0
    triangles[inwards] = triangles[inwards][:, [0, 2, 1]]
    bumps = np.sin(7 * points[:, 0]) * np.sin(8 * points[:, 1]) * np.sin(9 * points[:, 2])
    return points * (1 + 0.1 * bumps[:, None]), triangles


# Along each side of the grid: 317^2 = 100 489 instances.
ALONG = 317


def instances(file: Path, along: int = ALONG) -> Path:
    """A PointInstancer's grid of bumpy spheres, each turned and scaled, over a floor, seen from above its edge."""
    stage = new_stage(file)
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/Grid")
    points, triangles = bumpy_sphere(3)
    prototype = add_mesh(stage, "/World/Grid/Prototypes/Bumpy", points, triangles, (0.6, 0.45, 0.3))
    instancer.CreatePrototypesRel().AddTarget(prototype.GetPath())
    random = np.random.default_rng(5)
    at = np.arange(along) - (along - 1) / 2
    x, z = (axis.reshape(-1) for axis in np.meshgrid(at, at))
    scales = random.uniform(0.25, 0.48, len(x))
    turns = random.standard_normal((len(x), 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    places = np.stack([x, scales, z], axis=1).astype(np.float32)
    instancer.CreatePositionsAttr(Vt.Vec3fArray.FromNumpy(places))
    instancer.CreateScalesAttr(Vt.Vec3fArray.FromNumpy(np.repeat(scales[:, None], 3, axis=1).astype(np.float32)))
    quaternions = [Gf.Quath(float(w), float(i), float(j), float(k)) for w, i, j, k in turns]
    instancer.CreateOrientationsAttr(Vt.QuathArray(quaternions))
    instancer.CreateProtoIndicesAttr(Vt.IntArray([0] * len(x)))
    reach = float(along)
    floor = np.array([[-reach, 0, -reach], [-reach, 0, reach], [reach, 0, reach], [reach, 0, -reach]])
    add_mesh(stage, "/World/Floor", floor, np.array([[0, 1, 2], [0, 2, 3]]), (0.4, 0.4, 0.4))
    look(stage, Gf.Vec3d(0, 14, 0.55 * along), Gf.Vec3d(0, 0, 0.3 * along), (36.0, 20.25), 40.0)
    add_sky(stage, 0.4, 2.0)
    return save(stage, file)
