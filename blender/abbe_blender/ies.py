# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the distributions of Blender's lights as IES files. This module does not need Blender."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

#: The number of angles between the axis and the edge of the light.
_STEPS = 256


def write(path: Path, edge: float, intensity: Callable[[float], float], size: tuple[float, float], round: bool) -> None:
    """Writes a light around an axis.

    `intensity` returns the intensity (cd) at an angle (rad) up to `edge`, beyond which it is dark.
    `size` is the size (m) of the opening along the directions C0 and C90.
    """
    angles = [edge * step / _STEPS for step in range(_STEPS + 1)]
    table = [(math.degrees(angle), max(0.0, intensity(angle))) for angle in angles]
    if edge < 0.5 * math.pi - 1e-6:
        dark = [min(90.0, table[-1][0] + 1e-3), 90.0]
        table += [(angle, 0.0) for angle in sorted(set(dark))]
    else:
        table[-1] = (90.0, table[-1][1])
    along, across = ((-length if round else length) for length in size)
    lines = ["IESNA:LM-63-2002", "[TEST] light of Blender", "TILT=NONE"]
    lines += [f"1 -1 1 {len(table)} 1 1 2 {across:.9g} {along:.9g} 0", "1 1 0"]
    lines += [f"{angle:.9g}" for angle, _ in table] + ["0"] + [f"{value:.9g}" for _, value in table]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def spread(power: float, angle: float) -> Callable[[float], float]:
    """Returns the intensity of an area light of Blender with a power and a spread (rad).

    The radiance falls linearly in the tangent of the angle, and the power stays the same, as in
    Cycles.
    """
    half = 0.5 * max(angle, math.radians(1.0))
    scale = power / math.pi / (math.tan(half) - half)
    return lambda theta: scale * math.cos(theta) * (math.tan(half) - math.tan(theta))


def spot(axial: float, size: float, blend: float) -> Callable[[float], float]:
    """Returns the intensity of a spot of Blender with an intensity on its axis and an angle (rad)."""
    edge = math.cos(0.5 * size)

    def intensity(theta: float) -> float:
        if blend <= 0.0:
            return axial
        x = min(1.0, max(0.0, (math.cos(theta) - edge) / ((1.0 - edge) * blend)))
        return axial * x * x * (3.0 - 2.0 * x)

    return intensity
