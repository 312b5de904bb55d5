//! What a camera path lets through, as a function of wavelength.

use crate::optics::surface::{Scatter, Sides, Surface, Transport};
use crate::scene::Scene;
use crate::scene::interior::Interior;
use crate::walk::{Passage, Start};
use glam::DVec3;

/// One event's factor on the radiance that a camera path carries back.
#[derive(Debug, Clone, Copy)]
pub(super) enum Factor<'a> {
    /// A scattering event.
    Scattering {
        surface: &'a Surface,
        wo: DVec3,
        scatter: Scatter,
        sides: Sides<'a>,
        /// The probability or density with which the direction was chosen.
        probability: f64,
    },
    /// What passes a stretch of glass, liquid or fog.
    Passage(Passage<'a>),
    /// The same for all wavelengths.
    Grey(f64),
}

impl Factor<'_> {
    /// The factor at a wavelength.
    pub(super) fn at(&self, nm: f64) -> f64 {
        match self {
            Factor::Scattering { surface, wo, scatter, sides, probability } => {
                surface.response(*wo, scatter, *sides, Transport::Radiance, nm) / probability
            }
            Factor::Passage(passage) => passage.at(nm),
            Factor::Grey(value) => *value,
        }
    }
}

/// The product of the factors at a wavelength.
#[inline]
pub(super) fn product(factors: &[Factor<'_>], nm: f64) -> f64 {
    factors.iter().map(|factor| factor.at(nm)).product()
}

/// (n here / n at the camera)²: radiance over n² is what glass leaves as it is. `start` is where the path goes on.
pub(super) fn relative_n2(scene: &Scene, start: &Start, nm: f64) -> f64 {
    let n = |interior: &Interior| scene.index_in(interior).n(nm);
    (n(&start.interior) / n(&scene.camera.interior)).powi(2)
}

/// How a camera path is coloured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Colour {
    /// Still a function of wavelength: the path's factors.
    Free,
    /// At one of the pass's shared wavelengths.
    Shared {
        /// Which.
        lane: usize,
        /// The wavelength in nm.
        nm: f64,
        /// What the path lets through, divided by the wavelength's density.
        throughput: f64,
    },
}
