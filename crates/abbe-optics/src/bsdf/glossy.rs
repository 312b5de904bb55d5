//! A diffuse base under a clear dielectric coat, such as paint, plastic or glazed pottery.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::albedo::CoatAlbedo;
use super::check::{check_alpha, check_fraction, whole_nm};
use super::hemisphere::{cosine_pdf, flip_z, same_side, sample_cosine, z_sign};
use super::sample::{BsdfSample, ScatterEvent};
use crate::fresnel;
use crate::glass::RefractiveIndex;
use crate::microfacet::Ggx;
use crate::texture::{SurfaceSpectrum, Texel};
use abbe_spectra::error::Result;

/// The least probability of each lobe if both have power, so that a lobe with little power at the
/// hero wavelength is not sampled too rarely for the other wavelengths of the path.
const MIN_LOBE_PROBABILITY: f64 = 0.1;

/// A smooth or rough dielectric coat over a Lambertian base.
///
/// The albedo of the coat determines how much light passes it on its way to the base and back
/// (Kelemen & Szirmay-Kalos 2001, after Ashikhmin & Shirley 2000):
///
/// f = F·D·G₂/(4·μ_o·μ_i) + ρ·(1−E(μ_o))·(1−E(μ_i))/(π·(1−Ē)),
///
/// where E(μ) is the directional albedo of the coat and Ē its cosine-weighted mean. The model is
/// reciprocal and has the albedo E(μ) + ρ·(1−E(μ)). Of the light that enters the coat, the fraction
/// ρ(λ) leaves it again, interreflection between base and coat included. The index of the coat is
/// relative to the surrounding medium. Both sides of the surface behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Glossy {
    pub(super) reflectance: SurfaceSpectrum,
    index: RefractiveIndex,
    facets: Ggx,
    coat: CoatAlbedo,
    has_base: bool,
    /// True if `reflectance` is that of the bare base (see [`Glossy::with_interreflection`]).
    interreflection: bool,
}

impl Glossy {
    /// Creates a base of this reflectance under a coat of this index and of GGX roughness `alpha`,
    /// at least [`crate::microfacet::MIN_ALPHA`]. Returns an error if either lies outside \[0, 1\].
    pub fn new(reflectance: impl Into<SurfaceSpectrum>, index: RefractiveIndex, alpha: f64) -> Result<Self> {
        let reflectance = reflectance.into();
        check_fraction("reflectance", &reflectance)?;
        check_alpha(alpha)?;
        let facets = Ggx::new(alpha);
        let (lowest, highest) =
            whole_nm().map(|nm| index.n(nm)).fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
        let has_base = reflectance.uniform().is_none_or(|uniform| whole_nm().any(|nm| uniform.at(nm) > 0.0));
        let coat = CoatAlbedo::new(&facets, lowest, highest);
        Ok(Self { coat, reflectance, index, facets, has_base, interreflection: false })
    }

    /// Returns the surface with `reflectance` as that of the bare base, ρ_b. The coat reflects the
    /// fraction R = 1 − (1−Ē)/n² of the diffuse light back to the base, so less, ρ =
    /// ρ_b·(1−R)/(1−ρ_b·R), leaves the coat (Saunderson 1942).
    #[must_use]
    pub fn with_interreflection(self) -> Self {
        Self { interreflection: true, ..self }
    }

    /// Returns Ē, the fraction of diffuse light that the coat reflects at a wavelength in nm.
    pub fn coat_albedo(&self, nm: f64) -> f64 {
        self.coat.mean(self.index.n(nm))
    }

    /// Returns ρ, the fraction of the light inside the coat that leaves the coat again.
    fn base(&self, texel: Texel, nm: f64) -> f64 {
        let reflectance = self.reflectance.at(texel, nm);
        if !self.interreflection {
            return reflectance;
        }
        let index = self.index.n(nm);
        let escaping = (1.0 - self.coat.mean(index)) / (index * index);
        reflectance * escaping / (1.0 - reflectance + reflectance * escaping)
    }

    pub(super) fn without_textures(self) -> Self {
        Self { reflectance: self.reflectance.without_texture(), ..self }
    }

