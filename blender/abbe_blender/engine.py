# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12 exports the scene, runs the program, and shows its pictures."""

from __future__ import annotations

import struct
import time
from pathlib import Path
from typing import Any

import bpy

from . import exr, passes, preferences, program
from .export import Exported, export, folder_of
from .files import MissingFile

#: The time in s between two looks for a new picture.
_PAUSE = 0.2
#: The number of sentences about unmapped settings that are shown one by one.
_SHOWN = 20


class AbbeRenderEngine(bpy.types.RenderEngine):
    """Renders with the program abbe."""

    bl_idname = "ABBE"
    bl_label = "Abbe"
    bl_use_preview = False
    bl_use_postprocess = True
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True

    #: The last export of this session, which the panel shows.
    last: Exported | None = None

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        """Tells Blender the passes of a view layer."""
        for wanted in passes.passes(scene, renderlayer):
            self.register_pass(scene, renderlayer, wanted.name, len(wanted.letters), wanted.letters, wanted.kind)

    def render(self, depsgraph: Any) -> None:
        """Renders one view layer of a frame."""
        try:
            self._render(depsgraph)
        except (program.ProgramError, MissingFile, ValueError, OSError) as error:
            self.report({"ERROR"}, f"Abbe: {error}")

    def is_cancelled(self) -> bool:
        """Returns true if the user stops the render."""
        return self.test_break()

    def _render(self, depsgraph: Any) -> None:
        path = program.find(preferences.program_path())
        scene, layer = depsgraph.scene, depsgraph.view_layer
        self.update_stats("", "Exporting the scene")
        frame = scene.frame_current if self.is_animation else None
        exported = export(depsgraph, folder_of(scene, layer, frame), self.frame_set)
        AbbeRenderEngine.last = exported
        for old in (exported.picture, exported.picture.with_suffix(".checkpoint.exr")):
            old.unlink(missing_ok=True)
        wanted = passes.passes(scene, layer)
        for extra in wanted[1:]:
            self.add_pass(extra.name, len(extra.letters), extra.letters)
        run = program.Render(path, exported.scene, exported.picture, render_options(scene))
        result = self.begin_result(0, 0, self.resolution_x, self.resolution_y, layer=layer.name)
        try:
            self._watch(run, result, wanted, scene)
            if exported.picture.is_file():
                picture = exr.read(exported.picture)
                self._fill(result, wanted, picture, scene)
                for field, text in passes.cryptomatte_fields(picture, layer.name).items():
                    self.get_result().stamp_data_add_field(field, text)
        finally:
            run.stop()
            self.end_result(result)
        self._conclude(run, exported)

    def _watch(self, run: program.Render, result: Any, wanted: list[passes.Pass], scene: Any) -> None:
        """Shows the growing picture until the program ends."""
        shown, started = 0.0, time.monotonic()
        for step in run.steps(_PAUSE, self.is_cancelled):
            if step is not None:
                self._show_progress(scene, step, time.monotonic() - started)
            changed = _changed(run.picture)
            if changed > shown:
                shown = changed
                picture = exr.read(run.picture)
                self._fill(result, wanted, picture, scene)
                self.update_result(result)
                self._show_progress(scene, _passes_of(picture, scene), time.monotonic() - started)

    def _fill(self, result: Any, wanted: list[passes.Pass], picture: exr.Picture, scene: Any) -> None:
        targets = result.layers[0].passes
        part = passes.region(scene, picture, (result.resolution_x, result.resolution_y))
        for source in wanted:
            numbers = passes.pixels(source, picture, scene.abbe.efficacy, part)
            if numbers is None and source.name == "Combined":
                numbers = passes.pixels(passes.COMBINED, picture, scene.abbe.efficacy, part)
            if numbers is not None:
                targets[source.name].rect.foreach_set(numbers)

    def _show_progress(self, scene: Any, step: program.Progress, seconds: float) -> None:
        parts = [step.done / step.total] if step.total else []
        if scene.abbe.time_limit > 0.0:
            parts.append(seconds / scene.abbe.time_limit)
        self.update_progress(min(1.0, max(parts, default=0.0)))
        of = f" of {step.total}" if step.total else ""
        self.update_stats("", f"{step.done}{of} passes" + (f", {step.rest}" if step.rest else ""))

    def _conclude(self, run: program.Render, exported: Exported) -> None:
        if run.status not in {0, 130} and not self.is_cancelled():
            message = "; ".join(run.errors) or f"the program ended with the status {run.status}"
            raise program.ProgramError(message)
        lines = [*exported.report.lines, *run.notes]
        for line in lines[:_SHOWN]:
            self.report({"WARNING"}, f"Abbe: {line}")
        if len(lines) > _SHOWN:
            rest = len(lines) - _SHOWN
            self.report(
                {"WARNING"}, f"Abbe: {rest} more settings are not mapped; see {exported.scene.parent / 'report.txt'}"
            )


def render_options(scene: Any) -> list[str]:
    """Returns the options of `abbe render` that a scene file cannot state."""
    own = scene.abbe
    options = ["--reproducible"]
    if own.time_limit > 0.0:
        options += ["--time", f"{own.time_limit:g}s"]
    if own.target_error > 0.0:
        options += ["--target-error", f"{own.target_error:g}%"]
    if own.integrator == "PATH":
        options += ["--integrator", "path"]
    return options


def _changed(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return 0.0


def _passes_of(picture: exr.Picture, scene: Any) -> program.Progress:
    data = picture.header.get("abbe.passes", b"")
    done = struct.unpack("<i", data)[0] if len(data) == 4 else int(data or 0)
    return program.Progress(done, scene.abbe.passes, "")


def register() -> None:
    """Registers the engine."""
    bpy.utils.register_class(AbbeRenderEngine)


def unregister() -> None:
    """Removes the engine."""
    bpy.utils.unregister_class(AbbeRenderEngine)
