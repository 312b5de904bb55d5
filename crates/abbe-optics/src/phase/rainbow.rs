//! The phase function of rain, which `data/media/rainbow.csv` holds from the series of
//! [`mie`](super::mie).
//!
//! The drops are water at 20 °C in air. Their radii follow a lognormal distribution with a median
//! of 0.4 mm and a standard deviation of ln r of 0.26, cut off at 3.5 standard deviations, so that
//! they lie between 0.16 and 1 mm. The table is for parallel light. A light with the angular size
//! of the sun blurs the rendered bows as in the sky.

use super::table::{self, PhaseTable, Spheres};
use crate::glass::RefractiveIndex;
use abbe_spectra::math::elementary::{asin, exp};
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

/// Returns the phase function of rain.
pub fn rainbow() -> Arc<PhaseTable> {
    static TABLE: OnceLock<Arc<PhaseTable>> = OnceLock::new();
    TABLE
        .get_or_init(|| {
            let table =
                table::parse(include_str!("../../data/media/rainbow.csv")).expect("the built-in table is valid");
            Arc::new(table.of_spheres(Spheres::Rain))
        })
        .clone()
}

/// Returns the elements S12, S33 and S34 of the phase matrix, divided by S11, at each angle.
///
/// The polarisation of large drops follows from geometrical optics: rays that are reflected outside,
/// or leave after up to four internal reflections, and the light that is diffracted forwards, which
/// keeps its polarisation. The powers of the rays add. Near a bow, the ray of least deviation
/// dominates (Können, *Polarized Light in Nature*, §39).
pub(super) fn ratios(nm: f64, angles_deg: &[f64]) -> Vec<[f32; 3]> {
    /// The width in degrees of the bins in which the rays are counted.
    const BIN_DEG: f64 = 0.25;
    /// The light in half of the extinction is diffracted within about this angle.
    const DIFFRACTED_DEG: f64 = 0.5;
    const BINS: usize = (180.0 / BIN_DEG) as usize;
    const RAYS: u32 = 40_000;
    const REFLECTIONS: u32 = 4;
    static WATER: OnceLock<RefractiveIndex> = OnceLock::new();
    let n = WATER.get_or_init(|| RefractiveIndex::catalogue("water 20C").expect("water is in the catalogue")).n(nm);
    // The powers of s and p, and the product of the amplitudes.
    let mut bins = vec![[0.0; 3]; BINS];
    let mut add = |deviation: f64, [s, p]: [f64; 2]| {
        let folded = deviation.rem_euclid(TAU);
        let angle = folded.min(TAU - folded).to_degrees();
        let bin = &mut bins[((angle / BIN_DEG) as usize).min(BINS - 1)];
        [s * s, p * p, s * p].into_iter().zip(bin).for_each(|(value, sum)| *sum += value);
    };
    for ray in 0..RAYS {
        // Rays of equal power.
        let sin_i = ((f64::from(ray) + 0.5) / f64::from(RAYS)).sqrt();
        let (cos_i, sin_t) = ((1.0 - sin_i * sin_i).sqrt(), sin_i / n);
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        let (incidence, refraction) = (asin(sin_i), asin(sin_t));
        let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
        let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
        add(PI - 2.0 * incidence, [s, p]);
        // Inside, both amplitudes have the opposite sign, so the powers that enter and leave are
        // those that are not reflected.
        let mut amplitudes = [1.0 - s * s, 1.0 - p * p];
        for reflections in 0..=REFLECTIONS {
            let k = f64::from(reflections);
            add(2.0 * (incidence - refraction) + k * (PI - 2.0 * refraction), amplitudes);
            amplitudes = [amplitudes[0] * -s, amplitudes[1] * -p];
        }
    }
    let diffracted = f64::from(RAYS);
    angles_deg
        .iter()
        .map(|&angle| {
            let bin = ((angle / BIN_DEG) as usize).min(BINS - 1);
            let forward = diffracted * exp(-(angle / DIFFRACTED_DEG).powi(2));
            let [s, p, cross] = bins[bin].map(|sum| sum + forward);
            let all = (s + p).max(f64::MIN_POSITIVE);
            [((p - s) / all) as f32, (2.0 * cross / all) as f32, 0.0]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::mie::{MieSpheres, lognormal};
    use super::super::{Deflection, PhaseFunction};
    use super::*;
    use crate::glass::RefractiveIndex;
    use std::fmt::Write;

    fn rain() -> MieSpheres {
        MieSpheres { radii_um: lognormal(400.0, 0.26, 100), index: RefractiveIndex::catalogue("water 20C").unwrap() }
    }

    /// In multiples of 0.001°: densest in the forward peak, and dense in bows and glory.
    fn angles() -> Vec<f64> {
        let forward = [(0, 40, 1), (40, 200, 4), (200, 2000, 30), (2000, 10_000, 200)];
        let bows = [(10_000, 120_000, 1000), (120_000, 150_000, 50), (150_000, 178_000, 500), (178_000, 180_000, 100)];
        let steps = |&(from, to, step): &(u32, u32, usize)| (from..to).step_by(step);
        let thousandths = forward.iter().chain(&bows).flat_map(steps).chain([180_000]);
        thousandths.map(|thousandths| f64::from(thousandths) / 1000.0).collect()
    }

    /// Returns one column of the table. From 5° to 179°, each value is the mean over five angles
    /// within 0.1°, which removes the ripples that the average over the drop sizes leaves.
    fn column(nm: f64) -> Vec<f64> {
        let angles = angles();
        let places = angles.iter().flat_map(|&angle| {
            let step = if angle > 5.0 && angle < 179.0 { 0.02 } else { 0.0 };
            (-2..=2).map(move |i| angle + f64::from(i) * step)
        });
        let pdf_per_sr = rain().scattering(nm, &places.collect::<Vec<_>>()).pdf_per_sr;
        pdf_per_sr.chunks(5).map(|places| places.iter().sum::<f64>() / 5.0).collect()
    }

    #[test]
    #[ignore = "minutes: sums series of thousands of terms; with ABBE_BLESS it writes the table"]
    fn built_in_rainbow_table_matches_the_mie_series() {
        let bless = std::env::var_os("ABBE_BLESS").is_some();
        let nm: Vec<f64> = (360..=830).step_by(if bless { 20 } else { 160 }).map(f64::from).chain([830.0]).collect();
        let (first, second) = nm.split_at(nm.len() / 2);
        let half = |nm: &[f64]| nm.iter().map(|&nm| column(nm)).collect::<Vec<_>>();
        let columns = std::thread::scope(|scope| {
            let other = scope.spawn(|| half(second));
            [half(first), other.join().unwrap()].concat()
        });
        if !bless {
            for (nm, column) in nm.iter().zip(&columns) {
                let table = PhaseFunction::Table(rainbow());
                for (angle, pdf_per_sr) in angles().into_iter().zip(column).step_by(7) {
                    // They are normalised separately, and the table is rounded to five digits.
                    let found = table.eval(Deflection::horizontal(angle.to_radians().cos()), *nm);
                    assert!((found / pdf_per_sr - 1.0).abs() < 0.02, "{angle}° {nm} nm: {found}, {pdf_per_sr}");
                }
            }
            return;
        }
        let mut text = String::from("angle_deg");
        nm.iter().for_each(|nm| write!(text, ",p_{nm}nm_per_sr").unwrap());
        for (i, angle) in angles().iter().enumerate() {
            write!(text, "\n{angle}").unwrap();
            for column in &columns {
                let digits = format!("{:.4e}", column[i]);
                write!(text, ",{}", digits.parse::<f64>().unwrap()).unwrap();
            }
        }
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/media/rainbow.csv");
        std::fs::write(path, text + "\n").unwrap();
    }
}
