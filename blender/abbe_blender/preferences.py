# SPDX-License-Identifier: GPL-3.0-or-later
"""The preferences of the add-on: where the program is."""

from typing import Any

import bpy
from bpy.props import StringProperty

from . import program

#: The program that the shell finds.
DEFAULT = "abbe"


class AbbePreferences(bpy.types.AddonPreferences):
    """The path of the program."""

    bl_idname = __package__

    program: StringProperty(
        name="Program", default=DEFAULT, subtype="FILE_PATH",
        description="Path of the program abbe. A name without a folder is looked up in PATH",
    )  # fmt: skip

    def draw(self, _context: Any) -> None:
        """Draws the path, and whether it is Abbe."""
        self.layout.prop(self, "program")
        try:
            found = program.find(bpy.path.abspath(self.program))
            self.layout.label(text=f"{program.version(found)}: {found}", icon="CHECKMARK")
        except program.ProgramError as error:
            self.layout.label(text=str(error), icon="ERROR")


def program_path() -> str:
    """Returns the path that the preferences state."""
    addon = bpy.context.preferences.addons.get(__package__)
    return bpy.path.abspath(addon.preferences.program) if addon is not None else DEFAULT


def register() -> None:
    """Registers the preferences."""
    bpy.utils.register_class(AbbePreferences)


def unregister() -> None:
    """Removes the preferences."""
    bpy.utils.unregister_class(AbbePreferences)
