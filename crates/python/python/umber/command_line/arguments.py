"""The arguments of `umber record`: those of usdrecord 25.08, and Umber's own."""

from __future__ import annotations

import argparse

from pxr import Sdf

from umber import aovs, settings

COMPLEXITIES = ("low", "medium", "high", "veryhigh")


def _sdf_path(text: str) -> Sdf.Path:
    return Sdf.Path(text) if text else Sdf.Path.emptyPath


def parser() -> argparse.ArgumentParser:
    """The parser. Destinations that usdrecord inverts are inverted here too."""
    made = argparse.ArgumentParser(
        prog="umber record",
        description="Generates images from a USD file",
        epilog=_settings_help(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    made.add_argument("usdFilePath", help="USD file to record")
    made.add_argument(
        "outputImagePath",
        help="Output image path (.png, .jpg, .bmp, .tga, .tif, .hdr, .exr). For frame ranges it must contain exactly "
        'one frame number placeholder of the form "###" or "###.###", with any number of hash marks in each group.',
    )
    _add_stage_arguments(made)
    _add_time_arguments(made)
    _add_image_arguments(made)
    _add_diagnostics(made)
    _add_own_arguments(made)
    return made


def _add_stage_arguments(made: argparse.ArgumentParser) -> None:
    made.add_argument(
        "--mask",
        dest="populationMask",
        metavar="PRIMPATH[,PRIMPATH...]",
        help="Limit stage population to these prims, their descendants and ancestors; separated by commas or spaces.",
    )
    made.add_argument(
        "--purposes",
        metavar="PURPOSE[,PURPOSE...]",
        default="proxy",
        help="Purposes to render beside 'default'; separated by commas or spaces (default=%(default)s)",
    )
    made.add_argument(
        "--sessionLayer",
        dest="sessionLayerPath",
        metavar="SESSIONLAYER",
        help="Open the stage with this session layer in place of an anonymous one.",
    )
    made.add_argument("--disableGpu", action="store_false", dest="gpuEnabled", help="Accepted: Umber uses no GPU.")
    made.add_argument(
        "--disableDrawMode",
        action="store_false",
        dest="drawModeEnabled",
        help="Accepted: geometry is never replaced by a draw mode's stand-in.",
    )
    made.add_argument(
        "--disableCameraLight",
        action="store_false",
        dest="cameraLightEnabled",
        help="Render without the default light at the camera.",
    )
    made.add_argument(
        "--camera",
        "-cam",
        type=_sdf_path,
        help="Which camera to use: a prim's name, or a full prim path. Without any, the stage's primary camera; "
        "without that one, a camera that frames the whole stage.",
    )
    made.add_argument(
        "--renderPassPrimPath",
        "-rp",
        dest="rpPrimPath",
        help="RenderPass prim to use; overrides the stage's renderSettingsPrimPath.",
    )
    made.add_argument(
        "--renderSettingsPrimPath",
        "-rs",
        dest="rsPrimPath",
        help="RenderSettings prim to use; overrides the stage's renderSettingsPrimPath.",
    )


def _add_time_arguments(made: argparse.ArgumentParser) -> None:
    time = made.add_mutually_exclusive_group()
    time.add_argument(
        "--defaultTime",
        "-d",
        action="store_true",
        help="Record the Default time code, not the stage's startTimeCode.",
    )
    time.add_argument(
        "--frames",
        "-f",
        metavar="FRAMESPEC[,FRAMESPEC...]",
        help="Time codes to record: single ones, ranges start:end, or start:end with stride (x). "
        "Examples: 123 - 101:105 - 105:101 - 101:109x2 - 101:104x0.5",
    )


def _add_image_arguments(made: argparse.ArgumentParser) -> None:
    made.add_argument(
        "--complexity",
        "-c",
        default="low",
        choices=COMPLEXITIES,
        help="Level of refinement to use (default=%(default)s)",
    )
    made.add_argument(
        "--colorCorrectionMode",
        "-color",
        default="sRGB",
        choices=["disabled", "sRGB", "openColorIO"],
        help="Colour correction of display images; EXR and HDR stay scene-linear (default=%(default)s)",
    )
    made.add_argument("--renderer", "-r", dest="rendererPlugin", choices=["Umber"], help="The renderer to use.")
    made.add_argument(
        "--imageWidth",
        "-w",
        type=int,
        default=960,
        help="Width of the output image; the height follows from the camera's aspect ratio (default=%(default)s)",
    )
    made.add_argument(
        "--enableDomeLightVisibility",
        action="store_true",
        dest="domeLightVisibility",
        help="Show dome lights in the background.",
    )


def _add_diagnostics(made: argparse.ArgumentParser) -> None:
    made.add_argument("--traceToFile", help="Trace USD and write the trace to this file.")
    made.add_argument(
        "--traceFormat", default="chrome", choices=["chrome", "trace"], help="Format of the trace (default=%(default)s)"
    )
    made.add_argument("--memstats", action="store_true", help="Account for USD's memory, where it supports that.")


def _positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{value} is less than 1")
    return value


def _add_own_arguments(made: argparse.ArgumentParser) -> None:
    own = made.add_argument_group("beyond usdrecord")
    own.add_argument(
        "--imageHeight", type=_positive, help="Height of the output image, in place of the camera's aspect."
    )
    own.add_argument(
        "--set",
        dest="settings",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="Sets a renderer setting (listed below); may be given more than once.",
    )
    own.add_argument(
        "--aovs",
        metavar="AOV[,AOV...]",
        help="AOVs to write as layers of one EXR file: " + ", ".join(row["name"] for row in aovs()),
    )
    own.add_argument("--stats", action="store_true", help="Print figures of the render.")


def _settings_help() -> str:
    lines = ["settings for --set:"]
    for row in settings():
        limits = f", {row['range'][0]:g} to {row['range'][1]:g}" if row["range"] else ""
        choices = f"; one of {', '.join(row['choices'])}" if row["choices"] else ""
        lines.append(f"  {row['key']} (default {str(row['default']).lower()}{limits}{choices})\n      {row['doc']}")
    return "\n".join(lines)
