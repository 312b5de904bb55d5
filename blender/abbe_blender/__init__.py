# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders Blender's scenes with Abbe, a spectral photon-mapping renderer.

The add-on writes a scene file, runs the program `abbe` in a process of its own, and reads the EXR
file that the program writes.
"""

from . import engine, operators, panels, preferences, properties

_MODULES = (preferences, properties, engine, operators, panels)


def register() -> None:
    """Registers all classes."""
    for module in _MODULES:
        module.register()


def unregister() -> None:
    """Removes all classes."""
    for module in reversed(_MODULES):
        module.unregister()
