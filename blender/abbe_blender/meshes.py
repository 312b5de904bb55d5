# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the evaluated geometry of objects as mesh files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import ply
from .files import Folder

#: The types of objects that become meshes.
TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


#: The distance between the front and the back of a luminous sheet, relative to its size.
_SHEET = 1e-5


@dataclass
class Part:
    """The triangles of an object with one material."""

    shape: str
    slot: int
    #: The mean length (m) of a straight path through the body: four volumes per area. 0 if open.
    chord: float
    #: The name of the shape, the vertices, the triangles and the texture coordinates, if it is open.
    sheet: tuple[str, Any, Any, Any] | None


class Meshes:
    """Writes meshes, each of them once, and adds them to the shapes of the scene."""

    def __init__(self, folder: Folder) -> None:
        self.folder = folder
        self.shapes: dict[str, Any] = {}
        self._known: dict[Any, list[Part]] = {}
        self._backs: dict[str, str] = {}

    def parts(self, thing: Any) -> list[Part]:
        """Returns the parts of an evaluated object, one for each material that its faces have."""
        key = thing.data.as_pointer() if thing.type == "MESH" else thing.name_full
        if key not in self._known:
            mesh = thing.data if thing.type == "MESH" else thing.to_mesh()
            try:
                self._known[key] = self._write(mesh, thing.data.name) if mesh is not None else []
            finally:
                if thing.type != "MESH":
                    thing.to_mesh_clear()
        return self._known[key]

    def _write(self, mesh: Any, name: str) -> list[Part]:
        mesh.calc_loop_triangles()
        triangles = mesh.loop_triangles
        if not triangles:
            return []
        corners = _read(triangles, "vertices", 3, np.int32)
        loops = _read(triangles, "loops", 3, np.int32)
        slots = _read(triangles, "material_index", 1, np.int32).ravel()
        positions = _read(mesh.vertices, "co", 3, np.float32)
        normals = None if mesh.normals_domain == "FACE" else _read(mesh.corner_normals, "vector", 3, np.float32)
        layers = [layer for layer in mesh.uv_layers if layer.active_render]
        uvs = _read(layers[0].uv, "vector", 2, np.float32) if layers else None
        parts = []
        for slot in np.unique(slots):
            chosen = slots == slot
            used = [positions[corners[chosen].ravel()]]
            used += [values[loops[chosen].ravel()] for values in (normals, uvs) if values is not None]
            rows, faces = ply.merged(np.hstack(used), np.arange(3 * int(chosen.sum())).reshape(-1, 3))
            shape = self.folder.free_name(name, ".ply")
            columns = np.split(rows, np.cumsum([part.shape[1] for part in used])[:-1], axis=1)
            ply.write(
                self.folder.path / shape, columns[0], faces,
                columns[1] if normals is not None else None, columns[-1] if uvs is not None else None,
            )  # fmt: skip
            self.shapes[shape.removesuffix(".ply")] = {"mesh": {"path": shape}}
            uv = columns[-1] if uvs is not None else None
            is_closed = ply.is_closed(columns[0], faces)
            volume, area = ply.size(columns[0], faces)
            chord = 4.0 * abs(volume) / area if is_closed and area > 0.0 else 0.0
            sheet = None if is_closed else (name, columns[0], faces, uv)
            parts.append(Part(shape.removesuffix(".ply"), int(slot), chord, sheet))
        return parts

    def back(self, part: Part) -> str:
        """Writes the back of an open part, slightly behind it. Returns the name of the shape."""
        if part.shape not in self._backs:
            name, positions, faces, uv = part.sheet
            size = float(np.ptp(positions, axis=0).max())
            behind = positions - np.float32(_SHEET * size) * ply.normals(positions, faces)
            path = self.folder.free_name(f"{name}-back", ".ply")
            ply.write(self.folder.path / path, behind, faces[:, ::-1], None, uv)
            self._backs[part.shape] = path.removesuffix(".ply")
            self.shapes[path.removesuffix(".ply")] = {"mesh": {"path": path}}
        return self._backs[part.shape]


def _read(collection: Any, name: str, width: int, kind: Any) -> Any:
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)
