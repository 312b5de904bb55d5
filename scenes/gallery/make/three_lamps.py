#!/usr/bin/env python3
"""Writes the meshes and textures of the scene three_lamps into scenes/gallery.

    scenes/gallery/make/three_lamps.py

The vest hangs from a hanger at the origin, and faces +z. A function gives its depth over its
outline, so that the tapes and the seams follow the folds. Lengths are in cm. Needs NumPy and, for
the letters of the cards, Pillow.
"""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import meshes
import textures


def neck(y):
    """Half the width of the opening in front, at the height y below the shoulder."""
    return np.interp(y, [-17, -9, -2, 0], [0.12, 3.0, 6.0, 6.8])


def side(y):
    """Half the width of the vest: shoulder, armhole, chest and hem."""
    return np.interp(y, [-54, -40, -26, -21, -17, -10, -5, 0], [21.0, 19.6, 18.9, 17.6, 15.3, 14.2, 14.9, 16.6])


def depth(x, y, back=False):
    """How far the cloth is from the plane of the hanger."""
    w = np.abs(x) / side(y)
    low = np.clip(-y / 54, 0, 1)
    chest = np.interp(-y, [0, 8, 20, 54], [0.5, 2.6, 4.6, 5.4]) * np.sqrt(np.clip(1 - w**3, 0.0, 1)) + 0.25
    rng = np.random.default_rng(7 if back else 5)
    folds = 0.0
    for wave in (0.19, 0.33, 0.52, 0.78, 1.2):
        drift, phase = rng.uniform(-0.012, 0.012), rng.uniform(0, 2 * np.pi)
        bend = 0.5 * np.sin(0.09 * y + rng.uniform(0, 6))
        folds = folds + rng.uniform(0.6, 1) / wave**0.75 * np.sin(wave * x * (1 + 0.006 * y) + drift * y * x + phase + bend)
    # Creases where the vest was folded in its package.
    crease = 0.0
    for at, slope in ((-15, 0.05), (-29.5, -0.04), (-44, 0.03)):
        crease = crease - 1.0 * np.exp(-np.abs(y - at - slope * x) / 1.3)
    crease = crease - 0.5 * np.exp(-np.abs(np.abs(x) - 9.2 - 0.03 * y) / 0.8)
    rumple = 0.16 * meshes.fractal(x + 40 * back, y, 7, 3, 31)
    # Drapes that run down from the shoulders to the middle.
    run = 0.62 * np.abs(x) + 0.8 * y
    rumple = rumple + 0.95 * np.clip(w * 3, 0, 1) * np.clip(-y / 12, 0, 1) * meshes.fractal(run * 1.5 + 9, 0.2 * (x - y), 11, 2, 32)
    return chest + (0.10 + 0.9 * low**1.2) * folds * 0.62 + 0.55 * crease * np.clip(-y / 8, 0, 1) + rumple


