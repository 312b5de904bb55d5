//! What a surface does to a light path that meets it: reflects, transmits or absorbs it.
//!
//! Directions are unit vectors in the surface's frame, with z along the outward normal; `wo` and `wi` both point away from the
//! surface. `wo` is where the path comes from (back along a photon's flight, or towards the camera), `wi` where it goes on.
//! `wo.z` may be negative: the surface is then seen from behind.
//!
//! A walk asks a surface in three steps: [`Surface::pick`] (one component of a mixture), [`Surface::sample`] (at the path's
//! hero wavelength), and then, for each wavelength that the path carries, [`Surface::response`] over
//! [`Scatter::probability`], which is the path's weight, and [`Surface::absorbed`], which is what the event takes away.
//! The two add up to 1 in the mean, for photons: that is the ledger's balance, and a test of every surface here.
//!
//! The variants, one file each, are documented on their types; `contract` is the test that all of them pass.

mod albedo;
mod conductor;
#[cfg(test)]
mod contract;
mod dielectric;
mod diffuse;
mod glossy;
mod hemisphere;
mod mirror;
mod mix;
mod thin;
mod translucent;

use glam::DVec3;

use super::glass::Index;
use crate::error::{Error, Result};
use crate::spectrum::{BAND_NM, Spectrum};

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use glossy::Glossy;
pub use mirror::Mirror;
pub use mix::Mix;
pub use thin::ThinDielectric;
pub use translucent::Translucent;

/// What the path carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, gathered against the light: camera paths. Radiance is squeezed where light enters a denser medium, so a
    /// transmitted path gains the factor (n_here/n_there)² (Veach 1997, §5.2).
    Radiance,
    /// Power, spread with the light: photons. No such factor.
    Importance,
}

/// The media on the two sides of a surface, as seen from `wo`.
#[derive(Debug, Clone, Copy)]
pub struct Sides<'a> {
    /// The medium on `wo`'s side.
    pub here: &'a Index,
    /// The medium on the other side.
    pub there: &'a Index,
}

/// How a surface spreads light, which decides what the integrators do with it. In rising order of spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Not at all: everything ends here.
    Absorbing,
    /// Into single directions only.
    Specular,
    /// Into a lobe that may be narrow: camera paths go on by sampling it.
    Glossy,
    /// Widely: photons are stored and gathered here.
    Diffuse,
}

/// On which side of the surface the path goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// On `wo`'s side.
    Reflection,
    /// On the other side.
    Transmission,
}

/// One sampled continuation of a path.
///
/// Where a rough surface sends a path into itself, `event` and the side of `wi` disagree: [`Surface::response`] is then 0 at all
/// wavelengths, [`Surface::absorbed`] says what is lost, and the path ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Where the path goes on, a unit vector.
    pub wi: DVec3,
    /// On which side.
    pub event: Event,
    /// Whether `wi` is the only direction that its choice could give.
    pub delta: bool,
    /// If `delta`, the probability of the choice; else the density of `wi` per solid angle. Always > 0.
    pub probability: f64,
    /// Whether `wi` depends on the wavelength: the path can then keep only one. True only for refraction between media of which
    /// at least one disperses.
    pub disperses: bool,
    /// The probability at the hero wavelength of having reflected rather than transmitted, or the reverse.
    choice: f64,
    /// The cosine at the facet that chose (the half vector tells it badly where the facet is seen edge-on).
    facet_cos: f64,
    /// Which component of a [`Mix`] scattered.
    component: usize,
}

impl Scatter {
    fn delta(wi: DVec3, event: Event, probability: f64) -> Self {
        Self {
            wi,
            event,
            delta: true,
            probability,
            disperses: false,
            choice: probability,
            facet_cos: wi.z.abs(),
            component: 0,
        }
    }

    fn spread(wi: DVec3, event: Event, density: f64) -> Self {
        Self {
            wi,
            event,
            delta: false,
            probability: density,
            disperses: false,
            choice: 1.0,
            facet_cos: wi.z.abs(),
            component: 0,
        }
    }

    /// Whether the path gets away from the surface, on the side that its event says.
    fn gets_away(&self, wo: DVec3) -> bool {
        let same_side = hemisphere::same_side(wo, self.wi);
        match self.event {
            Event::Reflection => same_side,
            Event::Transmission => !same_side && self.wi.z != 0.0,
        }
    }
}

/// A surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// Absorbs everything.
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
    /// See [`Mix`].
    Mix(Mix),
}

