//! A thin pane: both faces of a slab as one surface.

use glam::DVec3;

use super::{Event, Scatter, Sides};
use crate::optics::fresnel;
use crate::optics::glass::Index;

/// A slab of index n(λ) that is thin against everything around it. Light that enters bounces between the faces; all of its
/// rays leave along two directions, and their sums are R′ = R + (1−R)²R/(1−R²) = 2R/(1+R) and T′ = 1 − R′ (incoherent, no
/// absorption). Transmission goes straight on; the medium on `wo`'s side counts as that on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinDielectric {
    index: Index,
}

impl ThinDielectric {
    /// A pane of this index.
    pub fn new(index: Index) -> Self {
        Self { index }
    }

    pub(super) fn sample(&self, wo: DVec3, sides: Sides<'_>, nm: f64, u: [f64; 3]) -> Scatter {
        let reflected = self.coefficient(wo, Event::Reflection, sides, nm);
        if u[2] < reflected {
            Scatter::delta(DVec3::new(-wo.x, -wo.y, wo.z), Event::Reflection, reflected)
        } else {
            Scatter::delta(-wo, Event::Transmission, 1.0 - reflected)
        }
    }

    pub(super) fn coefficient(&self, wo: DVec3, event: Event, sides: Sides<'_>, nm: f64) -> f64 {
        let face = fresnel::dielectric(wo.z, sides.here.n(nm), self.index.n(nm));
        let reflected = 2.0 * face / (1.0 + face);
        match event {
            Event::Reflection => reflected,
            Event::Transmission => 1.0 - reflected,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_pane_reflects_both_its_faces() {
        let (air, glass) = (Index::constant(1.0).unwrap(), Index::constant(1.5).unwrap());
        let pane = ThinDielectric::new(glass);
        let sides = Sides { here: &air, there: &air };
        // One face reflects 0.04; the sum over all bounces is 2·0.04/1.04.
        assert!((pane.coefficient(DVec3::Z, Event::Reflection, sides, 500.0) - 0.08 / 1.04).abs() < 1e-15);
        assert!((pane.coefficient(DVec3::Z, Event::Transmission, sides, 500.0) - 0.96 / 1.04).abs() < 1e-15);
    }
}
