"""Blender against Hydra: light that a stage brings reaches Umber unharmed, and so does light that Blender has.

Started by `cargo xtask test`, which sets up the environment.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from images import read_colour
from pxr import Sdf, Usd, UsdLux
from test_hosts import HERE, run

LIGHTS = HERE.parents[1] / "docs/scenes/lights"
STAGES = sorted(path for path in LIGHTS.glob("*.usda") if path.stem != "set")
SETTINGS = HERE.parents[1] / "crates/settings/src"
MANY = HERE / "blender_lights.usda"
FLAGS = ["--camera", "/Camera", "--disableCameraLight", "--imageWidth", "96"]
BLOCK = 8

pytestmark = pytest.mark.skipif(not importlib.util.find_spec("bpy"), reason="this OpenUSD comes without Blender")


def picture(driver: str, stage: Path, output: Path, seed: int = 0) -> np.ndarray:
    """Mean radiance of each block of a picture of the stage."""
    settings = ["--set", "convergedSamplesPerPixel=32", "--set", f"umber:seed={seed}"]
    run([sys.executable, HERE / driver, stage, output, *FLAGS, *settings])
    pixels = read_colour(output).astype(np.float64)
    rows, columns = (size // BLOCK for size in pixels.shape[:2])
    return pixels.reshape(rows, BLOCK, columns, BLOCK, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("stage", [*STAGES, MANY], ids=lambda path: path.stem)
def test_blender_shows_what_hydra_shows(tmp_path: Path, stage: Path) -> None:
    """Blocks differ by no more than two seeds do, and the whole by far less."""
    hydra = picture("hydra_record.py", stage, tmp_path / "hydra.exr")
    again = picture("hydra_record.py", stage, tmp_path / "again.exr", seed=1)
    blender = picture("blender_render.py", stage, tmp_path / "blender.exr")
    assert hydra.mean() > 1e-3

    def difference(one: np.ndarray) -> float:
        return np.sqrt(np.mean(((one - hydra) / (hydra + 0.05 * hydra.mean())) ** 2))

    assert difference(blender) < 1.2 * difference(again) + 0.002
    mean_noise = abs(again.mean() / hydra.mean() - 1.0)
    assert abs(blender.mean() / hydra.mean() - 1.0) < 2.0 * mean_noise + 0.003


def edited(stage: Path, folder: Path, edit: str = "none", *options: str) -> tuple[Usd.Stage, str]:
    """The stage imported, edited and exported by Blender, and what Blender said."""
    folder.mkdir(exist_ok=True)
    output = folder / f"{stage.stem}_{edit}.usda"
    said = run([sys.executable, HERE / "blender_edits.py", stage, output, edit, *options])
    return Usd.Stage.Open(str(output)), said


def find_light(stage: Usd.Stage, name: str) -> UsdLux.LightAPI:
    """The light that the object `name` became."""
    found = [prim for prim in stage.Traverse() if prim.HasAPI(UsdLux.LightAPI) and prim.GetName() == name]
    assert len(found) == 1, (name, found)
    return UsdLux.LightAPI(found[0])


def value(light: UsdLux.LightAPI, name: str) -> object:
    """An attribute's value, as numbers where it is one of several."""
    found = light.GetPrim().GetAttribute(name).Get()
    return tuple(found) if hasattr(found, "__len__") and not isinstance(found, str) else found


@pytest.mark.parametrize("times", [1, 2])
def test_links_go_through(tmp_path: Path, times: int) -> None:
    """Through Blender's collections: what is in for one light, what is out for the other."""
    path = LIGHTS / "light_link.usda"
    for _ in range(times):
        stage, _ = edited(path, tmp_path)
        path = Path(stage.GetRootLayer().realPath)
    warm, cool = (find_light(stage, name).GetLightLinkCollectionAPI() for name in ("Warm", "Cool"))
    ball = [Sdf.Path("/root/Set/Ball/Ball")]
    assert warm.GetIncludeRootAttr().Get() is False
    assert (warm.GetIncludesRel().GetTargets(), warm.GetExcludesRel().GetTargets()) == (ball, [])
    assert cool.GetIncludeRootAttr().Get() is True
    assert (cool.GetIncludesRel().GetTargets(), cool.GetExcludesRel().GetTargets()) == ([], ball)
    stage, _ = edited(LIGHTS / "shadow_link.usda", tmp_path)
    shadows = find_light(stage, "Light").GetShadowLinkCollectionAPI()
    assert shadows.GetExcludesRel().GetTargets() == [Sdf.Path("/root/Set/Block/Block")]


