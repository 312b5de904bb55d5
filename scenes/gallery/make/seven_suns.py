#!/usr/bin/env python3
"""Renders one place at seven heights of the sun, into target/gallery/seven_suns.png.

    scenes/gallery/make/seven_suns.py [--program target/release/abbe]

1. The sky: air and ozone around a planet of true size, with light that is scattered any number of
   times, by the path tracer. Each height has four views of few pixels, because the sky is smooth.
2. The views become a picture of all directions. The sky is symmetric about the vertical plane
   through the sun, so both halves of a view are averaged, and noise is smoothed along the azimuth.
3. The landscape in the light of this sky and of the sun, towards the sun and away from it, in
   seven slices of 21° of one panorama.

Needs NumPy, Pillow and OpenEXR.
"""

import argparse
import json
import math
import pathlib
import subprocess

import numpy as np
import OpenEXR
from PIL import Image, ImageDraw, ImageFont

import meshes
import textures

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent.parent
SCENE = ROOT / "scenes/gallery/seven_suns.json"
WORK = ROOT / "target/gallery/seven_suns"
HEIGHTS = [50, 15, 4, 0.5, -1.5, -3, -4.5]
PASSES = [600, 600, 800, 1200, 2000, 3200, 4500]
# The exposure of the two rows at each height, in stops.
EXPOSURE = [(-12.8, -13.2), (-13.7, -12.6), (-12.2, -12.2), (-11.5, -10.1), (-9.5, -8.5), (-7.9, -6.9), (-6.5, -5.1)]
# Views of the sky: azimuth from the sun, pitch, vertical field of view, width and height.
VIEWS = {"front": (0, 20, 48, 40, 72), "back": (180, 20, 48, 40, 72), "zenith": (0, 90, 110, 18, 18), "side": (90, 25, 100, 18, 18)}
SLICE, GAP, TALL = 270, 5, 536
FOV, PITCH = 40.0, 6.0
STEP = 2 * math.degrees(math.atan(math.tan(math.radians(FOV / 2)) * SLICE / TALL))
EARTH = 6371000.0


