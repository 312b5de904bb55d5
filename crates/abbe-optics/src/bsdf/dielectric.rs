//! Smooth and rough interfaces between two dielectrics.

use glam::DVec3;

use super::check::check_alpha;
use super::facet::BareFacet;
use super::hemisphere::{flip_z, z_sign};
use super::power::PowerFractions;
use super::rough_interface::{FacetScattering, RoughInterface};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode, radiance_scale};
use crate::fresnel;
use crate::microfacet::MIN_ALPHA;
use abbe_spectra::error::Result;

/// A dielectric interface that reflects by Fresnel's equations and refracts by Snell's law.
///
/// A rough interface uses the GGX model of Walter et al. 2007 for light that hits one facet, and a
/// wide lobe for light that hits several (`compensation.rs`), so that it loses no energy. Between
/// equal indices in [`InterfaceIors`], light passes straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct Dielectric {
    /// `None` if the interface is smooth.
    pub(super) facets: Option<RoughInterface>,
}

impl Dielectric {
    /// Creates an interface of GGX roughness `alpha`, which is smooth if `alpha` is below
    /// [`MIN_ALPHA`]. Returns an error if `alpha` lies outside \[0, 1\].
    pub fn new(alpha: f64) -> Result<Self> {
        check_alpha(alpha)?;
        Ok(Self { facets: (alpha >= MIN_ALPHA).then(|| RoughInterface::new(alpha)) })
    }

    /// Returns true if the interface is rough, so that its lobes have a finite width.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    /// Returns the roughness α, or `None` if the surface is smooth.
    pub(super) fn alpha(&self) -> Option<f64> {
        self.facets.as_ref().map(|facets| facets.ggx.alpha())
    }

    pub(super) fn sample(&self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        let (n_i, n_t) = (iors.here.n(nm), iors.there.n(nm));
        if n_i == n_t {
            return Some(BsdfSample::delta(-wo, ScatterEvent::Transmission, 1.0));
        }
        if let Some(facets) = self.facets_between([n_i, n_t]) {
            return facets.sample(wo, iors, u);
        }
        let sign = z_sign(wo);
        let up = flip_z(wo, sign);
        let reflected = fresnel::dielectric(up.z, n_i, n_t);
        let sample = if u[2] < reflected {
            BsdfSample::delta(flip_z(DVec3::new(-up.x, -up.y, up.z), sign), ScatterEvent::Reflection, reflected)
        } else {
            let wi = fresnel::refract(up, DVec3::Z, n_i, n_t)?;
            let sample = BsdfSample::delta(flip_z(wi, sign), ScatterEvent::Transmission, 1.0 - reflected);
            BsdfSample { disperses: iors.is_dispersive(), ..sample }
        };
        (sample.probability > 0.0).then_some(sample)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let facets = self.facets_between([iors.here.n(nm), iors.there.n(nm)]);
        facets.map_or(0.0, |facets| facets.eval(wo, wi, iors, mode, nm))
    }

    /// Evaluates the light that hits one facet of a rough interface.
    pub(super) fn eval_facet(
        &self,
        wo: DVec3,
        wi: DVec3,
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        let facets = self.facets_between([iors.here.n(nm), iors.there.n(nm)]);
        facets.map_or(0.0, |facets| facets.eval_facet(wo, wi, iors, mode, nm))
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let facets = self.facets_between([iors.here.n(nm), iors.there.n(nm)]);
        facets.map_or(0.0, |facets| facets.pdf(wo, wi))
    }

    /// Returns the facets at one wavelength, with the index on the side of `wo` first, or `None` if
    /// the interface is smooth or the indices are equal.
    fn facets_between(&self, indices: [f64; 2]) -> Option<FacetScattering<'_, BareFacet>> {
        let RoughInterface { ggx, compensation } = self.facets.as_ref().filter(|_| indices[0] != indices[1])?;
        let multiple = compensation.between(indices[0], indices[1]);
        Some(FacetScattering { ggx, facet: BareFacet { indices }, multiple, indices })
    }
}

/// Returns the reflectance of a smooth interface, or its transmittance times [`radiance_scale`].
pub(super) fn coefficient(
    wo: DVec3,
    event: ScatterEvent,
    iors: InterfaceIors<'_>,
    mode: TransportMode,
    nm: f64,
) -> f64 {
    let PowerFractions { reflected, transmitted } = powers(wo, iors, nm);
    match event {
        ScatterEvent::Reflection => reflected,
        ScatterEvent::Transmission => transmitted * radiance_scale(iors, mode, nm),
    }
}

/// Returns R and T of a smooth interface.
pub(super) fn powers(wo: DVec3, iors: InterfaceIors<'_>, nm: f64) -> PowerFractions {
    let reflected = fresnel::dielectric(wo.z, iors.here.n(nm), iors.there.n(nm));
    PowerFractions { reflected, transmitted: 1.0 - reflected }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glass::RefractiveIndex;

    #[test]
    fn radiance_is_squeezed_by_the_squared_index_and_power_is_not() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.5).unwrap());
        let from_air = InterfaceIors { here: &air, there: &glass };
        let through = |iors, mode| coefficient(DVec3::Z, ScatterEvent::Transmission, iors, mode, 500.0);
        assert!((through(from_air, TransportMode::Importance) - 0.96).abs() < 1e-15);
        // A camera in air sees the radiance from inside the glass divided by 1.5², and a camera in
        // glass sees that from the air multiplied by it.
        assert!((through(from_air, TransportMode::Radiance) - 0.96 / 2.25).abs() < 1e-15);
        let from_glass = InterfaceIors { here: &glass, there: &air };
        assert!((through(from_glass, TransportMode::Radiance) - 0.96 * 2.25).abs() < 1e-15);
    }

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
