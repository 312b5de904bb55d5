# SPDX-License-Identifier: GPL-3.0-or-later
"""The guide's way without the add-on gives the picture of the add-on."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from conftest import PROGRAM

GUIDE = Path(__file__).parents[2] / "docs" / "guide" / "from-blender.md"


def overlay() -> Any:
    """Returns the overlay of the guide."""
    text = GUIDE.read_text(encoding="utf-8").split("<!-- blender: overlay -->")[1]
    return json.loads(text.split("```json")[1].split("```")[0])


def test_gltf_and_the_overlay_of_the_guide_give_the_picture_of_the_add_on(studio: Any) -> None:
    from abbe_blender import exr

    if "io_scene_gltf2" not in {path.name for path in Path(bpy.utils.system_resource("SCRIPTS")).glob("addons*/*")}:
        pytest.skip("this build of Blender does not have the glTF exporter")
    studio.camera((0, -6, 3), (1.1, 0, 0))
    studio.floor()
    bpy.data.materials["Floor"].node_tree.nodes.clear()
    grey = studio.material("Paint", Base_Color=(0.5, 0.5, 0.5, 1), Roughness=1.0, Specular_IOR_Level=0.0)
    bpy.data.objects["Floor"].data.materials[0] = grey
    glass = studio.material("Glass", Base_Color=(1, 1, 1, 1), Transmission_Weight=1.0, Roughness=0.0, IOR=1.5)
    glass.abbe.surface, glass.abbe.glass = "GLASS", "N-SF11"
    studio.ball(glass)
    panel = studio.material("Panel", Base_Color=(0, 0, 0, 1), Emission_Color=(1, 1, 1, 1), Emission_Strength=2.0)
    studio.ball(panel, (-1.5, 0.5, 0.4), 0.4)
    studio.light("AREA", 200, (1, 1, 3), size=1)
    studio.light("SUN", 2, angle=0.034907).rotation_euler = (0.3, 0.4, 0)
    studio.world((0.4, 0.6, 1.0), 0.5)
    studio.scene.abbe.passes = 24
    shown = studio.render()
    file = studio.folder / "room.glb"
    bpy.ops.export_scene.gltf(
        filepath=str(file), export_cameras=True, export_lights=True, export_apply=True,
        export_import_convert_lighting_mode="COMPAT",
    )  # fmt: skip
    (studio.folder / "overlay.json").write_text(json.dumps(overlay()))
    command = [PROGRAM, "render", "room.glb", "--overlay", "overlay.json", "--size", "64x64", "--passes", "24"]
    done = subprocess.run([*command, "-o", "room.exr"], cwd=studio.folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    picture = exr.read(studio.folder / "room.exr")
    found = np.stack([picture.channels[letter] for letter in "RGB"], -1)[::-1]
    ratio = found.mean(axis=(0, 1)) / shown.mean(axis=(0, 1))
    print(f"ratios {ratio}")
    assert np.abs(ratio - 1).max() < 0.01
    means = [it.reshape(8, 8, 8, 8, 3).mean(axis=(1, 3)) for it in (found, shown)]
    assert np.abs(means[0] - means[1]).max() < 0.05 * means[1].max()
