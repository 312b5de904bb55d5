"""Studies of accuracy against time."""

from __future__ import annotations

import datetime
import json
import os
from collections.abc import Mapping
from typing import Any, Callable, Optional, Union

from . import _native
from ._report import Report, finished_report
from ._scene import Scene, scene_arguments


class StudyReport(Report):
    """The results of a study, as in the file `study.json` of `abbe study`."""

    __slots__ = ()

    title: str
    #: Error against time of photon mapping, and of the path tracer.
    curves: list[Any]
    #: Recommended settings for given errors, with predicted times.
    wanted: list[Any]
    spent_seconds: float


def study(
    scene: Scene,
    output: Union[str, os.PathLike[str]],
    *,
    budget: Union[float, datetime.timedelta] = 300.0,
    reference: Optional[Union[str, os.PathLike[str]]] = None,
    threads: Optional[int] = None,
    set: Optional[Mapping[str, Any]] = None,
    folder: Optional[Union[str, os.PathLike[str]]] = None,
    allow_outside: bool = False,
    progress: Optional[Callable[[str], object]] = None,
) -> StudyReport:
    """Measures the error of a render against its time.

    The study writes a page, tables and plots to the folder `output`, and caches finished steps in
    it. `budget` is the approximate time in seconds. `reference` is an EXR file; without it, the
    study renders a reference first. `progress` receives the name of each step.

    Ctrl-C stops the study, and the same call continues from the finished steps.
    """
    seconds = budget.total_seconds() if isinstance(budget, datetime.timedelta) else budget
    task = _native.ReportTask.study(
        scene_arguments(scene, set, folder, allow_outside),
        os.fspath(output),
        seconds,
        None if reference is None else os.fspath(reference),
        threads,
    )
    return StudyReport(json.loads(finished_report(task, progress)))
