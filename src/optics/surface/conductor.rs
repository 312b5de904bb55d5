//! Metals, polished and rough.

use glam::DVec3;

use super::hemisphere::{same_side, side, turned};
use super::{Event, Scatter, Sides, check_alpha, check_within};
use crate::error::Result;
use crate::optics::fresnel;
use crate::optics::microfacet::{Ggx, MIN_ALPHA};
use crate::spectrum::Spectrum;

/// A metal of complex index n + ik: reflects by Fresnel's equations into the mirror direction, or, rough, from GGX facets
/// (Walter et al. 2007) that scatter once. Light that a facet would send into another one is lost, and booked as absorbed. Both
/// sides are alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Conductor {
    pub(super) n: Spectrum,
    pub(super) k: Spectrum,
    /// `None` if smooth.
    facets: Option<Ggx>,
}

impl Conductor {
    /// A metal of index `n` + i`k`, both ≥ 0, and GGX roughness `alpha` in \[0, 1\]; below [`MIN_ALPHA`] it is smooth.
    /// Fails outside these ranges.
    pub fn new(n: Spectrum, k: Spectrum, alpha: f64) -> Result<Self> {
        check_within("refractive index", &n, f64::INFINITY)?;
        check_within("extinction coefficient", &k, f64::INFINITY)?;
        check_alpha(alpha)?;
        Ok(Self { n, k, facets: (alpha >= MIN_ALPHA).then(|| Ggx::new(alpha)) })
    }

    /// Whether it spreads light into a lobe.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    pub(super) fn fresnel(&self, cos: f64, sides: Sides<'_>, nm: f64) -> f64 {
        fresnel::conductor(cos, self.n.at(nm), self.k.at(nm), sides.here.n(nm))
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<Scatter> {
        let Some(facets) = &self.facets else {
            return Some(Scatter::delta(DVec3::new(-wo.x, -wo.y, wo.z), Event::Reflection, 1.0));
        };
        let side = side(wo);
        let up = turned(wo, side);
        let m = facets.sample_visible(up, u[0], u[1]);
        let wi = turned(fresnel::reflect(up, m), side);
        let density = self.pdf(wo, wi);
        (density > 0.0).then(|| Scatter::spread(wi, Event::Reflection, density))
    }

    pub(super) fn coefficient(&self, wo: DVec3, sides: Sides<'_>, nm: f64) -> f64 {
        self.fresnel(wo.z, sides, nm)
    }

    pub(super) fn absorbed(&self, wo: DVec3, scatter: &Scatter, sides: Sides<'_>, nm: f64) -> f64 {
        let Some(facets) = &self.facets else {
            return 1.0 - self.fresnel(wo.z, sides, nm);
        };
        let m = (wo + scatter.wi).normalize_or_zero();
        let reflected = self.fresnel(wo.dot(m), sides, nm);
        (1.0 - reflected) + reflected * facets.shadowed(wo.z.abs(), scatter.wi.z.abs())
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, sides: Sides<'_>, nm: f64) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let m = (wo + wi).normalize_or_zero();
        let lobe = facets.reflected_density(turned(m, side(wo)), wo.z.abs(), wi.z.abs());
        self.fresnel(wo.dot(m), sides, nm) * lobe
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let m = turned((wo + wi).normalize_or_zero(), side(wo));
        0.25 * facets.g1_per_cos(wo.z.abs()) * facets.density(m)
    }
}
