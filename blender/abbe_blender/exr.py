# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the EXR files of Abbe, and writes pictures for it. This module does not need Blender.

The files have one part of 32-bit channels in scan lines, without compression or with run lengths.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

#: The number of the pixel type FLOAT, and those of the compressions that Abbe writes.
_FLOAT = 2
_NONE, _RLE = 0, 1
_ONE = struct.pack("<f", 1.0)


class Picture:
    """The channels of a picture by name, with rows from the top, and its header."""

    def __init__(self, channels: dict[str, Any], header: dict[str, bytes], size: tuple[int, int]) -> None:
        self.channels, self.header, self.size = channels, header, size

    def text(self, name: str) -> str:
        """Returns an attribute of the type string, or an empty string."""
        return self.header.get(name, b"").decode("ascii", "replace")


def read(path: Path) -> Picture:
    """Reads a picture. Raises ValueError if the file is none that Abbe writes."""
    data = path.read_bytes()
    try:
        return _read(data)
    except (struct.error, IndexError) as error:
        raise ValueError(f"{path}: the EXR file is truncated ({error})") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def write(path: Path, channels: dict[str, Any]) -> None:
    """Writes channels of 32-bit numbers, with rows from the top, without compression."""
    names = sorted(channels)
    pixels = np.stack([channels[name] for name in names], axis=1).astype("<f4")
    height, _, width = pixels.shape
    kinds = b"".join(name.encode() + struct.pack("<BIIii", 0, _FLOAT, 0, 1, 1) for name in names) + b"\0"
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = [
        ("channels", "chlist", kinds), ("compression", "compression", bytes([_NONE])), ("dataWindow", "box2i", box),
        ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", _ONE),
        ("screenWindowCenter", "v2f", bytes(8)), ("screenWindowWidth", "float", _ONE),
    ]  # fmt: skip
    header = struct.pack("<II", 20000630, 2)
    for name, kind, value in attributes:
        header += f"{name}\0{kind}\0".encode() + struct.pack("<I", len(value)) + value
    start, row = len(header) + 1 + 8 * height, pixels[0].nbytes
    offsets = struct.pack(f"<{height}Q", *(start + y * (8 + row) for y in range(height)))
    lines = b"".join(struct.pack("<iI", y, row) + pixels[y].tobytes() for y in range(height))
    path.write_bytes(header + b"\0" + offsets + lines)


def _read(data: bytes) -> Picture:
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & 0x1A00:
        raise ValueError("no EXR file with a single part of scan lines")
    header, at = {}, 8
    while data[at] != 0:
        name, at = _string(data, at)
        _kind, at = _string(data, at)
        (length,) = struct.unpack_from("<I", data, at)
        header[name] = data[at + 4 : at + 4 + length]
        at += 4 + length
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names = _channels(header["channels"])
    compression = header["compression"][0]
    if compression not in (_NONE, _RLE):
        raise ValueError("the EXR file has a compression that Abbe does not write")
    row = len(names) * width * 4
    offsets = struct.unpack_from(f"<{height}Q", data, at + 1)
    pixels = np.empty((height, len(names), width), np.float32)
    for offset in offsets:
        y, length = struct.unpack_from("<iI", data, offset)
        block = data[offset + 8 : offset + 8 + length]
        if length < row and compression == _RLE:
            block = _unpacked(block, row)
        pixels[y - y0] = np.frombuffer(block, "<f4", len(names) * width).reshape(len(names), width)
    return Picture({name: pixels[:, number] for number, name in enumerate(names)}, header, (width, height))


def _string(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(0, at)
    return data[at:end].decode("utf-8", "replace"), end + 1


def _channels(data: bytes) -> list[str]:
    names, at = [], 0
    while data[at] != 0:
        name, at = _string(data, at)
        kind, _linear, x, y = struct.unpack_from("<IIii", data, at)
        if kind != _FLOAT or (x, y) != (1, 1):
            raise ValueError(f"the channel {name} has no 32-bit numbers for each pixel")
        names.append(name)
        at += 16
    return names


def _unpacked(block: bytes, length: int) -> bytes:
    """Undoes run lengths, differences and the separation of even and odd bytes."""
    runs, at = bytearray(), 0
    while at < len(block):
        count = block[at]
        if count > 127:  # A negative number: bytes that follow as they are.
            runs += block[at + 1 : at + 257 - count]
            at += 257 - count
        else:
            runs += block[at + 1 : at + 2] * (count + 1)
            at += 2
    if len(runs) != length:
        raise ValueError("a line of the EXR file is damaged")
    steps = np.frombuffer(bytes(runs), np.uint8).astype(np.int64)
    steps[1:] -= 128
    values = np.cumsum(steps).astype(np.uint8)
    half = (length + 1) // 2
    out = np.empty(length, np.uint8)
    out[0::2], out[1::2] = values[:half], values[half:]
    return out.tobytes()
