//! Portals through which the light of the surroundings reaches a room.
//!
//! A shadow ray to a random direction of the sky rarely passes through a window, so most of them
//! are sent towards the portals that a search before pass 0 found (compare Bitterli, Novák & Jarosz
//! 2015, "Portal-Masked Environment Map Sampling"). A portal is a sphere around a window, which the
//! user need not describe. The other shadow rays follow the radiance of the environment, so the
//! estimate is unbiased for any spheres.

use abbe_spectra::math::sphere::BoundingSphere;
use glam::DVec3;

/// The fraction of the shadow rays to an environment that are sent towards portals.
pub const PORTAL_FRACTION: f64 = 0.75;

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Portals {
    /// The portals without glass. Shadow rays pass through them.
    pub open: PortalSpheres,
    /// The portals of which at least some have glass. Only the paths of meters use them.
    pub glazed: PortalSpheres,
}

/// The spheres around portals. Rays are sent to all of them with equal probability.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PortalSpheres(pub Vec<BoundingSphere>);

impl Portals {
    pub const NONE: &'static Self = &Self { open: PortalSpheres(Vec::new()), glazed: PortalSpheres(Vec::new()) };

    pub fn all(&self) -> Vec<BoundingSphere> {
        [self.open.0.as_slice(), &self.glazed.0].concat()
    }

    /// Returns the portals for an estimator whose shadow rays pass through panes.
    #[must_use]
    pub fn without_glass(&self) -> Self {
        Self { open: PortalSpheres(self.all()), glazed: PortalSpheres::default() }
    }
}

impl PortalSpheres {
    #[inline]
    pub(in crate::gather) fn count(&self) -> usize {
        self.0.len()
    }

    /// Samples a direction from a point through an portal. `choice` in [0, 1) selects the portal.
    pub(in crate::gather) fn sample(&self, from: DVec3, choice: f64, u: [f64; 2]) -> DVec3 {
        let count = self.0.len();
        let number = ((choice * count as f64) as usize).min(count - 1);
        self.0[number].sample_direction(from, u).0
    }

    /// Returns the density of `Self::sample` per steradian.
    pub fn pdf(&self, from: DVec3, direction: DVec3) -> f64 {
        let sum: f64 = self.0.iter().map(|sphere| sphere.pdf_direction(from, direction)).sum();
        sum / self.0.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;

    /// The mean of 1/pdf over the samples is the solid angle that the portals cover.
    #[test]
    fn samples_have_their_pdf() {
        let sphere = |x: f64, radius_m: f64| BoundingSphere { centre: DVec3::new(x, 2.0, 0.0), radius_m };
        let portals = PortalSpheres(vec![sphere(0.0, 0.5), sphere(0.2, 0.6), sphere(5.0, 1.0)]);
        let (sobol, n) = (Sobol::new(3), 1 << 14);
        let (mut sampled, mut uniform) = (0.0, 0.0);
        for i in 0..n {
            let u = sobol.point(i);
            let direction = portals.sample(DVec3::ZERO, u[2], [u[0], u[1]]);
            sampled += 1.0 / portals.pdf(DVec3::ZERO, direction) / f64::from(n);
            let direction = abbe_spectra::math::warp::sphere([u[3], u[4]]);
            let covered = portals.pdf(DVec3::ZERO, direction) > 0.0;
            uniform += if covered { 4.0 * std::f64::consts::PI / f64::from(n) } else { 0.0 };
        }
        assert!((sampled / uniform - 1.0).abs() < 0.02, "{sampled} and {uniform}");
    }
}