def test_links_of_instances_go_through(tmp_path: Path) -> None:
    """A native instance by its own path, and all of a point instancer."""
    stage, _ = edited(HERE / "linking.usda", tmp_path, "none", "use_instancing=True")
    included = {
        name: find_light(stage, name).GetLightLinkCollectionAPI().GetIncludesRel().GetTargets()
        for name in ("Red", "Green", "Blue")
    }
    world = Sdf.Path("/root/World")
    paths = {name: world.AppendPath(name) for name in ("InstanceB", "Left/Left", "Points", "Right/Right")}
    assert included["Red"] == [paths["InstanceB"], paths["Left/Left"]]
    assert included["Green"] == [paths["Points"]]
    assert included["Blue"] == [paths["InstanceB"], paths["Left/Left"], paths["Right/Right"]]


@pytest.mark.parametrize(
    ("instancing", "parts"),
    [(True, ["Floor", "Floor_base"]), (False, ["Ball_0_0", "Ball_1_0", "Ball_2_0", "Ball_3_0", "Floor"])],
)
def test_links_of_what_is_scattered_go_by_the_instancer(tmp_path: Path, instancing: bool, parts: list[str]) -> None:
    """The floor's own mesh and the balls on it are in; the ball elsewhere is not."""
    stage, _ = edited(LIGHTS / "rect.usda", tmp_path, "scatter", f"use_instancing={instancing}")
    included = find_light(stage, "Light").GetLightLinkCollectionAPI().GetIncludesRel().GetTargets()
    assert included == [Sdf.Path(f"/root/Set/Floor/{part}") for part in parts]


def test_ordinary_exports_gain_only_light(tmp_path: Path) -> None:
    """Of a scene that came from no stage, all but a little about lights is as Blender alone exports it."""
    alone, gained = tmp_path / "alone.usda", tmp_path / "gained.usda"
    run([sys.executable, HERE / "blender_export.py", alone, gained])
    stages = [Usd.Stage.Open(str(path)) for path in (alone, gained)]
    said = [
        {
            (prim.GetName(), attribute.GetName()): str(attribute.Get())
            for prim in stage.Traverse()
            for attribute in prim.GetAuthoredAttributes()
        }
        for stage in stages
    ]
    differences = {key for key in said[0].keys() | said[1].keys() if said[0].get(key) != said[1].get(key)}
    assert differences == {
        ("env_light", "inputs:color"),
        ("env_light", "inputs:texture:file"),
        ("Spot", "inputs:shadow:enable"),
        *((name, "inputs:enableColorTemperature") for name in ("Point", "Sun", "Spot", "Area")),
    }


@pytest.mark.parametrize(("name", "count"), [("rect", 0), ("shadow_link", 1), ("light_link", 2)])
def test_lights_for_everything_are_not_looked_through(name: str, count: int) -> None:
    """As most lights are: with many of them, and many objects, that would take long."""
    said = run([sys.executable, HERE / "blender_default_links.py", LIGHTS / f"{name}.usda"])
    assert f"collections: {count}\n" in said


def test_links_made_in_blender_are_exported(tmp_path: Path) -> None:
    """Collections that an artist makes, nested ones among them."""
    stage, _ = edited(LIGHTS / "rect.usda", tmp_path, "link")
    light = find_light(stage, "Light")
    lit, shadows = light.GetLightLinkCollectionAPI(), light.GetShadowLinkCollectionAPI()
    assert lit.GetIncludeRootAttr().Get() is False
    assert lit.GetIncludesRel().GetTargets() == [Sdf.Path("/root/Set/Block/Block")]
    assert shadows.GetIncludeRootAttr().Get() is True
    assert shadows.GetExcludesRel().GetTargets() == [Sdf.Path("/root/Set/Ball/Ball")]


