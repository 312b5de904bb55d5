#!/usr/bin/env python3
"""Makes the golden colours: lamps, black bodies, monochromatic light, ColorChecker, metamers.

common.py states the sums. colour-science computes ΔE2000, Lab and its own rendering index; the
rest is written out here. Needs `pip install numpy scipy colour-science`.
"""

import json

import colour
import numpy as np
import scipy
from scipy.optimize import brentq, least_squares, nnls

import common
from common import CIE_1964, GRID, LUMENS_PER_WATT, Light, lamp, linear_srgb, xy

PROGRAMS = f"colour-science {colour.__version__}, numpy {np.__version__}, scipy {scipy.__version__}"
OHTA = "reflectance/colorchecker_ohta_5nm.csv"
D50_WHITE = lamp("D50").xyz()


SUMS = (
    "M1: grid 360..830 nm step 1 nm, plain sum (Δλ=1 nm). Lamp tables in illuminants/*.csv: linear "
    "interpolation, 0 outside. Reflectances: linear interpolation, end value held. Lines: CMF "
    "linearly interpolated at the line. CIE 1931 2° unless said. linear sRGB: matrix from "
    "IEC 61966-2-1 primaries and white xy (0.3127, 0.3290), full precision, unclipped, no transfer "
    "curve. Bradford: von Kries in the Bradford cone space. CCT/Duv: nearest point of the Planckian "
    "locus (c2 = 0.01438776877 m K) in CIE 1960 uv. CRI: CIE 13.3-1995 by plain 5 nm sums 380..780, "
    "TCS of reflectance/cie_tcs_5nm.csv, reference = Planck below 5000 K, else the D series of "
    "cie/d_series_basis_5nm.csv at the lamp's CCT (given only when |Duv|<0.05 and 1000 K<CCT<50000 K; "
    "also colour-science's own value, which interpolates otherwise). ΔE2000: colour-science, "
    "kL=kC=kH=1, Lab against the lamp white."
)


def head(method):
    return {"method": method, "generator": "make_colour.py", "programs": PROGRAMS}


def delta_e(lab_1, lab_2):
    return float(colour.delta_E(lab_1, lab_2, method="CIE 2000"))


def lab(xyz, white):
    """Returns CIE Lab against a white, both with the white's Y = 1."""
    return colour.XYZ_to_Lab(xyz / white[1], xy(white))


# Colour temperature and rendering


def black_body(kelvin):
    """Returns X, Y, Z of a black body and their derivatives by log T, on an arbitrary scale."""
    # Scaled by the exponential at 560 nm, so that nothing underflows.
    x = common.H * common.C / (GRID * 1e-9 * common.K * kelvin)
    at_560 = common.H * common.C / (560e-9 * common.K * kelvin)
    values = (560 / GRID) ** 5 * np.exp(at_560 - x) / -np.expm1(-x)
    return Light(values).xyz(), Light(values * x / -np.expm1(-x)).xyz()


def locus(kelvin):
    """Returns the Planckian locus in CIE 1960 uv and its derivative by log T."""
    xyz, slope = black_body(kelvin)
    scale = xyz @ [1, 15, 3]
    uv = common.uv1960(xyz)
    return uv, (np.array([4 * slope[0], 6 * slope[1]]) - uv * (slope @ [1, 15, 3])) / scale


def cct_duv(xyz):
    """Returns temperature and distance of the nearest point of the Planckian locus, or None."""
    uv = common.uv1960(xyz)
    kelvins = np.geomspace(500, 1e6, 400)
    nearest = int(np.argmin([np.hypot(*(locus(kelvin)[0] - uv)) for kelvin in kelvins]))
    if nearest in (0, len(kelvins) - 1):
        return None

    def along(log_kelvin):
        point, slope = locus(np.exp(log_kelvin))
        return slope @ (uv - point)

    ends = np.log(kelvins[[nearest - 1, nearest + 1]])
    kelvin = float(np.exp(brentq(along, *ends, xtol=1e-14, rtol=1e-14)))
    apart = uv - locus(kelvin)[0]
    duv = float(np.copysign(np.hypot(*apart), apart[1]))
    return (kelvin, duv) if abs(duv) < 0.05 else None


