"""Writes the benchmark scenes with 1,000 lights: lights_street.json and lights_rooms.json.

For each scene, it also writes a version with only the ten lights that matter for the view.
"""

import json
import random
import sys
from pathlib import Path

GREY = {"diffuse": {"reflectance": 0.5}}


def rectangle(name, width, height, axis, degrees, at):
    """Returns a rectangle. Its normal is +y, rotated by the angle around the axis."""
    transform = [{"rotate": {"axis": axis, "degrees": degrees}}, {"translate": at}]
    shape = {"rectangle": {"width": width, "height": height}}
    return {"name": name, "shape": shape, "material": "grey", "transform": transform}


def street():
    """A street of 5 km with two rows of lamps of equal power. The view covers about 20 m."""
    objects = [rectangle("ground", 12, 5100, [1, 0, 0], 0, [0, 0, 0])]
    objects += [
        rectangle(f"{side} houses", 10, 5100, [0, 0, 1], degrees, [x, 5, 0])
        for side, degrees, x in [("left", -90, -6), ("right", 90, 6)]
    ]
    at = [[x, 5, 10 * i - 2495] for i in range(500) for x in (-4, 4)]
    lights = [{"point": {"at": place, "spectrum": "D65", "power": 20}} for place in at]
    nearest = sorted(range(1000), key=lambda i: abs(at[i][2]))[:10]
    camera = {"from": [-5, 9, -9], "at": [1.5, 1, 1], "lens": {"pinhole": {"fov": 55}}}
    return camera, objects, lights, [lights[i] for i in nearest]


def rooms():
    """100 closed rooms with ten panels each, on the walls and the ceiling. The powers of the panels
    cover three decades. The view is inside one room."""
    draw = random.Random(1)
    walls = [
        rectangle("floor", 40, 40, [1, 0, 0], 0, [20, 0, 20]),
        rectangle("ceiling", 40, 40, [1, 0, 0], 180, [20, 3, 20]),
    ]
    for i in range(11):
        walls.append(rectangle(f"wall x{i}", 3, 40, [0, 0, 1], 90, [4 * i, 1.5, 20]))
        walls.append(rectangle(f"wall z{i}", 40, 3, [1, 0, 0], 90, [20, 1.5, 4 * i]))
    panels, inside = [], []
    for room in range(100):
        x, z = 4 * (room % 10), 4 * (room // 10)
        for number in range(10):
            u, v = draw.uniform(0.4, 3.6), draw.uniform(0.4, 2.6)
            axis, degrees, at = draw.choice([
                ([1, 0, 0], 180, [x + u, 2.98, z + 4 * v / 3]),
                ([0, 0, 1], -90, [x + 0.02, v, z + u]),
                ([0, 0, 1], 90, [x + 3.98, v, z + u]),
                ([1, 0, 0], 90, [x + u, v, z + 0.02]),
                ([1, 0, 0], -90, [x + u, v, z + 3.98]),
            ])
            panel = rectangle(f"panel {room}.{number}", 0.2, 0.2, axis, degrees, at)
            panel["emission"] = {"spectrum": "D65", "power": round(10 ** draw.uniform(-1, 2), 4)}
            panels.append(panel)
            if room == 55:
                inside.append(panel)
    camera = {"from": [20.2, 2.2, 20.2], "at": [22.5, 1, 22.5], "lens": {"pinhole": {"fov": 70}}}
    return camera, walls + panels, [], inside


def write(path, title, camera, objects, lights):
    """Writes a scene file with one object or light per line."""
    film = {"width": 160, "height": 90}
    fields = {"title": title, "camera": camera, "film": film, "materials": {"grey": GREY}}
    lines = [f'  "{name}": {json.dumps(value)}' for name, value in fields.items()]
    for name, items in (("objects", objects), ("lights", lights)):
        if items:
            lines.append(f'  "{name}": [\n    ' + ",\n    ".join(map(json.dumps, items)) + "\n  ]")
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def main():
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    camera, objects, lights, ten = street()
    write(folder / "lights_street.json", "1,000 street lamps", camera, objects, lights)
    write(folder / "lights_street_ten.json", "the ten nearest street lamps", camera, objects, ten)
    camera, objects, _, ten = rooms()
    walls = [item for item in objects if "emission" not in item]
    write(folder / "lights_rooms.json", "1,000 panels in 100 rooms", camera, objects, [])
    write(folder / "lights_rooms_ten.json", "the ten panels of one room", camera, walls + ten, [])


main()
