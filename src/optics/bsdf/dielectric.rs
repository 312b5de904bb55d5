//! Smooth and rough interfaces between two dielectrics.

use glam::DVec3;

use super::check::check_alpha;
use super::compensation::{DielectricCompensation, MultipleScattering};
use super::hemisphere::{flip_z, z_sign};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
use crate::error::Result;
use crate::optics::fresnel;
use crate::optics::microfacet::{Ggx, MIN_ALPHA};

/// A dielectric interface that reflects by Fresnel's equations and refracts by Snell's law.
///
/// A rough interface uses the GGX model of Walter et al. 2007 for light that hits one facet. A wide
/// lobe contains the light that hits several facets (`compensation.rs`), so that the interface
/// loses no energy. [`InterfaceIors`] contains the two refractive indices. If the two indices are
/// equal, light passes straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct Dielectric {
    /// `None` if the interface is smooth.
    facets: Option<RoughInterface>,
}

#[derive(Debug, Clone, PartialEq)]
struct RoughInterface {
    ggx: Ggx,
    compensation: DielectricCompensation,
}

impl Dielectric {
    /// Creates an interface of GGX roughness `alpha`. If `alpha` is below [`MIN_ALPHA`], the
    /// interface is smooth. Returns an error if `alpha` lies outside \[0, 1\].
    pub fn new(alpha: f64) -> Result<Self> {
        check_alpha(alpha)?;
        let rough = |ggx: Ggx| RoughInterface { ggx, compensation: DielectricCompensation::new(ggx) };
        Ok(Self { facets: (alpha >= MIN_ALPHA).then(|| rough(Ggx::new(alpha))) })
    }

    /// Returns whether the interface is rough, so that its lobes have a finite width.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    pub(super) fn sample(&self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        let (n_i, n_t) = (iors.here.n(nm), iors.there.n(nm));
        if n_i == n_t {
            return Some(BsdfSample::delta(-wo, ScatterEvent::Transmission, 1.0));
        }
        let sign = z_sign(wo);
        let up = flip_z(wo, sign);
        if let Some(facets) = &self.facets {
            return facets.sample(up, iors, nm, u).map(|sample| BsdfSample { wi: flip_z(sample.wi, sign), ..sample });
        }
        let reflected = fresnel::dielectric(up.z, n_i, n_t);
        let sample = if u[2] < reflected {
            BsdfSample::delta(flip_z(DVec3::new(-up.x, -up.y, up.z), sign), ScatterEvent::Reflection, reflected)
        } else {
            let wi = fresnel::refract(up, DVec3::Z, n_i, n_t)?;
            let disperses = iors.here.is_dispersive() || iors.there.is_dispersive();
            BsdfSample { disperses, ..BsdfSample::delta(flip_z(wi, sign), ScatterEvent::Transmission, 1.0 - reflected) }
        };
        (sample.probability > 0.0).then_some(sample)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let sign = z_sign(wo);
        self.facets.as_ref().map_or(0.0, |facets| facets.eval(flip_z(wo, sign), flip_z(wi, sign), iors, mode, nm))
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let sign = z_sign(wo);
        self.facets.as_ref().map_or(0.0, |facets| facets.pdf(flip_z(wo, sign), flip_z(wi, sign), iors, nm))
    }
}

