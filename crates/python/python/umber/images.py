"""Writes pictures: display-referred 8 bit files, scene-linear HDR and EXR files.

Pictures are arrays of shape (height, width, components), row 0 at the top.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from umber._umber import write_hdr

Picture = npt.NDArray[Any]
DISPLAY_FORMATS = (".png", ".jpg", ".jpeg", ".bmp", ".tga", ".tif", ".tiff")
LINEAR_FORMATS = (".exr", ".hdr")
WITHOUT_ALPHA = (".jpg", ".jpeg", ".bmp")
JPEG_QUALITY = 95
AXES = {1: "Z", 2: "XY", 3: "XYZ", 4: "RGBA"}


def srgb_from_linear(linear: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """The sRGB transfer function."""
    positive = np.maximum(linear, 0.0)
    curved = 1.055 * np.power(positive, 1.0 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, curved).astype(np.float32)


def quantized(values: npt.NDArray[np.float32]) -> npt.NDArray[np.uint8]:
    """Numbers from 0 to 1 as bytes, rounded as usdrecord does."""
    scaled = np.floor(255.0 * np.nan_to_num(values, nan=0.0) + 0.499999)
    return np.clip(scaled, 0, 255).astype(np.uint8)


def write(path: Path, planes: dict[str, Picture], srgb: bool) -> None:
    """Writes AOVs by name. Only EXR takes more than colour.

    `srgb`: whether colours of display formats go through the sRGB curve.
    """
    suffix = path.suffix.lower()
    if suffix == ".exr":
        write_exr(path, planes)
    elif suffix == ".hdr":
        write_hdr(str(path), np.ascontiguousarray(planes["color"][..., :3], np.float32))
    else:
        _write_display(path, planes["color"], srgb)


def _write_display(path: Path, color: Picture, srgb: bool) -> None:
    from PIL import Image  # noqa: PLC0415 - not needed for EXR

    rgb = srgb_from_linear(color[..., :3]) if srgb else color[..., :3]
    values = quantized(rgb)
    if path.suffix.lower() not in WITHOUT_ALPHA:
        values = np.concatenate([values, quantized(color[..., 3:])], axis=2)
    Image.fromarray(np.ascontiguousarray(values)).save(path, quality=JPEG_QUALITY)


def write_exr(path: Path, planes: dict[str, Picture]) -> None:
    """Writes AOVs as layers of one file.

    Colour becomes R, G, B, A, in the single precision of the render buffer, which is what usdrecord
    writes from it; other AOVs get their name as layer: `depth.Z`, `normal.X`, `primId.id` (unsigned;
    where nothing is seen, the largest number).
    """
    import OpenEXR  # noqa: PLC0415 - not needed for PNG

    channels: dict[str, Picture] = {}
    for name, picture in planes.items():
        if name == "color":
            channels["RGBA"] = np.ascontiguousarray(picture, np.float32)
            continue
        layer = name.removeprefix("primvars:")
        if np.issubdtype(picture.dtype, np.integer):
            channels[f"{layer}.id"] = np.ascontiguousarray(picture[..., 0]).view(np.uint32)
            continue
        for i, axis in enumerate(AXES[picture.shape[2]]):
            channels[f"{layer}.{axis}"] = np.ascontiguousarray(picture[..., i], np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))


def why_not_writable(path: Path) -> str | None:
    """Why a picture could not be written to `path`; None where it could."""
    suffix = path.suffix.lower()
    if suffix not in DISPLAY_FORMATS + LINEAR_FORMATS:
        known = ", ".join(DISPLAY_FORMATS + LINEAR_FORMATS)
        return f"'{path.suffix}' is not an image format that can be written (known: {known})"
    if not path.parent.is_dir():
        return f"the folder {path.parent} does not exist"
    existed = path.exists()
    try:
        with path.open("ab"):
            pass
    except OSError as error:
        return error.strerror or str(error)
    if not existed:
        path.unlink()
    return None