@pytest.mark.parametrize(
    ("name", "kept"),
    [("focus", "inputs:shaping:focus"), ("cylinder", "inputs:length"), ("rect_textured", None)],
)
def test_power_is_the_artists(tmp_path: Path, name: str, kept: str | None) -> None:
    """An edit in Blender wins over what the stage said; the rest is still the stage's."""
    before = Usd.Stage.Open(str(LIGHTS / f"{name}.usda"))
    after, _ = edited(LIGHTS / f"{name}.usda", tmp_path, "double_power")
    source, result = find_light(before, "Light"), find_light(after, "Light")
    assert value(result, "inputs:intensity") == pytest.approx(2.0 * value(source, "inputs:intensity"))
    assert result.GetPrim().GetTypeName() == source.GetPrim().GetTypeName()
    if kept:
        assert value(source, kept) is not None
        assert value(result, kept) == value(source, kept)
    else:
        texture = result.GetPrim().GetAttribute("inputs:texture:file").Get()
        assert Path(texture.resolvedPath).samefile(LIGHTS / "card.png")


@pytest.mark.parametrize("merged", [False, True])
def test_points_keep_their_size(tmp_path: Path, merged: bool) -> None:
    """Blender's points have none; one that an artist gives is taken."""
    point, _ = edited(LIGHTS / "point.usda", tmp_path, "none", f"merge_parent_xform={merged}")
    light = find_light(point, "Light")
    assert (value(light, "treatAsPoint"), value(light, "inputs:radius")) == (True, pytest.approx(0.2))
    edit, _ = edited(LIGHTS / "point.usda", tmp_path, "give_size")
    light = find_light(edit, "Light")
    assert (value(light, "treatAsPoint"), value(light, "inputs:radius")) == (False, pytest.approx(0.3))


@pytest.mark.parametrize("times", [1, 2])
def test_every_attribute_goes_through(tmp_path: Path, times: int) -> None:
    """Exported in the stage's own unit, each light has all that it had; so it has where that is imported again."""
    source = Usd.Stage.Open(str(MANY))
    path = MANY
    for _ in range(times):
        result, said = edited(path, tmp_path, "none", "convert_scene_units=CENTIMETERS")
        path = Path(result.GetRootLayer().realPath)
        assert "umber" not in said
    compared = 0
    for prim in (prim for prim in source.Traverse() if prim.HasAPI(UsdLux.LightAPI)):
        name = "env_light" if prim.GetName() == "World" else prim.GetName()
        other = find_light(result, name)
        for attribute in prim.GetAuthoredAttributes():
            key = attribute.GetName()
            if not key.startswith(("inputs:", "treatAs")):
                continue
            wanted, got = attribute.Get(), value(other, key)
            compared += 1
            if isinstance(wanted, Sdf.AssetPath):
                assert Path(got.resolvedPath).name == Path(wanted.resolvedPath).name, (name, key)
            elif isinstance(wanted, str | bool):
                assert got == wanted, (name, key)
            else:
                assert got == pytest.approx(tuple(wanted) if hasattr(wanted, "__len__") else wanted), (name, key)
    assert compared == 40
    world, second = find_light(result, "env_light"), find_light(result, "Second")
    assert world.GetShadowLinkCollectionAPI().GetExcludesRel().GetTargets() == [Sdf.Path("/root/Set/Block/Block")]
    assert second.GetLightLinkCollectionAPI().GetExcludesRel().GetTargets() == [Sdf.Path("/root/Set/Ball/Ball")]


