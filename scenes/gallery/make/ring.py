#!/usr/bin/env python3
"""Writes the meshes of the scene diamond_ring into scenes/gallery/meshes.

    scenes/gallery/make/ring.py

The ring stands on the origin: its axis is z, and the head of its stone is at the top (+y). Lengths
are in mm. Needs NumPy.
"""

import numpy as np

import meshes
from three_lamps import tube, turned, write

INNER = 8.6
SEAT = 13.7  # height of the girdle of the stone above the axis of the ring


def band():
    """A band that is flat inside and round outside, and narrower towards the stone."""
    angle = np.linspace(0, 2 * np.pi, 145)
    around = np.linspace(0, 2 * np.pi, 33)
    up = 0.5 + 0.5 * np.cos(angle)
    width = 1.35 - 0.45 * up**3
    thick = 1.6 + 0.25 * up**2
    c, s = np.cos(around), np.sin(around)
    # A superellipse, flatter on the inside.
    z = np.sign(s) * np.abs(s) ** 0.75
    r = np.where(c > 0, np.abs(c) ** 0.9, -(np.abs(c) ** 0.45) * 0.30)
    radius = INNER + 0.3 * thick[:, None] + thick[:, None] * r[None, :] * 0.95
    depth = width[:, None] * z[None, :]
    position = np.stack([radius * np.sin(angle)[:, None], radius * np.cos(angle)[:, None], depth], -1)
    along, across = np.gradient(position, axis=0), np.gradient(position, axis=1)
    normal = np.cross(along, across)
    centre = np.stack([(INNER + 0.5 * thick) * np.sin(angle), (INNER + 0.5 * thick) * np.cos(angle), 0 * angle], -1)[:, None]
    normal *= np.sign((normal * (position - centre)).sum(-1, keepdims=True))
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    uv = np.stack(np.broadcast_arrays(angle[:, None] * 1.5, around[None, :] / 6.3), -1)
    write("ring_band", [np.concatenate([position, normal, uv], -1)])


def head():
    """Four claws and two rings of wire that hold a stone of 6.5 mm."""
    parts = []
    for k in range(4):
        a = np.pi / 4 + k * np.pi / 2
        out = np.array([np.cos(a), 0, np.sin(a)])
        curve = [(0.9, 9.9), (1.9, 11.4), (2.85, 13.0), (3.32, 13.9), (3.2, 14.35), (2.72, 14.62)]
        path = meshes.spline([r * out + [0, y, 0] for r, y in curve], 6)
        t = np.linspace(0, 1, len(path))
        radius = 0.42 - 0.06 * t
        radius[-1] = 0.02
        radius[-2] = 0.26
        parts.append(tube(path, radius[:, None, None], 14))
    for ring, height, wire in ((1.75, 11.2, 0.28), (2.55, 12.55, 0.24)):
        a = np.linspace(0, 2 * np.pi, 65)
        parts.append(tube(np.stack([ring * np.cos(a), height + 0 * a, ring * np.sin(a)], -1), wire, 12))
    write("ring_head", parts)


def cup():
    """A cup around the lower half of a stone of radius 1."""
    curve = [(0.20, -0.92), (0.62, -0.62), (1.0, -0.12), (1.10, 0.02), (1.06, 0.07), (1.02, 0.0), (0.95, -0.1), (0.16, -0.80)]
    write("ring_cup", [turned(meshes.smooth(curve, 0.04, 3), 24)])


if __name__ == "__main__":
    band()
    head()
    cup()
