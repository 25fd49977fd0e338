"""What every renderer's side of the measure has in common: it loads a scene, then takes pictures on request.

A side is a process of its own, called with STAGE WIDTH HEIGHT. It prints `READY {about}` once the scene is loaded. Each
line of its input is a request, {"samples": 64, "seed": 3, "out": "picture.npy"} and settings of its own; it renders,
writes the picture (radiance, float32, (height, width, 3), row 0 at the top) and prints `DONE {"seconds": 1.2}`: the
wall time of rendering alone. Other lines on its output mean nothing.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

BOUNCES = 8

# A request becomes a picture, and figures of it: "seconds" at least.
Take = Callable[[dict[str, Any]], tuple[Any, dict[str, float]]]


def serve(about: str, take: Take) -> None:
    """Answers requests until the input ends."""
    print("READY " + json.dumps(about), flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        picture, figures = take(request)
        np.save(request["out"], np.asarray(picture, dtype=np.float32))
        print("DONE " + json.dumps(figures), flush=True)