def test_lengths_are_in_metres(tmp_path: Path) -> None:
    """Those of the World's dome, too, where the export is in Blender's own unit."""
    stage, _ = edited(MANY, tmp_path)
    world, rect = find_light(stage, "env_light"), find_light(stage, "Rect")
    lengths = [value(light, f"inputs:shadow:{name}") for light in (world, rect) for name in ("distance", "falloff")]
    assert lengths == pytest.approx([0.03, 0.01, 0.015, 0.005])


@pytest.mark.parametrize("merged", [False, True])
def test_properties_of_others_stay(tmp_path: Path, merged: bool) -> None:
    """An artist's own are exported as Blender does it, and one with a wrong name is told."""
    stage, said = edited(LIGHTS / "rect.usda", tmp_path, "tag", f"merge_parent_xform={merged}")
    light = find_light(stage, "Light")
    holder = light.GetPrim() if merged else light.GetPrim().GetParent()
    assert holder.GetAttribute("usd:assetTag").Get() == "lamp"
    assert not holder.HasAttribute("usd:inputs:shaping:focus")
    assert holder.GetParent().GetAttribute("usd:assetTag").Get() == "lamp"
    assert holder.GetParent().GetAttribute("usd:inputs:shaping:focus").Get() == pytest.approx(0.25)
    assert value(light, "inputs:shaping:focus") == 0.5
    assert said.count("umber: Light: usd:inputs:shaping:fokus: a RectLight has no such attribute; left out") == 1


@pytest.mark.parametrize(("name", "key"), [("rect_textured", "texture"), ("ies", "shaping:ies")])
def test_exports_can_be_moved(tmp_path: Path, name: str, key: str) -> None:
    """Files are named as seen from the stage, so that they are found where all is moved together."""
    here, there = tmp_path / "here", tmp_path / "there"
    shutil.copytree(LIGHTS, here / "lights")
    (here / "shots").mkdir()
    edited(here / "lights" / f"{name}.usda", here / "shots")
    here.rename(there)
    stage = Usd.Stage.Open(str(there / "shots" / f"{name}_none.usda"))
    file = find_light(stage, "Light").GetPrim().GetAttribute(f"inputs:{key}:file").Get()
    assert file.path.startswith("../lights/")
    assert Path(file.resolvedPath).is_relative_to(there)


def test_custom_properties_do_not_come_twice(tmp_path: Path) -> None:
    """What an add-on wrote to the light is not left beside it as Blender exports custom properties."""
    stage, _ = edited(LIGHTS / "line.usda", tmp_path)
    assert value(find_light(stage, "Light"), "treatAsLine") is True
    custom = [found.GetName() for prim in stage.Traverse() for found in prim.GetAttributes() if found.IsCustom()]
    assert all(name.startswith("userProperties:blender:") for name in custom), custom


def test_portals_find_their_dome(tmp_path: Path) -> None:
    """The World is the dome, and the portal a portal of its own size."""
    stage, _ = edited(LIGHTS / "portal.usda", tmp_path)
    dome, portal = find_light(stage, "env_light"), find_light(stage, "Portal")
    assert dome.GetPrim().GetRelationship("portals").GetTargets() == [portal.GetPath()]
    assert portal.GetPrim().GetTypeName() == "PortalLight"
    assert value(portal, "inputs:width") == pytest.approx(1.6)


def test_profile_inside_blender_gets_a_file(tmp_path: Path) -> None:
    """A point with an IES node shines all around, and shadows that Blender has switched off are off."""
    stage, _ = edited(LIGHTS / "ies.usda", tmp_path, "profile_inside")
    light = find_light(stage, "Light")
    profile = light.GetPrim().GetAttribute("inputs:shaping:ies:file").Get()
    assert profile.path == "./textures/two_beams.ies"
    assert Path(profile.resolvedPath).read_text() == (LIGHTS / "two_beams.ies").read_text()
    assert value(light, "inputs:shaping:cone:angle") == 180.0
    assert value(light, "inputs:shadow:enable") is False


