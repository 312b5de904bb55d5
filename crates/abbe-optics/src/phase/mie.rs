//! Lorenz–Mie scattering by spheres, tabulated over angles and wavelengths.
//!
//! The series follows Bohren & Huffman 1983, chapter 4 and appendix A. The logarithmic derivative
//! D_n(mx) is computed by downward recurrence, and the Riccati–Bessel functions ψ_n(x) and χ_n(x)
//! by upward recurrence. The number of terms follows from the size parameter of each sphere. The
//! spheres do not absorb, because a drop of water absorbs less than 10⁻⁴ of visible light.

use super::table::{PhaseTable, Spheres};
use crate::glass::RefractiveIndex;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{cbrt, cos, exp, ln, sin_cos};
use abbe_spectra::spectrum::BAND_NM;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, Mutex, OnceLock};

/// Spheres with a distribution of radii.
#[derive(Debug, Clone, PartialEq)]
pub struct MieSpheres {
    /// Pairs of a radius in µm and the fraction of the spheres that have this radius.
    pub radii_um: Vec<(f64, f64)>,
    /// Refractive index of the spheres relative to the surrounding medium.
    pub index: RefractiveIndex,
}

/// Scattering by spheres at one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct MieScattering {
    /// Density per steradian at the requested angles.
    pub pdf_per_sr: Vec<f64>,
    /// Mean scattering cross-section in µm².
    pub cross_section_um2: f64,
    /// Mean of cos θ.
    pub mean_cosine: f64,
}

/// The elements of the phase matrix of spheres per steradian in the notation of Bohren & Huffman
/// 1983 (equation 4.77). Their first axis lies in the scattering plane, and fields vary as
/// exp(−iωt).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MieMatrix {
    /// The density (|S₂|² + |S₁|²)/2.
    pub s11: f64,
    /// (|S₂|² − |S₁|²)/2.
    pub s12: f64,
    /// Re(S₁S₂*).
    pub s33: f64,
    /// Im(S₂S₁*).
    pub s34: f64,
}

/// Largest size parameter 2πr/λ. The series of larger spheres would take minutes.
const MAX_SIZE_PARAMETER: f64 = 1000.0;

/// Number of radius steps of a distribution, and its half-width in standard deviations of ln r.
const RADIUS_STEPS: i32 = 100;
const RADIUS_RANGE_SIGMAS: f64 = 3.5;

const TABLE_STEPS: u32 = 16;

/// The coefficients of the series at one size parameter, as real and imaginary parts: `sums`
/// contains w_n·(a_n + b_n), and `differences` w_n·(a_n − b_n), with w_n = (2n + 1)/(n(n + 1)).
struct MieSeries {
    sums: Vec<[f64; 2]>,
    differences: Vec<[f64; 2]>,
    /// Σ (2n + 1)(|a_n|² + |b_n|²), proportional to the scattering cross-section.
    scattering_sum: f64,
    /// The mean cosine times `scattering_sum`.
    asymmetry_sum: f64,
}

impl MieSpheres {
    /// Creates spheres from their median radius in µm and relative index. The radii are lognormal
    /// with the geometric standard deviation `spread`, or equal without it. Returns an error if the
    /// spread is below 1, or the largest size parameter exceeds 1000.
    pub fn new(radius_um: f64, spread: Option<f64>, index: RefractiveIndex) -> Result<Self> {
        let spread = spread.unwrap_or(1.0);
        if !(spread >= 1.0 && spread.is_finite()) {
            let error = Error::input(format!("found a spread of {spread}"));
            return Err(error.expected("a geometric standard deviation of at least 1, such as 1.35"));
        }
        let radii_um = lognormal(radius_um, ln(spread), RADIUS_STEPS);
        let largest = size_parameter(radii_um[radii_um.len() - 1].0, BAND_NM.0);
        if largest > MAX_SIZE_PARAMETER {
            let limit = MAX_SIZE_PARAMETER * BAND_NM.0 * 1e-3 / TAU;
            let error = Error::input(format!("found spheres of up to {:.4} µm", radii_um[radii_um.len() - 1].0));
            return Err(error.expected(format!("at most {limit:.0} µm, or \"rainbow\" for drops of rain")));
        }
        Ok(Self { radii_um, index })
    }

