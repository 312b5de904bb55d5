//! Forcing an effect that a scene does not call for costs time and has no visible influence.

use super::common::compare::{Measured, compare};
use super::common::{colour_blocks, example_job, example_names, render_job};
use super::example_scenes::SMALL;
use abbe_session::render::{Integrator, Rendered};
use abbe_transport::plan::EffectState;
use std::cell::LazyCell;

/// The number of renders, each with its own seed, and their passes.
const RUNS: u64 = 6;
const PASSES: u64 = 8;

/// Renders the scene with an effect forced, or with none.
fn rendered(name: &str, force: &str, photons: u64, seed: u64) -> Rendered {
    let sets = [("force", force.to_owned()), ("photons", photons.to_string()), ("seed", seed.to_string())];
    let sets = sets.map(|(key, value)| format!("render.{key}={value}"));
    let sets: Vec<&str> = SMALL[..2].iter().copied().chain(sets.iter().map(String::as_str)).collect();
    render_job(&example_job(name, &sets), Integrator::Photon, PASSES)
}

/// Returns X, Y and Z in a few blocks of the picture. A compressive curve keeps visible lights,
/// which are bright in few pixels, from dominating.
fn measured(name: &str, force: &str, first_seed: u64, typical: f64) -> Measured {
    let run = |seed: u64| {
        let mut rendered = rendered(name, force, 20_000, seed);
        rendered.picture.xyz.iter_mut().flatten().for_each(|value| *value /= *value + typical);
        colour_blocks(16)(&rendered)
    };
    Measured::from_runs((first_seed..first_seed + RUNS).map(run).collect())
}

/// Returns the absent effects that change the picture when forced. The comparison is bit for bit,
/// or statistical if the effect consumes other random numbers.
fn what_forcing_changes(name: &str) -> Vec<String> {
    let plain_job = example_job(name, &[]);
    let forbids = |effect: &str| plain_job.scene.settings.forbid.iter().any(|forbidden| forbidden == effect);
    // Diffraction is requested by the scene and not decided by the plan. Forcing it is visible.
    let is_absent =
        |effect: &str, state: EffectState| state == EffectState::Off && effect != "diffraction" && !forbids(effect);
    let absent = plain_job.rows.iter().filter(|row| is_absent(row.effect.name, row.state));
    let plain = rendered(name, "[]", 1000, 0).picture;
    let typical = {
        let mut y: Vec<f64> = plain.xyz.iter().map(|xyz| xyz[1]).collect();
        y.sort_by(f64::total_cmp);
        y[y.len() / 2].max(1e-3 * plain.mean_y())
    };
    let many = LazyCell::new(|| measured(name, "[]", 0, typical));
    let mut changed = Vec::new();
    for effect in absent.map(|row| row.effect.name) {
        let force = format!("[\"{effect}\"]");
        if rendered(name, &force, 1000, 0).picture == plain {
            println!("{name}, {effect} forced: the same bits");
            continue;
        }
        let found = compare(&many, &measured(name, &force, 100, typical));
        println!("{name}, {effect} forced: {found}; standard error {:.4}", many.relative_error());
        changed.extend((!found.is_equal()).then(|| format!("{name}, {effect}: {found}")));
    }
    changed
}

/// Light that is reflected totally does not split its path, or paths in a puddle would nest without
/// end.
#[test]
fn forced_polarisation_keeps_paths_in_a_puddle_from_splitting() {
    let sets = ["film.width=24", "film.height=15", "render.photons=20000", "render.force=[\"polarisation\"]"];
    let rendered = render_job(&example_job("oil_on_asphalt", &sets), Integrator::Photon, 8);
    assert!(rendered.picture.mean_y() > 0.0);
}

#[test]
#[ignore = "nightly: 30 seconds of CPU time"]
fn forced_effects_leave_a_diffuse_box_unchanged() {
    assert_eq!(what_forcing_changes("cornell"), Vec::<String>::new());
}

#[test]
#[ignore = "slow: ten minutes of CPU time for all scenes and effects"]
fn forcing_an_absent_effect_leaves_all_scenes_unchanged() {
    let changed: Vec<String> = example_names().iter().flat_map(|name| what_forcing_changes(name)).collect();
    assert!(changed.is_empty(), "{changed:#?}");
}
