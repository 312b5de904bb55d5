"""Checks that the pixels of two EXR files have the same bits: same_pixels.py A.exr B.exr.

The headers may differ, because they contain times.
"""

import struct
import sys


def pixels(path: str) -> bytes:
    """Returns the bytes after the header and the table of the positions of the chunks."""
    with open(path, "rb") as file:
        data = file.read()
    place = 8
    while data[place] != 0:
        for _ in range(2):
            place = data.index(b"\0", place) + 1
        (size,) = struct.unpack_from("<i", data, place)
        place += 4 + size
    (first,) = struct.unpack_from("<Q", data, place + 1)
    return data[first:]


if pixels(sys.argv[1]) != pixels(sys.argv[2]):
    sys.exit(f"the pixels of {sys.argv[1]} and {sys.argv[2]} differ")
