# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the materials of Blender to those of Abbe."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from . import media, units
from .files import Folder
from .nodes import SocketReader, source, surface_node
from .report import Report
from .spectra import film_index, index, spectrum

#: A surface has no coat if its roughness is at least this value, as in Abbe's import of glTF.
_MATT = 0.95
#: A part of a mixture is left out if its weight is below this value.
_LEAST = 0.005
_HOLE = {"thin_dielectric": {"ior": 1}}

#: The inputs of the Principled BSDF that Abbe's materials do not have, with their neutral values.
_PRINCIPLED_MISSING = {
    "Diffuse Roughness": 0.0,
    "Subsurface Weight": 0.0,
    "Anisotropic": 0.0,
    "Sheen Weight": 0.0,
}


@dataclass
class Surface:
    """A converted material: its name in the scene, and the light that its objects emit."""

    name: str
    emission: dict[str, Any] | None = None


class Materials:
    """Converts materials, each of them once, and adds them to the materials of the scene."""

    def __init__(self, folder: Folder, report: Report, efficacy: float) -> None:
        self.folder, self.report, self.efficacy = folder, report, efficacy
        self.materials: dict[str, Any] = {}
        self.media: dict[str, Any] = {}
        self._known: dict[str, Surface] = {}

    def convert(self, material: Any, chord: float, owner: str) -> Surface:
        """Converts a material. `chord` is the mean chord (m) of its first object, `owner`."""
        key = material.name_full if material is not None else ""
        if key not in self._known:
            self._known[key] = _Conversion(self, material, chord, owner).surface()
        return self._known[key]

    def add(self, name: str, form: Any) -> str:
        """Adds a material under a new name, and returns the name."""
        number, free = 1, name
        while free in self.materials:
            number += 1
            free = f"{name} {number}"
        self.materials[free] = form
        return free


