#!/usr/bin/env python3
"""Makes lenses.json: paraxial properties and exact rays of the lenses in data/lenses/lenses.json.

The rays lie in the meridional plane and follow Snell's law at each sphere. Lengths are in mm. The
index of air is 1. Needs `pip install numpy scipy`.
"""

import json
import math

import scipy
from scipy.optimize import brentq

import common
from common import index

F_NM, D_NM, C_NM = 486.1327, 587.5618, 656.2725
GLASSES = common.glasses()


def index_of(name, nm):
    return 1.0 if name == "air" else index(GLASSES[name], nm)


def paraxial(surfaces, nm):
    """Returns the focal length and the distance of the focus from the last vertex."""
    height, slope, n = 1.0, 0.0, 1.0
    for i, surface in enumerate(surfaces):
        after = index_of(surface["glass"], nm)
        curvature = 1 / surface["radius_mm"] if surface["radius_mm"] else 0.0
        slope = (n * slope - height * (after - n) * curvature) / after
        n = after
        if i + 1 < len(surfaces):
            height += surface["thickness_mm"] * slope
    return -1 / slope, -height / slope


def trace(surfaces, nm, y, angle_deg):
    """Follows a ray from height y in the plane of the first vertex.

    Returns the heights at the surfaces, the height in the image plane and the slope there.
    """
    point_z, point_y = 0.0, y
    dir_z, dir_y = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    heights, vertex, n = [], 0.0, 1.0
    for surface in surfaces:
        after = index_of(surface["glass"], nm)
        if surface["radius_mm"] is None:
            along = (vertex - point_z) / dir_z
            normal_z, normal_y = -1.0, 0.0
        else:
            # The crossing that is nearer to the vertex.
            radius = surface["radius_mm"]
            to_z, to_y = vertex + radius - point_z, -point_y
            middle = to_z * dir_z + to_y * dir_y
            beside = to_z * dir_y - to_y * dir_z
            along = middle - math.copysign(math.sqrt(radius**2 - beside**2), radius)
            normal_z = (point_z + along * dir_z - vertex - radius) / radius
            normal_y = (point_y + along * dir_y) / radius
        point_z, point_y = point_z + along * dir_z, point_y + along * dir_y
        heights.append(point_y)
        # Snell's law as vectors, the normal against the ray.
        cosine = -(dir_z * normal_z + dir_y * normal_y)
        ratio = n / after
        shift = ratio * cosine - math.sqrt(1 - ratio**2 * (1 - cosine**2))
        dir_z, dir_y = ratio * dir_z + shift * normal_z, ratio * dir_y + shift * normal_y
        vertex, n = vertex + surface["thickness_mm"], after
    slope = dir_y / dir_z
    return heights, point_y + (vertex - point_z) * slope, slope


def chief_height(surfaces, field_deg):
    """Returns the height in the first plane from which a ray passes through the middle of the stop."""
    stop = next(i for i, surface in enumerate(surfaces) if surface.get("stop"))
    if stop == 0:
        return 0.0

    def missed(y):
        try:
            return trace(surfaces[: stop + 1], D_NM, y, field_deg)[0][stop]
        except ValueError:
            return math.nan

    # A sign change between neighbouring starts, from the middle outwards.
    reach = 2 * surfaces[0]["semi_aperture_mm"] / math.cos(math.radians(field_deg))
    starts = [-reach * i / 4000 for i in range(4001)]
    misses = [missed(start) for start in starts]
    for a, b, at_a, at_b in zip(starts, starts[1:], misses, misses[1:]):
        if at_a * at_b <= 0:
            return brentq(missed, a, b, xtol=1e-14, rtol=1e-15)
    raise ValueError("no chief ray")


def one(lens):
    surfaces, pupil = lens["surfaces"], lens["entrance_pupil_diameter_mm"]
    field = lens["half_field_deg"]
    (efl_d, bfd_d), (efl_f, bfd_f), (efl_c, bfd_c) = [
        paraxial(surfaces, nm) for nm in (D_NM, F_NM, C_NM)
    ]
    chief_y = chief_height(surfaces, field)
    heights, image_height, _ = trace(surfaces, D_NM, chief_y, field)
    # Shares of the pupil's radius on the axis. Oblique rays unless the field is very wide.
    plan = [(share * pupil / 2, 0.0) for share in (0.1, 0.5, 0.7, 1.0)]
    if field < 60:
        plan += [(0.2 * pupil / 2, share * field) for share in (0.3, 0.6)]
    rays = []
    for nm in (D_NM, F_NM, C_NM):
        for y, angle in plan:
            _, y_image, slope = trace(surfaces, nm, y, angle)
            ray = {"wavelength_nm": nm, "y_first_vertex_plane": y, "angle_deg": angle}
            rays.append({**ray, "y_image": y_image, "slope_dy_dz": slope})
    return {
        "name": lens["name"],
        "image_distance_given_mm": surfaces[-1]["thickness_mm"],
        "expected": {
            "efl_d": efl_d,
            "bfd_d": bfd_d,
            "efl_F": efl_f,
            "efl_C": efl_c,
            "bfd_F": bfd_f,
            "bfd_C": bfd_c,
            "longitudinal_chromatic_F_minus_C": bfd_f - bfd_c,
            "f_number": efl_d / pupil,
        },
        "chief_ray": {
            "field_deg": field,
            "y_at_first_vertex_plane": chief_y,
            "heights": heights,
            "image_height": image_height,
            "f_tan_theta": efl_d * math.tan(math.radians(field)),
            "f_theta": efl_d * math.radians(field),
        },
        "exact_meridional_rays": rays,
    }


def lenses():
    method = (
        "paraxial and exact meridional rays computed in Python, air n = 1, object at infinity, "
        "back focus from the last vertex; rays start in the plane z = 0 of the first vertex and "
        "end in the image plane at the sum of all thicknesses"
    )
    given = json.loads((common.DATA / "lenses/lenses.json").read_text(encoding="utf-8"))["lenses"]
    golden = {"method": method, "generator": "make_lenses.py", "programs": f"scipy {scipy.__version__}"}
    return {**golden, "lenses": common.rounded([one(lens) for lens in given], 10)}


if __name__ == "__main__":
    # The pupils of the prescriptions are rounded, and with them the rays.
    bounds = {"*/y_image": 1e-7, "*/heights/*": 1e-7}
    files = {"lenses.json": (lambda: common.json_text(lenses(), False), json.loads, 1e-8, bounds)}
    common.main(files)
