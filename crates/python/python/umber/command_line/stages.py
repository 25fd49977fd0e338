"""Opens the stage that the arguments name, and finds the camera and settings in it."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from pxr import Sdf, Tf, Usd, UsdGeom, UsdRender, UsdUtils

from umber.stage_reader import find_camera


class CannotRenderError(Exception):
    """Why nothing can be rendered, in words for the user."""


def _layer(path: str) -> Sdf.Layer:
    try:
        layer = Sdf.Layer.FindOrOpen(path)
    except Tf.ErrorException as error:
        raise CannotRenderError(f"Could not open layer: {path}\n{_reasons(error)}") from error
    if not layer:
        raise CannotRenderError(f"Could not open layer: {path}")
    return layer


def _reasons(error: Tf.ErrorException) -> str:
    return "\n".join(str(getattr(reason, "commentary", reason)) for reason in error.args)


def open_stage(arguments: argparse.Namespace) -> Usd.Stage:
    """The stage with its session layer, masked where that was asked for."""
    root = _layer(arguments.usdFilePath)
    session = _layer(arguments.sessionLayerPath) if arguments.sessionLayerPath else Sdf.Layer.CreateAnonymous()
    try:
        if arguments.populationMask:
            mask = Usd.StagePopulationMask()
            for path in arguments.populationMask.replace(",", " ").split():
                mask.Add(path)
            stage = Usd.Stage.OpenMasked(root, session, mask)
        else:
            stage = Usd.Stage.Open(root, session)
    except Tf.ErrorException as error:
        raise CannotRenderError(f"Could not open USD stage: {arguments.usdFilePath}\n{_reasons(error)}") from error
    if not stage:
        raise CannotRenderError(f"Could not open USD stage: {arguments.usdFilePath}")
    return stage


def render_settings_path(stage: Usd.Stage, arguments: argparse.Namespace, say: Callable[[str], None]) -> str | None:
    """Path of the RenderSettings prim: named, through a render pass, or by the stage's metadata."""
    if arguments.rsPrimPath and arguments.rpPrimPath:
        raise CannotRenderError("Cannot specify both --renderSettingsPrimPath and --renderPassPrimPath")
    if arguments.rpPrimPath:
        render_pass = UsdRender.Pass(stage.GetPrimAtPath(arguments.rpPrimPath))
        if not render_pass:
            raise CannotRenderError(f"Unknown render pass <{arguments.rpPrimPath}>")
        targets = render_pass.GetRenderSourceRel().GetTargets()
        if not targets:
            raise CannotRenderError(f"Render source not authored on {arguments.rpPrimPath}")
        if len(targets) > 1:
            say(f"Render pass <{arguments.rpPrimPath}> has multiple targets; using <{targets[0]}>")
        return str(targets[0])
    path: str | None = arguments.rsPrimPath or stage.GetMetadata("renderSettingsPrimPath") or None
    return path


def choose_camera(stage: Usd.Stage, arguments: argparse.Namespace, say: Callable[[str], None]) -> UsdGeom.Camera | None:
    """The camera to look through, found as usdrecord does; None for the one that frames the stage."""
    settings_path = render_settings_path(stage, arguments, say)
    if arguments.camera:
        camera = find_camera(stage, arguments.camera)
        if camera:
            return camera
        say(f"there is no camera <{arguments.camera}>")
    if settings_path:
        settings = UsdRender.Settings(stage.GetPrimAtPath(settings_path))
        if not settings:
            say(f"there are no render settings <{settings_path}>")
        targets = settings.GetCameraRel().GetTargets() if settings else []
        if len(targets) == 1:
            camera = UsdGeom.Camera(stage.GetPrimAtPath(targets[0]))
            if camera:
                return camera
    return find_camera(stage, Sdf.Path(UsdUtils.GetPrimaryCameraName()))
