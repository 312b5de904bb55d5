"""Glasses, lenses, spectra, lamps and studies."""

from __future__ import annotations

import json
import math
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abbe

from conftest import ROOT


def command_line(*words: object) -> Any:
    done = subprocess.run([sys.executable, "-m", "abbe", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_glass_has_the_index_of_its_data_sheet() -> None:
    glass = abbe.glass("N-BK7")
    # Sellmeier coefficients of the Schott data sheet.
    b, c = [1.03961212, 0.231792344, 1.01046945], [0.00600069867, 0.0200179144, 103.560653]
    for nm in [404.66, 587.5618, 706.52]:
        square = (nm / 1000) ** 2
        n = math.sqrt(1 + sum(bi * square / (square - ci) for bi, ci in zip(b, c)))
        assert glass.n(nm) == pytest.approx(n, abs=1e-9)
    index = glass.n(np.array([[400.0, 500.0], [600.0, 700.0]]))
    assert isinstance(index, np.ndarray) and index.shape == (2, 2) and (np.diff(index.ravel()) < 0).all()
    assert glass.to_dict() == command_line("glass", "N-BK7", "--json")
    assert "N-BK7" in abbe.glasses()


def test_a_wavelength_outside_the_data_is_an_error() -> None:
    with pytest.raises(abbe.InputError, match="wavelengths from"):
        abbe.glass("N-BK7").n(9000)


def test_an_unknown_glass_suggests_a_name() -> None:
    with pytest.raises(abbe.InputError) as caught:
        abbe.glass("SF 10")
    assert caught.value.suggestion in ("SF10", "N-SF10")


def test_lens_reports_are_those_of_the_command_line(tmp_path: Path) -> None:
    name = abbe.lenses()[0]
    report = abbe.lens(name, svg=tmp_path / "lens.svg")
    assert report.to_dict() == command_line("lens", name, "--json")
    assert (tmp_path / "lens.svg").read_text().startswith("<svg")
    with pytest.raises(abbe.InputError):
        abbe.lens("no such lens")


def test_a_lens_is_analysed_under_the_conditions_of_the_command_line() -> None:
    name = "double gauss"
    report = abbe.lens(name, field=10, wavelengths=[450, 550, 650], focus=-0.1)
    words = ["--field", 10, "--wavelengths", "450,550,650", "--focus=-0.1", "--json"]
    assert report.to_dict() == command_line("lens", name, *words)
    best = abbe.lens(name, focus="best")
    assert best.to_dict() == command_line("lens", name, "--focus", "best", "--json")
    assert best.to_dict() != abbe.lens(name).to_dict()
    for wrong in (
        {"wavelengths": [550, 550]},
        {"wavelengths": [1550]},
        {"focus": math.nan},
        {"focus": "least"},
        {"field": 90},
    ):
        with pytest.raises(abbe.InputError, match=next(iter(wrong))):
            abbe.lens(name, **wrong)


def test_plots_and_the_page_of_a_lens_are_those_of_the_command_line(tmp_path: Path) -> None:
    name = "double gauss"
    files = [tmp_path / "theirs.svg", tmp_path / "theirs.html"]
    report = abbe.lens(name, svg=tmp_path / "ours.svg", plot="mtf", html=tmp_path / "ours.html")
    command_line("lens", name, "--svg", files[0], "--plot", "mtf", "--html", files[1], "--json")
    assert files[0].read_text() == report.plot("mtf") == (tmp_path / "ours.svg").read_text()
    assert files[1].read_text() == report.page() == (tmp_path / "ours.html").read_text()
    plots = {plot: report.plot(plot) for plot in abbe.lens_plots()}  # type: ignore[arg-type]
    assert len(set(plots.values())) == 9 and all(plot.startswith("<svg") for plot in plots.values())
    assert report._repr_svg_() == plots["section"]
    with pytest.raises(abbe.InputError, match="did you mean \"spots\""):
        report.plot("spot")  # type: ignore[arg-type]
    copy = pickle.loads(pickle.dumps(report))
    assert copy.to_dict() == report.to_dict() and copy._repr_svg_() is None
    with pytest.raises(TypeError, match="call abbe.lens again"):
        copy.plot()


def test_lamp_reports_are_those_of_the_command_line(tmp_path: Path) -> None:
    lines = ["{\"lines\": [{\"nm\": 660, \"power\": 1}]}", "{\"lines\": [{\"nm\": 540, \"power\": 1}]}"]
    red, green = abbe.Spectrum.from_lines({660: 1}), abbe.Spectrum.from_lines({540: 1})
    report = abbe.compare_lamps("sodium-low-pressure", match=[red, green], html=tmp_path / "lamps.html")
    other = command_line("lamps", "sodium-low-pressure", "--match", *lines, "--json")
    assert report.delta_e_2000.to_dict() == other["delta_e_2000"]
    assert "<html" in (tmp_path / "lamps.html").read_text()
    three = abbe.compare_lamps("D65", "A", "led/red") if "led/red" in abbe.spectra() else abbe.compare_lamps("D65", "A", "E")
    assert three.c is not None


def test_a_spectrum_has_values_colours_and_a_scene_form() -> None:
    table = abbe.Spectrum.from_table([400, 500, 600], [0, 1, 0])
    assert table(450) == pytest.approx(0.5) and table(700) == 0
    assert np.allclose(table([450, 550]), 0.5)
    assert table.integral() == pytest.approx(100)
    assert abbe.Spectrum(table).scene == table.scene
    assert pickle.loads(pickle.dumps(table)).scene == table.scene
    assert abbe.Spectrum("D65").colour().to_dict() == command_line("spectrum", "D65", "--json")
    grey = abbe.Spectrum(0.5, role="reflectance")
    assert grey.colour(under="A").xyz[1] == pytest.approx(50)
    with pytest.raises(abbe.InputError):
        abbe.Spectrum("no-such-lamp")
    with pytest.raises(abbe.InputError):
        abbe.Spectrum("D65", role="lamp")  # type: ignore[arg-type]


def test_lines_keep_their_power_in_means() -> None:
    lines = abbe.Spectrum.from_lines({500.25: 3, 600: 1})
    assert lines.lines == pytest.approx({500.25: 3, 600: 1})
    assert np.sum(lines.means(np.arange(360.0, 831.0))) == pytest.approx(4)


def test_spectra_exchange_with_colour_science() -> None:
    colour = pytest.importorskip("colour")
    theirs = colour.SDS_ILLUMINANTS["FL2"]
    ours = abbe.Spectrum.from_colour(theirs)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    xyz = np.asarray(colour.sd_to_XYZ(theirs, cmfs=cmfs, method="Integration"))
    expected = xyz / xyz[1] * 100
    assert ours.colour().xyz == pytest.approx(expected, abs=0.05)
    back = ours.to_colour()
    assert back.wavelengths[0] == 360 and back[560] == pytest.approx(theirs[560], rel=0.02)
    pair = colour.MultiSpectralDistributions({500: [1, 2], 600: [2, 1], 700: [0, 0]}, labels=["one", "two"])
    both = abbe.spectra_from_colour(pair)
    assert list(both) == ["one", "two"] and both["two"](500) == pytest.approx(2)


def test_a_picture_exchanges_with_colour_science(scene: dict[str, Any]) -> None:
    pytest.importorskip("colour")
    picture = abbe.render(scene, passes=2, spectral_bands=47)
    distribution = picture.to_colour(8, 7)
    assert distribution.wavelengths[0] == pytest.approx(365)
    assert np.allclose(distribution.values, picture.spectrum[7, 8])


def test_a_study_returns_its_report(scene: dict[str, Any], tmp_path: Path) -> None:
    steps: list[str] = []
    report = abbe.study(scene, tmp_path / "study", budget=2, progress=steps.append)
    assert steps and len(report.curves) == 2
    assert any(path.suffix == ".html" for path in (tmp_path / "study").iterdir())


def test_reports_are_read_only() -> None:
    report = abbe.Report({"a": {"b": [1, {"c": 2}]}})
    assert report.a.b[1].c == 2 and report.to_dict() == {"a": {"b": [1, {"c": 2}]}}
    assert pickle.loads(pickle.dumps(report)) == report
    with pytest.raises(AttributeError):
        report.a = 1
    with pytest.raises(AttributeError, match="it has a"):
        report.d


def first_order(optic: Any) -> list[float]:
    """Returns the focal length and the f-number at the primary wavelength."""
    return [float(np.ravel(value)[0]) for value in (optic.paraxial.f2(), optic.paraxial.FNO())]


def test_lenses_of_optiland_keep_their_first_order_properties() -> None:
    objectives = pytest.importorskip("optiland.samples.objectives")
    for name in ("HeliarLens", "TessarLens"):
        optic = getattr(objectives, name)()
        report = abbe.lens(abbe.lens_from_optiland(optic), field=1)
        assert [report.efl_mm, report.f_number] == pytest.approx(first_order(optic), rel=1e-6)


def test_optiland_traces_the_lenses_of_abbe() -> None:
    pytest.importorskip("optiland")
    for name in abbe.lenses():
        report, optic = abbe.lens(name), abbe.lens_to_optiland(name)
        assert first_order(optic) == pytest.approx([report.efl_mm, report.f_number], rel=1e-6)
    report, optic = abbe.lens("double gauss"), abbe.lens_to_optiland("double gauss")
    # The marginal ray of the axis at the d line.
    fan = report.fields[0].ray_fans[1]
    ray = optic.trace_generic(0, 0, 0, 1, 0.5875618)
    assert float(ray.y[0]) == pytest.approx(fan.tangential_mm[-1], rel=1e-3)


def test_a_lens_survives_the_way_to_optiland_and_back() -> None:
    pytest.importorskip("optiland")
    aspheric = {
        "surfaces": [
            {
                "radius_mm": 50, "conic": -0.6, "aspheric": [1e-7, 2e-10], "thickness_mm": 8, "ior": "N-SF66",
                "semi_aperture_mm": 12,
            },
            {"radius_mm": None, "thickness_mm": 2, "ior": 1, "semi_aperture_mm": 12},
            {"radius_mm": None, "thickness_mm": 50, "ior": 1, "semi_aperture_mm": 8, "stop": True},
        ]
    }
    there = abbe.lens(aspheric, field=3)
    back = abbe.lens(abbe.lens_from_optiland(abbe.lens_to_optiland(aspheric)), field=3)
    assert back.efl_mm == pytest.approx(there.efl_mm, rel=1e-6)
    assert back.f_number == pytest.approx(there.f_number, rel=1e-6)
    for one, other in zip(there.fields, back.fields):
        assert other.image_height_mm == pytest.approx(one.image_height_mm, rel=1e-6)
        for spot, same in zip(one.spots, other.spots):
            assert same.rms_mm == pytest.approx(spot.rms_mm, rel=1e-3)


def test_mirrors_of_optiland_are_refused() -> None:
    optic_module = pytest.importorskip("optiland.optic")
    optic = optic_module.Optic()
    optic.surfaces.add(index=0, thickness=math.inf)
    optic.surfaces.add(index=1, radius=-200, thickness=-100, material="mirror", is_stop=True)
    optic.surfaces.add(index=2)
    optic.set_aperture("EPD", 20)
    optic.fields.set_type("angle")
    optic.fields.add(y=0)
    optic.wavelengths.add(0.5876, is_primary=True)
    with pytest.raises(ValueError, match="surface 1 of the lens: a mirror is not supported"):
        abbe.lens_from_optiland(optic)


def test_the_guide_shows_the_values() -> None:
    """A number in a comment behind an expression of the guide is the value of the expression."""
    guide = (ROOT / "docs" / "guide" / "python.md").read_text(encoding="utf-8")
    shown = re.findall(r"^(abbe\..*\S)\s+# (\d+\.(\d+))$", guide, re.MULTILINE)
    assert shown
    for expression, number, digits in shown:
        assert f"{eval(expression, {'abbe': abbe}):.{len(digits)}f}" == number, expression
