# SPDX-License-Identifier: GPL-3.0-or-later
"""The modules that do not need Blender, and the panels."""

from __future__ import annotations

import math
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from conftest import PROGRAM

PACKAGE = Path(__file__).parents[1] / "abbe_blender"


def test_conversions_have_closed_forms() -> None:
    from abbe_blender import units

    assert units.luminance((1, 1, 1)) == pytest.approx(1.0)
    assert units.luminance((0, 1, -5)) == pytest.approx(0.7152)
    assert units.vertical_fov(18, 36, True, (200, 100)) == pytest.approx(math.degrees(2 * math.atan(0.5)))
    assert units.vertical_fov(18, 36, False, (200, 100)) == pytest.approx(90)
    assert units.defocus_angle(50, 2.0, 2.5) == pytest.approx(math.degrees(2 * math.atan(0.0125 / 2.5)))
    half_angle, penumbra = units.spot_angles(math.radians(80), 0.25)
    edge, inner = math.cos(math.radians(half_angle)), math.cos(math.radians(half_angle - penumbra))
    assert (inner - edge) / (1 - edge) == pytest.approx(0.25)
    assert units.scaled_ior(1.5, 0.5) == pytest.approx(1.5)
    assert ((units.scaled_ior(1.5, 0.25) - 1) / (units.scaled_ior(1.5, 0.25) + 1)) ** 2 == pytest.approx(0.02)
    assert units.absorption((1, 1, 1), 2) == 0.0
    assert units.absorption((math.exp(-1),) * 3, 2) == pytest.approx(0.5)
    assert units.exposure_ev(2, 1024) == pytest.approx(-8)
    assert units.shutter("CENTER", 0.5) == (-0.25, 0.25)
    assert units.shutter("END", 0.5) == (-0.5, 0.0)


@pytest.mark.parametrize("shape", [(3, 5), (64, 33)])
def test_exr_files_are_written_and_read(tmp_path: Path, shape: tuple[int, int]) -> None:
    from abbe_blender import exr

    random = np.random.default_rng(1)
    channels = {name: random.normal(size=shape).astype(np.float32) for name in "RGB"}
    exr.write(tmp_path / "a.exr", channels)
    found = exr.read(tmp_path / "a.exr")
    assert found.size == (shape[1], shape[0])
    image = bpy.data.images.load(str(tmp_path / "a.exr"))
    image.colorspace_settings.name = "Non-Color"
    rows = np.array(image.pixels[:], np.float32).reshape(*shape, -1)[::-1]
    for number, name in enumerate("RGB"):
        assert np.array_equal(found.channels[name], channels[name])
        assert np.array_equal(rows[..., number], channels[name])


def test_compressed_files_of_abbe_are_read_as_openexr_reads_them(studio: Any) -> None:
    import OpenEXR

    from abbe_blender import exr

    studio.camera()
    studio.floor()
    studio.world()
    studio.render()
    found = exr.read(studio.exported.picture)
    assert found.header["compression"] == b"\x01"
    expected = OpenEXR.File(str(studio.exported.picture), separate_channels=True).parts[0].channels
    assert set(found.channels) == set(expected) and len(expected) > 6
    for name, channel in expected.items():
        assert np.array_equal(found.channels[name], channel.pixels), name


@pytest.mark.parametrize("length", [0, 3, 100, 500, -1])
def test_damaged_exr_files_are_errors(tmp_path: Path, length: int) -> None:
    from abbe_blender import exr

    exr.write(tmp_path / "a.exr", {"R": np.ones((8, 8), np.float32)})
    data = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "b.exr").write_bytes(data[:length])
    with pytest.raises(ValueError, match="b.exr"):
        exr.read(tmp_path / "b.exr")


