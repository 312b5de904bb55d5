//! How long each stage of the pipeline takes, on one thread unless a name says otherwise. `cargo
//! bench` runs them all in about two minutes; `cargo bench emit` those whose names contain "emit".
//! Figures stand in `benches/README.md`.

mod emit;
mod gather;
mod geometry;
mod map;
mod scenes;
mod sensor;
mod spectrum;
mod whole;

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;

/// Few samples of short runs: enough for ten per cent.
fn quick() -> Criterion {
    Criterion::default()
        .sample_size(12)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
}

criterion_group! {
    name = stages;
    config = quick();
    targets = spectrum::benches, geometry::benches, emit::benches, map::benches, gather::benches, sensor::benches,
        whole::benches
}
criterion_main!(stages);
