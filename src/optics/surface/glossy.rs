//! A matt base under a clear, more or less rough coat: paint, plastic, glazed pottery.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::albedo::CoatAlbedo;
use super::hemisphere::{cosine_density, same_side, sample_cosine, side, turned};
use super::{Event, Scatter, check_alpha, check_within, checked_nm};
use crate::error::Result;
use crate::optics::fresnel;
use crate::optics::glass::Index;
use crate::optics::microfacet::Ggx;
use crate::spectrum::Spectrum;

/// The least share of samples that each lobe gets: the hero wavelength may have little in a lobe where others have much.
const LEAST_SHARE: f64 = 0.1;

/// A coat of GGX facets that reflects E(μ) of what comes at cosine μ, over a matt base that is lit and seen through what the
/// coat lets through, 1 − E (after Kelemen & Szirmay-Kalos 2001; Ashikhmin & Shirley 2000 had the same form):
///
/// f = F·D·G₂/(4·μ_o·μ_i) + ρ·(1−E(μ_o))·(1−E(μ_i))/(π·(1−Ē)), Ē the mean of E.
///
/// It is reciprocal, and its albedo is E(μ) + ρ·(1−E(μ)): ρ(λ) is the fraction that comes back of what the coat lets in,
/// reflections between base and coat included. The index is that of the coat relative to the medium around. Both sides are
/// alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Glossy {
    pub(super) reflectance: Spectrum,
    index: Index,
    facets: Ggx,
    coat: CoatAlbedo,
    /// Whether the base reflects at any wavelength.
    has_base: bool,
}

impl Glossy {
    /// A base of this reflectance, in \[0, 1\], under a coat of this index and of GGX roughness `alpha` in \[0, 1\], which is held at
    /// [`crate::optics::microfacet::MIN_ALPHA`] from below. Fails outside these ranges.
    pub fn new(reflectance: Spectrum, index: Index, alpha: f64) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        check_alpha(alpha)?;
        let facets = Ggx::new(alpha);
        let (lowest, highest) = checked_nm()
            .map(|nm| index.n(nm))
            .fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
        let has_base = checked_nm().any(|nm| reflectance.at(nm) > 0.0);
        Ok(Self { coat: CoatAlbedo::new(&facets, lowest, highest), reflectance, index, facets, has_base })
    }

    /// The fraction reflected by coat and base together at the cosine of `wo`, and how much of it by the coat.
    fn albedo(&self, wo: DVec3, nm: f64) -> (f64, f64) {
        let coat = self.coat.at(wo.z.abs(), self.index.n(nm));
        (coat + self.reflectance.at(nm) * (1.0 - coat), coat)
    }

    /// The probability of sampling the coat.
    fn coat_share(&self, wo: DVec3, nm: f64) -> f64 {
        let (all, coat) = self.albedo(wo, nm);
        if coat == 0.0 {
            0.0
        } else if self.has_base {
            (coat / all).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE)
        } else {
            1.0
        }
    }

    pub(super) fn sample(&self, wo: DVec3, nm: f64, u: [f64; 3]) -> Scatter {
        let side = side(wo);
        let share = self.coat_share(wo, nm);
        let wi = if u[2] < share {
            let up = turned(wo, side);
            let m = self.facets.sample_visible(up, u[0], u[1]);
            turned(fresnel::reflect(up, m), side)
        } else {
            sample_cosine(side, u[0], u[1])
        };
        // A facet may send the path into the surface; any positive density will do then, for its response is 0.
        let density = self.density(wo, wi, share);
        Scatter::spread(wi, Event::Reflection, if density > 0.0 { density } else { 1.0 })
    }

    pub(super) fn absorbed(&self, wo: DVec3, nm: f64) -> f64 {
        let (_, coat) = self.albedo(wo, nm);
        (1.0 - coat) * (1.0 - self.reflectance.at(nm))
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let index = self.index.n(nm);
        let m = (wo + wi).normalize_or_zero();
        let lobe = self.facets.reflected_density(turned(m, side(wo)), wo.z.abs(), wi.z.abs());
        let (coat_o, coat_i) = (self.coat.at(wo.z.abs(), index), self.coat.at(wi.z.abs(), index));
        // Both of the base's factors vanish where the coat reflects everything, and so does what they are divided by.
        let through = (1.0 - coat_o) * (1.0 - coat_i) / (1.0 - self.coat.mean(index)).max(f64::MIN_POSITIVE);
        fresnel::dielectric(wo.dot(m), 1.0, index) * lobe + self.reflectance.at(nm) * FRAC_1_PI * through
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        self.density(wo, wi, self.coat_share(wo, nm))
    }

    /// The density of `wi` where the coat gets this share of the samples.
    fn density(&self, wo: DVec3, wi: DVec3, share: f64) -> f64 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let m = turned((wo + wi).normalize_or_zero(), side(wo));
        let coat = 0.25 * self.facets.g1_per_cos(wo.z.abs()) * self.facets.density(m);
        share * coat + (1.0 - share) * cosine_density(wi)
    }
}
