"""Mitsuba's side: see `side.py`.

The scene is what the converter beside the project makes of the stage, and two things
that it does not read: latlong textures of domes, and PointInstancers, as Mitsuba's own instances of shape groups.
"""

from __future__ import annotations

import glob
import importlib.util
import os
import re
import sys
import tempfile
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from extended import Extended
from numpy.typing import NDArray
from pxr import Usd, UsdGeom
from side import BOUNCES, serve

CONVERTER = Path(__file__).parents[4] / "shared/tools/mitsuba_reference.py"
VARIANT = "llvm_ad_rgb"
# Where there are many instances: Dr.Jit compiles something for each of them, and takes minutes.
VARIANT_OF_INSTANCES = "scalar_rgb"
# What Dr.Jit needs of LLVM to know today's processors.
LEAST_LLVM = 15


def find_llvm() -> None:
    """Names the newest LLVM library to Dr.Jit, unless the user has named one."""
    if os.environ.get("DRJIT_LIBLLVM_PATH"):
        return
    found = [(int(re.findall(r"LLVM[^/]*?(\d+)", f)[0]), f) for f in glob.glob("/usr/lib/*-linux-gnu/libLLVM*[0-9]*")]
    version, file = max(found, default=(0, ""))
    if version >= LEAST_LLVM:
        os.environ["DRJIT_LIBLLVM_PATH"] = file


def converter() -> ModuleType:
    """The tool, as a module."""
    spec = importlib.util.spec_from_file_location("mitsuba_reference", CONVERTER)
    if spec is None or spec.loader is None or not CONVERTER.exists():
        sys.exit(f"no {CONVERTER}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def variant_of(file: str) -> str:
    """The one that is fast for the stage."""
    stage = Usd.Stage.Open(file)
    instanced = any(prim.IsA(UsdGeom.PointInstancer) for prim in stage.Traverse())
    return VARIANT_OF_INSTANCES if instanced else VARIANT


def main() -> None:
    """Serves."""
    find_llvm()
    tool = converter()
    file, width, height = sys.argv[1:]
    variant = variant_of(file)

    def timed(scene: Any, _: object, __: object) -> None:  # noqa: ANN401
        def take(request: dict[str, Any]) -> tuple[NDArray[Any], dict[str, float]]:
            started = time.perf_counter()
            picture = np.array(tool.mi.render(scene, spp=request["samples"], seed=request["seed"]))
            return picture[..., :3], {"seconds": time.perf_counter() - started, "samples": request["samples"]}

        serve(f"Mitsuba {tool.mi.__version__} {variant}", take)

    # what it asks of Mitsuba goes through ours, which adds what it does not read
    extended = Extended(tool)
    vars(tool)["mi"], vars(tool)["light_of"] = extended, extended.light_of
    # the converter hands the scene that it made to its timer
    vars(tool)["timed"] = timed
    with tempfile.TemporaryDirectory() as folder:
        unused = str(Path(folder) / "unused.npy")
        np.save(unused, np.zeros((1, 1, 3)))
        words = ["--size", width, height, "--depth", str(BOUNCES + 1), "--variant", variant, "--time", "1"]
        sys.argv = ["mitsuba_reference", file, unused, *words]
        tool.main()


if __name__ == "__main__":
    main()
