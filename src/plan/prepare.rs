//! From a scene to its plan: what is forbidden is taken out of the scene itself, so that no code has to ask.

use super::effects::listed;
use super::negligible::{middle_of_light_nm, negligible};
use super::{Negligible, Plan, Row, State};
use crate::error::{Error, Result};
use crate::optics::glass::Index;
use crate::scene::Scene;
use crate::scene::facts::Facts;
use crate::scene::light::Emitter;

/// Fraunhofer's d line, at which glass without dispersion keeps its index.
const D_LINE_NM: f64 = 587.5618;

/// Plans the scene by its own settings, and takes out of it what they forbid.
pub fn prepare(scene: &mut Scene) -> Result<(Plan, Vec<Row>)> {
    let negligible = negligible(scene);
    let forced = |effect: &str, scene: &Scene| scene.settings.force.iter().any(|name| name == effect);
    let light_nm = middle_of_light_nm(scene);
    for Negligible { effect, .. } in &negligible {
        if !forced(effect, scene) {
            take_out(scene, effect, light_nm)?;
        }
    }
    let facts = Facts::of(scene);
    let (plan, rows) = Plan::new(&facts, &negligible, &scene.settings.force, &scene.settings.forbid)?;
    for row in rows.iter().filter(|row| row.state == State::Forbidden) {
        may_be_forbidden(row.effect.name)?;
        take_out(scene, row.effect.name, D_LINE_NM)?;
        let Row { effect, because, .. } = row;
        scene.notes.push(format!("{} is forbidden ({because}): {}", effect.name, effect.absent));
    }
    if !plan.aperture.diffracts() && rows.iter().any(|row| row.effect.name == "diffraction" && row.state.is_on()) {
        return Err(Error::input("diffraction is asked for, and the camera is left no opening to diffract light")
            .expected("a lens with an opening, or \"diffraction\" forbidden too"));
    }
    scene.notes.extend(guessed_colours(&facts));
    Ok((plan, rows))
}

/// What a reader must know of a scene where lines meet colours made from RGB: a smooth guess says little about the few
/// wavelengths of such a lamp.
fn guessed_colours(facts: &Facts) -> Option<String> {
    let Facts { upsampled, line_lamps, .. } = facts;
    if upsampled.is_empty() || line_lamps.is_empty() {
        return None;
    }
    let (colours, lamps) = (listed(upsampled), listed(line_lamps));
    Some(format!(
        "colours made from RGB ({colours}) are guesses where light is in spectral lines ({lamps}): measured spectra may look quite different"
    ))
}

/// Some effects are what things in the scene are, and without them the picture would be another scene's.
fn may_be_forbidden(effect: &str) -> Result<()> {
    let without = match effect {
        "roughness" => "a scene whose materials have no roughness",
        "bodies" => "a scene of opaque things in air",
        "shared" => "a camera without a lens of real glass, or \"depth-of-field\" forbidden",
        _ => return Ok(()),
    };
    Err(Error::input(format!("the effect \"{effect}\" cannot be forbidden")).expected(without))
}

/// Takes an effect out of the scene, where the plan's field alone does not do it. Indices become what they are at `nm`.
fn take_out(scene: &mut Scene, effect: &str, nm: f64) -> Result<()> {
    let bodies = scene.materials.iter_mut().filter_map(|material| material.body.as_mut());
    match effect {
        "dispersion" => {
            for body in bodies {
                body.index = body.index.as_ref().map(|index| Index::constant(index.n(nm))).transpose()?;
            }
        }
        "absorption" => bodies.for_each(|body| body.absorption = None),
        "depth-of-field" => scene.camera.close_aperture(),
        "motion" => scene.stop(),
        "environment" => {
            scene.lights.retain(|light| match light.emitter {
                Emitter::Environment(_) | Emitter::Directional(_) => false,
                Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Area(_) | Emitter::Volume(_) => true,
            });
            scene.renumber_lights();
        }
        "media" => {
            bodies.for_each(|body| body.medium = None);
            scene.lights.retain(|light| !matches!(light.emitter, Emitter::Volume(_)));
            scene.renumber_lights();
        }
        _ => {}
    }
    Ok(())
}
