"""`umber record`: renders a stage to image files, as usdrecord does."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pxr import Gf, Usd, UsdGeom

from umber import Session, aovs, images
from umber.command_line import arguments as command_arguments
from umber.command_line import frames, progress
from umber.command_line.stages import CannotRenderError, choose_camera, open_stage
from umber.command_line.tracing import traced
from umber.description import Camera
from umber.feed import feed
from umber.stage_reader import camera_light, read_camera, read_stage
from umber.stage_reader import free_camera as free

PURPOSES = ("render", "proxy", "guide")
INTERRUPTED = 130


def _warn(text: str) -> None:
    print(f"Warning: {text}", file=sys.stderr)


def record(given: list[str]) -> int:
    """Runs `umber record`; gives the exit code."""
    parser = command_arguments.parser()
    arguments = parser.parse_args(given)
    arguments.imageWidth = max(arguments.imageWidth, 1)
    planes = _planes(parser, arguments)
    _check_settings(parser, arguments.settings)
    try:
        with traced(arguments):
            stage = open_stage(arguments)
            try:
                plan = frames.plan(stage, arguments.outputImagePath, arguments.frames, arguments.defaultTime)
            except ValueError as error:
                parser.error(str(error))
            _record(stage, plan, arguments, planes)
    except CannotRenderError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("Interrupted: the picture that was being rendered is not written", file=sys.stderr)
        return INTERRUPTED
    return 0


def _planes(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> list[str]:
    """AOVs to render and write."""
    if arguments.aovs is None:
        return ["color"]
    known = {row["name"].removeprefix("primvars:"): row["name"] for row in aovs()}
    asked = list(dict.fromkeys(arguments.aovs.replace(",", " ").split()))
    for name in asked:
        if name.removeprefix("primvars:") not in known:
            parser.error(f"argument --aovs: unknown AOV '{name}' (known: {', '.join(known)})")
    names = [known[name.removeprefix("primvars:")] for name in asked]
    if not arguments.outputImagePath.lower().endswith(".exr") and names != ["color"]:
        parser.error("argument --aovs: several AOVs, or others than color, can only be written to an .exr file")
    return names or ["color"]


def _check_settings(parser: argparse.ArgumentParser, settings: list[str]) -> None:
    scratch = Session()
    for row in settings:
        key, equals, value = row.partition("=")
        if not equals:
            parser.error(f"argument --set: '{row}' is not of the form KEY=VALUE")
        try:
            scratch.set(key, value)
        except ValueError as error:
            parser.error(f"argument --set: {error}")


def _record(stage: Usd.Stage, plan: list[tuple[float, str]], arguments: argparse.Namespace, planes: list[str]) -> None:
    for _, path in plan:
        reason = images.why_not_writable(Path(path))
        if reason is not None:
            raise CannotRenderError(f"Cannot write {path}: {reason}")
    purposes = _purposes(arguments.purposes)
    camera = choose_camera(stage, arguments, _warn)
    if arguments.complexity != "low":
        _warn("--complexity has no effect yet: surfaces are not subdivided")
    if arguments.colorCorrectionMode == "openColorIO":
        _warn("--colorCorrectionMode openColorIO is not supported yet; sRGB is taken")
    print(f"Camera: {camera.GetPath() if camera else '(frames the stage)'}")
    print("Renderer plugin: Umber")
    for time, path in plan:
        print(f"Recording time code: {time:f}", flush=True)
        _record_frame(stage, Usd.TimeCode(time), camera, Path(path), purposes, arguments, planes)


def _purposes(text: str) -> list[str]:
    asked = text.replace(",", " ").split()
    for name in asked:
        if name not in (*PURPOSES, "default"):
            _warn(f"unrecognized purpose value '{name}'")
    return [name for name in asked if name in PURPOSES]


def _cameras(
    stage: Usd.Stage, time: Usd.TimeCode, camera: UsdGeom.Camera | None, purposes: list[str]
) -> tuple[Camera, Gf.Camera]:
    """The camera for the session, and as it was before it went there."""
    if camera:
        return read_camera(camera, time), camera.GetCamera(time)
    framing = free.frame_stage(stage, time, purposes)
    taken = free.as_hydra_has_it(framing)
    return free.describe_free(taken), framing


def _record_frame(
    stage: Usd.Stage,
    time: Usd.TimeCode,
    usd_camera: UsdGeom.Camera | None,
    path: Path,
    purposes: list[str],
    arguments: argparse.Namespace,
    planes: list[str],
) -> None:
    session = Session()
    session.set("enableInteractive", "false")
    session.set("domeLightCameraVisibility", str(arguments.domeLightVisibility))
    for row in arguments.settings:
        session.set(*row.split("=", 1))
    session.purposes(purposes)
    camera, gf_camera = _cameras(stage, time, usd_camera, purposes)
    session.camera(camera)
    if arguments.cameraLightEnabled:
        session.light(camera_light(gf_camera))
    if feed(session, read_stage(stage, time, frozenset(purposes), _warn)) == 0:
        _warn(f"{stage.GetRootLayer().identifier} shows no geometry at this time code")
    height = arguments.imageHeight or free.image_height(arguments.imageWidth, gf_camera)
    session.set_film(arguments.imageWidth, max(height, 1), planes)
    session.start()
    try:
        progress.wait(session)
    finally:
        session.stop()
    _say_messages(session)
    pictures = {name: session.resolve(name) for name in planes}
    try:
        images.write(path, pictures, srgb=arguments.colorCorrectionMode != "disabled")
    except OSError as error:
        raise CannotRenderError(f"Failed to write image to {path}: {error}") from error
    if arguments.stats:
        for name, value in session.stats().items():
            print(f"{name}: {value}")


def _say_messages(session: Session) -> None:
    failed = [text for is_error, text in session.messages() if is_error or _warn(text)]
    if failed:
        raise CannotRenderError("\n".join(failed))
