"""Draws where textbook methods fail, beside what replaces them: the pictures of docs/from-polygon-to-path.md.

    target/venv/usd-core/bin/python tests/accuracy/chapter/figures.py [mean_depth edges small far leaving]

Each picture has the textbook's method on the left and Umber on the right, and prints the number that goes with it. The
textbook's methods are those of `method.py`, written for whole arrays and in single precision, as renderers compute.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pxr import Gf, Usd, UsdGeom, UsdLux
from umber import Session
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "docs/scenes/chapter"))
from make import SPHERE, icosphere, textbook

PICTURES = ROOT / "docs/images/chapter"
SIZE = 256
HALF = 0.2
EPSILON = np.float32(1e-6)
OFFSET = np.float32(1e-4)
SUN = Gf.Vec3d(1, 1, 1).GetNormalized()
Floats = NDArray[np.float32]
Faces = NDArray[np.int32]


def screen() -> NDArray[np.float64]:
    """Where the samples are, (SIZE, SIZE, 2): the textbook's grid starts on the corner at the top left."""
    step = np.arange(SIZE) * (2 * HALF / SIZE)
    x, y = np.meshgrid(step - HALF, HALF - step)
    return np.stack([x, y], -1)


def rays(scale: float, place: Gf.Vec3d) -> tuple[Floats, Floats]:
    """Origin and directions of the eye's rays in single precision, the world scaled and then moved."""
    at = np.concatenate([screen(), np.full((SIZE, SIZE, 1), -1.0)], -1).reshape(-1, 3)
    at /= np.linalg.norm(at, axis=-1, keepdims=True)
    return np.array(np.array([0, 0, 1]) * scale + np.array(place), np.float32), at.astype(np.float32)


def triangles(scale: float, place: Gf.Vec3d) -> Floats:
    """The sphere's corners in the world, (faces, 3, 3), in single precision."""
    points, faces = icosphere(1)
    corners = np.array([[np.array(points[i] + SPHERE) for i in face] for face in faces])
    return np.array(corners * scale + np.array(place), np.float32)


def intersect(origin: Floats, direction: Floats, corners: Floats) -> Floats:
    """Distance to a triangle along rays; infinite where there is none (Moeller and Trumbore 1997)."""
    a, b, c = corners
    to_b, to_c = b - a, c - a
    h = np.cross(direction, to_c)
    determinant = h @ to_b
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        s = origin - a
        u = (s * h).sum(-1) / determinant
        q = np.cross(s, to_b)
        v = (direction * q).sum(-1) / determinant
        t = (q @ to_c if q.ndim > 1 else np.broadcast_to(q @ to_c, determinant.shape)) / determinant
        inside = (u >= 0) & (v >= 0) & (u + v <= 1)
    hit = (np.abs(determinant) >= EPSILON) & inside & (t > EPSILON)
    return np.where(hit, t, np.float32(np.inf)).astype(np.float32)


def nearest(origin: Floats, direction: Floats, world: Floats) -> tuple[Faces, Floats]:
    """Face and distance of the nearest triangle; -1 for none."""
    distances = np.stack([intersect(origin, direction, corners) for corners in world])
    face = distances.argmin(0).astype(np.int32)
    best = distances.min(0)
    return np.where(np.isfinite(best), face, -1).astype(np.int32), best


def by_mean_depth(corners: NDArray[np.float64]) -> Faces:
    """The polygon that is seen when they are painted from back to front by mean depth."""
    order = np.argsort(-np.linalg.norm(corners.mean(1) - [0, 0, 1], axis=-1), kind="stable")
    at, seen = screen(), np.full((SIZE, SIZE), -1, np.int32)
    for face in order:
        flat = corners[face, :, :2] / (1 - corners[face, :, 2:])
        inside = np.zeros((SIZE, SIZE), bool)
        for (x0, y0), (x1, y1) in zip(np.roll(flat, 1, 0), flat, strict=True):
            if y0 != y1:
                crosses = (y1 > at[..., 1]) != (y0 > at[..., 1])
                inside ^= crosses & (at[..., 0] < (x0 - x1) / (y0 - y1) * (at[..., 1] - y1) + x1)
        seen[inside] = face
    return seen


