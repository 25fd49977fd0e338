"""Renders the frames of one command."""

from __future__ import annotations

import argparse
import dataclasses
import sys
from dataclasses import dataclass
from pathlib import Path

from pxr import Gf, Usd, UsdGeom

from umber import Session, images
from umber.command_line import progress
from umber.command_line.stages import CannotRenderError
from umber.description import Camera
from umber.feed import feed
from umber.stage_reader import camera_light, free_camera, read_camera, read_stage


def warn(text: str) -> None:
    """Tells the user of something that does not keep the picture from being rendered."""
    print(f"Warning: {text}", file=sys.stderr)


@dataclass
class Job:
    """What all frames of a command share."""

    stage: Usd.Stage
    camera: UsdGeom.Camera | None
    """None: the one that frames the stage."""
    purposes: list[str]
    planes: list[str]
    """AOVs to render and write."""
    arguments: argparse.Namespace

    def record(self, time: Usd.TimeCode, path: Path) -> None:
        """Renders one frame and writes it. A frame that is interrupted is not written."""
        session = Session()
        self._set_up(session)
        camera, gf_camera = self._cameras(time)
        if self.arguments.imageHeight:
            # a picture of another shape than the aperture shows the aperture's whole width
            camera = dataclasses.replace(camera, conform_policy="matchHorizontally")
        session.camera(camera)
        if self.arguments.cameraLightEnabled:
            session.light(camera_light(gf_camera))
        if feed(session, read_stage(self.stage, time, frozenset(self.purposes), warn)) == 0:
            warn(f"{self.stage.GetRootLayer().identifier} shows no geometry at this time code")
        width = self.arguments.imageWidth
        height = self.arguments.imageHeight or free_camera.image_height(width, gf_camera)
        session.set_film(width, max(height, 1), self.planes)
        session.start()
        try:
            progress.wait(session)
        finally:
            session.stop()
        _say_messages(session)
        self._write(session, path)
        if self.arguments.stats:
            for name, value in session.stats().items():
                print(f"{name}: {value}")

    def _set_up(self, session: Session) -> None:
        session.set("enableInteractive", "false")
        session.set("domeLightCameraVisibility", str(self.arguments.domeLightVisibility))
        for row in self.arguments.settings:
            session.set(*row.split("=", 1))
        session.purposes(self.purposes)

    def _cameras(self, time: Usd.TimeCode) -> tuple[Camera, Gf.Camera]:
        """The camera for the session, and the one that it was made from."""
        if self.camera:
            return read_camera(self.camera, time), self.camera.GetCamera(time)
        framing = free_camera.frame_stage(self.stage, time, self.purposes)
        return free_camera.describe_free(framing), framing

    def _write(self, session: Session, path: Path) -> None:
        pictures = {name: session.resolve(name) for name in self.planes}
        try:
            images.write(path, pictures, srgb=self.arguments.colorCorrectionMode != "disabled")
        except (OSError, RuntimeError) as error:
            raise CannotRenderError(f"Failed to write image to {path}: {error}") from error


def _say_messages(session: Session) -> None:
    errors = []
    for is_error, text in session.messages():
        if is_error:
            errors.append(text)
        else:
            warn(text)
    if errors:
        raise CannotRenderError("\n".join(errors))
