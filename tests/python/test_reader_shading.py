"""Lights, materials, cameras and implicit shapes as the reader describes them."""

from collections.abc import Callable

import numpy as np
import pytest
from conftest import Scene, stage_of
from pxr import Gf, Sdf, Usd, UsdGeom
from umber.description import Shadow, Shaping
from umber.stage_reader import camera_light, find_camera, free_camera, implicit, read_camera

Read = Callable[..., Scene]


def test_lights(read: Read) -> None:
    scene = read("""
        def RectLight "rect" {
            float inputs:width = 3
            float inputs:height = 4
            color3f inputs:color = (1, 0.5, 0.25)
            float inputs:intensity = 7
            float inputs:exposure = 2
            bool inputs:normalize = 1
            bool inputs:enableColorTemperature = 1
            float inputs:colorTemperature = 4000
            float inputs:diffuse = 0.5
            float inputs:specular = 0.25
        }
        def SphereLight "sphere" (prepend apiSchemas = ["ShadowAPI"]) {
            float inputs:radius = 0.1
            bool treatAsPoint = 1
            bool inputs:shadow:enable = 0
        }
        def DistantLight "sun" { float inputs:angle = 1 }
        def DomeLight "sky" { asset inputs:texture:file = @nowhere.hdr@ }
        """)
    rect, sphere = scene.lights["/rect"], scene.lights["/sphere"]
    assert (rect.kind, rect.width, rect.height, rect.color) == ("rect", 3, 4, (1, 0.5, 0.25))
    assert (rect.intensity, rect.exposure, rect.normalize, rect.color_temperature) == (7, 2, True, 4000)
    assert (rect.diffuse, rect.specular, rect.shadow_enable) == (0.5, 0.25, True)
    assert (sphere.kind, sphere.treat_as_point, sphere.shadow_enable) == ("sphere", True, False)
    assert sphere.radius == float(np.float32(0.1)) and sphere.color_temperature is None
    assert (scene.lights["/sun"].angle_deg, scene.lights["/sun"].intensity) == (1, 50000)
    assert scene.lights["/sky"].texture_file == "nowhere.hdr"


def test_shapes_of_lights(read: Read) -> None:
    scene = read("""
        def DiskLight "disk" { float inputs:radius = 2 }
        def DiskLight "plainDisk" {}
        def CylinderLight "tube" {
            float inputs:length = 3
            float inputs:radius = 0.25
        }
        def CylinderLight "line" { bool treatAsLine = 1 }
        def RectLight "card" { asset inputs:texture:file = @card.png@ }
        """)
    lights = scene.lights
    disks = lights["/disk"], lights["/plainDisk"]
    assert [(disk.kind, disk.radius) for disk in disks] == [("disk", 2), ("disk", 0.5)]
    tube, line = lights["/tube"], lights["/line"]
    assert (tube.kind, tube.length, tube.radius, tube.treat_as_line) == ("cylinder", 3, 0.25, False)
    assert (line.kind, line.length, line.radius, line.treat_as_line) == ("cylinder", 1, 0.5, True)
    assert lights["/card"].texture_file == "card.png" and not scene.warnings


def test_texture_formats_of_domes(read: Read) -> None:
    formats = ("automatic", "latlong", "mirroredBall", "angular", "cubeMapVerticalCross")
    domes = "".join(f'def DomeLight "{name}" {{ token inputs:texture:format = "{name}" }}\n' for name in formats)
    scene = read(domes + 'def DomeLight_1 "none" {}')
    assert {path[1:]: light.texture_format for path, light in scene.lights.items()} == {
        **{name: name for name in formats}, "none": "automatic",
    }  # fmt: skip
    assert not scene.warnings
    scene = read('def DomeLight "sky" { token inputs:texture:format = "cubist" }')
    assert scene.lights["/sky"].texture_format == "automatic"
    assert len(scene.warnings) == 1 and "</sky>" in scene.warnings[0] and "'cubist'" in scene.warnings[0]


