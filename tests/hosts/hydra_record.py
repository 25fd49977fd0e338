"""Renders a stage through Hydra: what usdrecord does, with Umber as the renderer and without a GPU.

The flags are usdrecord's, and more: --imageHeight, --set, --aovs, --stats. Without those the picture is made by
OpenUSD's own UsdAppUtils.FrameRecorder; with any of them by UsdImagingGL.Engine, since FrameRecorder passes no
settings on and gives colour alone.

Runs in the Python of an OpenUSD with imaging, PXR_PLUGINPATH_NAME naming the delegate's plugin folder.
"""

from __future__ import annotations

import argparse
import sys

from engine import EngineRecorder
from leave import leave
from pxr import Sdf, Tf, Usd, UsdAppUtils, UsdGeom, UsdImagingGL, UsdRender, UsdUtils

DONE, COULD_NOT_RENDER, BAD_ARGUMENTS = 0, 1, 2


def main() -> int:
    """Renders what the command line says; the exit code."""
    parser = argument_parser()
    arguments = parser.parse_args()
    stage = open_stage(arguments)
    if not stage:
        return refuse(f"could not open {arguments.usdFilePath}")
    UsdAppUtils.framesArgs.ValidateCmdlineArgs(parser, arguments, stage, frameFormatArgName="outputImagePath")
    plugin = UsdAppUtils.rendererArgs.GetPluginIdFromArgument(arguments.rendererPlugin)
    if not plugin:
        return refuse(f"no renderer {arguments.rendererPlugin} here: does PXR_PLUGINPATH_NAME name its folder?")
    try:
        aovs = parse_aovs(arguments)
        settings = parse_settings(arguments.set, plugin)
    except ValueError as error:
        parser.error(str(error))
    render_settings = find_render_settings(stage, arguments)
    camera = find_camera(stage, arguments.camera, render_settings)
    if arguments.camera and not camera:
        return refuse(f"there is no camera {arguments.camera}")
    try:
        recorder = make_recorder(arguments, plugin, settings, aovs)
        configure(recorder, arguments, render_settings, camera)
        for time in arguments.frames:
            output = arguments.outputImagePath.format(frame=time.GetValue() if isinstance(time, Usd.TimeCode) else time)
            recorder.Record(stage, camera, time, output)
    except (Tf.ErrorException, OSError, ValueError) as error:
        return refuse(str(error))
    if arguments.stats:
        for name, value in sorted(recorder.stats().items()):
            print(f"{name}: {value}")
    return DONE


def refuse(why: str) -> int:
    """Says why there is no picture."""
    print(f"hydra_record: {why}", file=sys.stderr)
    return COULD_NOT_RENDER


def argument_parser() -> argparse.ArgumentParser:
    """The flags: usdrecord's first, then ours."""
    parser = argparse.ArgumentParser(prog="hydra_record", description="Renders a USD stage through Hydra.")
    add = parser.add_argument
    add("usdFilePath")
    add("outputImagePath")
    add("--mask", dest="populationMask", metavar="PRIMPATH[,PRIMPATH...]")
    add("--purposes", default="proxy", metavar="PURPOSE[,PURPOSE...]")
    add("--sessionLayer", dest="sessionLayerPath")
    add("--disableGpu", action="store_true", help="always so here")
    add("--disableDrawMode", action="store_false", dest="drawModeEnabled")
    add("--disableCameraLight", action="store_false", dest="cameraLightEnabled")
    UsdAppUtils.cameraArgs.AddCmdlineArgs(parser)
    UsdAppUtils.framesArgs.AddCmdlineArgs(parser)
    UsdAppUtils.complexityArgs.AddCmdlineArgs(parser)
    UsdAppUtils.colorArgs.AddCmdlineArgs(parser, defaultValue="disabled")
    add("--renderer", "-r", dest="rendererPlugin", default="Umber")
    add("--imageWidth", "-w", type=int, default=960)
    add("--enableDomeLightVisibility", action="store_true", dest="domeLightVisibility")
    add("--renderPassPrimPath", "-rp", dest="rpPrimPath")
    add("--renderSettingsPrimPath", "-rs", dest="rsPrimPath")
    add("--imageHeight", type=int, help="height of the picture; from the camera's aspect ratio where not given")
    add("--set", action="append", default=[], metavar="KEY=VALUE", help="a setting of the renderer")
    add("--aovs", metavar="AOV[,AOV...]", help="AOVs to write as layers of one EXR; colour where not given")
    add("--stats", action="store_true", help="print the renderer's statistics")
    return parser


