#!/usr/bin/env python3
"""Makes lens_curves.json: field curvature, ray fans, spots and geometric MTF of built-in lenses.

Optiland 0.6.3 traces all rays through the prescriptions of data/lenses/lenses.json, which start
parallel to a chief ray through the middle of the stop. Rays outside a semi-aperture are left out.
The semi-aperture of the stop is that of the paraxial marginal ray of the d line.
The sensor lies in the paraxial focus of the d line. Lengths are in mm.

Run in an environment with optiland: python make_lens_curves.py
"""

import json
import math
import pathlib

import numpy as np
from optiland.materials import IdealMaterial
from optiland.optic import Optic
from optiland.rays import RealRays
from scipy.optimize import newton

import common

HERE = pathlib.Path(__file__).parent
LENSES = HERE.parent.parent / "crates/abbe-optics/data/lenses/lenses.json"
NM = {"F": 486.1327, "d": 587.5618, "C": 656.2725}
NAMES = ["cemented achromat 25 mm f100", "Cooke triplet f50", "double Gauss f/2 f100"]
GLASSES = common.glasses()
FREQUENCIES = [10, 20, 40]
FAN = [-0.5, -0.25, 0.25, 0.5]


def index_of(name, nm):
    return 1.0 if name == "air" else common.index(GLASSES[name], nm)


def optic_of(surfaces, nm, distance):
    optic = Optic()
    optic.surfaces.add(index=0, thickness=np.inf)
    for i, surface in enumerate(surfaces):
        optic.surfaces.add(
            index=i + 1,
            radius=surface["radius_mm"] or np.inf,
            thickness=distance if i + 1 == len(surfaces) else surface["thickness_mm"],
            material=IdealMaterial(index_of(surface["glass"], nm)),
            is_stop=bool(surface.get("stop")),
        )
    optic.surfaces.add(index=len(surfaces) + 1)
    optic.set_aperture("EPD", 1)
    optic.fields.set_type("angle")
    optic.fields.add(y=0)
    optic.wavelengths.add(nm / 1000, is_primary=True)
    return optic


class Lens:
    def __init__(self, entry, nm, distance):
        self.surfaces = entry["surfaces"]
        self.stop = next(i for i, surface in enumerate(self.surfaces) if surface.get("stop"))
        self.optic = optic_of(self.surfaces, nm, distance)
        self.nm = nm
        self.stop_mm = math.nan

    def trace(self, start, angle, aside, up):
        """Rays parallel to the one through the height `start` in the plane of the first vertex."""
        aside, up = np.broadcast_arrays(np.asarray(aside, float), np.asarray(up, float))
        sine, cosine = math.sin(angle), math.cos(angle)
        ones = np.ones(aside.size)
        back = 50.0
        y = start - back * sine / cosine + up.ravel() * cosine
        z = -back - up.ravel() * sine
        rays = RealRays(aside.ravel(), y, z, 0 * ones, sine * ones, cosine * ones, ones, self.nm / 1000 * ones)
        return self.optic.surfaces.trace(rays)

    def chief(self, angle):
        """Height in the plane of the first vertex of the ray through the middle of the stop."""

        def missed(start):
            self.trace(start, angle, 0, 0)
            return float(self.optic.surfaces.y[self.stop + 1, 0])

        return 0.0 if angle == 0 else newton(missed, 0.0, x1=-0.1, tol=1e-12)

    def passes(self):
        radius = np.hypot(self.optic.surfaces.x, self.optic.surfaces.y)[1:-1]
        limits = np.array([surface["semi_aperture_mm"] for surface in self.surfaces])
        limits[self.stop] = self.stop_mm
        return np.all(radius <= limits[:, None] * (1 + 1e-9), axis=0)


