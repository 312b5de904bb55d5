"""Exchange of lenses with optiland."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._optics import lens_argument

if TYPE_CHECKING:
    from optiland.optic.optic import Optic

#: The wavelengths in nm at which the programs exchange indices of refraction.
_NM = np.arange(360.0, 831.0, 2.0).tolist()

#: The spectral lines F, d and C in µm.
_LINES_UM = (0.4861327, 0.5875618, 0.6562725)

#: A sphere is used up to this share of its radius.
_USABLE = 0.999

#: Without a physical aperture, a surface is larger than the beam by this factor.
_MARGIN = 1.02


def lens_from_optiland(optic: Optic) -> dict[str, Any]:
    """Returns the prescription of an optiland `Optic`.

    The result is a value for `camera.lens.system.prescription` of a scene, and for `abbe.lens`.
    It contains tables of the indices of refraction. The paraxial marginal ray determines the size
    of the stop. A surface without a physical aperture is as large as the beams of all fields.

    Planes, spheres, conics and even aspheres without an h² term are supported. Other surfaces,
    mirrors, tilts, shifts and central obscurations raise a ValueError.
    """
    rows = list(optic.surfaces)
    stop_mm = np.abs(np.ravel(optic.paraxial.marginal_ray()[0]))
    beam_mm = _beam_heights(optic)
    surfaces = [
        _surface(i, rows[i], float(stop_mm[i] if rows[i].is_stop else _MARGIN * beam_mm[i]))
        for i in range(1, len(rows) - 1)
    ]
    return {"surfaces": surfaces}


def _beam_heights(optic: Optic) -> NDArray[np.float64]:
    """Returns the largest height of a ray on each surface: paraxial rays, and the real rays at the
    edges of the pupil and of the field that pass the lens."""
    paraxial = [np.abs(np.ravel(ray()[0])) for ray in (optic.paraxial.marginal_ray, optic.paraxial.chief_ray)]
    heights = [paraxial[0] + paraxial[1]]
    for wavelength in optic.wavelengths.get_wavelengths():
        for field, pupil in [(0, 1), (1, -1), (1, 0), (1, 1)]:
            optic.trace_generic(0, field, 0, pupil, wavelength)
            heights.append(np.array([abs(float(np.ravel(row.y)[0])) for row in optic.surfaces]))
    largest: NDArray[np.float64] = np.nanmax(heights, axis=0)
    return largest


def _surface(number: int, surface: Any, semi_aperture_mm: float) -> dict[str, Any]:
    """Returns a surface of a prescription. Its physical aperture replaces `semi_aperture_mm`."""
    geometry, placement = surface.geometry, surface.geometry.cs

    def unsupported(what: str) -> ValueError:
        return ValueError(f"surface {number} of the lens: {what} is not supported")

    if surface.interaction_model.is_reflective:
        raise unsupported("a mirror")
    if any(abs(float(value)) > 1e-12 for value in (placement.x, placement.y, placement.rx, placement.ry)):
        raise unsupported("a tilt or a shift")
    kind = type(geometry).__name__
    if kind not in ("Plane", "StandardGeometry", "EvenAsphere"):
        raise unsupported(kind)
    radius = float(geometry.radius)
    terms = [float(term) for term in geometry.coefficients] if kind == "EvenAsphere" else []
    if terms and terms[0] != 0:
        raise unsupported("an even asphere with an h² term")
    conic = 0.0 if kind == "Plane" else float(geometry.k)
    physical = surface.aperture
    if physical is not None and not surface.is_stop:
        if type(physical).__name__ != "RadialAperture" or physical.r_min != 0:
            raise unsupported("an aperture that is not a full circle")
        semi_aperture_mm = float(physical.r_max)
    if conic == 0 and math.isfinite(radius):
        semi_aperture_mm = min(semi_aperture_mm, _USABLE * abs(radius))
    n = np.ravel([surface.material_post.n(nm / 1000) for nm in _NM]).tolist()
    row: dict[str, Any] = {
        "radius_mm": radius if math.isfinite(radius) else None,
        "thickness_mm": float(surface.thickness),
        "ior": 1 if all(index == 1 for index in n) else {"table": {"nm": _NM, "values": n}},
        "semi_aperture_mm": semi_aperture_mm,
    }
    if conic != 0:
        row["conic"] = conic
    if terms:
        row["aspheric"] = terms[1:]
    if surface.is_stop:
        row["stop"] = True
    return row


def lens_to_optiland(
    lens: Union[str, os.PathLike[str], Mapping[str, Any]],
    *,
    glasses: Sequence[Union[str, os.PathLike[str]]] = (),
) -> Optic:
    """Returns an optiland `Optic` for a lens: a built-in name, a file, or a prescription.

    The arguments are those of `abbe.lens`. The object is at infinity, the fields are the axis and
    the edge of the field of view, and the wavelengths are the lines F, d and C.
    """
    from optiland.materials import DataMaterial, IdealMaterial
    from optiland.optic.optic import Optic as OptilandOptic
    from optiland.physical_apertures.radial import RadialAperture

    with lens_argument(lens) as name:
        files = [os.fspath(path) for path in glasses]
        report = json.loads(_native.lens_prescription(name, _NM, files))
    optic = OptilandOptic(report["name"])
    optic.surfaces.add(index=0, thickness=math.inf)
    for index, row in enumerate(report["surfaces"], start=1):
        n = row["n"]
        even_terms = row["even_terms"]
        optic.surfaces.add(
            index=index,
            surface_type="even_asphere" if even_terms else "standard",
            radius=math.inf if row["radius_mm"] is None else row["radius_mm"],
            conic=row["conic"],
            thickness=row["thickness_mm"],
            is_stop=row["stop"],
            material=(
                IdealMaterial(n=n[0])
                if min(n) == max(n)
                else DataMaterial.from_samples([nm / 1000 for nm in _NM], n)
            ),
            aperture=RadialAperture(r_max=row["semi_aperture_mm"], r_min=row["obscuration_mm"]),
            **({"coefficients": even_terms} if even_terms else {}),
        )
        if row["stop"]:
            optic.set_aperture("float_by_stop_size", 2 * row["semi_aperture_mm"])
    optic.surfaces.add(index=len(report["surfaces"]) + 1)
    optic.fields.set_type("angle")
    optic.fields.add(y=0)
    if report["half_field_deg"] is not None:
        optic.fields.add(y=report["half_field_deg"])
    for line in _LINES_UM:
        optic.wavelengths.add(line, is_primary=line == _LINES_UM[1])
    return optic
