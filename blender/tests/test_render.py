# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders through the add-on: bits, passes, progress, cancelling, and what goes wrong."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from conftest import PROGRAM


def suzanne(studio: Any) -> Any:
    """Adds Suzanne in dense flint, a lamp and a floor."""
    studio.scene.abbe.photons = 20_000
    studio.camera((0, -5, 2.4), (1.2, 0, 0))
    studio.floor()
    studio.light("AREA", 300, (2, -2, 4), size=1).rotation_euler = (0.5, 0.4, 0)
    bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 1))
    thing = bpy.context.object
    thing.modifiers.new("Smooth", "SUBSURF").render_levels = 1
    bpy.ops.object.shade_smooth()
    glass = studio.material("Flint")
    glass.abbe.surface, glass.abbe.glass = "GLASS", "N-SF11"
    thing.data.materials.append(glass)
    return thing


def test_suzanne_in_flint_has_the_bits_of_the_command_line(studio: Any) -> None:
    from abbe_blender import exr

    suzanne(studio)
    shown = studio.render()
    exported = studio.exported
    assert exported.content["materials"]["Flint"] == {"dielectric": {"ior": "N-SF11", "roughness": 0.0}}
    again = exported.scene.parent / "again.exr"
    command = [PROGRAM, "render", str(exported.scene), "-o", str(again), "--reproducible", "--quiet"]
    subprocess.run(command, check=True)
    assert again.read_bytes() == exported.picture.read_bytes()
    picture = exr.read(again)
    light = np.stack([picture.channels[letter] for letter in "RGB"], -1)[::-1] / np.float32(683)
    assert np.array_equal(light, shown)
    assert light.mean() > 0.01


def test_the_passes_are_the_layers_of_the_file(studio: Any) -> None:
    from abbe_blender import exr

    suzanne(studio)
    own, layer = studio.layer.abbe, studio.layer
    for name in ("noise", "bias", "denoised", "albedo", "paths"):
        setattr(own, f"use_pass_{name}", True)
    layer.use_pass_z = layer.use_pass_normal = True
    layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_material = True
    own.use_layer_lights = True
    studio.scene.abbe.spectral_bands = 8
    studio.render()
    saved, disk = exr.read(studio.layers("OPEN_EXR_MULTILAYER")), exr.read(studio.exported.picture)
    found = {name.split(".", 1)[1]: layer for name, layer in saved.channels.items()}
    efficacy = np.float32(683)
    expected = {
        "Denoised.R": disk.channels["denoised.R"] / efficacy,
        "Albedo.G": disk.channels["albedo.G"],
        "Normal.Z": disk.channels["normal.Z"],
        "Caustic Light.B": disk.channels["path.caustic.B"] / efficacy,
        "CryptoObject00.R": disk.channels["CryptoObject00.R"],
        "CryptoObject00.G": disk.channels["CryptoObject00.G"],
        "CryptoMaterial00.G": disk.channels["CryptoMaterial00.G"],
    }
    for name, layer in expected.items():
        key = name.replace(".R", ".r").replace(".G", ".g") if name not in found and "Crypto" in name else name
        assert np.array_equal(found[key], layer), name
        assert np.ptp(layer) > 0.0, name
    for name in ("Noise.X", "Bias.X"):
        layer = disk.channels[f"error.{name[:-2].lower()}"]
        assert np.array_equal(found[name], np.where(layer < 0, layer, layer / efficacy)), name
    assert (found["Depth.V"] if "Depth.V" in found else found["Depth.Z"]).max() <= np.float32(1e10)
    assert sum(name.startswith("S0.") for name in disk.channels) == 8
    assert any(name.startswith("light.Area.") for name in disk.channels)
    manifests = [text for name, text in saved.header.items() if name.endswith("/manifest")]
    assert any(b"Suzanne" in text for text in manifests)


def test_the_denoised_picture_can_be_the_combined_pass(studio: Any) -> None:
    from abbe_blender import exr

    suzanne(studio)
    studio.scene.abbe.combined = "DENOISED"
    shown, disk = studio.render(), exr.read(studio.exported.picture)
    assert np.array_equal(shown[::-1, :, 0], disk.channels["denoised.R"] / np.float32(683))
    assert not np.array_equal(disk.channels["R"], disk.channels["denoised.R"])


