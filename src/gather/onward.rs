//! How a camera path goes on from mirrors, glass and rough surfaces.

use super::camera_path::{CameraPath, REFERENCE_NM};
use super::direct::Counts;
use super::photon_gather::{Gatherer, Sample};
use super::throughput::{Colour, Factor, relative_n2};
use crate::math::random::ONE_MINUS_ULP;
use crate::optics::fresnel;
use crate::optics::surface::{Class, Event, Surface, Transport};
use crate::plan::WavelengthPlan;
use crate::scene::Scene;
use crate::spectrum::LANES;
use crate::walk::{Encounter, Sink, draw_consistently};

impl<'a> Gatherer<'a> {
    /// Where the path goes on from a mirror, from glass or from a rough surface; `None` where it ends.
    pub(super) fn go_on<S: Sink>(
        &self,
        path: &CameraPath,
        encounter: &Encounter<'a>,
        sample: &mut Sample<'_, 'a, S>,
    ) -> Option<CameraPath> {
        let mut path = *path;
        let goes_on = if let (Colour::Free, true) = (path.colour, self.disperses(encounter)) {
            self.go_on_through_dispersive(&mut path, encounter, sample)
        } else {
            let u = sample.numbers.stream.triple();
            self.scatter_once(&mut path, encounter, u, sample)
        };
        (goes_on && survives(self.scene, &mut path, sample)).then_some(path)
    }

    /// Whether refraction here would send wavelengths different ways.
    fn disperses(&self, encounter: &Encounter<'a>) -> bool {
        self.plan.wavelengths != WavelengthPlan::Free
            && matches!(encounter.surface, Surface::Dielectric(_))
            && (encounter.sides.here.is_dispersive() || encounter.sides.there.is_dispersive())
    }

    /// A wavelength-free path at dispersive glass: reflected it stays free, refracted it goes on once for each shared wavelength.
    fn go_on_through_dispersive<S: Sink>(
        &self,
        path: &mut CameraPath,
        encounter: &Encounter<'a>,
        sample: &mut Sample<'_, 'a, S>,
    ) -> bool {
        let surface = encounter.surface;
        if surface.class() == Class::Glossy {
            // Rough dispersive glass: each wavelength scatters for itself, reflections included.
            sample.tally.dispersions += 1;
            self.split_at(*path, encounter, None, sample);
            return false;
        }
        // At the first surface both ways are followed; further on, one is drawn.
        let reflectance = self.reflectance(encounter);
        let both = path.depth == 1;
        let reflects = both || sample.numbers.stream.uniform() < reflectance;
        let refracts = both || !reflects;
        if refracts && reflectance < 1.0 {
            let probability = if both { 1.0 } else { 1.0 - reflectance };
            sample.tally.dispersions += 1;
            self.split_at(*path, encounter, Some(probability), sample);
        }
        if !reflects {
            return false;
        }
        let probability = if both { 1.0 } else { reflectance };
        self.scatter_forced(path, encounter, Event::Reflection, probability, sample)
    }

    /// Reflectance of a smooth interface at the reference wavelength.
    fn reflectance(&self, encounter: &Encounter<'a>) -> f64 {
        let sides = encounter.sides;
        fresnel::dielectric(encounter.wo.z.abs(), sides.here.n(REFERENCE_NM), sides.there.n(REFERENCE_NM))
    }

    /// Sends the path on from here once for each shared wavelength; `refracted` says with which probability refraction was chosen, or that
    /// each wavelength chooses for itself.
    fn split_at<S: Sink>(
        &self,
        path: CameraPath,
        encounter: &Encounter<'a>,
        refracted: Option<f64>,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let u = sample.numbers.stream.triple();
        for lane in 0..LANES {
            let Some(mut single) = self.on_lane(path, lane, sample) else {
                continue;
            };
            let goes_on = match refracted {
                Some(probability) => {
                    self.scatter_forced(&mut single, encounter, Event::Transmission, probability, sample)
                }
                None => self.scatter_once(&mut single, encounter, u, sample),
            };
            if goes_on && survives(self.scene, &mut single, sample) {
                self.follow_lane(&single, sample);
            }
        }
    }

    /// Scatters into the reflection or the refraction of a smooth interface, whichever is told; false where there is none.
    fn scatter_forced<S: Sink>(
        &self,
        path: &mut CameraPath,
        encounter: &Encounter<'a>,
        event: Event,
        probability: f64,
        sample: &mut Sample<'_, 'a, S>,
    ) -> bool {
        let u = match event {
            Event::Reflection => [0.0; 3],
            Event::Transmission => [ONE_MINUS_ULP; 3],
        };
        let nm = path.reference_nm();
        let draw = |wo| encounter.surface.sample(wo, encounter.sides, nm, Transport::Radiance, u);
        match draw_consistently(encounter, draw) {
            Some(mut drawn) if drawn.scatter.event == event => {
                drawn.scatter.probability = probability;
                path.continue_along(encounter, &drawn, sample.scratch)
            }
            Some(_) | None => false,
        }
    }

    /// Scatters as the surface draws it.
    fn scatter_once<S: Sink>(
        &self,
        path: &mut CameraPath,
        encounter: &Encounter<'a>,
        u: [f64; 3],
        sample: &mut Sample<'_, 'a, S>,
    ) -> bool {
        let nm = path.reference_nm();
        let draw = |wo| encounter.surface.sample(wo, encounter.sides, nm, Transport::Radiance, u);
        match draw_consistently(encounter, draw) {
            Some(drawn) => {
                let goes_on = path.continue_along(encounter, &drawn, sample.scratch);
                // What a rough surface's scattered ray finds is a part of the light straight from lamps.
                if self.plan.direct.is_absent() && matches!(path.counts, Counts::Shared { .. }) {
                    path.counts = Counts::Not;
                }
                goes_on
            }
            None => false,
        }
    }
}

/// Russian roulette for paths that have lost most of their light (by more than glass takes and gives back with its n²).
fn survives<S: Sink>(scene: &Scene, path: &mut CameraPath, sample: &mut Sample<'_, '_, S>) -> bool {
    const FREE_EVENTS: u32 = 8;
    if path.level <= 0.0 && matches!(path.colour, Colour::Shared { .. }) {
        return false;
    }
    if path.depth < FREE_EVENTS {
        return true;
    }
    let level = path.level * relative_n2(scene, &path.start, path.reference_nm());
    if level >= 0.5 {
        return true;
    }
    let survival = level.max(0.05);
    if sample.numbers.stream.uniform() >= survival {
        return false;
    }
    path.multiply(Factor::Grey(1.0 / survival), sample.scratch);
    true
}
