#!/usr/bin/env python3
"""Makes the golden colours of the second regression set.

The spectra are those that `abbe regress --set 2 --export FOLDER` writes. The colour-matching
functions, Lab, the adaptation and the matrices are those of colour-science. Rec. 2020 is encoded by
the formula of ITU-R BT.2020 with its exact constants. Run `make_regress.py FOLDER/set.json`. Needs
`pip install numpy colour-science`.
"""

import json
import sys

import colour
import numpy as np

import common

OBSERVERS = {
    "": "CIE 1931 2 Degree Standard Observer",
    "_cie1964": "CIE 1964 10 Degree Standard Observer",
    "_cie2015_2": "CIE 2015 2 Degree Standard Observer",
    "_cie2015_10": "CIE 2015 10 Degree Standard Observer",
}
D65 = np.array([0.3127, 0.3290])


def bt2020(linear):
    alpha, beta = 1.09929682680944, 0.018053968510807
    return np.where(linear < beta, 4.5 * linear, alpha * np.abs(linear) ** 0.45 - (alpha - 1))


def sums(case, spectra, nm, observer):
    """Returns XYZ of a sample and of its light."""
    cmfs = colour.MSDS_CMFS[observer]
    bars = np.stack([np.interp(nm, cmfs.wavelengths, cmfs.values[:, i], 0, 0) for i in range(3)], axis=-1)
    bar = lambda at: np.array([np.interp(at, nm, bars[:, i]) for i in range(3)])
    light, reflectance = spectra[case["light"]], np.array(spectra[case["reflectance"]]["values"])
    values = np.array(light["values"])
    excitation = np.array(spectra[case["excitation"]]["values"]) if "excitation" in case else np.zeros_like(nm)
    sample, white, excited = (values * reflectance) @ bars, values @ bars, values @ excitation
    for line in light["lines"]:
        at, power = line["nm"], line["power"]
        sample = sample + power * np.interp(at, nm, reflectance) * bar(at)
        white = white + power * bar(at)
        excited += power * np.interp(at, nm, excitation)
    if "emission" in case:
        sample = sample + excited * (np.array(spectra[case["emission"]]["values"]) @ bars)
    return 100 * sample / white[1], 100 * white / white[1]


def forms(case, spectra, nm):
    """Returns the colour of a case in all forms, in the order of expected.csv."""
    found = {f"xyz{end}": sums(case, spectra, nm, observer) for end, observer in OBSERVERS.items()}
    xyz, white = found["xyz"]
    encode = colour.models.eotf_inverse_sRGB
    clip = lambda linear: np.clip(linear, 0, 1)
    result = {name: sample for name, (sample, _) in found.items()}
    for key, name in {"srgb": "sRGB", "display_p3": "Display P3", "rec2020": "ITU-R BT.2020"}.items():
        space = colour.RGB_COLOURSPACES[name].copy()
        space.use_derived_transformation_matrices(True)
        linear = xyz / 100 @ space.matrix_XYZ_to_RGB.T
        result[f"linear_{key}"] = linear
        result[key] = bt2020(clip(linear)) if key == "rec2020" else encode(clip(linear))
    adapt = colour.adaptation.matrix_chromatic_adaptation_VonKries
    d65 = 100 * colour.xy_to_XYZ(D65)
    aces = colour.RGB_COLOURSPACES["ACEScg"].copy()
    aces.use_derived_transformation_matrices(True)
    to_aces = adapt(d65, 100 * colour.xy_to_XYZ(aces.whitepoint), transform="Bradford")
    result["acescg"] = aces.matrix_XYZ_to_RGB @ to_aces @ xyz / 100
    result["lab"] = colour.XYZ_to_Lab(xyz / 100, colour.XYZ_to_xy(white))
    result["xyz_bradford"] = adapt(white, d65, transform="Bradford") @ xyz
    result["xyz_cat16"] = adapt(white, d65, transform="CAT16") @ xyz
    order = ["xyz", "linear_srgb", "srgb", "linear_display_p3", "display_p3", "linear_rec2020", "rec2020", "acescg"]
    order += ["xyz_cie1964", "xyz_cie2015_2", "xyz_cie2015_10", "lab", "xyz_bradford", "xyz_cat16"]
    return np.concatenate([result[form] for form in order])


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        content = json.load(file)
    spectra = {spectrum["name"]: spectrum for spectrum in content["spectra"]}
    nm = np.array(content["nm"])
    rows = [[case["id"], *(f"{value:.8g}" for value in forms(case, spectra, nm))] for case in content["cases"]]
    text = "\n".join(",".join(row) for row in rows) + "\n"
    (common.HERE / "regress_2.csv").write_text(text, encoding="utf-8")


main()