impl Surface {
    /// [`Diffuse::new`] as a surface.
    pub fn diffuse(reflectance: Spectrum) -> Result<Self> {
        Diffuse::new(reflectance).map(Self::Diffuse)
    }

    /// [`Translucent::new`] as a surface.
    pub fn translucent(reflectance: Spectrum, transmittance: Spectrum) -> Result<Self> {
        Translucent::new(reflectance, transmittance).map(Self::Translucent)
    }

    /// [`Mirror::new`] as a surface.
    pub fn mirror(reflectance: Spectrum) -> Result<Self> {
        Mirror::new(reflectance).map(Self::Mirror)
    }

    /// [`Conductor::new`] as a surface.
    pub fn conductor(n: Spectrum, k: Spectrum, alpha: f64) -> Result<Self> {
        Conductor::new(n, k, alpha).map(Self::Conductor)
    }

    /// [`Dielectric::new`] as a surface.
    pub fn dielectric(alpha: f64) -> Result<Self> {
        Dielectric::new(alpha).map(Self::Dielectric)
    }

    /// [`ThinDielectric::new`] as a surface.
    pub fn thin_dielectric(index: Index) -> Self {
        Self::ThinDielectric(ThinDielectric::new(index))
    }

    /// [`Glossy::new`] as a surface.
    pub fn glossy(reflectance: Spectrum, index: Index, alpha: f64) -> Result<Self> {
        Glossy::new(reflectance, index, alpha).map(Self::Glossy)
    }

    /// [`Mix::new`] as a surface.
    pub fn mix(parts: Vec<(f64, Self)>) -> Result<Self> {
        Mix::new(parts).map(Self::Mix)
    }

    /// How it spreads light; of a mixture, the widest of its components' classes.
    #[inline(always)]
    pub fn class(&self) -> Class {
        match self {
            Self::Absorber => Class::Absorbing,
            Self::Mirror(_) | Self::ThinDielectric(_) => Class::Specular,
            Self::Conductor(conductor) => rough_class(conductor.is_rough()),
            Self::Dielectric(dielectric) => rough_class(dielectric.is_rough()),
            Self::Glossy(_) => Class::Glossy,
            Self::Diffuse(_) | Self::Translucent(_) => Class::Diffuse,
            Self::Mix(mix) => mix.class(),
        }
    }

    /// Whether light gets through to the other side.
    #[inline]
    pub fn lets_through(&self) -> bool {
        match self {
            Self::Translucent(_) | Self::Dielectric(_) | Self::ThinDielectric(_) => true,
            Self::Mix(mix) => mix.components().iter().any(Self::lets_through),
            Self::Absorber | Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Glossy(_) => false,
        }
    }

    /// The reflectances and other functions of wavelength that it is made of, but for the indices of glass.
    pub fn spectra(&self) -> Vec<&Spectrum> {
        match self {
            Self::Absorber | Self::Dielectric(_) | Self::ThinDielectric(_) => Vec::new(),
            Self::Diffuse(diffuse) => vec![&diffuse.reflectance],
            Self::Translucent(sheet) => vec![&sheet.reflectance, &sheet.transmittance],
            Self::Mirror(mirror) => vec![&mirror.reflectance],
            Self::Conductor(metal) => vec![&metal.n, &metal.k],
            Self::Glossy(glossy) => vec![&glossy.reflectance],
            Self::Mix(mix) => mix.components().iter().flat_map(Self::spectra).collect(),
        }
    }

