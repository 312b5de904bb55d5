# SPDX-License-Identifier: GPL-3.0-or-later
"""What Abbe does not have is listed by name, and a plain scene lists nothing."""

from __future__ import annotations

from typing import Any

import addon_utils
import bpy
import pytest
from test_settings import fill, set_all, shader


def link(material: str, kind: str, socket: str, output: int = 0) -> None:
    """Feeds a socket of a Principled BSDF by a new node."""
    tree = bpy.data.materials[material].node_tree
    tree.links.new(tree.nodes.new(kind).outputs[output], shader(material)[socket])


MISSING: dict[str, Any] = {
    "Material 'Ball': 'Sheen Weight' of 'Principled BSDF'": lambda it: set_all(
        shader("Ball")["Sheen Weight"], default_value=1
    ),
    "Material 'Ball': 'Subsurface Weight' of 'Principled BSDF'": lambda it: set_all(
        shader("Ball")["Subsurface Weight"], default_value=0.5
    ),
    "Material 'Ball': the node 'Noise Texture' in 'Base Color' of 'Principled BSDF'": lambda it: link(
        "Ball", "ShaderNodeTexNoise", "Base Color", 1
    ),
    "Material 'Ball': the node 'Bump' in 'Normal' of 'Principled BSDF'": lambda it: link(
        "Ball", "ShaderNodeBump", "Normal"
    ),
    "Light 'Spot': the image of the light in mirrors": lambda it: set_all(
        bpy.data.lights["Spot"], shadow_soft_size=0.2
    ),
    "Light 'Sun': 'Diffuse Factor'": lambda it: set_all(bpy.data.lights["Sun"], diffuse_factor=0.5),
    "Light 'Area': the image of the light in mirrors": lambda it: it.light("AREA", 1, spread=1.0472),
    "World 'World': the node 'Sky Texture' in 'Color' of 'Background'": lambda it: sky(it),
    "Camera 'Camera': 'Shift'": lambda it: set_all(bpy.data.cameras["Camera"], shift_x=0.1),
    "Film: 'Transparent'": lambda it: set_all(it.scene.render, film_transparent=True),
    "Color management: the view transform 'Filmic' in the PNG of Abbe": lambda it: set_all(
        it.scene.view_settings, view_transform="Filmic"
    ),
    "Scene units: 'Unit Scale' (1 Blender unit is 1 m)": lambda it: set_all(it.scene.unit_settings, scale_length=0.01),
    "Object 'Sphere': invisibility to camera, shadow rays": lambda it: set_all(
        bpy.data.objects["Sphere"], visible_camera=False, visible_shadow=False
    ),
    "Object 'Sphere': 'Holdout'": lambda it: set_all(bpy.data.objects["Sphere"], is_holdout=True),
    "World 'World': invisibility to camera rays": lambda it: set_all(it.scene.world.cycles_visibility, camera=False),
    "Object 'Smoke': the type VOLUME": lambda it: it.add("Smoke", bpy.data.volumes.new("Smoke")),
    "Object 'Hair': the type CURVES": lambda it: it.add("Hair", bpy.data.hair_curves.new("Hair")),
}


def test_the_engine_does_not_need_cycles(studio: Any) -> None:
    fill(studio)
    studio.light("AREA", 10)
    studio.scene.render.use_motion_blur = True
    addon_utils.disable("cycles")
    try:
        assert not hasattr(bpy.types.Scene, "cycles")
        studio.scene.abbe.passes = 1
        bpy.ops.render.render()
    finally:
        addon_utils.enable("cycles")
    assert studio.exported.report.lines == []


def test_a_boundary_without_a_medium_is_named(studio: Any) -> None:
    fill(studio)
    bpy.data.materials["Ball"].abbe.surface = "BOUNDARY"
    studio.export()
    assert studio.exported.report.lines == ["Material 'Ball': the boundary has no medium inside, so it is invisible"]


def sky(studio: Any) -> None:
    tree = studio.scene.world.node_tree
    node = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], node.inputs["Color"])


def test_a_plain_scene_lacks_nothing(studio: Any) -> None:
    fill(studio)
    studio.export()
    assert studio.exported.report.lines == []


@pytest.mark.parametrize("line", MISSING)
def test_a_missing_setting_is_listed_by_name(studio: Any, line: str) -> None:
    fill(studio)
    MISSING[line](studio)
    studio.export()
    assert studio.exported.report.lines == [f"{line} is not mapped"]
    assert (studio.exported.scene.parent / "report.txt").read_text() == studio.exported.report.text()


def test_a_render_warns_about_what_is_missing(studio: Any, capfd: Any) -> None:
    fill(studio)
    studio.scene.abbe.passes = 1
    bpy.data.cameras["Camera"].shift_x = 0.1
    studio.render()
    assert "Abbe: Camera 'Camera': 'Shift' is not mapped" in capfd.readouterr().out
