//! Scattering functions of surfaces (BSDFs): reflection, transmission and absorption.
//!
//! Directions are unit vectors in the local frame of the surface, with z along the outward normal.
//! `wo` and `wi` both point away from the surface. Both photon paths and camera paths arrive along
//! −`wo` and continue along `wi`. If `wo.z` is negative, the path arrives from behind the surface.
//!
//! A path scatters in three steps. [`Bsdf::sample_component`] selects one component of a mixture.
//! [`Bsdf::sample`] samples `wi` at the hero wavelength of the path. The third step computes a
//! weight and an absorbed fraction for each wavelength of the path. The weight is
//! [`Bsdf::eval_sample`] divided by [`BsdfSample::probability`]. The absorbed fraction of the
//! arriving power is [`Bsdf::absorbed_fraction`]. For photons, the expected weight and the expected
//! absorbed fraction sum to 1. The energy ledger relies on this balance, and the contract tests
//! check it for every BSDF.
//!
//! Each variant has its own file. Each variant is documented at its type. Every variant must pass
//! the tests in `contract`.

mod albedo;
mod check;
mod compensation;
mod conductor;
#[cfg(test)]
mod contract;
mod dielectric;
mod diffuse;
mod glossy;
mod hemisphere;
mod mirror;
mod missing_energy;
mod mix;
mod sample;
mod thin;
mod translucent;

use glam::DVec3;

