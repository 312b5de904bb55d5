"""What the generators of this folder share: tables, colour sums, indices, writing and comparing.

Every sum runs over 360, 361, ... 830 nm and counts each sample once (1 nm each). Between samples
of a table everything is linear. Beyond its ends a lamp is 0, and a reflectance or an index keeps
its end value. A spectral line uses the colour-matching functions interpolated at its wavelength.
"""

import csv
import fnmatch
import json
import math
import pathlib
import re
import sys

import numpy as np

HERE = pathlib.Path(__file__).parent
DATA = HERE.parent.parent / "data"
GRID = np.arange(360.0, 831.0)

# The exact constants of the SI of 2019.
H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
LUMENS_PER_WATT = 683.0


# Tables


def table(path):
    """Reads a table of numbers. Returns its columns by name; the first is the wavelength in nm."""
    with open(DATA / path, encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    number = lambda cell: float(cell) if re.fullmatch(r"[-+.\deE]+", cell) else math.nan
    columns = zip(*[[number(cell) for cell in row] for row in rows])
    return {name: np.array(column) for name, column in zip(header, columns)}


def column(path, name, outside=None):
    """Returns a column on the grid. `outside` is the value beyond the ends, None holds the ends."""
    columns = table(path)
    return np.interp(GRID, columns["wavelength_nm"], columns[name], left=outside, right=outside)


def observer(name):
    """Returns the wavelengths and the three colour-matching functions of a table in data/cie."""
    columns = list(table(f"cie/{name}.csv").values())
    return columns[0], np.array(columns[1:4])


CIE_1931 = observer("cie1931_2deg_1nm")
CIE_1964 = observer("cie1964_10deg_1nm")


class Light:
    """A lamp: a spectrum on the grid and, or, spectral lines as pairs of nm and power."""

    def __init__(self, values=None, lines=()):
        self.values = np.zeros(len(GRID)) if values is None else values
        self.lines = list(lines)

    def xyz(self, reflectance=None, matching=CIE_1931):
        """Returns the sums X, Y, Z. The reflectance is a function of the wavelength in nm."""
        nm, bars = matching
        on_grid = np.array([np.interp(GRID, nm, bar) for bar in bars])
        total = on_grid @ (self.values * (1.0 if reflectance is None else reflectance(GRID)))
        for line_nm, power in self.lines:
            share = 1.0 if reflectance is None else reflectance(line_nm)
            total = total + power * share * np.array([np.interp(line_nm, nm, bar) for bar in bars])
        return total


MEASURED = "illuminants/lamps_measured_5nm.csv"
SUNS = {
    "SUN_AM0": "extraterrestrial_W_m2_nm",
    "SUN_AM15G": "global_tilt_W_m2_nm",
    "SUN_AM15D": "direct_circumsolar_W_m2_nm",
}


def lamp(name):
    """Returns a lamp with a table by its name in the golden files."""
    if name.startswith("lamp "):
        return Light(column(MEASURED, name.removeprefix("lamp "), 0.0))
    if name in SUNS:
        return Light(column("illuminants/solar_astm_g173.csv", SUNS[name], 0.0))
    if name == "SKY_zenith":
        path = "reflectance/sky_zenith_single_scatter.csv"
        return Light(column(path, "radiance_W_m2_sr_nm", 0.0))
    for file in ["cie_standard_1nm", "cie_C", "cie_fl", "cie_hp", "cie_led", "led_models_1nm"]:
        path = f"illuminants/{file}.csv"
        if name in table(path):
            return Light(column(path, name, 0.0))
    return line_lamp(name)


def line_lamp(name):
    """Returns a lamp of spectral lines."""
    with open(DATA / "illuminants/lines.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["lamp"] == name]
    return Light(lines=[(float(row["nm"]), float(row["power"])) for row in rows])


def reflectances(path):
    """Returns the reflectances of a table as functions of the wavelength in nm."""
    columns = table(path)
    nm = columns.pop("wavelength_nm")
    return {name: lambda at, values=values: np.interp(at, nm, values) for name, values in columns.items()}


# Colour


def srgb_matrix():
    """Returns the matrix from linear sRGB to XYZ, from the primaries and the white of IEC 61966-2-1."""
    primaries = np.array([[x / y, 1, (1 - x - y) / y] for x, y in [(0.64, 0.33), (0.3, 0.6), (0.15, 0.06)]])
    return primaries.T * np.linalg.solve(primaries.T, SRGB_WHITE)


SRGB_WHITE = np.array([0.3127 / 0.3290, 1.0, (1 - 0.3127 - 0.3290) / 0.3290])
SRGB_TO_XYZ = srgb_matrix()
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def linear_srgb(xyz):
    """Returns linear sRGB, unclipped."""
    return np.linalg.solve(SRGB_TO_XYZ, xyz)


def bradford(xyz, white_from, white_to=SRGB_WHITE):
    """Adapts a colour to another white. Only the colour of the whites counts, not their Y."""
    gain = (BRADFORD @ (white_to / white_to[1])) / (BRADFORD @ (white_from / white_from[1]))
    return np.linalg.solve(BRADFORD, gain * (BRADFORD @ xyz))


def xy(xyz):
    return xyz[:2] / xyz.sum()


def uv1960(xyz):
    return np.array([4 * xyz[0], 6 * xyz[1]]) / (xyz @ [1, 15, 3])


def planck(nm, kelvin):
    """Returns the spectral radiance of a black body in W m^-2 sr^-1 m^-1."""
    metres = nm * 1e-9
    return 2 * H * C**2 / metres**5 / np.expm1(H * C / (metres * K * kelvin))


# Refractive indices


def glasses():
    """Returns the entries of the glass catalogue by name, in its order."""
    text = (DATA / "glass/glasses.json").read_text(encoding="utf-8")
    return {entry["name"]: entry for entry in json.loads(text)["glasses"]}


def index(entry, nm):
    """Returns the refractive index of a glass by the formula in its entry, also beyond its range."""
    ((kind, given),) = entry["dispersion"].items()
    um2 = (nm / 1000) ** 2
    if kind == "sellmeier":
        terms = [b * um2 / (um2 - c) for b, c in zip(given["b"], given["c_um2"])]
        return math.sqrt(1 + given["c0"] + sum(terms))
    if kind in ("power_series_n2", "power_series_n"):
        total = given["c0"] + sum(c * um2 ** (p / 2) for c, p in zip(given["c"], given["p"]))
        return math.sqrt(total) if kind == "power_series_n2" else total
    if kind == "rii_formula4":
        c, um = [0, *given], nm / 1000
        first = c[2] * um ** c[3] / (um2 - c[4] ** c[5])
        return math.sqrt(c[1] + first + c[6] * um ** c[7] / (um2 - c[8] ** c[9]))
    if kind == "gas":
        terms = [b / (c - 1 / um2) for b, c in zip(given["b"], given["c_per_um2"])]
        return 1 + given["c0"] + sum(terms)
    return float(np.interp(nm, given["nm"], given["n"]))


def metals():
    """Returns wavelengths, n and k of each metal by its symbol."""
    with open(DATA / "metals/metals_nk.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = dict.fromkeys(row["metal"] for row in rows)
    number = lambda name, key: np.array([float(row[key]) for row in rows if row["metal"] == name])
    return {name: [number(name, key) for key in ["wavelength_nm", "n", "k"]] for name in names}


# Writing and comparing


def rounded(value, digits):
    """Rounds the floats of a structure to significant digits. Whole numbers stay as they are."""
    if isinstance(value, dict):
        return {key: rounded(item, digits) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [rounded(item, digits) for item in value]
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.{digits}g}")
    return value


def json_text(golden, lists_on_one_line=True):
    """Returns JSON with an indent of one. Lists of numbers fill one line each if asked."""
    text = json.dumps(golden, indent=1, ensure_ascii=False)
    if lists_on_one_line:
        one_line = lambda match: "[" + re.sub(r"\s*\n\s*", " ", match[1]) + "]"
        text = re.sub(r"\[\s+([^\[\]{}\"]*?)\s+\]", one_line, text)
    return text + "\n"


def leaves(value, path=()):
    """Walks a structure. Yields the path and the value of every leaf."""
    if isinstance(value, (dict, list)):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(item, (*path, key))
    else:
        yield path, value


def quantity(path):
    """Returns the last key that is a word: what the leaf measures."""
    words = [key for key in path if isinstance(key, str) and not re.fullmatch(r"[-.\d]+", key)]
    return words[-1] if words else ""


def compare(name, made, committed, tolerance, bounds):
    """Prints the largest difference of each quantity. Returns whether all are within bounds.

    A number passes within `tolerance` of the committed one, relative, or within 1e-9, absolute.
    `bounds` gives larger absolute bounds for paths, which the README explains. The printed
    relative difference leaves out numbers below 1e-9, which stand for 0.
    """
    made, committed = dict(leaves(made)), dict(leaves(committed))
    wrong, worst = made.keys() ^ committed.keys(), {}
    for place in sorted({"/".join(map(str, path[:2])) for path in wrong}):
        print(f"{name}: {place}: keys differ")
    for path, old in committed.items():
        new, key = made.get(path), quantity(path)
        if type(old) in (int, float) and type(new) in (int, float):
            apart = abs(new - old)
            relative, absolute = worst.get(key, (0.0, 0.0))
            share = apart / abs(old) if abs(old) > 1e-9 else 0.0
            worst[key] = (max(relative, share), max(absolute, apart))
            where = "/".join(map(str, path))
            larger = [bound for pattern, bound in bounds.items() if fnmatch.fnmatch(where, pattern)]
            if not apart <= max([tolerance * abs(old), 1e-9, *larger]):
                wrong.add(path)
        elif new != old and path[0] != "programs":
            where = "/".join(map(str, path))
            print(f"{name}: {where} is {new}, not {old}")
            wrong.add(path)
    for key, (relative, absolute) in worst.items():
        verdict = "DIFFERS" if key in map(quantity, wrong) else "ok"
        print(f"{name}: {key}: relative {relative:.1e}, absolute {absolute:.1e}: {verdict}")
    return not wrong


def main(files):
    """Writes the files, or compares them with the committed ones if the argument is --check.

    `files` maps a name to (function that makes the text, parser of the text, tolerance, bounds).
    """
    fine = True
    for name, (make, parse, tolerance, bounds) in files.items():
        text, path = make(), HERE / name
        if sys.argv[1:] == ["--check"]:
            committed = parse(path.read_text(encoding="utf-8"))
            fine &= compare(name, parse(text), committed, tolerance, bounds)
        else:
            path.write_text(text, encoding="utf-8")
    sys.exit(0 if fine else 1)
