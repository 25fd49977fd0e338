"""UsdGeomCamera, with the numbers that Hydra makes of it."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from umber.description import Camera
from umber.stage_reader.reading import matrix, single


def find_camera(stage: Usd.Stage, path: Sdf.Path) -> UsdGeom.Camera | None:
    """The camera at a path or, where that is one name alone, the first camera of that name."""
    if path.isEmpty or not path.IsPrimPath():
        return None
    if not path.IsAbsolutePath():
        if path.pathElementCount == 1:
            for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()):
                if prim.GetName() == path.name and prim.IsA(UsdGeom.Camera):
                    return UsdGeom.Camera(prim)
        path = path.MakeAbsolutePath(Sdf.Path.absoluteRootPath)
    camera = UsdGeom.Camera.Get(stage, path)
    return camera if camera else None


def read_camera(camera: UsdGeom.Camera, time: Usd.TimeCode) -> Camera:
    """A camera of the stage. Its aperture follows the picture's height, as in usdrecord."""
    gf_camera = camera.GetCamera(time)
    transform = UsdGeom.XformCache(time).GetLocalToWorldTransform(camera.GetPrim())
    return describe(camera.GetPath().pathString, gf_camera, transform, "matchVertically")


def describe(path: str, camera: Gf.Camera, transform: Gf.Matrix4d, conform_policy: str) -> Camera:
    """A camera with lengths in scene units and single precision, as HdCamera keeps them."""
    aperture, focal = np.float32(Gf.Camera.APERTURE_UNIT), np.float32(Gf.Camera.FOCAL_LENGTH_UNIT)

    def scaled(value: float, unit: np.float32) -> float:
        return float(np.float32(value) * unit)

    return Camera(
        path=path,
        transform=matrix(transform),
        aperture=(scaled(camera.horizontalAperture, aperture), scaled(camera.verticalAperture, aperture)),
        aperture_offset=(
            scaled(camera.horizontalApertureOffset, aperture),
            scaled(camera.verticalApertureOffset, aperture),
        ),
        focal_length=scaled(camera.focalLength, focal),
        orthographic=camera.projection == Gf.Camera.Orthographic,
        clipping_range=(single(camera.clippingRange.min), single(camera.clippingRange.max)),
        conform_policy=conform_policy,
    )
