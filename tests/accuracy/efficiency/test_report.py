"""The report's own arithmetic: the front, records that are merged, the document, the stages."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import stages
from document import NOT_YET, TEMPLATE, fill
from front import on_front
from merge import merged
from pxr import Usd, UsdGeom


def test_front_is_what_nothing_beats() -> None:
    points = [(1.0, 1.0), (2.0, 0.5), (2.0, 0.6), (3.0, 0.5), (4.0, 0.1), (0.5, 2.0), (5.0, 3.0)]
    assert on_front(points) == [True, True, False, False, True, True, False]


def test_equal_pictures_are_both_on_the_front() -> None:
    assert on_front([(1.0, 1.0), (1.0, 1.0)]) == [True, True]
    assert on_front([]) == []


def scene(name: str, commit: str) -> dict[str, Any]:
    return {
        "name": name,
        "processor": "a processor",
        "commit": commit,
        "command": "a command",
        "date": "a day",
        "rounds": 3,
        "reference": "a reference",
        "reference_noise": 0.0,
        "absent": ["Mitsuba: not installed"],
        "ratios": [],
    }


def test_partial_run_keeps_the_rest() -> None:
    old = {"scenes": [scene("a", "old"), scene("b", "old")], "unused": {"bar": 1.02}, "costs": [{"name": "b"}]}
    new = {"scenes": [scene("c", "new"), scene("b", "new")]}
    record = merged(old, new, ["c", "a", "b"])
    assert [(s["name"], s["commit"]) for s in record["scenes"]] == [("c", "new"), ("a", "old"), ("b", "new")]
    assert record["unused"] == {"bar": 1.02}
    assert record["costs"] == [{"name": "b"}]
    assert merged({}, {}, ["a"]) == {"scenes": [], "costs": []}


def test_new_bar_replaces_the_old() -> None:
    assert merged({"unused": {"bar": 1}}, {"unused": {"bar": 2}}, [])["unused"] == {"bar": 2}


def test_document_has_no_place_unfilled() -> None:
    template = TEMPLATE.read_text()
    for report in ({}, {"scenes": [scene("a", "0123abc")]}):
        text = fill(report, {}, template)
        assert not re.search(r"\$[a-z{]", text)
        assert NOT_YET in text
    assert "0123abc" in text
    assert "Mitsuba: not installed" in text


def test_place_that_nothing_fills_is_refused() -> None:
    with pytest.raises(KeyError):
        fill({}, {}, TEMPLATE.read_text() + "$nobody_knows_this")


def test_faces_become_fans() -> None:
    triangles, faces = stages.fan(np.array([3, 5, 4]), np.arange(12))
    assert triangles.tolist() == [[0, 1, 2], [3, 4, 5], [3, 5, 6], [3, 6, 7], [8, 9, 10], [8, 10, 11]]
    assert faces.tolist() == [0, 1, 1, 1, 2, 2]


def test_bumpy_sphere_is_closed_and_faces_outwards() -> None:
    points, triangles = stages.bumpy_sphere(2)
    assert len(triangles) == 320
    edges = {(int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3)}
    assert len(edges) == 960
    assert all((b, a) in edges for a, b in edges)
    corners = points[triangles]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx(4.0, abs=0.4)


def test_point_instances_are_written_out(tmp_path: Path) -> None:
    small = stages.instances(tmp_path / "small.usda", along=3)
    flat = Usd.Stage.Open(str(stages.plain(small, tmp_path / "flat.usda", stages.diffuse_color, tmp_path)))
    assert sum(prim.IsA(UsdGeom.Mesh) for prim in flat.Traverse()) == 9 + 1
    assert not any(prim.IsA(UsdGeom.PointInstancer) for prim in flat.Traverse())
    meshes = [UsdGeom.Mesh(prim) for prim in flat.Traverse() if prim.IsA(UsdGeom.Mesh)]
    points = [np.array(mesh.GetPointsAttr().Get()) for mesh in meshes if len(mesh.GetPointsAttr().Get()) > 4]
    source = Usd.Stage.Open(str(small))
    grid = UsdGeom.PointInstancer(source.GetPrimAtPath("/World/Grid"))
    assert np.allclose([p.mean(axis=0) for p in points], grid.GetPositionsAttr().Get(), atol=0.02)
    radii = [np.linalg.norm(p - p.mean(axis=0), axis=1).mean() for p in points]
    assert np.allclose(radii, np.array(grid.GetScalesAttr().Get())[:, 0], rtol=0.02)
