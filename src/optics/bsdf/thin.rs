//! The thin dielectric pane: both faces of a slab as one interface.

use glam::DVec3;

use super::sample::{BsdfSample, InterfaceIors, ScatterEvent};
use crate::optics::fresnel;
use crate::optics::glass::RefractiveIndex;

/// A dielectric slab of index n(λ) whose thickness is negligible.
///
/// Light that enters the slab is reflected between the two faces and leaves in two directions. R is
/// the reflectance of one face. Without absorption and interference, the sums over all internal
/// reflections are R′ = R + (1−R)²R/(1−R²) = 2R/(1+R) and T′ = 1 − R′ (Stokes 1862). Transmitted
/// light continues straight on. The medium on the side of `wo` is assumed to be on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinDielectric {
    index: RefractiveIndex,
}

impl ThinDielectric {
    /// Creates a pane from its refractive index.
    pub fn new(index: RefractiveIndex) -> Self {
        Self { index }
    }

    pub(super) fn sample(&self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64, u: [f64; 3]) -> BsdfSample {
        let reflected = self.coefficient(wo, ScatterEvent::Reflection, iors, nm);
        if u[2] < reflected {
            BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, reflected)
        } else {
            BsdfSample::delta(-wo, ScatterEvent::Transmission, 1.0 - reflected)
        }
    }

    pub(super) fn coefficient(&self, wo: DVec3, event: ScatterEvent, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let face = fresnel::dielectric(wo.z, iors.here.n(nm), self.index.n(nm));
        let reflected = 2.0 * face / (1.0 + face);
        match event {
            ScatterEvent::Reflection => reflected,
            ScatterEvent::Transmission => 1.0 - reflected,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_pane_reflects_both_its_faces() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.5).unwrap());
        let pane = ThinDielectric::new(glass);
        let iors = InterfaceIors { here: &air, there: &air };
        // One face reflects 0.04. The sum over all internal reflections is 2·0.04/1.04.
        assert!((pane.coefficient(DVec3::Z, ScatterEvent::Reflection, iors, 500.0) - 0.08 / 1.04).abs() < 1e-15);
        assert!((pane.coefficient(DVec3::Z, ScatterEvent::Transmission, iors, 500.0) - 0.96 / 1.04).abs() < 1e-15);
    }
}
