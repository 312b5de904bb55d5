//! Metals with smooth and rough surfaces.

use glam::DVec3;

use super::check::{check_alpha, check_within};
use super::hemisphere::{flip_z, same_side, z_sign};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent};
use crate::error::Result;
use crate::optics::fresnel;
use crate::optics::microfacet::{Ggx, MIN_ALPHA};
use crate::spectrum::Spectrum;

/// A metal of complex index n + ik.
///
/// A smooth metal reflects light into the mirror direction by Fresnel's equations. A rough metal
/// uses the single-scattering GGX model of Walter et al. 2007. Light that hits a second facet is
/// counted as absorbed. Both sides of the surface behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Conductor {
    pub(super) n: Spectrum,
    pub(super) k: Spectrum,
    /// `None` if the surface is smooth.
    facets: Option<Ggx>,
}

impl Conductor {
    /// Creates a metal of index `n` + i`k` and GGX roughness `alpha`. If `alpha` is below
    /// [`MIN_ALPHA`], the surface is smooth.
    ///
    /// # Errors
    /// Returns an error if `n` or `k` is negative, or `alpha` lies outside \[0, 1\].
    pub fn new(n: Spectrum, k: Spectrum, alpha: f64) -> Result<Self> {
        check_within("refractive index", &n, f64::INFINITY)?;
        check_within("extinction coefficient", &k, f64::INFINITY)?;
        check_alpha(alpha)?;
        Ok(Self { n, k, facets: (alpha >= MIN_ALPHA).then(|| Ggx::new(alpha)) })
    }

    /// Returns whether the surface is rough, so that its lobe has a finite width.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    pub(super) fn fresnel(&self, cos: f64, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        fresnel::conductor(cos, self.n.at(nm), self.k.at(nm), iors.here.n(nm))
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<BsdfSample> {
        let Some(facets) = &self.facets else {
            return Some(BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, 1.0));
        };
        let sign = z_sign(wo);
        let up = flip_z(wo, sign);
        let m = facets.sample_visible(up, u[0], u[1]);
        let wi = flip_z(fresnel::reflect(up, m), sign);
        let density = self.pdf(wo, wi);
        (density > 0.0).then(|| BsdfSample::lobe(wi, ScatterEvent::Reflection, density))
    }

    pub(super) fn coefficient(&self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        self.fresnel(wo.z, iors, nm)
    }

    pub(super) fn absorbed_fraction(&self, wo: DVec3, sample: &BsdfSample, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let Some(facets) = &self.facets else {
            return 1.0 - self.fresnel(wo.z, iors, nm);
        };
        let m = (wo + sample.wi).normalize_or_zero();
        let reflected = self.fresnel(wo.dot(m), iors, nm);
        (1.0 - reflected) + reflected * facets.shadowed_fraction(wo.z.abs(), sample.wi.z.abs())
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let m = (wo + wi).normalize_or_zero();
        let lobe = facets.reflection_lobe(flip_z(m, z_sign(wo)), wo.z.abs(), wi.z.abs());
        self.fresnel(wo.dot(m), iors, nm) * lobe
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let m = flip_z((wo + wi).normalize_or_zero(), z_sign(wo));
        0.25 * facets.g1_per_cos(wo.z.abs()) * facets.eval(m)
    }
}
