"""Writes rendition.json: Rf, Rg and the hue bins of TM-30, from colour-science.

python3 -m venv venv && venv/bin/pip install colour-science && venv/bin/python make_rendition.py

Lights of `data/` keep the step of their table: 5 nm or 1 nm. D50, D55, D65, D75 and E are linear
between multiples of 5 nm, so they are taken every 5 nm. Black bodies are taken every 1 nm. The
spectral lines are samples of a table with steps of 1 nm.
"""

import csv
import json
import re
import warnings

import colour
import numpy as np
from colour.quality import colour_fidelity_index_ANSIIESTM3018
from common import C, DATA, H, HERE, K, table

warnings.filterwarnings("ignore")

FILES = {
    "illuminants/cie_standard_1nm.csv": {"A": 1, "D50": 5, "D55": 5, "D65": 5, "D75": 5, "E": 5},
    "illuminants/cie_C.csv": None,
    "illuminants/cie_fl.csv": None,
    "illuminants/cie_hp.csv": None,
    "illuminants/cie_led.csv": None,
    "illuminants/lamps_measured_5nm.csv": None,
    "illuminants/led_models_1nm.csv": {"LEDmodel_white": 1},
}
BLACK_BODIES_K = [1300, 2000, 2700, 4200, 4500, 4800]
LINES = {
    "638, 532, 457 nm": {638: 1.6, 532: 1.0, 457: 0.7},
    "612, 543, 447 nm": {612: 1.6, 543: 1.0, 447: 0.9},
    "638, 520, 450 nm": {638: 1.0, 520: 1.0, 450: 0.8},
}
# Lights whose samples are stored too.
WITH_SAMPLES = ["FL2", "HP5", "LED-RGB1"]
# Abbe defines the rendition within these limits.
LARGEST_DUV, RANGE_K = 0.049, (1200, 25000)


def rendition(name, nm, values):
    """Returns the values of a light, or None if it is out of the limits."""
    inside = (nm >= 380) & (nm <= 780)
    light = colour.SpectralDistribution(values[inside], nm[inside])
    found = colour_fidelity_index_ANSIIESTM3018(light, additional_data=True)
    if abs(found.D_uv) > LARGEST_DUV or not RANGE_K[0] < found.CCT < RANGE_K[1]:
        return None
    rounded = lambda values, digits: np.round(np.asarray(values, dtype=float), digits).tolist()
    known = {
        "rf": round(float(found.R_f), 4),
        "rg": round(float(found.R_g), 4),
        "rf_bins": rounded(found.R_fs, 3),
        "chroma_shift_percent": rounded(found.R_cs, 3),
        "hue_shift": rounded(found.R_hs, 5),
    }
    if name in WITH_SAMPLES:
        known["samples"] = rounded(found.R_s, 3)
    return known


def library_lights():
    """Returns the names of lights of the library with their wavelengths and values."""
    with open(DATA / "library.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        if row["file"] not in FILES:
            continue
        steps = FILES[row["file"]]
        if steps is not None and row["column"] not in steps:
            continue
        columns = table(row["file"])
        step = 1 if steps is None else steps[row["column"]]
        nm, values = columns["wavelength_nm"], columns[row["column"]]
        if steps is not None:
            chosen = nm % step == 0
            nm, values = nm[chosen], values[chosen]
        yield row["name"], nm, values


def main():
    nm = np.arange(380.0, 781.0)
    lights = {name: rendition(name, nm, values) for name, nm, values in library_lights()}
    planck = lambda kelvin: 1.0 / (nm * 1e-9) ** 5 / np.expm1(H * C / (nm * 1e-9 * K * kelvin))
    bodies = {str(kelvin): rendition("", nm, planck(kelvin)) for kelvin in BLACK_BODIES_K}
    lines = {
        name: {"powers": powers, **rendition("", nm, np.array([powers.get(int(at), 0.0) for at in nm]))}
        for name, powers in LINES.items()
    }
    result = {
        "method": "colour_fidelity_index_ANSIIESTM3018 of colour-science: sums of 380..780 nm in the step of the light "
        "(5 nm or 1 nm), CES of 5 nm or 1 nm, CCT by Ohno 2013. Lights farther than 0.049 from the Planckian locus, or "
        "outside 1200..25000 K, are left out.",
        "generator": "make_rendition.py",
        "programs": f"colour-science {colour.__version__}, numpy {np.__version__}",
        "library": {name: known for name, known in lights.items() if known},
        "blackbodies_K": bodies,
        "lines": lines,
    }
    text = json.dumps(result, indent=1)
    # Lists of numbers are on one line.

    text = re.sub(r"\[\s+([^\]]*?)\s+\]", lambda match: "[" + re.sub(r"\s+", " ", match[1]) + "]", text)
    (HERE / "rendition.json").write_text(text + "\n", encoding="utf-8")


main()
