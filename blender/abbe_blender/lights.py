# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the lights and the world of Blender."""

from __future__ import annotations

import math
from typing import Any

from mathutils import Euler, Matrix

from . import ies, units
from .files import Folder
from .nodes import SocketReader, source, surface_node
from .report import Report
from .spectra import spectrum

#: The rotation from Abbe's rectangle, which faces +y, to Blender's area light, which faces −z.
_FACING_DOWN = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
#: The rotation from Abbe's pictures of all directions (+y up, −z in the middle) to Blender's.
_PICTURE_TO_WORLD = Matrix(((0, 0, -1), (-1, 0, 0), (0, 1, 0)))
#: The material of a lamp with an extent, which light passes as in Cycles.
CLEAR = "clear lamp"


def matrix_step(matrix: Matrix) -> list[Any]:
    """Returns a transform of Abbe with the rows of a matrix. The identity has no steps."""
    if matrix == Matrix.Identity(4):
        return []
    return [{"matrix": [list(row) for row in matrix.to_4x4()]}]


def rigid(matrix: Matrix) -> Matrix:
    """Returns a matrix without its scale."""
    place, turn, _ = matrix.decompose()
    return Matrix.LocRotScale(place, turn, None)


class Lights:
    """Converts the lights of a scene to lights and luminous objects of Abbe."""

    def __init__(self, folder: Folder, report: Report, efficacy: float) -> None:
        self.folder, self.report, self.efficacy = folder, report, efficacy

    def convert(
        self, thing: Any, placed: Matrix, motion: list[tuple[float, Matrix]]
    ) -> tuple[str, dict[str, Any]] | None:
        """Returns ("lights", light) or ("objects", object), or None if the light emits nothing."""
        light, owner = thing.data, f"Light '{thing.name}'"
        if light.type == "AREA" and getattr(getattr(light, "cycles", None), "is_portal", False):
            return None
        self._name_missing(thing, light, owner)
        colour, strength, temperature = self._colour(light, owner)
        chosen = spectrum(light.abbe, self.folder, owner)
        if chosen is None:
            is_planck = temperature is not None and units.is_grey(colour)
            chosen = {"blackbody": {"temperature": temperature}} if is_planck else None
        if chosen is None:
            rgb = colour if temperature is None else [a * b for a, b in zip(colour, light.temperature_color)]
            chosen = units.light_spectrum(rgb)
        if temperature is not None:
            colour = [a * b for a, b in zip(colour, light.temperature_color)]
        amount = strength * units.luminance(colour) * self.efficacy
        if light.abbe.quantity == "PHOTOMETRIC":
            amount = light.abbe.amount
        if amount <= 0.0:
            return None
        form = {"spectrum": chosen, "group": thing.name}
        if light.type == "AREA":
            return self._area(thing, light, placed, motion, form, amount)
        radius = light.shadow_soft_size * max(abs(s) for s in placed.to_scale()) if light.type != "SUN" else 0.0
        if light.type == "POINT" and radius > 0.0:
            form["luminous_flux"] = amount
            shape = {"sphere": {"radius": radius}}
            return "objects", luminous(thing.name, shape, rigid(placed), [(t, rigid(m)) for t, m in motion], form)
        if light.type == "SPOT" and radius > 0.0:
            axial = amount / (4.0 * math.pi)
            shape = ies.spot(axial, light.spot_size, light.spot_blend)
            return self._opening(thing, placed, motion, form, 0.5 * light.spot_size, shape, (2 * radius,) * 2, True)
        at, toward = placed.to_translation(), placed.to_3x3() @ Matrix.Identity(3).col[2] * -1.0
        if motion:
            at, toward = at * 0.0, Matrix.Identity(3).col[2] * -1.0
            form["motion"] = [{"time": t, "transform": matrix_step(rigid(m))} for t, m in motion]
        if light.type == "SUN":
            form.update(toward=list(toward), illuminance=amount, angular_diameter=math.degrees(light.angle))
            return "lights", {"directional": form}
        form["at"] = list(at)
        if light.type == "POINT":
            return "lights", {"point": {**form, "luminous_flux": amount}}
        half_angle, penumbra = units.spot_angles(light.spot_size, light.spot_blend)
        form.update(to=list(at + toward), half_angle=half_angle, penumbra=penumbra, falloff="smooth")
        if light.abbe.quantity == "PHOTOMETRIC":
            return "lights", {"spot": {**form, "luminous_flux": amount}}
        return "lights", {"spot": {**form, "luminous_intensity": amount / (4.0 * math.pi)}}

    def _area(self, thing: Any, light: Any, placed: Matrix, motion: Any, form: Any, amount: float) -> Any:
        height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
        if light.spread < math.pi - 1e-3:
            size, is_round = (light.size, height), light.shape not in {"SQUARE", "RECTANGLE"}
            form["luminous_flux"] = amount
            shape = ies.spread(amount, light.spread)
            return self._opening(thing, placed, motion, form, 0.5 * light.spread, shape, size, is_round)
        turn = _FACING_DOWN
        if light.shape in {"SQUARE", "RECTANGLE"}:
            shape = {"rectangle": {"width": light.size, "height": height}}
        else:
            shape = {"disk": {"radius": 0.5 * light.size}}
            turn = turn @ Matrix.Diagonal((1.0, 1.0, height / light.size, 1.0))
        form["luminous_flux"] = amount
        return "objects", luminous(thing.name, shape, placed @ turn, [(t, m @ turn) for t, m in motion], form)

    def _opening(
        self, thing: Any, placed: Matrix, motion: Any, form: Any, edge: float, shape: Any, size: Any, is_round: bool
    ) -> tuple[str, dict[str, Any]]:
        """Returns a flat light with an intensity that depends on the angle to its axis."""
        path = self.folder.free_name(thing.name, ".ies")
        ies.write(self.folder.path / path, edge, shape, size, is_round)
        self.report.missing(f"Light '{thing.name}'", "the image of the light in mirrors")
        form.update(at=[0.0, 0.0, 0.0], toward=[0.0, 0.0, -1.0], c0=[1.0, 0.0, 0.0], path=path, area=True)
        if thing.data.abbe.quantity == "PHOTOMETRIC":
            form["luminous_flux"] = thing.data.abbe.amount
        # The scale of a spot is part of its radius.
        scaled = rigid if thing.data.type == "SPOT" else Matrix.copy
        form["transform"] = matrix_step(scaled(placed)) if not motion else []
        if motion:
            form["motion"] = [{"time": t, "transform": matrix_step(scaled(m))} for t, m in motion]
        return "lights", {"ies": form}

    def _name_missing(self, thing: Any, light: Any, owner: str) -> None:
        neutral = {"diffuse_factor": 1.0, "specular_factor": 1.0, "transmission_factor": 1.0, "volume_factor": 1.0}
        neutral.update(use_shadow=True, use_square=False)
        for name, value in neutral.items():
            if getattr(light, name, value) != value:
                self.report.missing(owner, f"'{light.bl_rna.properties[name].name}'")
        if not thing.visible_camera and (
            light.type == "AREA" or (light.type == "POINT" and light.shadow_soft_size > 0)
        ):
            self.report.missing(owner, "invisibility to the camera")
        kinds = ("diffuse", "glossy", "transmission", "volume_scatter", "shadow")
        hidden = [kind for kind in kinds if not getattr(thing, f"visible_{kind}")]
        if hidden:
            self.report.missing(owner, f"invisibility to {', '.join(hidden)} rays")
        if getattr(thing, "light_linking", None) is not None and thing.light_linking.receiver_collection is not None:
            self.report.missing(owner, "light linking")

    def _colour(self, light: Any, owner: str) -> tuple[list[float], float, float | None]:
        """Returns the colour, Blender's strength and the temperature in K of a light."""
        colour, strength = list(light.color), light.energy * 2.0 ** getattr(light, "exposure", 0.0)
        tree = light.node_tree if light.use_nodes else None
        node = surface_node(tree, "Surface") if tree is not None else None
        if node is not None and node.type == "EMISSION":
            read = SocketReader(owner, self.folder, self.report)
            colour = [a * b for a, b in zip(colour, read.value(node, "Color"))]
            strength *= read.value(node, "Strength")
        elif tree is not None:
            self.report.missing(owner, "the node tree without an Emission at its output")
        if light.type != "SUN" and not getattr(light, "normalize", True):
            self.report.missing(owner, "'Normalize' that is switched off")
        temperature = light.temperature if getattr(light, "use_temperature", False) else None
        return colour, strength, temperature


