//! The emission of a photon, as far as its ribbon needs it.

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
