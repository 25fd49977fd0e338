"""Light linking, shadow linking and portals as the reader describes them."""

from collections.abc import Callable

import pytest
from conftest import Scene

Read = Callable[..., Scene]

MESHES = """
def Xform "World" {
    def Mesh "a" { SQUARE }
    def Mesh "b" { SQUARE }
    def Xform "more" {
        def Mesh "c" { SQUARE }
    }
}
"""


def linked(name: str, kind: str, text: str) -> str:
    """A light with a collection of a kind: lightLink or shadowLink."""
    return f'def SphereLight "{name}" {{\n' + text.replace("LINK", f"collection:{kind}") + "\n}\n"


def test_links_name_what_is_in_them(read: Read) -> None:
    scene = read(
        MESHES
        + linked("one", "lightLink", "bool LINK:includeRoot = 0\nrel LINK:includes = [</World/a>, </World/more>]")
        + linked("two", "shadowLink", "rel LINK:excludes = [</World/more>]")
    )
    one, two = scene.lights["/one"], scene.lights["/two"]
    assert (one.light_link, one.shadow_link) == ("/one.collection:lightLink", None)
    assert (two.light_link, two.shadow_link) == (None, "/two.collection:shadowLink")
    categories = {path.rsplit("/", 1)[1]: mesh.categories for path, mesh in scene.meshes.items()}
    assert categories == {"a": [one.light_link, two.shadow_link], "b": [two.shadow_link], "c": [one.light_link]}
    assert not scene.warnings


def test_links_to_everything_are_none(read: Read) -> None:
    scene = read(MESHES + 'def SphereLight "plain" {}\n' + linked("all", "lightLink", "bool LINK:includeRoot = 1"))
    assert all(light.light_link is None and light.shadow_link is None for light in scene.lights.values())
    assert all(not mesh.categories for mesh in scene.meshes.values())


def test_collections_with_the_same_members_are_one(read: Read) -> None:
    members = "bool LINK:includeRoot = 0\nrel LINK:includes = </World/b>"
    scene = read(MESHES + linked("one", "lightLink", members) + linked("two", "shadowLink", members))
    assert scene.lights["/one"].light_link == scene.lights["/two"].shadow_link
    assert [len(mesh.categories) for mesh in scene.meshes.values()] == [0, 1, 0]


def test_expressions_link_too(read: Read) -> None:
    members = 'bool LINK:includeRoot = 0\npathExpression LINK:membershipExpression = "//c"'
    scene = read(MESHES + linked("one", "lightLink", members))
    assert [len(mesh.categories) for mesh in scene.meshes.values()] == [0, 0, 1]


def test_nothing_is_linked_to_an_empty_collection(read: Read) -> None:
    scene = read(MESHES + linked("one", "lightLink", "bool LINK:includeRoot = 0"))
    assert scene.lights["/one"].light_link is not None
    assert all(not mesh.categories for mesh in scene.meshes.values())


INSTANCES = """
def Xform "Proto" { def Mesh "m" { SQUARE } }
def Xform "one" (instanceable = true
    prepend references = </Proto>) {}
def Xform "two" (instanceable = true
    prepend references = </Proto>) {}
def PointInstancer "points" {
    int[] protoIndices = [0, 0]
    point3f[] positions = [(0, 0, 0), (2, 0, 0)]
    rel prototypes = </points/p>
    def Xform "p" {
        def Mesh "m" { SQUARE }
    }
}
"""


@pytest.mark.parametrize(
    ("included", "native", "points"),
    [
        ("includeRoot = 0\nrel LINK:includes = </one>", [1, 0], [0]),
        ("includeRoot = 0\nrel LINK:includes = </points>", [0, 0], [1]),
        ("includeRoot = 1\nrel LINK:excludes = </nowhere>", [1, 1], [1]),
    ],
)
def test_instances_belong_by_their_own_path(read: Read, included: str, native: list[int], points: list[int]) -> None:
    scene = read(INSTANCES + linked("light", "lightLink", f"bool LINK:{included}"))
    assert [len(c) for c in scene.instancers["/points"].categories] == points
    [instancer] = [i for path, i in scene.instancers.items() if path != "/points"]
    assert [len(c) for c in instancer.categories] == native
    assert all(not mesh.categories for mesh in scene.meshes.values() if mesh.instancer)


def test_portals(read: Read) -> None:
    scene = read("""
        def DomeLight "sky" { rel portals = [</window>, </shut>] }
        def DomeLight_1 "other" {}
        def PortalLight "window" {
            float inputs:width = 2
            float inputs:height = 3
            double3 xformOp:translate = (1, 2, 3)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
        def PortalLight "shut" { token visibility = "invisible" }
        """)
    assert scene.lights["/sky"].portals == ["/window"]
    assert scene.lights["/other"].portals == []
    window = scene.lights["/window"]
    assert (window.kind, window.width, window.height) == ("portal", 2, 3)
    assert list(window.transform[3, :3]) == [1, 2, 3]
    assert "/shut" not in scene.lights and not scene.warnings