def luminous(name: str, shape: Any, placed: Matrix, motion: list[tuple[float, Matrix]], form: Any) -> dict[str, Any]:
    """Returns an object that shines, and that light passes."""
    thing = {"name": name, "shape": shape, "material": CLEAR, "emission": form}
    if motion:
        thing["motion"] = [{"time": t, "transform": matrix_step(m)} for t, m in motion]
    else:
        thing["transform"] = matrix_step(placed)
    return thing


def world_light(world: Any, folder: Folder, report: Report, efficacy: float) -> dict[str, Any] | None:
    """Returns the environment of a world, or None if it is black."""
    if world is None:
        return None
    owner = f"World '{world.name}'"
    read = SocketReader(owner, folder, report)
    visibility = getattr(world, "cycles_visibility", {})
    hidden = [kind for kind in ("camera", "diffuse", "glossy", "transmission") if not visibility.get(kind, 1)]
    if hidden:
        report.missing(owner, f"invisibility to {', '.join(hidden)} rays")
    colour, strength, picture = list(world.color), 1.0, None
    rotation = Matrix.Identity(3)
    tree = world.node_tree if world.use_nodes else None
    if tree is not None:
        node = surface_node(tree, "Surface")
        if node is None:
            return None
        if node.type != "BACKGROUND":
            report.missing(owner, f"the shader '{node.name}' (black instead)")
            return None
        strength = read.value(node, "Strength")
        feeding = source(node.inputs["Color"])
        if feeding is not None and feeding.type == "TEX_ENVIRONMENT" and feeding.image is not None:
            picture = folder.picture(feeding.image, owner)
            colour = [1.0, 0.0, 1.0] if picture is None else [1.0] * 3
            if feeding.projection != "EQUIRECTANGULAR":
                report.missing(owner, f"the projection {feeding.projection}")
            rotation = _rotation(feeding, read)
        else:
            colour = read.value(node, "Color")[:3]
    chosen = spectrum(world.abbe, folder, owner)
    luminance = strength * efficacy * units.luminance(colour)
    if luminance <= 0.0:
        return None
    if picture is None:
        return {"environment": {"spectrum": units.light_spectrum(colour) if chosen is None else chosen,
                                "luminance": luminance, "group": "world"}}  # fmt: skip
    if chosen is not None:
        report.missing(owner, "the spectrum of the panel for a picture")
    if picture["encoding"] == "srgb" and picture["path"].endswith((".exr", ".hdr")):
        report.missing(owner, "the encoding sRGB of a picture with linear values")
    turn = (rotation @ _PICTURE_TO_WORLD).to_4x4()
    form = {"image": picture["path"], "luminance": luminance, "transform": matrix_step(turn), "group": "world"}
    return {"environment": form}


def _rotation(node: Any, read: SocketReader) -> Matrix:
    """Returns the rotation of the picture of a world by a Mapping node."""
    mapping = source(node.inputs["Vector"])
    if mapping is None or mapping.type == "TEX_COORD":
        return Matrix.Identity(3)
    if mapping.type != "MAPPING" or mapping.vector_type not in {"POINT", "VECTOR", "NORMAL", "TEXTURE"}:
        read.missing(f"the node '{mapping.name}' in the coordinates of the picture")
        return Matrix.Identity(3)
    if max(abs(part - 1.0) for part in mapping.inputs["Scale"].default_value) > 1e-6:
        read.missing(f"the scale of '{mapping.name}'")
    if "Location" in mapping.inputs and any(mapping.inputs["Location"].default_value):
        read.missing(f"the location of '{mapping.name}'")
    turn = Euler(mapping.inputs["Rotation"].default_value).to_matrix()
    # A point of the picture is looked up at the turned direction, so the picture turns back.
    return turn if mapping.vector_type == "TEXTURE" else turn.inverted()