class _Conversion:
    def __init__(self, scene: Materials, material: Any, chord: float, owner: str) -> None:
        self.scene, self.material, self.chord, self.user = scene, material, chord, owner
        self.name = material.name if material is not None else "no material"
        self.owner = f"Material '{self.name}'"
        self.read = SocketReader(self.owner, scene.folder, scene.report)
        self.emission: dict[str, Any] | None = None
        self.normal_map: dict[str, Any] | None = None

    def surface(self) -> Surface:
        form = self._form()
        if self.normal_map is not None:
            inner = self._part("below the normal map", form)
            form = {"normal_map": {"material": inner, **self.normal_map}}
        return Surface(self.scene.add(self.name, form), self.emission)

    def _form(self) -> Any:
        if self.material is None:
            return {"diffuse": {"reflectance": {"rgb": [0.8] * 3}}}
        own = self.material.abbe
        if own.surface == "GLASS":
            return self._glass({"ior": index(own.glass), "roughness": own.roughness})
        if own.surface == "METAL":
            return {"conductor": {"metal": own.metal, "roughness": own.roughness, **self._coating(True)}}
        if own.surface == "BOUNDARY":
            if self._medium() is None:
                self.scene.report.add(f"{self.owner}: the boundary has no medium inside, so it is invisible")
            return self._clear()
        tree = self.material.node_tree
        if tree is None or not self.material.use_nodes:
            colour = list(self.material.diffuse_color)[:3]
            return self._opaque({"rgb": colour}, 1.5, self.material.roughness)
        displacement, surface = surface_node(tree, "Displacement"), surface_node(tree, "Surface")
        if displacement is not None:
            self.read.missing(f"the node '{displacement.name}' in 'Displacement'")
        if surface is None and self._medium():
            return self._clear()
        return self._node(surface)

    def _node(self, node: Any) -> Any:
        if node is None:
            return "absorber"
        convert = getattr(self, f"_{node.type.lower()}", None)
        if convert is None:
            self.read.missing(f"the shader '{node.name}' (black instead)")
            return "absorber"
        self._normals(node)
        return convert(node)

    def _bsdf_principled(self, node: Any) -> Any:
        value = self.read.value
        for name, neutral in _PRINCIPLED_MISSING.items():
            if name in node.inputs and (source(node.inputs[name]) or node.inputs[name].default_value != neutral):
                self.read.missing(f"'{name}' of '{node.name}'")
        self._emit(value(node, "Emission Color")[:3], value(node, "Emission Strength"), node)
        base, roughness = self.read.reflectance(node, "Base Color"), self.read.number(node, "Roughness")
        ior = max(1.0, value(node, "IOR"))
        metallic, transmission = self.read.number(node, "Metallic"), self.read.number(node, "Transmission Weight")
        for name in ("Specular Tint", "Coat Tint"):
            used = name == "Specular Tint" or value(node, "Coat Weight") > _LEAST
            if used and max(abs(part - 1.0) for part in value(node, name)[:3]) > 1e-3:
                self.read.missing(f"'{name}' of '{node.name}'")
        parts = []
        rest = _complement(metallic)
        if not _is(metallic, 0.0):
            parts.append((metallic, "metal", {"conductor": {"reflectance": base, "roughness": roughness}}))
        if not _is(rest, 0.0):
            film = self._principled_film(node, transmission)
            glass_weight = _product(rest, transmission, self.read)
            if not _is(glass_weight, 0.0):
                tint = self._tint(node)
                parts.append((glass_weight, "glass", self._glass({"ior": ior, "roughness": roughness, **tint, **film})))
            opaque_weight = _product(rest, _complement(transmission), self.read)
            if not _is(opaque_weight, 0.0):
                specular = units.scaled_ior(ior, value(node, "Specular IOR Level"))
                opaque = self._opaque(base, specular, roughness)
                coat = min(1.0, max(0.0, value(node, "Coat Weight")))
                if coat > _LEAST:
                    coated = self._opaque(base, max(1.0, value(node, "Coat IOR")), value(node, "Coat Roughness"))
                    opaque = self._mix([(coat, "coat", coated), (1.0 - coat, "base", opaque)])
                parts.append((opaque_weight, "opaque", opaque))
        return self._with_holes(self._mix(parts), node)

    def _bsdf_diffuse(self, node: Any) -> Any:
        if self.read.value(node, "Roughness") > 0.0:
            self.read.missing(f"'Roughness' of '{node.name}'")
        return {"diffuse": {"reflectance": self._base(self.read.reflectance(node, "Color"))}}

    def _bsdf_glossy(self, node: Any) -> Any:
        if self.read.value(node, "Anisotropy") != 0.0:
            self.read.missing(f"'Anisotropy' of '{node.name}'")
        roughness = self.read.number(node, "Roughness")
        return {"conductor": {"reflectance": self.read.reflectance(node, "Color"), "roughness": roughness}}

    def _bsdf_metallic(self, node: Any) -> Any:
        if self.read.value(node, "Anisotropy") != 0.0:
            self.read.missing(f"'Anisotropy' of '{node.name}'")
        names = "'IOR' and 'Extinction'" if node.fresnel_type == "PHYSICAL_CONDUCTOR" else "'Edge Tint'"
        self.read.missing(f"{names} of '{node.name}' (the panel Abbe has metals with n and k)")
        roughness = self.read.number(node, "Roughness")
        return {"conductor": {"reflectance": self.read.reflectance(node, "Base Color"), "roughness": roughness}}

    def _bsdf_glass(self, node: Any) -> Any:
        ior, roughness = max(1.0, self.read.value(node, "IOR")), self.read.number(node, "Roughness")
        return self._glass({"ior": ior, "roughness": roughness, **self._tint(node, "Color")})

    def _bsdf_translucent(self, node: Any) -> Any:
        return {"translucent": {"reflectance": 0, "transmittance": self.read.reflectance(node, "Color")}}

    def _bsdf_transparent(self, node: Any) -> Any:
        if min(self.read.value(node, "Color")[:3]) < 0.999:
            self.read.missing(f"'Color' of '{node.name}'")
        return self._clear()

    def _holdout(self, node: Any) -> Any:
        self.read.missing(f"the shader '{node.name}' (black instead)")
        return "absorber"

    def _emission(self, node: Any) -> Any:
        self._emit(self.read.value(node, "Color")[:3], self.read.value(node, "Strength"), node)
        return "absorber"

    def _mix_shader(self, node: Any) -> Any:
        first, second = (source(node.inputs[number]) for number in (1, 2))
        if "EMISSION" in {part.type for part in (first, second) if part is not None}:
            self.read.missing(f"the weight of the emission in '{node.name}'")
        weight = self.read.number(node, node.inputs[0].name)
        return self._mix([(_complement(weight), "first", self._node(first)), (weight, "second", self._node(second))])

    def _add_shader(self, node: Any) -> Any:
        shaders = [source(socket) for socket in node.inputs]
        forms = [self._node(shader) for shader in shaders if shader is not None and shader.type != "EMISSION"]
        for shader in shaders:
            if shader is not None and shader.type == "EMISSION":
                self._emission(shader)
        if len(forms) > 1:
            self.read.missing(f"the sum of two surfaces in '{node.name}' (the first one instead)")
        return forms[0] if forms else "absorber"

    def _opaque(self, base: Any, ior: float, roughness: Any) -> Any:
        base = self._base(base)
        if ior <= 1.0 or (isinstance(roughness, float) and roughness >= _MATT):
            return {"diffuse": {"reflectance": base}}
        return {"glossy": {"reflectance": base, "ior": ior, "roughness": roughness}}

    def _base(self, base: Any) -> Any:
        """Returns the spectrum of the panel, or else the colour of the nodes."""
        own = self.material.abbe if self.material is not None else None
        chosen = spectrum(own, self.scene.folder, self.owner) if own is not None else None
        return base if chosen is None else chosen

    def _glass(self, form: dict[str, Any]) -> Any:
        own = self.material.abbe
        form.update(self._coating(False))
        if self._medium():
            form["medium"] = self._medium()
        if own.priority:
            form["priority"] = own.priority
        if own.absorption_distance > 0.0 and own.surface == "GLASS":
            form["absorption"] = units.absorption(list(own.absorption_colour), own.absorption_distance)
        return {"dielectric": form}

    def _tint(self, node: Any, name: str = "Base Color") -> dict[str, Any]:
        """Returns the absorption that gives glass its colour over a chord of the object."""
        if self.read.image(node, name) is not None:
            self.read.missing(f"the picture in '{name}' of the glass '{node.name}'")
            return {}
        colour = self.read.value(node, name)[:3]
        if min(colour) >= 0.999 or self.chord <= 0.0:
            return {}
        self.scene.report.add(
            f"{self.owner}: the colour of the glass becomes absorption, which reaches this colour after "
            f"{self.chord:.3g} m, the mean chord of {self.user}"
        )
        return {"absorption": units.absorption(colour, self.chord)}

    def _principled_film(self, node: Any, transmission: Any) -> dict[str, Any]:
        if "Thin Film Thickness" not in node.inputs or self.material.abbe.use_film:
            return {}
        thickness = self.read.value(node, "Thin Film Thickness")
        if thickness <= 0.0:
            return {}
        if _is(transmission, 0.0):
            self.read.missing("the thin film on an opaque surface")
            return {}
        ior = max(1.0, self.read.value(node, "Thin Film IOR"))
        return {"coating": {"layers": [{"ior": ior, "thickness_nm": thickness}]}}

    def _coating(self, on_metal: bool) -> dict[str, Any]:
        own = self.material.abbe
        if not own.use_film or (not on_metal and own.surface == "METAL"):
            return {}
        return {"coating": {"layers": [{"ior": film_index(own.film), "thickness_nm": own.film_thickness}]}}

    def _medium(self) -> str | None:
        """Returns the name of the medium inside, from the panel or else from the nodes."""
        own, form = self.material.abbe, None
        if own.use_medium:
            form = media.panel_medium(own)
        elif self.material.node_tree is not None:
            form = media.node_medium(self.material.node_tree, self.read)
        if form is not None:
            self.scene.media[self.name] = form
        return self.name if form is not None else None

    def _clear(self) -> Any:
        """Returns a surface that changes no light. It encloses the medium inside, if there is one."""
        inside = self._medium()
        return _HOLE if inside is None else {"boundary": {"medium": inside}}

    def _emit(self, colour: list[float], strength: float, node: Any) -> None:
        """Adds the light of a surface: 1 W/m²/sr becomes the luminance of the efficacy."""
        name = "Emission Color" if "Emission Color" in node.inputs else "Color"
        luminance = strength * self.scene.efficacy
        picture = self.read.image(node, name) if strength > 0.0 else None
        if picture is not None and not picture.get("missing"):
            self.emission = {"spectrum": "D65", "luminance": luminance, "slide": {"image": picture}}
            return
        luminance *= units.luminance(colour)
        if luminance <= 0.0:
            return
        chosen = spectrum(self.material.abbe, self.scene.folder, self.owner, "emission_")
        self.emission = {"spectrum": units.light_spectrum(colour) if chosen is None else chosen, "luminance": luminance}

    def _with_holes(self, form: Any, node: Any) -> Any:
        alpha = self.read.image(node, "Alpha")
        if alpha is not None and not alpha.get("missing"):
            link = node.inputs["Alpha"].links[0]
            channel = "alpha" if link.from_socket.name == "Alpha" else "red"
            cover = {"image": {**alpha, "channel": channel, "encoding": "linear"}}
        else:
            cover = min(1.0, max(0.0, self.read.value(node, "Alpha"))) if alpha is None else 1.0
        return self._mix([(cover, "covered", form), (_complement(cover), "hole", _HOLE)])

    def _normals(self, node: Any) -> None:
        feeding = source(node.inputs["Normal"]) if "Normal" in node.inputs else None
        if feeding is None:
            return
        picture = self.read.image(feeding, "Color") if feeding.type == "NORMAL_MAP" else None
        if picture is None or picture.get("missing") or feeding.space != "TANGENT":
            self.read.missing(f"the node '{feeding.name}' in 'Normal' of '{node.name}'")
            return
        if picture.pop("encoding") != "linear":
            self.scene.report.add(f"{self.owner}: the image of '{feeding.name}' is read as Non-Color")
        self.normal_map = {**picture, "strength": self.read.value(feeding, "Strength")}

    def _mix(self, parts: list[tuple[Any, str, Any]]) -> Any:
        parts = [part for part in parts if not _is(part[0], 0.0)]
        if len(parts) == 1:
            return parts[0][2]
        if not parts:
            return "absorber"
        return {"mix": [{"material": self._part(name, form), "weight": weight} for weight, name, form in parts]}

    def _part(self, name: str, form: Any) -> str:
        return self.scene.add(f"{self.name} ({name})", form)


def _is(weight: Any, value: float) -> bool:
    return not isinstance(weight, dict) and abs(weight - value) < _LEAST


def _complement(weight: Any) -> Any:
    """Returns 1 − a number, or the picture with the opposite range."""
    if not isinstance(weight, dict):
        return 1.0 - weight
    low, high = weight["image"].get("range", [0.0, 1.0])
    return {"image": {**weight["image"], "range": [1.0 - low, 1.0 - high]}}


def _product(first: Any, second: Any, read: SocketReader) -> Any:
    """Returns the product of two weights, of which at most one is a picture."""
    if isinstance(first, dict) and isinstance(second, dict):
        read.missing("the product of two pictures of weights (the first picture instead)")
        return first
    if isinstance(second, dict):
        first, second = second, first
    if not isinstance(first, dict):
        return first * second
    low, high = first["image"].get("range", [0.0, 1.0])
    return {"image": {**first["image"], "range": [low * second, high * second]}}
