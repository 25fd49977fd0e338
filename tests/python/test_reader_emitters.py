"""Meshes that shine: UsdLuxMeshLightAPI, LightAPI on other shapes, GeometryLight."""

from collections.abc import Callable

import pytest
from conftest import Scene

Read = Callable[..., Scene]


def test_a_mesh_light_shines_from_its_mesh(read: Read) -> None:
    scene = read("""
        def Mesh "lamp" (prepend apiSchemas = ["MeshLightAPI"]) {
            SQUARE
            float inputs:intensity = 3
            color3f inputs:color = (1, 0.5, 0.25)
            bool inputs:normalize = 1
        }
        def Mesh "dark" { SQUARE }
        """)
    assert not scene.warnings and list(scene.lights) == ["/lamp"]
    light = scene.lights["/lamp"]
    assert (light.kind, light.mesh, light.material_sync_mode) == ("mesh", "/lamp", "materialGlowTintsLight")
    assert (light.intensity, light.color, light.normalize) == (3, (1, 0.5, 0.25), True)
    assert set(scene.meshes) == {"/lamp", "/dark"}


def test_any_shape_may_be_a_light(read: Read) -> None:
    scene = read("""
        def Sphere "ball" (prepend apiSchemas = ["LightAPI"]) { uniform token light:materialSyncMode = "independent" }
        def Cube "box" (prepend apiSchemas = ["LightAPI"]) {}
        """)
    modes = {path: (light.mesh, light.material_sync_mode) for path, light in scene.lights.items()}
    assert modes == {"/ball": ("/ball", "independent"), "/box": ("/box", "noMaterialResponse")}


def test_an_unknown_mode_is_named(read: Read) -> None:
    scene = read("""
        def Mesh "lamp" (prepend apiSchemas = ["MeshLightAPI"]) {
            SQUARE
            uniform token light:materialSyncMode = "sometimes"
        }
        """)
    assert scene.lights["/lamp"].material_sync_mode == "materialGlowTintsLight"
    assert len(scene.warnings) == 1 and "'sometimes'" in scene.warnings[0]


def test_a_geometry_light_points_at_its_mesh(read: Read) -> None:
    scene = read("""
        def Mesh "tube" { SQUARE }
        def GeometryLight "neon" {
            rel geometry = </tube>
            float inputs:exposure = 2
        }
        """)
    light = scene.lights["/neon"]
    assert (light.kind, light.mesh, light.material_sync_mode) == ("mesh", "/tube", "noMaterialResponse")
    assert light.exposure == 2 and not scene.warnings


@pytest.mark.parametrize("target", ["", "rel geometry = </nowhere>", "rel geometry = </group>"])
def test_a_geometry_light_without_a_mesh_is_named(read: Read, target: str) -> None:
    scene = read(f"""
        def Xform "group" {{}}
        def GeometryLight "neon" {{ {target} }}
        """)
    assert not scene.lights and len(scene.warnings) == 1 and "</neon>" in scene.warnings[0]


def test_instances_of_a_mesh_light_share_it(read: Read) -> None:
    scene = read("""
        class "proto" {
            def Mesh "lamp" (prepend apiSchemas = ["MeshLightAPI"]) { SQUARE }
        }
        def Xform "a" (
            instanceable = true
            inherits = </proto>
        ) {}
        def Xform "b" (
            instanceable = true
            inherits = </proto>
        ) {}
        """)
    assert len(scene.meshes) == 1 and len(scene.lights) == 1
    (light,) = scene.lights.values()
    assert light.mesh in scene.meshes


def test_mesh_lights_have_links_and_shadows(read: Read) -> None:
    scene = read("""
        def Mesh "lamp" (prepend apiSchemas = ["MeshLightAPI", "ShadowAPI"]) {
            SQUARE
            bool collection:lightLink:includeRoot = 0
            rel collection:lightLink:includes = </near>
            color3f inputs:shadow:color = (0, 0, 1)
        }
        def Mesh "tube" { SQUARE }
        def GeometryLight "neon" {
            rel geometry = </tube>
            rel collection:shadowLink:excludes = </near>
        }
        def Mesh "near" { SQUARE }
        """)
    lamp, neon = scene.lights["/lamp"], scene.lights["/neon"]
    assert (lamp.light_link, lamp.shadow_link) == ("/lamp.collection:lightLink", None)
    assert (neon.light_link, neon.shadow_link) == (None, "/neon.collection:shadowLink")
    assert lamp.shadow.color == (0, 0, 1) and not scene.warnings
    categories = {path: mesh.categories for path, mesh in scene.meshes.items()}
    others = [neon.shadow_link]
    assert categories == {"/lamp": others, "/tube": others, "/near": [lamp.light_link]}
