# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of Abbe, and the panels of Blender that its engine uses."""

from __future__ import annotations

from typing import Any

import bpy

from .engine import AbbeRenderEngine

#: Panels of EEVEE whose settings the add-on exports, in addition to the panels of all engines.
EXTRA = {
    "DATA_PT_EEVEE_light", "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture", "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface",
}  # fmt: skip
#: The beginnings of the names of panels whose settings have no effect.
WITHOUT_EFFECT = (
    "DATA_PT_light", "DATA_PT_preview", "MATERIAL_PT_freestyle", "NODE_DATA_PT_light", "RENDER_PT_freestyle",
    "RENDER_PT_gpencil", "RENDER_PT_grease", "RENDER_PT_simplify", "RENDER_PT_stereo", "TEXTURE_PT_",
    "VIEWLAYER_PT_freestyle",
)  # fmt: skip


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {"ABBE"}
    bl_label = "Abbe"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine == "ABBE" and cls.has_owner(context)

    @classmethod
    def has_owner(cls, _context: Any) -> bool:
        return True

    def start(self) -> Any:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout


def _show(layout: Any, owner: Any, *names: str) -> None:
    for name in names:
        layout.prop(owner, name)


def _spectrum(layout: Any, settings: Any, prefix: str = "", label: str = "Spectrum") -> None:
    source = f"{prefix}spectrum_source"
    layout.prop(settings, source, text=label)
    chosen = {"LIBRARY": f"{prefix}spectrum", "FILE": f"{prefix}spectrum_file"}.get(getattr(settings, source))
    if chosen:
        layout.prop(settings, chosen)


def _medium(layout: Any, settings: Any, label: str) -> None:
    layout.prop(settings, "use_medium", text=label)
    if settings.use_medium:
        _show(layout, settings, "medium_scattering", "medium_absorption", "medium_anisotropy")


class ABBE_PT_render(_Panel, bpy.types.Panel):
    """Sampling, spectra and files."""

    bl_context = "render"

    def draw(self, context: Any) -> None:
        layout, own = self.start(), context.scene.abbe
        _show(layout, own, "integrator", "passes", "time_limit", "target_error", "photons", "max_depth", "seed")
        _show(layout.column(heading="Picture"), own, "combined", "spectral_bands", "efficacy", "folder")
        render = context.scene.render
        layout.prop(render, "use_motion_blur")
        if render.use_motion_blur:
            _show(layout, render, "motion_blur_position", "motion_blur_shutter")
            layout.template_curve_mapping(render, "motion_blur_shutter_curve")
        row = layout.row()
        row.operator("abbe.export")
        row.operator("abbe.measure")


class ABBE_PT_report(_Panel, bpy.types.Panel):
    """What the last export left out."""

    bl_label = "Abbe: Not Mapped"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context: Any) -> None:
        last = AbbeRenderEngine.last
        if last is None:
            self.layout.label(text="Nothing was exported yet")
            return
        self.layout.label(text=str(last.scene), icon="FILE")
        for line in last.report.lines or ["All settings are mapped"]:
            self.layout.label(text=line)


class ABBE_PT_passes(_Panel, bpy.types.Panel):
    """The passes of a view layer."""

    bl_label = "Abbe Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        layout, layer = self.start(), context.view_layer
        _show(layout, layer.abbe, "use_pass_noise", "use_pass_bias", "use_pass_denoised", "use_pass_albedo")
        _show(layout, layer, "use_pass_z", "use_pass_normal")
        _show(layout, layer, "use_pass_cryptomatte_object", "use_pass_cryptomatte_material", "pass_cryptomatte_depth")
        _show(layout, layer.abbe, "use_pass_paths", "use_layer_lights")


