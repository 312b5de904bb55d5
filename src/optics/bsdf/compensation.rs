//! Energy compensation: the light that microfacets scatter more than once.
//!
//! The single-scattering model of rough surfaces loses the energy of light that hits a second
//! microfacet. A second, wide lobe returns this energy (Kulla & Conty, "Revisiting physically based
//! shading at Imageworks", 2017, after Kelemen & Szirmay-Kalos 2001). With the missing energy l(μ),
//! the lobe has the form l(μ_o)·l(μ_i)/(π·l̄), so it is reciprocal.

use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::missing_energy::{AngleGrid, FacetKind, GridPoint, MissingEnergy};
use super::sample::ScatterEvent;
use crate::math::elementary::{exp, exp_m1, ln, ln_1p, sin_cos};
use crate::optics::microfacet::Ggx;

/// There are tables for the relative indices exp(±(k·STEP)²). The nodes are dense near index
/// 1, where the critical angle of total reflection changes fast.
const STEP: f64 = 0.015;
/// The largest k. The last relative index is above 100. Beyond it, the last table is used.
const LAST: usize = 144;

/// The missing energy of a rough dielectric of one roughness, at every relative index.
///
/// A table is interpolated when it is first used. Its values depend only on the roughness and the
/// index.
#[derive(Debug, Clone)]
pub(super) struct DielectricCompensation(Arc<Tables>);

#[derive(Debug)]
struct Tables {
    facets: Ggx,
    grid: AngleGrid,
    sampling: LobeSampling,
    /// One table per relative index, from exp(−(LAST·STEP)²) to exp((LAST·STEP)²).
    by_index: Vec<OnceLock<MissingEnergy>>,
}

/// Two compensations are equal if they belong to the same microfacets, because the tables follow
/// from the microfacets.
impl PartialEq for DielectricCompensation {
    fn eq(&self, other: &Self) -> bool {
        self.0.facets == other.0.facets
    }
}

impl DielectricCompensation {
    pub(super) fn new(facets: Ggx) -> Self {
        let by_index = (0..=2 * LAST).map(|_| OnceLock::new()).collect();
        Self(Arc::new(Tables { grid: AngleGrid::new(), sampling: LobeSampling::new(&facets), facets, by_index }))
    }

    /// Returns the lobe of light that arrives in the medium of index `n_i` at an interface with a
    /// medium of index `n_t`.
    pub(super) fn between(&self, n_i: f64, n_t: f64) -> MultipleScattering<'_> {
        let offset = ln(n_t) - ln(n_i);
        let position = (offset.abs().sqrt() / STEP).min(LAST as f64);
        let low = (position as usize).min(LAST - 1);
        let share = position - low as f64;
        let side = |upwards: bool| {
            let table = |k: usize| self.0.table(if upwards { LAST + k } else { LAST - k });
            OneSide { low: table(low), high: table(low + 1), share }
        };
        let (here, there) = (side(offset > 0.0), side(offset < 0.0));
        MultipleScattering {
            grid: &self.0.grid,
            sampling: self.0.sampling,
            transmitted: transmitted_share([(&here, n_i), (&there, n_t)]),
            here,
            there,
        }
    }
}

impl Tables {
    fn table(&self, number: usize) -> &MissingEnergy {
        self.by_index[number].get_or_init(|| {
            let k = number as f64 - LAST as f64;
            let index = exp(k * STEP * (k * STEP).abs());
            MissingEnergy::new(&self.facets, &self.grid, FacetKind::Dielectric(index))
        })
    }
}

