"""Edits of links while an engine lives: its next picture is that of a new engine on the edited stage.

Runs in a Python whose `pxr` has imaging, with PXR_PLUGINPATH_NAME and UMBER_ENGINE_BUFFERS as hydra_record.py.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from engine import EngineRecorder
from leave import leave
from pxr import Sdf, Usd, UsdAppUtils, UsdGeom, UsdLux

PLUGIN = "HdUmberRendererPlugin"


def light(stage: Usd.Stage, name: str) -> UsdLux.LightAPI:
    """A light of the stage."""
    return UsdLux.LightAPI(stage.GetPrimAtPath(f"/World/{name}"))


def include(collection: Usd.CollectionAPI, *names: str) -> None:
    """Makes these all that a collection holds."""
    collection.CreateIncludesRel().SetTargets([Sdf.Path(f"/World/{name}") for name in names])


# by what they change
EDITS: dict[str, Callable[[Usd.Stage], object]] = {
    "light link of meshes": lambda s: include(light(s, "Red").GetLightLinkCollectionAPI(), "Right"),
    "light link of a point instancer": lambda s: include(light(s, "Green").GetLightLinkCollectionAPI(), "Left"),
    "back to the point instancer": lambda s: include(light(s, "Green").GetLightLinkCollectionAPI(), "Points"),
    "shadow link": lambda s: include(light(s, "Lamp").GetShadowLinkCollectionAPI(), "Right"),
    "no light link any more": lambda s: light(s, "Blue").GetLightLinkCollectionAPI().ResetCollection(),
    "light link of native instances": lambda s: include(
        light(s, "Red").GetLightLinkCollectionAPI(), "InstanceA", "Right"
    ),
}


def recorder() -> EngineRecorder:
    """An engine with few samples."""
    made = EngineRecorder(PLUGIN)
    made.settings = {"convergedSamplesPerPixel": 4}
    made.SetImageWidth(48)
    made.SetCameraLightEnabled(False)
    return made


def main(path: str) -> int:
    """Makes the edits in turn; the exit code."""
    stage = Usd.Stage.Open(path)
    camera: UsdGeom.Camera = UsdAppUtils.GetCameraAtPath(stage, "Camera")
    now = Usd.TimeCode.EarliestTime()
    kept = recorder()
    failures = 0
    before = kept.render(stage, camera, now)["color"]
    for name, edit in EDITS.items():
        edit(stage)
        got, want = (engine.render(stage, camera, now)["color"] for engine in (kept, recorder()))
        changed, wrong = (int((np.abs(other - got) > 1e-6).any(axis=2).sum()) for other in (before, want))
        print(f"{name}: {changed} pixels changed, {wrong} differ from a new engine's")
        failures += changed == 0 or wrong > 0
        before = got
    return int(failures > 0)


if __name__ == "__main__":
    leave(main(sys.argv[1]))
