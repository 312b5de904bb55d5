//! Rough interfaces between two dielectrics, with or without thin films on the facets.

use glam::DVec3;

use super::compensation::{DielectricCompensation, MultipleScattering};
use super::facet::FacetResponse;
use super::hemisphere::{flip_z, z_sign};
use super::power::PowerFractions;
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode, radiance_scale};
use crate::fresnel;
use crate::microfacet::Ggx;

/// The microfacets of a rough interface. The GGX model of Walter et al. 2007 describes the light
/// that hits one facet, and a wide lobe that which hits several (`compensation.rs`).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RoughInterface {
    pub(super) ggx: Ggx,
    pub(super) compensation: DielectricCompensation,
}

impl RoughInterface {
    pub(super) fn new(alpha: f64) -> Self {
        let ggx = Ggx::new(alpha);
        Self { ggx, compensation: DielectricCompensation::new(ggx) }
    }
}

/// A rough interface at one wavelength, for light from the side of `wo`. `sample`, `eval` and `pdf`
/// accept directions on both sides; in all other methods, `wo` lies in the upper hemisphere.
pub(super) struct FacetScattering<'a, R> {
    pub(super) ggx: &'a Ggx,
    pub(super) facet: R,
    pub(super) multiple: MultipleScattering<'a>,
    /// Of the medium on the side of `wo` and of the other medium. They differ.
    pub(super) indices: [f64; 2],
}