use super::glass::RefractiveIndex;
use crate::error::Result;
use crate::spectrum::Spectrum;

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use glossy::Glossy;
pub use mirror::Mirror;
pub use mix::MixBsdf;
pub use sample::{BsdfClass, BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
pub use thin::ThinDielectric;
pub use translucent::Translucent;

/// A BSDF.
#[derive(Debug, Clone, PartialEq)]
pub enum Bsdf {
    /// Absorbs all light.
    Absorber,
    /// See [`Diffuse`].
    Diffuse(Diffuse),
    /// See [`Translucent`].
    Translucent(Translucent),
    /// See [`Mirror`].
    Mirror(Mirror),
    /// See [`Conductor`].
    Conductor(Conductor),
    /// See [`Dielectric`].
    Dielectric(Dielectric),
    /// See [`ThinDielectric`].
    ThinDielectric(ThinDielectric),
    /// See [`Glossy`].
    Glossy(Glossy),
    /// See [`MixBsdf`].
    Mix(MixBsdf),
}

impl Bsdf {
    /// Creates a [`Diffuse`] BSDF; see [`Diffuse::new`].
    pub fn diffuse(reflectance: Spectrum) -> Result<Self> {
        Diffuse::new(reflectance).map(Self::Diffuse)
    }

    /// Creates a [`Translucent`] BSDF; see [`Translucent::new`].
    pub fn translucent(reflectance: Spectrum, transmittance: Spectrum) -> Result<Self> {
        Translucent::new(reflectance, transmittance).map(Self::Translucent)
    }

    /// Creates a [`Mirror`] BSDF; see [`Mirror::new`].
    pub fn mirror(reflectance: Spectrum) -> Result<Self> {
        Mirror::new(reflectance).map(Self::Mirror)
    }

    /// Creates a [`Conductor`] BSDF; see [`Conductor::new`].
    pub fn conductor(n: Spectrum, k: Spectrum, alpha: f64) -> Result<Self> {
        Conductor::new(n, k, alpha).map(Self::Conductor)
    }

    /// Creates a [`Dielectric`] BSDF; see [`Dielectric::new`].
    pub fn dielectric(alpha: f64) -> Result<Self> {
        Dielectric::new(alpha).map(Self::Dielectric)
    }

    /// Creates a [`ThinDielectric`] BSDF; see [`ThinDielectric::new`].
    pub fn thin_dielectric(index: RefractiveIndex, optical_depth: Option<Spectrum>) -> Result<Self> {
        ThinDielectric::new(index, optical_depth).map(Self::ThinDielectric)
    }

    /// Creates a [`Glossy`] BSDF; see [`Glossy::new`].
    pub fn glossy(reflectance: Spectrum, index: RefractiveIndex, alpha: f64) -> Result<Self> {
        Glossy::new(reflectance, index, alpha).map(Self::Glossy)
    }

    /// Creates a [`MixBsdf`] BSDF; see [`MixBsdf::new`].
    pub fn mix(parts: Vec<(f64, Self)>) -> Result<Self> {
        MixBsdf::new(parts).map(Self::Mix)
    }

    /// Returns the width class of the BSDF. The class of a mixture is the widest class among its
    /// components.
    #[inline(always)]
    pub fn class(&self) -> BsdfClass {
        match self {
            Self::Absorber => BsdfClass::Absorbing,
            Self::Mirror(_) | Self::ThinDielectric(_) => BsdfClass::Specular,
            Self::Conductor(conductor) => rough_class(conductor.is_rough()),
            Self::Dielectric(dielectric) => rough_class(dielectric.is_rough()),
            Self::Glossy(_) => BsdfClass::Glossy,
            Self::Diffuse(_) | Self::Translucent(_) => BsdfClass::Diffuse,
            Self::Mix(mix) => mix.class(),
        }
    }

    /// Returns whether the BSDF transmits light.
    #[inline]
    pub fn is_transmissive(&self) -> bool {
        match self {
            Self::Translucent(_) | Self::Dielectric(_) | Self::ThinDielectric(_) => true,
            Self::Mix(mix) => mix.components().iter().any(Self::is_transmissive),
            Self::Absorber | Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Glossy(_) => false,
        }
    }

    /// Returns the spectra of the BSDF, such as reflectances. The refractive indices of dielectrics
    /// are not included.
    pub fn spectra(&self) -> Vec<&Spectrum> {
        match self {
            Self::Absorber | Self::Dielectric(_) => Vec::new(),
            Self::ThinDielectric(thin) => thin.optical_depth.iter().collect(),
            Self::Diffuse(diffuse) => vec![&diffuse.reflectance],
            Self::Translucent(sheet) => vec![&sheet.reflectance, &sheet.transmittance],
            Self::Mirror(mirror) => vec![&mirror.reflectance],
            Self::Conductor(metal) => vec![&metal.n, &metal.k],
            Self::Glossy(glossy) => vec![&glossy.reflectance],
            Self::Mix(mix) => mix.components().iter().flat_map(Self::spectra).collect(),
        }
    }

    /// Selects a component of a mixture by the random number `u` in \[0, 1). The probability of a
    /// component is its normalised weight. Any other BSDF returns itself.
    #[inline]
    pub fn sample_component(&self, u: f64) -> &Self {
        match self {
            Self::Mix(mix) => mix.sample_component(u),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::ThinDielectric(_)
            | Self::Glossy(_) => self,
        }
    }

    /// Iterates over the components of a mixture, which are never mixtures themselves. Any other
    /// BSDF yields itself.
    pub fn components(&self) -> impl Iterator<Item = &Self> {
        let components = match self {
            Self::Mix(mix) => mix.components(),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::ThinDielectric(_)
            | Self::Glossy(_) => std::slice::from_ref(self),
        };
        components.iter()
    }

    /// Samples a direction at the hero wavelength `nm`.
    ///
    /// `u[0]` and `u[1]` choose the direction; `u[2]` chooses between reflection and transmission
    /// or between lobes. All three lie in \[0, 1). A mixture first selects a component by `u[2]`.
    /// The probability in the sample then refers to that component alone. It is not multiplied by
    /// the weight of the component. Returns `None` if the event absorbs the light of all
    /// wavelengths. For example, a facet of a rough metal may reflect the path below the surface.
    /// The distribution of the samples does not depend on the [`TransportMode`].
    #[inline]
    pub fn sample(&self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        match self {
            Self::Absorber => None,
            Self::Diffuse(diffuse) => Some(diffuse.sample(wo, u)),
            Self::Translucent(translucent) => translucent.sample(wo, nm, u),
            Self::Mirror(mirror) => Some(mirror.sample(wo)),
            Self::Conductor(conductor) => Some(conductor.sample(wo, u)),
            Self::Dielectric(dielectric) => dielectric.sample(wo, iors, nm, u),
            Self::ThinDielectric(thin) => Some(thin.sample(wo, iors, nm, u)),
            Self::Glossy(glossy) => Some(glossy.sample(wo, nm, u)),
            Self::Mix(mix) => {
                let mut choice = u[2];
                let component = mix.sample_index(&mut choice);
                let sample = mix.components()[component].sample(wo, iors, nm, [u[0], u[1], choice])?;
                Some(BsdfSample { component, ..sample })
            }
        }
    }

    /// Evaluates a sample at the wavelength `nm`. The weight of the path is the result divided by
    /// `sample.probability`.
    ///
    /// If the sample is a delta sample, the result is the reflectance or the transmittance. The
    /// transmittance includes the n² factor of [`TransportMode::Radiance`]. The result does not
    /// include the probability of the event. If the sample is not a delta sample, the result is
    /// f·|cosθ_i| in 1/sr.
    pub fn eval_sample(
        &self,
        wo: DVec3,
        sample: &BsdfSample,
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        if let Self::Mix(mix) = self {
            return mix.components()[sample.component].eval_sample(wo, sample, iors, mode, nm);
        }
        if sample.delta {
            return self.coefficient(wo, sample.event, iors, mode, nm);
        }
        if !sample.on_event_side(wo) {
            return 0.0;
        }
        self.eval(wo, sample.wi, iors, mode, nm) * sample.wi.z.abs()
    }

    /// Returns the fraction of the arriving power that is absorbed by this event at `nm`. The
    /// fraction lies in \[0, 1\].
    ///
    /// The fraction is computed from albedos and losses, not as 1 minus the weight. If the mode is
    /// [`TransportMode::Importance`] and the sample was taken at `nm`, the expected weight and the
    /// expected absorbed fraction sum to 1. If [`Bsdf::sample`] returns `None`, all power is
    /// absorbed.
    pub fn absorbed_fraction(&self, wo: DVec3, sample: &BsdfSample, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        match self {
            Self::Absorber => 1.0,
            Self::Diffuse(diffuse) => diffuse.absorbed_fraction(nm),
            Self::Translucent(translucent) => translucent.absorbed_fraction(nm),
            Self::Mirror(mirror) => mirror.absorbed_fraction(nm),
            Self::Conductor(conductor) => conductor.absorbed_fraction(wo, sample, iors, nm),
            Self::Dielectric(_) => 0.0,
            Self::ThinDielectric(thin) => thin.absorbed_fraction(wo, iors, nm),
            Self::Glossy(glossy) => glossy.absorbed_fraction(wo, nm),
            Self::Mix(mix) => mix.components()[sample.component].absorbed_fraction(wo, sample, iors, nm),
        }
    }

    /// Evaluates f(wo, wi) in 1/sr at the wavelength `nm`, without the cosine and without delta
    /// distributions. The value of a mixture is the weighted sum of the values of its components.
    pub fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        match self {
            Self::Absorber | Self::Mirror(_) | Self::ThinDielectric(_) => 0.0,
            Self::Diffuse(diffuse) => diffuse.eval(wo, wi, nm),
            Self::Translucent(translucent) => translucent.eval(wo, wi, nm),
            Self::Conductor(conductor) => conductor.eval(wo, wi, iors, nm),
            Self::Dielectric(dielectric) => dielectric.eval(wo, wi, iors, mode, nm),
            Self::Glossy(glossy) => glossy.eval(wo, wi, nm),
            Self::Mix(mix) => {
                mix.weighted_components().map(|(weight, part)| weight * part.eval(wo, wi, iors, mode, nm)).sum()
            }
        }
    }

    /// Returns the density per solid angle with which [`Bsdf::sample`] samples `wi` if the hero
    /// wavelength is `nm`. Delta distributions are not included. The density of a mixture is the
    /// weighted sum of the densities of its components.
    pub fn pdf(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        match self {
            Self::Absorber | Self::Mirror(_) | Self::ThinDielectric(_) => 0.0,
            Self::Diffuse(diffuse) => diffuse.pdf(wo, wi),
            Self::Translucent(translucent) => translucent.pdf(wo, wi, nm),
            Self::Conductor(conductor) => conductor.pdf(wo, wi),
            Self::Dielectric(dielectric) => dielectric.pdf(wo, wi, iors, nm),
            Self::Glossy(glossy) => glossy.pdf(wo, wi, nm),
            Self::Mix(mix) => mix.weighted_components().map(|(weight, part)| weight * part.pdf(wo, wi, iors, nm)).sum(),
        }
    }

    /// Returns the coefficient of the delta distribution at `nm`. If the BSDF has no delta
    /// distribution, returns 0.
    fn coefficient(
        &self,
        wo: DVec3,
        event: ScatterEvent,
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        match self {
            Self::Mirror(mirror) => mirror.coefficient(nm),
            Self::Conductor(conductor) => conductor.coefficient(wo, iors, nm),
            Self::Dielectric(_) => dielectric::coefficient(wo, event, iors, mode, nm),
            Self::ThinDielectric(thin) => thin.coefficient(wo, event, iors, nm),
            Self::Absorber | Self::Diffuse(_) | Self::Translucent(_) | Self::Glossy(_) | Self::Mix(_) => 0.0,
        }
    }
}