    /// The component that a path meets: of a mixture, one drawn by weight with `u` in \[0, 1), of any other surface the surface itself.
    #[inline]
    pub fn pick(&self, u: f64) -> &Self {
        match self {
            Self::Mix(mix) => mix.pick(u),
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

    /// All components: of a mixture, its parts (never mixtures themselves), of any other surface the surface itself.
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

    /// Draws where a path goes on, by what the surface does at `nm`, the path's hero wavelength. `None` when the surface absorbs
    /// all that arrived, at every wavelength. `u[0]` and `u[1]` choose the direction, `u[2]` between reflection and transmission
    /// or between lobes; all lie in \[0, 1).
    ///
    /// A mixture first picks a component by `u[2]`, and its scatter keeps that component's probability. No surface here draws
    /// otherwise for radiance than for power; the argument stands in the signature for one that would.
    #[inline]
    pub fn sample(&self, wo: DVec3, sides: Sides<'_>, nm: f64, _transport: Transport, u: [f64; 3]) -> Option<Scatter> {
        self.draw(wo, sides, nm, u)
    }

    fn draw(&self, wo: DVec3, sides: Sides<'_>, nm: f64, u: [f64; 3]) -> Option<Scatter> {
        match self {
            Self::Absorber => None,
            Self::Diffuse(diffuse) => Some(diffuse.sample(wo, u)),
            Self::Translucent(translucent) => translucent.sample(wo, nm, u),
            Self::Mirror(mirror) => Some(mirror.sample(wo)),
            Self::Conductor(conductor) => conductor.sample(wo, u),
            Self::Dielectric(dielectric) => dielectric.sample(wo, sides, nm, u),
            Self::ThinDielectric(thin) => Some(thin.sample(wo, sides, nm, u)),
            Self::Glossy(glossy) => Some(glossy.sample(wo, nm, u)),
            Self::Mix(mix) => {
                let mut choice = u[2];
                let component = mix.draw(&mut choice);
                let scatter = mix.components()[component].draw(wo, sides, nm, [u[0], u[1], choice])?;
                Some(Scatter { component, ..scatter })
            }
        }
    }

    /// What the surface sends on towards `scatter.wi` at any wavelength `nm`: for a delta its coefficient (reflectance, or
    /// transmittance × the n² of [`Transport::Radiance`]) without the probability of the choice, else f·|cosθ_i| in 1/sr.
    /// The path's weight at `nm` is this over `scatter.probability`.
    pub fn response(&self, wo: DVec3, scatter: &Scatter, sides: Sides<'_>, transport: Transport, nm: f64) -> f64 {
        if let Self::Mix(mix) = self {
            return mix.components()[scatter.component].response(wo, scatter, sides, transport, nm);
        }
        if scatter.delta {
            return self.coefficient(wo, scatter.event, sides, transport, nm);
        }
        if !scatter.gets_away(wo) {
            return 0.0;
        }
        self.eval(wo, scatter.wi, sides, transport, nm) * scatter.wi.z.abs()
    }

    /// The fraction, in \[0, 1\], of the arriving power that this event absorbs at `nm`, from albedos and losses, never as the
    /// difference from the weight: over many samples at `nm`, the mean of `response/probability` for [`Transport::Importance`]
    /// and the mean of this add up to 1. (Where [`Surface::sample`] gives `None`, all is absorbed.)
    pub fn absorbed(&self, wo: DVec3, scatter: &Scatter, sides: Sides<'_>, nm: f64) -> f64 {
        match self {
            Self::Absorber => 1.0,
            Self::Diffuse(diffuse) => diffuse.absorbed(nm),
            Self::Translucent(translucent) => translucent.absorbed(nm),
            Self::Mirror(mirror) => mirror.absorbed(nm),
            Self::Conductor(conductor) => conductor.absorbed(wo, scatter, sides, nm),
            Self::Dielectric(dielectric) => dielectric.absorbed(wo, scatter, sides, nm),
            Self::ThinDielectric(_) => 0.0,
            Self::Glossy(glossy) => glossy.absorbed(wo, nm),
            Self::Mix(mix) => mix.components()[scatter.component].absorbed(wo, scatter, sides, nm),
        }
    }

    /// The scattering function f(wo, wi) in 1/sr at `nm`, without a cosine and without the deltas; of a mixture, the weighted sum.
    pub fn eval(&self, wo: DVec3, wi: DVec3, sides: Sides<'_>, transport: Transport, nm: f64) -> f64 {
        match self {
            Self::Absorber | Self::Mirror(_) | Self::ThinDielectric(_) => 0.0,
            Self::Diffuse(diffuse) => diffuse.eval(wo, wi, nm),
            Self::Translucent(translucent) => translucent.eval(wo, wi, nm),
            Self::Conductor(conductor) => conductor.eval(wo, wi, sides, nm),
            Self::Dielectric(dielectric) => dielectric.eval(wo, wi, sides, transport, nm),
            Self::Glossy(glossy) => glossy.eval(wo, wi, nm),
            Self::Mix(mix) => {
                mix.weighted().map(|(weight, part)| weight * part.eval(wo, wi, sides, transport, nm)).sum()
            }
        }
    }

    /// The density per solid angle with which [`Surface::sample`] at `nm` draws `wi`, without the deltas; of a mixture, the
    /// weighted sum.
    pub fn pdf(&self, wo: DVec3, wi: DVec3, sides: Sides<'_>, nm: f64) -> f64 {
        match self {
            Self::Absorber | Self::Mirror(_) | Self::ThinDielectric(_) => 0.0,
            Self::Diffuse(diffuse) => diffuse.pdf(wo, wi),
            Self::Translucent(translucent) => translucent.pdf(wo, wi, nm),
            Self::Conductor(conductor) => conductor.pdf(wo, wi),
            Self::Dielectric(dielectric) => dielectric.pdf(wo, wi, sides, nm),
            Self::Glossy(glossy) => glossy.pdf(wo, wi, nm),
            Self::Mix(mix) => mix.weighted().map(|(weight, part)| weight * part.pdf(wo, wi, sides, nm)).sum(),
        }
    }

    /// The strength of a delta at `nm`; 0 for surfaces that have none.
    fn coefficient(&self, wo: DVec3, event: Event, sides: Sides<'_>, transport: Transport, nm: f64) -> f64 {
        match self {
            Self::Mirror(mirror) => mirror.coefficient(nm),
            Self::Conductor(conductor) => conductor.coefficient(wo, sides, nm),
            Self::Dielectric(_) => dielectric::coefficient(wo, event, sides, transport, nm),
            Self::ThinDielectric(thin) => thin.coefficient(wo, event, sides, nm),
            Self::Absorber | Self::Diffuse(_) | Self::Translucent(_) | Self::Glossy(_) | Self::Mix(_) => 0.0,
        }
    }
}

fn rough_class(rough: bool) -> Class {
    if rough { Class::Glossy } else { Class::Specular }
}

/// Whole nanometres of the band, at which spectra of materials are checked.
fn checked_nm() -> impl Iterator<Item = f64> {
    (0..=(BAND_NM.1 - BAND_NM.0) as usize).map(|step| BAND_NM.0 + step as f64)
}

/// Fails where a spectrum leaves \[0, `most`\] within the band, naming it `what`.
fn check_within(what: &str, spectrum: &Spectrum, most: f64) -> Result<()> {
    let possible = |value: f64| value.is_finite() && (0.0..=most).contains(&value);
    // Whole nanometres say where it is wrong; the extremes also see what lies between them.
    let at_nm = checked_nm().find(|nm| !possible(spectrum.at(*nm)));
    let at_nm = at_nm.map(|nm| (spectrum.at(nm), format!(" at {nm} nm")));
    let extreme = || [spectrum.min(), spectrum.max()].into_iter().find(|value| !possible(*value));
    let Some((value, place)) = at_nm.or_else(|| extreme().map(|value| (value, String::new()))) else {
        return Ok(());
    };
    let expected = if most.is_finite() { format!("values from 0 to {most}") } else { "values from 0 up".into() };
    Err(Error::input(format!("a {what} of {value}{place}")).expected(expected))
}

/// Fails unless a roughness lies in \[0, 1\].
fn check_alpha(alpha: f64) -> Result<()> {
    if (0.0..=1.0).contains(&alpha) {
        return Ok(());
    }
    Err(Error::input(format!("a roughness of {alpha}")).expected("a number from 0 to 1"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Outside;

    #[test]
    fn fractions_outside_0_to_1_are_refused_and_named() {
        for bad in [-0.1, 1.5, f64::NAN] {
            let message = Surface::diffuse(Spectrum::constant(bad)).unwrap_err().to_string();
            assert!(message.contains("reflectance") && message.contains("from 0 to 1"), "{message}");
            assert!(Surface::mirror(Spectrum::constant(bad)).is_err());
            let index = Index::constant(1.5).unwrap();
            assert!(Surface::glossy(Spectrum::constant(bad), index, 0.1).is_err());
        }
        let spike = Spectrum::table(&[500.0, 500.5, 501.0], &[0.5, 1.2, 0.5], Outside::Hold).unwrap();
        assert!(Surface::diffuse(spike).unwrap_err().to_string().contains("a reflectance of 1.2"));
        assert!(Surface::conductor(Spectrum::constant(-1.0), Spectrum::constant(2.0), 0.0).is_err());
        assert!(Surface::conductor(Spectrum::constant(0.2), Spectrum::constant(3.0), 2.0).is_err());
    }

    #[test]
    fn a_leaf_is_its_own_component_and_its_own_pick() {
        let surface = Surface::diffuse(Spectrum::constant(0.5)).unwrap();
        assert_eq!(surface.pick(0.7), &surface);
        assert_eq!(surface.components().count(), 1);
    }
}
