//! Parts of the effects in the table: facts that several of them need, and changes of a scene.

use super::fields::{IndirectPlan, Plan};
use abbe_optics::bsdf::Bsdf;
use abbe_scene::facts::Facts;
use abbe_scene::{Body, Scene};
use abbe_spectra::error::Result;

/// Returns the diffuse surfaces of a picture in clear air and natural light.
pub(super) fn pictured_diffuse(facts: &Facts) -> Vec<String> {
    let clear = facts.dense_media.is_empty() && facts.thin_media.is_empty();
    let pictured = facts.meters.is_empty() && facts.polarising.is_empty();
    if clear && pictured { facts.diffuse.clone() } else { Vec::new() }
}

/// Returns the plan of indirect light if a final gather is `on`. Paths with polarisation have none.
pub(super) fn with_final_gather(plan: &Plan, on: bool) -> IndirectPlan {
    let is_possible = on && plan.indirect == IndirectPlan::Photons && !plan.polarisation.is_on();
    if is_possible { IndirectPlan::PhotonsOrFinalGather } else { plan.indirect }
}

/// Replaces the surface of each material.
pub(super) fn replace_surfaces(scene: &mut Scene, replace: impl Fn(Bsdf) -> Result<Bsdf>) -> Result<()> {
    scene.materials.iter_mut().try_for_each(|material| {
        material.surface = replace(std::mem::replace(&mut material.surface, Bsdf::Absorber))?;
        Ok(())
    })
}

/// The interiors of all materials that have an interior.
pub(super) fn bodies(scene: &mut Scene) -> impl Iterator<Item = &mut Body> {
    scene.materials.iter_mut().filter_map(|material| material.body.as_mut())
}
