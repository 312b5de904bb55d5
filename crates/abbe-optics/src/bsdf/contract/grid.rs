//! A grid of cells of equal solid angle, to compare a pdf with samples by the χ² test.

use std::f64::consts::TAU;

use glam::DVec3;

use super::any_direction;

pub(super) const BANDS: usize = 16;
pub(super) const SECTORS: usize = 32;
const GAUSS_5_UNIT: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_095),
    (0.230_765_344_947_158, 0.239_314_335_249_683),
    (0.5, 0.284_444_444_444_444),
    (0.769_234_655_052_841, 0.239_314_335_249_683),
    (0.953_089_922_969_332, 0.118_463_442_528_095),
];

pub(super) fn cell(w: DVec3) -> usize {
    let band = ((0.5 * (w.z + 1.0) * BANDS as f64) as usize).min(BANDS - 1);
    let turn = w.y.atan2(w.x).rem_euclid(TAU) / TAU;
    band * SECTORS + ((turn * SECTORS as f64) as usize).min(SECTORS - 1)
}

/// A rectangle in the unit square, which the equal-area map transforms to a region of the sphere.
#[derive(Clone, Copy)]
struct SpherePatch {
    at: [f64; 2],
    size: [f64; 2],
}

impl SpherePatch {
    fn integral(self, f: &impl Fn(DVec3) -> f64) -> f64 {
        let mut sum = 0.0;
        for (x, weight_x) in GAUSS_5_UNIT {
            for (y, weight_y) in GAUSS_5_UNIT {
                let u = [self.at[0] + x * self.size[0], self.at[1] + y * self.size[1], 0.0];
                sum += weight_x * weight_y * f(any_direction(u));
            }
        }
        2.0 * TAU * self.size[0] * self.size[1] * sum
    }

    fn quarters(self) -> [Self; 4] {
        let size = self.size.map(|side| 0.5 * side);
        let [x, y] = self.at;
        [[x, y], [x + size[0], y], [x, y + size[1]], [x + size[0], y + size[1]]].map(|at| Self { at, size })
    }

    /// Integrates `f` by quarters of a rectangle until it changes by less than `tolerance`.
    fn refined(self, f: &impl Fn(DVec3) -> f64, tolerance: f64, known: f64, depth: usize) -> f64 {
        let quarters = self.quarters().map(|quarter| (quarter, quarter.integral(f)));
        let sum: f64 = quarters.iter().map(|(_, value)| value).sum();
        if depth == 0 || (sum - known).abs() < tolerance {
            return sum;
        }
        quarters.iter().map(|(quarter, value)| quarter.refined(f, tolerance, *value, depth - 1)).sum()
    }
}

/// Returns ∫ f dω over each cell. The error of the sum is of the order of 10⁻⁵.
pub(super) fn integrals(f: impl Fn(DVec3) -> f64) -> Vec<f64> {
    integrals_within(1e-7, f)
}

/// Returns ∫ f dω over each cell, with subdivision down to changes below `tolerance`.
pub(super) fn integrals_within(tolerance: f64, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let size = [1.0 / BANDS as f64, 1.0 / SECTORS as f64];
    (0..BANDS * SECTORS)
        .map(|cell| {
            let at = [(cell / SECTORS) as f64 * size[0], (cell % SECTORS) as f64 * size[1]];
            let patch = SpherePatch { at, size };
            patch.refined(&f, tolerance, patch.integral(&f), 10)
        })
        .collect()
}

/// Counts the samples of each cell, those in delta directions, and those without a valid direction.
pub(super) struct Histogram {
    pub(super) cells: Vec<f64>,
    pub(super) deltas: f64,
    pub(super) nowhere: f64,
    pub(super) total: f64,
}

/// Returns the number of standard deviations by which χ² exceeds its mean (Wilson & Hilferty 1931).
/// Cells with fewer than 8 expected samples are pooled.
pub(super) fn chi_square_deviations(seen: &Histogram, expected: &[f64]) -> f64 {
    let (mut sum, mut degrees) = (0.0, -1.0);
    let (mut rare_seen, mut rare_expected) = (0.0, 0.0);
    let missing = seen.total - expected.iter().sum::<f64>();
    let mut count = |seen: f64, expected: f64| {
        sum += (seen - expected) * (seen - expected) / expected;
        degrees += 1.0;
    };
    let elsewhere = seen.deltas + seen.nowhere;
    for (&seen, &expected) in seen.cells.iter().zip(expected).chain([(&elsewhere, &missing)]) {
        if expected >= 8.0 {
            count(seen, expected);
        } else {
            rare_seen += seen;
            rare_expected += expected;
        }
    }
    if rare_expected >= 8.0 {
        count(rare_seen, rare_expected);
    } else if rare_seen > 8.0 + 6.0 * 8.0_f64.sqrt() {
        return f64::INFINITY;
    }
    if degrees < 1.0 {
        return 0.0;
    }
    let spread = 2.0 / (9.0 * degrees);
    ((sum / degrees).cbrt() - (1.0 - spread)) / spread.sqrt()
}