def foci(lens, angle, pupil):
    start, thin = lens.chief(angle), 3e-4 * pupil
    rays = lens.trace(start, angle, [0, 0, thin], [thin, -thin, 0])
    y, slope = np.array(rays.y), np.array(rays.M) / np.array(rays.N)
    tangential = -(y[0] - y[1]) / (slope[0] - slope[1])
    sagittal = -float(rays.x[2]) / (float(rays.L[2]) / float(rays.N[2]))
    return float(tangential), sagittal


def main():
    lenses = json.loads(LENSES.read_text())["lenses"]
    golden = {entry["name"]: entry for entry in json.loads((HERE / "lenses.json").read_text())["lenses"]}
    out = []
    for entry in lenses:
        if entry["name"] not in NAMES:
            continue
        distance = golden[entry["name"]]["expected"]["bfd_d"]
        pupil = 0.5 * entry["entrance_pupil_diameter_mm"]
        lines = {line: Lens(entry, nm, distance) for line, nm in NM.items()}
        lines["d"].trace(0.0, 0.0, 0, 1e-4)
        stop_mm = pupil * 1e4 * float(lines["d"].optic.surfaces.y[lines["d"].stop + 1, 0])
        for lens in lines.values():
            lens.stop_mm = stop_mm
        fields = []
        for fraction in (0.0, 0.7, 1.0):
            angle = math.radians(fraction * entry["half_field_deg"])
            start = lines["d"].chief(angle)
            reference = float(lines["d"].trace(start, angle, 0, 0).y[0])
            field = {"fraction": fraction, "image_height": reference, "foci": {}, "chief": {}, "fans": {}, "rms": {}}
            # Uniform in area: a fine grid over twice the pupil, which the apertures cut.
            grid = (2 * np.arange(500) + 1) / 500 - 1
            aside, up = (2 * pupil * part.ravel() for part in np.meshgrid(grid, grid))
            keep = np.hypot(aside, up) <= 1.3 * pupil
            aside, up = aside[keep], up[keep]
            points = []
            for line, lens in lines.items():
                field["foci"][line] = foci(lens, angle, pupil)
                own = lens.chief(angle)
                field["chief"][line] = float(lens.trace(own, angle, 0, 0).y[0])
                heights = np.array(FAN) * pupil
                upper = lens.trace(start, angle, 0 * heights, heights * math.cos(angle))
                field["fans"][line] = {"y": [float(y) - reference for y in upper.y]}
                side = lens.trace(start, angle, heights, 0 * heights)
                field["fans"][line]["x"] = [float(x) for x in side.x]
                rays = lens.trace(start, angle, aside, up)
                x, y = np.array(rays.x), np.array(rays.y)
                passing = lens.passes() & np.isfinite(x) & np.isfinite(y)
                x, y = x[passing], y[passing]
                field["rms"][line] = float(np.sqrt(np.mean((x - x.mean()) ** 2 + (y - y.mean()) ** 2)))
                points.append((x, y))
            field["mtf"] = []
            for per_mm in FREQUENCIES:
                both = []
                for axis in (1, 0):
                    waves = np.concatenate([np.exp(-2j * np.pi * per_mm * point[axis]) for point in points])
                    both.append(float(abs(waves.mean())))
                field["mtf"].append({"per_mm": per_mm, "tangential": both[0], "sagittal": both[1]})
            fields.append(field)
        axial = {}
        for line, lens in lines.items():
            rays = lens.trace(0.0, 0.0, [0, 0], [0.5 * pupil, 0.9 * pupil])
            axial[line] = [float(-y / (m / n)) for y, m, n in zip(rays.y, rays.M, rays.N)]
        out.append({"name": entry["name"], "longitudinal_at_0.5_and_0.9_of_the_pupil": axial, "fields": fields})
    text = {
        "method": "rays traced by optiland 0.6.3 with ideal materials of the catalogue's indices",
        "generator": "make_lens_curves.py",
        "fan_pupil": FAN,
        "lenses": out,
    }
    (HERE / "lens_curves.json").write_text(json.dumps(text, indent=1) + "\n")


main()
