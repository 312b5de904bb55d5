# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares pictures of Abbe with those of Cycles, which shares no code with Abbe."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest


def blocks(picture: Any) -> Any:
    """Returns the means of 8 × 8 pixels."""
    return picture.reshape(8, 8, 8, 8, 3).mean(axis=(1, 3))


def compare(studio: Any, mean: float = 0.01, block: float = 0.03) -> None:
    """Requires equal means of both pictures, and equal blocks relative to the largest one."""
    abbe, cycles = studio.render("ABBE"), studio.render("CYCLES")
    ratio = abbe.mean(axis=(0, 1)) / cycles.mean(axis=(0, 1))
    difference = np.abs(blocks(abbe) - blocks(cycles)) / blocks(cycles).max()
    print(f"ratios {ratio}, largest difference of a block {difference.max():.4f}")
    assert cycles.mean() > 0.01
    assert np.abs(ratio - 1.0).max() < mean
    assert difference.max() < block


LIGHTS = {
    "point": ("POINT", 300, {"shadow_soft_size": 0}),
    "point of a colour": ("POINT", 300, {"shadow_soft_size": 0, "color": (1, 0.5, 0.2)}),
    "point with an exposure": ("POINT", 100, {"shadow_soft_size": 0, "exposure": 1.5}),
    "ball": ("POINT", 300, {"shadow_soft_size": 0.4, "use_soft_falloff": False}),
    "sun": ("SUN", 2, {"angle": 0}),
    "wide sun": ("SUN", 2, {"angle": 0.3}),
    "spot": ("SPOT", 500, {"shadow_soft_size": 0, "spot_size": 1.2, "spot_blend": 0.4}),
    "wide spot": ("SPOT", 500, {"shadow_soft_size": 0.3, "spot_size": 1.2, "spot_blend": 0.4}),
    "sharp spot": ("SPOT", 500, {"shadow_soft_size": 0.1, "spot_size": 0.9, "spot_blend": 0}),
    "square": ("AREA", 200, {"size": 1}),
    "rectangle": ("AREA", 200, {"shape": "RECTANGLE", "size": 2, "size_y": 0.5}),
    "spread": ("AREA", 200, {"shape": "RECTANGLE", "size": 2, "size_y": 0.5, "spread": 1.0}),
    "disk": ("AREA", 200, {"shape": "DISK", "size": 1.5}),
    "ellipse": ("AREA", 200, {"shape": "ELLIPSE", "size": 2, "size_y": 0.7}),
    "ellipse with a spread": ("AREA", 200, {"shape": "ELLIPSE", "size": 2, "size_y": 0.7, "spread": 2.0}),
}


@pytest.mark.parametrize("name", LIGHTS)
def test_lights_are_as_bright_as_in_cycles(studio: Any, name: str) -> None:
    kind, energy, settings = LIGHTS[name]
    if not all(hasattr(bpy.data.lights.new("probe", kind), key) for key in settings):
        pytest.skip("this version of Blender does not have the setting")
    studio.camera()
    studio.floor()
    studio.ball(studio.material("Grey", "ShaderNodeBsdfDiffuse", Color=(0.3, 0.3, 0.3, 1)))
    light = studio.light(kind, energy, (1, -0.5, 3), **settings)
    light.rotation_euler = (0.2, 0.25, 0.4)
    light.scale = (1.5, 1.0, 1.0) if kind == "AREA" else (1, 1, 1)
    # Cycles turns the disk of a wide spot to the shaded point.
    compare(studio, 0.02 if name == "wide spot" else 0.01)


def test_a_world_is_as_bright_as_in_cycles(studio: Any) -> None:
    studio.camera()
    studio.floor()
    studio.ball(studio.material("Grey", "ShaderNodeBsdfDiffuse", Color=(0.3, 0.6, 0.5, 1)))
    studio.world((0.4, 0.6, 1.0), 1.3)
    compare(studio)


@pytest.mark.parametrize("turn", [(0, 0, 0), (0, 0, 1.0), (0.6, 0, 0), (0.5, 0.3, 1.2)])
def test_a_picture_of_a_world_has_the_directions_of_cycles(studio: Any, turn: tuple[float, ...]) -> None:
    camera = studio.camera((0, 0, 1), (1.4, 0.1, 0.3))
    camera.data.lens = 16
    node = studio.world()
    image = bpy.data.images.new("sky", 64, 32, float_buffer=True)
    u, v = np.meshgrid(np.linspace(0, 1, 64), np.linspace(0, 1, 32))
    red, blue = 0.5 + 0.5 * np.cos(math.tau * u), 0.5 + 0.5 * np.sin(math.tau * u)
    image.pixels = np.stack([red, v, blue, np.ones_like(u)], -1).astype(np.float32).ravel()
    tree = studio.scene.world.node_tree
    texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    texture.image, mapping.inputs["Rotation"].default_value = image, turn
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    compare(studio)


def test_an_emissive_mesh_is_as_bright_as_in_cycles(studio: Any) -> None:
    studio.camera()
    studio.floor()
    studio.ball(studio.material("Lamp", "ShaderNodeEmission", Color=(1, 0.6, 0.3, 1), Strength=5))
    compare(studio)


