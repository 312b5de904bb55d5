//! Camera samples: the specular chain, lamps, and photons around the end.

use super::scenes::{Prepared, Total, gatherer, load};
use abbe::gather::{CameraNumbers, Direct, Outlines, PathTracer, RADIUS_KINDS, Scratch};
use abbe::map::LightMaps;
use abbe::walk::Tally;
use criterion::{Criterion, Throughput};

/// Every this many pixels one is sampled.
const STEP: usize = 7;

pub(crate) fn benches(c: &mut Criterion) {
    let mut group = c.benchmark_group("gather");
    for name in ["s1_ball", "s2_prism", "s3_box"] {
        let prepared = Prepared::new(&format!("{name}.json"));
        let pixels: Vec<u64> = (0..prepared.scene.camera.pixel_count() as u64).step_by(STEP).collect();
        group.throughput(Throughput::Elements(pixels.len() as u64));
        let maps = prepared.harvest(100_000).maps();
        let (outlines, light_maps) = (Outlines::default(), LightMaps::default());
        let gatherer = gatherer(&prepared, (&maps, &outlines, &light_maps));
        // Kernels of about 50 photons; the exact radii of a render are its pilot's.
        let radii = [0.05_f32; RADIUS_KINDS];
        group.bench_function(format!("photon maps/{name}"), |b| {
            b.iter(|| {
                let (mut scratch, mut tally, mut total) = (Scratch::default(), Tally::default(), Total(0.0));
                for &pixel in &pixels {
                    let numbers = CameraNumbers::new(1, 0, pixel);
                    gatherer.sample(pixel, numbers, &radii, (&mut scratch, &mut tally), &mut total);
                }
                total.0
            });
        });
    }
    let prepared = Prepared::new("s3_box.json");
    let scene = load("s3_box.json", &[]);
    let direct = Direct::new(&scene, &prepared.choice.lights, prepared.plan.between);
    let (wavelengths, between) = (&prepared.choice.wavelengths, prepared.plan.between);
    let tracer = PathTracer { scene: &scene, direct, wavelengths, max_depth: 64, between };
    let pixels: Vec<u64> = (0..scene.camera.pixel_count() as u64).step_by(STEP).collect();
    group.throughput(Throughput::Elements(pixels.len() as u64));
    group.bench_function("path tracer/s3_box", |b| {
        b.iter(|| {
            let (mut tally, mut total) = (Tally::default(), Total(0.0));
            pixels.iter().for_each(|&pixel| {
                tracer.sample(pixel, CameraNumbers::new(1, 0, pixel), &mut tally, &mut total);
            });
            total.0
        });
    });
    group.finish();
}
