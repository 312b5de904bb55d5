#!/usr/bin/env python3
"""Writes the meshes of the gallery into scenes/gallery/meshes.

    scenes/gallery/make/meshes.py

Each mesh is a curve that is turned about the y axis. Glasses are closed shells. A liquid reaches a
fifth of a millimetre into its glass, where its higher priority replaces the glass, so that no gap
of air remains. Lengths are in cm. Needs NumPy.
"""

import pathlib

import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "meshes"


def smooth(points, corner, steps=5):
    """A polyline whose inner corners are replaced by arcs of parabolas that begin `corner` before them."""
    points = [np.array(p, float) for p in points]
    curve = [points[0]]
    for before, here, after in zip(points, points[1:], points[2:]):
        cut = [min(corner, 0.45 * np.linalg.norm(end - here)) for end in (before, after)]
        a = here + (before - here) / np.linalg.norm(before - here) * cut[0]
        b = here + (after - here) / np.linalg.norm(after - here) * cut[1]
        for t in np.linspace(0, 1, steps):
            curve.append((1 - t) ** 2 * a + 2 * t * (1 - t) * here + t**2 * b)
    return np.array(curve + [points[-1]])


def spline(points, count):
    """A Catmull-Rom spline through the points."""
    p = np.array([points[0], *points, points[-1]], float)
    curve = []
    for i in range(1, len(p) - 2):
        for t in np.linspace(0, 1, count, endpoint=False):
            a, b, c, d = p[i - 1 : i + 3]
            curve.append(
                0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
            )
    return np.array(curve + [p[-1]])


def write_ply(name, vertices, faces):
    header = f"""ply
format binary_little_endian 1.0
comment Written by scenes/gallery/make/meshes.py.
element vertex {len(vertices)}
property float x
property float y
property float z
property float nx
property float ny
property float nz
element face {len(faces)}
property list uchar int vertex_indices
end_header
"""
    face_type = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / f"{name}.ply").write_bytes(
        header.encode() + np.array(vertices, "<f4").tobytes() + np.array(faces, face_type).tobytes()
    )


def turn(name, curve, around=160, flutes=None):
    """Turns a curve of (radius, height) about the y axis, and writes the mesh as a PLY file.

    The outside is on the right of the curve. `flutes` is (number, depth, where): waves of the
    radius around the body, times a function of the curve's points.
    """
    curve = np.array(curve)
    keep = np.r_[True, np.linalg.norm(np.diff(curve, axis=0), axis=1) > 1e-6]
    curve = curve[keep]
    angle = 2 * np.pi * np.arange(around) / around
    radius = np.repeat(curve[:, :1], around, 1)
    height = np.repeat(curve[:, 1:2], around, 1)
    if flutes:
        number, depth, outside = flutes
        radius = radius * (1 - depth * outside(curve)[:, None] * (0.5 + 0.5 * np.cos(number * angle)[None, :]))
    position = np.stack([radius * np.cos(angle), height, -radius * np.sin(angle)], -1)
    along = np.gradient(position, axis=0)
    across = np.roll(position, -1, 1) - np.roll(position, 1, 1)
    normal = np.cross(across, along)
    # On the axis, the curve is horizontal.
    for row in (0, -1):
        if curve[row, 0] < 1e-9:
            normal[row] = [0, -1 if row == 0 else 1, 0]
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    rows = len(curve)
    ends = [curve[0, 0] < 1e-9, curve[-1, 0] < 1e-9]
    index = np.zeros((rows, around), int)
    vertices = []
    for row in range(rows):
        single = (row == 0 and ends[0]) or (row == rows - 1 and ends[1])
        for k in range(1 if single else around):
            index[row, k] = len(vertices)
            vertices.append((*position[row, k], *normal[row, k]))
        if single:
            index[row, :] = index[row, 0]
    faces = []
    for row in range(rows - 1):
        for k in range(around):
            n = (k + 1) % around
            a, b, c, d = index[row, k], index[row, n], index[row + 1, n], index[row + 1, k]
            if a != b:
                faces.append((3, (a, b, c)))
            if c != d:
                faces.append((3, (a, c, d)))
    write_ply(name, vertices, faces)


