# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a scene of Blender as a scene file of Abbe, with its meshes and pictures beside it.

The scene keeps the axes of Blender: z is up. One unit of Blender is 1 m.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from . import camera, lights, materials, media, meshes, units
from .files import Folder
from .nodes import SocketReader
from .report import Report

#: The number of keyframes while the shutter is open.
_KEYFRAMES = 5
#: The types of objects that render, but have no counterpart.
_MISSING_TYPES = {"CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL", "GPENCIL"}
#: The samples of the transmission of a shutter over time.
_SHUTTER_SAMPLES = 17


@dataclass
class Exported:
    """An exported scene: its files, and what it lacks."""

    scene: Path
    picture: Path
    report: Report
    content: dict[str, Any]


def folder_of(scene: Any, layer: Any, frame: int | None) -> Path:
    """Returns the folder of the files of a scene. `frame` is its number in an animation."""
    own = scene.abbe.folder
    if own.startswith("//") and not bpy.data.filepath:
        base = Path(bpy.app.tempdir) / "abbe"
    else:
        base = Path(bpy.path.abspath(own))
    name = scene.name if len(scene.view_layers) == 1 else f"{scene.name}-{layer.name}"
    name = re.sub(r"[^\w.-]+", "_", name)
    return base / (name if frame is None else f"{name}-{frame:04}")


def export(depsgraph: Any, folder: Path, frame_set: Callable[..., None]) -> Exported:
    """Writes the scene of a dependency graph. `frame_set` evaluates the graph at another frame.

    Raises MissingFile if a spectrum or a prescription that the scene names does not exist, and
    ValueError if the scene has no camera.
    """
    return _Export(depsgraph, folder, frame_set).run()


