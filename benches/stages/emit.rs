//! Photons from the lamp to their end, with the real materials and spectra; kept for the maps, not
//! connected to the camera.

use super::scenes::Prepared;
use criterion::{Criterion, Throughput};

const PHOTONS: u64 = 20_000;

pub(crate) fn benches(c: &mut Criterion) {
    let mut group = c.benchmark_group("emit");
    group.throughput(Throughput::Elements(PHOTONS));
    for name in ["s1_ball", "s2_prism", "s3_box"] {
        let prepared = Prepared::new(&format!("{name}.json"));
        group.bench_function(name, |b| b.iter(|| prepared.harvest(PHOTONS).indirect.len()));
    }
    group.finish();
}
