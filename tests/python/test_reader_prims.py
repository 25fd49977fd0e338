"""What the reader makes of meshes: visibility, purpose, primvars, subsets, time."""

from collections.abc import Callable

import numpy as np
import pytest
from conftest import Scene

Read = Callable[..., Scene]


def test_a_mesh(read: Read) -> None:
    scene = read("""
        def Xform "g" {
            double3 xformOp:translate = (1, 2, 3)
            uniform token[] xformOpOrder = ["xformOp:translate"]
            def Mesh "m" {
                SQUARE
                int[] holeIndices = [0]
                uniform token orientation = "leftHanded"
                uniform bool doubleSided = 1
            }
        }""")
    mesh = scene.meshes["/g/m"]
    assert mesh.points.dtype == np.float32 and mesh.points.shape == (4, 3)
    assert mesh.face_vertex_indices.tolist() == [0, 1, 2, 3] and mesh.hole_indices.tolist() == [0]
    assert (mesh.orientation, mesh.subdivision_scheme, mesh.double_sided) == ("leftHanded", "none", True)
    assert mesh.transform[3].tolist() == [1, 2, 3, 1]
    assert mesh.instancer is None and mesh.prim_id == 0
    assert scene.warnings == []


def test_visibility_is_inherited(read: Read) -> None:
    scene = read(
        """
        def Xform "a" {
            token visibility = "invisible"
            def Mesh "m" { SQUARE }
            def SphereLight "l" {}
        }
        def Mesh "b" { SQUARE
            token visibility.timeSamples = { 1: "invisible", 2: "inherited" } }
        """,
        1.0,
    )
    assert not scene.meshes and not scene.lights
    timed = 'def Mesh "b" { SQUARE\n token visibility.timeSamples = { 1: "invisible", 2: "inherited" } }'
    assert list(read(timed, 2.0).meshes) == ["/b"]


@pytest.mark.parametrize(
    ("purposes", "shown"),
    [((), {"/a", "/g/own"}), (("proxy",), {"/a", "/g/own", "/g/m"}), (("guide",), {"/a", "/g/own", "/g/x/y"})],
)
def test_purpose_is_inherited(read: Read, purposes: tuple[str, ...], shown: set[str]) -> None:
    scene = read(
        """
        def Mesh "a" { SQUARE }
        def Xform "g" {
            uniform token purpose = "proxy"
            def Mesh "m" { SQUARE }
            def Mesh "own" { SQUARE
                uniform token purpose = "default" }
            def "x" { def Mesh "y" { SQUARE
                uniform token purpose = "guide" } }
        }""",
        purposes=purposes,
    )
    assert set(scene.meshes) == shown


def test_typeless_prims_have_no_purpose_and_no_visibility(read: Read) -> None:
    scene = read("""
        def "group" {
            uniform token purpose = "guide"
            token visibility = "invisible"
            def Mesh "m" { SQUARE }
        }""")
    assert scene.meshes["/group/m"].purpose == "default"


PRIMVARS = """
def Xform "g" {
    color3f[] primvars:displayColor = [(1, 0, 0)] (interpolation = "constant")
    def Mesh "inherits" { SQUARE }
    def Mesh "indexed" { SQUARE
        color3f[] primvars:displayColor = [(0, 0, 0), (0, 1, 0)] (interpolation = "faceVarying")
        int[] primvars:displayColor:indices = [1, 0, 1, 1]
        float[] primvars:displayOpacity = [0.5] (interpolation = "uniform")
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
    }
    def Mesh "broken" { SQUARE
        color3f[] primvars:displayColor = [(0, 0, 0)] (interpolation = "vertex")
        int[] primvars:displayColor:indices = [0, 0, 9, 0]
        float[] primvars:st = [1, 2] (interpolation = "vertex")
    }
}"""


