//! Camera samples: the specular chain, lamps, and photons around the end.

use super::scenes::{Prepared, load};
use abbe::gather::{CameraNumbers, Direct, Gatherer, Maps, Outlines, PathTracer, RADIUS_KINDS, Scratch};
use abbe::map::LightMaps;
use abbe::map::radius::Scales;
use abbe::walk::{Sink, Tally};
use criterion::{Criterion, Throughput};

/// Every this many pixels one is sampled.
const STEP: usize = 7;

/// Adds all light up.
struct Total(f64);

impl Sink for Total {
    fn radiance(&mut self, _: f64, weight: f64) {
        self.0 += weight;
    }

    fn biased(&mut self, _: f64, weight: f64, _: f64) {
        self.0 += weight;
    }
}

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

fn gatherer<'a>(
    prepared: &'a Prepared,
    (maps, outlines, light_maps): (&'a Maps, &'a Outlines, &'a LightMaps<'a>),
) -> Gatherer<'a> {
    let wavelengths = [450.0, 520.0, 590.0, 650.0];
    Gatherer {
        scene: &prepared.scene,
        plan: &prepared.plan,
        direct: Direct::new(&prepared.scene, &prepared.choice.lights, prepared.plan.between),
        free: maps,
        shared: maps,
        shared_nm: wavelengths,
        shared_pdf: wavelengths.map(|nm| prepared.choice.wavelengths.pdf(nm)),
        glass: None,
        light_maps,
        outlines,
        scales: Scales::of_pass(0),
        radius_m: None,
        max_depth: 64,
    }
}
