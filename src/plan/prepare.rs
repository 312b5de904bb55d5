//! From a scene to its plan: what is forbidden is taken out of the scene itself, so that no code has to ask.

use super::effects::listed;
use super::{Plan, Row, State};
use crate::error::{Error, Result};
use crate::optics::glass::Index;
use crate::scene::Scene;
use crate::scene::facts::Facts;
use crate::scene::light::Emitter;

/// Fraunhofer's d line, at which glass without dispersion keeps its index.
const D_LINE_NM: f64 = 587.5618;

/// Plans the scene by its own settings, and takes out of it what they forbid.
pub fn prepare(scene: &mut Scene) -> Result<(Plan, Vec<Row>)> {
    let facts = Facts::of(scene);
    let (plan, rows) = Plan::new(&facts, &scene.settings.force, &scene.settings.forbid)?;
    for row in rows.iter().filter(|row| row.state == State::Forbidden) {
        take_out(scene, row.effect.name)?;
        scene.notes.push(format!("the picture lacks {}: forbidden ({})", row.effect.name, row.because));
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

/// Takes an effect out of the scene, where the plan's field alone does not do it.
fn take_out(scene: &mut Scene, effect: &str) -> Result<()> {
    match effect {
        "dispersion" => {
            for body in scene.materials.iter_mut().filter_map(|material| material.body.as_mut()) {
                body.index = body.index.as_ref().map(|index| Index::constant(index.n(D_LINE_NM))).transpose()?;
            }
        }
        "absorption" => {
            scene.materials.iter_mut().filter_map(|m| m.body.as_mut()).for_each(|body| body.absorption = None);
        }
        "depth-of-field" => scene.camera.close_aperture(),
        "environment" => {
            scene.lights.retain(|light| match light.emitter {
                Emitter::Environment(_) | Emitter::Directional(_) => false,
                Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Area(_) | Emitter::Volume(_) => true,
            });
            scene.renumber_lights();
        }
        "roughness" => {
            return Err(Error::input("the effect \"roughness\" cannot be forbidden")
                .expected("a scene whose materials have no roughness"));
        }
        "shared" => {
            return Err(Error::input("the effect \"shared\" cannot be forbidden")
                .expected("a camera without a lens of real glass, or \"depth-of-field\" forbidden"));
        }
        // The plan's field alone leaves these out.
        "caustics" | "indirect" | "direct" | "aim" | "volume-photons" | "photon-beams" | "diffraction" => {}
        "media" => {
            scene.lights.retain(|light| !matches!(light.emitter, Emitter::Volume(_)));
            scene.renumber_lights();
            scene.materials.iter_mut().filter_map(|m| m.body.as_mut()).for_each(|body| body.medium = None);
        }
        other => return Err(Error::input(format!("the effect \"{other}\" cannot be forbidden"))),
    }
    Ok(())
}
