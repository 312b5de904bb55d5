# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads values and pictures from the sockets of shader nodes."""

from __future__ import annotations

import math
from typing import Any

from .files import Folder
from .report import Report

#: The reflectance that shows a missing picture, as in Cycles.
MAGENTA = {"rgb": [1.0, 0.0, 1.0]}


def source(socket: Any) -> Any:
    """Returns the node that feeds a socket, or None. Reroute nodes are skipped."""
    while socket.is_linked and socket.links and not socket.links[0].is_muted:
        socket = socket.links[0].from_socket
        if socket.node.type != "REROUTE":
            return socket.node
        socket = socket.node.inputs[0]
    return None


def surface_node(tree: Any, socket: str) -> Any:
    """Returns the node that feeds an input of the active output for Cycles, or None."""
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
    return source(output.inputs[socket]) if output is not None else None


class SocketReader:
    """Reads the sockets of the nodes of one material, light or world."""

    def __init__(self, owner: str, folder: Folder, report: Report) -> None:
        self.owner, self.folder, self.report = owner, folder, report

    def missing(self, what: str) -> None:
        """States that a setting is not mapped."""
        self.report.missing(self.owner, what)

    def value(self, node: Any, name: str) -> Any:
        """Returns the constant of a socket. If a node feeds it that has none, reports the node."""
        socket = node.inputs[name]
        feeding = source(socket)
        if feeding is None:
            value = socket.default_value
        elif feeding.type in {"RGB", "VALUE"}:
            value = feeding.outputs[0].default_value
        elif feeding.type == "BLACKBODY" and source(feeding.inputs[0]) is None:
            return blackbody_rgb(feeding.inputs[0].default_value)
        else:
            self.missing(f"the node '{feeding.name}' in '{name}' of '{node.name}'")
            value = socket.default_value
        return list(value) if hasattr(value, "__len__") else value

    def image(self, node: Any, name: str) -> dict[str, Any] | None:
        """Returns the picture that an Image Texture node feeds to a socket, with its map of uv."""
        feeding = source(node.inputs[name])
        if feeding is None or feeding.type != "TEX_IMAGE":
            return None
        if feeding.image is None:
            self.missing(f"the node '{feeding.name}' without an image")
            return {"missing": True}
        picture = self.folder.picture(feeding.image, self.owner)
        if picture is None:
            return {"missing": True}
        if feeding.projection != "FLAT":
            self.missing(f"the projection {feeding.projection} of '{feeding.name}'")
        wrap = {"REPEAT": "repeat", "MIRROR": "mirror", "EXTEND": "clamp"}.get(feeding.extension)
        if wrap is None:
            self.missing(f"the extension {feeding.extension} of '{feeding.name}'")
        picture["wrap"] = wrap or "clamp"
        picture["filter"] = "nearest" if feeding.interpolation == "Closest" else "bilinear"
        uv = self._uv_map(feeding)
        if uv:
            picture["uv"] = uv
        return picture

    def reflectance(self, node: Any, name: str) -> Any:
        """Returns the reflectance of a colour socket: a picture or a smooth spectrum."""
        picture = self.image(node, name)
        if picture is not None:
            return MAGENTA if picture.get("missing") else {"image": picture}
        colour = self.value(node, name)[:3]
        return {"rgb": [min(1.0, max(0.0, component)) for component in colour]}

    def number(self, node: Any, name: str) -> Any:
        """Returns the number of a socket from 0 to 1, or the picture of numbers that feeds it."""
        picture = self.image(node, name)
        if picture is not None and not picture.get("missing"):
            return {"image": picture}
        if picture is not None:
            return node.inputs[name].default_value
        return min(1.0, max(0.0, self.value(node, name)))

    def _uv_map(self, node: Any) -> dict[str, Any] | None:
        feeding = source(node.inputs["Vector"])
        if feeding is None:
            return None
        scale, rotate, offset = (1.0, 1.0), 0.0, (0.0, 0.0)
        if feeding.type == "MAPPING":
            location, rotation, scale3 = (feeding.inputs[key] for key in ("Location", "Rotation", "Scale"))
            turned = list(rotation.default_value)
            if feeding.vector_type != "POINT" or abs(turned[0]) + abs(turned[1]) > 1e-6:
                self.missing(f"the node '{feeding.name}', which is no plain map of UV")
            scale, rotate = tuple(scale3.default_value)[:2], turned[2]
            offset = tuple(location.default_value)[:2]
            feeding = source(feeding.inputs["Vector"])
        is_uv = feeding is None or feeding.type == "UVMAP"
        if feeding is not None and feeding.type == "TEX_COORD":
            link = node.inputs["Vector"].links[0]
            link = link if link.from_node.type == "TEX_COORD" else link.from_node.inputs["Vector"].links[0]
            is_uv = link.from_socket.name == "UV"
        if not is_uv:
            self.missing(f"the coordinates of '{node.name}' other than UV")
        if feeding is not None and feeding.type == "UVMAP" and feeding.uv_map:
            self.report.add(f"{self.owner}: '{feeding.name}' uses the UV map that is active for rendering")
        return uv_map(scale, rotate, offset)


def uv_map(scale: tuple[float, ...], rotate: float, offset: tuple[float, ...]) -> dict[str, Any] | None:
    """Returns Abbe's form of Blender's map of coordinates, R(rotate) (scale · uv) + offset.

    v increases upwards in Blender and downwards in Abbe, which both scale, then rotate, then shift.
    With v = 1 − w, the offset of w contains the image of the corner w = 0.
    """
    sx, sy = scale
    if (sx, sy, rotate, *offset) == (1.0, 1.0, 0.0, 0.0, 0.0):
        return None
    cos, sin = math.cos(rotate), math.sin(rotate)
    u = offset[0] - sin * sy
    v = 1.0 - offset[1] - cos * sy
    return {"scale": [sx, sy], "rotate": math.degrees(rotate), "offset": [u, v]}


def blackbody_rgb(kelvin: float) -> list[float]:
    """Returns the linear sRGB colour of a black body with the luminance 1, without negative parts.

    The chromaticity is the cubic approximation of Kim et al. (US patent 7024034, 2006).
    """
    t = 1000.0 / min(25000.0, max(1667.0, kelvin))
    if kelvin < 4000.0:
        x = ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
    else:
        x = ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390
    if kelvin < 2222.0:
        y = ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
    elif kelvin < 4000.0:
        y = ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
    else:
        y = ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483
    big_x, big_z = x / y, (1.0 - x - y) / y
    rgb = (
        3.2404542 * big_x - 1.5371385 - 0.4985314 * big_z,
        -0.9692660 * big_x + 1.8760108 + 0.0415560 * big_z,
        0.0556434 * big_x - 0.2040259 + 1.0572252 * big_z,
    )
    return [max(0.0, component) for component in rgb]
