# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances, modifiers, curves, motion and pictures, compared with Cycles."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest
from test_cycles import compare


def grey(studio: Any) -> Any:
    return studio.material("Grey", "ShaderNodeBsdfDiffuse", Color=(0.4, 0.4, 0.4, 1))


def texture(studio: Any, material: Any, node: str, socket: str, image: Any, **mapping: Any) -> Any:
    """Feeds an image to a socket, through a Mapping node."""
    tree = material.node_tree
    picture, place, coordinates = (
        tree.nodes.new(kind) for kind in ("ShaderNodeTexImage", "ShaderNodeMapping", "ShaderNodeTexCoord")
    )
    picture.image = image
    for name, value in mapping.items():
        place.inputs[name].default_value = value
    tree.links.new(coordinates.outputs["UV"], place.inputs["Vector"])
    tree.links.new(place.outputs["Vector"], picture.inputs["Vector"])
    tree.links.new(picture.outputs["Color"], tree.nodes[node].inputs[socket])
    return picture


def chart(size: int = 16) -> Any:
    """Returns a generated image whose quarters have different colours."""
    image = bpy.data.images.new("chart", size, size)
    pixels = np.ones((size, size, 4), np.float32)
    half = size // 2
    pixels[:half, :half, :3], pixels[:half, half:, :3] = (0.9, 0.2, 0.2), (0.2, 0.8, 0.3)
    pixels[half:, :half, :3], pixels[half:, half:, :3] = (0.2, 0.3, 0.9), (0.9, 0.9, 0.2)
    image.pixels = pixels.ravel()
    return image


@pytest.mark.parametrize(
    "mapping",
    [
        {},
        {"Scale": (2, 3, 1), "Location": (0.1, 0.3, 0)},
        {"Rotation": (0, 0, 0.5), "Scale": (1.5, 0.7, 1), "Location": (0.2, 0.05, 0)},
    ],
)
def test_pictures_lie_as_in_cycles(studio: Any, mapping: Any) -> None:
    studio.camera((0, -3, 4), (0.65, 0, 0))
    floor = studio.floor(4)
    picture = texture(studio, floor.data.materials[0], "Diffuse BSDF", "Color", chart(), **mapping)
    picture.interpolation = "Closest"  # Cycles interpolates the codes of sRGB, and Abbe light.
    studio.world()
    compare(studio)


def test_a_normal_map_leans_as_in_cycles(studio: Any) -> None:
    studio.camera((0, -3, 4), (0.65, 0, 0))
    floor = studio.floor(4)
    material = floor.data.materials[0]
    image = bpy.data.images.new("normals", 8, 8)
    image.colorspace_settings.name = "Non-Color"
    image.pixels = [0.7, 0.6, 0.9, 1.0] * 64
    tree = material.node_tree
    tree.nodes.new("ShaderNodeNormalMap")
    texture(studio, material, "Normal Map", "Color", image)
    tree.links.new(tree.nodes["Normal Map"].outputs[0], tree.nodes["Diffuse BSDF"].inputs["Normal"])
    studio.light("SUN", 3, angle=0).rotation_euler = (0.7, 0, 0)
    compare(studio, 0.02)


def test_alpha_of_a_picture_cuts_as_in_cycles(studio: Any) -> None:
    studio.camera((0, -3, 4), (0.65, 0, 0))
    studio.floor()
    material = studio.material("Fence", Specular_IOR_Level=0.0)
    image = chart()
    pixels = np.array(image.pixels[:], np.float32).reshape(16, 16, 4)
    pixels[:, ::4, 3] = 0.0
    image.pixels = pixels.ravel()
    picture = texture(studio, material, "Principled BSDF", "Base Color", image)
    tree = material.node_tree
    tree.links.new(picture.outputs["Alpha"], tree.nodes["Principled BSDF"].inputs["Alpha"])
    bpy.ops.mesh.primitive_plane_add(size=2, location=(0, 0, 1))
    bpy.context.object.data.materials.append(material)
    studio.world()
    compare(studio, 0.02, 0.06)


