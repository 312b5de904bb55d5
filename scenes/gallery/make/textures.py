#!/usr/bin/env python3
"""Writes the textures of the gallery into scenes/gallery/textures.

    scenes/gallery/make/textures.py

All textures repeat without a seam, because they are sums of filtered periodic noise. Needs NumPy.
"""

import pathlib
import struct
import zlib

import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "textures"


def write_png(name, picture, step=4):
    """Writes values from 0 to 1 as a PNG file with 8 bits, in grey or in RGB."""
    # Steps of 4 are invisible in these grains, and make the files half as large.
    data = np.clip(np.round(picture * (255 / step)) * step, 0, 255).astype(np.uint8)
    height, width = data.shape[:2]
    rows = data.reshape(height, -1)
    # The PNG filter "Up" stores differences of rows, which compress better.
    differences = np.vstack([rows[:1], (rows[1:].astype(int) - rows[:-1]).astype(np.uint8)])
    raw = b"".join(bytes([0 if y == 0 else 2]) + row.tobytes() for y, row in enumerate(differences))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 0 if data.ndim == 2 else 2, 0, 0, 0)
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / name).write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")
    )


def noise(shape, slope, stretch, seed, low=0.0):
    """Periodic noise with the mean 0 and the standard deviation 1.

    Its amplitude falls with the frequency to the power `slope`. Features are longer along x by the
    factor `stretch`, and frequencies below `low` cycles per picture are left out.
    """
    height, width = shape
    fy = np.fft.fftfreq(height)[:, None] * height
    fx = np.fft.fftfreq(width)[None, :] * width
    frequency = np.sqrt((fx * stretch * height / width) ** 2 + fy**2)
    gain = np.where(frequency > low, np.maximum(frequency, 1.0) ** -slope, 0.0)
    gain[0, 0] = 0
    white = np.random.default_rng(seed).standard_normal(shape)
    field = np.fft.ifft2(np.fft.fft2(white) * gain).real
    return field / field.std()


