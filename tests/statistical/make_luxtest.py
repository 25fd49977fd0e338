"""Computes what frames of ASWF's luxtest must look like: UsdLux's formulas, integrated numerically.

    python tests/statistical/make_luxtest.py [rect_3 ...]

No renderer takes part. Each pixel is sampled at a grid of points; from each point that its ray meets, direct light is
the sum over a fine grid on the light of  albedo / pi * L * cos * cos / distance^2 * area, where nothing is between;
L is intensity * 2^exposure * color (* temperature) / sizeFactor, by the shaping's factors (schema.usda of usdLux).
Writes luxtest.npz: NAME, radiance as (height, width, 3), and NAME_usable: which pixels hold neither an
edge nor the light itself, where a grid of points is no good estimate.
"""

from __future__ import annotations

import math
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdShade

HERE = Path(__file__).parent
LUXTEST = HERE.parents[2] / "shared/assets/luxtest"
# stage and frame, by name
FRAMES = {
    f"{stage}_{frame}": (stage, frame)
    for stage, frames in {
        "distant": [3, 13, 25, 34],  # tilted; wide; wide and normalized; cold
        "rect": [3, 8, 13, 17, 31, 33, 38, 43, 48],  # tilted; wide; normalized; warm; cone; soft; focus, tints
        "sphere": [8, 13, 19, 33],
        "disk": [3, 8, 13, 17, 38],
        "cylinder": [3, 8, 13, 19, 31],
        "iesDown": [25, 60],
        "dome": [1],
    }.items()
    for frame in frames
}
SIZE = 24
# points a pixel, across and down; more under a point's profile, and under a texture. Light is not smooth everywhere:
# beside the plane of a disk or a rectangle it ends, and two points of Gauss' rule there were 5 % off
SUB = 8
POINT_SUB = 12
POINT_RADIUS = 0.01
DOME_SUB = 24
CHUNK = 256
DEFAULT_ALBEDO = 0.18
Array = NDArray[np.float64]


def grid(count: int) -> Array:
    """Midpoints of so many parts of [0, 1]."""
    return (np.arange(count) + 0.5) / count


@dataclass
class Quad:
    """A flat mesh: a corner, two edges, and what it reflects."""

    corner: Array
    edges: tuple[Array, Array]
    albedo: float

    @property
    def normal(self) -> Array:
        """Unit."""
        n = np.cross(*self.edges)
        return np.asarray(n / np.linalg.norm(n))

    def hit(self, origins: Array, directions: Array) -> Array:
        """Distance in lengths of the direction; infinite where it misses. Shapes broadcast."""
        with np.errstate(divide="ignore", invalid="ignore"):
            t = ((self.corner - origins) @ self.normal) / (directions @ self.normal)
            at = origins + t[..., None] * directions - self.corner
            inside = np.isfinite(t) & (t > 1e-6)
            for edge in self.edges:
                along = at @ edge / (edge @ edge)
                inside &= (along > 0) & (along < 1)
        return np.where(inside, t, np.inf)


@dataclass
class Emitter:
    """Points on a light, where they face, the area that each stands for, and the radiance without shaping."""

    points: Array
    normals: Array
    areas: Array
    radiance: Array


def quads(stage: Usd.Stage, time: Usd.TimeCode) -> list[Quad]:
    """The stage's meshes: each is a flat grid."""
    found = []
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh):
            (x0, y0, z0), (x1, y1, z1) = UsdGeom.Mesh(prim).GetExtentAttr().Get()
            matrix = UsdGeom.XformCache(time).GetLocalToWorldTransform(prim)
            corner = (x0, y0, z0)
            others = [(x1, y0, z0), (x0, y0, z1) if y0 == y1 else (x0, y1, z0)]
            world = [np.array(matrix.Transform(Gf.Vec3d(*p))) for p in (corner, *others)]
            bound, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
            albedo = 1.0 if bound else DEFAULT_ALBEDO  # their one material is white, without a specular part
            found.append(Quad(world[0], (world[1] - world[0], world[2] - world[0]), albedo))
    return found


def radiance(light: Usd.Prim, time: Usd.TimeCode, size_factor: float) -> Array:
    """By UsdLuxLightAPI."""
    api = UsdLux.LightAPI(light)
    value = api.GetIntensityAttr().Get(time) * 2.0 ** api.GetExposureAttr().Get(time) * api.GetDiffuseAttr().Get(time)
    color = np.array(api.GetColorAttr().Get(time), np.float64) * value
    if api.GetEnableColorTemperatureAttr().Get(time):
        color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(api.GetColorTemperatureAttr().Get(time)))
    return np.asarray(color / size_factor if api.GetNormalizeAttr().Get(time) else color)


