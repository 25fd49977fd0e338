"""Point instancers and native instances: kept as instances, nested ones nested."""

from collections.abc import Callable

import numpy as np
from conftest import Scene, stage_of
from pxr import Gf, Sdf, Usd, UsdGeom
from umber.description import Mesh

Read = Callable[..., Scene]

MOVE = """double3 xformOp:translate = (%s, 0, 0)
          uniform token[] xformOpOrder = ["xformOp:translate"]
"""


def origins(scene: Scene, mesh: Mesh) -> list[list[float]]:
    """Where the mesh's origin comes to stand in the world, once an instance."""

    def placements(instancer: str | None, indices: np.ndarray) -> list[np.ndarray]:
        if instancer is None:
            return [np.eye(4)]
        found = scene.instancers[instancer]
        outer = placements(found.parent, found.parent_indices)
        return [found.transforms[i] @ o for o in outer for i in indices]

    return sorted((mesh.transform @ p)[3, :3].tolist() for p in placements(mesh.instancer, mesh.instance_indices))


def test_point_instancer(read: Read) -> None:
    scene = read(
        """
        def PointInstancer "pi" {
            int[] protoIndices = [0, 1, 0, 1]
            point3f[] positions = [(0, 0, 0), (10, 0, 0), (20, 0, 0), (30, 0, 0)]
            float3[] scales = [(2, 2, 2), (1, 1, 1), (1, 1, 1), (1, 1, 1)]
            int64[] invisibleIds = [2]
            rel prototypes = [</pi/p/a>, </pi/p/b>]
            MOVE5
            def Scope "p" {
                def Mesh "a" { SQUARE
 MOVE1 }
                def Xform "b" { def Mesh "m" { SQUARE } }
            }
        }""".replace("MOVE5", MOVE % 5).replace("MOVE1", MOVE % 1)
    )
    assert list(scene.instancers) == ["/pi"]
    a, b = scene.meshes["/pi/p/a"], scene.meshes["/pi/p/b/m"]
    assert a.instance_indices.tolist() == [0] and b.instance_indices.tolist() == [1, 3]
    assert origins(scene, a) == [[7, 0, 0]]  # its own move is scaled, then moved with the instancer
    assert origins(scene, b) == [[15, 0, 0], [35, 0, 0]]


def test_orientations_agree_with_usd(read: Read) -> None:
    stage = Usd.Stage.CreateInMemory()
    instancer = UsdGeom.PointInstancer.Define(stage, "/pi")
    rng = np.random.default_rng(1)
    quats = [Gf.Quath(Gf.Quatf(*map(float, q / np.linalg.norm(q)))) for q in rng.normal(size=(20, 4))]
    positions = rng.normal(size=(20, 3)).astype(np.float32)
    scales = rng.uniform(0.5, 2.0, size=(20, 3)).astype(np.float32)
    instancer.CreateOrientationsAttr(quats)
    instancer.CreatePositionsAttr([Gf.Vec3f(*map(float, p)) for p in positions])
    instancer.CreateScalesAttr([Gf.Vec3f(*map(float, s)) for s in scales])
    instancer.CreateProtoIndicesAttr([0] * 20)
    instancer.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    stage.DefinePrim("/pi/proto", "Cube")
    instancer.CreatePrototypesRel().AddTarget("/pi/proto")
    outer = instancer.GetLocalTransformation()
    for i, transform in enumerate(read(stage).instancers["/pi"].transforms):
        wanted = Gf.Matrix4d(1).SetTranslate(Gf.Vec3d(*map(float, positions[i]))) * outer
        wanted = Gf.Matrix4d(1).SetRotate(Gf.Quatd(quats[i])) * wanted
        wanted = Gf.Matrix4d(1).SetScale(Gf.Vec3d(*map(float, scales[i]))) * wanted
        assert np.array_equal(transform, np.array(wanted))  # to the last bit


def test_nested_point_instancers(read: Read) -> None:
    scene = read("""
        def PointInstancer "outer" {
            int[] protoIndices = [0, 0]
            point3f[] positions = [(0, 0, 0), (100, 0, 0)]
            rel prototypes = </outer/inner>
            def PointInstancer "inner" {
                int[] protoIndices = [0, 0]
                point3f[] positions = [(1, 0, 0), (2, 0, 0)]
                rel prototypes = </outer/inner/m>
                def Mesh "m" { SQUARE }
            }
        }""")
    assert scene.instancers["/outer/inner"].parent == "/outer"
    assert scene.instancers["/outer/inner"].parent_indices.tolist() == [0, 1]
    assert [x for x, _, _ in origins(scene, scene.meshes["/outer/inner/m"])] == [1, 2, 101, 102]