OVERLAP = 0.02


def water():
    outer = [(0, 0), (3.15, 0), (3.9, 10.2), (3.72, 10.2), (3.0, 1.1), (0, 1.0)]
    curve = smooth(outer, 0.25)
    # Flutes on the outer wall only.
    walls = lambda c: np.clip((c[:, 1] - 0.3) / 1.0, 0, 1) * np.clip((8.2 - c[:, 1]) / 2.5, 0, 1) * (
        np.arange(len(c)) < np.argmax(c[:, 1])
    )
    pieces = [
        np.linspace(a, b, 8 if np.linalg.norm(b - a) > 2 else 2, endpoint=False) for a, b in zip(curve, curve[1:])
    ]
    walls_fine = np.vstack([*pieces, curve[-1:]])
    turn("tumbler", walls_fine, 160, (10, 0.045, walls))
    inside = lambda y: 3.0 + (3.72 - 3.0) * (y - 1.1) / (10.2 - 1.1) + OVERLAP
    top = 7.6
    liquid = [(0, 1.0 - OVERLAP), (3.0 + OVERLAP, 1.1 - OVERLAP), (inside(top + 0.12), top + 0.12)]
    meniscus = [(inside(top) - 0.04, top + 0.1), (inside(top) - 0.12, top + 0.035), (inside(top) - 0.25, top), (0, top)]
    turn("water", np.vstack([smooth(liquid, 0.25 + OVERLAP), meniscus]))


def milk():
    """A glass of milk: the glass above the milk, the milk with the thin wall around it, and the base."""
    outer = lambda y: 2.9 + 0.3 * y / 12.5
    inner = lambda y: outer(y) - 0.17
    top, base = 9.2, 0.8
    turn("milk_base", smooth([(0, 0), (2.9, 0), (outer(base - 0.01), base - 0.01), (0, base - 0.01)], 0.2))
    side = [(0, base), (outer(base), base), (outer(top), top)]
    meniscus = [(inner(top), top + 0.1), (inner(top) - 0.08, top + 0.035), (inner(top) - 0.2, top), (0, top)]
    turn("milk", np.vstack([smooth(side, 0.05), meniscus]))
    low, high = top + 0.002, 12.5
    tube = [(outer(low), low), (outer(high), high), (inner(high), high), (inner(low), low), (outer(low), low)]
    turn("milk_glass", smooth(tube, 0.08))


def wine():
    foot = smooth([(0, 0), (3.4, 0), (3.42, 0.16), (1.4, 0.42), (0.42, 0.9)], 0.12)
    stem = spline([(0.42, 0.9), (0.33, 2.0), (0.33, 4.0), (0.45, 5.2), (0.95, 5.9)], 5)
    bowl = spline([(0.95, 5.9), (2.6, 7.0), (3.7, 8.9), (4.0, 10.7), (3.75, 13.2), (3.15, 16.4)], 7)
    rim = [(3.10, 16.46), (3.04, 16.4)]
    inner_points = [(3.04, 16.4), (3.64, 13.2), (3.89, 10.7), (3.58, 8.95), (2.45, 7.2), (0.9, 6.32), (0, 6.2)]
    inner = spline(inner_points, 7)
    turn("wine_glass", np.vstack([foot, stem, bowl, rim, inner]))
    level = 10.4
    below = inner[::-1]
    below = below[below[:, 1] < level + 0.1] + [OVERLAP, -OVERLAP]
    below[0] = (0, 6.2 - OVERLAP)
    edge = below[-1, 0]
    meniscus = [(edge - 0.06, level + 0.07), (edge - 0.14, level + 0.03), (edge - 0.28, level), (0, level)]
    turn("wine", np.vstack([below, meniscus]))


if __name__ == "__main__":
    water()
    milk()
    wine()
