"""Traces a lens with a tilted plate by optiland 0.6.3. The values are in crates/abbe-optics/src/lens/zemax/tests.rs.

Run in an environment with optiland: python make_folded.py
"""

import math

import numpy as np
from optiland.materials import IdealMaterial
from optiland.optic import Optic

TILT = math.radians(20)
PLATE_Z = 15.0


def on_plate(depth):
    """Position (y, z) of a vertex of the plate, which is shifted by 1 mm and tilted about x."""
    return 1.0 - depth * math.sin(TILT), PLATE_Z + depth * math.cos(TILT)


optic = Optic()
optic.add_surface(index=0, z=-np.inf)
optic.add_surface(index=1, z=0, radius=50, material=IdealMaterial(1.5168), is_stop=True)
optic.add_surface(index=2, z=5, radius=-50)
for index, (depth, material) in enumerate([(0.0, IdealMaterial(1.67271)), (8.0, "air")], start=3):
    y, z = on_plate(depth)
    optic.add_surface(index=index, y=y, z=z, rx=TILT, material=material)
image_y, image_z = on_plate(8.0)
optic.add_surface(index=5, y=image_y - 1.0, z=image_z + 30)
optic.set_aperture("EPD", 10)
optic.set_field_type("angle")
optic.add_field(y=0)
optic.add_field(y=2)
optic.add_wavelength(0.5875618, is_primary=True)
offsets = (2 * np.arange(64) + 1) / 64 - 1
px, py = np.meshgrid(offsets, offsets)
inside = px**2 + py**2 <= 1
for field in (0.0, 1.0):
    count = int(inside.sum())
    rays = optic.trace_generic(
        Hx=np.zeros(count), Hy=np.full(count, field), Px=px[inside], Py=py[inside], wavelength=0.5875618
    )
    x, y = np.array(rays.x), np.array(rays.y) - (image_y - 1.0)
    rms = math.sqrt(np.mean((x - x.mean()) ** 2 + (y - y.mean()) ** 2))
    print(f"{2 * field}° height {y.mean():.9f} mm, rms {rms:.9f} mm")