    /// Returns the phase function over the band, from a cache of the process, because scenes may be
    /// read repeatedly. Spheres of [`new`](Self::new) give no error.
    pub fn table(&self) -> Result<Arc<PhaseTable>> {
        static KNOWN: OnceLock<Mutex<HashMap<String, Arc<PhaseTable>>>> = OnceLock::new();
        let key = format!("{self:?}");
        let known = KNOWN.get_or_init(Mutex::default);
        let found = known.lock().ok().and_then(|known| known.get(&key).cloned());
        if let Some(table) = found {
            return Ok(table);
        }
        let angles = self.angles_deg();
        let step = (BAND_NM.1 - BAND_NM.0) / f64::from(TABLE_STEPS);
        let nm: Vec<f64> = (0..=TABLE_STEPS).map(|i| BAND_NM.0 + f64::from(i) * step).collect();
        let values: Vec<Vec<f64>> = nm.iter().map(|&nm| self.scattering(nm, &angles).pdf_per_sr).collect();
        let table = Arc::new(
            PhaseTable::new(&angles, &nm, &values)?.of_spheres(Spheres::Mie(self.radii_um.clone(), self.index.clone())),
        );
        if let Ok(mut known) = known.lock() {
            known.insert(key, table.clone());
        }
        Ok(table)
    }

    /// Returns the angles of the table in degrees, in steps that resolve the forward peak and the
    /// ripples. For the size parameter x of the mean radius at the shortest wavelength, the width
    /// of the peak is proportional to 1/x, and the period of the ripples is π/x.
    fn angles_deg(&self) -> Vec<f64> {
        let mean_um: f64 = self.radii_um.iter().map(|(radius, fraction)| radius * fraction).sum();
        let x = size_parameter(mean_um, BAND_NM.0);
        let ripple = (20.0 / x).min(1.0);
        let mut angles = vec![0.0];
        let mut angle: f64 = 0.0;
        while angle < 180.0 {
            // `ripple` is at most one ninth of the period of the ripples. The step grows from a
            // tenth of it in the peak to the whole at angles above 10·`ripple`.
            let step = ripple * (angle / (10.0 * ripple)).clamp(0.1, 1.0);
            angle = if angle + 1.5 * step >= 180.0 { 180.0 } else { angle + step };
            angles.push(angle);
        }
        angles
    }

    /// Computes the scattering at a wavelength in nm and at angles in degrees.
    pub fn scattering(&self, nm: f64, angles_deg: &[f64]) -> MieScattering {
        let cosines: Vec<f64> = angles_deg.iter().map(|degrees| cos(degrees.to_radians())).collect();
        let mut intensity = vec![0.0; cosines.len()];
        let (mut scattering_sum, mut asymmetry_sum) = (0.0, 0.0);
        for &(radius_um, fraction) in &self.radii_um {
            let series = MieSeries::new(size_parameter(radius_um, nm), self.index.n(nm));
            scattering_sum += fraction * series.scattering_sum;
            asymmetry_sum += fraction * series.asymmetry_sum;
            for (cosines, intensity) in cosines.chunks(ANGLE_LANES).zip(intensity.chunks_mut(ANGLE_LANES)) {
                let mut lanes = [1.0; ANGLE_LANES];
                lanes[..cosines.len()].copy_from_slice(cosines);
                let found = series.intensity(&lanes);
                intensity.iter_mut().zip(found).for_each(|(sum, here)| *sum += fraction * here);
            }
        }
        // The pdf is (|S₁|² + |S₂|²)/(2k²) over the cross-section `scattering_sum`·2π/k².
        let pdf_per_sr = intensity.iter().map(|intensity| intensity / (4.0 * PI * scattering_sum)).collect();
        let wavelength_um = nm * 1e-3;
        let cross_section_um2 = wavelength_um * wavelength_um / TAU * scattering_sum;
        MieScattering { pdf_per_sr, cross_section_um2, mean_cosine: asymmetry_sum / scattering_sum }
    }

