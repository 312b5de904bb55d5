# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts quantities of Blender to those of Abbe. This module does not need Blender.

Blender counts light in watts, but has no wavelengths: a picture shows 1 W/m²/sr as the value 1.
The add-on states how many lumens one of these watts carries, its luminous efficacy. White light of
the power P then has the luminous flux efficacy × P, and a colour scales the flux by its luminance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

#: The luminous efficacy (lm/W) that Blender's glTF exporter uses.
LUMENS_PER_WATT = 683.0


def luminance(rgb: Sequence[float]) -> float:
    """Returns the luminance of a linear sRGB colour relative to white."""
    r, g, b = (max(0.0, component) for component in rgb)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def light_spectrum(rgb: Sequence[float]) -> Any:
    """Returns the spectrum of a light of a linear sRGB colour. Black has that of white."""
    colour = [max(0.0, component) for component in rgb]
    return {"rgb": colour} if luminance(colour) > 0.0 else "D65"


def is_grey(rgb: Sequence[float]) -> bool:
    """Returns true if a colour has no hue."""
    return max(rgb) - min(rgb) <= 1e-4 * max(max(rgb), 1e-9)


def vertical_fov(lens_mm: float, sensor_mm: float, fits_width: bool, size: tuple[int, int]) -> float:
    """Returns the vertical field of view in degrees.

    `sensor_mm` is the extent of the sensor along the width of the picture, or along its height.
    """
    width, height = size
    tangent = 0.5 * sensor_mm / lens_mm * (height / width if fits_width else 1.0)
    return math.degrees(2.0 * math.atan(tangent))


def fits_width(fit: str, size: tuple[int, int]) -> bool:
    """Returns true if the sensor of a camera extends over the width of the picture."""
    return fit == "HORIZONTAL" or (fit == "AUTO" and size[0] >= size[1])


def defocus_angle(lens_mm: float, f_number: float, focus_distance: float) -> float:
    """Returns the apex angle in degrees of the cone from a point in focus to the pupil."""
    radius = 0.5e-3 * lens_mm / f_number
    return math.degrees(2.0 * math.atan(radius / focus_distance))


def spot_angles(size: float, blend: float) -> tuple[float, float]:
    """Returns the half-angle and the penumbra of a spot light in degrees.

    Blender's spots are smooth in the cosine of the angle, like Abbe's: the intensity rises from
    cos(size/2) over the part `blend` of the remaining range of cosines.
    """
    edge = math.cos(0.5 * size)
    inner = math.acos(min(1.0, edge + (1.0 - edge) * blend))
    return math.degrees(0.5 * size), math.degrees(0.5 * size - inner)


def scaled_ior(ior: float, level: float) -> float:
    """Returns the index whose reflectance at normal incidence is 2 × `level` times that of `ior`.

    This is the meaning of "Specular IOR Level" of Blender's Principled BSDF.
    """
    reflectance = min(0.9, ((ior - 1.0) / (ior + 1.0)) ** 2 * 2.0 * level)
    root = math.sqrt(reflectance)
    return (1.0 + root) / (1.0 - root)


def coefficient(rgb: Sequence[float]) -> Any:
    """Returns a coefficient (1/m) with values for red, green and blue as a spectrum or a number."""
    largest = max(rgb)
    if largest <= 0.0 or is_grey(rgb):
        return max(0.0, largest)
    return {"mix": [{"spectrum": {"rgb": [part / largest for part in rgb]}, "weight": largest}]}


def absorption(rgb: Sequence[float], distance: float) -> Any:
    """Returns the absorption coefficient (1/m) that gives white light a colour after a distance."""
    return coefficient([-math.log(min(1.0, max(1e-4, component))) / distance for component in rgb])


def exposure_ev(exposure: float, efficacy: float) -> float:
    """Returns the exposure in stops with which Abbe's PNG is as bright as Blender's picture."""
    return exposure - math.log2(efficacy)


def shutter(position: str, length_frames: float) -> tuple[float, float]:
    """Returns the frames at which the shutter opens and closes, relative to the frame."""
    start = {"START": 0.0, "CENTER": -0.5, "END": -1.0}[position] * length_frames
    return start, start + length_frames
