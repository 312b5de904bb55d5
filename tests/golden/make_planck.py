#!/usr/bin/env python3
"""Makes planck.json: Planck's law with sixty decimal digits, from 50 K to 10 million K.

The spectral radiance is 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1) in W m^-2 sr^-1 m^-1,
with the exact constants of the SI of 2019. Radiances below the least normal double (2.2e-308) are
written as they are and read as the nearest double. Needs `pip install mpmath`.
"""

import json
import pathlib

from mpmath import mp, mpf

mp.dps = 60
H, C, K = mpf("6.62607015e-34"), mpf(299792458), mpf("1.380649e-23")

TEMPERATURES_K = ["50", "75", "100", "200", "300", "700", "1000", "1667", "2855.5", "4000", "5000", "6503.6", "1e4"]
TEMPERATURES_K += ["20000", "1e5", "31415.9", "1e6", "3e6", "1e7"]
WAVELENGTHS_NM = ["360", "400.25", "486.1327", "555.5", "587.5618", "656.2725", "700", "780", "830"]


def planck(nm, kelvin):
    metres = mpf(nm) * mpf(10) ** -9
    return 2 * H * C**2 / metres**5 / mp.expm1(H * C / (metres * K * mpf(kelvin)))


rows = [
    [float(kelvin), float(nm), mp.nstr(planck(nm, kelvin), 20)] for kelvin in TEMPERATURES_K for nm in WAVELENGTHS_NM
]
golden = {
    "method": "make_planck.py: mpmath, 60 digits, exact SI constants",
    "columns": ["temperature_K", "wavelength_nm", "radiance_W_per_m2_sr_m"],
    "rows": rows,
}
text = json.dumps(golden, indent=1)
# One row a line.
text = text.replace("[\n   ", "[").replace(",\n   ", ", ").replace("\n  ]", "]")
pathlib.Path(__file__).with_name("planck.json").write_text(text + "\n")
