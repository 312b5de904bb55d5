//! Smooth and rough interfaces between two dielectrics.

use glam::DVec3;

use super::check::check_alpha;
use super::hemisphere::{flip_z, same_side, z_sign};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
use crate::error::Result;
use crate::optics::fresnel;
use crate::optics::microfacet::{Ggx, MIN_ALPHA};

/// A dielectric interface that reflects by Fresnel's equations and refracts by Snell's law.
///
/// A rough interface uses the single-scattering GGX model of Walter et al. 2007. Light that hits a
/// second facet is counted as absorbed. [`InterfaceIors`] contains the two refractive indices. If
/// the two indices are equal, light passes straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct Dielectric {
    /// `None` if the interface is smooth.
    facets: Option<Ggx>,
}

impl Dielectric {
    /// Creates an interface of GGX roughness `alpha`. If `alpha` is below [`MIN_ALPHA`], the
    /// interface is smooth. Returns an error if `alpha` lies outside \[0, 1\].
    pub fn new(alpha: f64) -> Result<Self> {
        check_alpha(alpha)?;
        Ok(Self { facets: (alpha >= MIN_ALPHA).then(|| Ggx::new(alpha)) })
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
        let m = self.facets.as_ref().map_or(DVec3::Z, |facets| facets.sample_visible(up, u[0], u[1]));
        let reflected = fresnel::dielectric(up.dot(m), n_i, n_t);
        let mut sample = if u[2] < reflected {
            let wi = if self.is_rough() { fresnel::reflect(up, m) } else { DVec3::new(-up.x, -up.y, up.z) };
            BsdfSample::delta(flip_z(wi, sign), ScatterEvent::Reflection, reflected)
        } else {
            let wi = fresnel::refract(up, m, n_i, n_t)?;
            let disperses = iors.here.is_dispersive() || iors.there.is_dispersive();
            BsdfSample { disperses, ..BsdfSample::delta(flip_z(wi, sign), ScatterEvent::Transmission, 1.0 - reflected) }
        };
        if self.is_rough() {
            let density = if sample.on_event_side(wo) { self.pdf(wo, sample.wi, iors, nm) } else { 1.0 };
            sample = BsdfSample { delta: false, probability: density, cos_microfacet: up.dot(m), ..sample };
        }
        (sample.probability > 0.0).then_some(sample)
    }

    pub(super) fn absorbed_fraction(&self, wo: DVec3, sample: &BsdfSample, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| !sample.delta) else {
            return 0.0;
        };
        let lost = if sample.on_event_side(wo) { facets.shadowed_fraction(wo.z.abs(), sample.wi.z.abs()) } else { 1.0 };
        // The event was sampled with the Fresnel factor at the hero wavelength. At another
        // wavelength, the reflected power is the Fresnel factor at that wavelength divided by the
        // probability of the event.
        match sample.event {
            ScatterEvent::Reflection => {
                lost * fresnel::dielectric(sample.cos_microfacet, iors.here.n(nm), iors.there.n(nm))
                    / sample.event_probability
            }
            ScatterEvent::Transmission => lost,
        }
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let Some(half_vector) = self.half_vector(wo, wi, iors, nm) else {
            return 0.0;
        };
        let masking = half_vector.ggx.g2_per_cos(wo.z.abs(), wi.z.abs());
        let common = half_vector.fraction * half_vector.ggx.eval(half_vector.m) * half_vector.jacobian * masking;
        match half_vector.event {
            ScatterEvent::Reflection => common * half_vector.cos_o,
            ScatterEvent::Transmission => common * half_vector.cos_o * radiance_scale(iors, mode, nm),
        }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let Some(half_vector) = self.half_vector(wo, wi, iors, nm) else {
            return 0.0;
        };
        let visible = half_vector.ggx.g1_per_cos(wo.z.abs()) * half_vector.ggx.eval(half_vector.m) * half_vector.cos_o;
        half_vector.fraction * visible * half_vector.jacobian
    }

    /// Returns the half vector of `wo` and `wi`, or `None` if no facet connects the two directions.
    fn half_vector(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> Option<HalfVector<'_>> {
        let ggx = self.facets.as_ref()?;
        let (n_i, n_t) = (iors.here.n(nm), iors.there.n(nm));
        if n_i == n_t || wi.z == 0.0 {
            return None;
        }
        let sign = z_sign(wo);
        let (up, wi_up) = (flip_z(wo, sign), flip_z(wi, sign));
        if same_side(wo, wi) {
            let m = (up + wi_up).normalize_or_zero();
            let cos_o = up.dot(m);
            if cos_o <= 0.0 {
                return None;
            }
            let fraction = fresnel::dielectric(cos_o, n_i, n_t);
            // dω_m/dω_i = 1/(4·|o·m|) (Walter et al. 2007, equation 14).
            return Some(HalfVector {
                ggx,
                m,
                cos_o,
                fraction,
                jacobian: 0.25 / cos_o,
                event: ScatterEvent::Reflection,
            });
        }
        // The generalised half vector of refraction is h = n_i·o + n_t·i (Walter et al. 2007,
        // equation 16). The Jacobian is n_t²·|i·m|/(n_i(o·m) + n_t(i·m))² (equation 17). Its
        // denominator equals |h|².
        let along = up * n_i + wi_up * n_t;
        let m = along.normalize_or_zero() * along.z.signum();
        let (cos_o, cos_i) = (up.dot(m), -wi_up.dot(m));
        if !(cos_o > 0.0 && cos_i > 0.0) {
            return None;
        }
        let fraction = 1.0 - fresnel::dielectric(cos_o, n_i, n_t);
        let jacobian = n_t * n_t * cos_i / along.length_squared();
        Some(HalfVector { ggx, m, cos_o, fraction, jacobian, event: ScatterEvent::Transmission })
    }
}

/// The microfacet normal that connects two directions. The frame of this normal is chosen so that
/// `wo` lies in the upper hemisphere.
struct HalfVector<'a> {
    ggx: &'a Ggx,
    m: DVec3,
    /// |o·m|, > 0.
    cos_o: f64,
    /// The probability of the event. It is F for reflection and 1 − F for transmission, where F is
    /// the Fresnel reflectance.
    fraction: f64,
    /// The Jacobian dω_m/dω_i.
    jacobian: f64,
    event: ScatterEvent,
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
fn radiance_scale(iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
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
