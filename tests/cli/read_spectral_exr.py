#!/usr/bin/env python3
"""Reads a spectral EXR with the OpenEXR project's own library and prints what it holds as JSON.

The layout is that of A. Fichet, R. Pacanowski and A. Wilkie, "An OpenEXR Layout for Spectral Images", Journal of
Computer Graphics Techniques 10(3), 2021. Needs `pip install OpenEXR` (3.3 or later, which brings numpy).

    read_spectral_exr.py PICTURE.exr

prints {"size": [width, height], "attributes": {name: text}, "bands": [{"channel", "nm", "values"}], "channels": [name]},
the bands in the order of their wavelengths, values row by row from the top.
"""

import json
import re
import sys

import OpenEXR

# Section 3.2: S0 to S3 for emission and its polarisation, a decimal comma, a unit; here the total (S0) in nm.
BAND = re.compile(r"^S0\.(\d+(?:,\d+)?)nm$")


def main(path):
    part = OpenEXR.File(path, separate_channels=True).parts[0]
    bands = []
    for name, channel in part.channels.items():
        found = BAND.match(name)
        if found:
            nm = float(found.group(1).replace(",", "."))
            bands.append({"channel": name, "nm": nm, "values": channel.pixels.astype(float).ravel().tolist()})
    bands.sort(key=lambda band: band["nm"])
    attributes = {name: value for name, value in part.header.items() if isinstance(value, str)}
    height, width = next(iter(part.channels.values())).pixels.shape
    channels = sorted(part.channels)
    json.dump({"size": [width, height], "attributes": attributes, "bands": bands, "channels": channels}, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1])