def emitter(light: Usd.Prim, time: Usd.TimeCode) -> Emitter:
    """A grid on an area light."""

    def number(name: str) -> float:
        return float(light.GetAttribute(f"inputs:{name}").Get(time))

    kind = light.GetTypeName()
    if kind == "RectLight":
        u, v = (m.ravel() for m in np.meshgrid(grid(48), grid(48)))
        local = np.stack([(u - 0.5) * number("width"), (v - 0.5) * number("height"), 0 * u], axis=1)
        normals = np.tile([0.0, 0.0, -1.0], (len(u), 1))
        areas = np.full(len(u), number("width") * number("height") / len(u))
    elif kind == "DiskLight":
        u, v = (m.ravel() for m in np.meshgrid(grid(32), grid(64)))
        r, phi = number("radius") * np.sqrt(u), math.tau * v
        local = np.stack([r * np.cos(phi), r * np.sin(phi), 0 * r], axis=1)
        normals = np.tile([0.0, 0.0, -1.0], (len(u), 1))
        areas = np.full(len(u), math.pi * number("radius") ** 2 / len(u))
    elif kind == "SphereLight":
        counts = (12, 24) if number("radius") < POINT_RADIUS else (40, 64)
        u, v = (m.ravel() for m in np.meshgrid(*map(grid, counts)))
        z, phi = 1 - 2 * u, math.tau * v
        normals = np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=1)
        local = number("radius") * normals
        areas = np.full(len(u), 4 * math.pi * number("radius") ** 2 / len(u))
    elif kind == "CylinderLight":
        u, v = (m.ravel() for m in np.meshgrid(grid(32), grid(96)))
        phi = math.tau * v
        normals = np.stack([0 * phi, np.cos(phi), np.sin(phi)], axis=1)
        local = number("radius") * normals + np.stack([(u - 0.5) * number("length"), 0 * u, 0 * u], axis=1)
        areas = np.full(len(u), math.tau * number("radius") * number("length") / len(u))
    else:
        sys.exit(f"{light.GetPath()}: no grid for a {kind}")
    matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(light))
    turn = matrix[:3, :3]
    if not np.allclose(turn @ turn.T, np.eye(3), atol=1e-6):
        sys.exit(f"{light.GetPath()}: scaled at {time}: another frame")
    return Emitter(local @ turn + matrix[3, :3], normals @ turn, areas, radiance(light, time, areas.sum()))


def shaping(light: Usd.Prim, time: Usd.TimeCode, directions: Array) -> Array:
    """The factor of UsdLuxShapingAPI on emission along unit directions of world space."""
    api = UsdLux.ShapingAPI(light)
    turn = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(light))[:3, :3]
    local = directions @ turn.T
    off_axis = np.arccos(np.clip(-local[..., 2], -1, 1))
    factor = np.ones((*off_axis.shape, 3))
    cutoff = math.radians(api.GetShapingConeAngleAttr().Get(time))
    softness = min(max(api.GetShapingConeSoftnessAttr().Get(time), 0.0), 1.0)
    start = cutoff * (1 - softness)
    t = np.clip((off_axis - start) / max(cutoff - start, 1e-12), 0, 1)
    factor *= np.where(off_axis > cutoff, 0.0, 1 - t * t * (3 - 2 * t) if softness > 0 else 1.0)[..., None]
    focus = api.GetShapingFocusAttr().Get(time) or 0.0
    if focus > 0:
        if light.GetTypeName() not in ("RectLight", "DiskLight"):
            sys.exit(f"{light.GetPath()}: focus is about the surface's normal: another frame")
        tint = np.array(api.GetShapingFocusTintAttr().Get(time))
        blend = (np.abs(local[..., 2]) ** focus)[..., None]
        factor *= tint * (1 - blend) + blend
    file = api.GetShapingIesFileAttr().Get(time)
    if file is not None and file.path:
        scale = api.GetShapingIesAngleScaleAttr().Get(time)
        # horizontal angle 0 is -X, 90 degrees -Y: anticlockwise seen from above, where -Z is down
        around = np.degrees(np.arctan2(-local[..., 1], -local[..., 0])) % 360
        factor *= profile(Path(file.resolvedPath), np.degrees(off_axis) / (scale or 1.0), around)[..., None]
    return factor


