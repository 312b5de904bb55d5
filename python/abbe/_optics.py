"""Glasses and lenses."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
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


class LensReport(Report):
    """The analysis of a lens. Its attributes are those of `abbe lens --json`; lengths are in mm."""

    __slots__ = ()

    name: str
    surfaces: int
    efl_mm: float
    bfd_mm: float
    #: The back focus at the F line minus the back focus at the C line.
    fc_shift_mm: float
    f_number: Optional[float]
    half_field_deg: float
    #: The foci and the transmittance on the axis in the F, d and C lines.
    lines: list[Any]
    fields: list[Any]


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
    glasses: Sequence[Union[str, os.PathLike[str]]] = (),
    svg: Optional[Union[str, os.PathLike[str]]] = None,
) -> LensReport:
    """Analyses a built-in lens, a file with a prescription (JSON, Zemax, CODE V, OSLO), or a prescription.

    `field` is half the field of view in degrees. `glasses` are Zemax catalogues that are searched
    first. `svg` is a file for the cross-section.

    >>> import abbe
    >>> report = abbe.lens("singlet")
    >>> report.efl_mm > 0 and len(report.fields) > 0
    True
    """
    files = [os.fspath(path) for path in glasses]
    with lens_argument(name) as argument:
        text = _native.lens_report(argument, field, files, None if svg is None else os.fspath(svg))
    return LensReport(json.loads(text))


def lenses() -> list[str]:
    """Returns the names of all built-in lenses."""
    return _native.lens_names()
