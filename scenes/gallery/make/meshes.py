#!/usr/bin/env python3
"""Writes the meshes of the gallery into scenes/gallery/meshes.

    scenes/gallery/make/meshes.py

Glasses, the stand and the tower are curves that are turned about the y axis. Glasses are closed
shells. A liquid reaches a fifth of a millimetre into its glass, where its higher priority replaces
the glass, so that no gap of air remains. Rocks, the sea and the road are heights over a grid.
Lengths are in cm, and in m for the shore and the lighthouse. Needs NumPy.
"""

import pathlib

import numpy as np

import textures

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


def write_ply(name, vertices, faces, columns="nx ny nz"):
    """Writes a mesh. A vertex has its position and the values that `columns` names."""
    properties = "".join(f"property float {column}\n" for column in columns.split())
    header = f"""ply
format binary_little_endian 1.0
comment Written by scenes/gallery/make/meshes.py.
element vertex {len(vertices)}
property float x
property float y
property float z
{properties}element face {len(faces)}
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


def stand():
    """A turned brass stand for a ball of radius 5 whose centre is 14.2 above the table."""
    foot = smooth([(0, 0), (4.8, 0), (4.8, 0.55), (3.9, 0.75), (2.2, 1.5), (1.25, 2.4)], 0.2)
    stem = spline([(1.25, 2.4), (0.85, 3.6), (0.75, 4.8), (1.45, 5.5), (1.45, 6.0), (0.75, 6.7), (0.9, 7.6)], 6)
    cup = smooth([(0.9, 7.6), (1.8, 8.6), (2.75, 9.5), (2.95, 9.95), (2.62, 9.9), (1.6, 9.1), (0, 8.7)], 0.2)
    turn("stand", np.vstack([foot, stem, cup]), 48)


def ball(radius, centre):
    """An octahedron, divided once, with its corners on a sphere."""
    faces = []
    for x in (1, -1):
        for y in (1, -1):
            for z in (1, -1):
                corners = [np.array([x, 0, 0.0]), np.array([0, y, 0.0]), np.array([0, 0, z * 1.0])]
                faces.append(corners if x * y * z > 0 else corners[::-1])
    for _ in range(1):
        divided = []
        for a, b, c in faces:
            ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
            divided += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = divided
    points = np.array(faces).reshape(-1, 3)
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    return np.hstack([normals * radius + centre, normals])


def bulbs():
    """A string of small bulbs on the wall behind the ball."""
    rng = np.random.default_rng(91)
    vertices = []
    for i in range(15):
        x = -62 + 9.2 * i + rng.uniform(-1.2, 1.2)
        sag = 7.5 * (1 - ((i % 5) - 2) ** 2 / 4)
        vertices.append(ball(0.95, [x, 34 - sag + rng.uniform(-0.7, 0.7), -58 + rng.uniform(-1, 1)]))
    vertices = np.vstack(vertices)
    write_ply("bulbs", vertices, [(3, (i, i + 1, i + 2)) for i in range(0, len(vertices), 3)])


def fractal(x, z, size, octaves, seed, ridged=False):
    """Noise between about -1 and 1 over a plane. Its largest features have this size."""
    grid = textures.noise((256, 256), 0.0, 1, seed)
    grid = np.clip(grid / 1.6, -1, 1)
    total = np.zeros(np.broadcast(x, z).shape)
    weight, crest = 1.0, 1.0
    for octave in range(octaves):
        angle = 0.7 * octave
        u = (x * np.cos(angle) + z * np.sin(angle)) / size * 2**octave + 17.3 * octave
        v = (z * np.cos(angle) - x * np.sin(angle)) / size * 2**octave + 5.1 * octave
        i, j = np.floor(u).astype(int), np.floor(v).astype(int)
        a, b = (t * t * t * (t * (6 * t - 15) + 10) for t in (u - i, v - j))
        at = lambda di, dj: grid[(j + dj) % 256, (i + di) % 256]
        value = (at(0, 0) * (1 - a) + at(1, 0) * a) * (1 - b) + (at(0, 1) * (1 - a) + at(1, 1) * a) * b
        if ridged:
            value = (1 - np.abs(value)) ** 2 * crest
            crest = np.clip(1.6 * value, 0, 1)
            value = 2 * value - 1
        total += weight * value
        weight *= 0.5
    return total / 1.6


def ground(name, x, y, z, uv_size, grass=None):
    """Writes meshes over the rows and columns of x, y and z, with one unit of uv for each `uv_size`.

    The faces on which `grass` is above 0 go into a mesh of their own, and so do those that the
    waves of the sea at the height 0 wet. A fourth mesh is the foam on the shallow sea.
    """
    rows, columns = y.shape
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    up = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    if up[:, 1].mean() < 0:
        faces = faces[:, ::-1]
    uv = np.stack([x, z], -1).reshape(-1, 2) / uv_size

    def part(suffix, chosen, vertices):
        used, corners = np.unique(faces[chosen], return_inverse=True)
        write_ply(name + suffix, vertices[used], [(3, tuple(face)) for face in corners.reshape(-1, 3)], "nx ny nz u v")

    along, across = np.gradient(points.reshape(rows, columns, 3), axis=(0, 1))
    normal = np.cross(along, across).reshape(-1, 3)
    normal *= np.sign(normal[:, 1:2]) / np.linalg.norm(normal, axis=1, keepdims=True)
    vertices = np.hstack([points, normal, uv])
    # Faces below the sea are never seen.
    visible = (points[faces, 1] > -0.4).any(1)
    green = visible & (grass.reshape(-1)[faces].mean(1) > 0)
    wet = visible & ~green & (points[faces, 1].mean(1) < 0.85 + 0.5 * fractal(*points[faces][:, 0, ::2].T, 4, 3, 118))
    part("", visible & ~green & ~wet, vertices)
    part("_wet", wet, vertices)
    part("_grass", green, vertices)
    water = points[:, 1] + 0.75 * fractal(points[:, 0], points[:, 2], 5, 4, 119)
    foam = (np.abs(water[faces] + 0.25) < 0.62).all(1) & (points[faces, 1] < 0.12).all(1)
    part("_foam", foam, np.hstack([points * [1, 0, 1] + [0, 0.15, 0], points * 0 + [0, 1, 0], uv]))


def shore():
    """The rocks in front of the camera at (0, 7.2, 0): their grid is finer near the camera.

    Returns x, y, z, and where grass grows.
    """
    angle = np.radians(np.linspace(-50, 50, 176))[None, :]
    distance = np.geomspace(4.5, 58, 96)[:, None]
    x, z = distance * np.sin(angle), -distance * np.cos(angle)
    edge = 26 + 9 * fractal(x, z * 0 + 3.0, 26, 4, 101) - 0.010 * x**2 + 0.28 * np.abs(x)
    slope = 1 / (1 + np.exp(-(edge - distance) / 3.0))
    rocks = fractal(x + 0.5 * z, z * 1.4 - 0.3 * x, 7, 6, 102, ridged=True)
    # Beds of rock: the height rises in tilted steps.
    tilt = 0.16 * x - 0.05 * z
    y = -2.6 + 6.4 * slope + (0.5 + 1.3 * slope) * rocks + 0.30 * fractal(x, z, 1.6, 4, 103) * slope
    bed = 0.9
    level = (y + tilt) / bed
    steps = np.floor(level) + np.clip((level - np.floor(level) - 0.5) * 2.4 + 0.5, 0, 1)
    y = 0.35 * y + 0.65 * (steps * bed - tilt)
    y = np.minimum(y, 4.3 + 0.12 * rocks)
    grass = fractal(x, z, 7, 4, 104) - 0.35 + 0.5 * (y - 3.0) - 0.02 * distance
    return x, y, z, grass


def tufts(count=330):
    """Transforms of the tufts of grass on the shore, as rows of x, y, z, an angle and a size."""
    x, y, z, grass = (a.ravel() for a in shore())
    rng = np.random.default_rng(105)
    distance = np.hypot(x, z)
    # Points of the grid are dense near the camera, so a point counts with its area.
    weight = np.where((grass > 0) & (distance < 30), distance**0.9, 0)
    chosen = rng.choice(len(x), count, replace=False, p=weight / weight.sum())
    return np.stack([x[chosen], y[chosen] - 0.05, z[chosen], rng.uniform(0, 360, count), rng.uniform(0.7, 1.25, count)], -1)


def tuft():
    """A patch of grass with a diameter of 1.5 m, and flowers on thin stems."""
    rng = np.random.default_rng(106)
    vertices, faces = [], []
    for _ in range(420):
        r, a = 0.75 * np.sqrt(rng.uniform()), rng.uniform(0, 2 * np.pi)
        foot = np.array([r * np.cos(a), 0, r * np.sin(a)])
        lean = rng.uniform(0, 2 * np.pi)
        side = np.array([np.cos(lean), 0, np.sin(lean)])
        bend = np.array([-side[2], 0, side[0]]) * rng.uniform(0.02, 0.16)
        height, width, colour = rng.uniform(0.10, 0.30) * (1 - 0.4 * r), rng.uniform(0.006, 0.011), rng.uniform()
        first = len(vertices)
        for t in (0, 0.55, 1):
            for sign in (-1, 1) if t < 1 else (0,):
                point = foot + bend * t * t + [0, height * t, 0] + side * width * sign * (1 - 0.5 * t)
                normal = np.array([0, 1, 0]) + 0.6 * np.cross(side, [0, 1, 0])
                vertices.append((*point, *(normal / np.linalg.norm(normal)), colour, 1 - t))
        faces += [(3, (first, first + 1, first + 3)), (3, (first, first + 3, first + 2)), (3, (first + 2, first + 3, first + 4))]
    write_ply("tuft", vertices, faces, "nx ny nz u v")
    heads = []
    for _ in range(9):
        r, a = 0.6 * np.sqrt(rng.uniform()), rng.uniform(0, 2 * np.pi)
        heads.append(ball(0.026, [r * np.cos(a), rng.uniform(0.2, 0.32), r * np.sin(a)]))
    heads = np.vstack(heads)
    write_ply("thrift", heads, [(3, (i, i + 1, i + 2)) for i in range(0, len(heads), 3)])


def coast():
    """The rocks in front of the camera at (0, 7.2, 0)."""
    ground("coast", *shore()[:3], 3.0, shore()[3])


def sea():
    """Waves between the shore and 150 m from the camera. Far from it, the grid holds only long waves."""
    angle = np.radians(np.linspace(-58, 58, 150))[None, :]
    distance = np.geomspace(15, 170, 118)[:, None]
    x, z = distance * np.sin(angle), -distance * np.cos(angle)
    rng = np.random.default_rng(116)
    y = np.zeros(x.shape)
    for length in np.geomspace(0.9, 17, 46):
        heading = 0.5 + rng.normal(0, 0.45)
        phase = 2 * np.pi / length * (x * np.sin(heading) + z * np.cos(heading)) + rng.uniform(0, 2 * np.pi)
        resolved = np.clip((length / (0.021 * distance) - 2.2) / 2, 0, 1)
        wave = 0.0066 * length**0.8 * np.cos(phase)
        y += resolved * (wave + 0.12 * np.abs(wave))
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)])
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    up = np.cross(points[faces[0, 1]] - points[faces[0, 0]], points[faces[0, 2]] - points[faces[0, 0]])
    faces = faces if up[1] > 0 else faces[:, ::-1]
    write_ply("sea", points, [(3, tuple(face)) for face in faces], "")


def island():
    """The island of the lighthouse, 60 m wide, around the origin."""
    x, z = np.meshgrid(np.linspace(-40, 40, 124), np.linspace(-22, 22, 70))
    r = np.hypot(x / 36, z / 19) + 0.20 * fractal(x, z, 16, 4, 111)
    body = np.clip(1 - r, -0.4, 1)
    steep = np.sign(body) * np.abs(body) ** 0.55
    top = np.clip((0.45 - r) * 3, 0, 1)
    rocks = fractal(x + 0.5 * z, z * 1.3, 9, 6, 112, ridged=True)
    y = 8.5 * steep + (1 - top) * 2.2 * rocks + 0.6 * (1 - top) * fractal(x, z, 3, 3, 113)
    level = (y + 0.2 * x) / 1.3
    steps = np.floor(level) + np.clip((level - np.floor(level) - 0.5) * 2.4 + 0.5, 0, 1)
    y = 0.4 * y + 0.6 * (steps * 1.3 - 0.2 * x)
    y = np.where(top > 0, y * (1 - top) + top * (8.0 + 0.35 * fractal(x, z, 6, 3, 114)), y)
    grass = top - 0.25 + 0.3 * fractal(x, z, 5, 3, 115) + 0.16 * (y - 7)
    ground("island", x, y, z, 4.0, grass)


def band(curve, low, high, thickness=0.0):
    """The piece of a curve of (radius, height) between two heights, from the axis to the axis."""
    heights = np.linspace(low, high, 4)
    side = np.stack([np.interp(heights, curve[:, 1], curve[:, 0]) + thickness, heights], -1)
    return np.vstack([[(0, low)], side, [(0, high)]])


def lighthouse():
    """A tower of 19 m with bands, its gallery, its lantern and its roof."""
    tower = spline([(3.3, 0), (2.75, 4), (2.35, 9), (2.1, 14), (2.05, 16.6)], 6)
    for name, pieces in (("tower_white", [(0, 4.2), (8.4, 12.6)]), ("tower_red", [(4.2, 8.4), (12.6, 16.6)])):
        for number, (low, high) in enumerate(pieces, 1):
            turn(f"{name}_{number}", band(tower, low, high), 56)
    turn("lantern_frame", np.array([(0, 16.6), (2.15, 16.6), (3.0, 17.2), (3.0, 17.5), (1.55, 17.5), (1.55, 18.3), (0, 18.3)]), 48)
    roof = [(0, 20.9), (1.95, 20.9), (1.95, 21.05), (1.6, 21.6), (0.9, 22.3), (0.28, 22.6), (0.28, 23.0), (0.1, 23.2), (0.06, 24.6), (0, 24.6)]
    turn("lantern_roof", np.array(roof), 48)


def road():
    """A road 260 cm wide, with a hollow in which rain stands up to the height 0. Lengths are in cm."""
    x, z = np.meshgrid(np.linspace(-130, 130, 66), np.linspace(-210, 50, 58))
    hollow = np.exp(-(((x + 6) / 44) ** 2 + ((z + 6) / 26) ** 2))
    y = 0.55 - 1.25 * hollow + 0.34 * fractal(x, z, 34, 4, 161) + 0.002 * np.abs(x)
    along, across = np.gradient(np.stack([x, y, z], -1), axis=(0, 1))
    normal = np.cross(along, across)
    normal *= np.sign(normal[..., 1:2]) / np.linalg.norm(normal, axis=-1, keepdims=True)
    vertices = np.dstack([x, y, z, normal, (x + 130) / 260, (z + 210) / 260]).reshape(-1, 8)
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)])
    write_ply("road", vertices, [(3, tuple(face)) for face in faces], "nx ny nz u v")


def leaf():
    """A fallen leaf with five lobes, 8 cm long, which curls up at its edges."""
    angle = np.linspace(-np.pi, np.pi, 121)[:-1]
    lobes = 0.0
    for at, size, width in ((0, 1.0, 0.30), (0.95, 0.86, 0.27), (-0.95, 0.86, 0.27), (2.0, 0.55, 0.30), (-2.0, 0.55, 0.30)):
        lobes = np.maximum(lobes, size * np.exp(-(((angle - at) / width) ** 2)))
    radius = 4.2 * (0.30 + 0.70 * lobes) * (1 + 0.05 * np.cos(41 * angle)) * np.clip((np.pi - np.abs(angle)) * 3, 0.15, 1)
    rings = np.linspace(0, 1, 7)[1:]
    x, z = (np.concatenate([[0], np.outer(rings, radius * f(angle)).ravel()]) for f in (np.sin, np.cos))
    y = 0.018 * (x**2 + z**2) + 0.10 * np.sin(1.9 * x) * np.cos(1.3 * z)
    faces = []
    for k in range(120):
        n = (k + 1) % 120
        faces.append((3, (0, 1 + k, 1 + n)))
        for ring in range(5):
            a = 1 + 120 * ring
            faces += [(3, (a + k, a + 120 + k, a + 120 + n)), (3, (a + k, a + 120 + n, a + n))]
    write_ply("leaf", np.stack([x, y, z, x / 9 + 0.5, z / 9 + 0.5], -1), faces, "u v")


def dome():
    """The upper half of a ball of radius 1, whose texture coordinates are those of a sphere."""
    polar, turned = np.meshgrid(np.linspace(0, np.pi / 2, 19), np.linspace(0, 2 * np.pi, 57), indexing="ij")
    normal = np.stack([np.sin(polar) * np.cos(turned), np.cos(polar), -np.sin(polar) * np.sin(turned)], -1)
    vertices = np.dstack([normal, normal, turned / (2 * np.pi), polar / np.pi]).reshape(-1, 8)
    index = np.arange(polar.size).reshape(polar.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.concatenate([np.stack([a, d, c], -1)[0:].reshape(-1, 3), np.stack([a, c, b], -1)[1:].reshape(-1, 3)])
    write_ply("dome", vertices, [(3, tuple(face)) for face in faces], "nx ny nz u v")


if __name__ == "__main__":
    water()
    milk()
    wine()
    stand()
    bulbs()
    coast()
    tuft()
    sea()
    island()
    lighthouse()
    road()
    leaf()
    dome()
