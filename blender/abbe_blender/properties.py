# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of Abbe in a Blender file."""

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import preferences, program, units


def _suggestions(command: str, kinds: tuple[str, ...] = ()) -> Any:
    """Returns the search of a text field: the names that `abbe COMMAND --list` prints."""

    def search(_self: Any, _context: Any, _text: str) -> list[tuple[str, str]]:
        try:
            listed = program.names(program.find(preferences.program_path()), command)
        except program.ProgramError:
            return []
        return [(name, about) for name, about in listed if not kinds or about.split(" ", 1)[0] in kinds]

    return search


def _name(label: str, default: str, about: str, command: str, kinds: tuple[str, ...] = ()) -> Any:
    return StringProperty(
        name=label, default=default, description=about, search=_suggestions(command, kinds),
        search_options={"SUGGESTION"},
    )  # fmt: skip


def _sources(what: str) -> Any:
    return EnumProperty(
        name="Spectrum",
        items=[
            ("COLOUR", "Colour of Blender", f"A smooth spectrum with the colour of the {what}"),
            ("LIBRARY", "Library", "A spectrum of Abbe's library"),
            ("FILE", "File", "A CSV file with the columns nm,value, or an IES TM-27 file (.spdx)"),
        ],
    )


def _file() -> Any:
    return StringProperty(name="File", subtype="FILE_PATH", description="The file with the spectrum")


class AbbeSceneSettings(bpy.types.PropertyGroup):
    """The settings of a render."""

    passes: IntProperty(name="Passes", default=64, min=1, description="Stop after this many passes")
    time_limit: FloatProperty(
        name="Time Limit", default=0.0, min=0.0, unit="TIME_ABSOLUTE", description="Stop after this time. 0 is no limit"
    )
    target_error: FloatProperty(
        name="Target Error", default=0.0, min=0.0, max=100.0, subtype="PERCENTAGE",
        description="Stop when the error of a typical pixel falls to this value. 0 is no target",
    )  # fmt: skip
    photons: IntProperty(
        name="Photons", default=0, min=0, description="Photon paths in each pass. At 0, Abbe chooses the number"
    )
    max_depth: IntProperty(
        name="Max Depth", default=0, min=0, description="Largest number of events on a path. 0 is no limit"
    )
    seed: IntProperty(name="Seed", default=0, min=0, description="Seed of all random numbers")
    integrator: EnumProperty(
        name="Integrator",
        items=[
            ("PHOTON", "Photon Mapping", "Progressive photon mapping"),
            ("PATH", "Path Tracer", "The path tracer for reference pictures"),
        ],
    )
    combined: EnumProperty(
        name="Picture",
        items=[
            ("RENDERED", "As Rendered", "The combined pass is the picture as it was rendered"),
            ("DENOISED", "Denoised", "The combined pass is the denoised picture"),
        ],
    )
    spectral_bands: IntProperty(
        name="Spectral Bands", default=0, min=0, max=1024,
        description="Bands of the spectrum that the EXR file on disk holds for every pixel",
    )  # fmt: skip
    efficacy: FloatProperty(
        name="Lumens per Watt", default=units.LUMENS_PER_WATT, min=1e-3,
        description="Luminous efficacy of a watt of Blender. It scales luminances, but not Blender's picture",
    )  # fmt: skip
    folder: StringProperty(
        name="Folder", default="//abbe", subtype="DIR_PATH",
        description="Folder of the exported scene and of the EXR file. An unsaved file uses a temporary folder",
    )  # fmt: skip


class AbbeViewLayerSettings(bpy.types.PropertyGroup):
    """The passes that only Abbe has."""

    use_pass_noise: BoolProperty(name="Noise", description="Standard error of the luminance; −1 is unknown")
    use_pass_bias: BoolProperty(name="Bias", description="Estimated bias of the luminance; −1 is unknown")
    use_pass_denoised: BoolProperty(name="Denoised", description="The denoised picture")
    use_pass_albedo: BoolProperty(name="Albedo", description="Reflected or transmitted fraction of the first surface")
    use_pass_paths: BoolProperty(
        name="Path Classes", description="Emission, direct, caustic, indirect and volume light"
    )
    use_layer_lights: BoolProperty(name="Light Groups on Disk", description="A layer of the EXR file for each light")