def test_primvars(read: Read) -> None:
    scene = read(PRIMVARS)
    inherited = scene.meshes["/g/inherits"].primvars["displayColor"]
    assert (inherited.interpolation, inherited.values.tolist()) == ("constant", [[1, 0, 0]])
    own = scene.meshes["/g/indexed"].primvars
    assert own["displayColor"].interpolation == "faceVarying"
    assert own["displayColor"].values[:, 1].tolist() == [1, 0, 1, 1]
    assert own["displayOpacity"].values.shape == (1,) and own["displayOpacity"].interpolation == "uniform"
    assert own["st"].values.shape == (4, 2) and own["st"].interpolation == "vertex"


def test_broken_primvars_are_named(read: Read) -> None:
    scene = read(PRIMVARS)
    assert not scene.meshes["/g/broken"].primvars
    assert any("</g/broken>" in w and "displayColor" in w for w in scene.warnings)
    assert any("</g/broken>" in w and "'st'" in w for w in scene.warnings)


def test_normals_of_polygons_only(read: Read) -> None:
    normals = "normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)]"
    primvar = 'normal3f[] primvars:normals = [(0, 1, 0)] (interpolation = "uniform")'
    scene = read(
        f"""
        def Mesh "plain" {{ SQUARE {normals} (interpolation = "vertex") }}
        def Mesh "both" {{ SQUARE {normals}
            {primvar} }}
        def Mesh "subdivided" {{ SQUARE {normals}
            uniform token subdivisionScheme = "catmullClark" }}
        """
    )
    plain, both = scene.meshes["/plain"].normals, scene.meshes["/both"].normals
    assert plain is not None and plain.interpolation == "vertex"
    assert both is not None and both.interpolation == "uniform" and both.values.tolist() == [[0, 1, 0]]


def test_subdivided_meshes_have_no_authored_normals(read: Read) -> None:
    scene = read("""
        def Mesh "m" {
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
            normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1)]
        }""")
    assert scene.meshes["/m"].normals is None
    assert scene.meshes["/m"].subdivision_scheme == "catmullClark"


def test_subsets_take_their_own_materials(read: Read) -> None:
    scene = read("""
        def Material "red" {}
        def Material "blue" {}
        def Material "preview" {}
        def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) {
            SQUARE
            rel material:binding = </red>
            rel material:binding:preview = </preview>
            def GeomSubset "s" (prepend apiSchemas = ["MaterialBindingAPI"]) {
                uniform token elementType = "face"
                uniform token familyName = "materialBind"
                int[] indices = [0]
                rel material:binding = </blue>
            }
            def GeomSubset "other" {
                uniform token elementType = "face"
                uniform token familyName = "else"
                int[] indices = [0]
            }
        }""")
    mesh = scene.meshes["/m"]
    assert mesh.material == "/red"
    assert [(s.material, s.faces.tolist()) for s in mesh.subsets] == [("/blue", [0])]
    assert set(scene.materials) == {"/red", "/blue"}


def test_time_samples_interpolate(read: Read) -> None:
    text = """
        def Mesh "m" {
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points.timeSamples = {
                1: [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
                3: [(0, 0, 2), (1, 0, 2), (0, 1, 2)] }
            double3 xformOp:translate.timeSamples = { 1: (0, 0, 0), 3: (4, 0, 0) }
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }"""
    mesh = read(text, 2.0).meshes["/m"]
    assert mesh.points[:, 2].tolist() == [1, 1, 1] and mesh.transform[3, 0] == 2.0
    assert not read(text).meshes  # nothing is said of the default time


def test_what_is_not_drawn_is_named(read: Read) -> None:
    scene = read("""
        def BasisCurves "hair" {}
        def Mesh "empty" {}
        def Scope "s" { def Material "m" {} }
        def Camera "c" {}""")
    assert not scene.meshes
    assert len(scene.warnings) == 1 and "</hair>" in scene.warnings[0] and "BasisCurves" in scene.warnings[0]


def test_points_of_a_wrong_type_are_named(read: Read) -> None:
    scene = read("""
        def Mesh "m" {
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            float[] points = [0, 1, 2]
        }
        def Mesh "good" { SQUARE }""")
    assert list(scene.meshes) == ["/good"] and "</m>" in scene.warnings[0]
