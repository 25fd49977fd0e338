"""A recorder on UsdImagingGL.Engine: UsdAppUtils.FrameRecorder with settings, AOVs, height and statistics.

Reading buffers back needs what Python's Engine leaves out; the library that UMBER_ENGINE_BUFFERS names has it
(cpp_shim/testing/engine_buffers.cpp, built by `cargo xtask render` and `cargo xtask test`).
"""

from __future__ import annotations

import ctypes
import math
import os
import time as clock

import numpy as np
from images import write_image
from pxr import CameraUtil, Gf, Glf, Sdf, Usd, UsdGeom, UsdImagingGL

AMBIENT = Gf.Vec4f(0.01, 0.01, 0.01, 1.0)
COMPONENT_TYPES = {0: np.uint8, 4: np.int8, 8: np.float16, 12: np.float32, 16: np.int16, 20: np.uint16, 24: np.int32}


class EngineRecorder:
    """Renders frames. Named methods as FrameRecorder has them, so that either can stand for the other."""

    def __init__(self, plugin: str, *, draw_modes: bool = True) -> None:
        parameters = UsdImagingGL.Engine.Parameters()
        parameters.rendererPluginId, parameters.gpuEnabled = plugin, False
        parameters.enableUsdDrawModes = draw_modes
        self.engine = UsdImagingGL.Engine(parameters)
        self.engine.SetRendererSetting("enableInteractive", False)
        self.buffers = EngineBuffers(self.engine)
        self.settings: dict[str, object] = {}
        self.aovs = ["color"]
        self.image_width = 960
        self.image_height: int | None = None
        self.camera_light = True
        self.dome_visible = False
        self.purposes = {"default", "proxy"}
        self.parameters = UsdImagingGL.RenderParams()
        self.parameters.clearColor = Gf.Vec4f(0)
        self.parameters.colorCorrectionMode = "disabled"

    def SetActiveRenderPassPrimPath(self, path: str) -> None:
        """Renders the pass at `path`."""
        self.engine.SetActiveRenderPassPrimPath(Sdf.Path(path))

    def SetActiveRenderSettingsPrimPath(self, path: str) -> None:
        """Renders with the settings at `path`."""
        self.engine.SetActiveRenderSettingsPrimPath(Sdf.Path(path))

    def SetImageWidth(self, width: int) -> None:
        """Width of the picture."""
        self.image_width = width

    def SetComplexity(self, complexity: float) -> None:
        """Refinement, as UsdImagingGL counts it."""
        self.parameters.complexity = complexity

    def SetCameraLightEnabled(self, enabled: bool) -> None:
        """Whether a light goes with the camera where the stage has none."""
        self.camera_light = enabled

    def SetIncludedPurposes(self, purposes: list[str]) -> None:
        """Purposes to draw beside the default one."""
        self.purposes = {"default", *purposes}

    def SetDomeLightVisibility(self, visible: bool) -> None:
        """Whether the camera sees dome lights."""
        self.dome_visible = visible

    def SetPrimaryCameraPrimPath(self, path: Sdf.Path) -> None:
        """The camera to render from."""
        self.engine.SetCameraPath(path)

    def Record(self, stage: Usd.Stage, camera: UsdGeom.Camera, time: float, output: str) -> None:
        """Renders `time` and writes the picture and its AOVs."""
        write_image(output, self.render(stage, camera, time))

    def render(self, stage: Usd.Stage, camera: UsdGeom.Camera, time: float) -> dict[str, np.ndarray]:
        """Renders `time`; the pictures by AOV, top row first."""
        self.buffers.ask_for(self.aovs)
        lens = camera.GetCamera(time) if camera else camera_to_frame(stage, time, sorted(self.purposes))
        self.point(camera, lens)
        for key, value in {"domeLightCameraVisibility": self.dome_visible, **self.settings}.items():
            self.engine.SetRendererSetting(key, value)
        self.parameters.frame = time
        self.parameters.showProxy = "proxy" in self.purposes
        self.parameters.showRender = "render" in self.purposes
        self.parameters.showGuides = "guide" in self.purposes
        wait_ms = 1
        while True:
            self.engine.Render(stage.GetPseudoRoot(), self.parameters)
            if self.engine.IsConverged():
                break
            clock.sleep(wait_ms / 1000)
            wait_ms = min(100, wait_ms + 5)
        return {name: self.buffers.read(name) for name in self.aovs}

    def point(self, camera: UsdGeom.Camera, lens: Gf.Camera) -> None:
        """Points the engine's camera and sizes its buffers."""
        # single precision, as FrameRecorder has it: rounding decides about a row
        aspect = np.float32(lens.aspectRatio if abs(lens.aspectRatio) > 1e-4 else 1.0)
        height = self.image_height or max(int(np.float32(self.image_width) / aspect), 1)
        size = Gf.Vec2i(self.image_width, height)
        if self.image_height:
            self.engine.SetOverrideWindowPolicy(CameraUtil.MatchHorizontally)
        if camera:
            self.engine.SetCameraPath(camera.GetPath())
        else:
            self.engine.SetCameraState(lens.frustum.ComputeViewMatrix(), lens.frustum.ComputeProjectionMatrix())
        self.engine.SetFraming(CameraUtil.Framing(Gf.Rect2i(Gf.Vec2i(0), *size)))
        self.engine.SetRenderBufferSize(size)
        lights = []
        if self.camera_light:
            light = Glf.SimpleLight()
            light.position = Gf.Vec4f(*lens.frustum.position, 1.0)
            light.transform = lens.frustum.ComputeViewInverse()
            light.ambient = AMBIENT
            lights.append(light)
        self.engine.SetLightingState(lights, Glf.SimpleMaterial(), AMBIENT)

    def stats(self) -> dict[str, object]:
        """The renderer's statistics."""
        return dict(self.engine.GetRenderStats())


