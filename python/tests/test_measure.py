"""Measurements with meters."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SCENES

import abbe


@pytest.fixture
def lamp() -> dict[str, Any]:
    """A lamp of 100 lm, 2 m above a meter."""
    return {
        "materials": {},
        "objects": [],
        "lights": [{"point": {"at": [0, 2, 0], "spectrum": "D65", "luminous_flux": 100}}],
        "meters": [
            {"name": "desk", "points": [[0, 0, 0], [2, 0, 0]]},
            {"name": "spectrum", "quantity": "spectral_irradiance", "points": [[0, 0, 0]]},
        ],
    }


def test_readings_are_those_of_the_inverse_square_law(lamp: dict[str, Any]) -> None:
    measurement = abbe.measure(lamp, passes=16, threads=1)
    desk = measurement.meter("desk")
    expected = 100 / (4 * math.pi * 4)
    assert (desk.unit, desk.quantity) == ("lx", "illuminance")
    assert desk.value == pytest.approx([expected, expected / math.sqrt(8)], rel=1e-3)
    assert desk.positions.tolist() == [[0, 0, 0], [2, 0, 0]]
    assert desk.noise.shape == desk.bias.shape == (2,)
    low, high = desk.interval()
    assert (low <= desk.value).all() and (desk.value <= high).all()
    spectrum = measurement.meter("spectrum")
    assert spectrum.value.shape == (1, len(spectrum["wavelength_nm"])) and np.isfinite(spectrum.value).all()
    assert [meter.name for meter in measurement.meters] == ["desk", "spectrum"]
    with pytest.raises(KeyError, match="desk"):
        measurement.meter("chair")


def test_readings_are_those_of_the_command_line() -> None:
    scene = SCENES / "daylit_room.json"
    options = ["--passes", "16", "--meter", "desk", "--seed", "3", "--json", "--quiet"]
    words = [sys.executable, "-m", "abbe", "measure", str(scene), *options]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    known = json.loads(done.stdout)
    found = abbe.measure(scene, passes=16, meters=["desk"], seed=3)
    assert found.to_dict()["meters"] == known["meters"] and found.passes == 16


def test_requirements_are_judged_as_on_the_command_line(lamp: dict[str, Any], tmp_path: Path) -> None:
    assert abbe.measure(lamp, passes=16).requirements == []
    lamp["requirements"] = [
        {"meter": "desk", "mean_at_least": 500, "source": "EN 12464-1"},
        {"meter": "desk", "at_most": 100},
    ]
    path = tmp_path / "room.json"
    path.write_text(json.dumps(lamp))
    words = [sys.executable, "-m", "abbe", "measure", str(path), "--passes", "16", "--json", "--quiet"]
    known = json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
    page = tmp_path / "room.html"
    measurement = abbe.measure(path, passes=16, html=page)
    assert [judgement.to_dict() for judgement in measurement.requirements] == known["requirements"]
    mean, largest = measurement.requirements
    assert (mean.verdict, mean.source, mean.limit) == ("not_met", "EN 12464-1", 500)
    assert (largest.verdict, largest.source) == ("met", None)
    assert mean.interval_95 is not None and mean.value is not None
    assert mean.interval_95[0] <= mean.value <= mean.interval_95[1]
    assert "EN 12464-1" in page.read_text() and "not met" in page.read_text()
    only = abbe.measure(lamp, passes=16, meters=["spectrum"])
    assert only.requirements == []


def test_wrong_arguments_are_input_errors(lamp: dict[str, Any]) -> None:
    with pytest.raises(abbe.InputError, match="desk"):
        abbe.measure(lamp, meters=["desc"])
    with pytest.raises(abbe.InputError, match="seconds"):
        abbe.measure(lamp, time=-1)
    with pytest.raises(abbe.InputError, match="photon or path"):
        abbe.measure(lamp, integrator="bidirectional")  # type: ignore[arg-type]