def direction(azimuth, elevation):
    """The unit vector at an azimuth clockwise from −z, in degrees."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.stack(np.broadcast_arrays(np.sin(a) * np.cos(e), np.sin(e) + 0 * a, -np.cos(a) * np.cos(e)), -1)


def abbe(*arguments):
    subprocess.run([str(PROGRAM), "render", *map(str, arguments), "--quiet"], check=True)


def sky_view(height, view, passes):
    """Renders a view of the sky, and returns its linear RGB."""
    azimuth, pitch, fov, width, rows = VIEWS[view]
    out = WORK / f"{view}_{height}.exr"
    if not out.exists():
        eye = np.array([0, EARTH + 20, 0])
        sets = {
            "variables.toward": list(-direction(0, height)),
            "camera.at": list(eye + 1000 * direction(azimuth, pitch)),
            "camera.up": [0, 0, -1] if pitch == 90 else [0, 1, 0],
            "camera.lens.pinhole.fov": fov,
        }
        abbe(SCENE, "--integrator", "path", "--passes", passes, "--size", f"{width}x{rows}", "--no-denoise", "-o", out,
             *(part for key, value in sets.items() for part in ("--set", f"{key}={json.dumps(value)}")))
    return OpenEXR.File(str(out)).channels()["RGB"].pixels.astype(float)


def smooth(picture, across, along):
    """Averages with a Gaussian weight across the columns and the rows."""
    for axis, sigma in ((1, across), (0, along)):
        x = np.arange(picture.shape[axis])
        weight = np.exp(-0.5 * ((x[:, None] - x[None, :]) / sigma) ** 2)
        picture = np.moveaxis(np.tensordot(weight / weight.sum(1, keepdims=True), picture, (1, axis)), 0, axis)
    return picture


def look_up(picture, view, d):
    """The bilinear value of a view in the directions d, and whether the view contains them."""
    azimuth, pitch, fov, width, rows = VIEWS[view]
    forward = direction(azimuth, pitch)
    right = np.cross(forward, [0, 0, -1.0] if pitch == 90 else [0, 1.0, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    depth = d @ forward
    scale = rows / 2 / math.tan(math.radians(fov / 2))
    z = np.maximum(depth, 1e-6)
    x, y = width / 2 - 0.5 + scale * (d @ right) / z, rows / 2 - 0.5 - scale * (d @ up) / z
    inside = (depth > 0) & (x > -0.5) & (x < width - 0.5) & (y > -0.5) & (y < rows - 0.5)
    x, y = np.clip(x, 0, width - 1.001), np.clip(y, 0, rows - 1.001)
    i, j = x.astype(int), y.astype(int)
    a, b = (x - i)[..., None], (y - j)[..., None]
    at = lambda dj, di: picture[j + dj, i + di]
    return (at(0, 0) * (1 - a) + at(0, 1) * a) * (1 - b) + (at(1, 0) * (1 - a) + at(1, 1) * a) * b, inside


def sky_picture(height, passes):
    """Writes the sky as an equirectangular picture with the sun at −z, and returns its path."""
    views = {}
    for view in VIEWS:
        picture = sky_view(height, view, passes if view in ("front", "back") else passes * 3 // 4)
        if view != "side":
            picture = 0.5 * (picture + picture[:, ::-1])
        views[view] = smooth(picture, *{"front": (3.0, 0.8), "back": (8.0, 1.2), "zenith": (1.5, 1.5), "side": (1.5, 1.5)}[view])
    rows, columns = 512, 1024
    elevation = 90 - (np.arange(rows) + 0.5) * 180 / rows
    azimuth = (np.arange(columns) + 0.5) * 360 / columns - 180
    # The ground below the horizon is not of the sky: it repeats the lowest row of the sky.
    d = direction(azimuth[None, :], np.maximum(elevation, 0.15)[:, None])
    value, weight = np.zeros(d.shape), np.zeros(d.shape[:2] + (1,))
    mirrored = d * np.where(d[..., :1] < 0, -1, 1)
    for view, strength in (("zenith", 1e-3), ("side", 1e-3), ("front", 1.0), ("back", 1.0)):
        part, inside = look_up(views[view], view, mirrored if view == "side" else d)
        value += part * strength * inside[..., None]
        weight += strength * inside[..., None]
    value = np.maximum(value / np.maximum(weight, 1e-12), 0)
    value[elevation < 0] *= 0.12
    path = WORK / f"sky_{height}.exr"
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"RGB": value.astype("f4")}).write(str(path))
    return path


def sunlight(height):
    """The illuminance of the sun through the air and the ozone, in lx, and its spectrum."""
    scene = json.loads(SCENE.read_text())
    if height < -0.3:
        return 0.0, None
    nm = np.arange(380, 781, 5)
    ozone = scene["media"]["air with ozone"]["grid"]["absorption"]["table"]
    rayleigh = np.loadtxt(ROOT / "data/media/rayleigh_air.csv", delimiter=",", comments="#", skiprows=1)
    s = np.linspace(0, 1500e3, 60001)
    radius = np.sqrt((EARTH + 20) ** 2 + s**2 + 2 * s * (EARTH + 20) * math.sin(math.radians(height)))
    h = radius - EARTH
    density = np.where(h < 1e5, np.exp(-h / 8000), 0)
    air, high = np.trapezoid(density, s), np.trapezoid(np.where(h > 18000, density, 0), s)
    tau = np.interp(nm, rayleigh[:, 0], rayleigh[:, 2]) * air + np.interp(nm, ozone["nm"], ozone["values"]) * high
    # A black body of 5778 K is near enough for the colour of the disc.
    planck = nm**-5.0 / (np.exp(1.4388e7 / (nm * 5778)) - 1)
    y = np.exp(-0.5 * ((nm - 559) / 42.0) ** 2)
    through = planck * np.exp(-tau)
    values = through / planck.max()
    return 133000 * (through * y).sum() / (planck * y).sum(), {"table": {"nm": nm.tolist(), "values": [float(f"{v:.4g}") for v in values]}}


def grid_mesh(name, x, y, z, u, v, keep=None):
    along = np.gradient(np.stack([x, y, z], -1), axis=0)
    across = np.gradient(np.stack([x, y, z], -1), axis=1)
    normal = np.cross(along, across)
    normal *= np.sign(normal[..., 1:2]) / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    up = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    faces[up[:, 1] < 0] = faces[up[:, 1] < 0][:, ::-1]
    visible = (points[faces, 1] > -2).any(1)
    vertices = np.concatenate([np.stack([x, y, z], -1), normal, np.stack([u, v], -1)], -1).reshape(-1, 8)
    meshes.write_ply(name, vertices, [(3, tuple(f)) for f in faces[visible]], "nx ny nz u v")


def heights(name, azimuth, r):
    """The far shores: x, y and z on a grid of azimuths and distances."""
    x, z = r * np.sin(azimuth), -r * np.cos(azimuth)
    if name == "hills":
        # The lake is open where the sun sets at 0.5°.
        gap = np.clip((np.abs(np.degrees(azimuth) - 2) - 9) / 16, 0, 1) ** 1.2
        rise = np.clip((r - 1700) / 2600, 0, 1)
        return x, -14 + gap * (rise * (95 + 120 * meshes.fractal(x, z, 2600, 6, 201)) + 14 * meshes.fractal(x, z, 300, 4, 202)), z
    rise = np.clip((r - 3600) / 6500, 0, 1) ** 1.25
    ridge = meshes.fractal(x + 0.3 * z, z - 0.2 * x, 5200, 8, 203, ridged=True)
    y = -25 + rise * (1750 + 1250 * ridge + 500 * meshes.fractal(x, z, 9000, 3, 204))
    y += 130 * np.clip(rise * 3, 0, 1) * meshes.fractal(x, z, 700, 6, 205)
    return x, np.where(r > 12500, y - (r - 12500) * 0.6, y), z


def cover(name, x, y, z):
    """The colour of the far shores: grass, or forest, rock and snow."""
    patches = meshes.fractal(x, z, 240, 5, 206)
    if name == "hills":
        return textures.mix([0.05, 0.075, 0.035], [0.12, 0.13, 0.06], 0.5 + 0.5 * patches)
    position = np.stack([x, y, z], -1)
    normal = np.cross(np.gradient(position, axis=0), np.gradient(position, axis=1))
    steep = np.abs(normal[..., 1]) / np.linalg.norm(normal, axis=-1)
    snow = (y - 900 - 380 * meshes.fractal(x, z, 1500, 4, 207)) / 260 + np.clip(3.0 * (steep - 0.7), -1.5, 0.6) + 0.5 * patches
    rock = textures.mix([0.16, 0.14, 0.13], [0.32, 0.29, 0.26], 0.5 + 0.5 * patches)
    forest = textures.mix([0.03, 0.05, 0.025], [0.09, 0.11, 0.05], 0.5 + 0.8 * patches)
    return textures.mix(textures.mix(forest, rock, (y - 620 - 200 * patches) / 160), [0.9, 0.91, 0.93], snow * 1.6)


def landscape():
    """Writes the meshes of the two shores, of the trees and of the figure on the jetty."""
    meshes.FOLDER = textures.FOLDER = WORK
    for name, near, far in (("hills", 1500, 5200), ("mountains", 3200, 14000)):
        # The picture of the ground has more detail than its mesh.
        for columns, rows in ((1100, 120), (2600, 260)):
            azimuth = np.radians(np.linspace(-92, 92, columns))[None, :]
            r = np.geomspace(near, far, rows)[:, None]
            x, y, z = heights(name, azimuth, r)
            if rows == 120:
                u, v = np.broadcast_arrays(np.linspace(0, 1, columns)[None, :], np.linspace(1, 0, rows)[:, None])
                grid_mesh(name, x, y, z, u, v)
            else:
                textures.write_png(f"{name}.png", np.clip(cover(name, x, y, z), 0, 1) ** (1 / 2.2), 1)
    waves = textures.noise((512, 512), 1.15, 2.5, 208)
    textures.write_png("waves.png", textures.normals(waves, 0.55), 2)
    rng = np.random.default_rng(209)
    vertices, faces = [], []
    def tree(at, height):
        """A spruce: whorls of drooping triangles around a trunk."""
        lean = rng.uniform(0, 6.28)
        for t in np.linspace(0.12, 0.99, int(16 + height)):
            reach = 0.21 * height * (1 - t) ** 0.8 * rng.uniform(0.75, 1.15) + 0.12
            for k in range(7):
                a = lean + 2.4 * k + 9 * t + rng.uniform(-0.3, 0.3)
                out = np.array([math.cos(a), 0, math.sin(a)])
                side = np.array([-out[2], 0, out[0]])
                root = np.array(at) + [0, t * height, 0]
                tip = root + out * reach * rng.uniform(0.8, 1.1) - [0, 0.30 * reach, 0]
                first = len(vertices)
                for p in (root + side * 0.13 * reach + [0, 0.10 * reach, 0], root - side * 0.13 * reach, tip, root + 0.6 * (tip - root) + side * 0.24 * reach, root + 0.6 * (tip - root) - side * 0.24 * reach):
                    vertices.append(tuple(p))
                faces.extend([(3, (first, first + 1, first + 2)), (3, (first, first + 3, first + 2)), (3, (first + 1, first + 4, first + 2))])
    for centre, width, count, distance in ((-66, 15, 34, 75), (-40, 8, 9, 120), (64, 16, 30, 95), (36, 7, 7, 150)):
        for _ in range(count):
            a = math.radians(centre + rng.normal(0, 0.5) * width)
            r = distance * rng.uniform(0.85, 1.3)
            height = rng.uniform(0.5, 1) * (0.9 if count > 20 else 0.7) * 17
            tree((r * math.sin(a), 0.2, -r * math.cos(a)), height)
            root = np.array([r * math.sin(a), 0, -r * math.cos(a)])
            first = len(vertices)
            for p in ([0.18, -1, 0], [-0.18, -1, 0], [0, height, 0]):
                vertices.append(tuple(root + p))
            faces.append((3, (first, first + 1, first + 2)))
    meshes.write_ply("trees", np.array(vertices), faces, "")
    # The spits of land below the trees.
    a, t = np.meshgrid(np.radians(np.linspace(-92, 92, 500)), np.linspace(0, 1, 14))
    deg = np.degrees(a)
    land = np.maximum.reduce([np.exp(-(((deg - c) / w) ** 4)) for c, w in ((-70, 19), (-40, 9), (70, 20), (36, 8))])
    r = 70 + 95 * t
    y = -0.5 + land * (1.6 * np.sin(np.pi * t) ** 0.5 + 0.5 * meshes.fractal(r * np.sin(a), r * np.cos(a), 14, 4, 210)) - (1 - land) * 2
    grid_mesh("spits", r * np.sin(a), y, -r * np.cos(a), deg / 10, t)


def figure(azimuth, distance):
    """A jetty, and a person at its end, as objects."""
    turn = {"rotate": {"axis": [0, 1, 0], "degrees": -azimuth}}
    def part(name, shape, *steps, material="clothes"):
        return {"name": name, "shape": shape, "material": material, "transform": [*steps, {"translate": [0, 0, -distance]}, turn]}
    limb = lambda radius, height: {"cylinder": {"radius": radius, "height": height}}
    lean = lambda degrees: {"rotate": {"axis": [0, 0, 1], "degrees": degrees}}
    deck = 0.45
    objects = [part("jetty", {"box": {"size": [1.5, 0.12, 14]}}, {"translate": [0, deck - 0.06, 5.5]}, material="planks")]
    for z in (-1.2, 2.5, 6.5, 10.5):
        for x in (-0.7, 0.7):
            objects.append(part("pile", limb(0.09, 2.2), {"translate": [x, deck - 0.75, z]}, material="planks"))
    at = lambda x, y: {"translate": [x, deck + y, 0]}
    def body(name, x, y, size, degrees=0):
        return part(name, {"sphere": {"radius": 1}}, {"scale": size}, lean(degrees), at(x, y))
    objects += [
        body("leg", -0.10, 0.44, [0.085, 0.50, 0.1], 3),
        body("leg", 0.11, 0.44, [0.085, 0.50, 0.1], -4),
        body("hips", 0, 0.90, [0.175, 0.22, 0.14]),
        body("coat", 0, 1.14, [0.185, 0.36, 0.14]),
        body("shoulders", 0, 1.37, [0.205, 0.10, 0.12]),
        body("arm", -0.205, 1.10, [0.055, 0.34, 0.07], -7),
        body("arm", 0.205, 1.10, [0.055, 0.34, 0.07], 7),
        body("neck", 0, 1.50, [0.06, 0.12, 0.06]),
        body("head", 0, 1.64, [0.092, 0.125, 0.105]),
    ]
    return objects


def slice_scene(number, away, sky):
    """The scene of a slice.

    The landscape stays, and the sky turns so that the sun is in the middle of the slice, or behind
    the camera.
    """
    height = HEIGHTS[number]
    look = (number - 3) * STEP
    sun = look + (180 if away else 0)
    lux, spectrum = sunlight(height)
    turn = [{"rotate": {"axis": [0, 1, 0], "degrees": -sun}}]
    lights = [{"environment": {"image": sky.name, "luminance": 1, "transform": turn}}]
    # Behind the camera, the sun is a point and the lake has no diffuse base. The path tracer then
    # leaves out the sunlight that the lake mirrors to the mountains, of which it would find few,
    # bright dots.
    if lux:
        lights.append({"directional": {"toward": list(-direction(sun, max(height, 0.2))), "angular_diameter": 0 if away else 0.53, "spectrum": spectrum, "illuminance": lux}})
    surface = lambda name: {"diffuse": {"reflectance": {"image": {"path": f"{name}.png", "wrap": "clamp"}}}}
    ground = ["mountains"] if away else ["hills", "spits", "trees"]
    materials = {
        "water film": {"dielectric": {"ior": 1.334, "medium": "deep water"}}
        if away
        else {"glossy": {"reflectance": {"rgb": [0.006, 0.014, 0.018]}, "ior": 1.334, "roughness": 0.03}},
        "water": {"normal_map": {"material": "water film", "path": "waves.png", "strength": 0.05 if away else 0.14, "uv": {"scale": [2200, 2200]}}},
        "trees": {"diffuse": {"reflectance": {"rgb": [0.03, 0.045, 0.022]}}},
        "spits": {"diffuse": {"reflectance": {"rgb": [0.07, 0.07, 0.045]}}},
        "clothes": {"diffuse": {"reflectance": {"rgb": [0.14, 0.02, 0.015]}}},
        "planks": {"diffuse": {"reflectance": {"rgb": [0.16, 0.13, 0.1]}}},
        "hills": surface("hills"),
        "mountains": surface("mountains"),
    }
    lake = {"box": {"size": [30000, 40, 30000]}} if away else {"rectangle": {"width": 30000, "height": 30000}}
    objects = [{"name": "lake", "shape": lake, "material": "water", "transform": [{"translate": [0, -20 if away else 0, 0]}]}]
    objects += [{"name": name, "shape": {"mesh": {"path": f"{name}.ply", **({"smooth": True} if name == "spits" else {})}}, "material": name} for name in ground]
    if not away:
        objects += figure(STEP * 1.0 + 3, 13)
    return {
        "unit": "m",
        "camera": {"from": [0, 2.6, 0], "at": (np.array([0, 2.6, 0]) + direction(look, PITCH)).tolist(), "lens": {"pinhole": {"fov": FOV}}},
        "film": {"width": SLICE, "height": TALL, "exposure": {"ev": EXPOSURE[number][away]}, "bloom": {"fov": STEP}},
        "media": {"deep water": {"homogeneous": {"absorption": 5, "scattering": 0, "phase": "isotropic"}}},
        "materials": materials,
        "objects": objects,
        "lights": lights,
        "render": {"passes": ARGUMENTS.slice_passes},
    }


def main():
    WORK.mkdir(parents=True, exist_ok=True)
    landscape()
    strip = Image.new("RGB", (7 * SLICE + 6 * GAP, 2 * TALL + GAP + 3), (12, 12, 14))
    font = ImageFont.truetype("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", 22)
    draw = ImageDraw.Draw(strip)
    for number, (height, passes) in enumerate(zip(HEIGHTS, PASSES)):
        sky = sky_picture(height, passes)
        for away in (False, True):
            name = f"slice_{number}_{'away' if away else 'sun'}"
            (WORK / f"{name}.json").write_text(json.dumps(slice_scene(number, away, sky)))
            abbe(WORK / f"{name}.json", "--integrator", "path", "--denoise", "--size", f"{SLICE // ARGUMENTS.divide}x{TALL // ARGUMENTS.divide}", "-o", WORK / f"{name}.exr")
            picture = Image.open(WORK / f"{name}.png").convert("RGB").resize((SLICE, TALL))
            strip.paste(picture, (number * (SLICE + GAP), away * (TALL + GAP)))
        label = f"{height:g}°".replace("-", "−")
        draw.text((number * (SLICE + GAP) + SLICE - 12, TALL + GAP + TALL - 12), label, (235, 235, 235), font, anchor="rd")
    strip.save(WORK.parent / "seven_suns.png")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default=ROOT / "target/release/abbe")
    parser.add_argument("--slice-passes", type=int, default=24)
    parser.add_argument("--divide", type=int, default=1, help="render slices of fewer pixels")
    ARGUMENTS = parser.parse_args()
    PROGRAM = pathlib.Path(ARGUMENTS.program).resolve()
    main()
