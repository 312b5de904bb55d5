"""The regression kit for code that converts spectra to colours.

There are two sets, which have a version and never change. Test a converter with pytest:

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
    #: The fault that explains the errors: its `name`, `form`, `explanation` and `residual`.
    cause: Optional[Any]
    #: The explanation of the cause.
    hint: Optional[str]
    #: The counts of each group.
    groups: list[Any]
    #: The cases. The case with the largest difference comes first.
    cases: list[Any]


@dataclass(frozen=True, eq=False)
class Case:
    """A light, or a reflectance under a light, with its colour."""

    id: str
    #: `lamps`, `lines`, `monochromatic`, `surfaces`, `metamers` or `fluorescent`.
    group: str
    #: The wavelengths of the samples in nm: 360, 361, … 830.
    nm: NDArray[np.float64]
    #: The power of the light per nm at these wavelengths, without its lines.
    light: NDArray[np.float64]
    #: The spectral lines of the light: pairs of wavelength in nm and power.
    lines: tuple[tuple[float, float], ...]
    #: The samples of the reflectance, or None if the case is the colour of the light.
    reflectance_values: Optional[NDArray[np.float64]]
    #: The excitation and the emission of a fluorescent sample as samples, or None.
    fluorescence: Optional[tuple[NDArray[np.float64], NDArray[np.float64]]]
    #: The colours by the names of their forms, such as `lab` in the second set.
    colours: Mapping[str, NDArray[np.float64]]
    #: The number of the set.
    set: int
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
        **others: ArrayLike,
    ) -> None:
        """Raises an AssertionError if a colour differs by more than the tolerances of `judge`.

        `others` are the other forms of the second set, such as ``lab``.
        """
        forms = {"xyz": xyz, "linear_srgb": linear_srgb, "srgb": srgb, **others}
        colours = {form: value for form, value in forms.items() if value is not None}
        judged = judge({self.id: colours}, delta_e=delta_e, component=component, set=self.set).cases[0]
        if not judged.passed:
            raise AssertionError(f"{self.id}: {judged.fault}")

    def __str__(self) -> str:
        return self.id

    def __repr__(self) -> str:
        return f"abbe.regress.Case({self.id!r})"


@functools.lru_cache(maxsize=2)
def _set(number: int) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(_native.regression_set(number))
    return content


def set_name(set: int = 1) -> str:
    """Returns the name and the version of a set."""
    return str(_set(set)["set"])


@functools.lru_cache(maxsize=2)
def _cases(number: int) -> tuple[Case, ...]:
    content = _set(number)
    nm = np.array(content["nm"])
    spectra = {spectrum["name"]: spectrum for spectrum in content["spectra"]}
    samples = {name: np.array(spectrum["values"]) for name, spectrum in spectra.items()}
    for array in (nm, *samples.values()):
        array.flags.writeable = False
    described = {"id", "group", "light", "reflectance", "excitation", "emission"}
    found = []
    for case in content["cases"]:
        light, reflectance = case["light"], case["reflectance"]
        lines = tuple((line["nm"], line["power"]) for line in spectra[light]["lines"])
        values = None if reflectance is None else samples[reflectance]
        excitation = case.get("excitation")
        fluorescence = None if excitation is None else (samples[excitation], samples[case["emission"]])
        colours = {form: np.array(value) for form, value in case.items() if form not in described}
        parts = (nm, samples[light], lines, values, fluorescence, colours, number)
        basic = [colours[form] for form in ("xyz", "linear_srgb", "srgb")]
        found.append(Case(case["id"], case["group"], *parts, *basic))
    return tuple(found)


def cases(*groups: str, set: int = 1) -> list[Case]:
    """Returns the cases of some groups of a set, or all its cases."""
    known = {case.group for case in _cases(set)}
    for group in groups:
        if group not in known:
            raise ValueError(f"no group {group!r}; the groups are {sorted(known)}")
    return [case for case in _cases(set) if not groups or case.group in groups]


def observer(nm: ArrayLike) -> NDArray[np.float64]:
    """Returns x̄, ȳ and z̄ of the CIE 1931 observer at one or more wavelengths in nm."""
    content = _set(1)
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
    set: int = 1,
) -> RegressReport:
    """Judges the colours that a converter computed.

    `colours` contains the colours by the id of the case: either XYZ, or a dictionary with the keys
    ``xyz``, ``linear_srgb`` and ``srgb``. A case passes if ΔE2000 is at most `delta_e` (default
    0.1), and if no component differs by more than `component` (default 0.0005) of white or of the
    largest expected component. `page` is an HTML file that shows the worst cases. `set` is the
    number of the set, whose forms are the keys of a dictionary.

    Raises `InputError` if a case is unknown.
    """
    entries = []
    for name, colour in colours.items():
        forms = colour if isinstance(colour, Mapping) else {"xyz": colour}
        entries.append({"id": name, **{form: _numbers(value) for form, value in forms.items()}})
    path = None if page is None else os.fspath(page)
    return RegressReport(json.loads(_native.regression_report(set, to_json(entries), delta_e, component, path)))


def _numbers(value: ArrayLike) -> list[Optional[float]]:
    """Returns numbers for JSON. A number that is not finite becomes None."""
    return [float(number) if np.isfinite(number) else None for number in np.asarray(value, dtype=float).ravel()]
