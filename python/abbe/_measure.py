"""Measurements with the meters of a scene."""

from __future__ import annotations

import datetime
import json
import os
from collections.abc import Iterable, Mapping
from typing import Any, Literal, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._report import Report, finished_report
from ._scene import Scene, scene_arguments


class MeterReport(Report):
    """The readings of a meter. Its entries are those of a meter in `abbe measure --json`.

    The arrays have one row for each position. Readings of a spectrum have one column for each band.
    """

    __slots__ = ()

    name: str
    quantity: str
    unit: str
    #: The readings, one report for each position.
    points: list[Any]
    #: The mean of the readings, or None for spectra.
    mean: Optional[float]
    #: The least reading divided by the mean reading, or None for spectra.
    uniformity: Optional[float]

    @property
    def positions(self) -> NDArray[np.float64]:
        """The positions in the unit of the scene, with the shape (readings, 3)."""
        return self._array("position")

    @property
    def value(self) -> NDArray[np.float64]:
        """The values in `unit`."""
        return self._array("value")

    @property
    def noise(self) -> NDArray[np.float64]:
        """The standard errors in `unit`. NaN means that the noise is unknown."""
        return self._array("noise")

    @property
    def bias(self) -> NDArray[np.float64]:
        """The magnitudes of the estimated bias in `unit`. NaN means that the bias is unknown."""
        return self._array("bias")

    def interval(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the lower and the upper limits of the 95 % intervals, or NaN if they are unknown."""
        limits = [point["interval_95"] or (None, None) for point in self["points"]]
        return self._filled([low for low, _ in limits]), self._filled([high for _, high in limits])

    def _array(self, entry: str) -> NDArray[np.float64]:
        return self._filled([point[entry] for point in self["points"]])

    def _filled(self, values: list[Any]) -> NDArray[np.float64]:
        bands = self.get("wavelength_nm")
        unknown: Any = np.nan if bands is None else [np.nan] * len(bands)
        return np.array([unknown if value is None else value for value in values], dtype=np.float64)


class Judgement(Report):
    """The verdict on a limit of a scene's `requirements`, by the interval of the measured value."""

    __slots__ = ()

    meter: str
    #: The limit in words, such as ``mean at least 500 lx``.
    requirement: str
    limit: float
    #: The measured value: of a limit of each reading, that of the worst reading.
    value: Optional[float]
    #: The 95 % interval of the value, or None if it is unknown.
    interval_95: Optional[list[float]]
    #: ``met`` or ``not_met`` if the whole interval is on one side of the limit, else ``undecided``.
    verdict: Literal["met", "not_met", "undecided"]

    @property
    def source(self) -> Optional[str]:
        """The standard or the agreement that states the limit, or None."""
        return self.get("source")


class Measurement(Report):
    """The readings of all meters. Its entries are those of `abbe measure --json`."""

    __slots__ = ()

    #: `path` or `photon`.
    integrator: str
    passes: int
    seconds: float
    notes: list[str]

    @property
    def meters(self) -> list[MeterReport]:
        """The meters in the order of the scene."""
        return [MeterReport(meter) for meter in self["meters"]]

    @property
    def requirements(self) -> list[Judgement]:
        """The verdicts on the requirements of the scene whose meters were read, in their order."""
        return [Judgement(judgement) for judgement in self.get("requirements", [])]

    def meter(self, name: str) -> MeterReport:
        """Returns the meter with this name."""
        for meter in self.meters:
            if meter.name == name:
                return meter
        raise KeyError(f"no meter {name!r}; the meters are {[meter.name for meter in self.meters]}")


def measure(
    scene: Scene,
    *,
    meters: Iterable[str] = (),
    passes: Optional[int] = None,
    target_error: Optional[float] = None,
    time: Union[float, datetime.timedelta, None] = None,
    set: Optional[Mapping[str, Any]] = None,
    photons: Optional[int] = None,
    seed: Optional[int] = None,
    threads: Optional[int] = None,
    integrator: Optional[Literal["photon", "path"]] = None,
    html: Optional[Union[str, os.PathLike[str]]] = None,
    folder: Optional[Union[str, os.PathLike[str]]] = None,
    allow_outside: bool = False,
) -> Measurement:
    """Measures the light at the meters of a scene, and judges its `requirements`.

    `meters` contains the names of the meters to use; the default is all meters. The measurement
    stops as soon as one of these limits is reached: a number of `passes`, a `time` in seconds, or a
    relative `target_error` of every reading. The limits and the `integrator` have the defaults of
    `abbe measure`. `html` is a file for the page of readings, plans and verdicts. The other options
    are those of `render`.

    >>> import abbe
    >>> scene = {
    ...     "materials": {},
    ...     "objects": [],
    ...     "lights": [{"point": {"at": [0, 2, 0], "spectrum": "D65", "luminous_flux": 100}}],
    ...     "meters": [{"name": "desk", "quantity": "illuminance", "points": [[0, 0, 0]]}],
    ...     "requirements": [{"meter": "desk", "mean_at_least": 500}],
    ... }
    >>> measurement = abbe.measure(scene, passes=16)
    >>> desk = measurement.meter("desk")
    >>> desk.unit, round(float(desk.value[0]), 3)
    ('lx', 1.989)
    >>> [(judgement.requirement, judgement.verdict) for judgement in measurement.requirements]
    [('mean at least 500 lx', 'not_met')]
    """
    changes: dict[str, Any] = dict(set or {})
    for key, value in (("render.photons", photons), ("render.seed", seed), ("render.threads", threads)):
        if value is not None:
            changes[key] = value
    options = {
        "meters": list(meters),
        "integrator": integrator,
        "passes": passes,
        "seconds": time.total_seconds() if isinstance(time, datetime.timedelta) else time,
        "target_error": target_error,
        "html": None if html is None else os.fspath(html),
    }
    arguments = scene_arguments(scene, changes, folder, allow_outside)
    return Measurement(json.loads(finished_report(_native.ReportTask.measure(arguments, options))))
