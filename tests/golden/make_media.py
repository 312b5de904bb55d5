#!/usr/bin/env python3
"""Makes media.json: daylight through water and air, Rayleigh scattering, Henyey and Greenstein.

Needs `pip install numpy`.
"""

import json

import numpy as np

import common
from common import GRID


def rayleigh(nm):
    """Returns the scattering of dry air in 1/m after Bodhaine et al. 1999.

    The air holds 360 ppm of CO2, at 15 °C and 101 325 Pa.
    """
    um, co2 = nm / 1000, 360e-6
    # Index of air with 300 ppm of CO2 (Peck and Reeder), then with more.
    n_300 = (8060.51 + 2480990 / (132.274 - um**-2) + 17455.7 / (39.32957 - um**-2)) * 1e-8
    n = 1 + n_300 * (1 + 0.54 * (co2 - 0.0003))
    nitrogen = 1.034 + 3.17e-4 / um**2
    oxygen = 1.096 + 1.385e-3 / um**2 + 1.448e-4 / um**4
    shares = np.array([78.084, 20.946, 0.934, co2 * 100])
    # The King factor of the mixture, of N2, O2, Ar and CO2.
    king = (shares[0] * nitrogen + shares[1] * oxygen + shares[2] + shares[3] * 1.15) / shares.sum()
    per_cm3, cm = 2.546899e19, nm * 1e-7
    lorentz = (n**2 - 1) / (n**2 + 2)
    return 24 * np.pi**3 * lorentz**2 * king / (cm**4 * per_cm3) * 100


def beam(extinction, path_m):
    """Returns the colour of D65 after a path, the unweakened light having Y = 1."""
    light = common.lamp("D65")
    xyz = light.xyz(lambda nm: np.exp(-extinction * path_m)) / light.xyz()[1]
    return {"XYZ": xyz, "linear_srgb": common.linear_srgb(xyz)}


def henyey_greenstein(g, degrees):
    cosine = np.cos(np.radians(degrees))
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * cosine) ** 1.5)


def media():
    method = (
        "Beer–Lambert of D65 through water (media/water.csv absorption, linear, ends held) and "
        "sea-level air (Rayleigh, formula), M1, white Y=1"
    )
    water = common.column("media/water.csv", "absorption_per_m")
    angles = [0, 30, 60, 90, 120, 150, 180]
    phase = lambda g: {str(angle): henyey_greenstein(g, angle) for angle in angles}
    found = {
        "water_beam": [{"path_m": m, **beam(water, m)} for m in (1.0, 5.0, 10.0, 30.0)],
        "rayleigh_per_m": {str(nm): rayleigh(nm) for nm in range(400, 701, 50)},
        "air_beam": [{"path_km": km, **beam(rayleigh(GRID), km * 1000)} for km in (10.0, 50.0)],
        "hg_checks": [{"g": g, "P_at_deg": phase(g)} for g in (0.0, 0.3, 0.76, 0.9, -0.4)],
    }
    golden = {"method": method, "generator": "make_media.py", "programs": f"numpy {np.__version__}"}
    return {**golden, **common.rounded(found, 10)}


if __name__ == "__main__":
    files = {"media.json": (lambda: common.json_text(media()), json.loads, 1e-9, {})}
    common.main(files)
