# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the camera, the film and the colour management of Blender."""

from __future__ import annotations

import math
from typing import Any

from mathutils import Matrix, Vector

from . import units
from .files import Folder
from .report import Report

_TONE = {"AgX": "agx", "Khronos PBR Neutral": "pbr_neutral", "Standard": "clip"}


def pose(matrix: Matrix) -> dict[str, Any]:
    """Returns the position and the direction of a camera, which looks along its −z axis."""
    place, turn, _ = matrix.decompose()
    ahead, up = turn @ Vector((0.0, 0.0, -1.0)), turn @ Vector((0.0, 1.0, 0.0))
    return {"from": list(place), "at": list(place + ahead), "up": list(up)}


def lens(thing: Any, placed: Matrix, size: tuple[int, int], folder: Folder, report: Report) -> dict[str, Any]:
    """Returns the lens of a camera for a picture of `size` pixels."""
    camera, owner = thing.data, f"Camera '{thing.name}'"
    if camera.type == "PANO":
        report.missing(owner, "the panoramic projection (a pinhole of 90° instead)")
        return {"pinhole": {"fov": 90.0}}
    if camera.shift_x or camera.shift_y:
        report.missing(owner, "'Shift'")
    if camera.clip_start > 0.1001 or camera.clip_end < 99.9:
        report.missing(owner, "'Clip Start' and 'Clip End'")
    fits_width = units.fits_width(camera.sensor_fit, size)
    if camera.type == "ORTHO":
        return {"orthographic": {"height": camera.ortho_scale * (size[1] / size[0] if fits_width else 1.0)}}
    sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    own, focus = camera.abbe, _focus_distance(camera, placed)
    if own.lens_source != "BLENDER":
        prescription = own.lens if own.lens_source == "LIBRARY" else folder.copy(own.lens_file, owner)
        height = sensor * (size[1] / size[0] if fits_width else 1.0)
        form = {"prescription": prescription, "focus_distance": focus, "sensor_height_mm": height}
        if camera.dof.use_dof:
            form["f_number"] = camera.dof.aperture_fstop
        return {"system": {**form, **_aperture(camera), "ghosts": own.ghosts, "diffraction": own.diffraction}}
    fov = units.vertical_fov(camera.lens, sensor, fits_width, size)
    if not camera.dof.use_dof:
        return {"pinhole": {"fov": fov}}
    if camera.dof.aperture_ratio != 1.0:
        report.missing(owner, "'Ratio' of the aperture")
    angle = units.defocus_angle(camera.lens, camera.dof.aperture_fstop, focus)
    form = {"fov": fov, "focus_distance": focus, "defocus_angle": angle, "diffraction": own.diffraction}
    return {"thin": {**form, **_aperture(camera)}}


def _aperture(camera: Any) -> dict[str, Any]:
    blades = camera.dof.aperture_blades
    return {"blades": blades, "rotation": math.degrees(camera.dof.aperture_rotation)} if blades >= 3 else {}


def _focus_distance(camera: Any, placed: Matrix) -> float:
    target = camera.dof.focus_object
    if target is None:
        return max(1e-3, camera.dof.focus_distance)
    ahead = placed.to_quaternion() @ Vector((0.0, 0.0, -1.0))
    return max(1e-3, abs((target.matrix_world.to_translation() - placed.to_translation()).dot(ahead)))


def film(scene: Any, layer: Any, size: tuple[int, int], report: Report) -> dict[str, Any]:
    """Returns the film: the size, the layers, and how the PNG of Abbe looks like Blender's view."""
    own, view, render = scene.abbe, scene.view_settings, scene.render
    form: dict[str, Any] = {"width": size[0], "height": size[1], "layers": layers(layer)}
    form["exposure"] = {"ev": units.exposure_ev(view.exposure, own.efficacy)}
    form["denoise"] = needs_denoiser(scene, layer)
    if own.spectral_bands:
        form["spectral_bands"] = own.spectral_bands
    if view.view_transform in _TONE:
        form["tone"] = _TONE[view.view_transform]
    elif view.view_transform not in {"", "NONE"}:
        report.missing("Color management", f"the view transform '{view.view_transform}' in the PNG of Abbe")
    changed = [view.look not in {"None", "NONE", ""} and f"the look '{view.look}'", view.gamma != 1.0 and "'Gamma'"]
    changed += [view.use_curve_mapping and "the curves", getattr(view, "use_white_balance", False) and "white balance"]
    for what in filter(None, changed):
        report.missing("Color management", f"{what} in the PNG of Abbe (Blender's view has it)")
    if render.film_transparent:
        report.missing("Film", "'Transparent'")
    if render.use_multiview:
        report.missing("Output", "stereoscopy")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        report.missing("Output", "the aspect of pixels")
    if scene.unit_settings.scale_length != 1.0:
        report.missing("Scene units", "'Unit Scale' (1 Blender unit is 1 m)")
    return form


def needs_denoiser(scene: Any, layer: Any) -> bool:
    """Returns true if Blender shows the denoised picture, or has it as a pass."""
    return scene.abbe.combined == "DENOISED" or layer.abbe.use_pass_denoised


def layers(layer: Any) -> list[str]:
    """Returns the layers of the EXR that the passes of a view layer need."""
    wanted = {
        "albedo": layer.abbe.use_pass_albedo,
        "normal": layer.use_pass_normal,
        "depth": layer.use_pass_z,
        "object": layer.use_pass_cryptomatte_object,
        "material": layer.use_pass_cryptomatte_material,
        "paths": layer.abbe.use_pass_paths,
        "lights": layer.abbe.use_layer_lights,
    }
    return [name for name, is_wanted in wanted.items() if is_wanted]
