//! Drawing wavelengths, and looking spectra and indices up.

use abbe_optics::glass::RefractiveIndex;
use abbe_spectra::spectrum::{Observer, Outside, SpectralLine, Spectrum, WavelengthDistribution, library};
use criterion::{Criterion, Throughput};
use std::hint::black_box;

/// Calls a benchmark makes in one round.
const ROUND: u64 = 10_000;

/// A number in [0, 1) that jumps about.
fn scattered(i: u64) -> f64 {
    (i as f64 * 0.618_033_988_749_894_9).fract()
}

pub(crate) fn benches(c: &mut Criterion) {
    let observer = Observer::cie1931();
    let daylight = library::find("D65").expect("D65 is in the library").spectrum;
    let line = |nm, power| SpectralLine { nm, power, fwhm_nm: None };
    let mercury: Vec<SpectralLine> =
        (0..12).map(|i| line(400.0 + 17.3 * f64::from(i), 1.0 + f64::from(i % 3))).collect();
    let lines = Spectrum::lines(&mercury).expect("lines");
    let red = Spectrum::table(&[360.0, 580.0, 600.0, 830.0], &[0.06, 0.06, 0.6, 0.6], Outside::Hold).expect("a table");
    let glass = RefractiveIndex::catalogue("N-BK7").expect("N-BK7 is in the catalogue");

    let mut group = c.benchmark_group("spectrum");
    group.throughput(Throughput::Elements(ROUND));
    for (name, spectrum) in [("daylight", &daylight), ("lines", &lines), ("constant", &Spectrum::constant(1.0))] {
        let distribution = WavelengthDistribution::visually_weighted(spectrum, observer).expect("a lit spectrum");
        group.bench_function(format!("draw a wavelength/{name}"), |b| {
            b.iter(|| (0..ROUND).map(|i| distribution.sample(scattered(i)).1).sum::<f64>());
        });
    }
    for (name, spectrum) in [("daylight", &daylight), ("lines", &lines), ("four knots", &red)] {
        group.bench_function(format!("value/{name}"), |b| {
            b.iter(|| (0..ROUND).map(|i| spectrum.at(360.0 + 470.0 * scattered(i))).sum::<f64>());
        });
    }
    group.bench_function("index of N-BK7", |b| {
        b.iter(|| (0..ROUND).map(|i| black_box(&glass).n(360.0 + 470.0 * scattered(i))).sum::<f64>());
    });
    group.bench_function("colour-matching functions", |b| {
        b.iter(|| (0..ROUND).map(|i| observer.xyz_bar(360.0 + 470.0 * scattered(i))[1]).sum::<f64>());
    });
    group.finish();
}
