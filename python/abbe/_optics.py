"""Glasses and lenses."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Literal, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._errors import InputError
from ._report import Report


class Glass(Report):
    """A glass, crystal, polymer, liquid or gas. Its attributes are those of `abbe glass --json`."""

    __slots__ = ("_native",)

    name: str
    kind: str
    #: The index of refraction at 587.6 nm.
    nd: float
    #: The Abbe number, or None if the data does not cover the F and C lines.
    vd: Optional[float]
    range_nm: list[float]
    source: str

    def __init__(self, native: _native.Glass) -> None:
        super().__init__(json.loads(native.report_json()))
        object.__setattr__(self, "_native", native)

    @overload
    def n(self, nm: float) -> float: ...
    @overload
    def n(self, nm: ArrayLike) -> Union[float, NDArray[np.float64]]: ...
    def n(self, nm: ArrayLike) -> Union[float, NDArray[np.float64]]:
        """Returns the index of refraction at one or more wavelengths in nm.

        >>> import abbe
        >>> round(abbe.glass("N-SF10").n(587.5618), 5)
        1.72828
        """
        wavelengths = np.asarray(nm, dtype=np.float64)
        index: NDArray[np.float64] = self._native.n(wavelengths.ravel().tolist()).reshape(wavelengths.shape)
        return float(index) if index.ndim == 0 else index

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("a glass cannot be pickled; call abbe.glass with its name")


def glass(name: str, *, agf: Optional[Union[str, os.PathLike[str]]] = None) -> Glass:
    """Returns a glass of the built-in catalogue, or of a Zemax catalogue (`agf`).

    Raises `InputError` if the name is unknown:

    >>> import abbe
    >>> abbe.glass("N-BK8")
    Traceback (most recent call last):
    ...
    abbe.InputError: unknown glass "N-BK8"; expected a glass of the built-in catalogue; did you mean "N-BK7"?
    """
    return Glass(_native.Glass(name, None if agf is None else os.fspath(agf)))


def glasses() -> list[str]:
    """Returns the names of all materials of the built-in catalogue."""
    return _native.glass_names()


Plot = Literal[
    "section",
    "spots",
    "ray-fans",
    "mtf",
    "through-focus",
    "field-curves",
    "lateral-colour",
    "illumination",
    "axial-colour",
]


class LensReport(Report):
    """The analysis of a lens. Its attributes are those of `abbe lens --json`; lengths are in mm.

    In a notebook, a report shows the cross-section with rays.
    """

    __slots__ = ("_native",)

    name: str
    surfaces: int
    efl_mm: float
    bfd_mm: float
    #: The back focus at the F line minus the back focus at the C line.
    fc_shift_mm: float
    f_number: Optional[float]
    half_field_deg: float
    #: The foci and the transmittance on the axis at each wavelength.
    lines: list[Any]
    fields: list[Any]

    def __init__(self, entries: Mapping[str, Any], native: Optional[_native.Lens] = None) -> None:
        super().__init__(entries)
        object.__setattr__(self, "_native", native)

    def plot(self, plot: Plot = "section") -> str:
        """Returns a plot as the text of an SVG file.

        `plot` is the cross-section with rays (``"section"``), spot diagrams (``"spots"``),
        ``"ray-fans"``, the MTF against frequency (``"mtf"``) or against the position of the sensor
        (``"through-focus"``), ``"field-curves"`` with the distortion, ``"lateral-colour"``,
        relative ``"illumination"``, or ``"axial-colour"``.

        >>> import abbe
        >>> abbe.lens("double gauss").plot("mtf").startswith("<svg")
        True
        """
        return self._analysed().plot(plot)

    def page(self) -> str:
        """Returns a page for A4 paper with all figures and plots as the text of an HTML file."""
        return self._analysed().page()

    def _analysed(self) -> _native.Lens:
        native: Optional[_native.Lens] = self._native
        if native is None:
            raise TypeError("a report that was pickled or copied has no plots; call abbe.lens again")
        return native

    def _repr_svg_(self) -> Optional[str]:
        # A copy has no plots.
        native: Optional[_native.Lens] = self._native
        return native.plot("section") if native is not None else None


@contextmanager
def lens_argument(lens: Union[str, os.PathLike[str], Mapping[str, Any]]) -> Iterator[str]:
    """Yields a name or a path for a lens. A prescription is written to a temporary file."""
    if not isinstance(lens, Mapping):
        yield os.fspath(lens)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "prescription.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(lens, file)
        yield path


def lens(
    name: Union[str, os.PathLike[str], Mapping[str, Any]],
    *,
    field: Optional[float] = None,
    wavelengths: Optional[ArrayLike] = None,
    focus: Union[float, Literal["best"], None] = None,
    glasses: Sequence[Union[str, os.PathLike[str]]] = (),
    svg: Optional[Union[str, os.PathLike[str]]] = None,
    plot: Plot = "section",
    html: Optional[Union[str, os.PathLike[str]]] = None,
) -> LensReport:
    """Analyses a built-in lens, a file with a prescription (JSON, Zemax, CODE V, OSLO), or a prescription.

    `field` is half the field of view in degrees. `wavelengths` are 1 to 6 wavelengths in nm, whose
    middle one is the reference; the default are the F, d and C lines. `focus` is the distance of the
    sensor in mm behind the paraxial focus, or ``"best"`` for the smallest spots. `glasses` are Zemax
    catalogues that are searched first. `svg` is a file for the `plot`, and `html` one for the page;
    `LensReport.plot` and `LensReport.page` return them as texts.

    >>> import abbe
    >>> report = abbe.lens("singlet", wavelengths=[450, 550, 650], focus="best")
    >>> report.efl_mm > 0 and len(report.fields) > 0
    True
    >>> [line.nm for line in report.lines]
    [450.0, 550.0, 650.0]
    """
    if isinstance(focus, str) and focus != "best":
        raise InputError(f'focus: {focus!r}; expected a distance in mm, or "best"')
    conditions = {
        "field": field,
        "wavelengths": None if wavelengths is None else np.asarray(wavelengths, dtype=float).ravel().tolist(),
        "focus": None if isinstance(focus, str) else focus,
        "best_focus": focus == "best",
    }
    with lens_argument(name) as argument:
        native = _native.Lens(argument, [os.fspath(path) for path in glasses], conditions)
    if svg is not None:
        _native.write_whole(os.fspath(svg), native.plot(plot))
    if html is not None:
        _native.write_whole(os.fspath(html), native.page())
    return LensReport(json.loads(native.report_json()), native)


def lens_plots() -> list[str]:
    """Returns the names of the plots of a lens."""
    return _native.lens_plot_names()


def lenses() -> list[str]:
    """Returns the names of all built-in lenses."""
    return _native.lens_names()
