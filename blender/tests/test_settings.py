# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings survive a Blender file and reach the scene of Abbe, which the program accepts."""

from __future__ import annotations

import math
import subprocess
from typing import Any

import bpy
import pytest
from conftest import PROGRAM


def set_all(target: Any, **values: Any) -> None:
    """Sets several settings of an owner."""
    for name, value in values.items():
        setattr(target, name, value)


def own(kind: str, name: str) -> Any:
    """Returns the settings of Abbe of a data block."""
    return getattr(bpy.data, kind)[name].abbe


def shader(name: str) -> Any:
    """Returns the Principled BSDF of a material."""
    return bpy.data.materials[name].node_tree.nodes["Principled BSDF"].inputs


def lamp(content: Any, name: str) -> Any:
    """Returns the light or the emission of a light of Blender."""
    emissions = [thing["emission"] for thing in content["objects"] if thing["name"] == name and "emission" in thing]
    lights = [form for light in content["lights"] for form in light.values() if form["group"] == name]
    return (emissions + lights)[0]


def spectrum_file(folder: Any) -> str:
    path = folder / "lamp.csv"
    path.write_text("nm,value\n400,0\n550,1\n700,0\n")
    return str(path)


#: For each setting: how a user makes it, where it is in the scene of Abbe, and its value there.
SETTINGS: dict[str, tuple[Any, Any, Any]] = {
    "glass of the catalogue": (
        lambda it: set_all(own("materials", "Ball"), surface="GLASS", glass="N-BK7", roughness=0.25, priority=3),
        lambda c: c["materials"]["Ball"],
        {"dielectric": {"ior": "N-BK7", "roughness": 0.25, "priority": 3}},
    ),
    "glass with an index": (
        lambda it: set_all(own("materials", "Ball"), surface="GLASS", glass="1.7"),
        lambda c: c["materials"]["Ball"]["dielectric"]["ior"],
        1.7,
    ),
    "colour of glass": (
        lambda it: set_all(
            own("materials", "Ball"), surface="GLASS", absorption_distance=0.5, absorption_colour=(1, 1, math.exp(-1))
        ),
        lambda c: c["materials"]["Ball"]["dielectric"]["absorption"]["mix"][0],
        {"spectrum": {"rgb": [0, 0, 1]}, "weight": pytest.approx(2.0, rel=1e-6)},
    ),
    "metal": (
        lambda it: set_all(own("materials", "Ball"), surface="METAL", metal="copper", roughness=0.5),
        lambda c: c["materials"]["Ball"],
        {"conductor": {"metal": "copper", "roughness": 0.5}},
    ),
    "thin film": (
        lambda it: set_all(
            own("materials", "Ball"),
            surface="METAL",
            metal="titanium",
            use_film=True,
            film="rutile TiO2",
            film_thickness=60,
        ),
        lambda c: c["materials"]["Ball"]["conductor"]["coating"],
        {"layers": [{"ior": "rutile TiO2", "thickness_nm": 60.0}]},
    ),
    "film with n and k": (
        lambda it: set_all(own("materials", "Ball"), surface="GLASS", use_film=True, film="2.1 3.5", film_thickness=20),
        lambda c: c["materials"]["Ball"]["dielectric"]["coating"]["layers"][0]["ior"],
        {"n": 2.1, "k": 3.5},
    ),
    "thin film of the nodes": (
        lambda it: [
            setattr(shader("Ball")[name], "default_value", value)
            for name, value in {"Transmission Weight": 1, "Thin Film Thickness": 300, "Thin Film IOR": 1.25}.items()
        ],
        lambda c: c["materials"]["Ball"]["dielectric"]["coating"],
        {"layers": [{"ior": 1.25, "thickness_nm": 300.0}]},
    ),
    "reflectance of the library": (
        lambda it: set_all(own("materials", "Ball"), spectrum_source="LIBRARY", spectrum="colorchecker/blue"),
        lambda c: c["materials"]["Ball"]["glossy"]["reflectance"],
        "colorchecker/blue",
    ),
    "medium inside": (
        lambda it: set_all(
            own("materials", "Ball"),
            surface="BOUNDARY",
            use_medium=True,
            medium_scattering=2.5,
            medium_absorption=0.5,
            medium_anisotropy=0.25,
        ),  # fmt: skip
        lambda c: [c["materials"]["Ball"], c["media"]["Ball"]],
        [
            {"boundary": {"medium": "Ball"}},
            {"homogeneous": {"absorption": 0.5, "scattering": 2.5, "phase": {"henyey_greenstein": {"g": 0.25}}}},
        ],
    ),
    "emission of the nodes": (
        lambda it: [
            setattr(shader("Ball")["Emission Strength"], "default_value", 2),
            setattr(shader("Ball")["Emission Color"], "default_value", (0, 1, 0, 1)),
        ],
        lambda c: lamp(c, "Sphere"),
        {"spectrum": {"rgb": [0, 1, 0]}, "luminance": pytest.approx(2 * 683 * 0.7152), "group": "Sphere"},
    ),
    "spectrum of a light from the library": (
        lambda it: set_all(own("lights", "Spot"), spectrum_source="LIBRARY", spectrum="LED-B3"),
        lambda c: [lamp(c, "Spot")["spectrum"], lamp(c, "Spot")["luminous_intensity"]],
        ["LED-B3", pytest.approx(100 * 683 / (4 * math.pi))],
    ),
    "spectrum of a light from a file": (
        lambda it: set_all(own("lights", "Spot"), spectrum_source="FILE", spectrum_file=spectrum_file(it.folder)),
        lambda c: lamp(c, "Spot")["spectrum"],
        {"file": "lamp.csv"},
    ),
    "lumens of a light": (
        lambda it: set_all(own("lights", "Spot"), quantity="PHOTOMETRIC", amount=800),
        lambda c: lamp(c, "Spot")["luminous_flux"],
        800.0,
    ),
    "temperature of a light": (
        lambda it: set_all(bpy.data.lights["Spot"], use_temperature=True, temperature=3000),
        lambda c: lamp(c, "Spot")["spectrum"],
        {"blackbody": {"temperature": 3000.0}},
    ),
    "cone of a spot": (
        lambda it: set_all(bpy.data.lights["Spot"], spot_size=math.radians(60), spot_blend=1.0),
        lambda c: [lamp(c, "Spot")["half_angle"], lamp(c, "Spot")["penumbra"]],
        [pytest.approx(30, abs=1e-4), pytest.approx(30, abs=1e-4)],
    ),
    "lux of a sun": (
        lambda it: set_all(own("lights", "Sun"), quantity="PHOTOMETRIC", amount=50_000),
        lambda c: lamp(c, "Sun")["illuminance"],
        50_000.0,
    ),
    "size of a sun": (
        lambda it: set_all(bpy.data.lights["Sun"], angle=math.radians(0.53)),
        lambda c: lamp(c, "Sun")["angular_diameter"],
        pytest.approx(0.53, rel=1e-6),
    ),
    "spectrum of a world": (
        lambda it: set_all(own("worlds", "World"), spectrum_source="LIBRARY", spectrum="D50"),
        lambda c: lamp(c, "world"),
        {"spectrum": "D50", "luminance": pytest.approx(683.0, rel=1e-6), "group": "world"},
    ),
    "fog": (
        lambda it: set_all(own("worlds", "World"), use_medium=True, medium_scattering=0.125, medium_anisotropy=0.5),
        lambda c: [c["atmosphere"], c["media"]["fog"]],
        ["fog", {"homogeneous": {"absorption": 0.0, "scattering": 0.125, "phase": {"henyey_greenstein": {"g": 0.5}}}}],
    ),
    "lens prescription": (
        lambda it: (
            set_all(own("cameras", "Camera"), lens_source="LIBRARY", lens="Tessar f/4.5", ghosts=True),
            set_all(bpy.data.cameras["Camera"].dof, use_dof=True, focus_distance=4, aperture_fstop=8),
        ),
        lambda c: c["camera"]["lens"]["system"],
        {
            "prescription": "Tessar f/4.5",
            "focus_distance": 4.0,
            "f_number": 8.0,
            "sensor_height_mm": 36.0,
            "ghosts": True,
            "diffraction": False,
        },
    ),
    "depth of field": (
        lambda it: set_all(
            bpy.data.cameras["Camera"].dof, use_dof=True, focus_distance=4, aperture_fstop=2, aperture_blades=6
        ),
        lambda c: [c["camera"]["lens"]["thin"][key] for key in ("defocus_angle", "focus_distance", "blades")],
        [pytest.approx(math.degrees(2 * math.atan(0.0125 / 4)), rel=1e-5), 4.0, 6],
    ),
    "orthographic camera": (
        lambda it: (
            set_all(bpy.data.cameras["Camera"], type="ORTHO", ortho_scale=4),
            set_all(it.scene.render, resolution_y=32),
        ),
        lambda c: c["camera"]["lens"],
        {"orthographic": {"height": 2.0}},
    ),
    "exposure and view transform": (
        lambda it: set_all(it.scene.view_settings, exposure=1.5, view_transform="AgX"),
        lambda c: [c["film"]["exposure"]["ev"], c["film"]["tone"]],
        [pytest.approx(1.5 - math.log2(683)), "agx"],
    ),
    "meter at an empty": (
        lambda it: set_all(bpy.data.objects["Empty"].abbe, meter="melanopic_edi"),
        lambda c: c["meters"],
        [{"name": "Empty", "quantity": "melanopic_edi", "points": [[0, 0, 2]], "normal": [0, 0, 1]}],
    ),
    "meter on a mesh": (
        lambda it: set_all(bpy.data.objects["Floor"].abbe, meter="luminous_flux"),
        lambda c: c["meters"],
        [{"name": "Floor", "surface": "Floor", "quantity": "luminous_flux"}],
    ),
    "sampling": (
        lambda it: set_all(it.scene.abbe, passes=12, photons=5000, seed=7, max_depth=6, spectral_bands=16),
        lambda c: [c["render"], c["film"]["spectral_bands"]],
        [{"passes": 12, "photons": 5000, "seed": 7, "max_depth": 6}, 16],
    ),
}


def fill(studio: Any) -> None:
    """Adds one of each thing that has settings."""
    studio.camera()
    studio.floor()
    studio.ball(studio.material("Ball"))
    studio.light("SPOT", 100, shadow_soft_size=0)
    studio.light("SUN", 1)
    studio.world()
    studio.add("Empty", None, (0, 0, 2))


@pytest.mark.parametrize("name", SETTINGS)
def test_a_setting_survives_a_file_and_reaches_abbe(studio: Any, name: str) -> None:
    make, find, expected = SETTINGS[name]
    if name == "temperature of a light" and bpy.app.version < (4, 5, 0):
        pytest.skip("this version of Blender does not have the setting")
    fill(studio)
    assert not _found(find, studio.export(), expected), "the setting has no effect"
    make(studio)
    path = str(studio.folder / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    content = studio.export()
    assert find(content) == expected
    done = subprocess.run([PROGRAM, "check", str(studio.exported.scene)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def _found(find: Any, content: Any, expected: Any) -> bool:
    try:
        return bool(find(content) == expected)
    except (KeyError, IndexError):
        return False
