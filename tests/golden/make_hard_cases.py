#!/usr/bin/env python3
"""Makes hard_cases.json: Fresnel, Snell, spheres, Planck and phase functions in the cases that are
hard in double precision, with fifty decimal digits. Needs `pip install mpmath`.

All inputs are doubles, written as they are and taken as exact. So a comparison shows only what the
program does with them.
"""

import json
import math
import pathlib

from mpmath import mp, mpf

mp.dps = 60


def text(value):
    return mp.nstr(value, 50)


def fresnel(cos, n_i, n_t):
    """Returns the reflectance of unpolarised light, and cosine and sine of the refracted ray.

    The cosine and the sine are 0 under total reflection.
    """
    c, n_i, n_t = mpf(cos), mpf(n_i), mpf(n_t)
    sine = mp.sqrt(1 - c * c) * n_i / n_t
    if sine > 1:
        return mpf(1), mpf(0), mpf(0)
    q = mp.sqrt(1 - sine * sine)
    s = (n_i * c - n_t * q) / (n_i * c + n_t * q)
    p = (n_t * c - n_i * q) / (n_t * c + n_i * q)
    return (s * s + p * p) / 2, q, sine


def interfaces():
    pairs = [(1.0, 1.5), (1.5, 1.0), (1.0, 4.0), (4.0, 1.0), (1.0, 1 + 1e-9), (1 + 1e-9, 1.0), (1.5, 1.5 + 1e-12)]
    pairs += [(1.5, 1.5 - 1e-12), (1.333, 2.4175), (2.4175, 1.333)]
    angles = [0.0, 1e-9, 1e-3, 10.0, 30.0, 45.0, 60.0, 80.0, 89.0, 89.9, 89.99, 89.9999, 89.9999999]
    rows = []
    for n_i, n_t in pairs:
        for angle in angles:
            cos = math.cos(math.radians(angle))
            if n_i <= n_t or cos * cos > 1.02 * (n_i - n_t) * (n_i + n_t) / n_i**2:
                rows.append([cos, n_i, n_t, *map(text, fresnel(cos, n_i, n_t))])
    return rows


def critical():
    rows = []
    for n_i, n_t in [(1.5, 1.0), (4.0, 1.0), (2.4175, 1.333), (1 + 1e-9, 1.0), (1.5 + 1e-12, 1.5)]:
        cos = math.sqrt((n_i - n_t) * (n_i + n_t)) / n_i
        for _ in range(8):
            cos = math.nextafter(cos, 0)
        for _ in range(17):
            rows.append([cos, n_i, n_t, *map(text, fresnel(cos, n_i, n_t))])
            cos = math.nextafter(cos, 1)
    return rows


def spheres():
    """Returns rays at a sphere about the origin, each with its first distance and the normal there.

    A ray starts at `distance` and aims at a share of the radius beside the middle.
    """
    rows = []
    for distance in [1.0, 1e3, 1e6]:
        for radius in [1e-6, 1e-3, 0.5]:
            for share in [0.0, 0.25, 0.5, 0.75, 0.9]:
                origin = [distance * 0.6, distance * 0.48, distance * 0.64]
                side = [0.8, -0.36, -0.48]
                way = [share * radius * s - o for s, o in zip(side, origin)]
                length = math.sqrt(sum(w * w for w in way))
                direction = [w / length for w in way]
                o, d = [mpf(x) for x in origin], [mpf(x) for x in direction]
                a = sum(x * x for x in d)
                b = sum(x * y for x, y in zip(o, d))
                c = sum(x * x for x in o) - mpf(radius) ** 2
                root = b * b - a * c
                if root > 0:
                    t = (-b - mp.sqrt(root)) / a
                    normal = [(x + t * y) / mpf(radius) for x, y in zip(o, d)]
                    rows.append([origin, direction, radius, text(t), [text(x) for x in normal]])
    return rows


def planck():
    h, c, k = mpf("6.62607015e-34"), mpf(299792458), mpf("1.380649e-23")
    rows = []
    for kelvin in [35.0, 60.0, 100.0, 1000.0, 5772.0, 1e5, 1e7, 1e9, 1e12, 1e15]:
        for nm in [360.0, 555.0, 830.0]:
            metres = mpf(nm) * mpf(10) ** -9
            value = 2 * h * c**2 / metres**5 / mp.expm1(h * c / (metres * k * mpf(kelvin)))
            if value > mpf("2.3e-308"):
                rows.append([nm, kelvin, text(value)])
    return rows


def henyey_greenstein():
    """Returns densities per steradian, and draws.

    A draw is 1 - cos of the angle below which a share u of the light goes.
    """
    gs = [0.0, 1e-6, -1e-6, 0.5, -0.9, 0.9999, -0.9999, 0.999999]
    densities, draws = [], []
    for g in gs:
        exact = mpf(g)
        for cos in [-1.0, -0.999999, -0.5, 0.0, 0.5, 0.999999, 1 - 2.0**-40, 1 - 2.0**-53, 1.0]:
            apart = 1 + exact**2 - 2 * exact * mpf(cos)
            densities.append([g, cos, text((1 - exact**2) / (4 * mp.pi * apart ** mpf("1.5")))])
        # Light is drawn from the peak on. The peak lies behind where g < 0.
        forward = abs(exact)
        for u in [0.0, 1e-12, 1e-3, 0.5, 0.999, 1 - 2.0**-53]:
            share = 1 - mpf(u)
            if forward == 0:
                cos = 2 * share - 1
            else:
                square = (1 - forward**2) / (1 - forward + 2 * forward * share)
                cos = (1 + forward**2 - square**2) / (2 * forward)
            draws.append([g, u, text(1 - cos)])
    return densities, draws


densities, draws = henyey_greenstein()
golden = {
    "method": "make_hard_cases.py: mpmath, 60 digits, 50 written",
    "interfaces": interfaces(),
    "critical": critical(),
    "spheres": spheres(),
    "planck": planck(),
    "phase_densities": densities,
    "phase_draws": draws,
}
lines = ["{", f' "method": {json.dumps(golden.pop("method"))},']
for name, rows in golden.items():
    lines += [f' "{name}": [', ",\n".join("  " + json.dumps(row) for row in rows), " ],"]
lines[-1] = " ]"
pathlib.Path(__file__).with_name("hard_cases.json").write_text("\n".join([*lines, "}"]) + "\n")