def test_profile_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    """A file in the place of its folder: the light loses the profile and nothing else."""
    (tmp_path / "textures").write_text("")
    stage, said = edited(LIGHTS / "ies.usda", tmp_path, "profile_inside")
    light = find_light(stage, "Light")
    assert said.count("umber: Light: the IES profile two_beams.ies is left out: ") == 1
    assert value(light, "inputs:shaping:ies:file") is None
    assert value(light, "inputs:shaping:focus") == 2.0


def test_exports_without_names_are_told(tmp_path: Path) -> None:
    """Links alone are enough to lose something."""
    _, said = edited(LIGHTS / "rect.usda", tmp_path, "link", "author_blender_name=False")
    assert said.count("as Author Blender Names is off") == 1


def test_bad_properties_are_named(tmp_path: Path) -> None:
    """Values of wrong types: each is named with its object, once, and the frame renders."""
    output = tmp_path / "spoilt.exr"
    said = run([sys.executable, HERE / "blender_edits.py", LIGHTS / "focus.usda", output, "spoil"])
    for what in (
        "Light: usd:inputs:shaping:focus = 'much': a value of type float is wanted",
        "Light: usd:inputs:shaping:focusTint = [1.0, 2.0]: a value of type color3f is wanted",
        "Ball: usd:light = 'LavaLamp': of a mesh MeshLightAPI is wanted",
    ):
        assert said.count(what) == 1, said
    assert "Traceback" not in said
    assert read_colour(output).mean() > 1e-3


def test_missing_profile_is_named(tmp_path: Path) -> None:
    """A file that is not there: named with its object; the frame renders without."""
    output = tmp_path / "lost.exr"
    said = run([sys.executable, HERE / "blender_edits.py", LIGHTS / "ies.usda", output, "lose_profile"])
    assert said.count("umber: Light: inputs:shaping:ies:file = '/nowhere/lost.ies': there is no such file") == 1, said
    assert read_colour(output).mean() > 1e-4


def test_properties_are_the_delegates_settings() -> None:
    """The same keys and defaults, for the viewport and for final renders; Blender itself decides about two."""
    said = run([sys.executable, HERE / "blender_settings.py"])
    settings = json.loads(next(line for line in said.splitlines() if line.startswith("{")))
    delegate = settings["delegate"]
    for key in ("enableInteractive", "domeLightCameraVisibility"):
        delegate.pop(key)
    assert settings["final"] == delegate
    assert settings["viewport"] == delegate


def test_limits_are_the_tables() -> None:
    """Ranges and words are those of the table of settings, as far as Blender's properties reach."""
    said = run([sys.executable, HERE / "blender_settings.py"])
    limits = json.loads(next(line for line in said.splitlines() if line.startswith("{")))["limits"]
    table, choice = ((SETTINGS / name).read_text() for name in ("table.rs", "choice.rs"))
    ranges = re.findall(r'"([\w:]+)", Some\(\(([^,]+), ([^)]+)\)\)', table)
    numbers = {key: [float(end.replace("_", "")) for end in ends] for key, *ends in ranges}
    # The largest integer of Blender's.
    numbers["umber:seed"][1] = 2.0**31 - 1.0
    words = set(re.findall(r'^ +\w+ = "(\w+)",$', choice, re.MULTILINE))
    assert {key: found for key, found in limits.items() if found and not isinstance(found[0], str)} == {
        key: pytest.approx(ends) for key, ends in numbers.items()
    }
    assert {*limits["umber:integrator"], *limits["umber:rasterColor"]} == words


def test_missing_renderer_is_told(tmp_path: Path) -> None:
    """Without a plugin folder there is no picture, and a word about what is missing."""
    environment = {**os.environ, "UMBER_PLUGIN_PATH": str(tmp_path)}
    command = [sys.executable, HERE / "blender_render.py", LIGHTS / "rect.usda", tmp_path / "no.exr"]
    said = run(command, environment, code=1)
    assert "plugInfo.json" in said
    assert str(tmp_path) in said
    del environment["UMBER_PLUGIN_PATH"]
    assert "UMBER_PLUGIN_PATH is not set" in run(command, environment, code=1)