def profile(file: Path, vertical: Array, horizontal: Array) -> Array:
    """Candelas of an IES profile in type C, bilinear between its angles (degrees), nothing outside them."""
    numbers = [float(x) for x in re.split(r"\s+", file.read_text().split("TILT=NONE")[1].strip())]
    multiplier, down, around = numbers[2], int(numbers[3]), int(numbers[4])
    angles = numbers[13 : 13 + down + around]
    values = multiplier * numbers[10] * np.array(numbers[13 + down + around :]).reshape(around, down)
    v, h = np.array(angles[:down]), np.array(angles[down:])

    def place(x: Array, known: Array) -> tuple[NDArray[np.intp], Array]:
        at = np.clip(np.searchsorted(known, x, side="right") - 1, 0, len(known) - 2)
        return at, np.clip((x - known[at]) / (known[at + 1] - known[at]), 0, 1)

    (i, s), (j, t) = place(vertical, v), place(horizontal, h)
    mixed = (1 - t) * ((1 - s) * values[j, i] + s * values[j, i + 1])
    mixed += t * ((1 - s) * values[j + 1, i] + s * values[j + 1, i + 1])
    return np.where((vertical >= v[0]) & (vertical <= v[-1]), mixed, 0.0)


def camera_rays(stage: Usd.Stage, time: Usd.TimeCode, sub: int) -> tuple[Array, Array]:
    """Origin, and unit directions as (height, width, points, 3), row 0 at the top."""
    prim = next(prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera))
    camera = UsdGeom.Camera(prim).GetCamera(time)
    half = camera.horizontalAperture / 2 / camera.focalLength
    at = (np.arange(SIZE)[:, None] + grid(sub)) / SIZE
    x = np.broadcast_to(at[None, :, None, :], (SIZE, SIZE, sub, sub)).reshape(SIZE, SIZE, -1)
    y = np.broadcast_to(at[:, None, :, None], (SIZE, SIZE, sub, sub)).reshape(SIZE, SIZE, -1)
    local = np.stack([half * (2 * x - 1), half * (1 - 2 * y), -np.ones_like(x)], axis=-1)
    matrix = np.array(camera.transform)
    directions = local @ matrix[:3, :3]
    return matrix[3, :3], directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def reflected(
    points: Array, quad: Quad, viewer: Array, light: Usd.Prim, time: Usd.TimeCode, scene: list[Quad]
) -> Array:
    """Radiance towards the viewer from points on a quad, (points, 3): direct light."""
    normal = quad.normal if quad.normal @ (viewer - points[0]) > 0 else -quad.normal
    if light.GetTypeName() == "DistantLight":
        return under_distant(points, quad.albedo, normal, light, time, scene)
    source = emitter(light, time)
    out = np.zeros((len(points), 3))
    for start in range(0, len(points), CHUNK):
        part = points[start : start + CHUNK]
        between = source.points[None] - part[:, None]
        squared = (between**2).sum(axis=-1)
        unit = between / np.sqrt(squared)[..., None]
        weight = np.maximum(unit @ normal, 0) * np.maximum(-(unit * source.normals).sum(axis=-1), 0)
        weight *= source.areas / squared
        lit = weight > 0
        origins = np.broadcast_to(part[:, None], between.shape)[lit]
        for other in scene:
            if other is not quad:
                weight[lit] *= other.hit(origins, between[lit]) > 1
        factor = shaping(light, time, -unit) if light.HasAPI(UsdLux.ShapingAPI) else np.ones((*weight.shape, 3))
        out[start : start + CHUNK] = (weight[..., None] * factor).sum(axis=1)
    return out * source.radiance * quad.albedo / math.pi


def under_distant(
    points: Array, albedo: float, normal: Array, light: Usd.Prim, time: Usd.TimeCode, scene: list[Quad]
) -> Array:
    """The same under a distant light: a cone of directions. Nothing here is in the way of it."""
    if len(scene) != 1:
        sys.exit("a distant light with occluders: another frame")
    half = math.radians(light.GetAttribute("inputs:angle").Get(time)) / 2
    sine = math.sin(half) ** 2
    size_factor = math.pi * (sine if half <= math.pi / 2 else 2 - sine) if half > 0 else 1.0
    u, v = (m.ravel() for m in np.meshgrid(grid(256), grid(256)))
    z = 1 - u * (1 - math.cos(half))
    around = np.sqrt(np.maximum(1 - z * z, 0))
    local = np.stack([around * np.cos(math.tau * v), around * np.sin(math.tau * v), z], axis=1)
    turn = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(light))[:3, :3]
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    solid_angle = math.tau * (1 - math.cos(half))
    irradiance = np.maximum((local @ turn) @ normal, 0).mean() * solid_angle
    value = radiance(light, time, size_factor) * irradiance * albedo / math.pi
    return np.tile(value, (len(points), 1))


