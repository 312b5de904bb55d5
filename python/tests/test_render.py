"""Renders: pictures, limits, errors, and equality with the command line."""

from __future__ import annotations

import datetime
import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SCENES

import abbe


def command_line(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "abbe", *map(str, words)], capture_output=True, text=True)


def test_arrays_have_the_documented_shapes(scene: dict[str, Any]) -> None:
    picture = abbe.render(scene, passes=8, spectral_bands=10)
    assert (picture.width, picture.height, picture.passes) == (16, 9, 8)
    assert picture.xyz.shape == picture.rgb.shape == picture.srgb.shape == (9, 16, 3)
    assert picture.xyz.dtype == np.float64 and picture.srgb.dtype == np.uint8
    assert picture.noise.shape == picture.bias.shape == picture.edge.shape == (9, 16)
    assert picture.spectrum.shape == (9, 16, 10) and picture.wavelengths.shape == (10,)
    assert picture.wavelengths[0] == pytest.approx(383.5)
    assert not picture.xyz.flags.writeable
    low, high = picture.interval()
    known = np.isfinite(low)
    assert known.any() and (low[known] <= picture.luminance[known]).all() and (high[known] >= low[known]).all()
    assert picture.stats.passes == 8 and picture.stats.error.relative == picture.relative_error
    assert picture.stats.error.typical == picture.typical_error
    assert picture._repr_png_().startswith(b"\x89PNG")


def test_stokes_vectors_analyse_the_light(scene: dict[str, Any]) -> None:
    # Oblique rays pass a polariser at other angles of the picture, so the field of view is small.
    scene["camera"] |= {"at": [0, 0, 0], "lens": {"pinhole": {"fov": 0.5}}, "filter": {"polariser": {"axis": 30}}}
    scene["film"]["stokes"] = True
    picture = abbe.render(scene, passes=8)
    lit = picture.luminance > 0
    assert picture.stokes.shape == (9, 16, 4) and picture.stokes_noise.shape == (9, 16, 3)
    # The squared noise of the Stokes vector is taken from that of the polarised light.
    noise = np.linalg.norm(picture.stokes_noise, axis=-1)[lit] / picture.luminance[lit]
    assert np.all(np.abs(picture.dop[lit] - 1) <= noise**2 + 1e-3)
    assert lit.all() and np.median(picture.dop) > 0.99
    assert np.allclose(picture.analyse(30)[lit], picture.luminance[lit], rtol=1e-4)
    assert np.allclose(picture.analyse(120)[lit], 0, atol=1e-3 * picture.luminance.max())
    with pytest.raises(abbe.InputError, match="film.stokes"):
        _ = abbe.render({**scene, "film": {"width": 4, "height": 4}}, passes=1).stokes


def test_the_luminance_is_the_closed_form(scene: dict[str, Any]) -> None:
    # A Lambertian floor under an isotropic point light: Y = ρ/π · I · cos θ / d².
    scene["camera"] = {"from": [0, 4, 0], "at": [0, 0, 0], "up": [0, 0, -1], "lens": {"pinhole": {"fov": 1}}}
    picture = abbe.render(scene, passes=4)
    d65 = abbe.Spectrum("D65")
    lumens = 683.002 * d65.xyz()[1] / d65.integral() * 10
    expected = 0.5 / np.pi * lumens / (4 * np.pi) / 3**2
    assert picture.luminance[4, 8] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("integrator", ["photon", "path"])
def test_python_and_the_command_line_give_equal_bits(tmp_path: Path, integrator: Any) -> None:
    words = ["--passes", 3, "--size", "40x24", "--seed", 7, "--spectral-bands", 6, "--threads", 2]
    words += ["--integrator", integrator, "--set", 'materials.flint.dielectric.ior="N-BK7"']
    path = tmp_path / "line.exr"
    done = command_line("render", SCENES / "prism.json", "-o", path, "--quiet", *words)
    assert done.returncode == 0, done.stderr
    options: dict[str, Any] = {"passes": 3, "size": (40, 24), "seed": 7, "spectral_bands": 6, "threads": 1}
    change = {"materials.flint.dielectric.ior": "N-BK7"}
    picture = abbe.render(SCENES / "prism.json", set=change, integrator=integrator, **options)
    picture.save(tmp_path / "python.exr")
    picture.save(tmp_path / "python.png")
    line, python = abbe.read(path), abbe.read(tmp_path / "python.exr")
    for name in ["xyz", "noise", "bias", "edge", "spectrum"]:
        assert getattr(line, name).tobytes() == getattr(python, name).tobytes(), name
    assert (tmp_path / "python.png").read_bytes() == path.with_suffix(".png").read_bytes()
    assert line.header["abbe.sceneHash"] == python.header["abbe.sceneHash"]
    # A dictionary of the same content gives the same picture.
    content = json.loads((SCENES / "prism.json").read_text())
    again = abbe.render(content, folder=SCENES, set=change, integrator=integrator, **options)
    assert again.xyz.tobytes() == picture.xyz.tobytes()