class AbbeMaterialSettings(bpy.types.PropertyGroup):
    """What a material is, beyond its nodes."""

    surface: EnumProperty(
        name="Surface",
        items=[
            ("NODES", "Nodes", "The nodes of the material"),
            ("GLASS", "Glass", "A glass, crystal, polymer or liquid of Abbe's catalogue"),
            ("METAL", "Metal", "A metal of Abbe's catalogue"),
            ("BOUNDARY", "Boundary of a Medium", "No surface: only the medium inside is visible"),
        ],
    )
    glass: _name("Glass", "N-BK7", "Name of the catalogue, or an index of refraction", "glass")
    metal: _name("Metal", "gold", "Name of the metal", "metal")
    roughness: FloatProperty(name="Roughness", default=0.0, min=0.0, max=1.0, description="0 is polished")
    priority: IntProperty(
        name="Priority", default=0, description="Where glasses overlap, the highest priority fills the space"
    )
    absorption_colour: FloatVectorProperty(
        name="Colour", subtype="COLOR", size=3, default=(1.0, 1.0, 1.0), min=0.0, max=1.0,
        description="Colour of white light after the distance",
    )  # fmt: skip
    absorption_distance: FloatProperty(
        name="After", default=0.0, min=0.0, unit="LENGTH", description="Distance of the colour. At 0, glass is clear"
    )
    spectrum_source: _sources("base")
    spectrum: _name("Name", "", "Name of a reflectance of the library", "spectrum", ("reflectance",))
    spectrum_file: _file()
    emission_spectrum_source: _sources("emission")
    emission_spectrum: _name("Name", "D65", "Name of a light of the library", "spectrum", ("light",))
    emission_spectrum_file: _file()
    use_film: BoolProperty(name="Thin Film", description="A film on glass or metal, in which light interferes")
    film: _name("Film", "MgF2", "Name of the catalogue, an index of refraction, or n and k such as '2.1 3.4'", "glass")
    film_thickness: FloatProperty(name="Thickness", default=100.0, min=0.0, max=1e6, description="Thickness in nm")
    use_medium: BoolProperty(name="Medium Inside", description="The body is filled with a medium")
    medium_scattering: FloatProperty(name="Scattering", default=1.0, min=0.0, description="Coefficient in 1/m")
    medium_absorption: FloatProperty(name="Absorption", default=0.0, min=0.0, description="Coefficient in 1/m")
    medium_anisotropy: FloatProperty(name="Anisotropy", default=0.0, min=-0.99, max=0.99, description="Mean cosine")


class AbbeLightSettings(bpy.types.PropertyGroup):
    """The spectrum and the strength of a light."""

    spectrum_source: _sources("light")
    spectrum: _name("Name", "D65", "Name of a light of the library", "spectrum", ("light",))
    spectrum_file: _file()
    quantity: EnumProperty(
        name="Strength",
        items=[
            ("BLENDER", "Blender's Power", "The power or strength of the light, times the lumens per watt"),
            (
                "PHOTOMETRIC",
                "Photometric",
                "Lumens, or the lux of a sun. The power and the colour of Blender do not count",
            ),
        ],
    )
    amount: FloatProperty(
        name="Amount", default=800.0, min=0.0, description="Luminous flux in lm, or illuminance in lx"
    )


class AbbeWorldSettings(bpy.types.PropertyGroup):
    """The spectrum of a world, and its fog."""

    spectrum_source: _sources("world")
    spectrum: _name("Name", "D65", "Name of a light of the library", "spectrum", ("light",))
    spectrum_file: _file()
    use_medium: BoolProperty(name="Fog", description="A medium outside of all objects")
    medium_scattering: FloatProperty(
        name="Scattering", default=0.02, min=0.0, precision=4, description="Coefficient in 1/m"
    )
    medium_absorption: FloatProperty(
        name="Absorption", default=0.0, min=0.0, precision=4, description="Coefficient in 1/m"
    )
    medium_anisotropy: FloatProperty(name="Anisotropy", default=0.0, min=-0.99, max=0.99, description="Mean cosine")


class AbbeCameraSettings(bpy.types.PropertyGroup):
    """A lens of real glass."""

    lens_source: EnumProperty(
        name="Lens",
        items=[
            ("BLENDER", "Ideal Lens", "The focal length, and the depth of field, of the camera"),
            ("LIBRARY", "Library", "A prescription of Abbe's library"),
            ("FILE", "File", "A prescription in a file (.json, .zmx, .seq, .len or .txt)"),
        ],
    )
    lens: _name("Name", "double Gauss f/2 f100", "Name of the prescription", "lens")
    lens_file: StringProperty(name="File", subtype="FILE_PATH", description="The file with the prescription")
    ghosts: BoolProperty(name="Ghosts", description="Light that two surfaces of the lens reflect reaches the sensor")
    diffraction: BoolProperty(name="Diffraction", description="Light is diffracted at the aperture stop")


METERS = [
    ("NONE", "None", "No meter"),
    ("illuminance", "Illuminance", "lx"),
    ("irradiance", "Irradiance", "W/m² from 360 to 830 nm"),
    ("spectral_irradiance", "Spectral Irradiance", "W/m²/nm in bands of 5 nm"),
    ("ppfd", "PPFD", "µmol/m²/s from 400 to 700 nm"),
    ("melanopic_edi", "Melanopic EDI", "lx of daylight"),
    ("colour_temperature", "Colour Temperature", "K"),
    ("colour_rendering", "Colour Rendering Index", "CIE 13.3"),
    ("luminous_flux", "Luminous Flux", "lm on both sides of a mesh"),
    ("ugr", "Glare (UGR)", "along the z axis of an empty"),
]


class AbbeObjectSettings(bpy.types.PropertyGroup):
    """A meter at an empty, or on the surface of a mesh."""

    meter: EnumProperty(name="Meter", items=METERS)


OWNERS = {
    AbbeSceneSettings: bpy.types.Scene,
    AbbeViewLayerSettings: bpy.types.ViewLayer,
    AbbeMaterialSettings: bpy.types.Material,
    AbbeLightSettings: bpy.types.Light,
    AbbeWorldSettings: bpy.types.World,
    AbbeCameraSettings: bpy.types.Camera,
    AbbeObjectSettings: bpy.types.Object,
}


def register() -> None:
    """Registers the settings as the property `abbe` of their owners."""
    for settings, owner in OWNERS.items():
        bpy.utils.register_class(settings)
        owner.abbe = PointerProperty(type=settings)


def unregister() -> None:
    """Removes the settings."""
    for settings, owner in OWNERS.items():
        del owner.abbe
        bpy.utils.unregister_class(settings)
