//! Each example scene calls for exactly the effects that scenes/README.md lists. Other effects
//! never happen.

use super::common::{example_job, example_names, render_job};
use abbe_session::render::Integrator;
use std::path::Path;

/// Changes that make a scene quick to render: a small film and few photons.
pub(crate) const SMALL: [&str; 3] = ["film.width=32", "film.height=18", "render.photons=2000"];

/// Effects of which the pilot chooses whether they happen.
const PILOT_CHOOSES: [&str; 1] = ["final-gather"];

#[test]
fn the_table_of_example_scenes_is_what_their_plans_say() {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/README.md")).unwrap();
    let mut listed: Vec<&str> = Vec::new();
    for row in readme.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let name = cells[0].trim_matches('`');
        let job = example_job(name, &[]);
        let on: Vec<&str> = job.rows.iter().filter(|row| row.state.is_on()).map(|row| row.effect.name).collect();
        assert!(cells[1].contains(&format!("/{name}.png")), "{name} has no picture");
        assert_eq!(cells[3], on.join(", "), "{name}");
        listed.push(name);
    }
    for name in example_names() {
        assert!(listed.contains(&name.as_str()), "{name} is not in the table");
    }
}

#[test]
fn effects_happen_exactly_where_the_plan_has_them() {
    for name in example_names() {
        let rendered = render_job(&example_job(&name, &SMALL), Integrator::Photon, 1);
        assert_eq!(rendered.stats.rejected_samples, 0, "{name}");
        for (effect, found) in &rendered.stats.effects {
            let on = found.state == "on";
            assert!(on || found.events == 0, "{name}: {effect} {found:?}");
            let occurs = || found.events > 0 || happens(&name, effect);
            assert!(!on || PILOT_CHOOSES.contains(&effect.as_str()) || occurs(), "{name}: {effect} never happens");
        }
    }
}

/// Tells whether an effect happens in a scene, with up to 200,000 photons. Through a lens, indirect
/// light is rare.
fn happens(name: &str, effect: &str) -> bool {
    [20_000, 200_000].into_iter().any(|photons| {
        let photons = format!("render.photons={photons}");
        let job = example_job(name, &[SMALL[0], SMALL[1], &photons]);
        render_job(&job, Integrator::Photon, 2).stats.effects[effect].events > 0
    })
}