def umber(stage: Usd.Stage, aov: str, **values: str) -> NDArray[Any]:
    """Umber's picture of a stage, row 0 at the top."""
    session = Session()
    session.set("enableInteractive", "false")
    for key, value in values.items():
        session.set(key if key.startswith("converged") else f"umber:{key}", value)
    moment = Usd.TimeCode.EarliestTime()
    session.camera(read_camera(UsdGeom.Camera.Get(stage, "/Eye"), moment))
    feed(session, read_stage(stage, moment, frozenset({"render"}), lambda _: None))
    session.set_film(SIZE, SIZE, ["color", aov] if aov != "color" else ["color"])
    session.start()
    while not session.wait(10.0):
        pass
    return np.asarray(session.resolve(aov))


def moved(scale: float, place: Gf.Vec3d) -> Usd.Stage:
    """The textbook's stage, all of it scaled and then moved by transforms."""
    stage = textbook()
    for path, at in (("/Icosphere", SPHERE), ("/Eye", Gf.Vec3d(0, 0, 1))):
        prim = UsdGeom.XformCommonAPI(stage.GetPrimAtPath(path))
        prim.SetTranslate(at * scale + place)
        prim.SetScale(Gf.Vec3f(scale) if path == "/Icosphere" else Gf.Vec3f(1))
    UsdGeom.Camera.Get(stage, "/Eye").GetClippingRangeAttr().Set(Gf.Vec2f(1e-2 * scale, 1e3 * scale))
    return stage


def colors(faces: Faces) -> Floats:
    """One colour a face; white where there is none."""
    table = np.random.default_rng(3).uniform(0.15, 0.95, (int(faces.max()) + 1, 3)).astype(np.float32)
    return np.where((faces >= 0)[..., None], table[faces], np.float32(1))


def write(name: str, *pictures: Floats) -> None:
    """Side by side, sRGB."""
    whole = np.concatenate(pictures, 1).clip(0, 1)
    encoded = np.where(whole <= 0.0031308, 12.92 * whole, 1.055 * whole ** (1 / 2.4) - 0.055)
    PICTURES.mkdir(parents=True, exist_ok=True)
    Image.fromarray((encoded * 255 + 0.5).astype(np.uint8)).save(PICTURES / f"{name}.png")


def long_triangles() -> NDArray[np.float64]:
    """Some that are long, and lean towards the eye and away from it."""
    random = np.random.default_rng(2)
    middles = random.uniform((-0.7, -0.7, -5.6), (0.7, 0.7, -4.4), (14, 3))
    along = random.normal(size=(14, 3))
    along *= 1.1 / np.linalg.norm(along, axis=-1, keepdims=True)
    across = np.cross(along, random.normal(size=(14, 3)))
    across *= 0.25 / np.linalg.norm(across, axis=-1, keepdims=True)
    return np.stack([middles - along, middles + along - across, middles + along + across], 1)


def write_painted(name: str, corners: NDArray[np.float64], stage: Usd.Stage) -> str:
    """By mean depth, by the depth at each pixel, and where the two differ; says how often they do."""
    left = by_mean_depth(corners)
    right = np.asarray(umber(stage, "elementId", integrator="raster")).reshape(SIZE, SIZE)
    differ = left != right
    marked = colors(right) * np.float32(0.25) + np.float32(0.75)
    marked[differ] = (0.9, 0.0, 0.0)
    write(name, colors(left), colors(right), marked)
    return f"{np.count_nonzero(differ)} of {np.count_nonzero(right >= 0)} pixels"


def mean_depth() -> None:
    """Long triangles, of which no single number says which is in front."""
    corners, stage = long_triangles(), textbook()
    mesh = UsdGeom.Mesh.Get(stage, "/Icosphere")
    points = [Gf.Vec3f(*corner) for corner in (corners - np.array(SPHERE)).reshape(-1, 3).tolist()]
    mesh.GetPointsAttr().Set(points)
    mesh.GetFaceVertexCountsAttr().Set([3] * len(corners))
    mesh.GetFaceVertexIndicesAttr().Set(list(range(len(points))))
    mesh.CreateDoubleSidedAttr(True)
    print(f"mean_depth: the wrong triangle in {write_painted('mean_depth', corners, stage)}")


