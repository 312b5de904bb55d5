#!/usr/bin/env python3
"""Computes a lens that throws a picture, and writes it to scenes/gallery/meshes/caustic_lens.ply.

    scenes/gallery/make/caustic_lens.py

The lens is a plate with one flat side. Parallel light enters there, and the other side sends it to
a wall, where a picture appears. The map from the lens to the wall is the optimal transport between
the even light on the lens and the light of the picture, so it is the gradient of a potential
(Brenier 1991), and the height of the surface is this potential apart from a factor, because angles
are small. The Monge-Ampère equation for the potential is solved by repeated Poisson equations
(Loeper and Rapetti 2005, "Numerical solution of the Monge-Ampère equation by a Newton's
algorithm"). Lengths are in cm. Needs NumPy, Pillow and the font DejaVu Serif.
"""

import numpy as np
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from meshes import write_ply

# The plate and the place of the wall.
SIDE, THICKNESS, DISTANCE, MAGNIFICATION = 10.0, 0.8, 60.0, 2.2
# Acrylic glass at 550 nm.
INDEX = 1.4936
# The cells of the solution and of the mesh along a side.
CELLS, MESH_CELLS = 512, 192
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSerif-Italic.ttf"


def picture(size):
    """The light on the wall, with a mean of 1: Abbe's formula for what a microscope resolves."""
    scale = 4
    image = Image.new("L", (size * scale, size * scale), 0)
    draw, unit = ImageDraw.Draw(image), size * scale / 100

    def text(x, y, letters, height):
        font = ImageFont.truetype(FONT, int(height * unit))
        draw.text((x * unit, y * unit), letters, fill=255, font=font, anchor="mm")

    def ring(radius, width):
        low, high = (50 - radius) * unit, (50 + radius) * unit
        draw.ellipse((low, low, high, high), outline=255, width=int(width * unit))

    ring(45, 1.6)
    ring(41.5, 0.7)
    text(22, 50, "d", 27)
    text(38, 50, "=", 22)
    text(64.5, 37, "λ", 25)
    draw.rectangle((48 * unit, 49.3 * unit, 81 * unit, 51 * unit), fill=255)
    text(64.5, 61, "2n sin α", 10.5)
    image = image.resize((size, size), Image.LANCZOS).filter(ImageFilter.GaussianBlur(size / 400))
    light = 0.25 + 2.3 * np.asarray(image, float) / 255
    return light / light.mean()


def cosine_transform(values, axis):
    """The type-2 cosine transform along an axis, without a normalisation."""
    values = np.moveaxis(values, axis, -1)
    count = values.shape[-1]
    spectrum = np.fft.rfft(np.concatenate([values, values[..., ::-1]], -1))[..., :count]
    phase = np.exp(-0.5j * np.pi * np.arange(count) / count)
    return np.moveaxis((spectrum * phase).real, -1, axis)


def inverse_cosine_transform(values, axis):
    values = np.moveaxis(values, axis, -1)
    count = values.shape[-1]
    phase = np.exp(0.5j * np.pi * np.arange(count) / count)
    spectrum = np.concatenate([values * phase, np.zeros((*values.shape[:-1], 1))], -1)
    return np.moveaxis(np.fft.irfft(spectrum, 2 * count)[..., :count], -1, axis)


def solve_poisson(right):
    """Solves the Poisson equation on the unit square, with no slope across its sides."""
    count = len(right)
    waves = (2 * count * np.sin(0.5 * np.pi * np.arange(count) / count)) ** 2
    total = waves[:, None] + waves[None, :]
    total[0, 0] = np.inf
    spectrum = cosine_transform(cosine_transform(right, 0), 1) / -total
    return inverse_cosine_transform(inverse_cosine_transform(spectrum, 0), 1)


def derivatives(potential):
    """The gradient, and the second derivatives xx, yy and xy, of a potential at cell centres."""
    count = len(potential)
    padded = np.pad(potential, 1, mode="edge")
    gradient = [(padded[1:-1, 2:] - padded[1:-1, :-2]) * count / 2, (padded[2:, 1:-1] - padded[:-2, 1:-1]) * count / 2]
    centre = padded[1:-1, 1:-1]
    xx = (padded[1:-1, 2:] - 2 * centre + padded[1:-1, :-2]) * count**2
    yy = (padded[2:, 1:-1] - 2 * centre + padded[:-2, 1:-1]) * count**2
    xy = (padded[2:, 2:] - padded[2:, :-2] - padded[:-2, 2:] + padded[:-2, :-2]) * count**2 / 4
    return gradient, xx, yy, xy


