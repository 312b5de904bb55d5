# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes triangle meshes as binary PLY files. This module does not need Blender."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np


def write(path: Path, positions: Any, triangles: Any, normals: Any = None, uvs: Any = None) -> None:
    """Writes a mesh: one row of each array is a vertex, or a triangle of three vertex numbers."""
    columns = [np.asarray(positions, np.float32)]
    names = ["x", "y", "z"]
    if normals is not None:
        columns.append(np.asarray(normals, np.float32))
        names += ["nx", "ny", "nz"]
    if uvs is not None:
        columns.append(np.asarray(uvs, np.float32))
        names += ["u", "v"]
    vertices = np.ascontiguousarray(np.hstack(columns), "<f4")
    faces = np.empty(len(triangles), np.dtype([("count", "u1"), ("corners", "<u4", 3)]))
    faces["count"] = 3
    faces["corners"] = triangles
    properties = "".join(f"property float {name}\n" for name in names)
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
        f"element face {len(faces)}\nproperty list uchar uint vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())


def merged(corners: Any, triangles: Any) -> tuple[Any, Any]:
    """Merges equal rows of `corners`. Returns the different rows, and the triangles over them."""
    rows = np.ascontiguousarray(corners, np.float32) + np.float32(0.0)  # −0 becomes 0
    keys = rows.view(np.dtype((np.void, rows.shape[1] * 4))).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return rows[first], inverse.reshape(-1)[triangles]


def normals(positions: Any, triangles: Any) -> Any:
    """Returns the unit normals of all vertices, which are means over equal positions."""
    points, faces = merged(positions, triangles)
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    sums = np.zeros_like(points)
    for corner in range(3):
        np.add.at(sums, faces[:, corner], np.cross(b - a, c - a))
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    units = sums / np.where(lengths > 0.0, lengths, 1.0)
    found = np.empty_like(np.asarray(positions, np.float32))
    found[triangles] = units[faces]
    return found


def size(positions: Any, triangles: Any) -> tuple[float, float]:
    """Returns the enclosed volume, with the sign of its orientation, and the area of a mesh."""
    a, b, c = (np.asarray(positions, np.float64)[triangles[:, corner]] for corner in range(3))
    cross = np.cross(b - a, c - a)
    return float(np.einsum("ij,ij->", a, cross) / 6.0), float(np.linalg.norm(cross, axis=1).sum() / 2.0)


def is_closed(positions: Any, triangles: Any) -> bool:
    """Returns true if each edge between two positions is used as often in both directions."""
    points, faces = merged(positions, triangles)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    forward, backward = (edges @ np.array(order) for order in ([len(points), 1], [1, len(points)]))
    return bool(np.array_equal(np.sort(forward), np.sort(backward)))