    /// Computes the phase matrix at a wavelength in nm and at angles in degrees. The element `s11`
    /// is the density of [`scattering`](Self::scattering).
    pub fn phase_matrix(&self, nm: f64, angles_deg: &[f64]) -> Vec<MieMatrix> {
        let cosines: Vec<f64> = angles_deg.iter().map(|degrees| cos(degrees.to_radians())).collect();
        let mut matrices = vec![MieMatrix::default(); cosines.len()];
        let mut scattering_sum = 0.0;
        for &(radius_um, fraction) in &self.radii_um {
            let series = MieSeries::new(size_parameter(radius_um, nm), self.index.n(nm));
            scattering_sum += fraction * series.scattering_sum;
            for (cosines, matrices) in cosines.chunks(ANGLE_LANES).zip(matrices.chunks_mut(ANGLE_LANES)) {
                let mut lanes = [1.0; ANGLE_LANES];
                lanes[..cosines.len()].copy_from_slice(cosines);
                let parts = series.amplitudes(&lanes);
                matrices.iter_mut().enumerate().for_each(|(i, sum)| sum.add(fraction, parts.map(|part| part[i])));
            }
        }
        matrices.iter_mut().for_each(|matrix| matrix.scale(1.0 / (TAU * scattering_sum)));
        matrices
    }
}

impl MieMatrix {
    /// Adds spheres with the real and imaginary parts of S₁ + S₂ and S₁ − S₂.
    fn add(&mut self, fraction: f64, [sum_re, sum_im, difference_re, difference_im]: [f64; 4]) {
        let quarter = 0.25 * fraction;
        let (sum, difference) = ([sum_re, sum_im], [difference_re, difference_im]);
        self.s11 += quarter * (square(sum) + square(difference));
        self.s12 -= 2.0 * quarter * dot(sum, difference);
        self.s33 += quarter * (square(sum) - square(difference));
        self.s34 += 2.0 * quarter * (sum_im * difference_re - sum_re * difference_im);
    }

    fn scale(&mut self, factor: f64) {
        for element in [&mut self.s11, &mut self.s12, &mut self.s33, &mut self.s34] {
            *element *= factor;
        }
    }
}

fn size_parameter(radius_um: f64, nm: f64) -> f64 {
    TAU * radius_um / (nm * 1e-3)
}

/// Returns radii and their fractions, which sum to 1. The values of ln r are evenly spaced in
/// `steps` steps over [`RADIUS_RANGE_SIGMAS`]·`sigma` on both sides of the median's.
pub(super) fn lognormal(median_um: f64, sigma: f64, steps: i32) -> Vec<(f64, f64)> {
    if sigma == 0.0 {
        return vec![(median_um, 1.0)];
    }
    let deviation = |i: i32| RADIUS_RANGE_SIGMAS * (2.0 * f64::from(i) / f64::from(steps) - 1.0);
    let fraction = |z: f64| exp(-0.5 * z * z);
    let sum: f64 = (0..=steps).map(|i| fraction(deviation(i))).sum();
    (0..=steps).map(deviation).map(|z| (median_um * exp(sigma * z), fraction(z) / sum)).collect()
}

/// Number of angles for which the series is summed together.
const ANGLE_LANES: usize = 8;

