"""Dome lights in Blender's World, as the importer fills it, the add-on completes it and the exporter reads it.

Started by `cargo xtask test`, which sets up the environment.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from pxr import UsdLux
from test_blender import LIGHTS, MANY, edited, find_light, value

pytestmark = pytest.mark.skipif(not importlib.util.find_spec("bpy"), reason="this OpenUSD comes without Blender")


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_import_fills_the_world_that_is_there(tmp_path: Path, scale: float) -> None:
    """The importer's nodes are taken, its scale of strengths with them, and what it drops is kept."""
    stage, said = edited(MANY, tmp_path, "none", "import.has_world=True", f"import.light_intensity_scale={scale}")
    alone, _ = edited(MANY, tmp_path / "alone")
    dome, expected = find_light(stage, "env_light"), find_light(alone, "env_light")
    assert "umber" not in said
    for name in ("inputs:exposure", "inputs:diffuse", "inputs:shadow:distance"):
        assert value(dome, name) == pytest.approx(value(expected, name))
    assert value(dome, "inputs:intensity") == pytest.approx(scale * 0.3)
    assert value(dome, "inputs:color") == pytest.approx((1, 0.5, 0.25))
    assert value(dome, "xformOp:rotateXYZ") == pytest.approx(value(expected, "xformOp:rotateXYZ"), abs=1e-3)
    assert find_light(stage, "Second").GetPrim().GetTypeName() == "DomeLight"


@pytest.mark.parametrize("up_axis", ["Y", "Z"])
@pytest.mark.parametrize(
    ("schema", "body"), [("DomeLight", ""), ("DomeLight_1", f"asset inputs:texture:file = @{LIGHTS / 'sky.hdr'}@")]
)
def test_domes_fill_any_world_alike(tmp_path: Path, schema: str, body: str, up_axis: str) -> None:
    """A World that is there, and one that is made, show a dome the same: an even white one, and one with a Z pole."""
    path = tmp_path / "pole.usda"
    turn = "float inputs:intensity = 0.5\nfloat3 xformOp:rotateXYZ = (10, 20, 30)"
    order = 'uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]\ntoken poleAxis = "Z"'
    head = f'#usda 1.0\n(\nupAxis = "{up_axis}"\n)\n'
    path.write_text(f'{head}def {schema} "Sky"\n{{\n{body}\n{turn}\n{order}\n}}\n')
    domes = []
    for has_world in (False, True):
        stage, said = edited(path, tmp_path / str(has_world), "none", f"import.has_world={has_world}")
        assert "umber" not in said
        dome = find_light(stage, "env_light")
        domes.append([value(dome, name) or (0, 0, 0) for name in ("inputs:color", "xformOp:rotateXYZ")])
        assert value(dome, "inputs:intensity") == pytest.approx(0.5)
        assert value(dome, "inputs:color") == pytest.approx((1, 1, 1))
        assert [prim.GetTypeName() for prim in stage.Traverse() if "Dome" in prim.GetTypeName()] == ["DomeLight"]
    for one, other in zip(*domes, strict=True):
        assert one == pytest.approx(other, abs=1e-3)


def test_import_leaves_domes_where_it_is_told(tmp_path: Path) -> None:
    """Without lights no World is made; a World that is to stay stays, with a word about it."""
    stage, _ = edited(MANY, tmp_path / "dark", "none", "import.import_lights=False")
    assert not [prim for prim in stage.Traverse() if "Dome" in prim.GetTypeName()]
    stage, said = edited(MANY, tmp_path, "none", "import.has_world=True", "import.create_world_material=False")
    assert said.count("umber: Grey: it stays as it is") == 1
    domes = [prim for prim in stage.Traverse() if "Dome" in prim.GetTypeName()]
    assert [prim.GetName() for prim in domes] == ["env_light"]
    dome = UsdLux.LightAPI(domes[0])
    assert value(dome, "inputs:color") == pytest.approx((0.05, 0.05, 0.05), abs=1e-3)
    assert value(dome, "inputs:shadow:distance") is None


@pytest.mark.parametrize("edit", ["mixed_sky", "lone_sky"])
def test_worlds_keep_their_picture(tmp_path: Path, edit: str) -> None:
    """Whatever other background nodes there are."""
    stage, _ = edited(LIGHTS / "rect.usda", tmp_path, edit)
    dome = find_light(stage, "env_light")
    assert Path(dome.GetPrim().GetAttribute("inputs:texture:file").Get().resolvedPath).name == "sky.hdr"
    assert value(dome, "inputs:intensity") == pytest.approx(2.5)
    assert not dome.GetPrim().GetAttribute("inputs:color").HasAuthoredValue()