def test_shaping_and_shadows(read: Read) -> None:
    scene = read("""
        def SphereLight "spot" (prepend apiSchemas = ["ShapingAPI", "ShadowAPI"]) {
            float inputs:shaping:focus = 2
            color3f inputs:shaping:focusTint = (0, 0.5, 1)
            float inputs:shaping:cone:softness = 0.25
            asset inputs:shaping:ies:file = @nowhere.ies@
            float inputs:shaping:ies:angleScale = -0.1
            bool inputs:shaping:ies:normalize = 1
            color3f inputs:shadow:color = (0.25, 0, 0)
            float inputs:shadow:distance = 3
            float inputs:shadow:falloff = 2
            float inputs:shadow:falloffGamma = 0.5
        }
        def SphereLight "applied" (prepend apiSchemas = ["ShapingAPI"]) {}
        def SphereLight "plain" {}
        def SphereLight "unapplied" { float inputs:shaping:cone:angle = 30 }
        """)
    spot = scene.lights["/spot"]
    # the schema's fallback is a cone; without the schema there is none
    scale = float(np.float32(-0.1))
    assert spot.shaping == Shaping(2, (0, 0.5, 1), 90, 0.25, "nowhere.ies", scale, ies_normalize=True)
    assert spot.shadow == Shadow((0.25, 0, 0), 3, 2, 0.5)
    assert scene.lights["/applied"].shaping == Shaping(cone_angle_deg=90)
    assert scene.lights["/unapplied"].shaping == Shaping(cone_angle_deg=30)
    plain = scene.lights["/plain"]
    assert (plain.shaping, plain.shadow) == (Shaping(), Shadow())


def test_other_lights_are_named_once(read: Read) -> None:
    scene = read('def PluginLight "glow" {}')
    assert not scene.lights and len(scene.warnings) == 1
    assert "</glow>" in scene.warnings[0] and "PluginLight" in scene.warnings[0]


@pytest.mark.parametrize(
    ("pole", "up", "turned"),
    [("scene", "Z", True), ("scene", "Y", False), ("Y", "Z", False), ("Z", "Y", True)],
)
def test_dome_light_1_stands_on_its_pole(read: Read, pole: str, up: str, turned: bool) -> None:
    scene = read(f'(\n upAxis = "{up}"\n)\ndef DomeLight_1 "sky" {{ uniform token poleAxis = "{pole}" }}')
    assert np.allclose(scene.lights["/sky"].transform[1, :3], (0, 0, 1) if turned else (0, 1, 0))


MATERIAL = """
def Material "mat" {
    color3f inputs:tint = (0.1, 0.2, 0.3)
    token outputs:surface.connect = </mat/s.outputs:surface>
    def Shader "s" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </mat.inputs:tint>
        color3f inputs:emissiveColor.connect = </mat/t.outputs:rgb>
        float inputs:roughness = 0.7
        float inputs:metallic.connect = </mat/t.outputs:g>
        float inputs:ior.connect = </mat/r.outputs:result>
        int inputs:useSpecularWorkflow = 1
        token inputs:opacityMode = "presence"
        token outputs:surface
    }
    def Shader "t" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @gone.png@
        float4 inputs:fallback = (0.5, 0.25, 0, 1)
        float3 outputs:rgb
        float outputs:g
    }
    def Shader "r" {
        uniform token info:id = "UsdPrimvarReader_float"
        float outputs:result
    }
}
def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) { SQUARE
    rel material:binding = </mat> }
"""


def test_preview_surface(read: Read) -> None:
    scene = read(MATERIAL)
    surface = scene.materials["/mat"].surface
    assert surface is not None
    assert surface.diffuse_color == tuple(float(np.float32(v)) for v in (0.1, 0.2, 0.3))
    assert (surface.roughness, surface.ior) == (float(np.float32(0.7)), 1.5)
    assert surface.use_specular_workflow and surface.opacity_mode == "presence"


def test_connected_inputs_take_the_fallback_and_are_named(read: Read) -> None:
    scene = read(MATERIAL)
    surface = scene.materials["/mat"].surface
    assert surface is not None
    assert surface.emissive_color == (0.5, 0.25, 0.0) and surface.metallic == 0.25
    named = [name for name in ("emissiveColor", "metallic", "ior") if any(f"'{name}'" in w for w in scene.warnings)]
    assert named == ["emissiveColor", "metallic", "ior"] and len(scene.warnings) == 3


@pytest.mark.parametrize(
    ("statement", "field", "kept"),
    [
        ("float inputs:diffuseColor = 0.5", "diffuse_color", (0.18,) * 3),
        ("color3f inputs:roughness = (1, 1, 1)", "roughness", 0.5),
        ('string inputs:roughness = "rough"', "roughness", 0.5),
    ],
)
def test_inputs_of_the_wrong_type_are_named(read: Read, statement: str, field: str, kept: object) -> None:
    surface = read(
        """
        def Material "mat" {
            token outputs:surface.connect = </mat/surface.outputs:surface>
            def Shader "surface" {
                uniform token info:id = "UsdPreviewSurface"
                STATEMENT
                token outputs:surface
            }
        }
        def Mesh "mesh" (prepend apiSchemas = ["MaterialBindingAPI"]) { SQUARE
            rel material:binding = </mat>
        }
        """.replace("STATEMENT", statement)
    )
    preview = surface.materials["/mat"].surface
    assert preview is not None
    assert getattr(preview, field) == pytest.approx(kept)
    assert any("</mat/surface>" in text and "ignored" in text for text in surface.warnings)