class _Export:
    def __init__(self, depsgraph: Any, folder: Path, frame_set: Callable[..., None]) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.depsgraph, self.frame_set, self.report = depsgraph, frame_set, Report()
        self.scene, self.layer = depsgraph.scene_eval, depsgraph.view_layer_eval
        self.files = Folder(folder, self.report)
        efficacy = self.scene.abbe.efficacy
        self.meshes = meshes.Meshes(self.files)
        self.materials = materials.Materials(self.files, self.report, efficacy)
        self.lights = lights.Lights(self.files, self.report, efficacy)
        render = self.scene.render
        percent = render.resolution_percentage
        self.size = (max(1, render.resolution_x * percent // 100), max(1, render.resolution_y * percent // 100))
        self.content: dict[str, Any] = {"objects": [], "lights": [], "meters": []}

    def run(self) -> Exported:
        poses = self._poses()
        # Another frame may have replaced the evaluated data.
        self.scene, self.layer = self.depsgraph.scene_eval, self.depsgraph.view_layer_eval
        form: dict[str, Any] = {"title": self.scene.name, "unit": "m", "camera": self._camera(poses)}
        form["film"] = camera.film(self.scene, self.layer, self.size, self.report)
        for instance in self.depsgraph.object_instances:
            if instance.show_self:
                self._instance(instance, poses)
        world = lights.world_light(self.scene.world, self.files, self.report, self.scene.abbe.efficacy)
        if world is not None:
            self.content["lights"].append(world)
        fog = self._fog()
        if fog is not None:
            self.materials.media["fog"] = fog
            form["atmosphere"] = "fog"
        used = {thing["material"] for thing in self.content["objects"]}
        if lights.CLEAR in used:
            self.materials.materials[lights.CLEAR] = {"thin_dielectric": {"ior": 1}}
        form |= {"media": self.materials.media, "materials": self.materials.materials, "shapes": self.meshes.shapes}
        form |= {**self.content, "render": self._settings()}
        path = self.files.path / "scene.json"
        path.write_text(_json(form), encoding="utf-8")
        (self.files.path / "report.txt").write_text(self.report.text(), encoding="utf-8")
        return Exported(path, self.files.path / "scene.exr", self.report, form)

    def _fog(self) -> dict[str, Any] | None:
        world = self.scene.world
        if world is None or world.abbe.use_medium:
            return media.panel_medium(world.abbe) if world is not None else None
        read = SocketReader(f"World '{world.name}'", self.files, self.report)
        return media.node_medium(world.node_tree, read) if world.node_tree is not None else None

    def _poses(self) -> list[tuple[float, dict[Any, Matrix]]]:
        """Returns times in s while the shutter is open, and the matrices of all instances."""
        render = self.scene.render
        if not render.use_motion_blur or render.motion_blur_shutter <= 0.0:
            return []
        cycles = getattr(self.scene, "cycles", None)
        if cycles is not None and cycles.rolling_shutter_type != "NONE":
            self.report.missing("Motion blur", "the rolling shutter")
        start, end = units.shutter(render.motion_blur_position, render.motion_blur_shutter)
        frame, fps = self.scene.frame_current, render.fps / render.fps_base
        poses = []
        for step in range(_KEYFRAMES):
            offset = start + (end - start) * step / (_KEYFRAMES - 1)
            whole = math.floor(frame + offset)
            self.frame_set(whole, subframe=frame + offset - whole)
            matrices = {_identity(it): it.matrix_world.copy() for it in self.depsgraph.object_instances}
            matrices["camera"] = self.scene.camera.matrix_world.copy()
            poses.append((offset / fps, matrices))
        self.frame_set(frame, subframe=0.0)
        return poses

    def _motion(self, key: Any, poses: list[Any], owner: str) -> list[tuple[float, Matrix]]:
        """Returns the keyframes of an instance, or nothing if it rests."""
        found = [(time, matrices[key]) for time, matrices in poses if key in matrices]
        if len(found) < 2 or all(_close(matrix, found[0][1]) for _, matrix in found):
            return []
        if any(not _is_plain(matrix) for _, matrix in found):
            self.report.missing(owner, "the motion of a sheared or flat object")
            return []
        return found

    def _camera(self, poses: list[Any]) -> dict[str, Any]:
        thing = self.scene.camera
        if thing is None:
            raise ValueError("the scene has no camera")
        placed = thing.matrix_world.copy()
        form = {**camera.pose(placed), "lens": camera.lens(thing, placed, self.size, self.files, self.report)}
        if poses:
            form["shutter"] = {"open": poses[0][0], "close": poses[-1][0]}
            curve = self._shutter_curve()
            if curve is not None:
                form["shutter"]["curve"] = curve
            motion = self._motion("camera", poses, f"Camera '{thing.name}'")
            if motion:
                form["motion"] = [{"time": time, **camera.pose(matrix)} for time, matrix in motion]
        return form

    def _shutter_curve(self) -> list[list[float]] | None:
        mapping = self.scene.render.motion_blur_shutter_curve
        mapping.initialize()
        times = [step / (_SHUTTER_SAMPLES - 1) for step in range(_SHUTTER_SAMPLES)]
        values = [min(1.0, max(0.0, mapping.evaluate(mapping.curves[0], time))) for time in times]
        return None if min(values) > 0.999 else [list(pair) for pair in zip(times, values)]

    def _instance(self, instance: Any, poses: list[Any]) -> None:
        thing, placed = instance.object, instance.matrix_world.copy()
        owner = f"Object '{thing.name}'"
        motion = self._motion(_identity(instance), poses, owner)
        if thing.type == "LIGHT":
            light = self.lights.convert(thing, placed, motion)
            if light is not None:
                self.content[light[0]].append(light[1])
        elif thing.type in meshes.TYPES:
            self._mesh(thing, placed, motion, owner)
        elif thing.type in _MISSING_TYPES:
            self.report.missing(owner, f"the type {thing.type}")
        if thing.type == "EMPTY" and thing.abbe.meter not in {"NONE", "luminous_flux"}:
            turn = placed.to_3x3() @ Matrix.Identity(3).col[2]
            where = {"points": [list(placed.to_translation())], "normal": list(turn)}
            self.content["meters"].append({"name": thing.name, "quantity": thing.abbe.meter, **where})
        elif thing.type == "EMPTY" and thing.abbe.meter != "NONE":
            self.report.missing(owner, "a meter of the luminous flux at a point")

    def _mesh(self, thing: Any, placed: Matrix, motion: list[tuple[float, Matrix]], owner: str) -> None:
        self._name_missing(thing, owner)
        scale = abs(placed.to_3x3().determinant()) ** (1.0 / 3.0)
        if scale == 0.0:
            if any(placed.to_scale()):
                self.report.missing(owner, "a scale that makes the object flat")
            return
        parts = self.meshes.parts(thing)
        for part in parts:
            slots = thing.material_slots
            material = slots[min(part.slot, len(slots) - 1)].material if slots else None
            surface = self.materials.convert(material, part.chord * scale, owner)
            form = {"name": thing.name, "shape": {"shared": part.shape}, "material": surface.name}
            if motion:
                form["motion"] = [{"time": time, "transform": lights.matrix_step(matrix)} for time, matrix in motion]
            elif lights.matrix_step(placed):
                form["transform"] = lights.matrix_step(placed)
            if surface.emission is not None:
                form["emission"] = {**surface.emission, "group": thing.name}
            self.content["objects"].append(form)
            if surface.emission is not None and part.sheet is not None:
                self.content["objects"].append({**form, "shape": {"shared": self.meshes.back(part)}})
        if thing.abbe.meter != "NONE" and len(parts) == 1:
            meter = {"name": thing.name, "surface": thing.name, "quantity": thing.abbe.meter}
            self.content["meters"].append(meter)
        elif thing.abbe.meter != "NONE":
            self.report.missing(owner, "a meter on a mesh with several materials")

    def _name_missing(self, thing: Any, owner: str) -> None:
        kinds = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")
        hidden = [kind for kind in kinds if not getattr(thing, f"visible_{kind}")]
        if hidden:
            self.report.missing(owner, f"invisibility to {', '.join(hidden)} rays")
        if thing.original.holdout_get(view_layer=self.depsgraph.view_layer):
            self.report.missing(owner, "'Holdout'")
        if thing.is_shadow_catcher:
            self.report.missing(owner, "'Shadow Catcher'")
        if thing.original.indirect_only_get(view_layer=self.depsgraph.view_layer):
            self.report.missing(owner, "'Indirect Only' of its collection")
        cycles = getattr(thing, "cycles", None)  # The settings of Cycles exist while its add-on is on.
        if self.scene.render.use_motion_blur and not getattr(cycles, "use_motion_blur", True):
            self.report.missing(owner, "motion blur that is switched off")
        if any(it.settings.type == "HAIR" and it.settings.render_type == "PATH" for it in thing.particle_systems):
            self.report.missing(owner, "the hair of a particle system")
        kinds = {"ARMATURE", "CLOTH", "SOFT_BODY", "MESH_DEFORM", "HOOK", "LATTICE", "WAVE"}
        deforms = thing.type == "MESH" and getattr(thing.data, "shape_keys", None) is not None
        if self.scene.render.use_motion_blur and (deforms or kinds & {it.type for it in thing.modifiers}):
            self.report.missing(owner, "motion blur of a deformation")

    def _settings(self) -> dict[str, Any]:
        own, render = self.scene.abbe, self.scene.render
        form: dict[str, Any] = {"passes": own.passes, "seed": own.seed}
        form |= {key: getattr(own, key) for key in ("photons", "max_depth") if getattr(own, key)}
        if render.threads_mode == "FIXED":
            form["threads"] = render.threads
        return form


def _identity(instance: Any) -> Any:
    """Returns a key of an instance that is the same at all frames."""
    if not instance.is_instance:
        return instance.object.name_full, "", ()
    return instance.object.name_full, instance.parent.name_full, tuple(instance.persistent_id)


def _is_plain(matrix: Matrix) -> bool:
    """Returns true if a matrix consists of a translation, a rotation and a scale other than 0."""
    return matrix.determinant() != 0.0 and _close(matrix, Matrix.LocRotScale(*matrix.decompose()))


def _close(first: Matrix, second: Matrix) -> bool:
    return max(abs(a - b) for rows in zip(first, second) for a, b in zip(*rows)) <= 1e-5


def _json(form: Any) -> str:
    """Returns a JSON text in which lists of numbers stay on one line."""
    text = json.dumps(_short(form), indent=1, ensure_ascii=False)
    return re.sub(r"\[[-\d.e+,\s]+\]", lambda found: re.sub(r"\s+", " ", found[0]), text) + "\n"


def _short(form: Any) -> Any:
    """Returns a form with the shortest numbers that are the same in Blender's 32 bits."""
    if isinstance(form, float):
        single = np.float32(form)
        return float(str(single)) if float(single) == form else float(f"{form:.12g}")
    if isinstance(form, str):
        return f"_{form}" if form.startswith("$") else form  # "$name" is a variable of a scene.
    if isinstance(form, dict):
        return {_short(key): _short(value) for key, value in form.items()}
    return [_short(value) for value in form] if isinstance(form, (list, tuple)) else form