def test_instances_modifiers_and_curves_look_as_in_cycles(studio: Any) -> None:
    studio.camera()
    studio.floor()
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0, 0, 0.3))
    cube = bpy.context.object
    cube.data.materials.append(grey(studio))
    array = cube.modifiers.new("Array", "ARRAY")
    array.count, array.relative_offset_displace = 3, (1.5, 0, 0)
    cube.modifiers.new("Bevel", "BEVEL").width = 0.05
    collection = bpy.data.collections.new("Cubes")
    bpy.data.collections["Collection"].objects.unlink(cube) if "Collection" in bpy.data.collections else None
    collection.objects.link(cube)
    for number in range(3):
        empty = studio.add(f"Copy {number}", None, (-1 + 0.3 * number, 1 - number, 0.4), (0, 0.3, 0.5 * number))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.ops.curve.primitive_bezier_circle_add(radius=1.5, location=(0, 0, 0.5))
    bpy.context.object.data.bevel_depth = 0.1
    bpy.context.object.data.materials.append(grey(studio))
    bpy.ops.object.text_add(location=(-1, -1.5, 0.05))
    bpy.context.object.data.extrude = 0.1
    studio.light("SUN", 2, angle=0.1).rotation_euler = (0.3, 0.4, 0)
    studio.world((0.3, 0.3, 0.3))
    compare(studio, 0.01, 0.06)
    content = studio.exported.content
    cubes = [thing["shape"]["shared"] for thing in content["objects"] if thing["name"] == "Cube"]
    assert len(cubes) == 4 and len(set(cubes)) == 1


@pytest.mark.parametrize("position", ["START", "CENTER", "END"])
def test_motion_blurs_as_in_cycles(studio: Any, position: str) -> None:
    camera = studio.camera()
    studio.floor()
    ball = studio.ball(grey(studio))
    for thing, axis, reach in ((ball, 0, 2.0), (camera, 2, 0.4)):
        start = thing.location[axis]
        for frame in (0, 1, 2):
            thing.location[axis] = start + reach * (frame - 1)
            thing.keyframe_insert("location", frame=frame)
    for action in bpy.data.actions:
        for curve in curves(action):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
    studio.light("SUN", 2, angle=0.1).rotation_euler = (0.3, 0.4, 0)
    studio.world((0.3, 0.3, 0.3))
    render = studio.scene.render
    render.use_motion_blur, render.motion_blur_shutter = True, 0.75
    render.motion_blur_position = position
    studio.scene.abbe.passes, studio.scene.cycles.samples = 64, 256
    studio.scene.frame_set(1)
    compare(studio, 0.01, 0.05)
    shutter = studio.exported.content["camera"]["shutter"]
    assert shutter["close"] - shutter["open"] == pytest.approx(0.75 / 24)


def curves(action: Any) -> Any:
    """Returns the curves of an action, which has layers since Blender 4.4."""
    if hasattr(action, "layers") and action.layers:
        return [curve for strip in action.layers[0].strips for bag in strip.channelbags for curve in bag.fcurves]
    return action.fcurves


def test_a_camera_sees_what_that_of_cycles_sees(studio: Any) -> None:
    camera = studio.camera((2, -5, 3), (1.0, 0.2, 0.4))
    studio.floor()
    studio.ball(grey(studio))
    studio.world()
    render = studio.scene.render
    for fit, size, kind in (
        ("AUTO", (64, 32), "PERSP"),
        ("AUTO", (32, 64), "PERSP"),
        ("VERTICAL", (64, 32), "PERSP"),
        ("HORIZONTAL", (32, 64), "PERSP"),
        ("AUTO", (32, 64), "ORTHO"),
    ):
        camera.data.sensor_fit, camera.data.type = fit, kind
        render.resolution_x, render.resolution_y = size
        abbe, cycles = studio.render("ABBE"), studio.render("CYCLES")
        assert abbe.shape == cycles.shape == (size[1], size[0], 3)
        means = [
            np.add.reduceat(np.add.reduceat(it, range(0, size[1], 8), 0), range(0, size[0], 8), 1)
            for it in (abbe, cycles)
        ]
        assert np.abs(means[0] - means[1]).max() < 0.03 * means[1].max(), (fit, size, kind)


def test_depth_of_field_blurs_as_in_cycles(studio: Any) -> None:
    camera = studio.camera()
    studio.floor()
    studio.ball(studio.material("Lamp", "ShaderNodeEmission", Strength=3))
    camera.data.dof.use_dof, camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = True, 2.0, 0.1
    compare(studio, 0.01, 0.04)


def test_tinted_glass_has_its_colour_after_the_mean_chord(studio: Any) -> None:
    studio.camera()
    studio.ball(studio.material("Tinted", "ShaderNodeBsdfGlass", Color=(0.2, 0.9, 0.5, 1), Roughness=0.0))
    studio.world()
    red, green, _ = studio.render().mean(axis=(0, 1))
    assert red < 0.97 * green
    mix = studio.exported.content["materials"]["Tinted"]["dielectric"]["absorption"]["mix"][0]
    chord = 4 / 3 * 0.7  # The mean chord of a ball is 4/3 of its radius.
    assert mix["weight"] == pytest.approx(-math.log(0.2) / chord, rel=0.01)
    assert "the mean chord of Object 'Sphere'" in studio.exported.report.text()