fn rough_class(rough: bool) -> BsdfClass {
    if rough { BsdfClass::Glossy } else { BsdfClass::Specular }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Outside;

    #[test]
    fn fractions_outside_0_to_1_are_refused_and_named() {
        for bad in [-0.1, 1.5, f64::NAN] {
            let message = Bsdf::diffuse(Spectrum::constant(bad)).unwrap_err().to_string();
            assert!(message.contains("reflectance") && message.contains("from 0 to 1"), "{message}");
            assert!(Bsdf::mirror(Spectrum::constant(bad)).is_err());
            let index = RefractiveIndex::constant(1.5).unwrap();
            assert!(Bsdf::glossy(Spectrum::constant(bad), index, 0.1).is_err());
        }
        let spike = Spectrum::table(&[500.0, 500.5, 501.0], &[0.5, 1.2, 0.5], Outside::Hold).unwrap();
        assert!(Bsdf::diffuse(spike).unwrap_err().to_string().contains("a reflectance of 1.2"));
        assert!(Bsdf::conductor(Spectrum::constant(-1.0), Spectrum::constant(2.0), 0.0).is_err());
        assert!(Bsdf::conductor(Spectrum::constant(0.2), Spectrum::constant(3.0), 2.0).is_err());
    }

    #[test]
    fn a_simple_bsdf_is_its_own_only_component() {
        let bsdf = Bsdf::diffuse(Spectrum::constant(0.5)).unwrap();
        assert_eq!(bsdf.sample_component(0.7), &bsdf);
        assert_eq!(bsdf.components().count(), 1);
    }
}
