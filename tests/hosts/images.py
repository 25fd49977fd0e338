"""Pictures in and out of files, as arrays with the top row first."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import OpenEXR

AXES = {1: "Z", 2: "XY", 3: "XYZ", 4: "RGBA"}


def write_image(path: str, aovs: dict[str, np.ndarray]) -> None:
    """Writes `aovs`: all as layers of one file where it is an EXR, colour alone where it is a PNG."""
    if Path(path).suffix.lower() == ".png":
        write_png(path, aovs["color"])
    else:
        write_exr(path, aovs)


def write_exr(path: str, aovs: dict[str, np.ndarray]) -> None:
    """Writes an EXR with the channels that `umber record` gives it: R, G, B, A; `depth.Z`; `normal.X`; `primId.id`."""
    channels = {}
    for name, given in aovs.items():
        pixels = exr_type(np.atleast_3d(given))
        layer = "" if name == "color" else name.removeprefix("primvars:") + "."
        axes = ("id",) if pixels.dtype == np.uint32 else AXES[pixels.shape[2]]
        for index, axis in enumerate(axes):
            channels[layer + axis] = np.ascontiguousarray(pixels[:, :, index])
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {key: OpenEXR.Channel(key, pixels) for key, pixels in channels.items()}).write(path)


def exr_type(pixels: np.ndarray) -> np.ndarray:
    """`pixels` as a type that EXR has. Ids keep their bits: -1, nothing, is the largest unsigned number."""
    if pixels.dtype in (np.float16, np.float32):
        return np.ascontiguousarray(pixels)
    if pixels.dtype == np.int32:
        return np.ascontiguousarray(pixels).view(np.uint32)
    return pixels.astype(np.float32) / (np.iinfo(pixels.dtype).max if pixels.dtype.itemsize == 1 else 1)


def write_png(path: str, colour: np.ndarray) -> None:
    """Writes colour as it is, linear, in eight bits, as usdrecord does without a GPU."""
    pixels = (np.clip(colour.astype(np.float32), 0, 1) * 255 + 0.5).astype(np.uint8)
    height, width, components = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6 if components == 4 else 2, 0, 0, 0)
    content = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    Path(path).write_bytes(content)


def read_exr(path: str | Path) -> dict[str, np.ndarray]:
    """The channels of an EXR by name."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def read_colour(path: str | Path) -> np.ndarray:
    """Colour of an EXR: height × width × 3, single precision."""
    channels = read_exr(path)
    return np.stack([channels[name].astype(np.float32) for name in "RGB"], axis=2)
