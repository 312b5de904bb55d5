//! Light that comes straight from a lamp and is scattered into a camera ray, looked up in the lamp's map at many places of the ray.
//!
//! The places are drawn, so that they bring noise and no error of steps; what the map's cells do to the light is its bias. Whether the lamp is seen
//! is no matter for interpolation: a shadow ray decides, from each place that may be lit, and from one in eight, which counts for all, where the
//! nodes around say that it is dark. So no shadow and no ray of light is too thin to be found.

use super::camera_path::CameraPath;
use super::distance::{self, STOPS, Stop};
use super::photon_gather::{Gatherer, Sample, each_wavelength};
use crate::map::LightMap;
use crate::scene::geometry::Ray;
use crate::scene::light::{Incident, Tint};
use crate::scene::medium::Medium;
use crate::spectrum::{LANES, Lanes, Wavelengths};
use crate::walk::{Sink, Stretch, Tally};

/// The light scattered into a stretch of a camera ray, at each wavelength.
struct Scattered<'s> {
    wavelengths: Wavelengths,
    /// σ_s and σ_t of the medium, and the absorption of the body that holds it, in 1/m.
    scattering: Lanes,
    extinction: Lanes,
    absorption: Lanes,
    /// What weakens light on its way from the lamp.
    coefficients: &'s [Lanes],
    sum: Lanes,
    bias: Lanes,
    /// The place, by its number, that is asked though it lies in the dark.
    asked: usize,
    looks: usize,
}

impl<'a> Gatherer<'a> {
    /// Light of the lamps that have maps over this medium.
    pub(super) fn gather_mapped_lamps<S: Sink>(
        &self,
        path: &CameraPath,
        (stretch, number, medium): (&Stretch<'a>, usize, &'a Medium),
        sample: &mut Sample<'_, 'a, S>,
    ) {
        for map in self.light_maps.over(number) {
            let light = &self.scene.lights[map.light];
            let (world, [u, v, w]) = (self.scene.world(), sample.numbers.stream.triple());
            let window = medium.window(&stretch.ray, stretch.length_m);
            let reach = window.and_then(|window| light.reach(world, &stretch.ray, window, map.pick.numbers()));
            let Some(reach) = reach else { continue };
            let (mut nm, mut share, mut count) = ([0.0; LANES], [0.0; LANES], 0);
            each_wavelength(path.colour, &sample.scratch.factors, light, sample.numbers.wavelength, |at, worth| {
                (nm[count], share[count]) = (at, worth * light.shape_at(Tint::Own, at));
                count += 1;
            });
            let wavelengths = Wavelengths { nm, count };
            sample.scratch.coefficients.clear();
            sample.scratch.coefficients.extend(map.coefficients(&wavelengths));
            let mut scattered = Scattered {
                wavelengths,
                scattering: wavelengths.each(|nm| medium.scattering.at(nm)),
                extinction: wavelengths.each(|nm| medium.extinction.at(nm)),
                absorption: wavelengths.each(|nm| stretch.absorption.map_or(0.0, |absorption| absorption.at(nm))),
                coefficients: &sample.scratch.coefficients,
                sum: [0.0; LANES],
                bias: [0.0; LANES],
                asked: (w * STOPS as f64) as usize,
                looks: 0,
            };
            distance::spread(medium, &stretch.ray, &reach, [u, v], |stop| {
                let place = stretch.ray.at(stop.t);
                if let Some(incident) = light.picked(world, &map.pick, place) {
                    let ray = Ray::new(place, stretch.ray.direction);
                    self.look_up(map, (&stop, &ray), (&incident, medium), &mut scattered, sample.tally);
                }
            });
            sample.tally.light_map_looks += scattered.looks as u64;
            for k in 0..count {
                sample.sink.biased(nm[k], share[k] * scattered.sum[k], share[k] * scattered.bias[k]);
            }
        }
    }

    /// Adds what one place of the ray scatters.
    fn look_up(
        &self,
        map: &LightMap<'a>,
        (stop, ray): (&Stop, &Ray),
        (incident, medium): (&Incident, &Medium),
        scattered: &mut Scattered<'_>,
        tally: &mut Tally,
    ) {
        let look = map.look(ray.origin);
        let asked = scattered.looks == scattered.asked;
        scattered.looks += 1;
        let share = match (map.may_see(&look), asked) {
            (true, _) => 1.0,
            (false, true) => STOPS as f64,
            (false, false) => return,
        };
        tally.shadow_rays += 1;
        let way = Ray::new(ray.origin, incident.direction);
        if self.scene.geometry.occluded(&way, None, incident.target, incident.distance) {
            return;
        }
        // Against the light's way, and against the ray, which goes to meet it.
        let cosine = incident.direction.dot(ray.direction);
        let phase = scattered.wavelengths.each(|nm| medium.phase.at(cosine, nm));
        let [fine, coarse] = map.depths(&look, incident.distance, scattered.coefficients);
        for k in 0..scattered.wavelengths.count {
            let here = scattered.extinction[k] * stop.column_m + scattered.absorption[k] * stop.t;
            let bright =
                share * scattered.scattering[k] * phase[k] * incident.irradiance * stop.strength * (-here).exp();
            let (fine, coarse) = (bright * (-fine[k]).exp(), bright * (-coarse[k]).exp());
            scattered.sum[k] += fine;
            scattered.bias[k] += (coarse - fine) / 3.0;
        }
    }
}