def test_closed_meshes_are_found_and_measured() -> None:
    from abbe_blender import ply

    corners = np.array([[x, y, z] for x in (0, 2) for y in (0, 2) for z in (0, 2)], np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([tri for a, b, c, d in quads for tri in ((a, b, c), (a, c, d))])
    assert ply.is_closed(corners, triangles)
    assert not ply.is_closed(corners, triangles[1:])
    volume, area = ply.size(corners, triangles)
    assert (volume, area) == (pytest.approx(8.0), pytest.approx(24.0))
    rows, merged = ply.merged(np.concatenate([corners, -0.0 * corners[:1]]), np.array([[0, 1, 8]]))
    assert len(rows) == 8 and merged[0][0] == merged[0][2]


def test_modules_without_blender_do_not_import_it() -> None:
    names = ("exr", "ies", "ply", "program", "report", "units")
    script = (
        "import sys, types; sys.modules['bpy'] = None; sys.modules['mathutils'] = None; p = types.ModuleType('p'); "
    )
    script += f"p.__path__ = [{str(PACKAGE)!r}]; sys.modules['p'] = p; "
    script += "; ".join(f"import p.{name}" for name in names)
    subprocess.run([sys.executable, "-c", script], check=True)


def test_names_of_the_catalogues_are_suggested(studio: Any) -> None:
    from abbe_blender import program

    assert "N-SF11" in dict(program.names(PROGRAM, "glass"))
    assert "gold" in dict(program.names(PROGRAM, "metal"))["Au"]
    assert dict(program.names(PROGRAM, "spectrum"))["D65"].startswith("light ")
    assert "Tessar f/4.5" in dict(program.names(PROGRAM, "lens"))


class Layout:
    """A layout that checks what a panel draws: each property and each operator must exist."""

    def __init__(self) -> None:
        self.drawn: list[str] = []

    def prop(self, owner: Any, name: str, **_options: Any) -> None:
        assert name in owner.bl_rna.properties, (owner, name)
        self.drawn.append(name)

    def operator(self, name: str) -> None:
        assert name in {"abbe.export", "abbe.measure"}
        self.drawn.append(name)

    def label(self, text: str, icon: str = "NONE") -> None:
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        self.drawn.append(text)

    def template_curve_mapping(self, owner: Any, name: str) -> None:
        assert name in owner.bl_rna.properties

    def row(self) -> Layout:
        return self

    def column(self, heading: str = "") -> Layout:
        return self


def test_the_panels_draw_each_setting(studio: Any) -> None:
    from abbe_blender import panels, properties

    camera, lamp, empty = studio.camera(), studio.light("SUN", 1), studio.add("Empty", None)
    studio.world()
    material = studio.material("Glass")
    studio.scene.render.use_motion_blur = True
    material.abbe.use_film = material.abbe.use_medium = studio.scene.world.abbe.use_medium = True
    lamp.data.abbe.quantity = "PHOTOMETRIC"
    material.abbe.absorption_distance = 1.0
    drawn: set[str] = set()
    for surface, choice in (("NODES", 0), ("NODES", 1), ("NODES", 2), ("GLASS", 0), ("METAL", 0), ("BOUNDARY", 0)):
        material.abbe.surface = surface
        for settings in (material.abbe, lamp.data.abbe, studio.scene.world.abbe, camera.data.abbe):
            for name, known in settings.bl_rna.properties.items():
                if name.endswith("_source"):
                    setattr(settings, name, known.enum_items[choice].identifier)
        context = types.SimpleNamespace(
            engine="ABBE", scene=studio.scene, view_layer=studio.layer, material=material, light=lamp.data,
            world=studio.scene.world, camera=camera.data, object=empty,
        )  # fmt: skip
        for panel in panels.CLASSES:
            assert panel.poll(context)
            layout = Layout()
            panel.draw(types.SimpleNamespace(layout=layout, start=lambda layout=layout: layout), context)
            assert layout.drawn, panel
            drawn.update(layout.drawn)
    all_names = {name for owner in properties.OWNERS for name in owner.__annotations__}
    assert all_names <= drawn, all_names - drawn


def test_the_engine_has_the_panels_of_blender(studio: Any) -> None:
    for name in ("DATA_PT_lens", "DATA_PT_EEVEE_light", "EEVEE_MATERIAL_PT_surface", "RENDER_PT_format"):
        assert "ABBE" in getattr(bpy.types, name).COMPAT_ENGINES, name
    assert "ABBE" not in bpy.types.RENDER_PT_freestyle.COMPAT_ENGINES


def test_the_add_on_can_be_switched_off_and_on(studio: Any) -> None:
    import addon_utils

    addon_utils.disable("abbe_blender", default_set=True)
    assert not hasattr(bpy.types.Scene, "abbe")
    assert "ABBE" not in bpy.types.DATA_PT_lens.COMPAT_ENGINES
    addon_utils.enable("abbe_blender", default_set=True)
    assert bpy.context.scene.abbe.passes == 8


def test_each_file_names_its_licence_and_is_short() -> None:
    files = [*PACKAGE.glob("*.py"), *Path(__file__).parent.glob("*.py")]
    assert len(files) > 20
    for path in files:
        lines = path.read_text(encoding="utf-8").splitlines()
        assert lines[0] == "# SPDX-License-Identifier: GPL-3.0-or-later", path
        assert len(lines) <= 500 and max(map(len, lines)) <= 120, path
