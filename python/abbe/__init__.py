"""Abbe: a spectral photon-mapping renderer for prisms, lenses, caustics and real lamps.

Render a scene, and read the luminance of a pixel with its error bar:

>>> import abbe
>>> scene = {
...     "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
...     "film": {"width": 16, "height": 9},
...     "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
...     "objects": [{"shape": {"rectangle": {"width": 10, "height": 10}}, "material": "grey"}],
...     "lights": [{"point": {"at": [0, 3, 0], "spectrum": "D65", "power": 10}}],
... }
>>> picture = abbe.render(scene, passes=8)
>>> picture.xyz.shape
(9, 16, 3)
>>> low, high = picture.interval()
>>> bool(low[8, 8] < picture.luminance[8, 8] < high[8, 8])
True

Arrays of pixels have the shape (rows, columns, ...). The first row is the top row. Luminances are
in cd/m², wavelengths in nm, spectral radiances in W/m²/sr/nm.
"""

from . import regress
from ._errors import Error, InputError, Interrupted, MachineError
from ._lamps import LampsReport, compare_lamps
from ._measure import Judgement, Measurement, MeterReport, measure
from ._native import __version__
from ._optics import Glass, LensReport, glass, glasses, lens, lens_plots, lenses
from ._optiland import lens_from_optiland, lens_to_optiland
from ._picture import Picture, read
from ._render import Progress, check, explain, passes, render
from ._report import Report
from ._spectrum import ColourReport, Spectrum, spectra, spectra_from_colour
from ._study import StudyReport, study

# Messages and pickles name the public classes by their public names.
for _class in (Error, InputError, Interrupted, MachineError, Picture, Spectrum):
    _class.__module__ = __name__
del _class

__all__ = [
    "ColourReport",
    "Error",
    "Glass",
    "InputError",
    "Interrupted",
    "Judgement",
    "LampsReport",
    "LensReport",
    "MachineError",
    "Measurement",
    "MeterReport",
    "Picture",
    "Progress",
    "Report",
    "Spectrum",
    "StudyReport",
    "__version__",
    "check",
    "compare_lamps",
    "explain",
    "glass",
    "glasses",
    "lens",
    "lens_from_optiland",
    "lens_plots",
    "lens_to_optiland",
    "lenses",
    "measure",
    "passes",
    "read",
    "regress",
    "render",
    "spectra",
    "spectra_from_colour",
    "study",
]