def sheet(x, y, lift, back):
    """Vertices of the cloth: positions, normals and texture coordinates in 10 cm."""
    e = 0.05
    z = depth(x, y, back)
    normal = np.stack([-(depth(x + e, y, back) - depth(x - e, y, back)), -(depth(x, y + e, back) - depth(x, y - e, back)), np.full(x.shape, 2 * e)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    sway = 0.35 * np.sin(0.23 * y) * np.clip(-y / 30, 0, 1) + 0.5 * np.sin(0.07 * y + 1)
    hang = 0.7 * np.sin(0.31 * x + 2 * back) * np.clip(-y / 54, 0, 1) ** 4
    position = np.stack([x + sway, y + hang, z], -1) + np.asarray(lift)[..., None] * normal
    if back:
        position[..., 2] *= -0.8
        normal[..., 2] *= -1
    return np.concatenate([position, normal, np.stack([x / 10, y / 10], -1)], -1)


def join(parts):
    """The vertices and faces of grids of vertices."""
    vertices, faces, first = [], [], 0
    for grid in parts:
        rows, columns = grid.shape[:2]
        index = first + np.arange(rows * columns).reshape(rows, columns)
        a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
        faces += [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
        vertices.append(grid.reshape(rows * columns, -1))
        first += rows * columns
    return np.vstack(vertices), np.vstack(faces)


def write(name, parts):
    vertices, faces = join(parts)
    # Faces turn to the side of their normals.
    p, n = vertices[:, :3], vertices[:, 3:6]
    up = np.cross(p[faces[:, 1]] - p[faces[:, 0]], p[faces[:, 2]] - p[faces[:, 0]])
    wrong = (up * n[faces[:, 0]]).sum(1) < 0
    faces[wrong] = faces[wrong][:, ::-1]
    meshes.write_ply(name, vertices, [(3, tuple(f)) for f in faces], "nx ny nz u v")


def tube(points, radius, around=8):
    """A tube along a polyline."""
    points = np.array(points, float)
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    helper = np.where(np.abs(along[:, 2:3]) > 0.8, [[0, 1.0, 0]], [[0, 0, 1.0]])
    u = np.cross(along, helper)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(along, u)
    angle = np.linspace(0, 2 * np.pi, around + 1)
    normal = u[:, None] * np.cos(angle)[None, :, None] + v[:, None] * np.sin(angle)[None, :, None]
    length = np.cumsum(np.r_[0, np.linalg.norm(np.diff(points, axis=0), axis=1)])
    uv = np.stack(np.broadcast_arrays(length[:, None] / 10, angle[None, :] / 6.3), -1)
    return np.concatenate([points[:, None] + radius * normal, normal, uv], -1)


def panel(back, sign):
    t = np.linspace(0, 1, 66)[:, None]
    s = np.linspace(0, 1, 12 if back else 32)[None, :]
    top = -4.2 * s**1.2
    y = top + (-54 - top) * t
    inner = 6.8 * np.clip(1 + (y + 0.0) / 2.2, 0, 1) if back else neck(y)
    x = inner + (side(y) - inner) * s
    return sheet(sign * x, y, 0, back)


def vest():
    write("vest", [panel(back, sign) for back in (False, True) for sign in (1, -1)])
    for name, lift, width in (("vest_border", 0.09, 3.9), ("vest_tape", 0.17, 2.5)):
        parts = []
        for back in (False, True):
            for at in (-34.5, -46):
                for sign in (1, -1):
                    y = np.linspace(at - width, at + width, 9)[:, None]
                    s = np.linspace(0, 1, 40)[None, :]
                    inner = 0.15
                    parts.append(sheet(sign * (inner + (side(y) - inner) * s), y + 0 * s, lift, back))
            for sign in (1, -1):
                y = np.linspace(-0.5, -34.5 + width, 50)[:, None]
                x = np.linspace(10.4 - width, 10.4 + width, 9)[None, :]
                x = np.clip(x + 0 * y, neck(y) + 0.3, side(y) - 0.3)
                parts.append(sheet(sign * x, y - 4.2 * (x / 16) ** 2 * np.exp(y / 6), lift - 0.02, back))
        write(name, parts)
    trim = []
    for sign in (1, -1):
        y = np.linspace(0, -54, 70)
        trim.append(sheet(sign * neck(y), y, 0.0, False)[:, :3])
        y = np.linspace(-4.2, -22, 40)
        trim.append(sheet(sign * side(y), y, 0.0, False)[:, :3])
        x = np.linspace(0.12, side(-54), 50)
        trim.append(sheet(sign * x, x * 0 - 54, 0.0, False)[:, :3])
    write("vest_trim", [tube(curve, 0.32) for curve in trim])
    y = np.linspace(-17.5, -54, 90)
    zip_line = sheet(0 * y, y, 0.1, False)[:, :3]
    write("vest_zip", [tube(zip_line, 0.30, 6)])


def hanger():
    angle = np.radians(np.linspace(-90, 170, 24))
    hook = np.stack([1.5 * np.cos(angle), 4.4 + 1.5 * np.sin(angle), 0 * angle], -1)
    bar = meshes.spline([(-15, -4.0, 0), (-8, -1.6, 0), (0, 0.6, 0), (8, -1.6, 0), (15, -4.0, 0)], 6)
    write("hanger", [tube(np.vstack([[(0, 0.8, 0), (0, 2.0, 0)], hook]), 0.18), tube(bar, 0.55, 10)])


def turned(curve, around=48):
    """A curve of (radius, height), turned about the y axis."""
    curve = np.array(curve, float)
    along = np.gradient(curve, axis=0)
    angle = np.linspace(0, 2 * np.pi, around + 1)
    position = np.stack([curve[:, :1] * np.cos(angle), curve[:, 1:] + 0 * angle, -curve[:, :1] * np.sin(angle)], -1)
    normal = np.stack([along[:, 1:] * np.cos(angle), -along[:, :1] + 0 * angle, -along[:, 1:] * np.sin(angle)], -1)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    length = np.cumsum(np.r_[0, np.linalg.norm(np.diff(curve, axis=0), axis=1)])
    uv = np.stack(np.broadcast_arrays(angle[None, :] / 6.2832 * 3, length[:, None] / 10), -1)
    return np.concatenate([position, normal, uv], -1)


def candlestick():
    """A turned candlestick of 13.6 cm, and a candle of 8 cm with a hollow around its wick."""
    foot = meshes.smooth([(0.01, 0), (5.2, 0), (5.2, 0.5), (4.5, 0.8), (4.2, 1.15), (3.1, 1.25), (1.6, 2.2), (1.0, 3.0)], 0.25)
    stem = meshes.spline([(1.0, 3.0), (0.75, 3.7), (1.5, 4.3), (1.5, 4.8), (0.7, 5.3), (0.6, 6.6), (1.25, 8.0), (1.45, 9.0), (0.75, 9.8), (0.95, 10.3), (0.7, 10.7)], 6)
    cup = meshes.smooth([(0.7, 10.7), (1.35, 11.3), (1.45, 13.0), (3.0, 13.3), (3.05, 13.55), (1.5, 13.6), (1.15, 13.5), (0.01, 13.4)], 0.2)
    write("candlestick", [turned(np.vstack([foot, stem, cup]))])
    wax = [(0.01, 13.3), (1.12, 13.3), (1.08, 18), (1.08, 21.0), (0.98, 21.35), (0.7, 21.25), (0.35, 20.95), (0.01, 20.9)]
    parts = [turned(meshes.smooth(wax, 0.15), 40)]
    # Drops that ran down.
    for angle, length, size in ((0.6, 4.2, 0.2), (2.2, 2.4, 0.24), (4.4, 3.2, 0.22), (5.4, 1.5, 0.2)):
        t = np.linspace(0, 1, 14)
        r = 1.08 + 0.03 * np.sin(7 * t)
        run = np.stack([r * np.cos(angle), 21.2 - length * t, -r * np.sin(angle)], -1)
        parts.append(tube(run, (size * (0.75 + 0.5 * t**3) * np.sqrt(np.clip(1.02 - t**6, 0, 1)))[:, None, None], 8))
    write("candle", parts)
    t = np.linspace(0, 1, 8)
    write("wick", [tube(np.stack([0.16 * t**2, 20.85 + 0.95 * t, 0 * t], -1), 0.07, 6)])


def helmet():
    """A safety helmet: a dome with three ridges, and a brim that is longer in front (+z)."""
    polar = np.linspace(0.001, 1, 34)[:, None]
    angle = np.linspace(0, 2 * np.pi, 97)[None, :]
    theta = polar * np.pi / 2
    x, z = np.sin(theta) * np.cos(angle), np.sin(theta) * np.sin(angle)
    ridge = 0.0
    for at, height in ((0, 0.55), (-3.1, 0.35), (3.1, 0.35)):
        ridge = ridge + height * np.exp(-(((10.2 * x - at) / 0.75) ** 4))
    rise = np.cos(theta) ** 0.85
    lift = 1 + ridge / 11 * np.clip(1.6 * rise - 0.25, 0, 1)
    dome = np.stack([10.2 * x * lift, 2 + 11.2 * rise * lift, 12.4 * z * lift], -1)
    t = np.linspace(0, 1, 9)[:, None]
    front = np.clip(np.sin(angle), 0, 1) ** 1.5
    reach = 1 + t * (0.07 + 0.24 * front)
    brim = np.stack([10.2 * np.cos(angle) * reach, 2 - t * (0.5 + 0.9 * front) - 0.4 * t**3, 12.4 * np.sin(angle) * reach], -1)
    grid = np.concatenate([dome, brim[1:]])
    along, across = np.gradient(grid, axis=0), np.roll(grid[:, :-1], -1, 1) - np.roll(grid[:, :-1], 1, 1)
    across = np.concatenate([across, across[:, :1]], 1)
    normal = np.cross(along, across)
    normal *= np.where(normal[..., 1:2] < 0, -1, 1)
    normal[0] = [0, 1, 0]
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    uv = np.stack([grid[..., 0] / 10, grid[..., 2] / 10], -1)
    write("helmet", [np.concatenate([grid, normal, uv], -1)])


def pictures():
    shape = (256, 256)
    weave = np.sin(2 * np.pi * 32 * np.arange(256) / 256)
    textures.write_png("cloth_normal.png", textures.normals(0.8 * weave[:, None] * weave[None, :] + 0.25 * textures.noise(shape, 0.8, 1, 51), 0.28), 8)
    y, x = np.mgrid[0:256, 0:256]
    chevron = (x + np.abs((y % 64) - 32)) % 32 < 16
    grain = textures.noise(shape, 0.6, 1, 52)
    textures.write_png("tape.png", np.clip(0.68 + 0.06 * chevron + 0.03 * grain - 0.12 * np.clip(textures.noise(shape, 1.6, 1, 53) - 0.8, 0, 1), 0, 1))
    stains = textures.noise(shape, 1.7, 1, 54)
    scratches = np.abs(textures.noise(shape, 0.9, 30, 55)) < 0.03
    textures.write_png("tarnish.png", np.clip(0.24 + 0.24 * stains + 0.05 * grain - 0.25 * scratches, 0, 1))
    font = ImageFont.truetype("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", 64)
    for name, text in (("card_daylight", "Daylight"), ("card_sodium", "Sodium, 589 nm"), ("card_ultraviolet", "Ultraviolet, 365 nm")):
        card = Image.new("L", (768, 160), 0)
        draw = ImageDraw.Draw(card)
        draw.rectangle((12, 12, 755, 147), outline=180, width=4)
        draw.text((384, 78), text, 235, font, anchor="mm")
        textures.write_png(f"{name}.png", np.array(card) / 255, 16)


if __name__ == "__main__":
    vest()
    hanger()
    candlestick()
    helmet()
    pictures()
