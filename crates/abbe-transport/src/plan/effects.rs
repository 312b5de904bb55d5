//! The effects that a scene may need, and the properties of each effect.

use super::fields::Plan;
use super::tally::Tally;
use abbe_scene::Scene;
use abbe_scene::facts::Facts;
use abbe_spectra::error::Result;

/// An effect that a scene may need, in the order of decision and of reports. A setter may read or
/// refine values of earlier setters: `Absorption` refines the field that `Bodies` writes, and
/// `LightMap` reads those of `Direct` and `Media`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectId {
    /// Glass refracts each wavelength in its own direction.
    Dispersion,
    /// Each camera path starts with one of the pass's shared wavelengths.
    Shared,
    /// Photons and camera paths carry the polarisation of light.
    Polarisation,
    /// Light reaches surfaces through glass and from mirrors.
    Caustics,
    /// Photons paint dispersed light with their whole spectrum.
    Ribbons,
    /// Light is scattered from surface to surface.
    Indirect,
    /// Camera paths may gather indirect light behind the first diffuse surface.
    FinalGather,
    /// Light reaches surfaces straight from its source.
    Direct,
    /// The camera's aperture has a finite size.
    DepthOfField,
    /// The rim of the camera's aperture diffracts light.
    Diffraction,
    /// The surfaces of the camera's lens reflect light to the sensor.
    Ghosts,
    Environment,
    /// Properties of materials vary over surfaces.
    Textures,
    /// Light interferes in thin films.
    ThinFilms,
    /// Surfaces emit light at other wavelengths than they absorb.
    Fluorescence,
    /// Light below 360 nm excites fluorophores.
    Ultraviolet,
    /// Camera paths continue at rough and coated surfaces.
    Roughness,
    Bodies,
    Absorption,
    Media,
    /// Direct light in media comes from light maps.
    LightMap,
    VolumePhotons,
    PhotonBeams,
    /// The directions of emitted photons follow learned distributions.
    Aim,
    Motion,
    Meters,
}

#[derive(Debug, Clone, Copy)]
pub struct Effect {
    pub id: EffectId,
    /// The name in scene files, command lines and reports.
    pub name: &'static str,
    /// The switch of the effect: a field of the plan, or a part of the scene.
    pub field: &'static str,
    pub cost: &'static str,
    /// The consequence if the effect is off.
    pub absent: &'static str,
    pub events: fn(&Tally, &Plan) -> u64,
    /// A plural noun for the parts of the scene that need the effect.
    pub(super) required_by: &'static str,
    /// Reports show this reason if the effect is off because no part of the scene needs it.
    pub(super) not_required: &'static str,
    /// Returns the objects, lights, media or settings that need the effect.
    pub(super) requires: fn(&Facts) -> Vec<String>,
    /// Switches the effect on or off in a plan.
    pub(super) set: fn(&mut Plan, &Facts, bool),
    /// How the effect is removed if it is forbidden or negligible.
    pub(super) removal: Removal,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Removal {
    /// The plan's field switches the effect off. The scene does not change.
    FromPlan,
    /// From the scene too. The second argument is a wavelength in nm, at which a forbidden
    /// dispersion leaves the refractive indices.
    FromScene(fn(&mut Scene, f64) -> Result<()>),
    /// The effect is a property of the scene and cannot be forbidden.
    Refused { alternative: &'static str },
}

impl EffectId {
    /// All effects, in the order of decision.
    pub const ALL: [Self; 26] = [
        Self::Dispersion,
        Self::Shared,
        Self::Polarisation,
        Self::Caustics,
        Self::Ribbons,
        Self::Indirect,
        Self::FinalGather,
        Self::Direct,
        Self::DepthOfField,
        Self::Diffraction,
        Self::Ghosts,
        Self::Environment,
        Self::Textures,
        Self::ThinFilms,
        Self::Fluorescence,
        Self::Ultraviolet,
        Self::Roughness,
        Self::Bodies,
        Self::Absorption,
        Self::Media,
        Self::LightMap,
        Self::VolumePhotons,
        Self::PhotonBeams,
        Self::Aim,
        Self::Motion,
        Self::Meters,
    ];
}

/// Lists the first three names and the number of the others.
pub(super) fn listed(names: &[String]) -> String {
    const SHOWN: usize = 3;
    let shown = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{shown} and {} more", names.len() - SHOWN) } else { shown }
}
