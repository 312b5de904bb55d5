//! Whole renders, pilot included, on all threads: a tiny one, and the preview of a million photons.

use super::scenes::load;
use abbe_session::render::{Integrator, Job, NoMonitor, Request, StopRules};
use criterion::Criterion;

fn render(job: &Job, integrator: Integrator, passes: u64) -> f64 {
    let request = Request { integrator, stop: StopRules { passes: Some(passes), ..StopRules::default() } };
    job.render(request, &mut NoMonitor).expect("a benchmark scene renders").picture.mean_y()
}

pub(crate) fn benches(c: &mut Criterion) {
    let mut group = c.benchmark_group("render");
    let tiny = ["film.width=64", "film.height=64", "render={\"photons\": 10000}"];
    for (name, integrator) in [("photon", Integrator::Photon), ("path", Integrator::Path)] {
        let job = Job::new(load("s3_box.json", &tiny)).expect("a benchmark scene can be planned");
        group.bench_function(format!("64 × 64, 4 passes, {name}"), |b| b.iter(|| render(&job, integrator, 4)));
    }
    let preview = ["render={\"photons\": 250000}"];
    let job = Job::new(load("s1_ball.json", &preview)).expect("a benchmark scene can be planned");
    group.sample_size(10);
    group.bench_function("preview of s1_ball, 256 × 256, a million photons", |b| {
        b.iter(|| render(&job, Integrator::Photon, 4));
    });
    group.finish();
}