def normals(height_map, strength):
    """Normals of a periodic height map, encoded as colours with green up."""
    dx = (np.roll(height_map, -1, 1) - np.roll(height_map, 1, 1)) * 0.5 * strength
    dy = (np.roll(height_map, -1, 0) - np.roll(height_map, 1, 0)) * 0.5 * strength
    normal = np.stack([-dx, dy, np.ones_like(dx)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return normal * 0.5 + 0.5


def mix(a, b, t):
    t = np.clip(t, 0, 1)[..., None]
    return np.asarray(a) * (1 - t) + np.asarray(b) * t


def wood():
    """Oak boards: rings, fibres, pores and worn places. The grain runs along u."""
    shape = (512, 1024)
    y = np.arange(512)[:, None] / 512
    rings = np.sin(2 * np.pi * (9 * y + 0.75 * noise(shape, 2.2, 7, 1)))
    fibres = noise(shape, 0.7, 40, 2, low=6)
    pores = noise(shape, 0.35, 26, 3, low=30)
    tone = 0.5 + 0.17 * rings + 0.16 * fibres + 0.10 * noise(shape, 1.6, 3, 4)
    colour = mix([0.25, 0.145, 0.075], [0.62, 0.43, 0.26], tone)
    colour = colour * (1 - 0.45 * np.clip(pores - 1.25, 0, 1))[..., None]
    worn = np.clip(noise(shape, 1.5, 4, 5) - 1.1, 0, 1)
    colour = mix(colour, [0.55, 0.44, 0.32], 0.35 * worn)
    height = 0.25 * rings + 0.8 * fibres - 2.0 * np.clip(pores - 1.25, 0, 1)
    write_png("wood.png", colour)
    write_png("wood_normal.png", normals(height, 0.22))
    # Polish: the pores are rough, and worn places are smoother.
    write_png("wood_roughness.png", np.clip(0.45 + 0.12 * fibres - 0.2 * worn, 0, 1))


def plaster():
    """Old lime plaster: trowel marks, stains, and chipped places."""
    shape = (768, 768)
    trowel = noise(shape, 1.5, 2.5, 11)
    grain = noise(shape, 0.6, 1, 12, low=40)
    chips = np.clip((noise(shape, 1.5, 1, 13) - 1.75) * 3.5, 0, 1)
    stains = noise(shape, 1.9, 0.6, 14)
    tone = 0.62 + 0.05 * trowel + 0.025 * grain + 0.085 * stains
    colour = mix([0.50, 0.41, 0.31], [0.86, 0.80, 0.70], tone)
    colour = mix(colour, [0.44, 0.35, 0.27], 0.75 * chips)
    write_png("plaster.png", colour)
    write_png("plaster_normal.png", normals(1.6 * trowel + 0.35 * grain - 3.2 * chips, 0.30))


def stone():
    """Honed limestone: a fine grain, fossils and veins, and the stains of use."""
    shape = (768, 768)
    clouds = noise(shape, 1.7, 1.6, 21)
    grain = noise(shape, 0.4, 1, 22, low=60)
    veins = np.exp(-((noise(shape, 1.9, 1.4, 23) / 0.035) ** 2))
    pits = np.clip(noise(shape, 0.8, 1, 24, low=25) - 2.1, 0, 1)
    tone = 0.55 + 0.10 * clouds + 0.06 * grain
    colour = mix([0.42, 0.37, 0.31], [0.80, 0.75, 0.66], tone)
    colour = mix(colour, [0.34, 0.28, 0.22], 0.35 * veins)
    colour = colour * (1 - 0.55 * pits)[..., None]
    write_png("stone.png", colour)
    write_png("stone_normal.png", normals(0.5 * clouds + 0.30 * grain - 2.5 * pits - 0.5 * veins, 0.20))
    write_png("stone_roughness.png", np.clip(0.42 + 0.14 * noise(shape, 1.4, 1.5, 25) + 0.25 * pits, 0, 1))


def letter():
    """A sheet of paper with a drawing of a prism and lines of handwriting, which nobody can read."""
    height, width = 704, 512
    rng = np.random.default_rng(31)
    ink = np.zeros((height, width))

    def stroke(x, y, weight):
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                px = np.clip(np.round(x + 0.6 * dx).astype(int), 0, width - 1)
                py = np.clip(np.round(y + 0.6 * dy).astype(int), 0, height - 1)
                np.maximum.at(ink, (py, px), weight * (1 if dx == dy == 0 else 0.45))

    for row in [*range(60, 220, 26), *range(440, 660, 26)]:
        x = 50.0
        end = width - 50 if rng.random() > 0.15 else 300
        while x < end:
            length = rng.uniform(18, 62)
            steps = np.linspace(0, 1, 400)
            phase = 2 * np.pi * length / 9 * steps
            tall = np.repeat(rng.choice([0.5, 0.5, 0.6, 1.5], 20), 20)
            stroke(x + length * steps + 2.2 * np.cos(phase), row - 5 * tall * np.sin(phase), 0.85)
            x += length + 12
    line = np.linspace(0, 1, 900)
    corners = [(190, 390), (260, 268), (330, 390), (190, 390)]
    for (ax, ay), (bx, by) in zip(corners, corners[1:]):
        stroke(ax + (bx - ax) * line, ay + (by - ay) * line, 1.0)
    stroke(60 + 165 * line, 290 + 40 * line, 0.9)
    for spread in (0.0, 16.0, 32.0):
        stroke(225 + 70 * line, 330 + spread * 0.15 * line, 0.7)
        stroke(295 + 165 * line, 330 + spread * 0.15 + (45 + spread) * line, 0.7)
    paper = mix([0.72, 0.63, 0.46], [0.88, 0.82, 0.68], 0.55 + 0.16 * noise((height, width), 1.8, 1, 32))
    y, x = np.mgrid[0:height, 0:width]
    edge = np.minimum(np.minimum(x, width - x), np.minimum(y, height - y))
    paper = paper * (1 - 0.35 * np.exp(-edge / 14.0))[..., None]
    write_png("letter.png", mix(paper, [0.16, 0.10, 0.06], ink))


def masonry(shape, rows, columns, jitter, joint, seed):
    """Stones in rows, each second row shifted by half a stone.

    Returns the number of the stone of each pixel, and the distance from its edge in stones.
    """
    rng = np.random.default_rng(seed)
    height, width = shape
    y, x = np.mgrid[0:height, 0:width]
    v = y / height * rows + 0.06 * noise(shape, 1.8, 1, seed + 1)
    row = np.floor(v).astype(int) % rows
    offsets = np.where(np.arange(rows) % 2, 0.5, 0.0) + rng.uniform(-jitter, jitter, rows)
    u = x / width * columns + offsets[row] + 0.06 * noise(shape, 1.8, 1, seed + 2)
    column = np.floor(u).astype(int) % columns
    aspect = (width / columns) / (height / rows)
    du = np.minimum(u - np.floor(u), np.ceil(u) - u) * max(aspect, 1)
    dv = np.minimum(v - np.floor(v), np.ceil(v) - v) / min(aspect, 1)
    distance = np.minimum(du, dv)
    corner = -0.12 * np.log(np.exp(-du / 0.12) + np.exp(-dv / 0.12))
    return row * columns + column, np.minimum(distance, np.maximum(corner, 0)) - joint


def cobbles():
    """Wet cobblestones: domed stones of different greys, and wet sand in the joints."""
    shape = (768, 768)
    stone, edge = masonry(shape, 10, 8, 0.2, 0.05, 41)
    dome = np.clip(edge / 0.36, 0, 1)
    dome = np.sqrt(1 - (1 - dome) ** 2)
    rng = np.random.default_rng(44)
    tone = rng.uniform(0, 1, 80)[stone] + 0.16 * noise(shape, 0.9, 1, 45)
    colour = mix([0.20, 0.20, 0.21], [0.42, 0.40, 0.38], tone)
    colour = mix([0.13, 0.12, 0.10], colour, np.clip(edge * 12, 0, 1))
    height = 13 * dome + 0.25 * noise(shape, 0.9, 1, 46) + 0.5 * noise(shape, 1.5, 1, 47)
    write_png("cobbles.png", colour)
    write_png("cobbles_normal.png", normals(height, 0.33))
    wet = np.clip(0.5 + 0.35 * noise(shape, 1.7, 1, 48), 0, 1)
    write_png("cobbles_roughness.png", np.clip(0.25 + 0.5 * wet * np.clip(edge * 8, 0, 1), 0, 1))


def bricks():
    """An old brick wall with lime mortar and soot."""
    shape = (768, 768)
    brick, edge = masonry(shape, 14, 5, 0.05, 0.07, 51)
    rng = np.random.default_rng(54)
    tone = rng.uniform(0, 1, 70)[brick] + 0.18 * noise(shape, 0.8, 1, 55)
    inside = np.clip(edge * 14, 0, 1)
    colour = mix([0.42, 0.22, 0.16], [0.68, 0.40, 0.27], tone)
    colour = mix([0.60, 0.56, 0.49], colour, inside)
    colour = colour * (0.86 + 0.10 * noise(shape, 1.8, 0.5, 56))[..., None]
    write_png("bricks.png", colour)
    write_png("bricks_normal.png", normals(3.0 * inside + 0.5 * noise(shape, 0.8, 1, 57), 0.35))


def garden():
    """A backdrop: a meadow, hedges and the morning sky, as a camera that focuses on a table sees it."""
    height, width = 360, 720
    y, x = np.mgrid[0:height, 0:width] / height
    rng = np.random.default_rng(81)
    sky = mix([0.62, 0.76, 0.95], [0.98, 0.97, 0.92], y / 0.55 + 0.06 * noise((height, width), 2.0, 3, 82))
    picture = sky
    leaves = noise((height, width), 0.9, 1, 83)

    def crowns(count, base, low, high, dark, bright):
        nonlocal picture
        for cx in np.linspace(-0.05, 2.05, count) + rng.uniform(-0.06, 0.06, count):
            rx, ry = rng.uniform(low, high), rng.uniform(0.7, 1.1) * rng.uniform(low, high)
            r = np.hypot((x - cx) / rx, (y - base + 0.25 * ry) / ry) + 0.05 * leaves
            # The sun stands behind the garden, on the left, and lights the edges.
            light = np.clip(0.45 - 0.55 * (x - cx) / rx - 0.75 * (y - base) / ry + 0.22 * leaves, 0, 1)
            inside = np.clip((1 - r) * 12, 0, 1)[..., None]
            picture = picture * (1 - inside) + mix(dark, bright, light) * inside

    crowns(12, 0.50, 0.10, 0.19, [0.20, 0.30, 0.22], [0.50, 0.60, 0.38])
    crowns(9, 0.56, 0.09, 0.16, [0.10, 0.20, 0.08], [0.50, 0.62, 0.22])
    meadow = mix([0.55, 0.66, 0.20], [0.24, 0.42, 0.10], (y - 0.56) / 0.5 + 0.12 * noise((height, width), 1.3, 5, 84))
    below = np.clip((y - 0.56 - 0.006 * leaves) * 40, 0, 1)[..., None]
    picture = picture * (1 - below) + meadow * below
    crowns(5, 0.66, 0.07, 0.12, [0.07, 0.16, 0.05], [0.44, 0.60, 0.16])
    write_png("garden.png", np.clip(picture, 0, 1))


def storm():
    """All directions of the sky, equirectangular: rain clouds ahead, and the clear evening sky behind the camera."""
    height, width = 768, 1536
    azimuth = (np.arange(width)[None, :] + 0.5) / width * 2 * np.pi - np.pi
    elevation = np.pi / 2 - (np.arange(height)[:, None] + 0.5) / height * np.pi
    ahead = 0.5 + 0.5 * np.cos(azimuth) * np.cos(np.clip(elevation, 0, 2))
    # Clouds lie in a layer, so they are finer near the horizon.
    clouds = np.zeros((height, width))
    for k, (slope, stretch, seed, weight) in enumerate(((1.7, 2.6, 131, 1.0), (1.35, 3.6, 132, 0.55))):
        layer = noise((height, width), slope, stretch, seed)
        rise = (height * (0.5 - 0.42 * np.tanh(2.2 * np.clip(elevation, 0, 2)))).astype(int)[:, 0] * (k + 1)
        clouds += weight * layer[rise % height]
    bulge = np.clip(0.5 + 0.28 * clouds, 0, 1)
    up = np.clip(elevation / (np.pi / 2), 0, 1)
    dark = mix([0.27, 0.30, 0.36], [0.15, 0.17, 0.21], up * 1.8) * (0.70 + 0.55 * bulge)[..., None]
    clear = mix([0.98, 0.86, 0.70], [0.42, 0.58, 0.86], up * 2.2)
    white = mix(clear, [1.0, 0.94, 0.86], np.clip(clouds - 0.6, 0, 1) * 0.8)
    sky = mix(white, dark, np.clip((ahead - 0.30) * 2.4 + 0.12 * clouds, 0, 1))
    sky = np.where(elevation[..., None] < 0, sky[height // 2 - 1][None] * 0.25, sky)
    write_png("storm.png", sky)


def asphalt():
    """Stones in bitumen, and a worn line of white paint for a mix of materials."""
    shape = (384, 384)
    stones = noise(shape, 0.55, 1, 141, low=22)
    size = noise(shape, 1.4, 1, 142)
    tone = 0.35 + 0.22 * stones + 0.12 * size
    colour = mix([0.13, 0.13, 0.135], [0.40, 0.38, 0.36], tone)
    write_png("asphalt.png", colour, 16)
    write_png("asphalt_normal.png", normals(np.clip(1.7 * stones, -1.2, 1.5), 0.75), 12)
    height, width = 480, 480
    y, x = np.mgrid[0:height, 0:width] / height
    across = (y - 0.50 - 0.14 * x) / 0.026
    wear = noise((height, width), 0.9, 1.6, 143) + 0.8 * noise((height, width), 1.9, 1, 144)
    line = np.clip((1 - np.abs(across)) * 9, 0, 1) * np.clip((1.15 - wear) * 2.5, 0, 1)
    write_png("line.png", line, 32)


def films():
    """Thicknesses of the film of a bubble, which drains and swirls, and of oil on a puddle."""
    height, width = 256, 512
    v = np.arange(height)[:, None] / height + np.zeros((1, width))
    across = np.arange(width)[None, :] / width * 2 * np.pi
    swirl = noise((height, width), 2.3, 1.6, 151) * np.sin(np.pi * v)
    fine = noise((height, width), 1.7, 3, 152) * np.sin(np.pi * v) ** 2
    film = 0.08 + 0.80 * v**0.8 + 0.085 * swirl + 0.04 * fine * (0.6 + 0.4 * np.cos(across + 4 * v))
    write_png("bubble_film.png", film, 1)
    size = 384
    y, x = np.mgrid[0:size, 0:size] / size - 0.5
    warp = [noise((size, size), 2.4, 1, seed) for seed in (153, 154, 155)]
    r = np.hypot(x + 0.07 * warp[0], (y + 0.07 * warp[1]) * 1.15)
    oil = np.exp(-((r / 0.24) ** 2)) + 0.10 * warp[2] * np.exp(-((r / 0.3) ** 2))
    write_png("oil_film.png", np.clip(oil * 0.85, 0, 1), 1)


if __name__ == "__main__":
    wood()
    letter()
    plaster()
    stone()
    cobbles()
    bricks()
    garden()
    storm()
    asphalt()
    films()
