#!/usr/bin/env python3
"""Makes the golden optics: glasses, Fresnel, prisms, simple lenses, the rainbow, metals.

Indices come from the dispersion formulas of data/glass/glasses.json, also beyond their ranges, and
from data/metals/metals_nk.csv. The air outside has n = 1. Needs `pip install numpy`.
"""

import cmath
import json
import math

import numpy as np

import common
from common import index

PROGRAMS = f"numpy {np.__version__}"
GLASSES = common.glasses()
LINES_NM = {"h": 404.6561, "g": 435.8343, "F": 486.1327, "e": 546.074}
LINES_NM |= {"d": 587.5618, "D": 589.2938, "C": 656.2725, "r": 706.5188}
# The lines and the helium-neon laser.
WAVELENGTHS_NM = sorted([*LINES_NM.values(), 632.8])


def head(method):
    return {"method": method, "generator": "make_optics.py", "programs": PROGRAMS}


def glass_text():
    """Returns indices, Abbe numbers and internal transmittances, one glass a line."""
    method = (
        "n at the Fraunhofer lines, V_d and internal transmittance of the catalogue, computed "
        "in Python from the dispersion formulas and k of the refractiveindex.info database "
        "(CC0)"
    )
    rows = []
    for name, entry in GLASSES.items():
        first, last = entry["range_nm"]
        n = {line: index(entry, nm) for line, nm in LINES_NM.items() if first <= nm <= last}
        row = {"name": name, "n": common.rounded(n, 11)}
        # A gas and a formula that starts within the band have no Abbe number.
        if {"F", "d", "C"} <= n.keys() and entry["kind"] != "gas":
            row["vd"] = common.rounded((n["d"] - 1) / (n["F"] - n["C"]), 11)
        if "extinction" in entry:
            nm, k = np.array(entry["extinction"]["nm"], float), np.array(entry["extinction"]["k"])
            tau = lambda mm: common.rounded(np.exp(-4 * np.pi * k * mm * 1e6 / nm), 6)
            row["transmittance"] = {"nm": list(nm), "tau_10mm": tau(10), "tau_25mm": tau(25)}
        rows.append(row)
    dump = lambda value: json.dumps(value, ensure_ascii=False)
    top = ",\n".join(f"{dump(key)}: {dump(value)}" for key, value in head(method).items())
    lines = ",\n".join(map(dump, rows))
    return f'{{{top},\n"lines_nm": {dump(LINES_NM)},\n"glasses": [\n{lines}\n]}}\n'


def reflectances(n1, n2, angle_deg):
    """Returns the power reflectances for s and p at an interface, n2 complex."""
    sine = math.sin(math.radians(angle_deg))
    cos_1 = math.cos(math.radians(angle_deg))
    cos_2 = cmath.sqrt(1 - (n1 * sine / n2) ** 2)
    if n2.imag == 0 and n1 * sine >= n2.real:
        return 1.0, 1.0
    s = (n1 * cos_1 - n2 * cos_2) / (n1 * cos_1 + n2 * cos_2)
    p = (n2 * cos_1 - n1 * cos_2) / (n2 * cos_1 + n1 * cos_2)
    return abs(s) ** 2, abs(p) ** 2


def fresnel():
    method = (
        "power reflectances for s and p polarisation; n2 = n + i k linearly interpolated from "
        "metals_nk.csv for metals; unpolarised = mean. Beyond the critical angle R = 1 exactly."
    )
    n_d = lambda name: index(GLASSES[name], LINES_NM["d"])
    bk7, sf11, water = n_d("N-BK7"), n_d("N-SF11"), n_d("water 20C")
    pairs = [
        ("air to N-BK7 d", 1.0, bk7),
        ("N-BK7 d to air", bk7, 1.0),
        ("air to 1.5", 1.0, 1.5),
        ("1.5 to air", 1.5, 1.0),
        ("air to water d", 1.0, water),
        ("water d to air", water, 1.0),
        ("air to N-SF11 d", 1.0, sf11),
        ("N-SF11 d to N-BK7 d", sf11, bk7),
        ("air to diamond d", 1.0, n_d("diamond")),
    ]
    tables = common.metals()
    for metal in ["Au", "Ag", "Cu", "Al", "Fe"]:
        for nm in [450, 550, 650]:
            n, k = metal_index(tables[metal], nm)
            pairs.append((f"air to {metal} {nm} nm", 1.0, complex(n, k)))
    angles = [0, 10, 20, 30, 40, 45, 50, 55, 56.31, 60, 65, 70, 75, 80, 85, 88, 89, 89.5, 89.9, 89.99, 89.999]
    cases = []
    for name, n1, n2 in pairs:
        powers = [reflectances(n1, complex(n2), angle) for angle in angles]
        parts = [complex(n2).real, complex(n2).imag]
        case = {"case": name, "n1": n1, "n2": parts, "angle_deg": angles}
        case |= {"Rs": [s for s, _ in powers], "Rp": [p for _, p in powers]}
        cases.append(case)
    return {**head(method), "cases": common.rounded(cases, 12)}


def arcsine(sine):
    """Returns an angle in degrees, or None where there is none."""
    return math.degrees(math.asin(sine)) if abs(sine) <= 1 else None


def deviation(n, apex, incidence):
    """Returns the deviation by a prism in degrees, or None where the second face reflects all."""
    inside = apex - arcsine(math.sin(math.radians(incidence)) / n)
    leaving = arcsine(n * math.sin(math.radians(inside)))
    return None if leaving is None else incidence + leaving - apex