impl<R: FacetResponse> FacetScattering<'_, R> {
    /// Samples a direction with its pdf per solid angle, or returns `None` if that is 0.
    pub(super) fn sample(&self, wo: DVec3, iors: InterfaceIors<'_>, u: [f64; 3]) -> Option<BsdfSample> {
        let sample = self.sample_upper(flip_z(wo, z_sign(wo)), u)?;
        let disperses = sample.event == ScatterEvent::Transmission && (iors.is_dispersive());
        Some(BsdfSample { wi: flip_z(sample.wi, z_sign(wo)), disperses, ..sample })
    }

    /// Evaluates f(wo, wi) in 1/sr at the wavelength `nm`.
    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        self.eval_scaled((wo, wi), iors, mode, nm, Self::eval_upper)
    }

    /// Evaluates the part of [`Self::eval`] of light that hits one facet.
    pub(super) fn eval_facet(
        &self,
        wo: DVec3,
        wi: DVec3,
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        self.eval_scaled((wo, wi), iors, mode, nm, |facets, wo, wi| facets.eval_single(wo, wi))
    }

    #[inline]
    fn eval_scaled(
        &self,
        (wo, wi): (DVec3, DVec3),
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: f64,
        eval_upper: impl Fn(&Self, DVec3, DVec3) -> f64,
    ) -> f64 {
        let (wo, wi) = (flip_z(wo, z_sign(wo)), flip_z(wi, z_sign(wo)));
        if wi.z == 0.0 {
            return 0.0;
        }
        let scale = match event_towards(wi) {
            ScatterEvent::Reflection => 1.0,
            ScatterEvent::Transmission => radiance_scale(iors, mode, nm),
        };
        eval_upper(self, wo, wi) * scale
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let (wo, wi) = (flip_z(wo, z_sign(wo)), flip_z(wi, z_sign(wo)));
        if wi.z == 0.0 { 0.0 } else { self.pdf_upper(wo, wi, self.multiple.albedo(wo.z)) }
    }

    fn sample_upper(&self, wo: DVec3, u: [f64; 3]) -> Option<BsdfSample> {
        let [n_i, n_t] = self.indices;
        let probability = self.multiple.albedo(wo.z);
        let (wi, event) = if u[2] < probability {
            let (wi, event) = self.multiple.sample([u[0], u[1], u[2] / probability]);
            (if event == ScatterEvent::Transmission { flip_z(wi, -1.0) } else { wi }, event)
        } else {
            let choice = (u[2] - probability) / (1.0 - probability);
            let m = self.ggx.sample_visible(wo, u[0], u[1]);
            if choice < self.facet.reflection_probability(self.facet.powers(wo.dot(m))) {
                (fresnel::reflect(wo, m), ScatterEvent::Reflection)
            } else {
                (fresnel::refract(wo, m, n_i, n_t)?, ScatterEvent::Transmission)
            }
        };
        let sample = BsdfSample::lobe(wi, event, 1.0);
        let pdf = if sample.on_event_side(wo) { self.pdf_upper(wo, wi, probability) } else { 1.0 };
        (pdf > 0.0).then_some(BsdfSample { probability: pdf, ..sample })
    }

    /// Evaluates f(wo, wi) in 1/sr for power.
    fn eval_upper(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.eval_single(wo, wi) + self.multiple.eval(wo.z, wi.z.abs(), event_towards(wi))
    }

    /// Evaluates the light that hits one facet, in 1/sr for power.
    fn eval_single(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.half_vector(wo, wi).map_or(0.0, |half_vector| {
            let masking = self.ggx.g2_per_cos(wo.z, wi.z.abs());
            let fraction = self.facet.powers(half_vector.cos_o).of_event(event_towards(wi));
            // At grazing angles, the Jacobian may be so large that other products overflow.
            fraction * self.ggx.eval(half_vector.m) * (half_vector.jacobian * half_vector.cos_o) * masking
        })
    }

    /// Returns the pdf of `wi`, with `probability` for the lobe of multiple scattering.
    fn pdf_upper(&self, wo: DVec3, wi: DVec3, probability: f64) -> f64 {
        let event = event_towards(wi);
        let single = self.half_vector(wo, wi).map_or(0.0, |half_vector| {
            let visible = self.ggx.g1_per_cos(wo.z) * self.ggx.eval(half_vector.m) * half_vector.cos_o;
            let reflected = self.facet.reflection_probability(self.facet.powers(half_vector.cos_o));
            let fraction = PowerFractions { reflected, transmitted: 1.0 - reflected }.of_event(event);
            fraction * visible * half_vector.jacobian
        });
        (1.0 - probability) * single + probability * self.multiple.pdf(wi.z.abs(), event)
    }

    /// Returns the fractions of the reflected and of the refracted light that hit another facet.
    pub(super) fn shadowed(&self, wo: DVec3, m: DVec3) -> [f64; 2] {
        let hidden = |upwards: f64| if upwards > 0.0 { self.ggx.shadowed_fraction(wo.z, upwards) } else { 1.0 };
        let refracted = fresnel::refract(wo, m, self.indices[0], self.indices[1]);
        [hidden(fresnel::reflect(wo, m).z), refracted.map_or(1.0, |refracted| hidden(-refracted.z))]
    }

    /// Returns the half vector, or `None` if no facet connects the two directions.
    fn half_vector(&self, wo: DVec3, wi: DVec3) -> Option<HalfVector> {
        let [n_i, n_t] = self.indices;
        if wi.z > 0.0 {
            let m = (wo + wi).normalize_or_zero();
            let cos_o = wo.dot(m);
            // dω_m/dω_i = 1/(4·|o·m|) (Walter et al. 2007, equation 14).
            return (cos_o > 0.0).then(|| HalfVector { m, cos_o, jacobian: 0.25 / cos_o });
        }
        // The half vector is h = n_i·o + n_t·i (Walter et al. 2007, equation 16), and the Jacobian
        // n_t²·|i·m|/(n_i(o·m) + n_t(i·m))² (equation 17) with the denominator |h|².
        let along = wo * n_i + wi * n_t;
        let m = along.normalize_or_zero() * along.z.signum();
        let (cos_o, cos_i) = (wo.dot(m), -wi.dot(m));
        let jacobian = n_t * n_t * cos_i / along.length_squared();
        (cos_o > 0.0 && cos_i > 0.0).then_some(HalfVector { m, cos_o, jacobian })
    }
}

fn event_towards(wi: DVec3) -> ScatterEvent {
    if wi.z > 0.0 { ScatterEvent::Reflection } else { ScatterEvent::Transmission }
}

/// The microfacet normal that connects two directions, with `wo` in the upper hemisphere.
struct HalfVector {
    m: DVec3,
    /// |o·m|, > 0.
    cos_o: f64,
    /// The Jacobian dω_m/dω_i.
    jacobian: f64,
}
