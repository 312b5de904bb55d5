//! Ribbons: photons that paint their whole spectrum.
//!
//! Behind a dispersive surface, each wavelength λ of a photon takes its own way and lands at its own
//! point x(λ). As long as the sequence of surfaces stays the same, x is a smooth curve. A ribbon
//! traces the photon at a few wavelengths, its nodes, and paints the curve between neighbouring
//! nodes into the pixels that see it, with the power that the light emits between the wavelengths
//! at which the curve enters and leaves each pixel. A photon of a single wavelength would paint one
//! point of the curve.
//!
//! The wavelengths of a ribbon use the same random numbers, so that the light at λ is a function of
//! λ alone, and any rule that chooses an estimator for a part of the spectrum by the values of this
//! function at the nodes leaves the mean unchanged. [`nodes`] divides the spectrum: where the
//! nodes lie on a parabola, the ribbon is painted, and the other parts are sampled at one random
//! wavelength.
//!
//! A ribbon contains exactly the paths L S* R S* D: events at mirrors and at clear interfaces
//! without dispersion, one refraction or diffraction at the first dispersive surface, further
//! specular events, and a diffuse or glossy surface that the camera sees directly. [`RibbonPart`]
//! tells a photon of one wavelength whether it is such a path, which it then leaves to the ribbon.

mod chain;
mod film_line;
mod nodes;
mod spectrum;

pub use nodes::{RibbonPainter, RibbonTally};
pub use spectrum::EmittedPower;

use crate::map::WavelengthCode;
use crate::walk::{RayDensity, RayState, SurfaceInteraction};
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::light::EmittedSpd;
use abbe_spectra::math::random::StreamKey;

/// The emission of a photon, before it has wavelengths.
#[derive(Debug, Clone, Copy)]
pub struct Launch {
    pub light: usize,
    pub spd: EmittedSpd,
    /// The flux in W over the band that the photon represents.
    pub flux_w: f64,
    pub ray_state: RayState,
    pub ray_density: RayDensity,
    pub wavelength_code: WavelengthCode,
    /// The streams of the ribbon.
    pub streams: StreamKey,
    /// The wavelength (nm) that decides between the events before the first dispersive surface.
    pub hero_nm: f64,
}

/// The relation of a photon's path so far to the ribbon of the same emission.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RibbonPart {
    /// There was no dispersive surface yet.
    Ahead,
    /// The path is one of those that the ribbon contains.
    Painted,
    /// The path is none of those that the ribbon contains.
    Missed,
}

impl RibbonPart {
    /// Returns the relation after an event at a surface. `split` is true if the path kept one
    /// wavelength there.
    #[inline]
    #[must_use]
    pub fn after(self, interaction: &SurfaceInteraction<'_>, split: bool) -> Self {
        match self {
            Self::Missed => Self::Missed,
            Self::Ahead | Self::Painted if interaction.bsdf.class() != BsdfClass::Specular => Self::Missed,
            Self::Ahead if split => Self::Painted,
            Self::Ahead if interaction.disperses() => Self::Missed,
            Self::Ahead | Self::Painted => self,
        }
    }
}
