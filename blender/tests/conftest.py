# SPDX-License-Identifier: GPL-3.0-or-later
"""What all tests share: Blender without a window, the add-on, and scenes."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

import addon_utils  # noqa: E402  (a module of Blender)

#: The program under test.
PROGRAM = os.environ["ABBE_PROGRAM"]


class Studio:
    """An empty scene of Blender with the engine Abbe, and functions that fill and render it."""

    def __init__(self, folder: Path) -> None:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        addon_utils.enable("cycles")
        addon_utils.enable("abbe_blender", default_set=True)
        self.folder = folder
        self.preferences = bpy.context.preferences.addons["abbe_blender"].preferences
        self.preferences.program = PROGRAM
        self.use(bpy.context.scene)

    def use(self, scene: Any) -> None:
        """Prepares a scene for small, quick renders."""
        self.scene, self.layer = scene, scene.view_layers[0]
        scene.render.engine = "ABBE"
        scene.render.resolution_x = scene.render.resolution_y = 64
        scene.abbe.folder, scene.abbe.passes = str(self.folder / "abbe"), 8
        scene.cycles.device, scene.cycles.samples = "CPU", 64
        scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
        scene.cycles.sample_clamp_indirect, scene.cycles.diffuse_bounces = 0, 32
        scene.cycles.blur_glossy = 0

    def add(
        self, name: str, data: Any, place: tuple[float, ...] = (0, 0, 0), turn: tuple[float, ...] = (0, 0, 0)
    ) -> Any:
        """Adds an object at a place, turned by Euler angles."""
        thing = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(thing)
        thing.location, thing.rotation_euler = place, turn
        return thing

    def camera(self, place: tuple[float, ...] = (0, -6, 3), turn: tuple[float, ...] = (1.1, 0, 0)) -> Any:
        """Adds the camera."""
        self.scene.camera = self.add("Camera", bpy.data.cameras.new("Camera"), place, turn)
        return self.scene.camera

    def light(self, kind: str, energy: float, place: tuple[float, ...] = (0, 0, 3), **settings: Any) -> Any:
        """Adds a light that shines down."""
        data = bpy.data.lights.new(kind.capitalize(), kind)
        data.energy = energy
        for name, value in settings.items():
            setattr(data, name, value)
        thing = self.add(kind.capitalize(), data, place)
        thing.visible_camera = True
        return thing

    def material(self, name: str, kind: str = "ShaderNodeBsdfPrincipled", **inputs: Any) -> Any:
        """Returns a material with one shader."""
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        shader = tree.nodes.new(kind)
        for socket, value in inputs.items():
            shader.inputs[socket.replace("_", " ")].default_value = value
        tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        return material

    def floor(self, size: float = 8.0, grey: float = 0.5) -> Any:
        """Adds a diffuse floor."""
        bpy.ops.mesh.primitive_plane_add(size=size)
        floor = bpy.context.object
        floor.name = "Floor"
        floor.data.materials.append(self.material("Floor", "ShaderNodeBsdfDiffuse", Color=(grey, grey, grey, 1)))
        return floor

    def ball(self, material: Any, place: tuple[float, ...] = (0, 0, 0.7), radius: float = 0.7) -> Any:
        """Adds a smooth ball of 64 × 32 faces."""
        bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=place, segments=64, ring_count=32)
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(material)
        return bpy.context.object

    def world(self, colour: tuple[float, ...] = (1, 1, 1), strength: float = 1.0) -> Any:
        """Adds a world of one colour. Returns its Background node."""
        world = bpy.data.worlds.new("World")
        world.use_nodes = True
        self.scene.world = world
        node = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
        node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (*colour, 1), strength
        return node

    def render(self, engine: str = "ABBE") -> Any:
        """Renders the scene. Returns linear RGB, rows from the bottom."""
        self.scene.render.engine = engine
        bpy.ops.render.render()
        return self.layers("OPEN_EXR")

    def layers(self, kind: str) -> Any:
        """Saves the picture of the last render, and reads the colours back by Blender."""
        path = self.folder / "picture.exr"
        settings = self.scene.render.image_settings
        if hasattr(settings, "media_type"):
            settings.media_type = "MULTI_LAYER_IMAGE" if kind == "OPEN_EXR_MULTILAYER" else "IMAGE"
        settings.file_format, settings.color_depth = kind, "32"
        settings.exr_codec = "NONE"
        if hasattr(settings, "use_exr_interleave"):
            settings.use_exr_interleave = True
        bpy.data.images["Render Result"].save_render(str(path))
        if kind == "OPEN_EXR_MULTILAYER":
            return path
        image = bpy.data.images.load(str(path))
        image.colorspace_settings.name = "Non-Color"
        pixels = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], -1)[..., :3]
        bpy.data.images.remove(image)
        return pixels

    @property
    def exported(self) -> Any:
        """The last exported scene."""
        from abbe_blender.engine import AbbeRenderEngine

        return AbbeRenderEngine.last

    def export(self) -> Any:
        """Exports the scene without a render. Returns its content."""
        assert bpy.ops.abbe.export() == {"FINISHED"}
        return self.exported.content


@pytest.fixture
def studio(tmp_path: Path) -> Studio:
    """A new, empty scene."""
    return Studio(tmp_path)