/// In all methods, `wo` lies in the upper hemisphere, and the two indices differ in `sample`.
impl RoughInterface {
    fn sample(&self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        let (n_i, n_t) = (iors.here.n(nm), iors.there.n(nm));
        let multiple = self.compensation.between(n_i, n_t);
        let probability = multiple.albedo(wo.z);
        let (wi, event) = if u[2] < probability {
            let (wi, event) = multiple.sample([u[0], u[1], u[2] / probability]);
            (if event == ScatterEvent::Transmission { flip_z(wi, -1.0) } else { wi }, event)
        } else {
            let choice = (u[2] - probability) / (1.0 - probability);
            let m = self.ggx.sample_visible(wo, u[0], u[1]);
            if choice < fresnel::dielectric(wo.dot(m), n_i, n_t) {
                (fresnel::reflect(wo, m), ScatterEvent::Reflection)
            } else {
                (fresnel::refract(wo, m, n_i, n_t)?, ScatterEvent::Transmission)
            }
        };
        let sample = BsdfSample::lobe(wi, event, 1.0);
        let density = if sample.on_event_side(wo) { self.mixed_pdf(wo, wi, &multiple, [n_i, n_t]) } else { 1.0 };
        let disperses =
            event == ScatterEvent::Transmission && (iors.here.is_dispersive() || iors.there.is_dispersive());
        (density > 0.0).then_some(BsdfSample { probability: density, disperses, ..sample })
    }

    fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let (n_i, n_t) = (iors.here.n(nm), iors.there.n(nm));
        if n_i == n_t || wi.z == 0.0 {
            return 0.0;
        }
        let single = self.half_vector(wo, wi, [n_i, n_t]).map_or(0.0, |half_vector| {
            let masking = self.ggx.g2_per_cos(wo.z, wi.z.abs());
            half_vector.fraction * self.ggx.eval(half_vector.m) * half_vector.jacobian * masking * half_vector.cos_o
        });
        let event = event_towards(wi);
        let multiple = self.compensation.between(n_i, n_t).eval(wo.z, wi.z.abs(), event);
        match event {
            ScatterEvent::Reflection => single + multiple,
            ScatterEvent::Transmission => (single + multiple) * radiance_scale(iors, mode, nm),
        }
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let indices = [iors.here.n(nm), iors.there.n(nm)];
        if indices[0] == indices[1] || wi.z == 0.0 {
            return 0.0;
        }
        self.mixed_pdf(wo, wi, &self.compensation.between(indices[0], indices[1]), indices)
    }

    /// Returns the density of `wi` per solid angle. The lobe of multiple scattering is sampled with
    /// the probability of its albedo.
    fn mixed_pdf(&self, wo: DVec3, wi: DVec3, multiple: &MultipleScattering<'_>, indices: [f64; 2]) -> f64 {
        let single = self.half_vector(wo, wi, indices).map_or(0.0, |half_vector| {
            let visible = self.ggx.g1_per_cos(wo.z) * self.ggx.eval(half_vector.m) * half_vector.cos_o;
            half_vector.fraction * visible * half_vector.jacobian
        });
        let probability = multiple.albedo(wo.z);
        (1.0 - probability) * single + probability * multiple.pdf(wi.z.abs(), event_towards(wi))
    }

    /// Returns the half vector of `wo` and `wi`, or `None` if no facet connects the two directions.
    /// The indices are those of the media on the side of `wo` and on the other side.
    fn half_vector(&self, wo: DVec3, wi: DVec3, [n_i, n_t]: [f64; 2]) -> Option<HalfVector> {
        if wi.z > 0.0 {
            let m = (wo + wi).normalize_or_zero();
            let cos_o = wo.dot(m);
            if cos_o <= 0.0 {
                return None;
            }
            let fraction = fresnel::dielectric(cos_o, n_i, n_t);
            // dω_m/dω_i = 1/(4·|o·m|) (Walter et al. 2007, equation 14).
            return Some(HalfVector { m, cos_o, fraction, jacobian: 0.25 / cos_o });
        }
        // The generalised half vector of refraction is h = n_i·o + n_t·i (Walter et al. 2007,
        // equation 16). The Jacobian is n_t²·|i·m|/(n_i(o·m) + n_t(i·m))² (equation 17). Its
        // denominator equals |h|².
        let along = wo * n_i + wi * n_t;
        let m = along.normalize_or_zero() * along.z.signum();
        let (cos_o, cos_i) = (wo.dot(m), -wi.dot(m));
        if !(cos_o > 0.0 && cos_i > 0.0) {
            return None;
        }
        let fraction = 1.0 - fresnel::dielectric(cos_o, n_i, n_t);
        Some(HalfVector { m, cos_o, fraction, jacobian: n_t * n_t * cos_i / along.length_squared() })
    }
}

