//! The example scenes: each calls for the effects that scenes/README.md says, and no others; the others never happen.

use abbe::render::{Integrator, Job, Rendered, Request, StopRules, Unwatched};
use abbe::scene::resolve;
use std::path::{Path, PathBuf};

/// The names of all example scenes, in order.
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

/// An example scene with some of its values changed, planned.
pub(crate) fn job(name: &str, sets: &[&str]) -> Job {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Job::new(resolve::load(&folder().join(format!("{name}.json")), &sets).unwrap()).unwrap()
}

/// Renders some passes.
pub(crate) fn render(job: &Job, passes: u64) -> Rendered {
    let stop = StopRules { passes: Some(passes), ..StopRules::default() };
    job.render(Request { integrator: Integrator::Photon, stop }, &mut Unwatched).unwrap()
}

/// A stamp of a picture, by few photons: quick.
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
fn what_a_scene_does_not_call_for_never_happens_and_what_it_calls_for_does() {
    for name in names() {
        let rendered = render(&job(&name, &SMALL), 2);
        assert_eq!(rendered.stats.rejected_samples, 0, "{name}");
        for (effect, found) in &rendered.stats.effects {
            // Of so few photons none comes back to the screen through the lens.
            let rare = name == "chromatic_aberration" && effect == "indirect";
            assert_eq!(found.events > 0, found.state == "on" && !rare, "{name}: {effect} {found:?}");
        }
    }
}
