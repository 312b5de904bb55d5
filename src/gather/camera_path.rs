//! A camera path under way: where it is, what it lets through, and how it goes on at a scattering event.

use super::direct::Counts;
use super::landing::{Landing, Sightline};
use super::throughput::{Colour, Factor};
use crate::plan::partition::View;
use crate::scene::geometry::Ray;
use crate::scene::interior::Interior;
use crate::spectrum::Lanes;
use crate::walk::{Drawn, Encounter, Start};

/// Wavelength-free camera paths choose between reflection and refraction, and compare densities, at this wavelength (nm); what
/// that does to other wavelengths is in the path's factors.
pub(super) const REFERENCE_NM: f64 = 550.0;

/// Buffers that one worker reuses from path to path.
#[derive(Debug, Default)]
pub struct Scratch<'a> {
    pub(super) factors: Vec<Factor<'a>>,
    /// What weakens light on the ways that a light map knows.
    pub(super) coefficients: Vec<Lanes>,
    /// Whether the following two are kept.
    pub(super) notes: bool,
    /// Where paths came to rest in the last call.
    pub landings: Vec<Landing>,
    /// Which ways through media they looked along in the last call.
    pub sightlines: Vec<Sightline>,
}

impl Scratch<'_> {
    /// Buffers that also note where paths come to rest and look.
    pub fn noting() -> Self {
        Self { notes: true, ..Self::default() }
    }
}

/// A camera path under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct CameraPath {
    pub(super) start: Start,
    pub(super) colour: Colour,
    pub(super) view: View,
    pub(super) counts: Counts,
    /// Grey estimate of what the path lets through, for roulette.
    pub(super) level: f64,
    pub(super) distance: f64,
    pub(super) depth: u32,
    /// By how much steps through media overrate the optical depth so far.
    pub(super) excess_depth: f64,
}

impl CameraPath {
    /// A path that starts at the camera, still a function of wavelength.
    pub(super) fn new(ray: Ray, interior: Interior) -> Self {
        Self {
            start: Start { ray, from: None, interior },
            colour: Colour::Free,
            view: View::Seen,
            counts: Counts::Fully,
            level: 1.0,
            distance: 0.0,
            depth: 0,
            excess_depth: 0.0,
        }
    }

    /// The wavelength at which directions are chosen.
    pub(super) fn reference_nm(&self) -> f64 {
        match self.colour {
            Colour::Free => REFERENCE_NM,
            Colour::Shared { nm, .. } => nm,
        }
    }

    /// Multiplies what the path lets through by an event's factor.
    pub(super) fn multiply<'a>(&mut self, factor: Factor<'a>, scratch: &mut Scratch<'a>) {
        let at_reference = factor.at(self.reference_nm());
        self.level *= at_reference;
        match &mut self.colour {
            Colour::Free => scratch.factors.push(factor),
            Colour::Shared { throughput, .. } => *throughput *= at_reference,
        }
    }

    /// Takes the path along a scattered direction; false where a rough surface sends it into itself.
    pub(super) fn continue_along<'a>(
        &mut self,
        encounter: &Encounter<'a>,
        drawn: &Drawn,
        scratch: &mut Scratch<'a>,
    ) -> bool {
        let Drawn { frame, wo, scatter } = drawn;
        let direction = frame.to_world(scatter.wi);
        if !encounter.agrees(direction, scatter.event) {
            return false;
        }
        let (surface, sides) = (encounter.surface, encounter.sides);
        let factor =
            Factor::Scattering { surface, wo: *wo, scatter: *scatter, sides, probability: scatter.probability };
        self.multiply(factor, scratch);
        self.view = View::Relayed;
        self.counts = match (scatter.delta, self.counts) {
            (false, _) => Counts::Shared { place: encounter.hit.position, pdf: scatter.probability },
            (true, Counts::Fully) => Counts::Fully,
            (true, Counts::Shared { .. } | Counts::Not) => Counts::Not,
        };
        self.start = encounter.leave(direction, encounter.interior_after(scatter.event));
        true
    }
}
