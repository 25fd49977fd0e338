"""UsdLux lights."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

from umber.description import Color, Light
from umber.stage_reader.light_apis import read_light_apis
from umber.stage_reader.placement import Space
from umber.stage_reader.reading import Reading, asset_file, matrix, single

KINDS = {
    "DistantLight": "distant",
    "DomeLight": "dome",
    "DomeLight_1": "dome",
    "PortalLight": "portal",
    "RectLight": "rect",
    "SphereLight": "sphere",
    "DiskLight": "disk",
    "CylinderLight": "cylinder",
}
TEXTURE_FORMATS = ("automatic", "latlong", "mirroredBall", "angular", "cubeMapVerticalCross")
MATERIAL_SYNC_MODES = ("materialGlowTintsLight", "independent", "noMaterialResponse")


def read_light(reading: Reading, prim: Usd.Prim, space: Space) -> Iterator[Light]:
    """A light, once for each place where instancing puts it."""
    kind = KINDS.get(prim.GetTypeName())
    if kind is None:
        what = prim.GetTypeName() or "typeless prim"
        reading.warn(prim, f"lights of this type are not supported yet; left out ({what})")
        return
    own = _to_space(reading, prim, space)
    for outer in space.placements():
        light = Light(reading.unique_path(prim.GetPath()), kind, matrix(own * outer))
        _read_shape(reading, prim, light)
        _read_emission(reading, prim, light)
        read_light_apis(reading, prim, light)
        yield light


def read_mesh_light(reading: Reading, prim: Usd.Prim, mesh: str) -> Light:
    """The light that shines from a described mesh: its own (UsdLuxMeshLightAPI), or a GeometryLight."""
    path = mesh if prim.IsA(UsdGeom.Gprim) else reading.unique_path(prim.GetPath())
    light = Light(path, "mesh", mesh=mesh)
    mode = reading.value(prim, "light:materialSyncMode")
    if mode in MATERIAL_SYNC_MODES:
        light.material_sync_mode = mode
    else:
        reading.warn(prim, f"materialSyncMode '{mode}' is not known; taken as '{light.material_sync_mode}'")
    _read_emission(reading, prim, light)
    read_light_apis(reading, prim, light)
    return light


def geometry_targets(prim: Usd.Prim) -> list[Sdf.Path]:
    """What a GeometryLight shines from."""
    return list(prim.GetRelationship("geometry").GetForwardedTargets())


def _to_space(reading: Reading, prim: Usd.Prim, space: Space) -> Gf.Matrix4d:
    own = space.from_object(reading, prim)
    if prim.GetTypeName() != "DomeLight_1":
        return own
    pole = UsdLux.DomeLight_1(prim).GetPoleAxisAttr().Get()
    up_axis = UsdGeom.GetStageUpAxis(reading.stage)
    z_up = pole == UsdLux.Tokens.Z or (pole == UsdLux.Tokens.scene and up_axis == UsdGeom.Tokens.z)
    turn = Gf.Matrix4d(1).SetRotate(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90)) if z_up else Gf.Matrix4d(1)
    return turn * own


def _input(reading: Reading, prim: Usd.Prim, name: str, fallback: Any) -> Any:  # noqa: ANN401
    value = reading.value(prim, f"inputs:{name}")
    return fallback if value is None else value


def _read_shape(reading: Reading, prim: Usd.Prim, light: Light) -> None:
    def number(name: str, fallback: float) -> float:
        return single(_input(reading, prim, name, fallback))

    if light.kind == "distant":
        light.angle_deg = number("angle", light.angle_deg)
    elif light.kind == "portal":
        light.width, light.height = number("width", light.width), number("height", light.height)
    elif light.kind == "rect":
        light.width, light.height = number("width", light.width), number("height", light.height)
        light.texture_file = asset_file(_input(reading, prim, "texture:file", None))
    elif light.kind == "sphere":
        light.radius = number("radius", light.radius)
        light.treat_as_point = bool(reading.value(prim, "treatAsPoint"))
    elif light.kind == "disk":
        light.radius = number("radius", light.radius)
    elif light.kind == "cylinder":
        light.radius, light.length = number("radius", light.radius), number("length", light.length)
        light.treat_as_line = bool(reading.value(prim, "treatAsLine"))
    else:
        light.portals = _portals(reading, prim)
        light.texture_file = asset_file(_input(reading, prim, "texture:file", None))
        _read_texture_format(reading, prim, light)


def _read_texture_format(reading: Reading, prim: Usd.Prim, light: Light) -> None:
    texture_format = str(_input(reading, prim, "texture:format", "") or "automatic")
    if texture_format in TEXTURE_FORMATS:
        light.texture_format = texture_format
    else:
        reading.warn(prim, f"there is no texture format '{texture_format}'; it is taken as automatic")


def _portals(reading: Reading, prim: Usd.Prim) -> list[str]:
    """Paths of a dome's portals, without those that are hidden."""

    def is_hidden(path: Sdf.Path) -> bool:
        portal = UsdGeom.Imageable(reading.stage.GetPrimAtPath(path))
        return bool(portal) and portal.ComputeVisibility(reading.time) == UsdGeom.Tokens.invisible

    targets = prim.GetRelationship("portals").GetForwardedTargets()
    return [path.pathString for path in targets if not is_hidden(path)]


def _read_emission(reading: Reading, prim: Usd.Prim, light: Light) -> None:
    for name in ("intensity", "exposure", "diffuse", "specular"):
        setattr(light, name, single(_input(reading, prim, name, getattr(light, name))))
    color: Color = tuple(_input(reading, prim, "color", light.color))
    light.color = color
    light.normalize = bool(_input(reading, prim, "normalize", False))
    light.shadow_enable = bool(_input(reading, prim, "shadow:enable", True))
    if _input(reading, prim, "enableColorTemperature", False):
        light.color_temperature = single(_input(reading, prim, "colorTemperature", 6500.0))
