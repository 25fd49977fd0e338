"""The two methods with which textbooks begin, in plain Python: what Umber's speed is measured against.

A picture of triangles seen from an eye on the z axis through a square of the plane z = 0; samples start on its corner
at the top left. Nothing is hurried: one sample after the other, one triangle after the other, vectors as objects.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pxr import Gf

Triangle = tuple[Gf.Vec3d, Gf.Vec3d, Gf.Vec3d]
Map = list[list[int]]
Picture = list[list[float]]

EYE = Gf.Vec3d(0, 0, 1)
HALF = 0.2
LIGHT = Gf.Vec3d(1, 1, 1).GetNormalized()
AWAY = 50 / 255
EPSILON = 1e-6
NOTHING = -1


def sample(size: int, row: int, column: int) -> Gf.Vec3d:
    """Where a sample is on the screen."""
    step = 2 * HALF / size
    return Gf.Vec3d(column * step - HALF, HALF - row * step, 0)


def project(point: Gf.Vec3d) -> tuple[float, float]:
    """Where a point is seen on the screen."""
    scale = EYE[2] / (EYE[2] - point[2])
    return point[0] * scale, point[1] * scale


def is_inside(corners: Sequence[tuple[float, float]], x: float, y: float) -> bool:
    """The odd-even rule: a line to the right crosses the outline an odd number of times."""
    inside = False
    before = corners[-1]
    for corner in corners:
        if (corner[1] > y) != (before[1] > y):
            slope = (before[0] - corner[0]) / (before[1] - corner[1])
            if x < slope * (y - corner[1]) + corner[0]:
                inside = not inside
        before = corner
    return inside


def rasterize(triangles: Sequence[Triangle], size: int) -> Map:
    """The polygon at each sample, painted from back to front by mean depth."""
    faces: Map = [[NOTHING] * size for _ in range(size)]
    depths = [sum((p - EYE).GetLength() for p in triangle) / 3 for triangle in triangles]
    for index in sorted(range(len(triangles)), key=lambda i: -depths[i]):
        corners = [project(point) for point in triangles[index]]
        for row in range(size):
            for column in range(size):
                at = sample(size, row, column)
                if is_inside(corners, at[0], at[1]):
                    faces[row][column] = index
    return faces


def intersect(origin: Gf.Vec3d, direction: Gf.Vec3d, triangle: Triangle) -> float | None:
    """Distance along a ray to a triangle (Moeller and Trumbore 1997)."""
    a, b, c = triangle
    to_b, to_c = b - a, c - a
    h = Gf.Cross(direction, to_c)
    determinant = Gf.Dot(to_b, h)
    if abs(determinant) < EPSILON:
        return None
    s = origin - a
    u = Gf.Dot(s, h) / determinant
    if u < 0 or u > 1:
        return None
    q = Gf.Cross(s, to_b)
    v = Gf.Dot(direction, q) / determinant
    if v < 0 or u + v > 1:
        return None
    t = Gf.Dot(to_c, q) / determinant
    return t if t > EPSILON else None


def trace(triangles: Sequence[Triangle], size: int) -> tuple[Map, Picture]:
    """The face that each ray meets first, and the picture: light times reflected ray."""
    faces: Map = [[NOTHING] * size for _ in range(size)]
    picture: Picture = [[0.0] * size for _ in range(size)]
    for row in range(size):
        for column in range(size):
            direction = (sample(size, row, column) - EYE).GetNormalized()
            nearest = math.inf
            for index, triangle in enumerate(triangles):
                t = intersect(EYE, direction, triangle)
                if t is not None and t < nearest:
                    nearest, faces[row][column] = t, index
            if nearest < math.inf:
                a, b, c = triangles[faces[row][column]]
                normal = Gf.Cross(b - a, c - a).GetNormalized()
                reflected = direction - normal * (2 * Gf.Dot(direction, normal))
                factor = Gf.Dot(LIGHT, reflected)
                picture[row][column] = factor if factor > 0 else AWAY
    return faces, picture