impl MieSeries {
    fn new(x: f64, m: f64) -> Self {
        let terms = (x + 4.05 * cbrt(x) + 2.0).ceil() as usize;
        let derivative = log_derivatives(m * x, terms);
        // The recurrences start with ψ₀, ψ₋₁, χ₀ and χ₋₁, with the signs of Bohren & Huffman.
        let (sin, cos) = sin_cos(x);
        let (mut psi, mut psi_before) = (sin, cos);
        let (mut chi, mut chi_before) = (cos, -sin);
        let (mut sums, mut differences) = (Vec::with_capacity(terms), Vec::with_capacity(terms));
        let (mut scattering_sum, mut asymmetry_sum) = (0.0, 0.0);
        let mut last: Option<([f64; 2], [f64; 2])> = None;
        for (order, derivative) in derivative.iter().enumerate().skip(1) {
            let n = order as f64;
            (psi, psi_before) = ((2.0 * n - 1.0) / x * psi - psi_before, psi);
            (chi, chi_before) = ((2.0 * n - 1.0) / x * chi - chi_before, chi);
            // (f ψ_n − ψ_{n−1}) / (f ξ_n − ξ_{n−1}), ξ = ψ − iχ: a_n for f = D/m + n/x, b_n for mD
            // + n/x.
            let coefficient = |f: f64| {
                let (real, imaginary) = (f * psi - psi_before, f * chi - chi_before);
                let norm = real * real + imaginary * imaginary;
                if norm.is_finite() { [real * real / norm, real * imaginary / norm] } else { [0.0, 0.0] }
            };
            let a = coefficient(derivative / m + n / x);
            let b = coefficient(derivative * m + n / x);
            scattering_sum += (2.0 * n + 1.0) * (square(a) + square(b));
            if let Some((a_before, b_before)) = last {
                let k = n - 1.0;
                asymmetry_sum += 2.0 * k * (k + 2.0) / (k + 1.0) * (dot(a_before, a) + dot(b_before, b));
                asymmetry_sum += 2.0 * (2.0 * k + 1.0) / (k * (k + 1.0)) * dot(a_before, b_before);
            }
            last = Some((a, b));
            let weight = (2.0 * n + 1.0) / (n * (n + 1.0));
            sums.push([weight * (a[0] + b[0]), weight * (a[1] + b[1])]);
            differences.push([weight * (a[0] - b[0]), weight * (a[1] - b[1])]);
        }
        Self { sums, differences, scattering_sum, asymmetry_sum }
    }

    /// Returns |S₁|² + |S₂|² = (|S₁ + S₂|² + |S₁ − S₂|²)/2 at each cosine.
    fn intensity(&self, cosines: &[f64; ANGLE_LANES]) -> [f64; ANGLE_LANES] {
        let parts = self.amplitudes(cosines);
        std::array::from_fn(|lane| 0.5 * parts.iter().map(|part| part[lane] * part[lane]).sum::<f64>())
    }

    /// Returns the real and imaginary parts of S₁ + S₂ = Σ w_n·(a_n + b_n)(π_n + τ_n) and then of
    /// S₁ − S₂ = Σ w_n·(a_n − b_n)(π_n − τ_n) at each cosine, with w_n = (2n + 1)/(n(n + 1)).
    fn amplitudes(&self, cosines: &[f64; ANGLE_LANES]) -> [[f64; ANGLE_LANES]; 4] {
        let (mut pi, mut pi_before) = ([1.0; ANGLE_LANES], [0.0; ANGLE_LANES]);
        let mut parts = [[0.0; ANGLE_LANES]; 4];
        for (order, (sum, difference)) in self.sums.iter().zip(&self.differences).enumerate() {
            let n = order as f64 + 1.0;
            let (up, down) = ((2.0 * n + 1.0) / n, (n + 1.0) / n);
            for lane in 0..ANGLE_LANES {
                let mu = cosines[lane];
                let tau = n * mu * pi[lane] - (n + 1.0) * pi_before[lane];
                let (plus, minus) = (pi[lane] + tau, pi[lane] - tau);
                parts[0][lane] += sum[0] * plus;
                parts[1][lane] += sum[1] * plus;
                parts[2][lane] += difference[0] * minus;
                parts[3][lane] += difference[1] * minus;
                let next = up * mu * pi[lane] - down * pi_before[lane];
                pi_before[lane] = pi[lane];
                pi[lane] = next;
            }
        }
        parts
    }
}

/// Returns D_n(z) for n up to `terms` by a downward recurrence that starts so far above `terms` and
/// z that the starting value has no influence.
fn log_derivatives(z: f64, terms: usize) -> Vec<f64> {
    let start = terms.max(z as usize) + 16 + (4.0 * cbrt(z)) as usize;
    let mut derivatives = vec![0.0; terms + 1];
    let mut here = 0.0;
    for order in (1..=start).rev() {
        let ratio = order as f64 / z;
        here = ratio - 1.0 / (here + ratio);
        if order <= terms + 1 {
            derivatives[order - 1] = here;
        }
    }
    derivatives
}

fn square(z: [f64; 2]) -> f64 {
    dot(z, z)
}

