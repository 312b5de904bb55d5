//! The types that BSDFs and integrators exchange.

use glam::DVec3;

use super::hemisphere;
use crate::glass::RefractiveIndex;

/// The quantity that a path transports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransportMode {
    /// Radiance, transported by camera paths against the light. A transmitted path gains the factor
    /// (n_here/n_there)², because radiance scales with the squared index (Veach 1997, §5.2).
    Radiance,
    /// Power, transported by photons along the light, without a factor for the change of index.
    Importance,
}

/// The refractive indices on the two sides of a surface, named relative to the direction `wo`.
#[derive(Debug, Clone, Copy)]
pub struct InterfaceIors<'a> {
    /// Index of the medium on the side of `wo`.
    pub here: &'a RefractiveIndex,
    /// Index of the medium on the other side.
    pub there: &'a RefractiveIndex,
}

impl InterfaceIors<'_> {
    /// Returns true if refraction depends on the wavelength.
    #[inline]
    pub fn is_dispersive(self) -> bool {
        self.here.is_dispersive() || self.there.is_dispersive()
    }
}

/// Returns the factor of transmitted light: (n_i/n_t)² for radiance (Veach 1997, §5.2), else 1.
pub(super) fn radiance_scale(iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
    match mode {
        TransportMode::Radiance => {
            let ratio = iors.here.n(nm) / iors.there.n(nm);
            ratio * ratio
        }
        TransportMode::Importance => 1.0,
    }
}

/// The classes of BSDFs, by which the integrators choose their strategy, by increasing lobe width.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BsdfClass {
    /// Absorbs all light.
    Absorbing,
    /// Discrete directions only (delta distributions).
    Specular,
    /// A lobe that may be narrow, so camera paths sample a direction of it and continue.
    Glossy,
    /// A wide lobe, so photons are stored and gathered at surfaces of this class.
    Diffuse,
}

/// The side of the surface on which a scattered path continues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScatterEvent {
    /// The side of `wo`.
    Reflection,
    /// The side opposite to `wo`.
    Transmission,
}

/// A sampled direction of scattering.
///
/// On a rough surface, `wi` may lie on the wrong side for the `event`. The path then ends:
/// [`LocalBsdf::eval_sample`](super::LocalBsdf::eval_sample) is 0 at all wavelengths, and
/// [`LocalBsdf::absorbed_fraction`](super::LocalBsdf::absorbed_fraction) is the lost power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// The direction, a unit vector.
    pub wi: DVec3,
    /// Reflection or transmission.
    pub event: ScatterEvent,
    /// True if `wi` comes from a delta distribution.
    pub delta: bool,
    /// The probability of the event if `delta`, or the pdf of `wi` in 1/sr. Positive.
    pub probability: f64,
    /// True if `wi` depends on the wavelength, so that the path can keep only one: after
    /// diffraction, or after refraction between media of which at least one is dispersive.
    pub disperses: bool,
    /// Between `wo` and the sampled normal, for rough metals and rough coated interfaces.
    pub(super) cos_microfacet: f64,
    /// The fractions of the reflected and of the refracted light that hit another microfacet, for
    /// rough metals (the first) and rough coated interfaces (both).
    pub(super) shadowed: [f64; 2],
    pub(super) component: usize,
}

impl BsdfSample {
    pub(super) fn delta(wi: DVec3, event: ScatterEvent, probability: f64) -> Self {
        Self { delta: true, ..Self::lobe(wi, event, probability) }
    }

    pub(super) fn lobe(wi: DVec3, event: ScatterEvent, pdf: f64) -> Self {
        Self {
            wi,
            event,
            delta: false,
            probability: pdf,
            disperses: false,
            cos_microfacet: 1.0,
            shadowed: [0.0; 2],
            component: 0,
        }
    }

    /// Returns true if `wi` lies on the correct side of the surface for `event`.
    pub(super) fn on_event_side(&self, wo: DVec3) -> bool {
        let same_side = hemisphere::same_side(wo, self.wi);
        match self.event {
            ScatterEvent::Reflection => same_side,
            ScatterEvent::Transmission => !same_side && self.wi.z != 0.0,
        }
    }
}