def prism():
    method = (
        "δ = i1 + i2 − A, Snell at both faces in the principal section, n from glasses.json "
        "dispersion formula, outside n=1; null = total internal reflection at face 2. "
        "tir_below_incidence: smallest i1 (towards the base side, signed) that still leaves "
        "through face 2."
    )
    five = ["N-BK7", "N-SF11", "SF10", "F2", "fused silica"]
    plans = {
        60.0: ([*five, "diamond", "water 20C"], [30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 89]),
        30.0: (five, [0, 10, 20, 30, 45, 60]),
    }
    golden = head(method)
    for apex, (names, incidences) in plans.items():
        glasses = {}
        for name in names:
            rows = []
            for nm in WAVELENGTHS_NM:
                n = index(GLASSES[name], nm)
                least = arcsine(n * math.sin(math.radians(apex / 2)))
                critical = arcsine(1 / n)
                rows.append(
                    {
                        "wavelength_nm": nm,
                        "n": n,
                        "deviation_deg": {str(i): deviation(n, apex, i) for i in incidences},
                        "minimum": least
                        and {"min_deviation_deg": 2 * least - apex, "incidence_deg": least},
                        "tir_below_incidence_deg": arcsine(n * math.sin(math.radians(apex - critical))),
                        "critical_angle_deg": critical,
                        "brewster_angle_deg": math.degrees(math.atan(n)),
                    }
                )
            glasses[name] = {"apex_deg": apex, "rows": common.rounded(rows, 10)}
        golden[f"apex{apex:.0f}"] = glasses
    return golden


def rainbow():
    method = (
        "geometric stationary angles, n(λ) of 'water 20C' (Daimon & Masumura), outside n=1: "
        "cos i = sqrt((n²−1)/3) and sqrt((n²−1)/8); radius from the antisolar point; point sun."
    )

    def bow(n, reflections):
        """Returns the least deviation after this many reflections inside, and its incidence."""
        cosine = math.sqrt((n * n - 1) / (reflections * (reflections + 2)))
        incidence = math.acos(cosine)
        refracted = math.asin(math.sin(incidence) / n)
        turned = 2 * (incidence - refracted) + reflections * (math.pi - 2 * refracted)
        return math.degrees(turned), math.degrees(incidence)

    rows = []
    for nm in range(380, 781, 10):
        n = index(GLASSES["water 20C"], nm)
        (first, first_incidence), (second, second_incidence) = bow(n, 1), bow(n, 2)
        row = {"wavelength_nm": nm, "n": n}
        row |= {"primary_deg": 180 - first, "primary_incidence_deg": first_incidence}
        row |= {"secondary_deg": second - 180, "secondary_incidence_deg": second_incidence}
        rows.append(row)
    return {**head(method), "rows": common.rounded(rows, 10)}


def simple_lenses():
    method = (
        "thin: 1/f=(n−1)(1/R1−1/R2); thick: lensmaker with thickness; ball: EFL=nD/(4(n−1)), "
        "BFL=EFL−D/2"
    )
    r1, r2, thick, ball = 100.0, -100.0, 8.0, 10.0
    by_glass = {}
    names = ["N-BK7", "N-SF11", "F2", "fused silica", "N-FK51A", "N-LASF9", "sapphire (o)", "PMMA"]
    for name in names:
        rows = []
        for nm in WAVELENGTHS_NM:
            n = index(GLASSES[name], nm)
            power = (n - 1) * (1 / r1 - 1 / r2 + (n - 1) * thick / (n * r1 * r2))
            row = {"wavelength_nm": nm, "n": n, "thin_f": 1 / ((n - 1) * (1 / r1 - 1 / r2))}
            row |= {"thick_f": 1 / power, "thick_bfd": (1 - (n - 1) * thick / (n * r1)) / power}
            ball_efl = n * ball / (4 * (n - 1))
            row |= {"ball_efl": ball_efl, "ball_bfl": ball_efl - ball / 2}
            rows.append(row)
        by_glass[name] = common.rounded(rows, 10)
    sizes = {"R1": r1, "R2": r2, "thickness": thick, "ball_diameter": ball}
    return {**head(method), **sizes, "by_glass": by_glass}


def metal_index(metal, nm):
    """Returns n and k, linear between the samples."""
    return [np.interp(nm, metal[0], values) for values in metal[1:]]


def metals():
    method = "normal-incidence reflectance; colour under D65 (M1), Y of white = 1"
    light, rows, colours = common.lamp("D65"), [], {}
    normal = lambda n, k: ((n - 1) ** 2 + k * k) / ((n + 1) ** 2 + k * k)
    for name, metal in common.metals().items():
        for nm in range(400, 701, 50):
            n, k = metal_index(metal, nm)
            row = {"metal": name, "wavelength_nm": nm, "n": n, "k": k, "R_normal": normal(n, k)}
            rows.append(row)
        xyz = light.xyz(lambda nm: normal(*metal_index(metal, nm))) / light.xyz()[1]
        colours[name] = {"XYZ": xyz, "linear_srgb": common.linear_srgb(xyz)}
    found = {"normal_reflectance": rows, "colour_under_D65": colours}
    return {**head(method), **common.rounded(found, 10)}


if __name__ == "__main__":
    text = common.json_text
    common.main(
        {
            "glass.json": (glass_text, json.loads, 1e-9, {}),
            "fresnel.json": (lambda: text(fresnel()), json.loads, 1e-9, {}),
            "prism.json": (lambda: text(prism()), json.loads, 1e-9, {}),
            "rainbow.json": (lambda: text(rainbow()), json.loads, 1e-9, {}),
            "simple_lenses.json": (lambda: text(simple_lenses()), json.loads, 1e-9, {}),
            "metals.json": (lambda: text(metals()), json.loads, 1e-9, {}),
        }
    )