def daylight(kelvin, nm):
    """Returns the CIE daylight of a colour temperature."""
    if kelvin <= 7000:
        x = 0.244063 + 99.11 / kelvin + 2.9678e6 / kelvin**2 - 4.6070e9 / kelvin**3
    else:
        x = 0.237040 + 247.48 / kelvin + 1.9018e6 / kelvin**2 - 2.0064e9 / kelvin**3
    y = -3 * x**2 + 2.87 * x - 0.275
    scale = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / scale
    m2 = (0.03 - 31.4424 * x + 30.0717 * y) / scale
    basis = common.table("cie/d_series_basis_5nm.csv")
    s0, s1, s2 = [np.interp(nm, basis["wavelength_nm"], basis[key]) for key in ["S0", "S1", "S2"]]
    return s0 + m1 * s1 + m2 * s2


def rendering(light, kelvin):
    """Returns the indices R1 to R14 of CIE 13.3-1995 by sums every 5 nm from 380 to 780 nm."""
    nm = np.arange(380.0, 781.0, 5.0)
    bars = np.array([np.interp(nm, common.CIE_1931[0], bar) for bar in common.CIE_1931[1]])
    samples = list(common.reflectances("reflectance/cie_tcs_5nm.csv").values())
    test = np.interp(nm, GRID, light.values)
    reference = common.planck(nm, kelvin) if kelvin < 5000 else daylight(kelvin, nm)

    def colours(spectrum):
        """Returns uv of the light, and uv and Y of the samples under it."""
        spectrum = spectrum * 100 / (bars[1] @ spectrum)
        under = [bars @ (spectrum * sample(nm)) for sample in samples]
        return common.uv1960(bars @ spectrum), [(common.uv1960(xyz), xyz[1]) for xyz in under]

    def cd(uv):
        return np.array([4 - uv[0] - 10 * uv[1], 1.708 * uv[1] + 0.404 - 1.481 * uv[0]]) / uv[1]

    (white, of_test), (white_r, of_reference) = colours(test), colours(reference)

    def u_star(uv, y):
        w = 25 * np.cbrt(y) - 17
        return np.array([*(13 * w * (uv - white_r)), w])

    def adapted(uv):
        c, d = cd(uv) * cd(white_r) / cd(white)
        scale = 16.518 + 1.481 * c - d
        return np.array([10.872 + 0.404 * c - 4 * d, 5.520]) / scale

    apart = [
        np.linalg.norm(u_star(adapted(uv), y) - u_star(uv_r, y_r))
        for (uv, y), (uv_r, y_r) in zip(of_test, of_reference)
    ]
    return [float(100 - 4.6 * distance) for distance in apart]


def colour_science_ra(light):
    """Returns colour-science's own Ra, of samples every 5 nm from 380 to 780 nm."""
    samples = {nm: value for nm, value in zip(GRID, light.values) if 380 <= nm <= 780 and nm % 5 == 0}
    return float(colour.colour_rendering_index(colour.SpectralDistribution(samples)))


# Files


def look(light):
    """Returns what every light has: its colour in several forms."""
    xyz = light.xyz()
    of_unit = xyz / xyz[1]
    return {
        "XYZ_Y100": 100 * of_unit,
        "xy": xy(xyz),
        "uv1976": common.uv1960(xyz) * [1, 1.5],
        "linear_srgb_Y1": linear_srgb(of_unit),
        "linear_srgb_Y1_bradford_D50_to_D65": linear_srgb(common.bradford(of_unit, D50_WHITE)),
        "xy_10deg": xy(light.xyz(matching=CIE_1964)),
    }


def temperature(light):
    found = cct_duv(light.xyz())
    if found is None:
        return {"cct_meaningful": False}
    return {"cct_K": found[0], "duv": found[1], "cct_meaningful": 1000 < found[0] < 50000}


# The measured lamps that lamps.json leaves out.
LEFT_OUT = ["4-LED-2 (447/512/573/627)", "F40/C75 (Broadband FL)", "H38JA-100/DX (Mercury DX)", "MHC100/U/MP/3K"]
LEFT_OUT += ["SDW-T 100W/LV (Super HPS)"]


