//! The film: exposing it, adding splats, developing it, and showing the picture on a screen.

use abbe_spectra::colour::RgbSpace;
use abbe_spectra::spectrum::Observer;
use abbe_transport::sensor::{Development, Film, Picture, develop};
use criterion::{Criterion, Throughput};

const SIDE: usize = 256;
const SPLATS: u32 = 100_000;

pub(crate) fn benches(c: &mut Criterion) {
    let mut film = Film::new(SIDE, SIDE, Observer::cie1931(), 0);
    let pixels = (SIDE * SIDE) as u64;
    let mut group = c.benchmark_group("sensor");
    group.throughput(Throughput::Elements(pixels));
    group.bench_function("expose a pixel to four wavelengths", |b| {
        b.iter(|| {
            for mut row in film.rows() {
                let exposed = row.expose(|pixel, sink| {
                    (0..4).for_each(|k| sink.radiance((0, 0), 430.0 + 60.0 * f64::from(k), pixel as f64));
                    1
                });
                row.add(0, &exposed);
            }
        });
    });
    film.count_pass(0);
    film.count_pass(1);
    group.bench_function("develop a pixel", |b| b.iter(|| film.picture().mean_y()));
    group.throughput(Throughput::Elements(u64::from(SPLATS)));
    group.bench_function("splat four wavelengths", |b| {
        b.iter(|| {
            let mut sink = film.splat_sink();
            for i in 0..SPLATS {
                let pixel = i.wrapping_mul(2_654_435_761) % pixels as u32;
                sink.splat((0, 0), pixel, (0..4).map(|k| (430.0 + 60.0 * f64::from(k), 1.0)));
            }
            film.add_splats(1, &sink)
        });
    });
    group.finish();
    screens(c);
}

/// A picture of 3840 × 2160 for a screen, on all threads: from black to twice as bright as white, a
/// tenth of it outside sRGB.
fn screens(c: &mut Criterion) {
    let (width, height) = (3840, 2160);
    let mut picture = Picture::black(width, height);
    for (i, xyz) in picture.xyz.iter_mut().enumerate() {
        let y = 2.0 * (i % width) as f64 / width as f64;
        let violet = if i % 10 == 0 { 3.0 } else { 1.0 };
        *xyz = [0.95 * y * violet, y, 1.09 * y * violet];
    }
    let mut group = c.benchmark_group("sensor");
    group.throughput(Throughput::Elements((width * height) as u64));
    for space in RgbSpace::ALL {
        let development = Development { space, ..Development::default() };
        group.bench_function(format!("4K picture for a screen/{}", space.name()), |b| {
            b.iter(|| develop(&picture, 1.0, &development));
        });
    }
    group.finish();
}
