"""Spheres, cubes, cylinders, cones, capsules and planes as the meshes that Hydra makes of them.

Topology, segment counts and single-precision arithmetic are those of OpenUSD's implicit surface
scene index, so that both front ends render the same triangles.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from pxr import Usd, UsdGeom

from umber.description import Floats, Ints
from umber.stage_reader.reading import Reading

RADIAL = 10
AXIAL = 10
CAP_AXIAL = 4

F = np.float32
Shape = tuple[Floats, Ints, Ints, str]
"""Points, corners a face, corners, subdivision scheme."""


def _cos(angle: np.float32) -> np.float32:
    return np.float32(math.cos(float(angle)))


def _sin(angle: np.float32) -> np.float32:
    return np.float32(math.sin(float(angle)))


@cache
def _circle() -> Floats:
    """Points on the unit circle, shape (RADIAL, 2)."""
    sweep = F(math.radians(360))
    angles = [F(i) / F(RADIAL) * sweep for i in range(RADIAL)]
    return np.array([(_cos(a), _sin(a)) for a in angles], F)


def _ring(radius: np.float32, z: np.float32) -> Floats:
    """A ring around Z, shape (RADIAL, 3)."""
    return np.column_stack([radius * _circle(), np.full(RADIAL, z, F)])


def _pole(z: np.float32) -> Floats:
    return np.array([(0, 0, z)], F)


@cache
def _strips(count: int, split_bottom: bool, top: bool, split_top: bool) -> tuple[Ints, Ints]:
    """Corner counts and corners of a bottom fan, strips of quads, and (where wanted) a top fan.

    A fan that is split from the strips has a ring of its own: the edge is sharp.
    """
    now = np.arange(RADIAL)
    after = (now + 1) % RADIAL
    first = 1
    faces = [np.column_stack([first + after, first + now, np.zeros(RADIAL, int)]).ravel()]
    first += RADIAL if split_bottom else 0
    for _ in range(count):
        quads = [first + now, first + after, first + after + RADIAL, first + now + RADIAL]
        faces.append(np.column_stack(quads).ravel())
        first += RADIAL
    if top:
        first += RADIAL if split_top else 0
        faces.append(np.column_stack([first + now, first + after, np.full(RADIAL, first + RADIAL)]).ravel())
    counts = [3] * RADIAL + [4] * RADIAL * count + [3] * RADIAL * top
    return np.array(counts, np.int32), np.concatenate(faces).astype(np.int32)


def _along(axis: str, points: Floats) -> Floats:
    """Turns the Z axis to the given one."""
    order = {"X": (2, 0, 1), "Y": (1, 2, 0)}.get(axis, (0, 1, 2))
    return np.ascontiguousarray(points[:, order])


def sphere(radius: float) -> Shape:
    """A sphere around the origin."""
    r = F(radius)
    rings = []
    for i in range(1, AXIAL):
        latitude = F((float(F(i) / F(AXIAL)) - 0.5) * math.pi)
        rings.append(_ring(r * _cos(latitude), r * _sin(latitude)))
    return np.concatenate([_pole(-r), *rings, _pole(r)]), *_strips(AXIAL - 2, False, True, False), "catmullClark"


def _box(x: float, y: float, z: float, signs: list[tuple[int, int, int]]) -> Floats:
    half = np.array([F(0.5 * float(F(length))) for length in (x, y, z)], F)
    return np.array(signs, F) * half


def cube(size: float) -> Shape:
    """A cube around the origin."""
    upper = [(1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, -1, 1)]
    lower = [(-1, -1, -1), (-1, 1, -1), (1, 1, -1), (1, -1, -1)]
    corners = [0, 1, 2, 3, 4, 5, 6, 7, 0, 6, 5, 1, 4, 7, 3, 2, 0, 3, 7, 6, 4, 2, 1, 5]
    counts = np.full(6, 4, np.int32)
    return _box(size, size, size, upper + lower), counts, np.array(corners, np.int32), "bilinear"


def plane(width: float, length: float, axis: str) -> Shape:
    """A rectangle around the origin, across the axis."""
    points = _box(width, length, 0.0, [(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)])
    return _along(axis, points), np.array([4], np.int32), np.arange(4, dtype=np.int32), "bilinear"


def cylinder(bottom: float, top: float, height: float, axis: str) -> Shape:
    """A closed cylinder around the origin, of two radii."""
    z = F(0.5 * float(F(height)))
    lower, upper = _ring(F(bottom), -z), _ring(F(top), z)
    points = np.concatenate([_pole(-z), lower, lower, upper, upper, _pole(z)])
    return _along(axis, points), *_strips(1, True, True, True), "catmullClark"


def cone(radius: float, height: float, axis: str) -> Shape:
    """A closed cone around the origin; its tip is a ring of coincident points."""
    z = F(0.5 * float(F(height)))
    base, tip = _ring(F(radius), -z), np.repeat(_pole(z), RADIAL, axis=0)
    points = np.concatenate([_pole(-z), base, base, tip])
    return _along(axis, points), *_strips(1, True, False, False), "catmullClark"


def _lerp(alpha: float, a: np.float32, b: np.float32) -> np.float32:
    return np.float32((1.0 - alpha) * float(a) + alpha * float(b))


def capsule(bottom: float, top: float, height: float, axis: str) -> Shape:
    """A cylinder of two radii between spherical caps that are tangent to it."""
    r0, r1, h = F(bottom), F(top), F(height)
    z0 = z1 = tangent = F(0)
    if r0 != r1 and h != 0:
        slope = (r0 - r1) / h
        z0, z1 = -(slope * r0), -(slope * r1)
        r0, r1 = np.sqrt(r0 * r0 + z0 * z0), np.sqrt(r1 * r1 + z1 * z1)
        tangent = F(math.atan(float(slope)))
    z0 = F(float(z0) - 0.5 * float(h))
    z1 = F(float(z1) + 0.5 * float(h))
    share = round(2 * CAP_AXIAL * (0.5 * math.pi + float(tangent)) / math.pi)
    rings0 = min(max(share, 1), 2 * CAP_AXIAL - 1)
    rings1 = 2 * CAP_AXIAL - rings0
    quarter = F(0.5 * math.pi)
    points = [_pole(z0 - r0)]
    for i in range(1, rings0 + 1):
        angle = _lerp(i / rings0, -quarter, tangent)
        points.append(_ring(r0 * _cos(angle), z0 + r0 * _sin(angle)))
    for i in range(rings1):
        angle = _lerp(i / rings1, tangent, quarter)
        points.append(_ring(r1 * _cos(angle), z1 + r1 * _sin(angle)))
    points.append(_pole(z1 + r1))
    strips = _strips(2 * (CAP_AXIAL - 1) + 1, False, True, False)
    return _along(axis, np.concatenate(points)), *strips, "catmullClark"


# Maker, and the attributes it takes, by schema type.
SHAPES: dict[str, tuple[Callable[..., Shape], tuple[str, ...]]] = {
    "Sphere": (sphere, ("radius",)),
    "Cube": (cube, ("size",)),
    "Plane": (plane, ("width", "length", "axis")),
    "Cone": (cone, ("radius", "height", "axis")),
    "Cylinder": (cylinder, ("radius", "radius", "height", "axis")),
    "Cylinder_1": (cylinder, ("radiusBottom", "radiusTop", "height", "axis")),
    "Capsule": (capsule, ("radius", "radius", "height", "axis")),
    "Capsule_1": (capsule, ("radiusBottom", "radiusTop", "height", "axis")),
}


def shape(reading: Reading, prim: Usd.Prim) -> Shape | None:
    """The mesh that an implicit shape becomes; None for any other prim."""
    if prim.GetTypeName() == UsdGeom.Tokens.Mesh:
        return None
    known = SHAPES.get(prim.GetTypeName())
    if known is None:
        return None
    maker, attributes = known
    return maker(*(reading.value(prim, name) for name in attributes))