/// Returns the real part of the product of z and the conjugate of w.
fn dot(z: [f64; 2], w: [f64; 2]) -> f64 {
    z[0] * w[0] + z[1] * w[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{Deflection, PhaseFunction};

    fn water() -> RefractiveIndex {
        RefractiveIndex::catalogue("water 20C").unwrap()
    }

    /// Reads the angles and the other columns of a CSV table with a header.
    fn table(name: &str) -> (Vec<f64>, Vec<Vec<f64>>) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        let rows: Vec<Vec<f64>> =
            text.lines().skip(1).map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        let column = |i: usize| rows.iter().map(|row| row[i]).collect();
        (column(0), (1..rows[0].len()).map(column).collect())
    }

    #[test]
    fn small_spheres_scatter_as_rayleigh_says() {
        let tiny = MieSpheres::new(0.002, None, RefractiveIndex::constant(1.5).unwrap()).unwrap();
        let angles = [0.0, 40.0, 90.0, 170.0];
        let found = tiny.scattering(500.0, &angles);
        for (angle, pdf_per_sr) in angles.iter().zip(&found.pdf_per_sr) {
            let expected = PhaseFunction::Rayleigh.eval(Deflection::horizontal(f64::to_radians(*angle).cos()), 500.0);
            assert!((pdf_per_sr / expected - 1.0).abs() < 1e-3, "{angle}°: {pdf_per_sr}");
        }
        // Rayleigh limit: C = 8/3 π r² x⁴ ((m² − 1)/(m² + 2))².
        let x = size_parameter(0.002, 500.0);
        let expected = 8.0 / 3.0 * PI * 4e-6 * x.powi(4) * (1.25_f64 / 4.25).powi(2);
        assert!((found.cross_section_um2 / expected - 1.0).abs() < 2e-3, "{}", found.cross_section_um2);
    }

    #[test]
    fn fog_matches_an_independent_mie_program() {
        let (angles, columns) = table("mie_fog_phase.csv");
        let fog = MieSpheres { radii_um: lognormal(5.0, 0.3, 300), index: water() };
        let known =
            [(400.0, 197.004_65, 0.858_689_23), (550.0, 199.381_33, 0.854_115_89), (700.0, 201.384_09, 0.849_848_39)];
        for (nm, cross_section, mean_cosine) in known {
            let found = fog.scattering(nm, &angles);
            assert!(
                (found.cross_section_um2 / cross_section - 1.0).abs() < 1e-5,
                "{nm} nm: {}",
                found.cross_section_um2
            );
            assert!((found.mean_cosine - mean_cosine).abs() < 3e-6, "{nm} nm: {}", found.mean_cosine);
            let column = &columns[((nm - 400.0) / 50.0) as usize];
            let off = found.pdf_per_sr.iter().zip(column).map(|(found, known)| (found / known - 1.0).abs());
            let worst = off.fold(0.0, f64::max);
            println!("{nm} nm: the density is off by at most {worst:.1e}");
            assert!(worst < 1e-4, "{nm} nm: off by {worst:e}");
        }
    }

    /// The mean cosine of the cached table of fog equals the mean cosine of the Mie series.
    #[test]
    fn fog_table_keeps_the_mean_cosine_of_the_series() {
        let fog = MieSpheres::new(5.0, Some(0.3_f64.exp()), water()).unwrap();
        let table = fog.table().unwrap();
        let again = fog.table().unwrap();
        assert!(Arc::ptr_eq(&table, &again));
        let phase = PhaseFunction::Table(table);
        for nm in [BAND_NM.0, BAND_NM.1] {
            let exact = fog.scattering(nm, &[]).mean_cosine;
            let found = phase.mean_cosine(nm).unwrap();
            assert!((found - exact).abs() < 1e-3, "{nm} nm: {found} {exact}");
        }
    }

    #[test]
    fn impossible_sphere_sizes_are_refused() {
        for (radius, spread, words) in [
            (5.0, Some(0.5), "a spread of 0.5"),
            (5.0, Some(f64::NAN), "a spread of NaN"),
            (500.0, None, "\"rainbow\""),
        ] {
            let error = MieSpheres::new(radius, spread, water()).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