def names():
    """Returns the names of the lamps with a table and of the lamps of lines."""
    columns = lambda path: list(common.table(f"illuminants/{path}.csv"))[1:]
    tables = [name for path in ["cie_standard_1nm", "cie_C", "cie_fl", "cie_hp", "cie_led"] for name in columns(path)]
    tables += [f"lamp {name}" for name in columns("lamps_measured_5nm") if name not in LEFT_OUT]
    tables += ["LEDmodel_white", *common.SUNS, "SKY_zenith", "LEDmodel_R", "LEDmodel_G", "LEDmodel_B"]
    lines = ["LPS_D_thin", "LPS_D_equal", "LPS_mono", "HeNe_632.8", "Hg_medium_pressure", "Hg_NIST_intensities"]
    lines += ["Ne_NIST_intensities", "Ne_glow_580_725", "H_Balmer_NIST", "He_NIST_intensities"]
    lines += ["laser_RGB_638_520_450", "BT2020_primaries_630_532_467"]
    return tables, lines


def lamps():
    with_table, of_lines = names()
    tables, lines = {}, {}
    for name in with_table:
        light = lamp(name)
        tables[name] = {**look(light), **temperature(light)}
        if tables[name]["cct_meaningful"]:
            indices = rendering(light, tables[name]["cct_K"])
            tables[name]["cri_Ra"] = float(np.mean(indices[:8]))
            tables[name]["cri_R1_to_R14"] = indices
            tables[name]["cri_Ra_colour_science"] = colour_science_ra(light)
        tables[name]["raw_sum_XYZ"] = light.xyz()
    for name in of_lines:
        light = lamp(name)
        efficacy = LUMENS_PER_WATT * light.xyz()[1] / sum(power for _, power in light.lines)
        lines[name] = {**look(light), **temperature(light), "luminous_efficacy_lm_per_W": efficacy}
    return {**head(SUMS), **common.rounded({"illuminants": tables, "line_lamps": lines}, 10)}


def blackbody():
    kelvins = [1000, 1200, 1500, 1800, 2000, 2200, 2400, 2700, 2856, 3000, 3500, 4000, 4500, 5000, 5500]
    kelvins += [5772, 6000, 6500, 7000, 8000, 9000, 10000, 12000, 15000, 20000]
    rows = {}
    for kelvin in kelvins:
        light = Light(common.planck(GRID, kelvin) * 1e-9)
        visible = (GRID >= 380) & (GRID <= 780)
        stefan_boltzmann = 2 * np.pi**5 * common.K**4 / (15 * common.H**3 * common.C**2)
        rows[str(kelvin)] = {
            **look(light),
            "luminance_cd_m2": LUMENS_PER_WATT * light.xyz()[1],
            "radiance_380_780_W_m2_sr": light.values[visible].sum(),
            "peak_wavelength_nm": 2897771.955 / kelvin,
            "total_radiance_W_m2_sr": stefan_boltzmann * kelvin**4 / np.pi,
            "spectral_radiance_W_m3_sr": {
                str(nm): common.planck(float(nm), kelvin) for nm in range(400, 701, 50)
            },
        }
    method = SUMS + " Absolute: L_λ = 2hc²/λ⁵/(exp(hc/λkT)−1), Km = 683 lm/W."
    return {**head(method), "temperatures_K": common.rounded(rows, 10)}


def monochromatic():
    def row(nm):
        xyz = Light(lines=[(nm, 1.0)]).xyz()
        return {
            "wavelength_nm": nm,
            "xyz_bar": xyz,
            "xy": xy(xyz),
            "linear_srgb_for_Y_equal_ybar": linear_srgb(xyz),
            "lm_per_W": LUMENS_PER_WATT * xyz[1],
        }

    named = [404.6561, 435.8343, 486.1327, 546.074, 587.5618, 588.995, 589.2938, 589.3, 589.5924]
    named += [632.8, 656.2725]
    rows = {"rows": [row(float(nm)) for nm in range(360, 831, 5)], "named": [row(nm) for nm in named]}
    return {**head(SUMS), **common.rounded(rows, 10)}


