"""`umber record`: renders a stage to image files, as usdrecord does."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pxr import Usd

from umber import Session, aovs, images
from umber.command_line import arguments as command_arguments
from umber.command_line import frames
from umber.command_line.job import Job, warn
from umber.command_line.stages import CannotRenderError, choose_camera, open_stage
from umber.command_line.tracing import traced

PURPOSES = ("render", "proxy", "guide")
INTERRUPTED = 130


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
    camera = choose_camera(stage, arguments, warn)
    if arguments.complexity != "low":
        warn("--complexity has no effect yet: surfaces are not subdivided")
    if arguments.colorCorrectionMode == "openColorIO":
        warn("--colorCorrectionMode openColorIO is not supported yet; sRGB is taken")
    print(f"Camera: {camera.GetPath() if camera else '(frames the stage)'}")
    print("Renderer plugin: Umber")
    job = Job(stage, camera, purposes, planes, arguments)
    for time, path in plan:
        print(f"Recording time code: {time:f}", flush=True)
        job.record(Usd.TimeCode(time), Path(path))


def _purposes(text: str) -> list[str]:
    asked = text.replace(",", " ").split()
    for name in asked:
        if name not in (*PURPOSES, "default"):
            warn(f"unrecognized purpose value '{name}'")
    return [name for name in asked if name in PURPOSES]
