//! Phase functions of participating media.
//!
//! Convention: cos θ = ω_in · ω_out with both directions along the propagation of the light, so
//! forward scattering has cos θ = +1. Every phase function is a density per steradian that
//! integrates to 1 over the sphere.

mod henyey_greenstein;
mod ice;
pub mod mie;
mod mixture;
mod rainbow;
mod rayleigh;
mod table;

#[cfg(test)]
mod contract;

pub use henyey_greenstein::MAX_MEAN_COSINE;
pub use ice::ice;
pub use mixture::PhaseMixture;
pub use rainbow::rainbow;
pub use table::{PhaseTable, parse as parse_table};

use self::mie::{MieMatrix, MieSpheres};
use self::table::Spheres;
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// A phase function.
#[derive(Debug, Clone, PartialEq)]
pub enum PhaseFunction {
    /// Uniform scattering in all directions.
    Isotropic,
    /// Scattering by particles much smaller than the wavelength.
    Rayleigh,
    /// The Henyey–Greenstein phase function with |g| ≤ [`MAX_MEAN_COSINE`] at every wavelength.
    HenyeyGreenstein {
        /// Asymmetry parameter g(λ), the mean cosine of the scattering angle.
        g: Spectrum,
    },
    /// A table over angles and wavelengths.
    Table(Arc<PhaseTable>),
}

impl PhaseFunction {
    /// Returns the pdf per steradian at a cosine of the scattering angle and a wavelength in nm.
    pub fn eval(&self, cos_theta: f64, nm: f64) -> f64 {
        match self {
            Self::Isotropic => 0.25 / PI,
            Self::Rayleigh => rayleigh::eval(cos_theta),
            Self::HenyeyGreenstein { g } => henyey_greenstein::eval(g.at(nm), cos_theta),
            Self::Table(table) => table.eval(cos_theta, nm),
        }
    }

    /// Samples the direction of scattered light with exactly the pdf [`eval`](Self::eval), by `u`
    /// in \[0, 1). `incoming`, the direction before scattering, and the result are unit vectors.
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
        Frame::new(axis).to_world(warp::spherical_direction(one_minus_cos, u[1]))
    }

    /// Returns true if the polarisation of the scattered light is known. Other phase functions
    /// depolarise.
    pub fn polarises(&self) -> bool {
        match self {
            Self::Isotropic | Self::HenyeyGreenstein { .. } => false,
            Self::Rayleigh => true,
            Self::Table(table) => table.has_polarisation(),
        }
    }

    /// Returns the elements S12, S33 and S34 of the phase matrix of spheres in the notation of
    /// Bohren & Huffman, divided by S11, or `None` if the phase function has no polarisation.
    pub fn polarisation(&self, cos_theta: f64, nm: f64) -> Option<[f64; 3]> {
        let Self::Table(table) = self else { return None };
        table.polarisation(cos_theta, nm, |spheres, nm, angles_deg| match spheres {
            Spheres::Mie(radii_um, index) => {
                let spheres = MieSpheres { radii_um: radii_um.clone(), index: index.clone() };
                let relative = |matrix: MieMatrix| {
                    [matrix.s12, matrix.s33, matrix.s34].map(|element| (element / matrix.s11) as f32)
                };
                spheres.phase_matrix(nm, angles_deg).into_iter().map(relative).collect()
            }
            Spheres::Rain => rainbow::ratios(nm, angles_deg),
        })
    }

    /// Returns the mean of cos θ at a wavelength in nm.
    pub fn mean_cosine(&self, nm: f64) -> f64 {
        match self {
            Self::Isotropic | Self::Rayleigh => 0.0,
            Self::HenyeyGreenstein { g } => g.at(nm),
            Self::Table(table) => table.mean_cosine(nm),
        }
    }

    /// Returns true if the phase function varies with wavelength.
    pub fn depends_on_wavelength(&self) -> bool {
        match self {
            Self::Isotropic | Self::Rayleigh => false,
            Self::HenyeyGreenstein { g } => g.is_constant().is_none(),
            Self::Table(table) => table.depends_on_wavelength(),
        }
    }
}
