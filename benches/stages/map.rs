//! The photon map: building it (on all threads) and asking it.

use super::scenes::Prepared;
use abbe_transport::map::PhotonMap;
use criterion::{Criterion, Throughput};
use std::num::NonZero;

const QUERIES: usize = 10_000;

pub(crate) fn benches(c: &mut Criterion) {
    // The diffuse box keeps about two photons a path; the floor of a bare scene would have only one
    // plane.
    let photons = Prepared::new("s3_box.json").harvest(200_000).indirect;
    let index = PhotonMap::build(&photons);
    let places: Vec<[f32; 3]> = photons.iter().step_by(photons.len() / QUERIES).take(QUERIES).map(|p| p.1).collect();
    let fifty = NonZero::new(50).expect("50 is not 0");
    // A radius that holds 50 photons in the middle.
    let mut distances: Vec<f32> =
        places.iter().filter_map(|&place| index.kth_distance(place, fifty, f32::INFINITY)).collect();
    distances.sort_by(f32::total_cmp);
    let radius = distances[distances.len() / 2];

    let mut group = c.benchmark_group("map");
    group.throughput(Throughput::Elements(photons.len() as u64));
    group.bench_function("build, all threads", |b| b.iter(|| PhotonMap::build(&photons).len()));
    group.throughput(Throughput::Elements(places.len() as u64));
    group.bench_function("50 within a radius", |b| {
        b.iter(|| {
            let mut sum = 0.0;
            places.iter().for_each(|&place| index.within(place, radius, |found| sum += found.distance2));
            sum
        });
    });
    group.bench_function("50 nearest", |b| {
        b.iter(|| places.iter().filter_map(|&place| index.kth_distance(place, fifty, f32::INFINITY)).sum::<f32>());
    });
    group.finish();
}