def test_lumens_per_watt_do_not_change_the_picture(studio: Any) -> None:
    suzanne(studio)
    studio.world((0.1, 0.2, 0.3))
    first = studio.render()
    studio.scene.abbe.efficacy = 170.75
    second = studio.render()
    assert studio.exported.content["objects"][1]["emission"]["luminous_flux"] == pytest.approx(300 * 170.75)
    assert np.abs(second - first).max() < 1e-4 * first.max()


def test_blender_and_the_png_of_abbe_are_equally_bright(studio: Any) -> None:
    suzanne(studio)
    studio.world((0.2, 0.2, 0.2))
    studio.scene.view_settings.view_transform = "Standard"
    studio.scene.view_settings.exposure = 0.7
    studio.render()
    settings = studio.scene.render.image_settings
    settings.file_format, settings.color_depth = "PNG", "8"
    bpy.data.images["Render Result"].save_render(str(studio.folder / "view.png"))
    pictures = []
    for path in (studio.folder / "view.png", studio.exported.picture.with_suffix(".png")):
        image = bpy.data.images.load(str(path))
        pictures.append(np.array(image.pixels[:]).reshape(64, 64, 4)[..., :3])
    # Both round to 8 bits. Abbe compresses colours outside sRGB, and Blender clips them.
    assert np.median(np.abs(pictures[0] - pictures[1])) <= 1.01 / 255
    assert abs(pictures[0].mean() - pictures[1].mean()) < 0.005


def test_a_render_region_is_a_part_of_the_picture(studio: Any) -> None:
    suzanne(studio)
    studio.scene.render.resolution_y = 40
    whole, render = studio.render(), studio.scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.26, 0.76, 0.3, 0.9
    cycles = studio.render("CYCLES")
    part = studio.render()
    assert part.shape == cycles.shape == (24, 32, 3)
    assert np.array_equal(part, whole[12:36, 16:48])


def test_the_picture_grows_while_it_renders(studio: Any, monkeypatch: Any) -> None:
    from abbe_blender.engine import AbbeRenderEngine

    suzanne(studio)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 256
    studio.scene.abbe.passes = 24
    seen = []
    show = AbbeRenderEngine._show_progress
    monkeypatch.setattr(AbbeRenderEngine, "_show_progress", lambda *args: (seen.append(args[2].done), show(*args)))
    studio.render()
    assert seen == sorted(seen)
    assert len({done for done in seen if 0 < done < 24}) >= 1, seen


def test_a_cancelled_render_keeps_its_finished_passes(studio: Any, monkeypatch: Any) -> None:
    from abbe_blender import exr
    from abbe_blender.engine import AbbeRenderEngine, _passes_of

    suzanne(studio)
    studio.scene.abbe.passes = 100_000

    def is_cancelled(_engine: Any) -> bool:
        path = AbbeRenderEngine.last.picture
        return path.is_file() and _passes_of(exr.read(path), studio.scene).done > 0

    monkeypatch.setattr(AbbeRenderEngine, "is_cancelled", is_cancelled)
    shown = studio.render()
    picture = exr.read(studio.exported.picture)
    assert 0 < _passes_of(picture, studio.scene).done < 100_000
    assert np.array_equal(shown[::-1, :, 0], picture.channels["R"] / np.float32(683))


def test_a_time_limit_and_a_target_error_stop_the_render(studio: Any) -> None:
    from abbe_blender.engine import render_options

    suzanne(studio)
    own = studio.scene.abbe
    own.passes, own.time_limit, own.target_error, own.integrator = 100_000, 1.0, 50.0, "PATH"
    assert render_options(studio.scene) == [
        "--reproducible", "--time", "1s", "--target-error", "50%", "--integrator", "path",
    ]  # fmt: skip
    assert studio.render().mean() > 0.0


def test_an_animation_has_a_folder_for_each_frame(studio: Any) -> None:
    thing = suzanne(studio)
    thing.location.x = 0
    thing.keyframe_insert("location", frame=1)
    thing.location.x = 2
    thing.keyframe_insert("location", frame=3)
    studio.scene.frame_start, studio.scene.frame_end, studio.scene.abbe.passes = 1, 2, 1
    studio.scene.render.filepath = str(studio.folder / "frame-")
    bpy.ops.render.render(animation=True)
    folders = sorted(path.name for path in (studio.folder / "abbe").iterdir())
    assert folders == ["Scene-0001", "Scene-0002"]
    assert len(list(studio.folder.glob("frame-*.png"))) == 2