def open_stage(arguments: argparse.Namespace) -> Usd.Stage | None:
    """The stage, masked and with the session layer that the arguments ask for; none where a layer does not open."""
    try:
        root = Sdf.Layer.FindOrOpen(arguments.usdFilePath)
        path = arguments.sessionLayerPath
        session = Sdf.Layer.FindOrOpen(path) if path else Sdf.Layer.CreateAnonymous()
    except Tf.ErrorException:
        return None
    if not root or not session:
        return None
    if not arguments.populationMask:
        return Usd.Stage.Open(root, session)
    mask = Usd.StagePopulationMask()
    for path in arguments.populationMask.replace(",", " ").split():
        mask.Add(path)
    return Usd.Stage.OpenMasked(root, session, mask)


def find_render_settings(stage: Usd.Stage, arguments: argparse.Namespace) -> str:
    """Path of the RenderSettings prim: named, of the named pass, or the stage's own."""
    if arguments.rpPrimPath and not arguments.rsPrimPath:
        render_pass = UsdRender.Pass(stage.GetPrimAtPath(arguments.rpPrimPath))
        targets = render_pass.GetRenderSourceRel().GetTargets() if render_pass else []
        return str(targets[0]) if targets else ""
    return arguments.rsPrimPath or stage.GetMetadata("renderSettingsPrimPath") or ""


def find_camera(stage: Usd.Stage, named: Sdf.Path | None, render_settings: str) -> UsdGeom.Camera:
    """The camera: named, of the render settings, or the one called as pipelines call it."""
    if named:
        return UsdAppUtils.GetCameraAtPath(stage, named)
    settings = UsdRender.Settings(stage.GetPrimAtPath(render_settings)) if render_settings else None
    targets = settings.GetCameraRel().GetTargets() if settings else []
    if len(targets) == 1:
        return UsdGeom.Camera(stage.GetPrimAtPath(targets[0]))
    return UsdAppUtils.GetCameraAtPath(stage, UsdUtils.GetPrimaryCameraName())


def parse_aovs(arguments: argparse.Namespace) -> list[str]:
    """Names of the AOVs that are asked for, as Hydra has them."""
    names = (arguments.aovs or "color").replace(",", " ").split()
    if names != ["color"] and not arguments.outputImagePath.lower().endswith(".exr"):
        raise ValueError("--aovs: several AOVs, or others than color, can only be written to an .exr file")
    return ["primvars:st" if name == "st" else name for name in names]


def parse_settings(texts: list[str], plugin: str) -> dict[str, object]:
    """Settings by key, each as the type that the renderer's own list gives it."""
    if not texts:
        return {}
    kinds = UsdImagingGL.RendererSettingType
    convert = {kinds.FLAG: parse_flag, kinds.INT: int, kinds.FLOAT: float, kinds.STRING: str}
    parameters = UsdImagingGL.Engine.Parameters()
    parameters.rendererPluginId, parameters.gpuEnabled = plugin, False
    known = {setting.key: setting.type for setting in UsdImagingGL.Engine(parameters).GetRendererSettingsList()}
    settings = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or key not in known:
            raise ValueError(f"--set {text}: KEY=VALUE, where KEY is one of {', '.join(sorted(known))}")
        settings[key] = convert[known[key]](value)
    return settings


def parse_flag(text: str) -> bool:
    """A flag as people write it."""
    values = {"true": True, "1": True, "on": True, "false": False, "0": False, "off": False}
    if text.lower() not in values:
        raise ValueError(f"{text} is neither true nor false")
    return values[text.lower()]


def make_recorder(
    arguments: argparse.Namespace, plugin: str, settings: dict[str, object], aovs: list[str]
) -> UsdAppUtils.FrameRecorder | EngineRecorder:
    """OpenUSD's recorder where it can do what is asked for, else ours."""
    if not (settings or arguments.aovs or arguments.imageHeight or arguments.stats):
        return UsdAppUtils.FrameRecorder(plugin, False, arguments.drawModeEnabled)
    recorder = EngineRecorder(plugin, draw_modes=arguments.drawModeEnabled)
    recorder.settings, recorder.aovs, recorder.image_height = settings, aovs, arguments.imageHeight
    return recorder


def configure(
    recorder: UsdAppUtils.FrameRecorder | EngineRecorder,
    arguments: argparse.Namespace,
    render_settings: str,
    camera: UsdGeom.Camera,
) -> None:
    """Passes on what both recorders know."""
    if arguments.rpPrimPath:
        recorder.SetActiveRenderPassPrimPath(arguments.rpPrimPath)
    if render_settings:
        recorder.SetActiveRenderSettingsPrimPath(render_settings)
    recorder.SetImageWidth(max(arguments.imageWidth, 1))
    recorder.SetComplexity(arguments.complexity.value)
    recorder.SetCameraLightEnabled(arguments.cameraLightEnabled)
    recorder.SetIncludedPurposes(arguments.purposes.replace(",", " ").split())
    recorder.SetDomeLightVisibility(arguments.domeLightVisibility)
    if camera:
        recorder.SetPrimaryCameraPrimPath(camera.GetPath())


if __name__ == "__main__":
    leave(main())
