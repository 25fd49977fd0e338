"""Hydra's life cycle under load: edits while rendering, removal, destruction, two delegates in one process.

Each round keeps two engines alive on one stage, edits it 200 times while both render, removes every prim and
destroys the engines. Fails where an engine does not converge afterwards, where it shows more or fewer meshes than
the stage has, or where memory grows with the number of edits.

Runs in a Python whose `pxr` has imaging; UMBER_PLUGIN_PATH names the delegate's plugin folder.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import time
from pathlib import Path

from leave import leave
from pxr import CameraUtil, Gf, Glf, Plug, Sdf, Usd, UsdGeom, UsdImagingGL, UsdLux, UsdShade, Vt

PLUGIN = "HdUmberRendererPlugin"
SIZE = Gf.Vec2i(96, 64)
EDITS = 200
ROUNDS = 2
GRID = 4
POINTS_ACROSS = 40
AMBIENT = Gf.Vec4f(0)


class Viewport:
    """An engine as a viewport drives it."""

    def __init__(self, camera: Sdf.Path) -> None:
        parameters = UsdImagingGL.Engine.Parameters()
        parameters.rendererPluginId, parameters.gpuEnabled = PLUGIN, False
        self.engine = UsdImagingGL.Engine(parameters)
        self.engine.SetRendererSetting("convergedSamplesPerPixel", 16)
        self.engine.SetCameraPath(camera)
        self.engine.SetRenderBufferSize(SIZE)
        self.engine.SetFraming(CameraUtil.Framing(Gf.Rect2i(Gf.Vec2i(0), *SIZE)))
        self.engine.SetLightingState([], Glf.SimpleMaterial(), AMBIENT)
        self.parameters = UsdImagingGL.RenderParams()
        self.parameters.colorCorrectionMode = "disabled"

    def draw(self, stage: Usd.Stage) -> None:
        """One redraw: syncs what changed and lets rendering go on."""
        self.engine.Render(stage.GetPseudoRoot(), self.parameters)

    def converges(self, stage: Usd.Stage, seconds: float = 60.0) -> bool:
        """Redraws until the picture is finished, or the time is over."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            self.draw(stage)
            if self.engine.IsConverged():
                return True
            time.sleep(0.005)
        return False

    def stat(self, name: str) -> float:
        """A figure of the renderer's."""
        return self.engine.GetRenderStats()[name]


def main() -> int:
    """Runs the rounds; the exit code."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--allowed-growth", type=float, default=8.0, help="MiB over the second half of the edits")
    allowed = arguments.parse_args().allowed_growth
    Plug.Registry().RegisterPlugins([os.environ["UMBER_PLUGIN_PATH"]])
    failures: list[str] = []
    for number in range(1, ROUNDS + 1):
        failures += [f"round {number}: {what}" for what in run_round(number, allowed)]
        gc.collect()
        print(f"round {number}: engines destroyed, {resident_mib():.1f} MiB resident")
    for failure in failures:
        print(f"lifecycle: {failure}", file=sys.stderr)
    return 1 if failures else 0


def run_round(number: int, allowed_growth: float) -> list[str]:
    """Two engines through one life; what went wrong."""
    failures = []
    stage = make_stage()
    camera = Sdf.Path("/World/Camera")
    viewports = [Viewport(camera), Viewport(camera)]
    resident = []
    for step in range(EDITS):
        edit(stage, step)
        for viewport in viewports:
            viewport.draw(stage)
        resident.append(resident_mib())
    growth = resident[-1] - resident[EDITS // 2]
    print(
        f"round {number}: {resident[0]:.1f} MiB, {resident[EDITS // 2]:.1f} after {EDITS // 2} edits, "
        f"{resident[-1]:.1f} after {EDITS}"
    )
    if growth > allowed_growth:
        failures.append(f"{growth:.1f} MiB more after the second {EDITS // 2} edits")
    for viewport in viewports:
        if not viewport.converges(stage):
            failures.append("no convergence after the edits")
        if viewport.stat("meshes") != GRID * GRID:
            failures.append(f"{viewport.stat('meshes')} meshes of {GRID * GRID} are shown")
    stage.RemovePrim("/World/Meshes")
    stage.RemovePrim("/World/Key")
    for viewport in viewports:
        if not viewport.converges(stage):
            failures.append("no convergence without prims")
        if viewport.stat("meshes") != 0:
            failures.append("removed meshes are still shown")
    return failures


def make_stage() -> Usd.Stage:
    """A grid of wavy meshes with a light, a material and a camera."""
    stage = Usd.Stage.CreateInMemory()
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    camera = UsdGeom.Camera.Define(stage, "/World/Camera")
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 12))
    light = UsdLux.RectLight.Define(stage, "/World/Key")
    light.AddTranslateOp().Set(Gf.Vec3d(0, 0, 8))
    light.CreateIntensityAttr(8)
    shader = UsdShade.Shader.Define(stage, "/World/Material/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.5))
    material = UsdShade.Material.Define(stage, "/World/Material")
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    for index in range(GRID * GRID):
        mesh = UsdGeom.Mesh.Define(stage, f"/World/Meshes/Mesh{index}")
        fill(mesh)
        mesh.AddTranslateOp().Set(Gf.Vec3d(index % GRID - 1.5, index // GRID - 1.5, 0) * 1.4)
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    return stage


def fill(mesh: UsdGeom.Mesh) -> None:
    """Points and faces of a square of quads."""
    n = POINTS_ACROSS
    corners = [n * row + column for row in range(n - 1) for column in range(n - 1)]
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray([4] * len(corners)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray([i for c in corners for i in (c, c + 1, c + n + 1, c + n)]))
    mesh.CreatePointsAttr(points(0.0))
    mesh.CreateSubdivisionSchemeAttr("none")


def points(bend: float) -> Vt.Vec3fArray:
    """A bent square around the origin."""
    axis = [i / (POINTS_ACROSS - 1) - 0.5 for i in range(POINTS_ACROSS)]
    return Vt.Vec3fArray([Gf.Vec3f(x, y, bend * (x * x + y * y)) for y in axis for x in axis])


def edit(stage: Usd.Stage, step: int) -> None:
    """One of the edits of an artist's session, in turn."""
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(f"/World/Meshes/Mesh{step % (GRID * GRID)}"))
    wave = (step % 17) / 17
    kind = step % 6
    if kind == 0:
        x, y, _ = mesh.GetOrderedXformOps()[0].Get()
        mesh.GetOrderedXformOps()[0].Set(Gf.Vec3d(x, y, wave))
    elif kind == 1:
        shader = UsdShade.Shader(stage.GetPrimAtPath("/World/Material/Surface"))
        shader.GetInput("diffuseColor").Set(Gf.Vec3f(wave, 0.5, 1 - wave))
    elif kind == 2:
        mesh.MakeInvisible()
    elif kind == 3:
        for shown in stage.GetPrimAtPath("/World/Meshes").GetChildren():
            UsdGeom.Imageable(shown).MakeVisible()
    elif kind == 4:
        camera = UsdGeom.Camera(stage.GetPrimAtPath("/World/Camera"))
        camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(wave, -wave, 12))
    else:
        mesh.GetPointsAttr().Set(points(wave))


def resident_mib() -> float:
    """Memory that the process has in use."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


if __name__ == "__main__":
    leave(main())