    /// Returns the directional albedo of coat and base at the cosine of `wo`, and that of the coat.
    fn albedo(&self, wo: DVec3, texel: Texel, nm: f64) -> (f64, f64) {
        let coat = self.coat.at(wo.z.abs(), self.index.n(nm));
        (coat + self.base(texel, nm) * (1.0 - coat), coat)
    }

    fn coat_probability(&self, wo: DVec3, texel: Texel, nm: f64) -> f64 {
        let (all, coat) = self.albedo(wo, texel, nm);
        if coat == 0.0 {
            0.0
        } else if self.has_base {
            (coat / all).clamp(MIN_LOBE_PROBABILITY, 1.0 - MIN_LOBE_PROBABILITY)
        } else {
            1.0
        }
    }

    pub(super) fn sample(&self, wo: DVec3, texel: Texel, nm: f64, u: [f64; 3]) -> BsdfSample {
        let sign = z_sign(wo);
        let coat_probability = self.coat_probability(wo, texel, nm);
        let wi = if u[2] < coat_probability {
            let up = flip_z(wo, sign);
            let m = self.facets.sample_visible(up, u[0], u[1]);
            flip_z(fresnel::reflect(up, m), sign)
        } else {
            sample_cosine(sign, u[0], u[1])
        };
        // A facet may reflect below the surface, where the BSDF is 0 and any positive pdf valid.
        let pdf = self.mixed_pdf(wo, wi, coat_probability);
        BsdfSample::lobe(wi, ScatterEvent::Reflection, if pdf > 0.0 { pdf } else { 1.0 })
    }

    pub(super) fn absorbed_fraction(&self, wo: DVec3, texel: Texel, nm: f64) -> f64 {
        let (_, coat) = self.albedo(wo, texel, nm);
        (1.0 - coat) * (1.0 - self.base(texel, nm))
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, texel: Texel, nm: f64) -> f64 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let index = self.index.n(nm);
        let (coat_o, coat_i) = (self.coat.at(wo.z.abs(), index), self.coat.at(wi.z.abs(), index));
        // If the coat reflects all light, the lower bound prevents 0/0.
        let through = (1.0 - coat_o) * (1.0 - coat_i) / (1.0 - self.coat.mean(index)).max(f64::MIN_POSITIVE);
        self.eval_coat(wo, wi, nm) + self.base(texel, nm) * FRAC_1_PI * through
    }

    /// Evaluates the light that the coat reflects.
    pub(super) fn eval_coat(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let m = (wo + wi).normalize_or_zero();
        let lobe = self.facets.reflection_lobe(flip_z(m, z_sign(wo)), wo.z.abs(), wi.z.abs());
        fresnel::dielectric(wo.dot(m), 1.0, self.index.n(nm)) * lobe
    }

    /// Returns the index of the coat relative to the surrounding medium.
    pub(super) fn coat_index(&self, nm: f64) -> f64 {
        self.index.n(nm)
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, texel: Texel, nm: f64) -> f64 {
        self.mixed_pdf(wo, wi, self.coat_probability(wo, texel, nm))
    }

    /// Returns the pdf of `wi` per solid angle if the coat has this probability.
    fn mixed_pdf(&self, wo: DVec3, wi: DVec3, coat_probability: f64) -> f64 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let m = flip_z((wo + wi).normalize_or_zero(), z_sign(wo));
        let coat = 0.25 * self.facets.g1_per_cos(wo.z.abs()) * self.facets.eval(m);
        coat_probability * coat + (1.0 - coat_probability) * cosine_pdf(wi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::Spectrum;

    /// For a polished coat of index 1.5, the diffuse reflectance is 0.0918 outside and 0.5963
    /// inside (Walsh 1926). A base of 0.5 then reflects 0.2877 of the light in the coat.
    #[test]
    fn interreflection_under_the_coat_lowers_the_reflectance() {
        let index = RefractiveIndex::constant(1.5).unwrap();
        let coated = |reflectance| {
            Glossy::new(Spectrum::constant(reflectance), index.clone(), 0.0).unwrap().with_interreflection()
        };
        let found = coated(0.5).base(Texel::default(), 550.0);
        assert!((found - 0.2877).abs() < 0.003, "{found}");
        assert_eq!(coated(1.0).base(Texel::default(), 550.0), 1.0, "a white base absorbs nothing");
    }
}
