//! Each example scene calls for exactly the effects that scenes/README.md lists. Other effects
//! never happen.

use abbe::format::resolve;
use abbe::render::{Integrator, Job, NoMonitor, Rendered, Request, StopRules};
use std::path::{Path, PathBuf};

/// Returns the names of all example scenes in order.
pub(crate) fn names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let scenes = files.filter(|file| !file.ends_with(".schema.json"));
    let mut names: Vec<String> = scenes.filter_map(|file| Some(file.strip_suffix(".json")?.to_owned())).collect();
    names.sort();
    names
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Plans an example scene with some values changed.
pub(crate) fn job(name: &str, sets: &[&str]) -> Job {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Job::new(resolve::load(&folder().join(format!("{name}.json")), &sets).unwrap()).unwrap()
}

/// Renders a number of passes.
pub(crate) fn render(job: &Job, passes: u64) -> Rendered {
    let stop = StopRules { passes: Some(passes), ..StopRules::default() };
    job.render(Request { integrator: Integrator::Photon, stop }, &mut NoMonitor).unwrap()
}

/// Changes that make a scene quick to render: a small film and few photons.
pub(crate) const SMALL: [&str; 3] = ["film.width=32", "film.height=18", "render.photons=2000"];

#[test]
fn the_table_of_example_scenes_is_what_their_plans_say() {
    let readme = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let mut listed: Vec<&str> = Vec::new();
    for row in readme.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let name = cells[0].trim_matches('`');
        let job = job(name, &[]);
        let on: Vec<&str> = job.rows.iter().filter(|row| row.state.is_on()).map(|row| row.effect.name).collect();
        assert_eq!(cells[2], on.join(", "), "{name}");
        listed.push(name);
    }
    for name in names() {
        assert!(listed.contains(&name.as_str()), "{name} is not in the table");
    }
}

#[test]
fn effects_happen_exactly_where_the_plan_has_them() {
    for name in names() {
        let rendered = render(&job(&name, &SMALL), 2);
        assert_eq!(rendered.stats.rejected_samples, 0, "{name}");
        for (effect, found) in &rendered.stats.effects {
            let on = found.state == "on";
            assert!(on || found.events == 0, "{name}: {effect} {found:?}");
            assert!(!on || found.events > 0 || happens(&name, effect), "{name}: {effect} is on and never happens");
        }
    }
}

/// Tells whether an effect happens in a scene, with up to 200,000 photons. Through a lens, indirect
/// light is rare.
fn happens(name: &str, effect: &str) -> bool {
    [20_000, 200_000].into_iter().any(|photons| {
        let photons = format!("render.photons={photons}");
        let job = job(name, &[SMALL[0], SMALL[1], &photons]);
        render(&job, 2).stats.effects[effect].events > 0
    })
}