/// Returns the fraction x of the lobe that is transmitted, for light on the first of two sides.
///
/// Reciprocity requires that n²·l̄·x has the same value Y on both sides. In each single scattering
/// event, the transmitted fraction is τ = T̄/(1 − l̄), where T̄ is the mean transmittance and n²·T̄ has
/// the same value on both sides. The lobe follows τ on the side on which n²·l̄·τ is lower, which
/// gives Y. Compared with the random walk on microfacets of Heitz et al. 2016, the mean
/// transmittance of the interface then differs by less than 0.02.
fn transmitted_share([here, there]: [(&OneSide<'_>, f64); 2]) -> f64 {
    let odds = |side: &OneSide<'_>| side.mean() / (1.0 - side.mean());
    let flux = |(side, n): (&OneSide<'_>, f64)| n * n * side.transmitted();
    // The tabulated flux differs slightly between the sides, so both sides use the mean.
    let both = 0.5 * (flux(here) + flux(there)) * odds(here.0).min(odds(there.0));
    let largest = |(side, n): (&OneSide<'_>, f64)| n * n * side.mean();
    let common = both.min(largest(here)).min(largest(there));
    common / largest(here)
}

/// The missing energy at a relative index between two tables.
#[derive(Debug, Clone, Copy)]
struct OneSide<'a> {
    low: &'a MissingEnergy,
    high: &'a MissingEnergy,
    /// The weight of `high`, from 0 to 1.
    share: f64,
}

impl OneSide<'_> {
    fn mixed(&self, value: impl Fn(&MissingEnergy) -> f64) -> f64 {
        (1.0 - self.share) * value(self.low) + self.share * value(self.high)
    }

    fn at(&self, point: GridPoint) -> f64 {
        self.mixed(|table| table.at(point))
    }

    fn mean(&self) -> f64 {
        self.mixed(|table| table.mean)
    }

    fn transmitted(&self) -> f64 {
        self.mixed(|table| table.transmitted)
    }
}

/// The lobe of multiply scattered light at a rough dielectric interface. All cosines are positive.
#[derive(Debug, Clone, Copy)]
pub(super) struct MultipleScattering<'a> {
    grid: &'a AngleGrid,
    sampling: LobeSampling,
    here: OneSide<'a>,
    there: OneSide<'a>,
    /// The fraction of the lobe that is transmitted.
    transmitted: f64,
}

impl MultipleScattering<'_> {
    /// Returns the albedo of the lobe at the cosine of `wo`. The sampling selects the lobe with this
    /// probability.
    pub(super) fn albedo(&self, cos_o: f64) -> f64 {
        self.here.at(self.grid.locate(cos_o))
    }

    fn far_side(&self, event: ScatterEvent) -> (&OneSide<'_>, f64) {
        match event {
            ScatterEvent::Reflection => (&self.here, 1.0 - self.transmitted),
            ScatterEvent::Transmission => (&self.there, self.transmitted),
        }
    }

    /// Evaluates the lobe in 1/sr for power.
    pub(super) fn eval(&self, cos_o: f64, cos_i: f64, event: ScatterEvent) -> f64 {
        let (side, share) = self.far_side(event);
        FRAC_1_PI * share * self.albedo(cos_o) * side.at(self.grid.locate(cos_i)) / side.mean()
    }

    /// Samples an event and a direction. The z component of the direction is positive for both
    /// events. All random numbers lie in \[0, 1).
    pub(super) fn sample(&self, u: [f64; 3]) -> (DVec3, ScatterEvent) {
        let event = if u[2] < self.transmitted { ScatterEvent::Transmission } else { ScatterEvent::Reflection };
        (self.sampling.sample([u[0], u[1]]), event)
    }

    /// Returns the density per solid angle with which [`Self::sample`] samples a direction.
    pub(super) fn pdf(&self, cos_i: f64, event: ScatterEvent) -> f64 {
        self.far_side(event).1 * self.sampling.pdf(cos_i)
    }
}

/// The lobe of multiply scattered light at a rough metal, without the losses in the metal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConductorCompensation {
    grid: AngleGrid,
    sampling: LobeSampling,
    missing: MissingEnergy,
}

impl ConductorCompensation {
    pub(super) fn new(facets: &Ggx) -> Self {
        let grid = AngleGrid::new();
        Self {
            missing: MissingEnergy::new(facets, &grid, FacetKind::Mirror),
            sampling: LobeSampling::new(facets),
            grid,
        }
    }

    /// Returns the albedo of the lobe at the cosine of `wo`, without the losses in the metal. The
    /// sampling selects the lobe with this probability.
    pub(super) fn albedo(&self, cos_o: f64) -> f64 {
        self.missing.at(self.grid.locate(cos_o))
    }

    /// Returns the fraction of the multiply scattered light that the metal reflects. `reflectance`
    /// is the cosine-weighted mean of the metal's reflectance.
    pub(super) fn reflected(&self, reflectance: f64) -> f64 {
        let single = 1.0 - self.missing.mean;
        // Every further event reflects F̄. The fraction 1 − l̄ of this light leaves the surface.
        reflectance * reflectance * single / (1.0 - reflectance * self.missing.mean)
    }

    /// Evaluates the lobe in 1/sr, without the losses in the metal.
    pub(super) fn eval(&self, cos_o: f64, cos_i: f64) -> f64 {
        FRAC_1_PI * self.albedo(cos_o) * self.albedo(cos_i) / self.missing.mean
    }

    /// Samples a direction with a positive z component.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.sampling.sample(u)
    }

    /// Returns the density per solid angle with which [`Self::sample`] samples a direction.
    pub(super) fn pdf(&self, cos_i: f64) -> f64 {
        self.sampling.pdf(cos_i)
    }
}

/// The distribution from which directions of the lobe are sampled. Its density per unit of μ is
/// proportional to μ/(μ² + α²). The missing energy l(μ) falls like 1/(μ² + α²), so the density
/// nearly follows the lobe μ·l(μ).
#[derive(Debug, Clone, Copy, PartialEq)]
struct LobeSampling {
    /// α².
    squared: f64,
    /// ln(1 + 1/α²), twice the integral of μ/(μ² + α²) from 0 to 1.
    norm: f64,
}

impl LobeSampling {
    fn new(facets: &Ggx) -> Self {
        let squared = facets.alpha() * facets.alpha();
        Self { squared, norm: ln_1p(squared.recip()) }
    }

    fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        // At u = 0 the direction would lie in the surface.
        let cos = (self.squared * exp_m1(self.norm * u.max(f64::EPSILON))).sqrt().min(1.0);
        let (sin_phi, cos_phi) = sin_cos(TAU * v);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        DVec3::new(sin * cos_phi, sin * sin_phi, cos)
    }

    /// Returns the density per solid angle.
    fn pdf(&self, cos: f64) -> f64 {
        2.0 * cos / ((cos * cos + self.squared) * self.norm * TAU)
    }
}