def test_the_iterator_ends_with_the_picture_of_render(scene: dict[str, Any]) -> None:
    pictures = list(abbe.passes(scene, passes=4))
    assert [picture.passes for picture in pictures] == [1, 2, 3, 4]
    states = [picture.progress for picture in pictures]
    assert states[0] is not None and states[0].passes_wanted == 4 and states[-1] is None
    assert np.array_equal(pictures[-1].xyz, abbe.render(scene, passes=4).xyz)


def test_leaving_the_loop_stops_the_render(scene: dict[str, Any], tmp_path: Path) -> None:
    checkpoint = tmp_path / "run.exr"
    for picture in abbe.passes(scene, passes=10**9, time=60, checkpoint=checkpoint):
        if picture.passes >= 3:
            break
    del picture
    assert checkpoint.exists()
    passes = abbe.read(checkpoint).passes
    resumed = abbe.render(scene, passes=passes + 2, checkpoint=checkpoint, resume=True)
    assert np.array_equal(resumed.xyz, abbe.render(scene, passes=passes + 2).xyz)
    assert not checkpoint.exists()


def test_limits_stop_the_render(scene: dict[str, Any]) -> None:
    assert abbe.render(scene, time=datetime.timedelta(seconds=0.05)).passes >= 1
    picture = abbe.render(scene, target_error=0.5)
    assert picture.typical_error is not None and picture.typical_error <= 0.5


def test_progress_reports_every_pass(scene: dict[str, Any]) -> None:
    seen: list[abbe.Progress] = []
    abbe.render(scene, passes=5, progress=seen.append)
    assert [state.passes for state in seen] == [1, 2, 3, 4, 5]
    assert str(seen[0]).startswith("1 of 5 passes")


def test_an_exception_of_the_progress_function_ends_the_render(scene: dict[str, Any]) -> None:
    def fail(_: abbe.Progress) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        abbe.render(scene, passes=10**9, time=60, progress=fail)


def test_errors_have_the_text_of_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "wrong.json"
    path.write_text((SCENES / "prism.json").read_text().replace('"fov": 27', '"fov": 270'))
    with pytest.raises(abbe.InputError) as caught:
        abbe.render(path)
    line = command_line("render", path, "-o", tmp_path / "a.exr")
    assert line.returncode == 2 and line.stderr == f"error: {caught.value}\n"
    assert caught.value.path == "camera.lens.pinhole.fov" and caught.value.file == str(path)
    assert isinstance(caught.value, ValueError)
    with pytest.raises(abbe.InputError, match="No such file|cannot be read|does not exist"):
        abbe.render(tmp_path / "missing.json")


@pytest.mark.parametrize(
    "options",
    [{"passes": 0}, {"target_error": 2}, {"time": -1.0}, {"integrator": "paths"}, {"set": {"film.wdth": 3}}],
)
def test_wrong_options_are_input_errors(scene: dict[str, Any], options: dict[str, Any]) -> None:
    with pytest.raises(abbe.InputError):
        abbe.render(scene, **options)


def test_a_scene_may_contain_spectra_and_numpy_values(scene: dict[str, Any]) -> None:
    scene["lights"][0]["point"]["spectrum"] = abbe.Spectrum.from_lines({589.3: 1})
    scene["lights"][0]["point"]["at"] = np.array([0.0, 3.0, 0.0])
    scene["film"]["width"] = np.int64(8)
    picture = abbe.render(scene, passes=1)
    assert picture.width == 8
    x, y, z = picture.xyz[6, 4]
    assert z < 0.01 * y < x
    with pytest.raises(abbe.InputError, match="JSON"):
        abbe.render({"camera": {1, 2}})


def test_pictures_survive_files_and_pickles(scene: dict[str, Any], tmp_path: Path) -> None:
    picture = abbe.render(scene, passes=2)
    copy = pickle.loads(pickle.dumps(picture))
    assert np.array_equal(copy.xyz, picture.xyz.astype(np.float32)) or np.array_equal(copy.xyz, picture.xyz)
    assert copy.passes == 2 and len(copy.stats) == 0
    with pytest.raises(abbe.InputError, match="neither"):
        picture.save(tmp_path / "a.tif")
    with pytest.raises(abbe.InputError, match="spectral"):
        picture.spectrum


def test_xarray_names_dimensions_and_units(scene: dict[str, Any]) -> None:
    pytest.importorskip("xarray")
    data = abbe.render(scene, passes=2, spectral_bands=5).to_xarray()
    assert data["xyz"].dims == ("y", "x", "component") and data["xyz"].attrs["units"] == "cd/m²"
    assert float(data["xyz"].sel(component="Y")[6, 8]) > 0
    assert data["spectrum"].sel(wavelength=600, method="nearest").shape == (9, 16)


def test_check_and_explain(scene: dict[str, Any]) -> None:
    assert abbe.check(scene) == []
    assert "photon" in abbe.explain(SCENES / "prism.json")


def test_the_command_line_is_complete(tmp_path: Path) -> None:
    version = command_line("--version")
    assert version.stdout == f"abbe {abbe.__version__}\n"
    assert command_line("render").returncode == 2
    glass = json.loads(command_line("glass", "N-SF10", "--json").stdout)
    assert glass["nd"] == abbe.glass("N-SF10").nd