def sample(image, x, y):
    """Interpolates an image of the unit square."""
    count = len(image)
    x, y = (np.clip(v * count - 0.5, 0, count - 1.001) for v in (x, y))
    i, j = x.astype(int), y.astype(int)
    s, t = x - i, y - j
    top = image[j, i] * (1 - s) + image[j, i + 1] * s
    return top * (1 - t) + (image[j + 1, i] * (1 - s) + image[j + 1, i + 1] * s) * t


def transport(light, steps=300):
    """The potential whose gradient moves even light on the unit square to `light`."""
    count = len(light)
    centres = (np.arange(count) + 0.5) / count
    x, y = np.meshgrid(centres, centres)
    potential = np.zeros_like(light)
    for step in range(steps):
        (to_x, to_y), xx, yy, xy = derivatives(potential)
        area = (1 + xx) * (1 + yy) - xy**2
        wanted = 1 / sample(light, x + to_x, y + to_y)
        error = wanted - area
        if step % 50 == 0 or step == steps - 1:
            print(f"step {step}: the areas differ by {np.sqrt(np.mean(error**2)):.4f}")
        potential += solve_poisson((error - error.mean()) * 0.2)
    return potential


def plate(potential):
    """The vertices with normals and the faces of the lens. Light flows along -z, and y is up."""
    cells = MESH_CELLS
    u = np.linspace(0, 1, cells + 1)
    u, v = (g.ravel() for g in np.meshgrid(u, u))
    scale = SIDE / (DISTANCE * (INDEX - 1))
    (to_x, to_y), *_ = derivatives(potential)
    sloped = [
        MAGNIFICATION * sample(part, u, v) + (MAGNIFICATION - 1) * (w - 0.5) for part, w in ((to_x, u), (to_y, v))
    ]
    slope_x, slope_y = (scale * part for part in sloped)
    height = MAGNIFICATION * sample(potential, u, v) + (MAGNIFICATION - 1) * ((u - 0.5) ** 2 + (v - 0.5) ** 2) / 2
    z = -scale * SIDE * (height - height.min()) - THICKNESS / 2
    normals = np.stack([-slope_x, slope_y, -np.ones_like(z)], -1)
    normals /= np.linalg.norm(normals, axis=-1)[:, None]
    front = np.concatenate([np.stack([(u - 0.5) * SIDE, (0.5 - v) * SIDE, z], -1), normals], -1)
    grid = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = (part.ravel() for part in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]))
    vertices, faces = [front], [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
    back = THICKNESS / 2
    for edge, normal in (
        (grid[0], (0, 1, 0)),
        (grid[::-1, 0], (-1, 0, 0)),
        (grid[-1, ::-1], (0, -1, 0)),
        (grid[:, -1], (1, 0, 0)),
    ):
        near = front[edge, :3]
        far = near * [1, 1, 0] + [0, 0, back]
        first, steps = sum(map(len, vertices)), len(edge)
        vertices.append(np.concatenate([np.concatenate([near, far]), np.tile(normal, (2 * steps, 1))], -1))
        i = first + np.arange(steps - 1)
        faces += [np.stack([i, i + steps, i + steps + 1], -1), np.stack([i, i + steps + 1, i + 1], -1)]
    # The flat side ends at the same points as the others, so that the body is closed.
    first = sum(map(len, vertices))
    rim = np.concatenate([grid[0, :-1], grid[:-1, -1], grid[-1, :0:-1], grid[:0:-1, 0]])
    flat = np.concatenate([front[rim, :3] * [1, 1, 0] + [0, 0, back], [[0, 0, back]]])
    vertices.append(np.concatenate([flat, np.tile((0, 0, 1), (len(flat), 1))], -1))
    i = np.arange(len(rim))
    faces.append(np.stack([np.full_like(i, first + len(rim)), first + (i + 1) % len(rim), first + i], -1))
    return np.concatenate(vertices), np.concatenate(faces)


if __name__ == "__main__":
    vertices, faces = plate(transport(picture(CELLS)))
    write_ply("caustic_lens", vertices, [(3, tuple(face)) for face in faces])
