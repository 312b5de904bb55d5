# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: export a scene, and read its meters."""

from __future__ import annotations

from typing import Any

import bpy

from . import preferences, program
from .engine import AbbeRenderEngine
from .export import Exported, export, folder_of
from .files import MissingFile

#: The name of the text that holds the readings of the meters.
READINGS = "Abbe Meters"


def exported_scene(context: Any) -> Exported:
    """Exports the scene of a context as F12 does."""
    scene = context.scene
    # Modifiers have the settings of the viewport here. Only F12 has those of the render.
    graph = context.evaluated_depsgraph_get()
    return export(graph, folder_of(scene, context.view_layer, None), scene.frame_set)


class AbbeExport(bpy.types.Operator):
    """Write the scene of Abbe without rendering. Modifiers have the settings of the viewport"""

    bl_idname = "abbe.export"
    bl_label = "Export Scene"

    def execute(self, context: Any) -> set[str]:
        """Writes the scene."""
        try:
            exported = exported_scene(context)
        except (MissingFile, ValueError, OSError) as error:
            self.report({"ERROR"}, f"Abbe: {error}")
            return {"CANCELLED"}
        AbbeRenderEngine.last = exported
        for line in exported.report.lines:
            self.report({"WARNING"}, f"Abbe: {line}")
        self.report({"INFO"}, f"Wrote {exported.scene}")
        return {"FINISHED"}


class AbbeMeasure(bpy.types.Operator):
    """Read the meters of the scene, and write the readings into a text"""

    bl_idname = "abbe.measure"
    bl_label = "Read Meters"

    def execute(self, context: Any) -> set[str]:
        """Reads the meters."""
        try:
            exported = exported_scene(context)
            if not exported.content["meters"]:
                raise ValueError("the scene has no meter; choose one in the object panel Abbe Meter")
            path = program.find(preferences.program_path())
            answer = program.output(path, "measure", str(exported.scene), "--quiet", *_limits(context.scene))
        except (program.ProgramError, MissingFile, ValueError, OSError) as error:
            self.report({"ERROR"}, f"Abbe: {error}")
            return {"CANCELLED"}
        text = bpy.data.texts.get(READINGS) or bpy.data.texts.new(READINGS)
        text.clear()
        text.write(answer)
        self.report({"INFO"}, f"The readings are in the text '{READINGS}'")
        return {"FINISHED"}


def _limits(scene: Any) -> list[str]:
    error = scene.abbe.target_error
    return ["--target-error", f"{error if error > 0.0 else 1.0:g}%", "--passes", str(max(8, scene.abbe.passes))]


CLASSES = (AbbeExport, AbbeMeasure)


def register() -> None:
    """Registers the operators."""
    for it in CLASSES:
        bpy.utils.register_class(it)


def unregister() -> None:
    """Removes the operators."""
    for it in CLASSES:
        bpy.utils.unregister_class(it)
