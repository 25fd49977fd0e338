"""What the converter to Mitsuba does not read, added to the scene that it makes."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import drjit.scalar
import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom, UsdShade

# Instances of one prototype, by world from prototype, for column vectors.
Prototypes = dict[str, tuple[Usd.Prim, list[Any]]]
# Names of the types that hold a mesh's points and faces.
BUFFERS = {"Float": "ArrayXf", "UInt32": "ArrayXu"}


def doubled(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """A latlong image that Mitsuba interpolates to what others see.

    It takes the image's left end for its first pixel's centre and the poles for those of its first and last rows, where
    UsdLux has the pixels' edges. At half steps, every second pixel is an old one, and those between are halfway.
    """
    rows = np.concatenate([pixels[:1], pixels, pixels[-1:]])
    halfway = (rows[:-1] + rows[1:]) / 2
    tall = np.empty((2 * len(pixels) + 1, *pixels.shape[1:]), np.float32)
    tall[0::2], tall[1::2] = halfway, pixels
    wide = np.empty((tall.shape[0], 2 * tall.shape[1], tall.shape[2]), np.float32)
    wide[:, 0::2], wide[:, 1::2] = (np.roll(tall, 1, axis=1) + tall) / 2, tall
    return wide


class Extended:
    """Stands for the module `mitsuba` in the converter: what is loaded as a scene gets the instances of the stage."""

    def __init__(self, tool: ModuleType) -> None:
        self._tool, self._mitsuba, self._light_of = tool, tool.mi, tool.light_of
        self._stage: Usd.Stage | None = None

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        if name in BUFFERS and self._mitsuba.variant().startswith("scalar"):
            # what the converter makes of arrays is a number in these variants
            return getattr(drjit.scalar, BUFFERS[name])
        return getattr(self._mitsuba, name)

    def light_of(self, prim: Usd.Prim, xform: Any, schema: Any) -> dict[str, Any]:  # noqa: ANN401
        """A light, as the converter has it, and one with a latlong texture.

        Mitsuba's, like UsdLux's, has its middle at +Z, +Y up and +X to the left.
        """
        self._stage = prim.GetStage()
        get = {a.GetName().removeprefix("inputs:"): a.Get() for a in prim.GetAttributes()}.get
        texture = get("texture:file")
        if prim.GetTypeName() != "DomeLight" or not texture:
            return dict(self._light_of(prim, xform, schema))
        if get("texture:format") != "latlong" or tuple(get("color")) != (1, 1, 1) or get("enableColorTemperature"):
            self._tool.fail(prim, "this dome")
        kinds = self._mitsuba.Bitmap.PixelFormat.RGB, self._mitsuba.Struct.Type.Float32
        pixels = np.array(self._mitsuba.Bitmap(texture.resolvedPath).convert(*kinds, srgb_gamma=False))
        scale = float(get("intensity")) * 2.0 ** float(get("exposure"))
        bitmap = self._mitsuba.Bitmap(doubled(pixels))
        return {"type": "envmap", "bitmap": bitmap, "scale": scale, "to_world": self._tool.matrix(xform)}

    def load_dict(self, what: dict[str, Any]) -> Any:  # noqa: ANN401
        """Mitsuba's own; a scene gets the instances, and loses the prototypes that the converter put in as they lie."""
        if what.get("type") != "scene":
            return self._mitsuba.load_dict(what)
        if self._stage is not None:
            for number, (prototype, places) in enumerate(_instances(self._stage).values()):
                path = str(prototype.GetPath())
                for key in [k for k, v in what.items() if self._is(v, path)]:
                    del what[key]
                # the group has the prototype's own space
                bsdf = self._tool.bsdf_of(prototype, UsdShade)
                group = self._tool.shape_of(prototype, np.eye(4), bsdf, UsdGeom)
                what[f"group{number}"] = {"type": "shapegroup", "mesh": group}
                for at, place in enumerate(places):
                    to_world = self._mitsuba.ScalarTransform4f(place)
                    reference = {"type": "ref", "id": f"group{number}"}
                    what[f"group{number}_{at}"] = {"type": "instance", "to_world": to_world, "group": reference}
        return self._mitsuba.load_dict(what)

    def _is(self, made: Any, path: str) -> bool:  # noqa: ANN401
        return isinstance(made, self._mitsuba.Mesh) and made.id() == path


def _instances(stage: Usd.Stage) -> Prototypes:
    """Instances of every PointInstancer whose prototypes are meshes."""
    found: Prototypes = {}
    time = Usd.TimeCode.EarliestTime()
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.PointInstancer):
            continue
        instancer = UsdGeom.PointInstancer(prim)
        prototypes = [stage.GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetTargets()]
        own = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(time))
        places = np.array(instancer.ComputeInstanceTransformsAtTime(time, time)) @ own
        for which, prototype in enumerate(prototypes):
            chosen = np.array(instancer.GetProtoIndicesAttr().Get(time)) == which
            found[str(prototype.GetPath())] = (prototype, [place.T for place in places[chosen]])
    return found