def colorchecker():
    by_light = {}
    for name in ["A", "D50", "D65", "E", "FL2", "FL11", "HP1", "lamp HPS", "LED-B3", "LPS_mono", "LPS_D_thin"]:
        light = lamp(name)
        white, patches = light.xyz(), {}
        for patch, reflectance in common.reflectances(OHTA).items():
            xyz = light.xyz(reflectance) / white[1]
            patches[patch] = {
                "XYZ": 100 * xyz,
                "xy": xy(xyz),
                "linear_srgb_none": linear_srgb(xyz),
                "linear_srgb_bradford": linear_srgb(common.bradford(xyz, white)),
            }
        by_light[name] = {"white_XYZ": 100 * white / white[1], "patches": patches}
    method = SUMS + " Patches: reflectance/colorchecker_ohta_5nm.csv; Y of the light = 100."
    return {**head(method), "by_light": common.rounded(by_light, 9)}


def metamers():
    names = ["LEDmodel_R", "LEDmodel_G", "LEDmodel_B"]
    primaries = [lamp(name) for name in names]
    by_lamp = {}
    for name in ["HP1", "lamp HPS", "FL11", "A", "D65"]:
        light = lamp(name)
        white = light.xyz()
        weights = np.linalg.solve(np.array([primary.xyz() for primary in primaries]).T, white)
        mix = Light(sum(weight * primary.values for weight, primary in zip(weights, primaries)))
        patches = {}
        for patch, reflectance in common.reflectances(OHTA).items():
            pair = [light.xyz(reflectance), mix.xyz(reflectance)]
            labs = [lab(xyz, white) for xyz in pair]
            patches[patch] = {
                "XYZ_lamp": 100 * pair[0] / white[1],
                "XYZ_led": 100 * pair[1] / white[1],
                "Lab_lamp": labs[0],
                "Lab_led": labs[1],
                "deltaE2000": delta_e(*labs),
            }
        apart = [patch["deltaE2000"] for patch in patches.values()]
        by_lamp[name] = {
            "primaries": names,
            "weights": weights,
            "all_weights_positive": bool((weights > 0).all()),
            "xy": xy(white),
            "mean_deltaE2000": float(np.mean(apart)),
            "max_deltaE2000": max(apart),
            "patches": patches,
        }
    method = (
        SUMS + " The lamp and a mixture of LEDmodel_R/G/B with the same XYZ (weights multiply the "
        "tables of led_models_1nm.csv against the raw lamp table); patches Ohta."
    )
    return {**head(method), "by_lamp": common.rounded(by_lamp, 9)}


def sodium_match():
    """Matches the sodium doublet with two lines that cannot reach it, as near as they can."""
    light, primaries = lamp("LPS_D_thin"), [Light(lines=[(620.0, 1.0)]), Light(lines=[(550.0, 1.0)])]
    white = light.xyz()
    columns = np.array([primary.xyz() for primary in primaries]).T
    lengths = np.linalg.norm(columns, axis=0)
    weights = nnls(columns / lengths, white / white[1])[0] / lengths * white[1]
    mix = Light(lines=[(620.0, weights[0]), (550.0, weights[1])])
    mixed = mix.xyz()
    surfaces = {
        **common.reflectances(OHTA),
        **common.reflectances("reflectance/cie_tcs_5nm.csv"),
        **common.reflectances("reflectance/leaf_prospectD.csv"),
    }
    for name in [name for name in surfaces if name.endswith("transmittance")]:
        del surfaces[name]
    labs = [{name: lab(l.xyz(r), l.xyz()) for name, r in surfaces.items()} for l in (light, mix)]
    patches = list(common.reflectances(OHTA))
    split, names = [], list(surfaces)
    for i, first in enumerate(names):
        for second in names[i + 1 :]:
            apart = [delta_e(of[first], of[second]) for of in labs]
            if min(apart) <= 2 and max(apart) >= 5:
                split.append((max(apart) - min(apart), [first, second], apart))
    largest = max(split)
    found = {
        "weights": weights,
        "delta_xy": float(np.hypot(*(xy(mixed) - xy(white)))),
        "delta_y": mixed[1] / white[1] - 1,
        "delta_e_2000": delta_e(*[colour.XYZ_to_Lab(xyz / white[1], [0.3127, 0.3290]) for xyz in (white, mixed)]),
        "patches": {name: delta_e(labs[0][name], labs[1][name]) for name in patches},
        "pair_count": len(split),
        "largest_split": {"surfaces": largest[1], "delta_e_2000": largest[2]},
    }
    method = (
        "M1 as in metamers.json, with numpy, scipy.optimize.nnls (columns scaled to unit "
        "length, target to Y = 1) and colour-science's ΔE2000. The lamp: sodium doublet 588.995"
        " nm (power 2) and 589.5924 nm (power 1). The primaries: lines of power 1 at 620 nm and"
        " 550 nm. delta_e_2000 of the match: target at Y = 1 against mix on the same scale, Lab"
        " with white xy (0.3127, 0.3290). Patches (Ohta): Lab with each light's own white. "
        "Pairs: among ColorChecker (Ohta), TCS01-14 and the two leaf reflectances, ΔE2000 at "
        "most 2 under one light and at least 5 under the other."
    )
    return {**head(method), **common.rounded(found, 9)}


