//! What media do to a camera path: they weaken what is behind them, and scatter light into it.
//!
//! Light that comes straight from a lamp to a point on the ray is looked for at one drawn place a lamp, or looked up in a map of the lamp; light that came through glass, or was scattered before,
//! is brought by the photons that pass the ray.

use super::camera_path::CameraPath;
use super::direct::{AskingInside, Counts};
use super::distance;
use super::estimate::{RadiusKind, add_photon};
use super::landing::Sightline;
use super::photon_gather::{Gatherer, Sample, each_wavelength};
use super::throughput::{Colour, Factor};
use crate::map::{Came, Cone, Neighbour, VolumeMap, Width};
use crate::math::random::hash64;
use crate::scene::geometry::Ray;
use crate::scene::medium::Medium;
use crate::walk::{Encounter, Passage, Sink, Start, Stretch, bias_of_excess, excess_depth, passes, travel};
use glam::DVec3;
use std::ops::ControlFlow;

impl<'a> Gatherer<'a> {
    /// Takes the path to the next surface, gathering what media add on the way; `None` where it leaves the scene.
    pub(super) fn advance<S: Sink>(
        &self,
        path: &mut CameraPath,
        sample: &mut Sample<'_, 'a, S>,
    ) -> Option<Encounter<'a>> {
        let component = sample.numbers.stream.uniform();
        let mut walked = path.distance;
        let leg = travel(self.scene, path.start, component, |stretch| {
            self.cross(path, stretch, walked, sample);
            walked += stretch.length_m;
            ControlFlow::Continue(())
        });
        leg.continue_value().flatten()
    }

    /// One stretch of the way.
    fn cross<S: Sink>(
        &self,
        path: &mut CameraPath,
        stretch: &Stretch<'a>,
        walked: f64,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        if let Some((number, medium)) = stretch.medium {
            sample.tally.media_stretches += 1;
            if medium.emission.is_some() && matches!(path.counts, Counts::Fully) {
                self.see_glow(path, (stretch, number, medium), sample);
            }
            if medium.scatters() && stretch.length_m.is_finite() {
                if !self.plan.direct.is_absent() {
                    self.gather_lamps_inside(path, (stretch, number, medium), sample);
                    self.gather_mapped_lamps(path, (stretch, number, medium), sample);
                }
                self.gather_volume_photons(path, (stretch, number, medium), walked, sample);
            }
        }
        sample.tally.body_events += u64::from(!stretch.interior.is_air());
        sample.tally.absorptions += u64::from(stretch.absorption.is_some());
        let passages = stretch.passages(stretch.length_m, seed(sample, stretch.ray.origin));
        path.excess_depth += excess_depth(&passages, path.reference_nm());
        for passage in passages {
            path.multiply(Factor::Passage(passage), sample.scratch);
        }
    }

    /// Light that the medium emits into the ray. (At surfaces and in media that light is looked for like a lamp's.)
    fn see_glow<S: Sink>(
        &self,
        path: &CameraPath,
        (stretch, number, medium): (&Stretch<'a>, usize, &'a Medium),
        sample: &mut Sample<'_, 'a, S>,
    ) {
        /// Places along the ray, one in each of as many equal parts.
        const PLACES: u32 = 16;
        let Some(light) = self.scene.light_of_medium(number) else { return };
        let Some((from, to)) = medium.window(&stretch.ray, stretch.length_m) else { return };
        let step = (to - from) / f64::from(PLACES);
        let shift = sample.numbers.stream.uniform();
        for i in 0..PLACES {
            let t = from + (f64::from(i) + shift) * step;
            let place = stretch.ray.at(t);
            let here = stretch.passages(t, seed(sample, stretch.ray.origin));
            let bias = bias_of_excess(path.excess_depth + excess_depth(&here, path.reference_nm()));
            let (scratch, sink) = (&sample.scratch, &mut *sample.sink);
            each_wavelength(path.colour, &scratch.factors, light, sample.numbers.wavelength, |nm, share| {
                let weight = share * medium.emission_per_m(place, nm) * passes(&here, nm) * step;
                sink.biased(nm, weight, weight * bias);
            });
        }
    }

    /// Light that comes straight from lamps without a map and is scattered once.
    fn gather_lamps_inside<S: Sink>(
        &self,
        path: &CameraPath,
        (stretch, number_here, medium): (&Stretch<'a>, usize, &'a Medium),
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let Some(window) = medium.window(&stretch.ray, stretch.length_m) else {
            return;
        };
        let mut u = sample.numbers.lamp();
        for number in self.direct.asked(&mut u) {
            if self.light_maps.of(number, number_here).is_some() {
                continue;
            }
            let draws = sample.numbers.stream.pair();
            let light = &self.scene.lights[number];
            let reach = light.reach(self.scene.world(), &stretch.ray, window, u);
            let place = reach.and_then(|reach| distance::draw(medium, &stretch.ray, &reach, draws));
            let Some(place) = place else { continue };
            let density = medium.density_at(stretch.ray.at(place.t));
            let here = stretch.passages(place.t, seed(sample, stretch.ray.origin));
            let ray = Ray { origin: stretch.ray.at(place.t), direction: stretch.ray.direction };
            let start = Start { ray, from: None, interior: stretch.interior };
            let asking = AskingInside { start, medium, scattered_nm: None, u };
            let wavelength = sample.numbers.wavelength;
            let (scratch, sink) = (&sample.scratch, &mut *sample.sink);
            let Some(lit) = self.direct.ask_inside(asking, number, sample.tally) else { continue };
            let cosine = -lit.incoming.dot(stretch.ray.direction);
            let strength = lit.strength * density / place.pdf;
            let excess = |way: &[Passage<'_>]| excess_depth(way, path.reference_nm());
            let bias = bias_of_excess(path.excess_depth + excess(&here) + excess(&lit.through));
            each_wavelength(path.colour, &scratch.factors, lit.light, wavelength, |nm, share| {
                let scattered = medium.scattering.at(nm) * medium.phase.at(cosine, nm);
                let passed = passes(&here, nm) * passes(&lit.through, nm);
                let weight = share * lit.light.shape_at(lit.tint, nm) * strength * scattered * passed;
                sink.biased(nm, weight, weight * bias);
            });
        }
    }

    /// Light that photons brought.
    fn gather_volume_photons<S: Sink>(
        &self,
        path: &CameraPath,
        (stretch, number, medium): (&Stretch<'a>, usize, &'a Medium),
        walked: f64,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let (maps, kinds) = match path.colour {
            Colour::Free => (self.free, [RadiusKind::FreeVolumeCaustic, RadiusKind::FreeVolumeIndirect]),
            Colour::Shared { .. } => (self.shared, [RadiusKind::SharedVolumeCaustic, RadiusKind::SharedVolumeIndirect]),
        };
        let shared = matches!(path.colour, Colour::Shared { .. });
        if sample.scratch.notes {
            let (ray, length_m) = (stretch.ray, stretch.length_m);
            sample.scratch.sightlines.push(Sightline { ray, length_m, behind_m: walked, medium: number, shared });
        }
        for (maps, kind) in [&maps.volume_caustic, &maps.volume_indirect].into_iter().zip(kinds) {
            let slope = f64::from(sample.radii[kind as usize]);
            for (map, scale) in [(&maps.points, self.scales.points), (&maps.beams, self.scales.beams)] {
                if map.is_empty() {
                    continue;
                }
                let width = match self.radius_m {
                    Some(radius) => Width::Stated(radius * scale),
                    None => Width::PerDistance(slope * scale),
                };
                let cone = Cone::of_camera(stretch.ray, stretch.length_m, walked, width);
                self.along(map, &cone, (path, stretch, number, medium), sample);
            }
        }
    }

    /// Adds the radiance that the photons of one map scatter into the ray.
    fn along<S: Sink>(
        &self,
        map: &VolumeMap,
        cone: &Cone,
        (path, stretch, number, medium): (&CameraPath, &Stretch<'a>, usize, &'a Medium),
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let seed = seed(sample, stretch.ray.origin);
        let (factors, sink) = (&sample.scratch.factors, &mut *sample.sink);
        map.along(cone, |found: Neighbour<'_>| {
            if found.medium != number {
                return;
            }
            let here = stretch.passages(found.t, seed);
            let cosine = -found.incoming.dot(stretch.ray.direction);
            // A beam's light has still to come to the crossing, and to be scattered there.
            let came = found.came.map(|Came { start, distance_m }| {
                let ray = Ray { origin: start, direction: found.incoming };
                (
                    Passage::new(medium, ray, distance_m, hash64([seed, distance_m.to_bits()])),
                    medium.density_at(ray.at(distance_m)),
                )
            });
            let excess = |way: &[Passage<'_>]| excess_depth(way, path.reference_nm());
            let of_beam = came.as_ref().map_or(0.0, |(passage, _)| excess(&[*passage]));
            let bias = bias_of_excess(path.excess_depth + excess(&here) + of_beam);
            add_photon::<true, S>(found.load, (found.kernels, bias), (path.colour, factors), sink, |nm| {
                let arrived =
                    came.as_ref().map_or(1.0, |(passage, density)| passage.at(nm) * medium.scattering.at(nm) * density);
                arrived * medium.phase.at(cosine, nm) * passes(&here, nm)
            });
        });
    }
}

/// The seed of what is random about this sample's passages from a place on: what passes one after the other must be drawn independently.
fn seed<S>(sample: &Sample<'_, '_, S>, from: DVec3) -> u64 {
    let [x, y, z] = from.to_array().map(f64::to_bits);
    hash64([sample.pixel, sample.numbers.wavelength.to_bits(), x, y, z])
}
