"""Reads a USD stage at a time code, as descriptions that a session takes."""

from umber.stage_reader.camera import find_camera, read_camera
from umber.stage_reader.camera_light import camera_light
from umber.stage_reader.stage import read_stage

__all__ = ["camera_light", "find_camera", "read_camera", "read_stage"]
