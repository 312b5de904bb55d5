//! Phase functions: into which directions a medium scatters.
//!
//! One convention: cos θ = ω_in · ω_out, both along the way the light travels, so that forward is +1. Every function is a density
//! per steradian that integrates to 1 over the sphere.

use crate::math::warp;
use glam::DVec3;
use std::f64::consts::PI;

/// A phase function.
#[derive(Debug, Clone, PartialEq)]
pub enum Phase {
    /// The same into all directions.
    Isotropic,
}

impl Phase {
    /// The density per steradian of scattering by the angle of this cosine, at a wavelength.
    pub fn at(&self, cos_theta: f64, nm: f64) -> f64 {
        let (_, _) = (cos_theta, nm);
        match self {
            Self::Isotropic => 0.25 / PI,
        }
    }

    /// Draws the new direction (unit) of light that came along the unit vector `incoming`, with the density [`at`](Self::at) exactly.
    pub fn sample(&self, incoming: DVec3, nm: f64, u: [f64; 2]) -> DVec3 {
        let (_, _) = (incoming, nm);
        match self {
            Self::Isotropic => warp::sphere(u),
        }
    }

    /// The mean of cos θ at a wavelength.
    pub fn mean_cosine(&self, nm: f64) -> f64 {
        let _ = nm;
        match self {
            Self::Isotropic => 0.0,
        }
    }
}