def dome(light: Usd.Prim, time: Usd.TimeCode, directions: Array) -> Array:
    """Radiance of a dome's lat-long texture along directions, bilinear."""
    with OpenEXR.File(str(light.GetAttribute("inputs:texture:file").Get(time).resolvedPath)) as file:
        texture = file.channels()["RGB"].pixels.astype(np.float64)
    height, width = texture.shape[:2]
    turn = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(light))[:3, :3]
    x, y, z = np.moveaxis(directions @ turn.T, -1, 0)
    column = (0.5 - np.arctan2(x, z) / math.tau) * width - 0.5
    row = np.arccos(np.clip(y, -1, 1)) / math.pi * height - 0.5
    i, j = np.floor(row).astype(int), np.floor(column).astype(int)
    s, t = (row - i)[..., None], (column - j)[..., None]

    def at(a: NDArray[np.int_], b: NDArray[np.int_]) -> Array:
        return np.asarray(texture[np.clip(a, 0, height - 1), b % width])

    mixed = (1 - s) * ((1 - t) * at(i, j) + t * at(i, j + 1)) + s * ((1 - t) * at(i + 1, j) + t * at(i + 1, j + 1))
    return mixed * radiance(light, time, 1.0)


def frame(name: str) -> tuple[Array, NDArray[np.bool_]]:
    """A frame's radiance, and which pixels are good for a comparison."""
    file, number = FRAMES[name]
    stage, time = Usd.Stage.Open(str(LUXTEST / "usd" / f"{file}.usda")), Usd.TimeCode(number)
    light = next(prim for prim in stage.Traverse() if prim.HasAPI(UsdLux.LightAPI))
    if light.GetTypeName() == "DomeLight":
        _, directions = camera_rays(stage, time, DOME_SUB)
        return dome(light, time, directions).mean(axis=2), np.ones((SIZE, SIZE), bool)
    is_point = light.GetTypeName() == "SphereLight" and light.GetAttribute("inputs:radius").Get(time) < POINT_RADIUS
    origin, directions = camera_rays(stage, time, POINT_SUB if is_point else SUB)
    scene = quads(stage, time)
    distances = np.stack([quad.hit(origin[None, None, None], directions) for quad in scene])
    nearest = np.where(np.isfinite(distances.min(axis=0)), distances.argmin(axis=0), -1)
    values = np.zeros((*nearest.shape, 3))
    for index, quad in enumerate(scene):
        seen = nearest == index
        if seen.any():
            points = origin + distances[index][seen][:, None] * directions[seen]
            values[seen] = reflected(points, quad, origin, light, time, scene)
    usable = (nearest == nearest[..., :1]).all(axis=2)
    if not is_point:
        spread = values.max(axis=2) - values.min(axis=2)
        usable &= (spread <= 0.5 * values.max(axis=2)).all(axis=-1)
    if light.GetTypeName() != "DistantLight":
        usable &= ~covered(emitter(light, time).points, stage, time)
    return values.mean(axis=2), usable


def covered(points: Array, stage: Usd.Stage, time: Usd.TimeCode) -> NDArray[np.bool_]:
    """Pixels that hold points of the light, or are next to one that does."""
    prim = next(prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera))
    camera = UsdGeom.Camera(prim).GetCamera(time)
    half = camera.horizontalAperture / 2 / camera.focalLength
    matrix = np.array(camera.transform)
    local = (points - matrix[3, :3]) @ matrix[:3, :3].T
    column = ((local[:, 0] / -local[:, 2] / half + 1) / 2 * SIZE).astype(int)
    row = ((1 - local[:, 1] / -local[:, 2] / half) / 2 * SIZE).astype(int)
    out = np.zeros((SIZE, SIZE), bool)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            inside = (row + i >= 0) & (row + i < SIZE) & (column + j >= 0) & (column + j < SIZE)
            out[(row + i)[inside], (column + j)[inside]] = True
    return out


def main() -> None:
    """One pair of arrays a frame."""
    out = HERE / "luxtest.npz"
    known = np.load(out) if sys.argv[1:] and out.exists() else {}
    kept = {name: known[name] for name in known if name.removesuffix("_usable") in FRAMES}
    for name in sys.argv[1:] or FRAMES:
        value, usable = frame(name)
        kept[name], kept[f"{name}_usable"] = value.astype(np.float32), usable
        print(f"{name}: mean {value.mean(axis=(0, 1))}, {usable.sum()} of {usable.size} pixels usable", flush=True)
        np.savez_compressed(out, **kept)


if __name__ == "__main__":
    main()
