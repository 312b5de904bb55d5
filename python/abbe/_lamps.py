"""Comparisons of lamps."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

from . import _native
from ._report import Report
from ._scene import to_json
from ._spectrum import Spectrum

_Lamp = Union[str, Spectrum, Mapping[str, Any]]


class LampsReport(Report):
    """The comparison of two or three lamps. Its attributes are those of `abbe lamps --json`."""

    __slots__ = ()

    a: Report
    b: Report
    c: Optional[Report]
    #: The difference between the colours of the lamps A and B.
    lights: Report
    match: Optional[Report]
    #: The ColorChecker patches under A and under B.
    patches: list[Any]
    delta_e_2000: Report
    metameric_pairs: Report
    #: A sentence that says how different A and B are.
    verdict: str
    warning: Optional[str]


def compare_lamps(
    a: _Lamp,
    b: Optional[_Lamp] = None,
    c: Optional[_Lamp] = None,
    *,
    match: Sequence[_Lamp] = (),
    observer: str = "cie1931",
    html: Optional[Union[str, os.PathLike[str]]] = None,
) -> LampsReport:
    """Compares two or three lamps by what they do to the colours of surfaces.

    If `b` is missing, A is compared with the mix of the lights of `match` that has the colour
    nearest to A. `html` is a file for a page with spectra, swatches and all numbers.

    >>> import abbe
    >>> report = abbe.compare_lamps("D65", "A")
    >>> report.b.name, report.delta_e_2000.max > 5
    ('A', True)
    """
    return LampsReport(
        json.loads(
            _native.lamps_report(
                _argument(a),
                (None if b is None else _argument(b), None if c is None else _argument(c)),
                [_argument(primary) for primary in match],
                observer,
                None if html is None else os.fspath(html),
            )
        )
    )


def _argument(lamp: _Lamp) -> str:
    form = lamp.scene if isinstance(lamp, Spectrum) else lamp
    return form if isinstance(form, str) else to_json(form)
