//! What planning saves: for every example scene and every effect that it does not call for, the
//! time with the effect forced over the time without. `cargo bench --bench forced` prints the table
//! of `benches/README.md`; names after `--` choose scenes.

use std::path::Path;
use std::time::Duration;

use abbe_format::resolve;
use abbe_session::render::{Integrator, Job, NoMonitor, Request, StopRules, on_threads};
use abbe_transport::plan::{EffectRow, EffectState};
use cpu_time::ProcessTime;

/// Large enough for rays to matter, small enough for the whole table in minutes.
const SIZE: [&str; 3] = ["film.width=96", "film.height=54", "render.photons=20000"];
const PASSES: u64 = 4;

/// Of some runs the fastest counts, since other work only slows them down.
const RUNS: usize = 3;

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files =
        std::fs::read_dir(&folder).expect("the example scenes are there").map(|entry| entry.expect("a file").path());
    let named = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut scenes: Vec<_> =
        files.filter(|path| named(path).ends_with(".json") && !named(path).ends_with(".schema.json")).collect();
    scenes.sort();
    scenes.retain(|path| chosen.is_empty() || chosen.iter().any(|name| named(path) == format!("{name}.json")));

    let effects: Vec<&str> = abbe_transport::plan::EFFECTS.iter().map(|effect| effect.name).collect();
    println!("| scene | CPU s | {} |\n| --- |{}", effects.join(" | "), " --- |".repeat(effects.len() + 1));
    for path in scenes {
        println!("{}", row(&path, named(&path).trim_end_matches(".json")));
    }
}

fn row(path: &Path, name: &str) -> String {
    let plain = job(path, None).expect("an example scene can be planned");
    let is_off = |state: EffectState| state == EffectState::Off;
    let forced: Vec<Option<Job>> =
        plain.rows.iter().map(|row| is_off(row.state).then(|| job(path, Some(row.effect.name)))?).collect();
    let mut fastest = vec![Duration::MAX; 1 + forced.len()];
    for _ in 0..RUNS {
        fastest[0] = fastest[0].min(spent(&plain));
        for (fastest, job) in fastest[1..].iter_mut().zip(&forced) {
            *fastest = job.as_ref().map_or(*fastest, |job| spent(job).min(*fastest));
        }
    }
    let seconds = fastest[0].as_secs_f64();
    let cell = |((job, fastest), row): ((&Option<Job>, &Duration), &EffectRow)| match job {
        Some(_) => format!("{:.2}", fastest.as_secs_f64() / seconds),
        None if is_off(row.state) => "–".to_owned(),
        None => "on".to_owned(),
    };
    let cells: Vec<String> = forced.iter().zip(&fastest[1..]).zip(&plain.rows).map(cell).collect();
    format!("| {name} | {seconds:.2} | {} |", cells.join(" | "))
}

/// The scene as a small picture, planned with an effect forced; `None` where that cannot be (a
/// pinhole diffracts nothing).
fn job(path: &Path, force: Option<&str>) -> Option<Job> {
    let force = force.map(|effect| format!("render.force=[\"{effect}\"]"));
    let sets: Vec<String> = SIZE.iter().map(|set| (*set).to_owned()).chain(force).collect();
    Job::new(resolve::load(path, &sets).expect("an example scene is valid")).ok()
}

/// The processor's time for a render, its pilot included.
fn spent(job: &Job) -> Duration {
    let request =
        Request { integrator: Integrator::Photon, stop: StopRules { passes: Some(PASSES), ..StopRules::default() } };
    let start = ProcessTime::now();
    on_threads(Some(1), || job.render(request, &mut NoMonitor)).expect("threads start").expect("the scene renders");
    start.elapsed()
}
