//! Phase functions of participating media.
//!
//! Convention: cos θ = ω_in · ω_out with both directions along the propagation of the light, so
//! forward scattering has cos θ = +1. Every phase function is a density per steradian that
//! integrates to 1 over the sphere.

mod crystal;
mod direction_table;
mod henyey_greenstein;
mod ice;
pub mod mie;
mod mixture;
mod oriented;
mod rainbow;
mod rayleigh;
mod table;

#[cfg(test)]
mod contract;

pub use henyey_greenstein::MAX_MEAN_COSINE;
pub use ice::ice;
pub use mixture::PhaseMixture;
pub use oriented::{IceOrientation, IcePopulation, OrientedIce, PrismShape, ice_crystals};
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

/// The directions of a scattering event, as far as phase functions depend on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deflection {
    /// Cosine of the scattering angle.
    pub cos_theta: f64,
    /// The component along +y, the vertical, of the direction of the light before the event.
    pub arriving_y: f64,
    /// The same after the event.
    pub leaving_y: f64,
}

impl Deflection {
    /// Takes unit vectors along the propagation of the light, before and after the event.
    #[inline]
    pub fn between(arriving: DVec3, leaving: DVec3) -> Self {
        Self { cos_theta: arriving.dot(leaving), arriving_y: arriving.y, leaving_y: leaving.y }
    }

    /// Takes the cosine of the scattering angle of light that is level before and after the event.
    pub fn horizontal(cos_theta: f64) -> Self {
        Self { cos_theta, arriving_y: 0.0, leaving_y: 0.0 }
    }

    /// Returns the event of light on the same path in the opposite direction.
    #[inline]
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { arriving_y: -self.leaving_y, leaving_y: -self.arriving_y, ..self }
    }
}

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
    /// Ice crystals that prefer an orientation. The only phase function that depends on more than
    /// the scattering angle, and that differs for light in the opposite direction.
    Oriented(Arc<OrientedIce>),
}

impl PhaseFunction {
    /// Returns the pdf per steradian of the light's direction after scattering, at a wavelength in
    /// nm.
    pub fn eval(&self, deflection: Deflection, nm: f64) -> f64 {
        let Deflection { cos_theta, .. } = deflection;
        match self {
            Self::Isotropic => 0.25 / PI,
            Self::Rayleigh => rayleigh::eval(cos_theta),
            Self::HenyeyGreenstein { g } => henyey_greenstein::eval(g.at(nm), cos_theta),
            Self::Table(table) => table.eval(cos_theta, nm),
            Self::Oriented(ice) => ice.tables().eval(deflection, nm),
        }
    }

    /// Returns the pdf of [`sample_reversed`](Self::sample_reversed). `deflection` is that of the
    /// path, whose direction is opposite to the light's.
    pub fn reversed_pdf(&self, deflection: Deflection, nm: f64) -> f64 {
        match self {
            Self::Oriented(ice) => ice.tables().reversed_pdf(deflection, nm),
            Self::Isotropic | Self::Rayleigh | Self::HenyeyGreenstein { .. } | Self::Table(_) => {
                self.eval(deflection, nm)
            }
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
            Self::Oriented(ice) => return ice.tables().sample(incoming, nm, u),
        };
        Frame::new(axis).to_world(warp::spherical_direction(one_minus_cos, u[1]))
    }

    /// Samples the direction in which a path that travels against the light continues, by `u` in
    /// \[0, 1). The pdf, [`reversed_pdf`](Self::reversed_pdf), is above 0 where the light that
    /// arrives from the sampled direction is scattered into the path.
    pub fn sample_reversed(&self, incoming: DVec3, nm: f64, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Oriented(ice) => ice.tables().sample_reversed(incoming, nm, u),
            Self::Isotropic | Self::Rayleigh | Self::HenyeyGreenstein { .. } | Self::Table(_) => {
                self.sample(incoming, nm, u)
            }
        }
    }

    /// Returns true if the polarisation of the scattered light is known. Other phase functions
    /// depolarise.
    pub fn polarises(&self) -> bool {
        match self {
            Self::Isotropic | Self::HenyeyGreenstein { .. } | Self::Oriented(_) => false,
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

    /// Returns the mean of cos θ at a wavelength in nm, or `None` if it depends on the direction of
    /// the light.
    pub fn mean_cosine(&self, nm: f64) -> Option<f64> {
        match self {
            Self::Isotropic | Self::Rayleigh => Some(0.0),
            Self::HenyeyGreenstein { g } => Some(g.at(nm)),
            Self::Table(table) => Some(table.mean_cosine(nm)),
            Self::Oriented(_) => None,
        }
    }

    /// Returns true if the phase function varies with wavelength.
    pub fn depends_on_wavelength(&self) -> bool {
        match self {
            Self::Isotropic | Self::Rayleigh => false,
            Self::HenyeyGreenstein { g } => g.is_constant().is_none(),
            Self::Table(table) => table.depends_on_wavelength(),
            Self::Oriented(_) => true,
        }
    }
}
