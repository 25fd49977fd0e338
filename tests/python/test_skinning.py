"""Skinned meshes take the pose of the time code."""

from collections.abc import Callable

import numpy as np
from conftest import Scene

Read = Callable[..., Scene]

SKINNED = """
def SkelRoot "root" {
    def Skeleton "skel" (prepend apiSchemas = ["SkelBindingAPI"]) {
        uniform token[] joints = ["a", "a/b"]
        uniform matrix4d[] bindTransforms = [
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1)) ]
        uniform matrix4d[] restTransforms = [
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1)) ]
        rel skel:animationSource = </root/skel/anim>
        def SkelAnimation "anim" {
            uniform token[] joints = ["a", "a/b"]
            float3[] translations.timeSamples = { 0: [(0, 0, 0), (0, 1, 0)], 10: [(0, 0, 0), (0, 1, 10)] }
            quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0)]
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
        }
    }
    def Mesh "m" (prepend apiSchemas = ["SkelBindingAPI"]) { SQUARE
        double3 xformOp:translate = (0, 0, 3)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
        rel skel:skeleton = </root/skel>
        int[] primvars:skel:jointIndices = [0, 0, 1, 1] (elementSize = 1
            interpolation = "vertex")
        float[] primvars:skel:jointWeights = [1, 1, 1, 1] (elementSize = 1
            interpolation = "vertex")
    }
}"""


def test_points_follow_their_joints(read: Read) -> None:
    for time in (0.0, 5.0, 10.0):
        mesh = read(SKINNED, time).meshes["/root/m"]
        in_world = mesh.points + mesh.transform[3, :3]
        # the skeleton's space is the world: a skinned mesh stands where its joints are
        assert np.allclose(in_world[:, 2], [0, 0, time, time], atol=1e-5)
        assert np.allclose(in_world[:, :2], [(0, 0), (1, 0), (1, 1), (0, 1)], atol=1e-6)


def test_other_meshes_stay(read: Read) -> None:
    stage = SKINNED.replace('def SkelRoot "root" {', 'def SkelRoot "root" {\n def Mesh "still" { SQUARE }')
    assert np.array_equal(read(stage, 10.0).meshes["/root/still"].points[:, 2], np.zeros(4))