def test_an_error_while_rendering_ends_the_program(studio: Any, monkeypatch: Any) -> None:
    from abbe_blender import exr, program

    suzanne(studio)
    studio.scene.abbe.passes = 100_000
    runs: list[Any] = []
    start = program.Render.__init__
    monkeypatch.setattr(program.Render, "__init__", lambda run, *args: (runs.append(run), start(run, *args))[1])

    def fail(_path: Path) -> Any:
        raise ValueError("the picture is damaged")

    monkeypatch.setattr(exr, "read", fail)
    assert "the picture is damaged" in failure(studio)
    assert runs[0]._process.wait(timeout=20) == 130


def failure(studio: Any) -> str:
    with pytest.raises(RuntimeError) as caught:
        studio.render()
    return str(caught.value)


def test_a_wrong_path_of_the_program_is_named(studio: Any) -> None:
    suzanne(studio)
    studio.preferences.program = "/nowhere/abbe"
    assert "'/nowhere/abbe' does not exist; set its path in the preferences" in failure(studio)
    studio.preferences.program = sys.executable
    assert "is not Abbe" in failure(studio)


def test_a_scene_without_light_or_camera_is_named(studio: Any) -> None:
    studio.floor()
    assert "no camera" in failure(studio)
    studio.camera()
    assert "the scene has no light" in failure(studio)


def test_an_error_of_the_program_reaches_the_user(studio: Any) -> None:
    suzanne(studio)
    bpy.data.materials["Flint"].abbe.glass = "N-SF99"
    assert "N-SF99" in failure(studio)


def test_a_missing_texture_is_magenta_and_named(studio: Any) -> None:
    studio.camera()
    floor = studio.floor()
    studio.world()
    material = studio.material("Wood", "ShaderNodeBsdfDiffuse")
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    image = bpy.data.images.new("wood.png", 4, 4)
    image.source, image.filepath = "FILE", str(studio.folder / "wood.png")
    texture.image = image
    material.node_tree.links.new(texture.outputs[0], material.node_tree.nodes["Diffuse BSDF"].inputs["Color"])
    floor.data.materials[0] = material
    red, green, _ = studio.render()[:24].mean(axis=(0, 1))
    assert green < 0.3 * red
    assert any("the file of the image 'wood.png' does not exist" in line for line in studio.exported.report.lines)


def test_a_missing_spectrum_is_an_error(studio: Any) -> None:
    suzanne(studio)
    own = bpy.data.lights["Area"].abbe
    own.spectrum_source, own.spectrum_file = "FILE", "//lamp.csv"
    assert "Light 'Area': the file '//lamp.csv' does not exist" in failure(studio)


def test_meters_are_read_into_a_text(studio: Any) -> None:
    studio.camera()
    studio.floor()
    studio.light("SUN", 1.0)
    empty = studio.add("Desk", None, (0, 0, 1))
    empty.abbe.meter = "illuminance"
    assert bpy.ops.abbe.measure() == {"FINISHED"}
    text = bpy.data.texts["Abbe Meters"].as_string()
    assert "Desk" in text and "683" in text, text


def test_the_archive_is_valid_and_installs_as_an_extension(studio: Any, tmp_path: Path) -> None:
    package = Path(__file__).parents[1] / "abbe_blender"
    tool = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    archive = tmp_path / "abbe_blender.zip"
    build = [sys.executable, str(tool), "build", "--source-dir", str(package), "--output-filepath", str(archive)]
    done = subprocess.run(build, capture_output=True, text=True, check=False)
    assert archive.is_file(), done.stdout + done.stderr
    script = (
        "import bpy, sys; bpy.ops.extensions.package_install_files(repo='user_default', filepath=sys.argv[1]); "
        "key = 'bl_ext.user_default.abbe_blender'; addon = bpy.context.preferences.addons[key]; "
        "bpy.context.scene.render.engine = 'ABBE'; print('installed', addon.preferences.program)"
    )
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")}
    done = subprocess.run([sys.executable, "-c", script, str(archive)], env=environment, capture_output=True, text=True)
    assert "installed abbe" in done.stdout, done.stdout + done.stderr
