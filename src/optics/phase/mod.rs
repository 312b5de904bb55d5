//! Phase functions: into which directions a medium scatters.
//!
//! One convention: cos θ = ω_in · ω_out, both along the way the light travels, so that forward is +1. Every function is a density
//! per steradian that integrates to 1 over the sphere.

mod henyey_greenstein;
pub mod mie;
mod rainbow;
mod rayleigh;
mod table;

#[cfg(test)]
mod contract;

pub use henyey_greenstein::MAX_MEAN_COSINE;
pub use rainbow::rainbow;
pub use table::{PhaseTable, parse as parse_table};

use crate::math::frame::Frame;
use crate::math::warp;
use crate::spectrum::Spectrum;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// A phase function.
#[derive(Debug, Clone, PartialEq)]
pub enum Phase {
    /// The same into all directions.
    Isotropic,
    /// By particles much smaller than the wavelength.
    Rayleigh,
    /// By its mean cosine g, |g| ≤ [`MAX_MEAN_COSINE`] at every wavelength.
    HenyeyGreenstein {
        /// Mean cosine.
        g: Spectrum,
    },
    /// Known at angles and wavelengths.
    Table(Arc<PhaseTable>),
}

impl Phase {
    /// The density per steradian of scattering by the angle of this cosine, at a wavelength.
    pub fn at(&self, cos_theta: f64, nm: f64) -> f64 {
        match self {
            Self::Isotropic => 0.25 / PI,
            Self::Rayleigh => rayleigh::at(cos_theta),
            Self::HenyeyGreenstein { g } => henyey_greenstein::at(g.at(nm), cos_theta),
            Self::Table(table) => table.at(cos_theta, nm),
        }
    }

    /// Draws the new direction (unit) of light that came along the unit vector `incoming`, with the density [`at`](Self::at) exactly.
    pub fn sample(&self, incoming: DVec3, nm: f64, u: [f64; 2]) -> DVec3 {
        let (axis, one_minus_cos) = match self {
            Self::Isotropic => return warp::sphere(u),
            Self::Rayleigh => (incoming, rayleigh::quantile(u[0])),
            Self::HenyeyGreenstein { g } => {
                let g = g.at(nm);
                (incoming * 1.0_f64.copysign(g), henyey_greenstein::quantile(g.abs(), u[0]))
            }
            Self::Table(table) => (incoming, table.quantile(nm, u[0])),
        };
        Frame::new(axis).to_world(warp::ring(one_minus_cos, u[1]))
    }

    /// The mean of cos θ at a wavelength.
    pub fn mean_cosine(&self, nm: f64) -> f64 {
        match self {
            Self::Isotropic | Self::Rayleigh => 0.0,
            Self::HenyeyGreenstein { g } => g.at(nm),
            Self::Table(table) => table.mean_cosine(nm),
        }
    }

    /// Whether light of different wavelengths is scattered differently.
    pub fn depends_on_wavelength(&self) -> bool {
        match self {
            Self::Isotropic | Self::Rayleigh => false,
            Self::HenyeyGreenstein { g } => g.is_constant().is_none(),
            Self::Table(table) => table.depends_on_wavelength(),
        }
    }
}
