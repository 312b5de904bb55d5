//! The energy that single scattering at microfacets loses, as a function of the angle.
//!
//! The models of Walter et al. 2007 drop all light that hits a second microfacet. At a cosine μ,
//! the missing energy is l(μ) = 1 − E(μ), where E(μ) is the directional albedo without absorption.

use super::angle_grid::{AngleGrid, GridPoint};
use super::facet_quadrature::{FacetKind, FacetQuadrature};

/// The missing energy l(μ) for light that arrives from one side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MissingEnergy {
    by_angle: Vec<f64>,
    /// ∫ 2μ·l(μ) dμ: the missing energy under uniform radiance.
    pub(super) mean: f64,
    /// The mean energy that single scattering transmits.
    pub(super) transmitted: f64,
}

impl MissingEnergy {
    pub(super) fn new(quadrature: &FacetQuadrature, grid: &AngleGrid, kind: FacetKind) -> Self {
        let table = grid.tabulate(|cos| missing_and_transmitted(quadrature, kind, cos));
        // Where the missing energy is nearly 0, the cubic interpolation may pass below 0.
        let by_angle: Vec<f64> = table.iter().map(|[missing, _]| missing.max(0.0)).collect();
        let transmitted = grid.mean(table.iter().map(|[_, transmitted]| *transmitted));
        Self { mean: grid.mean(by_angle.iter().copied()), transmitted, by_angle }
    }

    pub(super) fn at(&self, point: GridPoint) -> f64 {
        point.between(|node| self.by_angle[node])
    }
}

/// Returns l(μ), and the fraction of the light that single scattering transmits.
fn missing_and_transmitted(quadrature: &FacetQuadrature, kind: FacetKind, cos: f64) -> [f64; 2] {
    let (mut missing, mut transmitted) = (0.0, 0.0);
    quadrature.each_band(kind, cos, |band| {
        let reflectance = kind.reflectance(band.cos);
        missing += reflectance * band.reflected_shadowed + (1.0 - reflectance) * band.refracted_shadowed;
        transmitted += (1.0 - reflectance) * (band.visible - band.refracted_shadowed);
    });
    [missing, transmitted]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel;
    use crate::microfacet::Ggx;
    use glam::DVec3;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Computes l(μ) by the midpoint rule on the whole disk, without subdivision.
    fn brute_force(facets: &Ggx, kind: FacetKind, cos: f64) -> f64 {
        const POINTS: usize = 300;
        let wo = DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
        let lost = |up: f64| if up > 0.0 { facets.shadowed_fraction(cos, up) } else { 1.0 };
        let mut sum = 0.0;
        for i in 0..POINTS {
            for j in 0..POINTS {
                let at = |k: usize| (k as f64 + 0.5) / POINTS as f64;
                // The substitution u = sin²(πx/2) resolves the edge of the disk.
                let (sin, cos) = (FRAC_PI_2 * at(i)).sin_cos();
                let m = facets.sample_visible(wo, sin * sin, 0.25 + 0.5 * at(j));
                let weight = PI * sin * cos;
                let (reflected, refracted) = match kind {
                    FacetKind::Mirror => (1.0, None),
                    FacetKind::Dielectric(n) => {
                        (fresnel::dielectric(wo.dot(m), 1.0, n), fresnel::refract(wo, m, 1.0, n))
                    }
                };
                sum += weight * reflected * lost(fresnel::reflect(wo, m).z);
                sum += weight * refracted.map_or(0.0, |refracted| (1.0 - reflected) * lost(-refracted.z));
            }
        }
        sum / (POINTS * POINTS) as f64
    }

    #[test]
    fn the_missing_energy_agrees_with_brute_force() {
        for alpha in [0.05, 0.36, 1.0] {
            let facets = Ggx::new(alpha);
            let quadrature = FacetQuadrature::new(facets);
            let kinds = [1.1_f64, 1.5, 2.4].into_iter().flat_map(|n| [n, n.recip()]).map(FacetKind::Dielectric);
            for kind in kinds.chain([FacetKind::Mirror]) {
                for i in 0..8 {
                    let cos = ((f64::from(i) + 0.37) / 8.0).powi(2);
                    let error = missing_and_transmitted(&quadrature, kind, cos)[0] - brute_force(&facets, kind, cos);
                    assert!(error.abs() < 1e-4, "alpha {alpha}, {kind:?}, cosine {cos}: {error}");
                }
            }
        }
    }

    /// The positions lie between the nodes. The indices lie between 1/2.4 and 2.4.
    #[test]
    fn interpolated_missing_energy_agrees_with_a_finer_quadrature() {
        const STEPS: u32 = 200;
        let (mut worst, mut mean) = ((0.0_f64, String::new()), 0.0);
        for step in 0..STEPS {
            let [a, n, c] = [0.754_877_67, 0.569_840_29, 0.618_033_99].map(|golden| (f64::from(step) * golden).fract());
            let alpha = 0.0025_f64.powf(1.0 - a);
            let index = (1.02_f64.ln() + (2.4_f64 / 1.02).ln() * (2.0 * n - 1.0).abs()).exp().powf((n - 0.5).signum());
            let cos = c * c;
            let (facets, kind) = (Ggx::new(alpha), FacetKind::Dielectric(index));
            let grid = AngleGrid::new(&facets);
            let found = MissingEnergy::new(&FacetQuadrature::new(facets), &grid, kind).at(grid.locate(cos));
            let error = found - missing_and_transmitted(&FacetQuadrature::refined(facets, 3), kind, cos)[0];
            mean += error.abs() / f64::from(STEPS);
            if error.abs() > worst.0.abs() {
                worst = (error, format!("alpha {alpha:.4}, index {index:.4}, cosine {cos:.4}"));
            }
        }
        println!("mean error {mean:.1e}, worst error {:.1e} at {}", worst.0, worst.1);
        // Near the critical angle, the table does not resolve the lobe of a smoother surface.
        assert!(mean < 1e-5 && worst.0.abs() < 2e-4, "mean {mean}, {worst:?}");
    }
}