class EngineBuffers:
    """The render buffers of an engine, as arrays."""

    def __init__(self, engine: UsdImagingGL.Engine) -> None:
        path = os.environ.get("UMBER_ENGINE_BUFFERS")
        if not path:
            raise OSError("UMBER_ENGINE_BUFFERS names no library: start this through `cargo xtask render`")
        # PyDLL keeps the interpreter's lock: the library asks Python for the engine.
        self.library = ctypes.PyDLL(path)
        for function in ("umber_set_aovs", "umber_aov_shape", "umber_read_aov"):
            getattr(self.library, function).restype = ctypes.c_bool
        self.engine = ctypes.py_object(engine)

    def ask_for(self, names: list[str]) -> None:
        """Has the engine render the AOVs `names`."""
        array = (ctypes.c_char_p * len(names))(*(name.encode() for name in names))
        if not self.library.umber_set_aovs(self.engine, array, ctypes.c_size_t(len(names))):
            raise ValueError(f"the renderer gives no {', '.join(names)}")

    def read(self, name: str) -> np.ndarray:
        """The AOV `name`: height × width, or × components; top row first."""
        shape = BufferShape()
        if not self.library.umber_aov_shape(self.engine, name.encode(), ctypes.byref(shape)):
            raise ValueError(f"the renderer gives no {name}")
        kind = COMPONENT_TYPES[shape.component]
        pixels = np.empty((shape.height, shape.width, shape.components), kind)
        if not self.library.umber_read_aov(self.engine, name.encode(), pixels.ctypes, ctypes.c_size_t(shape.bytes)):
            raise ValueError(f"the buffer of {name} cannot be read")
        return (pixels if shape.components > 1 else pixels[:, :, 0])[::-1]


class BufferShape(ctypes.Structure):
    """UmberBufferShape of the library."""

    _fields_ = (
        ("width", ctypes.c_uint),
        ("height", ctypes.c_uint),
        ("components", ctypes.c_uint),
        ("component", ctypes.c_int),
        ("bytes", ctypes.c_size_t),
    )


def camera_to_frame(stage: Usd.Stage, time: float, purposes: list[str]) -> Gf.Camera:
    """The camera that FrameRecorder takes where a stage has none: 50 mm, all of the stage in view."""
    lens = Gf.Camera()
    bounds = UsdGeom.BBoxCache(time, purposes, useExtentsHint=True).ComputeWorldBound(stage.GetPseudoRoot())
    centre, size = bounds.ComputeCentroid(), bounds.ComputeAlignedRange().GetSize()
    y_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    up, away = (1, 2) if y_up else (2, 1)
    radius = math.hypot(size[0], size[up]) / 2
    distance = radius / math.tan(math.radians(lens.GetFieldOfView(Gf.Camera.FOVHorizontal) / 2)) + size[away] / 2
    near = lens.clippingRange.min
    distance += near if distance < near else 0.0
    transform = Gf.Matrix4d(1)
    if y_up:
        transform.SetTranslate(centre + Gf.Vec3d(0, 0, distance))
    else:
        transform.SetRotate(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90))
        transform.SetTranslateOnly(centre + Gf.Vec3d(0, -distance, 0))
    lens.transform = transform
    return lens
