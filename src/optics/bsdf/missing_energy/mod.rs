//! The energy that single scattering at microfacets loses, as a function of the angle.
//!
//! The single-scattering models of Walter et al. 2007 drop all light that hits a second microfacet.
//! The missing energy of a direction of cosine μ is l(μ) = 1 − E(μ), where E(μ) is the directional
//! albedo without absorption. A quadrature of l(μ) takes milliseconds, so the program contains a
//! table for all roughnesses, indices and angles. Materials interpolate in this table.

#[cfg(test)]
mod quadrature;
mod table;

use self::table::MissingEnergyTable;
use crate::optics::microfacet::Ggx;

/// Number of angles in the table of one interface.
const ANGLES: usize = 96;
/// The table is lowered by this factor. The factor exceeds the error of the quadrature and of the
/// interpolation, so that the compensated albedo stays below 1.
pub(super) const MARGIN: f64 = 0.998;

/// The cosines at which the missing energy is tabulated: the squares of evenly spaced numbers. The
/// grid is dense at grazing angles, where l(μ) is largest and changes fast.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AngleGrid {
    cosines: Vec<f64>,
}

/// A cosine between two neighbouring nodes of an [`AngleGrid`].
#[derive(Debug, Clone, Copy)]
pub(super) struct GridPoint {
    cell: usize,
    /// The position between the nodes, from 0 to 1.
    fraction: f64,
}

impl AngleGrid {
    pub(super) fn new() -> Self {
        Self { cosines: (0..ANGLES).map(|i| (i as f64 / (ANGLES - 1) as f64).powi(2)).collect() }
    }

    /// Returns the cosines of the nodes.
    pub(super) fn cosines(&self) -> impl Iterator<Item = f64> {
        self.cosines.iter().copied()
    }

    /// Finds the nodes around a cosine in \[0, 1\].
    pub(super) fn locate(&self, cos: f64) -> GridPoint {
        let cell = (((ANGLES - 1) as f64 * cos.sqrt()) as usize).min(ANGLES - 2);
        let (from, to) = (self.cosines[cell], self.cosines[cell + 1]);
        GridPoint { cell, fraction: ((cos - from) / (to - from)).clamp(0.0, 1.0) }
    }

    /// Returns ∫ 2μ·f(μ) dμ, for the linear interpolation of f between its values at the nodes.
    pub(super) fn mean(&self, values: &[f64]) -> f64 {
        (0..ANGLES - 1).map(|cell| self.moment(cell, values)).sum()
    }

    /// Returns ∫ 2μ·f(μ) dμ over a cell, for the linear interpolation of f between its values at
    /// the two nodes.
    fn moment(&self, cell: usize, values: &[f64]) -> f64 {
        let (from, to) = (self.cosines[cell], self.cosines[cell + 1]);
        let (low, high) = (values[cell], values[cell + 1]);
        (to - from) * (low * (2.0 * from + to) + high * (from + 2.0 * to)) / 3.0
    }
}

impl GridPoint {
    /// Interpolates linearly between the values at the nodes.
    pub(super) fn between(self, value: impl Fn(usize) -> f64) -> f64 {
        let (low, high) = (value(self.cell), value(self.cell + 1));
        low + (high - low) * self.fraction
    }
}

/// The microfacets of an interface: how much light each facet reflects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FacetKind {
    /// The facets reflect all light.
    Mirror,
    /// The facets reflect and refract light by Fresnel's equations. The value is the index of the
    /// far medium relative to the near medium.
    Dielectric(f64),
}

/// The missing energy l(μ) for light that arrives from one side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MissingEnergy {
    by_angle: Vec<f64>,
    /// The mean ∫ 2μ·l(μ) dμ: the missing energy under uniform incident radiance.
    pub(super) mean: f64,
    /// The mean of the energy that single scattering transmits.
    pub(super) transmitted: f64,
}

impl MissingEnergy {
    pub(super) fn new(facets: &Ggx, grid: &AngleGrid, kind: FacetKind) -> Self {
        let column = MissingEnergyTable::built_in().column(facets, kind);
        let by_angle: Vec<f64> = grid.cosines().map(|cos| MARGIN * column.at(cos)).collect();
        Self { mean: grid.mean(&by_angle), transmitted: column.transmitted, by_angle }
    }

    /// Returns l(μ), linearly interpolated.
    pub(super) fn at(&self, point: GridPoint) -> f64 {
        point.between(|node| self.by_angle[node])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::fresnel;
    use glam::DVec3;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Computes l(μ) by the midpoint rule on the whole disk of visible normals, without the
    /// subdivision of the quadrature.
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

    /// The roughness 0.05 to 1 of scene files corresponds to α from 0.0025 to 1.
    #[test]
    fn the_table_agrees_with_brute_force_between_its_nodes() {
        let grid = AngleGrid::new();
        for alpha in [0.05, 0.36, 1.0] {
            let facets = Ggx::new(alpha);
            let kinds = [1.1_f64, 1.5, 2.4].into_iter().flat_map(|n| [n, n.recip()]).map(FacetKind::Dielectric);
            for kind in kinds.chain([FacetKind::Mirror]) {
                let table = MissingEnergy::new(&facets, &grid, kind);
                let mut worst = (0.0_f64, 0.0);
                for i in 0..8 {
                    let cos = ((f64::from(i) + 0.37) / 8.0).powi(2);
                    let error = table.at(grid.locate(cos)) / MARGIN - brute_force(&facets, kind, cos);
                    if error.abs() > worst.0.abs() {
                        worst = (error, cos);
                    }
                }
                println!("alpha {alpha}, {kind:?}: {worst:?} of {}", table.mean);
                assert!(worst.0.abs() < 1e-3, "alpha {alpha}, {kind:?}: {worst:?}");
            }
        }
    }
}
