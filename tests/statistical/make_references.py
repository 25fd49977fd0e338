"""Renders the references of the statistical tests, with Mitsuba 3.

    pip install mitsuba usd-core numpy        # in an environment of their own
    python tests/statistical/make_references.py [rect disk ...] [--samples 8192]

Writes references/NAME.npz: `mean`, radiance as (height, width, 3), float32, row 0 at the top; `block_error` and
`mean_error`, the standard errors of its 8 x 8 blocks and of the whole, from the spread of independent batches;
`samples` a pixel. The stage is read by the converter in ../shared/tools, which refuses what it does not know. Two
things that it refuses are replaced before, by what they are according to UsdLux: a colour temperature by the colour
that `UsdLux.BlackbodyTemperatureAsRgb` gives, a distant light's disk by a sphere of the same solid angle far away.
"""

from __future__ import annotations

import argparse
import importlib.util
import math
import sys
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

HERE = Path(__file__).parent
CONVERTER = HERE.parents[2] / "shared/tools/mitsuba_reference.py"
SIZE = 64
BLOCK = 8
BATCHES = 8
VERTICES = 9  # that a path has beside the camera: eight scattering events
FAR = 1e5  # the sun's distance: parallax over the scenes stays below 1e-4 rad


def replaced(name: str) -> Usd.Stage:
    """The scene, with what the converter does not read replaced."""
    stage = Usd.Stage.Open(Usd.Stage.Open(str(HERE / "scenes" / f"{name}.usda")).Flatten())
    for prim in list(stage.Traverse()):
        if not prim.HasAPI(UsdLux.LightAPI):
            continue
        light = UsdLux.LightAPI(prim)
        if light.GetEnableColorTemperatureAttr().Get():
            warm = UsdLux.BlackbodyTemperatureAsRgb(light.GetColorTemperatureAttr().Get())
            color = light.GetColorAttr().Get()
            light.GetColorAttr().Set(Gf.Vec3f(*(a * b for a, b in zip(color, warm, strict=True))))
            light.GetEnableColorTemperatureAttr().Set(False)
        if prim.GetTypeName() == "DistantLight" and not light.GetNormalizeAttr().Get():
            _as_sphere(prim)
    return stage


def _as_sphere(prim: Usd.Prim) -> None:
    angle = math.radians(UsdLux.DistantLight(prim).GetAngleAttr().Get())
    transform = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    centre = -FAR * transform.TransformDir(Gf.Vec3d(0, 0, -1)).GetNormalized()
    prim.SetTypeName("SphereLight")
    prim.CreateAttribute("inputs:radius", Sdf.ValueTypeNames.Float).Set(FAR * math.sin(angle / 2))
    UsdGeom.Xformable(prim).MakeMatrixXform().Set(Gf.Matrix4d(1).SetTranslate(centre))


def converter() -> ModuleType:
    """The tool, as a module."""
    spec = importlib.util.spec_from_file_location("mitsuba_reference", CONVERTER)
    if spec is None or spec.loader is None or not CONVERTER.exists():
        sys.exit(f"no {CONVERTER}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def batches(tool: ModuleType, stage: Usd.Stage, samples: int) -> NDArray[np.float64]:
    """Independent pictures of a stage, (batch, height, width, 3)."""
    made: list[NDArray[np.float64]] = []

    def render(scene: Any, _: object, arguments: argparse.Namespace) -> None:  # noqa: ANN401
        for batch in range(BATCHES):
            picture = tool.mi.render(scene, spp=samples // BATCHES, seed=arguments.seed + 7919 * batch)
            made.append(np.array(picture, dtype=np.float64)[..., :3])

    # the converter hands the scene that it made to its timer: ours takes pictures
    vars(tool)["timed"] = render
    with tempfile.TemporaryDirectory() as folder:
        file, unused = Path(folder) / "stage.usda", Path(folder) / "unused.npy"
        stage.GetRootLayer().Export(str(file))
        np.save(unused, np.zeros((1, 1, 3)))
        size = ["--size", str(SIZE), str(SIZE), "--depth", str(VERTICES), "--time", "1"]
        sys.argv = ["mitsuba_reference", str(file), str(unused), *size]
        tool.main()
    return np.stack(made)


def main() -> None:
    """One file a scene."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--samples", type=int, default=8192)
    arguments = parser.parse_args()
    names = arguments.names or sorted(f.stem for f in (HERE / "scenes").glob("*.usda") if f.stem != "set")
    tool = converter()
    for name in names:
        pictures = batches(tool, replaced(name), arguments.samples)
        # pixels are independent, so their spreads may be added up: far more of them than there are batches
        spread = pictures.var(axis=0, ddof=1) / BATCHES
        shape = (SIZE // BLOCK, BLOCK, SIZE // BLOCK, BLOCK, 3)
        block_error = np.sqrt(spread.reshape(shape).sum(axis=(1, 3))) / BLOCK**2
        mean_error = np.sqrt(spread.sum(axis=(0, 1))) / SIZE**2
        out = HERE / "references" / f"{name}.npz"
        np.savez_compressed(
            out,
            mean=pictures.mean(axis=0).astype(np.float32),
            block_error=block_error.astype(np.float32),
            mean_error=mean_error.astype(np.float32),
            samples=arguments.samples,
        )
        mean = pictures.mean(axis=(0, 1, 2))
        print(f"{name}: mean {mean}, known to {100 * mean_error.mean() / mean.mean():.3f} %", flush=True)


if __name__ == "__main__":
    main()
