"""The camera that usdrecord makes where a stage has none: it frames the whole stage."""

from __future__ import annotations

import math

import numpy as np
from pxr import Gf, Usd, UsdGeom

from umber.description import Camera
from umber.stage_reader.camera import describe

PATH = "/_UsdImaging_HdUmber/camera"


def frame_stage(stage: Usd.Stage, time: Usd.TimeCode, purposes: list[str]) -> Gf.Camera:
    """A 50 mm camera before the stage's bounds, along the stage's up axis."""
    camera = Gf.Camera()
    bounds = UsdGeom.BBoxCache(time, [UsdGeom.Tokens.default_, *purposes], useExtentsHint=True)
    box = bounds.ComputeWorldBound(stage.GetPseudoRoot())
    extent = box.ComputeAlignedRange()
    empty = extent.IsEmpty()
    center = Gf.Vec3d(0) if empty else box.ComputeCentroid()
    size = Gf.Vec3d(0) if empty else extent.GetSize()
    y_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    across, depth = (size[1], size[2]) if y_up else (size[2], size[1])

    # single precision where usdrecord has it
    radius = np.float32(math.sqrt((size[0] / 2) ** 2 + (across / 2) ** 2))
    half_view = np.float32(camera.GetFieldOfView(Gf.Camera.FOVHorizontal) / 2.0)
    distance = np.float32(float(radius) / math.tan(math.radians(float(half_view))))
    distance = np.float32(float(distance) + depth / 2)
    near = np.float32(camera.clippingRange.min)
    if distance < near:
        distance = np.float32(distance + near)

    transform = Gf.Matrix4d(1)
    if y_up:
        transform.SetTranslate(center + Gf.Vec3d(0, 0, float(distance)))
    else:
        transform.SetRotate(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90))
        transform.SetTranslateOnly(center + Gf.Vec3d(0, -float(distance), 0))
    camera.transform = transform
    return camera


def image_height(width: int, camera: Gf.Camera) -> int:
    """Rows of a picture of `width` columns with the camera's aspect ratio."""
    aspect = np.float32(camera.aspectRatio)
    if not math.isfinite(aspect) or abs(float(aspect)) < 1e-4:
        aspect = np.float32(1.0)
    return max(int(np.float32(width) / aspect), 1)


def describe_free(camera: Gf.Camera) -> Camera:
    """The framing camera for a session.

    It goes by way of view and projection matrices first, because Hydra engines take it so.
    """
    frustum, taken = camera.frustum, Gf.Camera()
    taken.SetFromViewAndProjectionMatrix(frustum.ComputeViewMatrix(), frustum.ComputeProjectionMatrix())
    return describe(PATH, taken, taken.transform, "fit")