class ABBE_PT_material(_Panel, bpy.types.Panel):
    """Glass, metal, spectra, films and media."""

    bl_context = "material"

    @classmethod
    def has_owner(cls, context: Any) -> bool:
        return context.material is not None

    def draw(self, context: Any) -> None:
        layout, own = self.start(), context.material.abbe
        layout.prop(own, "surface")
        names = {"GLASS": ("glass", "roughness", "absorption_distance"), "METAL": ("metal", "roughness")}
        _show(layout, own, *names.get(own.surface, ()))
        if own.surface == "GLASS" and own.absorption_distance > 0.0:
            layout.prop(own, "absorption_colour")
        if own.surface == "NODES":
            _spectrum(layout, own, label="Base Spectrum")
            _spectrum(layout, own, "emission_", "Emission Spectrum")
        if own.surface != "BOUNDARY":
            layout.prop(own, "use_film")
            if own.use_film:
                _show(layout, own, "film", "film_thickness")
        _medium(layout, own, "Medium Inside")
        if own.surface != "METAL":
            layout.prop(own, "priority")


class ABBE_PT_light(_Panel, bpy.types.Panel):
    """Spectrum and strength."""

    bl_context = "data"

    @classmethod
    def has_owner(cls, context: Any) -> bool:
        return context.light is not None

    def draw(self, context: Any) -> None:
        layout, own = self.start(), context.light.abbe
        _spectrum(layout, own)
        layout.prop(own, "quantity")
        if own.quantity == "PHOTOMETRIC":
            layout.prop(own, "amount", text="Lux" if context.light.type == "SUN" else "Lumens")


class ABBE_PT_world(_Panel, bpy.types.Panel):
    """Spectrum and fog."""

    bl_label = "Abbe Fog and Spectrum"
    bl_context = "world"

    @classmethod
    def has_owner(cls, context: Any) -> bool:
        return context.world is not None

    def draw(self, context: Any) -> None:
        layout, own = self.start(), context.world.abbe
        _spectrum(layout, own)
        _medium(layout, own, "Fog")


class ABBE_PT_camera(_Panel, bpy.types.Panel):
    """A lens of real glass."""

    bl_label = "Abbe Lens"
    bl_context = "data"

    @classmethod
    def has_owner(cls, context: Any) -> bool:
        return context.camera is not None

    def draw(self, context: Any) -> None:
        layout, own = self.start(), context.camera.abbe
        layout.prop(own, "lens_source")
        names = {"LIBRARY": ("lens", "ghosts"), "FILE": ("lens_file", "ghosts")}
        _show(layout, own, *names.get(own.lens_source, ()), "diffraction")


class ABBE_PT_object(_Panel, bpy.types.Panel):
    """A meter."""

    bl_label = "Abbe Meter"
    bl_context = "object"

    @classmethod
    def has_owner(cls, context: Any) -> bool:
        return context.object is not None and context.object.type in {"EMPTY", "MESH"}

    def draw(self, context: Any) -> None:
        self.start().prop(context.object.abbe, "meter")


CLASSES = (
    ABBE_PT_render, ABBE_PT_report, ABBE_PT_passes, ABBE_PT_material, ABBE_PT_light, ABBE_PT_world,
    ABBE_PT_camera, ABBE_PT_object,
)  # fmt: skip


def _shared() -> list[Any]:
    """Returns the panels of Blender that are shown for the engine."""
    found = []
    for name in dir(bpy.types):
        engines = getattr(getattr(bpy.types, name), "COMPAT_ENGINES", ())
        if name in EXTRA or ("BLENDER_RENDER" in engines and not name.startswith(WITHOUT_EFFECT)):
            found.append(getattr(bpy.types, name))
    return found


def register() -> None:
    """Registers the panels."""
    for panel in CLASSES:
        bpy.utils.register_class(panel)
    for panel in _shared():
        panel.COMPAT_ENGINES.add("ABBE")


def unregister() -> None:
    """Removes the panels."""
    for panel in _shared():
        panel.COMPAT_ENGINES.discard("ABBE")
    for panel in CLASSES:
        bpy.utils.unregister_class(panel)