def edges() -> None:
    """The sphere, on which a triangle of the two beside an edge is taken by one rule or another."""
    corners = triangles(1.0, Gf.Vec3d(0)).astype(np.float64)
    print(f"edges: another triangle in {write_painted('edges', corners, textbook())}")


def small() -> None:
    """Everything a four-hundredth of its size, with a fixed epsilon."""
    scale = 1 / 400
    left, _ = nearest(*rays(scale, Gf.Vec3d(0)), triangles(scale, Gf.Vec3d(0)))
    left = left.reshape(SIZE, SIZE)
    right = np.asarray(umber(moved(scale, Gf.Vec3d(0)), "elementId", integrator="mirror")).reshape(SIZE, SIZE)
    seen, missed = right >= 0, (left < 0) & (right >= 0)
    behind = np.count_nonzero(seen & ~missed & (left != right))
    counts = [np.count_nonzero(pixels) for pixels in (missed, seen)]
    print(f"small: {counts[0]} of {counts[1]} pixels see nothing, {behind} another triangle")
    write("small", colors(left), colors(right))


def far() -> None:
    """Everything four million units from the origin."""
    place = Gf.Vec3d(4e6, 0, 0)
    left, _ = nearest(*rays(1.0, place), triangles(1.0, place))
    left = left.reshape(SIZE, SIZE)
    right = np.asarray(umber(moved(1.0, place), "elementId", integrator="mirror")).reshape(SIZE, SIZE)
    print(f"far: another face, or none, in {np.count_nonzero(left != right)} of {np.count_nonzero(right >= 0)} pixels")
    write("far", colors(left), colors(right))


def leaving() -> None:
    """Light of the sun, on everything two thousand times its size: shadow rays start a fixed 1e-4 above the surface."""
    scale = 2000.0
    (origin, directions), world = rays(scale, Gf.Vec3d(0)), triangles(scale, Gf.Vec3d(0))
    face, distance = nearest(origin, directions, world)
    a, b, c = np.moveaxis(world[face], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    sun = np.array(SUN, np.float32)
    start = origin + directions * np.where(face >= 0, distance, 0)[:, None] + normal * OFFSET
    lit = ((normal * sun).sum(-1) > 0) & (face >= 0)
    blocked = np.zeros(len(face), bool)
    for corners in world:
        blocked |= np.isfinite(intersect(start, np.broadcast_to(sun, start.shape), corners))
    cosine = np.where(lit & ~blocked, (normal * sun).sum(-1), 0).astype(np.float32)
    print(f"leaving: {np.count_nonzero(lit & blocked)} of {np.count_nonzero(lit)} lit pixels are in their own shadow")
    left = np.where(face[:, None] >= 0, np.repeat(cosine[:, None], 3, 1) * np.float32(0.8), 1)
    stage = moved(scale, Gf.Vec3d(0))
    light = UsdLux.DistantLight.Define(stage, "/Sun")
    light.CreateAngleAttr(0.0)
    light.CreateIntensityAttr(1.0)
    turn = Gf.Rotation(Gf.Vec3d(0, 0, 1), SUN)
    UsdGeom.Xformable(light).AddTransformOp().Set(Gf.Matrix4d().SetRotate(turn))
    UsdGeom.Mesh.Get(stage, "/Icosphere").CreateDisplayColorAttr([Gf.Vec3f(0.8)])
    picture = umber(stage, "color", integrator="direct", convergedSamplesPerPixel="16").astype(np.float32)
    brightest = picture[..., :3].max()
    right = picture[..., :3] / max(brightest, np.float32(1e-9)) * np.float32(0.8 * cosine.max())
    right = np.where(picture[..., 3:] > 0, right, 1)
    write("leaving", left.reshape(SIZE, SIZE, 3).astype(np.float32), right.astype(np.float32))


FIGURES: dict[str, Callable[[], None]] = {f.__name__: f for f in (mean_depth, edges, small, far, leaving)}


def main() -> None:
    """Draws what is asked for, else all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[[], *FIGURES], default=[])
    for name in parser.parse_args().names or FIGURES:
        FIGURES[name]()


if __name__ == "__main__":
    main()
