//! The response of single facets to light.

use super::power::PowerFractions;
use crate::fresnel;

/// The response of a facet to light at one wavelength.
pub(super) trait FacetResponse {
    /// Returns the reflected and the transmitted fraction at this cosine of incidence.
    fn powers(&self, cos: f64) -> PowerFractions;

    /// Returns the probability with which a sample is reflected by a facet of these powers.
    fn reflection_probability(&self, powers: PowerFractions) -> f64;
}

/// A facet without films, which reflects by Fresnel's equations.
pub(super) struct BareFacet {
    /// Of the medium on the side of `wo` and of the other medium.
    pub(super) indices: [f64; 2],
}

impl FacetResponse for BareFacet {
    fn powers(&self, cos: f64) -> PowerFractions {
        let reflected = fresnel::dielectric(cos, self.indices[0], self.indices[1]);
        PowerFractions { reflected, transmitted: 1.0 - reflected }
    }

    fn reflection_probability(&self, powers: PowerFractions) -> f64 {
        powers.reflected
    }
}
