//! Camera samples: the specular chain, lamps, and photons around the end.

use super::scenes::{Prepared, Total, camera_pass, load};
use abbe_spectra::math::random::{Purpose, Seed};
use abbe_transport::gather::{DirectLighting, PathBuffers, PathTracer, PixelSampler, SurfaceExtents};
use abbe_transport::map::{LightMaps, PixelRadii};
use abbe_transport::plan::Tally;
use abbe_transport::walk::NEVER_STOP;
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
        let (surface_extents, light_maps) = (SurfaceExtents::default(), LightMaps::default());
        let camera_pass = camera_pass(&prepared, (&maps, &surface_extents, &light_maps));
        // Kernels of about 50 photons; the exact radii of a render are its pilot's.
        let radii = PixelRadii::splat(0.05);
        group.bench_function(format!("photon maps/{name}"), |b| {
            b.iter(|| {
                let (mut buffers, mut tally, mut total) = (PathBuffers::default(), Tally::default(), Total(0.0));
                for &pixel in &pixels {
                    let sampler = PixelSampler::new(Seed::new(1).streams(Purpose::Camera), 0, pixel);
                    camera_pass.sample(pixel, sampler, &radii, &mut buffers, &mut tally, &mut total);
                }
                total.0
            });
        });
    }
    let prepared = Prepared::new("s3_box.json");
    let scene = load("s3_box.json", &[]);
    let direct = DirectLighting::new(&scene, &prepared.selector, prepared.plan.media_plan);
    let (wavelengths, media_plan) = (&prepared.choice.wavelengths, prepared.plan.media_plan);
    let tracer = PathTracer {
        scene: &scene,
        direct,
        wavelengths,
        spectra: &prepared.spectra,
        excitation: &[],
        media_plan,
        polarised: prepared.plan.polarisation.is_on(),
        stokes: prepared.plan.polarisation.records_stokes(),
        stop: &NEVER_STOP,
    };
    let pixels: Vec<u64> = (0..scene.camera.pixel_count() as u64).step_by(STEP).collect();
    group.throughput(Throughput::Elements(pixels.len() as u64));
    group.bench_function("path tracer/s3_box", |b| {
        b.iter(|| {
            let (mut tally, mut total) = (Tally::default(), Total(0.0));
            pixels.iter().for_each(|&pixel| {
                tracer.sample(
                    pixel,
                    PixelSampler::new(Seed::new(1).streams(Purpose::Camera), 0, pixel),
                    &mut tally,
                    &mut total,
                );
            });
            total.0
        });
    });
    group.finish();
}
