"""Writes the stages of docs/from-polygon-to-path.md beside itself.

    target/venv/usd-core/bin/python docs/scenes/chapter/make.py

`icosphere.usda`: a sphere of 80 triangles, five units behind the plane z = 0, seen from (0, 0, 1) through the square of
half width 0.2 on that plane. `lit.usda`: the same sphere on a floor between a red wall and a green one, under a
rectangle of light; `smooth.usda`: that with a normal at each point of the sphere.
"""

from __future__ import annotations

from pathlib import Path

from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade

HERE = Path(__file__).parent
GOLDEN = (1 + 5**0.5) / 2
SPHERE = Gf.Vec3d(0, 0, -5)
Triangles = list[tuple[int, int, int]]


def icosphere(splits: int) -> tuple[list[Gf.Vec3d], Triangles]:
    """Points on the unit sphere and triangles: an icosahedron, each of whose triangles is split in four, `splits` times."""
    corners = [(-1, GOLDEN, 0), (1, GOLDEN, 0), (-1, -GOLDEN, 0), (1, -GOLDEN, 0)]
    points = [Gf.Vec3d(c[(0 + k) % 3], c[(1 + k) % 3], c[(2 + k) % 3]).GetNormalized() for k in (0, 2, 1) for c in corners]
    faces: Triangles = [
        *[(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11)],
        *[(1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)],
        *[(3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9)],
        *[(4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)],
    ]
    for _ in range(splits):
        middles: dict[tuple[int, int], int] = {}

        def middle(a: int, b: int, known: dict[tuple[int, int], int] = middles) -> int:
            key = (min(a, b), max(a, b))
            if key not in known:
                known[key] = len(points)
                points.append((points[a] + points[b]).GetNormalized())
            return known[key]

        finer: Triangles = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    return points, faces


def add_mesh(stage: Usd.Stage, path: str, points: list[Gf.Vec3d], faces: list[tuple[int, ...]]) -> UsdGeom.Mesh:
    """A mesh of polygons as they are."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreatePointsAttr([Gf.Vec3f(p) for p in points])
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([i for face in faces for i in face])
    return mesh


def add_matte(stage: Usd.Stage, mesh: UsdGeom.Mesh, color: tuple[float, float, float]) -> None:
    """Gives a mesh a matte colour, on both sides."""
    path = f"/Looks/{mesh.GetPrim().GetName()}"
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(color)
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1.0)
    shader.CreateInput("useSpecularWorkflow", Sdf.ValueTypeNames.Int).Set(1)
    shader.CreateInput("specularColor", Sdf.ValueTypeNames.Color3f).Set((0, 0, 0))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    mesh.CreateDoubleSidedAttr(True)


def textbook(splits: int = 1) -> Usd.Stage:
    """The sphere as the textbook sees it. A camera's picture is sampled at pixel middles, the textbook's at corners: its
    aperture is moved by half a pixel of 256."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    sphere = add_mesh(stage, "/Icosphere", *icosphere(splits))
    sphere.CreateDisplayColorAttr([Gf.Vec3f(0.8)])
    UsdGeom.XformCommonAPI(sphere).SetTranslate(SPHERE)
    camera = UsdGeom.Camera.Define(stage, "/Eye")
    camera.CreateFocalLengthAttr(50.0)
    camera.CreateHorizontalApertureAttr(20.0)
    camera.CreateVerticalApertureAttr(20.0)
    camera.CreateHorizontalApertureOffsetAttr(-20.0 / 512)
    camera.CreateVerticalApertureOffsetAttr(20.0 / 512)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1000))
    UsdGeom.XformCommonAPI(camera).SetTranslate(Gf.Vec3d(0, 0, 1))
    return stage


def lit(smooth: bool) -> Usd.Stage:
    """The sphere in an open box."""
    stage = textbook()
    sphere = UsdGeom.Mesh.Get(stage, "/Icosphere")
    add_matte(stage, sphere, (0.8, 0.8, 0.8))
    if smooth:
        sphere.CreateNormalsAttr(sphere.GetPointsAttr().Get())
        sphere.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    low, high, near, far = -1.0, 2.0, -3.5, -6.6
    walls = {
        "Floor": ([(-1.7, low, near), (1.7, low, near), (1.7, low, far), (-1.7, low, far)], (0.7, 0.7, 0.7)),
        "Back": ([(-1.7, low, far), (1.7, low, far), (1.7, high, far), (-1.7, high, far)], (0.7, 0.7, 0.7)),
        "Left": ([(-1.7, low, near), (-1.7, low, far), (-1.7, high, far), (-1.7, high, near)], (0.7, 0.1, 0.08)),
        "Right": ([(1.7, low, far), (1.7, low, near), (1.7, high, near), (1.7, high, far)], (0.1, 0.5, 0.12)),
    }
    for name, (corners, color) in walls.items():
        add_matte(stage, add_mesh(stage, f"/{name}", [Gf.Vec3d(c) for c in corners], [(0, 1, 2, 3)]), color)
    light = UsdLux.RectLight.Define(stage, "/Lamp")
    light.CreateWidthAttr(1.2)
    light.CreateHeightAttr(1.2)
    light.CreateIntensityAttr(14.0)
    UsdGeom.XformCommonAPI(light).SetTranslate(Gf.Vec3d(0.2, 2.4, -4.6))
    UsdGeom.XformCommonAPI(light).SetRotate(Gf.Vec3f(-90, 0, 0))
    camera = UsdGeom.Camera.Get(stage, "/Eye")
    camera.GetHorizontalApertureOffsetAttr().Set(0.0)
    camera.GetVerticalApertureOffsetAttr().Set(0.0)
    camera.GetFocalLengthAttr().Set(34.0)
    UsdGeom.XformCommonAPI(camera).SetTranslate(Gf.Vec3d(0, 0.35, 1))
    return stage


def main() -> None:
    """Writes them."""
    stages = {"icosphere": textbook(), "lit": lit(smooth=False), "smooth": lit(smooth=True)}
    for name, stage in stages.items():
        stage.GetRootLayer().Export(str(HERE / f"{name}.usda"))


if __name__ == "__main__":
    main()