def test_bad_point_instancers_are_named(read: Read) -> None:
    scene = read("""
        def PointInstancer "none" { point3f[] positions = [(0, 0, 0)] }
        def PointInstancer "pi" {
            int[] protoIndices = [0, 7, 0]
            point3f[] positions = [(0, 0, 0), (1, 0, 0)]
            quath[] orientations = [(1, 0, 0, 0)]
            rel prototypes = [</pi/m>, </pi/gone>]
            def Mesh "m" { SQUARE }
        }""")
    said = "\n".join(scene.warnings)
    assert "</none>" in said and "protoIndices" in said
    assert "</pi>: the point instancer has 3 protoIndices for 2 positions" in said
    assert "protoIndex 7 of 2" in said and "</pi/gone>" in said and "orientations are ignored" in said
    assert scene.meshes["/pi/m"].instance_indices.tolist() == [0]


NATIVE = """
class "proto" { def Mesh "m" { SQUARE } }
def Xform "i1" (instanceable = true
    references = </proto>) { MOVE1 }
def Xform "i2" (instanceable = true
    references = </proto>) { MOVE2 }
def Xform "hidden" (instanceable = true
    references = </proto>) { token visibility = "invisible" }
""".replace("MOVE1", MOVE % 1).replace("MOVE2", MOVE % 2)


def test_native_instances_share_a_mesh(read: Read) -> None:
    scene = read(NATIVE)
    assert len(scene.meshes) == 1 and len(scene.instancers) == 1
    (mesh,) = scene.meshes.values()
    assert [x for x, _, _ in origins(scene, mesh)] == [1, 2]


def test_native_instances_are_told_apart_by_what_they_inherit(read: Read) -> None:
    stage = stage_of(NATIVE)
    color = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/i2")).CreatePrimvar(
        "displayColor", Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.constant
    )
    color.Set([Gf.Vec3f(1, 0, 0)])
    scene = read(stage)
    assert sorted("displayColor" in m.primvars for m in scene.meshes.values()) == [False, True]


def test_nested_native_instances(read: Read) -> None:
    scene = read(
        """
        class "leaf" { def Mesh "m" { SQUARE
 MOVE1 } }
        class "branch" {
            def "l1" (instanceable = true
                references = </leaf>) {}
            def Xform "l2" (instanceable = true
                references = </leaf>) { MOVE10 }
        }
        def Xform "t1" (instanceable = true
            references = </branch>) { MOVE100 }
        def Xform "t2" (instanceable = true
            references = </branch>) { MOVE200 }
        """.replace("MOVE100", MOVE % 100)
        .replace("MOVE200", MOVE % 200)
        .replace("MOVE10", MOVE % 10)
        .replace("MOVE1", MOVE % 1)
    )
    assert len(scene.meshes) == 1 and len(scene.instancers) == 2
    (mesh,) = scene.meshes.values()
    assert [x for x, _, _ in origins(scene, mesh)] == [101, 111, 201, 211]


def test_native_instances_in_point_instancers_and_back(read: Read) -> None:
    scene = read(
        """
        class "proto" { def Mesh "m" { SQUARE
 MOVE1 } }
        class "cloud" {
            def PointInstancer "pi" {
                int[] protoIndices = [0, 0]
                point3f[] positions = [(10, 0, 0), (20, 0, 0)]
                rel prototypes = </cloud/pi/p>
                def Xform "p" (instanceable = true
                    references = </proto>) { MOVE2 }
            }
        }
        def Xform "c" (instanceable = true
            references = </cloud>) { MOVE100 }
        """.replace("MOVE100", MOVE % 100)
        .replace("MOVE1", MOVE % 1)
        .replace("MOVE2", MOVE % 2)
    )
    (mesh,) = scene.meshes.values()
    assert [x for x, _, _ in origins(scene, mesh)] == [113, 123]


def test_a_prototype_shown_by_two_instancers_is_two_meshes(read: Read) -> None:
    instancer = """def PointInstancer "%s" {
        int[] protoIndices = [0]
        point3f[] positions = [(1, 0, 0)]
        rel prototypes = </m>
    }
    """
    scene = read('def Mesh "m" { SQUARE }' + "\n" + instancer % "a" + instancer % "b")
    assert {m.instancer for m in scene.meshes.values()} == {None, "/a", "/b"}


def test_lights_in_instances_stand_where_the_instances_do(read: Read) -> None:
    scene = read(NATIVE.replace('def Mesh "m" { SQUARE }', 'def SphereLight "l" {}'))
    assert sorted(light.transform[3, 0] for light in scene.lights.values()) == [1, 2]


def test_abstract_prototypes_are_not_drawn_themselves(read: Read) -> None:
    scene = read("""
        over "store" { def Mesh "m" { SQUARE } }
        def PointInstancer "pi" {
            int[] protoIndices = [0]
            point3f[] positions = [(1, 0, 0)]
            rel prototypes = </store/m>
        }""")
    assert [m.instancer for m in scene.meshes.values()] == ["/pi"]