@pytest.mark.parametrize("turn", [0.0, 3.0])
def test_a_luminous_sheet_shines_to_both_sides_as_in_cycles(studio: Any, turn: float) -> None:
    studio.camera()
    studio.floor()
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(0, 0.5, 1.2), rotation=(turn + 0.9, 0, 0))
    bpy.context.object.data.materials.append(studio.material("Sheet", "ShaderNodeEmission", Strength=5))
    compare(studio, 0.01, 0.05)
    assert studio.exported.report.lines == []


MATERIALS = {
    "plastic": ({"Base_Color": (0.2, 0.5, 0.8, 1), "Roughness": 0.4}, 0.02),
    "matt": ({"Base_Color": (0.2, 0.5, 0.8, 1), "Specular_IOR_Level": 0.0}, 0.01),
    "metal": ({"Base_Color": (0.9, 0.6, 0.3, 1), "Metallic": 1.0, "Roughness": 0.4}, 0.02),
    "half metal": ({"Base_Color": (0.9, 0.6, 0.3, 1), "Metallic": 0.5, "Roughness": 0.5}, 0.02),
    "coat": ({"Base_Color": (0.6, 0.1, 0.1, 1), "Coat_Weight": 1.0, "Roughness": 0.6}, 0.03),
    "glass": ({"Base_Color": (1, 1, 1, 1), "Transmission_Weight": 1.0, "Roughness": 0.0, "IOR": 1.45}, 0.01),
    # Cycles loses 3 % of the light. The picture of clear glass in a white world is white.
    "rough glass": ({"Base_Color": (1, 1, 1, 1), "Transmission_Weight": 1.0, "Roughness": 0.4, "IOR": 1.45}, 0.04),
    "half glass": ({"Base_Color": (0.7, 0.7, 0.7, 1), "Transmission_Weight": 0.5, "Roughness": 0.3}, 0.03),
    "holes": ({"Base_Color": (0.2, 0.5, 0.8, 1), "Alpha": 0.5}, 0.02),
}


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_reflect_as_much_as_in_cycles(studio: Any, name: str) -> None:
    inputs, tolerance = MATERIALS[name]
    studio.camera((0, -3.2, 1.2), (math.pi / 2 - 0.15, 0, 0))
    studio.ball(studio.material(name, **inputs))
    studio.world()
    studio.scene.cycles.max_bounces = studio.scene.cycles.transmission_bounces = 32
    compare(studio, tolerance, 4 * tolerance)
    if name in {"glass", "rough glass"}:
        assert abs(studio.render("ABBE").mean() - 1.0) < 0.003


#: The Glossy BSDF has the name Anisotropic in Python.
SHADERS = {
    "Anisotropic": ({"Color": (0.8, 0.7, 0.5, 1), "Roughness": 0.5}, 0.02),
    "Glass": ({"Color": (1, 1, 1, 1), "Roughness": 0.0, "IOR": 1.5}, 0.01),
    "Metallic": ({"Base_Color": (0.9, 0.6, 0.3, 1), "Roughness": 0.3}, 0.02),
    "Translucent": ({"Color": (0.6, 0.4, 0.2, 1)}, 0.02),
    "Transparent": ({"Color": (1, 1, 1, 1)}, 0.01),
}


@pytest.mark.parametrize("name", SHADERS)
def test_shaders_look_as_in_cycles(studio: Any, name: str) -> None:
    inputs, tolerance = SHADERS[name]
    if not hasattr(bpy.types, f"ShaderNodeBsdf{name}"):
        pytest.skip("this version of Blender does not have the shader")
    studio.camera()
    studio.floor()
    studio.ball(studio.material(name, f"ShaderNodeBsdf{name}", **inputs))
    if name != "Glass":  # Cycles finds the caustics of a light with much noise.
        studio.light("AREA", 200, (1, -1, 3), size=2)
    studio.world((0.3, 0.3, 0.3))
    studio.scene.abbe.passes = 16
    studio.scene.cycles.max_bounces = studio.scene.cycles.transmission_bounces = 32
    compare(studio, tolerance, 0.05)


@pytest.mark.parametrize("kind", ["ShaderNodeMixShader", "ShaderNodeAddShader"])
def test_two_shaders_look_as_in_cycles(studio: Any, kind: str) -> None:
    studio.camera()
    studio.floor()
    material = studio.material("Both", "ShaderNodeBsdfDiffuse", Color=(0.7, 0.2, 0.1, 1))
    tree = material.node_tree
    both, output = tree.nodes.new(kind), next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    is_mix = kind == "ShaderNodeMixShader"
    other = tree.nodes.new("ShaderNodeBsdfGlossy" if is_mix else "ShaderNodeEmission")
    if is_mix:
        both.inputs[0].default_value = 0.3
    tree.links.new(tree.nodes["Diffuse BSDF"].outputs[0], both.inputs[int(is_mix)])
    tree.links.new(other.outputs[0], both.inputs[int(is_mix) + 1])
    tree.links.new(both.outputs[0], output.inputs["Surface"])
    studio.ball(material)
    studio.world((0.5, 0.5, 0.5))
    compare(studio, 0.01, 0.04)
    assert studio.exported.report.lines == []
