# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the pictures and the files that a scene names into the folder of the export."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from . import exr
from .report import Report

_KNOWN = {".png", ".jpg", ".jpeg", ".webp", ".exr", ".hdr"}


class MissingFile(Exception):
    """A file that the scene needs does not exist."""


class Folder:
    """The folder of an exported scene. Files keep their names where these differ."""

    def __init__(self, path: Path, report: Report) -> None:
        self.path, self.report = path, report
        self._names: set[str] = set()
        self._copied: dict[str, str] = {}

    def free_name(self, name: str, extension: str) -> str:
        """Returns a new relative path for a file with a name of Blender."""
        stem = re.sub(r"[^\w.-]+", "_", name).strip("._") or "unnamed"
        number, candidate = 1, stem
        while candidate.lower() + extension in self._names:
            number += 1
            candidate = f"{stem}-{number}"
        self._names.add(candidate.lower() + extension)
        return candidate + extension

    def copy(self, source: str, owner: str) -> str:
        """Copies a file, whose path may be relative to the Blender file. Returns the new path."""
        path = Path(bpy.path.abspath(source))
        if not source or not path.is_file():
            raise MissingFile(f"{owner}: the file '{source}' does not exist")
        key = str(path.resolve())
        if key not in self._copied:
            self._copied[key] = self.free_name(path.stem, path.suffix.lower())
            shutil.copyfile(path, self.path / self._copied[key])
        return self._copied[key]

    def picture(self, image: Any, owner: str) -> dict[str, Any] | None:
        """Writes a picture. Returns its path and encoding, or None if its file does not exist."""
        if image.source not in {"FILE", "GENERATED"}:
            self.report.missing(owner, f"the image '{image.name}' of the kind {image.source}")
            return None
        key = f"image {image.name_full}"
        if key not in self._copied:
            written = self._write(image)
            if written is None:
                self.report.add(f"{owner}: the file of the image '{image.name}' does not exist ({image.filepath})")
                return None
            self._copied[key] = written
        _ = image.size[0]  # Blender knows the colour space of a file only when it has read the file.
        space = image.colorspace_settings.name
        linear = space in {"Non-Color", "Linear Rec.709", "Linear", "scene_linear", "Raw"}
        if not linear and space != "sRGB":
            self.report.missing(owner, f"the colour space '{space}' of the image '{image.name}'")
        return {"path": self._copied[key], "encoding": "linear" if linear else "srgb"}

    def _write(self, image: Any) -> str | None:
        source = Path(bpy.path.abspath(image.filepath, library=image.library))
        if image.packed_file is not None and not image.is_dirty and source.suffix.lower() in _KNOWN:
            name = self.free_name(image.name, source.suffix.lower())
            (self.path / name).write_bytes(image.packed_file.data)
            return name
        on_disk = image.source == "FILE" and image.packed_file is None
        if on_disk and not source.is_file():
            return None
        if on_disk and not image.is_dirty and source.suffix.lower() in _KNOWN:
            name = self.free_name(Path(image.name).stem, source.suffix.lower())
            shutil.copyfile(source, self.path / name)
            return name
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        if image.is_float:
            name = self.free_name(Path(image.name).stem, ".exr")
            rows = pixels.reshape(image.size[1], image.size[0], -1)[::-1]
            letters = "RGBA"[: rows.shape[2]]
            exr.write(self.path / name, {letter: rows[..., number] for number, letter in enumerate(letters)})
            return name
        name = self.free_name(Path(image.name).stem, ".png")
        # A copy of a generated or painted image would lose its pixels.
        copy = bpy.data.images.new(name, *image.size, alpha=True)
        try:
            copy.pixels.foreach_set(pixels)
            copy.filepath_raw, copy.file_format = str(self.path / name), "PNG"
            copy.save()
        finally:
            bpy.data.images.remove(copy)
        return name
