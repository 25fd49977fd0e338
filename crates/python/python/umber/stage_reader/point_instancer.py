"""UsdGeomPointInstancer: transforms of its instances, and which instances show which prototype."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from umber.description import Doubles, Ints
from umber.stage_reader.placement import Space
from umber.stage_reader.reading import Reading, ints, matrix


@dataclass
class Placed:
    """A point instancer at one time."""

    transforms: Doubles
    """Shape (n, 4, 4): the space that the instancer stands in, from prototype space."""
    prototypes: list[tuple[Usd.Prim, Ints]]
    """Root prim of each prototype, and the instances that show it."""


def read(reading: Reading, prim: Usd.Prim, space: Space) -> Placed | None:
    """Reads a point instancer; None (and a warning) where it cannot show anything."""
    instancer = UsdGeom.PointInstancer(prim)
    indices, positions = (reading.value(prim, name) for name in ("protoIndices", "positions"))
    if indices is None or positions is None:
        reading.warn(prim, "the point instancer is left out: protoIndices or positions are missing")
        return None
    numbers, count = ints(indices), len(positions)
    if len(numbers) != count:
        reading.warn(prim, f"the point instancer has {len(numbers)} protoIndices for {count} positions")
        count = min(count, len(numbers))
        numbers = numbers[:count]
    precise = reading.value(prim, "orientationsf")
    orientations = precise if precise else reading.value(prim, "orientations")
    scales = reading.value(prim, "scales")
    outer = matrix(space.from_object(reading, prim))
    transforms = _compose(
        outer,
        np.asarray(positions, np.float64)[:count],
        _checked(reading, prim, "orientations", orientations, count),
        _checked(reading, prim, "scales", scales, count),
    )
    return Placed(transforms, _prototypes(reading, instancer, numbers))


def _checked(reading: Reading, prim: Usd.Prim, name: str, values: Any, count: int) -> Doubles | None:  # noqa: ANN401
    if values is None or len(values) == 0:
        return None
    if len(values) < count:
        reading.warn(prim, f"{name} are ignored: {len(values)} of them for {count} instances")
        return None
    return np.asarray(values, np.float64)[:count]


def _prototypes(reading: Reading, instancer: UsdGeom.PointInstancer, numbers: Ints) -> list[tuple[Usd.Prim, Ints]]:
    prim = instancer.GetPrim()
    targets = instancer.GetPrototypesRel().GetForwardedTargets()
    mask = np.asarray(instancer.ComputeMaskAtTime(reading.time), bool)
    shown = mask if len(mask) == len(numbers) else np.ones(len(numbers), bool)
    outside = (numbers < 0) | (numbers >= len(targets))
    if outside.any():
        first = int(np.flatnonzero(outside)[0])
        reading.warn(
            prim,
            f"{int(outside.sum())} instances are left out: no such prototype (first: instance {first}, "
            f"protoIndex {numbers[first]} of {len(targets)})",
        )
    found = []
    for number, target in enumerate(targets):
        prototype = reading.stage.GetPrimAtPath(target)
        if not prototype:
            reading.warn(prim, f"prototype <{target}> does not exist")
            continue
        instances = np.flatnonzero((numbers == number) & shown).astype(np.int32)
        if instances.size:
            found.append((prototype, instances))
    return found


def _compose(outer: Doubles, positions: Doubles, orientations: Doubles | None, scales: Doubles | None) -> Doubles:
    """Transforms from positions (n, 3), orientations (n, 4: i, j, k, real) and scales (n, 3).

    Scale, then rotation, then translation, then `outer`, in the order in which Hydra's delegates
    multiply them, so that the last bit agrees.
    """
    linear, origin = outer[:3, :3], outer[3, :3]
    transforms = np.zeros((len(positions), 4, 4))
    transforms[:, 3, 3] = 1.0
    transforms[:, 3, :3] = _rows(positions, linear) + origin
    rows = np.broadcast_to(linear, (len(positions), 3, 3))
    if orientations is not None:
        rotation = _rotations(orientations)
        rows = np.stack([_rows(rotation[:, i], linear) for i in range(3)], axis=1)
    transforms[:, :3, :3] = rows if scales is None else scales[:, :, None] * rows
    return transforms


def _rows(vectors: Doubles, linear: Doubles) -> Doubles:
    """Row vectors (n, 3) times a matrix (3, 3), summed from left to right."""
    return vectors[:, :1] * linear[0] + vectors[:, 1:2] * linear[1] + vectors[:, 2:] * linear[2]


def _rotations(q: Doubles) -> Doubles:
    """Rotation matrices (n, 3, 3) for row vectors, from quaternions (n, 4: i, j, k, real) as they are."""
    x, y, z, w = q.T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (z * x - y * w)],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (z * z + x * x), 2.0 * (y * z + x * w)],
        [2.0 * (z * x + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (y * y + x * x)],
    ]
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)
