# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the spectra and the indices of refraction that the panels choose."""

from __future__ import annotations

from typing import Any

from .files import Folder


def spectrum(settings: Any, folder: Folder, owner: str, prefix: str = "") -> Any:
    """Returns the spectrum of a panel, or None if the panel keeps the colour of Blender."""
    kind = getattr(settings, f"{prefix}spectrum_source")
    if kind == "LIBRARY":
        return getattr(settings, f"{prefix}spectrum")
    if kind == "FILE":
        return {"file": folder.copy(getattr(settings, f"{prefix}spectrum_file"), owner)}
    return None


def index(text: str) -> Any:
    """Returns the index of refraction that a text names: a number, or a name of the catalogue."""
    try:
        return float(text)
    except ValueError:
        return text


def film_index(text: str) -> Any:
    """Returns the index of a film: a number, n and k such as "2.1 3.4", or a name."""
    parts = text.split()
    if len(parts) == 2:
        try:
            return {"n": float(parts[0]), "k": float(parts[1])}
        except ValueError:
            return text
    return index(text)