def test_a_lens_that_is_no_number_still_has_a_picture() -> None:
    camera = Gf.Camera()
    camera.horizontalAperture = float("nan")
    assert free_camera.image_height(64, camera) == 64


def test_unknown_surfaces_are_named(read: Read) -> None:
    scene = read(MATERIAL.replace("UsdPreviewSurface", "FancySurface"))
    assert scene.materials["/mat"].surface is None
    assert "</mat>" in scene.warnings[0] and "FancySurface" in scene.warnings[0]


def test_camera_has_hydras_numbers() -> None:
    stage = Usd.Stage.CreateInMemory()
    camera = UsdGeom.Camera.Define(stage, "/x/cam")
    camera.CreateFocalLengthAttr(35.3)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 77))
    described = read_camera(camera, Usd.TimeCode.Default())
    assert described.focal_length == float(np.float32(35.3) * np.float32(0.1))
    assert described.aperture[0] == float(np.float32(20.955) * np.float32(0.1))
    assert described.clipping_range == (float(np.float32(0.1)), 77)
    assert described.conform_policy == "matchVertically" and not described.orthographic


def test_cameras_are_found_by_path_or_name() -> None:
    stage = stage_of('def Xform "cam" { def Camera "cam" {} }')
    assert str(find_camera(stage, Sdf.Path("cam")).GetPath()) == "/cam/cam"
    assert str(find_camera(stage, Sdf.Path("/cam/cam")).GetPath()) == "/cam/cam"
    assert str(find_camera(stage, Sdf.Path("cam/cam")).GetPath()) == "/cam/cam"
    for missing in ("/cam", "other", "/cam.visibility", ""):
        assert find_camera(stage, Sdf.Path(missing) if missing else Sdf.Path()) is None


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_the_free_camera_frames_the_stage(up: str) -> None:
    stage = stage_of(f'(\n upAxis = "{up}"\n)\ndef Cube "c" {{ double size = 4 }}')
    camera = free_camera.frame_stage(stage, Usd.TimeCode.Default(), ["proxy"])
    # 20.955 mm of film behind 50 mm: half the diagonal of the face, and half the cube's depth
    distance = np.sqrt(8.0) / (20.955 / 2 / 50) + 2
    where = camera.transform.ExtractTranslation()
    assert np.allclose(where, (0, 0, distance) if up == "Y" else (0, -distance, 0), rtol=1e-6)
    looks = camera.transform.TransformDir(Gf.Vec3d(0, 0, -1))
    assert np.allclose(looks, (0, 0, -1) if up == "Y" else (0, 1, 0), atol=1e-12)
    assert free_camera.image_height(960, camera) == 700
    assert np.allclose(camera_light(camera).transform, np.array(camera.transform), atol=1e-12)


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_shapes_are_closed_and_lie_along_their_axis(axis: str) -> None:
    along = "XYZ".index(axis)
    for points, counts, corners, _ in (
        implicit.cylinder(1, 2, 10, axis),
        implicit.cone(1, 10, axis),
        implicit.capsule(1, 1, 8, axis),
        implicit.capsule(0.5, 1, 8, axis),
    ):
        assert counts.sum() == len(corners) and corners.max() == len(points) - 1
        extent = np.ptp(points, axis=0)
        assert np.argmax(extent) == along
        assert _outward_volume(points, counts, corners) > 0


def _outward_volume(points: np.ndarray, counts: np.ndarray, corners: np.ndarray) -> float:
    total, at = 0.0, 0
    for count in counts:
        face = points[corners[at : at + count]].astype(float)
        at += count
        for i in range(1, count - 1):
            total += float(np.linalg.det([face[0], face[i], face[i + 1]])) / 6
    return total


def test_shapes_of_a_stage(read: Read) -> None:
    scene = read("""
        def Sphere "sphere" { double radius = 2 }
        def Cube "cube" { double size = 3 }
        def Plane "plane" { double width = 5
            double length = 6 }
        def Cylinder_1 "cylinder" { double radiusTop = 0.5 }
        def Capsule_1 "capsule" {}
        def Cone "cone" { color3f[] primvars:displayColor = [(1, 0, 0)] }
        """)
    assert {path: len(mesh.points) for path, mesh in scene.meshes.items()} == {
        "/sphere": 92, "/cube": 8, "/plane": 4, "/cylinder": 42, "/capsule": 82, "/cone": 31,
    }  # fmt: skip
    assert scene.meshes["/cube"].subdivision_scheme == "bilinear"
    assert scene.meshes["/sphere"].subdivision_scheme == "catmullClark"
    assert np.allclose(np.linalg.norm(scene.meshes["/sphere"].points, axis=1), 2, rtol=1e-6)
    assert scene.meshes["/cone"].primvars["displayColor"].values.tolist() == [[1, 0, 0]]
