//! Plans a scene, and removes what the plan does not simulate, once before rendering, so that rays
//! and photons need no checks for absent effects.

use super::decide::{EffectRow, EffectState, decide};
use super::effects::{EffectId, Removal, listed};
use super::fields::Plan;
use super::negligible::{light_centre_nm, negligible};
use super::unpolarised::needs_polarisation;
use abbe_scene::Scene;
use abbe_scene::facts::Facts;
use abbe_spectra::error::{Error, Result};

/// Fraunhofer's d line, at which glass keeps its index if dispersion is forbidden.
const D_LINE_NM: f64 = 587.5618;

/// Plans the scene by its settings, removes negligible and forbidden effects from it, and adds
/// notes to it. Returns the plan and one row per effect, or an input error if the name of an effect
/// is unknown, a forbidden effect cannot be forbidden, or the plan contains diffraction without an
/// aperture.
pub fn prepare(scene: &mut Scene) -> Result<(Plan, Vec<EffectRow>)> {
    let negligible = negligible(scene);
    let light_nm = light_centre_nm(scene);
    for absent in &negligible {
        let effect = absent.effect.effect();
        if !scene.settings.forces(effect.name)
            && let Removal::FromScene(remove) = effect.removal
        {
            remove(scene, light_nm)?;
        }
    }
    let mut facts = Facts::of(scene);
    facts.polarising.extend(needs_polarisation(scene));
    let (plan, rows) = decide(&facts, &negligible, &scene.settings.force, &scene.settings.forbid)?;
    for row in rows.iter().filter(|row| row.state == EffectState::Forbidden) {
        let EffectRow { effect, because, .. } = row;
        match effect.removal {
            Removal::FromPlan => {}
            Removal::FromScene(remove) => remove(scene, D_LINE_NM)?,
            Removal::Refused { alternative } => {
                let what = format!("the effect \"{}\" cannot be forbidden", effect.name);
                return Err(Error::input(what).expected(alternative));
            }
        }
        scene.notes.push(format!("{} is forbidden ({because}): {}", effect.name, effect.absent));
    }
    if !plan.aperture.diffracts() && rows.iter().any(|row| row.effect.id == EffectId::Diffraction && row.state.is_on())
    {
        return Err(Error::input("diffraction is on, but the camera has no aperture")
            .expected("a lens with an aperture, or \"diffraction\" forbidden too"));
    }
    if plan.ultraviolet {
        scene.add_ultraviolet();
    }
    scene.notes.extend(upsampled_colours_note(&facts));
    Ok((plan, rows))
}

/// Warns if the scene has lights with spectral lines and spectra from RGB colours: a smooth
/// estimate, which predicts little about few wavelengths.
fn upsampled_colours_note(facts: &Facts) -> Option<String> {
    let Facts { upsampled, line_lights, .. } = facts;
    if upsampled.is_empty() || line_lights.is_empty() {
        return None;
    }
    let (colours, lights) = (listed(upsampled), listed(line_lights));
    Some(format!(
        "spectra reconstructed from RGB ({colours}) are estimates, and lights with spectral lines ({lights}) use them at few wavelengths: measured spectra may give quite different colours"
    ))
}
