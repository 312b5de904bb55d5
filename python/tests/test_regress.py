"""The regression kit: colour-science as the converter under test, and faulty converters."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Optional

import numpy as np
import pytest
from numpy.typing import NDArray

import abbe
from abbe import regress


def colour_science(case: regress.Case) -> dict[str, NDArray[np.float64]]:
    """Converts a case with colour-science: its observer, its integration, its sRGB."""
    colour = pytest.importorskip("colour")
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]

    def sums(reflectance: NDArray[np.float64]) -> NDArray[np.float64]:
        product = colour.SpectralDistribution(case.light * reflectance, case.nm)
        xyz = np.asarray(colour.sd_to_XYZ(product, cmfs=observer, k=1, method="Integration"))
        for nm, power in case.lines:
            bars = [np.interp(nm, observer.wavelengths, observer.values[:, i]) for i in range(3)]
            xyz = xyz + power * float(np.interp(nm, case.nm, reflectance)) * np.array(bars)
        return xyz

    white = sums(np.ones_like(case.nm))[1]
    xyz = 100 * sums(case.reflectance(case.nm)) / white
    linear = colour.XYZ_to_sRGB(xyz / 100, apply_cctf_encoding=False)
    return {"xyz": xyz, "linear_srgb": np.asarray(linear)}


@pytest.mark.parametrize("case", regress.cases("lamps", "lines", "metamers"), ids=str)
def test_colour_science_converts_spectra(case: regress.Case) -> None:
    colour = colour_science(case)
    case.check(xyz=colour["xyz"], linear_srgb=colour["linear_srgb"])


def test_colour_science_passes_the_whole_set(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    report = regress.judge({case.id: colour_science(case) for case in regress.cases()}, page=page)
    assert report.judged == 264 and report.failed == 0, report.cases[:3]
    # The XYZ values agree to rounding; the matrix of sRGB is rounded in colour-science.
    worst = {form: 0.0 for form in ("xyz", "linear_srgb")}
    for case in report.cases:
        for judged in case.colours:
            worst[judged.form] = max(worst[judged.form], judged.component)
    assert worst["xyz"] < 1e-6 < worst["linear_srgb"] < 3e-4
    assert "all 264 cases pass" in page.read_text()


def coarse(case: regress.Case, step: int = 5, nearest: Optional[int] = None) -> NDArray[np.float64]:
    """Converts a case with samples in steps of 5 nm, or moves lines to a multiple of a width."""
    nm = case.nm[::step]

    def sums(reflectance: Any) -> NDArray[np.float64]:
        xyz = step * (case.light[::step] * reflectance(nm)) @ regress.observer(nm)
        for line, power in case.lines:
            line = line if nearest is None else nearest * round(line / nearest)
            xyz = xyz + power * reflectance(line) * regress.observer(line)
        return np.asarray(xyz)

    return np.asarray(100 * sums(case.reflectance) / sums(np.ones_like)[1])


def test_the_default_tolerances_find_coarse_samples_and_moved_lines() -> None:
    fine = regress.judge({case.id: coarse(case, step=1) for case in regress.cases()})
    assert fine.failed == 0
    report = regress.judge({case.id: coarse(case) for case in regress.cases("lamps")})
    failed = {case.id for case in report.cases if not case.passed}
    assert {"FL11", "HP1"} & failed and "E" not in failed
    moved = regress.judge({case.id: coarse(case, step=1, nearest=1) for case in regress.cases("lines")})
    assert "sodium-d" in {case.id for case in moved.cases if not case.passed}


def test_a_wrong_colour_fails_with_its_reason() -> None:
    case = regress.cases("lamps")[0]
    with pytest.raises(AssertionError, match="A: xyz differs by ΔE2000"):
        case.check(xyz=case.xyz * [1.02, 1, 1])
    with pytest.raises(AssertionError, match="not finite"):
        case.check(xyz=[np.nan, 100, 30])
    case.check(xyz=case.xyz * [1.02, 1, 1], delta_e=3, component=0.05)
    report = regress.judge({case.id: case.xyz / 100 for case in regress.cases()})
    assert report.failed == 264 and report.hint is not None and "0.0100 times" in report.hint
    with pytest.raises(abbe.InputError, match="did you mean"):
        regress.judge({"D56": [1, 2, 3]})
    with pytest.raises(abbe.InputError, match="three numbers"):
        regress.judge({"D65": [1, 2]})
    with pytest.raises(ValueError, match="the groups are"):
        regress.cases("lamp")


def test_the_cases_are_those_of_the_command_line(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "abbe", "regress", "--export", str(tmp_path)]
    subprocess.run(words, check=True, capture_output=True)
    content = json.loads((tmp_path / "set.json").read_text())
    assert content["set"] == regress.set_name() == "abbe-regress 1"
    assert [case["id"] for case in content["cases"]] == [case.id for case in regress.cases()]
    assert all(case.xyz.tolist() == known["xyz"] for case, known in zip(regress.cases(), content["cases"]))
