"""The light that usdrecord puts at the camera."""

from __future__ import annotations

import numpy as np
from pxr import Gf

from umber.description import Light
from umber.stage_reader.reading import matrix

PATH = "/_UsdImaging_HdUmber/light0"


def camera_light(camera: Gf.Camera) -> Light:
    """A distant light along the view, without shadow, as Hydra's task controller makes it."""
    return Light(
        path=PATH,
        kind="distant",
        transform=matrix(camera.frustum.ComputeViewInverse()),
        angle_deg=float(np.float32(0.53)),
        intensity=15000.0,
        shadow_enable=False,
    )