def test_two_materials_of_a_mesh_are_two_objects(studio: Any) -> None:
    ball = studio.ball(grey(studio))
    ball.data.materials.append(studio.material("Red", "ShaderNodeBsdfDiffuse", Color=(1, 0, 0, 1)))
    for face in ball.data.polygons:
        face.material_index = int(face.center.z > 0)
    studio.camera()
    studio.world()
    compare(studio, 0.01)
    used = [(thing["name"], thing["material"]) for thing in studio.exported.content["objects"]]
    assert used == [("Sphere", "Grey"), ("Sphere", "Red")]


VOLUMES = {
    "scatter": ("ShaderNodeVolumeScatter", {"Color": (0.6, 0.6, 0.6, 1), "Density": 0.6, "Anisotropy": 0.4}),
    "absorption": ("ShaderNodeVolumeAbsorption", {"Color": (0.2, 0.6, 0.9, 1), "Density": 1.5}),
    "principled": (
        "ShaderNodeVolumePrincipled",
        {"Color": (0.5, 0.5, 0.5, 1), "Density": 1.2, "Absorption Color": (0.2, 0.2, 0.2, 1)},
    ),
}


def volume(tree: Any, name: str) -> None:
    """Feeds a volume shader to the output of a tree."""
    kind, inputs = VOLUMES[name]
    node = tree.nodes.new(kind)
    for socket, value in inputs.items():
        node.inputs[socket].default_value = value
    output = next(node for node in tree.nodes if node.type.startswith("OUTPUT"))
    tree.links.new(node.outputs[0], output.inputs["Volume"])


@pytest.mark.parametrize("name", VOLUMES)
def test_bodies_of_media_look_as_in_cycles(studio: Any, name: str) -> None:
    studio.camera()
    studio.floor()
    material = studio.material("Medium", "ShaderNodeBsdfTransparent")
    material.node_tree.nodes.remove(material.node_tree.nodes["Transparent BSDF"])
    volume(material.node_tree, name)
    studio.ball(material)
    studio.light("SUN", 2, angle=0.1).rotation_euler = (0.3, 0.4, 0)
    studio.world((0.4, 0.5, 0.6))
    studio.scene.cycles.volume_bounces, studio.scene.abbe.passes = 32, 64
    compare(studio, 0.01, 0.05)
    assert studio.exported.report.lines == []


def test_the_fog_of_a_world_looks_as_in_cycles(studio: Any) -> None:
    # The rays of Cycles begin at the near clipping plane, so that less fog is in front of them.
    studio.camera((0, -6, 2), (1.0, 0, 0)).data.clip_start = 1e-4
    studio.floor(20)
    studio.light("AREA", 300, (0, 0, 4), size=1)
    studio.world((0, 0, 0), 0.0)
    volume(studio.scene.world.node_tree, "principled")
    node = next(node for node in studio.scene.world.node_tree.nodes if node.type == "PRINCIPLED_VOLUME")
    # Abbe's fog fills a ball around the scene. It absorbs, so that little light returns from outside.
    node.inputs["Density"].default_value, node.inputs["Absorption Color"].default_value = 0.3, (0, 0, 0, 1)
    studio.scene.cycles.volume_bounces, studio.scene.cycles.samples, studio.scene.abbe.passes = 32, 256, 64
    compare(studio, 0.01, 0.15)


def test_objects_without_extent_are_left_out(studio: Any) -> None:
    studio.camera()
    studio.floor()
    studio.world()
    hidden, flat = studio.ball(grey(studio)), studio.ball(grey(studio))
    hidden.scale, flat.scale, flat.name = (0, 0, 0), (1, 1, 0), "Flat"
    studio.render()
    assert [thing["name"] for thing in studio.exported.content["objects"]] == ["Floor"]
    line = "Object 'Flat': a scale that makes the object flat is not mapped"
    assert studio.exported.report.lines == [line]


def test_any_name_is_a_name_in_abbe(studio: Any) -> None:
    studio.scene.name = 'Sc"ne/../x'
    studio.camera()
    floor = studio.floor()
    studio.world()
    floor.name, floor.data.name, floor.data.materials[0].name = "$floor", "../../evil", "$paint"
    image = chart()
    image.name = "../../tex/ü.png"
    texture(studio, floor.data.materials[0], "Diffuse BSDF", "Color", image)
    studio.light("SUN", 1).name = "Küche 1/2"
    assert studio.render().mean() > 0.1
    folder = studio.exported.scene.parent
    assert folder.parent == studio.folder / "abbe"
    assert {path.name for path in folder.iterdir()} >= {"evil.ply", "ü.png", "scene.json", "scene.exr"}
