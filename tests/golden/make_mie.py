#!/usr/bin/env python3
"""Makes mie_fog_phase.csv and mie_rain_r0.5mm.csv: phase functions of water drops in air.

miepython computes the Lorenz-Mie series of each radius. The mean over the radii weighs each phase
function by its scattering cross-section. Densities are per sr and have the integral 1 over the
sphere. The light comes from a point. Needs `pip install numpy numba miepython==3.3.0`. numba makes
the series a hundred times as fast.

The script also prints the means over the radii that crates/abbe-optics/src/phase/mie.rs and
tests/contracts/media_golden.rs quote.
"""

import importlib.metadata
import math
import os

import numpy as np

import common

os.environ["MIEPYTHON_USE_JIT"] = "1"
import miepython  # It reads the variable on import.

# The extinction coefficient of water: Hale and Querry, Appl. Opt. 12, 555 (1973).
FOG_K = {400: 1.86e-9, 450: 1.02e-9, 500: 1e-9, 550: 1.96e-9, 600: 1.09e-8, 650: 1.64e-8, 700: 3.35e-8}
# Rain is computed without absorption.
RAIN_K = dict.fromkeys([440, 490, 546.1, 589.3, 632.8, 680], 0.0)


def mean_over_radii(nm, k, radii_um, weights, angles_deg):
    """Returns the mean scattering cross-section in µm², cosine and phase function."""
    # miepython writes an absorbing index as n - ik.
    m = complex(common.index(common.glasses()["water 20C"], nm), -k)
    mu = np.cos(np.radians(angles_deg))
    cross_section, cosine, density = 0.0, 0.0, np.zeros(len(mu))
    for radius, weight in zip(radii_um, weights / weights.sum()):
        x = 2 * math.pi * radius / (nm / 1000)
        _, scattering, _, g = miepython.efficiencies_mx(m, x)
        share = weight * scattering * math.pi * radius**2
        cross_section += share
        cosine += share * g
        density += share * miepython.i_unpolarized(m, x, mu, norm="one")
    return cross_section, cosine / cross_section, density / cross_section


def table(first, angles, k_by_nm, radii_um, weights):
    """Returns the table as text and prints the means of each wavelength."""
    densities = []
    for nm, k in k_by_nm.items():
        cross_section, cosine, density = mean_over_radii(nm, k, radii_um, weights, angles)
        means = f"scattering cross-section {cross_section:.8g} µm², mean cosine {cosine:.8g}"
        bright = [bow(angles, density, *limits) for limits in [(135, 142), (122, 132)]]
        print(f"{nm} nm: {means}, brightest within 135-142° and 122-132° at {bright}")
        densities.append([f"{value:.9g}" for value in density])
    rows = [",".join([f"{angle:g}", *row]) for angle, *row in zip(angles, *densities)]
    header = ",".join([first, *[f"p_{nm}nm_per_sr" for nm in k_by_nm]])
    return "\n".join([header, *rows]) + "\n"


def bow(angles, density, first, last):
    """Returns the brightest angle within a range."""
    inside = (angles > first) & (angles < last)
    return round(float(angles[inside][np.argmax(density[inside])]), 2)


def fog():
    """Radii lognormal about 5 µm with the width 0.3 of ln r, 301 radii over ±3.5 widths."""
    z = np.linspace(-3.5, 3.5, 301)
    spans = [(0, 5, 0.1), (5, 15, 0.5), (15, 130, 1), (130, 160, 0.5), (160, 175, 1), (175, 180, 0.1)]
    angles = [first + i * step for first, last, step in spans for i in range(round((last - first) / step))]
    return table("angle_deg", np.array([*angles, 180.0]), FOG_K, 5 * np.exp(0.3 * z), np.exp(-z * z / 2))


def rain():
    """Radii normal about 0.5 mm with the width of 1 %, 61 radii over ±3 widths."""
    z = np.linspace(-3, 3, 61)
    angles = np.array([125 + 0.05 * i for i in range(401)])
    return table("scattering_angle_deg", angles, RAIN_K, 500 * (1 + 0.01 * z), np.exp(-z * z / 2))


def columns(text):
    """Returns the columns of a table by name."""
    header, *rows = [line.split(",") for line in text.splitlines()]
    return {name: [float(cell) for cell in cells] for name, cells in zip(header, zip(*rows))}


if __name__ == "__main__":
    print(f"miepython {importlib.metadata.version('miepython')}, numpy {np.__version__}")
    common.main(
        {
            "mie_fog_phase.csv": (fog, columns, 1e-7, {}),
            "mie_rain_r0.5mm.csv": (rain, columns, 1e-7, {}),
        }
    )
