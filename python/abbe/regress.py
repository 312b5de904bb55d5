"""The regression kit for code that converts spectra to colours.

The set has a version and never changes. Test a converter with pytest:

>>> import numpy as np
>>> from abbe import regress
>>> def my_converter(case):
...     def sums(reflectance):
...         xyz = (case.light * reflectance(case.nm)) @ regress.observer(case.nm)
...         for nm, power in case.lines:
...             xyz = xyz + power * reflectance(nm) * regress.observer(nm)
...         return xyz
...     return 100 * sums(case.reflectance) / sums(np.ones_like)[1]
>>> for case in regress.cases("lines"):
...     case.check(xyz=my_converter(case))
>>> report = regress.judge({case.id: {"xyz": my_converter(case)} for case in regress.cases()})
>>> report.failed, report.judged
(0, 264)
"""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._report import Report
from ._scene import to_json

__all__ = ["Case", "RegressReport", "cases", "judge", "observer", "set_name"]


class RegressReport(Report):
    """The judgement of a converter. Its entries are those of `abbe regress --json`."""

    __slots__ = ()

    set: str
    #: The number of cases, and the number of cases that failed.
    judged: int
    failed: int
    #: A likely cause, if many cases fail in the same way.
    hint: Optional[str]
    #: The cases. The case with the largest difference comes first.
    cases: list[Any]


@dataclass(frozen=True, eq=False)
class Case:
    """A light, or a reflectance under a light, with its colour."""

    id: str
    #: `lamps`, `lines`, `monochromatic`, `surfaces` or `metamers`.
    group: str
    #: The wavelengths of the samples in nm: 360, 361, … 830.
    nm: NDArray[np.float64]
    #: The power of the light per nm at these wavelengths, without its lines.
    light: NDArray[np.float64]
    #: The spectral lines of the light: pairs of wavelength in nm and power.
    lines: tuple[tuple[float, float], ...]
    #: The samples of the reflectance, or None if the case is the colour of the light.
    reflectance_values: Optional[NDArray[np.float64]]
    #: XYZ. A light and the perfect diffuser have Y = 100.
    xyz: NDArray[np.float64]
    #: Linear sRGB without chromatic adaptation, not clipped. White has the luminance 1.
    linear_srgb: NDArray[np.float64]
    #: The linear components clipped to 0–1 and encoded.
    srgb: NDArray[np.float64]

    def reflectance(self, nm: ArrayLike) -> NDArray[np.float64]:
        """Returns the reflectance at one or more wavelengths. It is 1 if the case is a light."""
        wavelengths = np.asarray(nm, dtype=np.float64)
        if self.reflectance_values is None:
            return np.ones_like(wavelengths)
        return np.asarray(np.interp(wavelengths, self.nm, self.reflectance_values))

    def check(
        self,
        *,
        xyz: Optional[ArrayLike] = None,
        linear_srgb: Optional[ArrayLike] = None,
        srgb: Optional[ArrayLike] = None,
        delta_e: Optional[float] = None,
        component: Optional[float] = None,
    ) -> None:
        """Raises an AssertionError if a colour differs by more than the tolerances of `judge`."""
        forms = {"xyz": xyz, "linear_srgb": linear_srgb, "srgb": srgb}
        colours = {form: value for form, value in forms.items() if value is not None}
        judged = judge({self.id: colours}, delta_e=delta_e, component=component).cases[0]
        if not judged.passed:
            raise AssertionError(f"{self.id}: {judged.fault}")

    def __str__(self) -> str:
        return self.id

    def __repr__(self) -> str:
        return f"abbe.regress.Case({self.id!r})"


@functools.lru_cache(maxsize=1)
def _set() -> dict[str, Any]:
    content: dict[str, Any] = json.loads(_native.regression_set())
    return content


def set_name() -> str:
    """Returns the name and the version of the set."""
    return str(_set()["set"])


@functools.lru_cache(maxsize=1)
def _cases() -> tuple[Case, ...]:
    content = _set()
    nm = np.array(content["nm"])
    spectra = {spectrum["name"]: spectrum for spectrum in content["spectra"]}
    samples = {name: np.array(spectrum["values"]) for name, spectrum in spectra.items()}
    for array in (nm, *samples.values()):
        array.flags.writeable = False
    found = []
    for case in content["cases"]:
        light, reflectance = case["light"], case["reflectance"]
        lines = tuple((line["nm"], line["power"]) for line in spectra[light]["lines"])
        values = None if reflectance is None else samples[reflectance]
        colours = [np.array(case[form]) for form in ("xyz", "linear_srgb", "srgb")]
        found.append(Case(case["id"], case["group"], nm, samples[light], lines, values, *colours))
    return tuple(found)


def cases(*groups: str) -> list[Case]:
    """Returns the cases of some groups, or all cases."""
    known = {case.group for case in _cases()}
    for group in groups:
        if group not in known:
            raise ValueError(f"no group {group!r}; the groups are {sorted(known)}")
    return [case for case in _cases() if not groups or case.group in groups]


def observer(nm: ArrayLike) -> NDArray[np.float64]:
    """Returns x̄, ȳ and z̄ of the CIE 1931 observer at one or more wavelengths in nm."""
    content = _set()
    table = np.array(content["observer"])
    wavelengths = np.asarray(nm, dtype=np.float64)
    columns = [np.interp(wavelengths, content["nm"], table[:, i]) for i in range(3)]
    return np.stack(columns, axis=-1)


def judge(
    colours: Mapping[str, Union[ArrayLike, Mapping[str, ArrayLike]]],
    *,
    delta_e: Optional[float] = None,
    component: Optional[float] = None,
    page: Optional[Union[str, os.PathLike[str]]] = None,
) -> RegressReport:
    """Judges the colours that a converter computed.

    `colours` contains the colours by the id of the case: either XYZ, or a dictionary with the keys
    ``xyz``, ``linear_srgb`` and ``srgb``. A case passes if ΔE2000 is at most `delta_e` (default
    0.1), and if no component differs by more than `component` (default 0.0005) of white or of the
    largest expected component. `page` is an HTML file that shows the worst cases.

    Raises `InputError` if a case is unknown.
    """
    entries = []
    for name, colour in colours.items():
        forms = colour if isinstance(colour, Mapping) else {"xyz": colour}
        entries.append({"id": name, **{form: _numbers(value) for form, value in forms.items()}})
    path = None if page is None else os.fspath(page)
    return RegressReport(json.loads(_native.regression_report(to_json(entries), delta_e, component, path)))


def _numbers(value: ArrayLike) -> list[Optional[float]]:
    """Returns numbers for JSON. A number that is not finite becomes None."""
    return [float(number) if np.isfinite(number) else None for number in np.asarray(value, dtype=float).ravel()]