def rgb_to_spectrum():
    """Fits the sigmoid of Jakob and Hanika 2019 to colours under D65."""
    colours = [[1, 1, 1], [0.5, 0.5, 0.5], [0.18, 0.18, 0.18], [0.02, 0.02, 0.02], [0.8, 0.1, 0.1]]
    colours += [[0.1, 0.6, 0.1], [0.1, 0.15, 0.7], [0.7, 0.7, 0.1], [0.1, 0.6, 0.6], [0.6, 0.1, 0.6]]
    colours += [[0.45, 0.25, 0.15], [0.9, 0.5, 0.05]]
    light = lamp("D65")
    white = light.xyz()[1]

    def reflectance(coefficients, nm):
        x = np.polyval(coefficients, (nm - 360) / 470)
        return 0.5 + x / (2 * np.sqrt(1 + x * x))

    rows = []
    for rgb in colours:
        target = common.SRGB_TO_XYZ @ rgb
        residual = lambda c: light.xyz(lambda nm: reflectance(c, nm)) / white - target
        grey = (np.mean(rgb) - 0.5) * 2
        start = [0.0, 0.0, grey / np.sqrt(max(1 - grey * grey, 1e-3))]
        fit = least_squares(residual, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=5000, method="lm")
        rows.append(
            {
                "rgb_linear": rgb,
                "target_XYZ": target,
                "coeffs_c0_c1_c2": fit.x,
                "max_abs_XYZ_residual": float(np.abs(fit.fun).max()),
                "reflectance_at": {str(nm): reflectance(fit.x, nm) for nm in range(400, 701, 50)},
            }
        )
    method = (
        "Any uplift may be used; check: Σ R(λ) D65(λ) cmf / Σ D65 ȳ over M1 grid must give "
        "target_XYZ (white Y=1) within 5e-3. coeffs: Jakob–Hanika 2019 sigmoid fitted here to "
        "D65; t=(λ−360)/470. White (1,1,1) and saturated colours have large coefficients or a "
        "residual: test those by XYZ only."
    )
    return {**head(method), "under_D65": common.rounded(rows, 9)}


# The committed temperatures are the ends of a coarser search.
TEMPERATURES = {"*/cct_K": 1e-3, "*/duv": 1e-8, "*/cri_Ra": 1e-5, "*/cri_R1_to_R14/*": 1e-4}
# Many coefficients make a white within 1e-6.
WHITE = {
    "under_D65/0/coeffs_c0_c1_c2/*": np.inf,
    "under_D65/0/max_abs_XYZ_residual": 1e-8,
    "under_D65/0/reflectance_at/*": 2e-6,
}

if __name__ == "__main__":
    text = common.json_text
    common.main(
        {
            "lamps.json": (lambda: text(lamps()), json.loads, 1e-8, TEMPERATURES),
            "blackbody.json": (lambda: text(blackbody()), json.loads, 1e-8, {}),
            "monochromatic.json": (lambda: text(monochromatic()), json.loads, 1e-8, {}),
            "colorchecker.json": (lambda: text(colorchecker()), json.loads, 1e-8, {}),
            "metamers.json": (lambda: text(metamers()), json.loads, 1e-8, {}),
            "sodium_match.json": (lambda: text(sodium_match(), False), json.loads, 1e-8, {}),
            "rgb_to_spectrum.json": (lambda: text(rgb_to_spectrum()), json.loads, 1e-8, WHITE),
        }
    )