/// Returns the event that leads to `wi` from the upper hemisphere.
fn event_towards(wi: DVec3) -> ScatterEvent {
    if wi.z > 0.0 { ScatterEvent::Reflection } else { ScatterEvent::Transmission }
}

/// The microfacet normal that connects two directions. The frame of this normal is chosen so that
/// `wo` lies in the upper hemisphere.
struct HalfVector {
    m: DVec3,
    /// |o·m|, > 0.
    cos_o: f64,
    /// The probability of the event. It is F for reflection and 1 − F for transmission, where F is
    /// the Fresnel reflectance.
    fraction: f64,
    /// The Jacobian dω_m/dω_i.
    jacobian: f64,
}

/// Returns the coefficient of a smooth interface. For reflection, it is the reflectance. For
/// transmission, it is the transmittance times [`radiance_scale`].
pub(super) fn coefficient(
    wo: DVec3,
    event: ScatterEvent,
    iors: InterfaceIors<'_>,
    mode: TransportMode,
    nm: f64,
) -> f64 {
    let reflected = fresnel::dielectric(wo.z, iors.here.n(nm), iors.there.n(nm));
    match event {
        ScatterEvent::Reflection => reflected,
        ScatterEvent::Transmission => (1.0 - reflected) * radiance_scale(iors, mode, nm),
    }
}

/// Returns the factor by which the change of index scales transmitted light. The factor is
/// (n_i/n_t)² for radiance and 1 for power (Veach 1997, §5.2).
pub(super) fn radiance_scale(iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
    match mode {
        TransportMode::Radiance => {
            let ratio = iors.here.n(nm) / iors.there.n(nm);
            ratio * ratio
        }
        TransportMode::Importance => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::glass::RefractiveIndex;

    #[test]
    fn radiance_is_squeezed_by_the_squared_index_and_power_is_not() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.5).unwrap());
        let from_air = InterfaceIors { here: &air, there: &glass };
        let through = |iors, mode| coefficient(DVec3::Z, ScatterEvent::Transmission, iors, mode, 500.0);
        assert!((through(from_air, TransportMode::Importance) - 0.96).abs() < 1e-15);
        // A camera in air sees the radiance from inside the glass divided by 1.5². A camera in
        // glass sees the radiance from the air multiplied by 1.5².
        assert!((through(from_air, TransportMode::Radiance) - 0.96 / 2.25).abs() < 1e-15);
        let from_glass = InterfaceIors { here: &glass, there: &air };
        assert!((through(from_glass, TransportMode::Radiance) - 0.96 * 2.25).abs() < 1e-15);
    }

    /// If both media have the same index, light passes straight on, even if the interface is rough.
    #[test]
    fn equal_indices_transmit_straight_even_if_rough() {
        let water = RefractiveIndex::catalogue("water 20C").unwrap();
        let iors = InterfaceIors { here: &water, there: &water };
        let wo = DVec3::new(0.6, 0.0, -0.8);
        for alpha in [0.0, 0.5] {
            let sample = Dielectric::new(alpha).unwrap().sample(wo, iors, 500.0, [0.3, 0.6, 0.0]).unwrap();
            assert_eq!((sample.wi, sample.delta, sample.disperses), (-wo, true, false));
            assert_eq!(sample.probability, 1.0);
        }
    }

    #[test]
    fn roughness_must_lie_between_0_and_1() {
        for alpha in [-0.1, 1.1, f64::NAN] {
            assert!(Dielectric::new(alpha).unwrap_err().to_string().contains("from 0 to 1"));
        }
    }
}
