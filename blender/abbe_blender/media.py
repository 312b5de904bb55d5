# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the volumes of shader nodes, and those of the panels, to media of Abbe."""

from __future__ import annotations

import math
from typing import Any

from . import units
from .nodes import SocketReader, source, surface_node


def panel_medium(settings: Any) -> dict[str, Any]:
    """Returns the medium of a panel."""
    phase = {"henyey_greenstein": {"g": settings.medium_anisotropy}}
    return _medium(settings.medium_absorption, settings.medium_scattering, phase)


def node_medium(tree: Any, read: SocketReader) -> dict[str, Any] | None:
    """Returns the medium of a node tree, or None if it has no volume or one without a counterpart."""
    node = surface_node(tree, "Volume")
    if node is None:
        return None
    absorption, scattering, phase = [0.0] * 3, [0.0] * 3, {"henyey_greenstein": {"g": 0.0}}
    shaders = [source(socket) for socket in node.inputs] if node.type == "ADD_SHADER" else [node]
    for shader in filter(None, shaders):
        parts = _coefficients(shader, read)
        if parts is None:
            return None
        absorption = [a + b for a, b in zip(absorption, parts[0])]
        scattering = [a + b for a, b in zip(scattering, parts[1])]
        phase = parts[2] or phase
    return _medium(units.coefficient(absorption), units.coefficient(scattering), phase)


def _medium(absorption: Any, scattering: Any, phase: Any) -> dict[str, Any]:
    return {"homogeneous": {"absorption": absorption, "scattering": scattering, "phase": phase}}


def _coefficients(node: Any, read: SocketReader) -> tuple[list[float], list[float], Any] | None:
    """Returns absorption, scattering (1/m) and the phase function of a shader, as in Cycles."""
    if node.type == "VOLUME_COEFFICIENTS":
        if max(read.value(node, "Emission Coefficients")) > 0.0:
            read.missing(f"the emission of '{node.name}'")
        absorption, scattering = (read.value(node, f"{name} Coefficients") for name in ("Absorption", "Scatter"))
        return absorption, scattering, _phase(node, read)
    if node.type not in {"VOLUME_SCATTER", "VOLUME_ABSORPTION", "PRINCIPLED_VOLUME"}:
        read.missing(f"the node '{node.name}' in 'Volume'")
        return None
    density, colour = read.value(node, "Density"), read.value(node, "Color")[:3]
    lost = [max(0.0, 1.0 - part) * density for part in colour]
    if node.type == "VOLUME_ABSORPTION":
        return lost, [0.0] * 3, None
    scattering = [part * density for part in colour]
    if node.type == "VOLUME_SCATTER":
        return [0.0] * 3, scattering, _phase(node, read)
    for name in ("Emission Strength", "Blackbody Intensity"):
        if read.value(node, name) > 0.0:
            read.missing(f"'{name}' of '{node.name}'")
    tint = [max(0.0, 1.0 - math.sqrt(max(0.0, part))) for part in read.value(node, "Absorption Color")[:3]]
    return [a * b for a, b in zip(lost, tint)], scattering, _phase(node, read)


def _phase(node: Any, read: SocketReader) -> Any:
    kind = getattr(node, "phase", "HENYEY_GREENSTEIN")
    if kind == "RAYLEIGH":
        return "rayleigh"
    if kind != "HENYEY_GREENSTEIN":
        read.missing(f"the phase function {kind} of '{node.name}' (Henyey-Greenstein instead)")
    return {"henyey_greenstein": {"g": min(0.99, max(-0.99, read.value(node, "Anisotropy")))}}
