//! Single scattering by light maps: direct light that a medium scatters into a camera ray.
//!
//! The estimator interpolates the transmittance in the light map at several random points of the
//! ray, which add noise but no bias; the only bias is the interpolation error of the map.
//! Visibility is not interpolated. A point casts a shadow ray if any map node around it sees the
//! light. Otherwise it is probably in shadow, and casts one with the probability 1/8 and a weight
//! of 8, so that even thin shadows and thin beams of light are found.

use super::distance::{self, MOST_DISTANCES, StratifiedDistance};
use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::{PathFactors, each_wavelength};
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::map::LightMap;
use crate::plan::{LightOrigin, Tally};
use crate::walk::{MediumSegment, NumberedMedium, Sink};
use abbe_optics::phase::Deflection;
use abbe_polarisation::Stokes;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::light::{EmittedSpd, LiSample};
use abbe_scene::medium::Medium;
use abbe_spectra::math::elementary::exp;
use abbe_spectra::spectrum::{LANES, Lanes, Wavelengths};

/// The light scattered into the camera along a segment of a camera ray, at each wavelength.
struct InScattering<'s, 'a> {
    scene: &'a Scene,
    map: &'s LightMap<'a>,
    medium: &'a Medium,
    wavelengths: Wavelengths,
    /// The scattering coefficient σ_s of the medium, in 1/m.
    scattering: Lanes,
    /// The extinction coefficient σ_t of the medium, in 1/m.
    extinction: Lanes,
    /// The absorption coefficient of the clear body around the medium, in 1/m.
    absorption: Lanes,
    /// The coefficients (1/m) of all media and bodies that attenuate the light in the map.
    coefficients: &'s [Lanes],
    factors: &'s PathFactors<'a>,
    sum: Lanes,
    /// The Stokes vectors of the sum.
    stokes: [Stokes; LANES],
    bias: Lanes,
    /// The number of the lookup that casts a shadow ray even if its point is probably in shadow.
    dark_lookup: usize,
    lookups: usize,
}

impl<'a> CameraPass<'a> {
    pub(super) fn gather_mapped_lights<S: Sink>(
        &self,
        path: &CameraPath,
        segment: &MediumSegment<'a>,
        NumberedMedium { number, medium }: NumberedMedium<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        for map in self.light_maps.over(number) {
            let light = &self.scene.lights[map.light];
            let (world, [u, v, w]) = (self.scene.extent(), context.sampler.stream.triple());
            let interval = medium.interval(&segment.ray, segment.length_m);
            let lit = interval
                .and_then(|interval| light.lit_interval(world, &segment.ray, interval, map.virtual_light.randoms()));
            let Some(lit) = lit else { continue };
            let (mut nm, mut weight, mut count) = ([0.0; LANES], [0.0; LANES], 0);
            let (factors, wavelength) = (&context.buffers.factors, context.sampler.wavelength);
            each_wavelength(path.spectral_mode, factors, light, wavelength, |at, throughput| {
                (nm[count], weight[count]) = (at, throughput * light.spd_at(EmittedSpd::Own, at));
                count += 1;
            });
            let wavelengths = Wavelengths { nm, count };
            context.buffers.coefficients.clear();
            context.buffers.coefficients.extend(map.coefficients(&wavelengths));
            let mut scattered = InScattering {
                scene: self.scene,
                map,
                medium,
                wavelengths,
                scattering: wavelengths.each(|nm| medium.scattering.at(nm)),
                extinction: wavelengths.each(|nm| medium.extinction.at(nm)),
                absorption: wavelengths.each(|nm| segment.absorption.map_or(0.0, |absorption| absorption.at(nm))),
                coefficients: &context.buffers.coefficients,
                factors: &context.buffers.factors,
                sum: [0.0; LANES],
                stokes: [Stokes::default(); LANES],
                bias: [0.0; LANES],
                dark_lookup: (w * MOST_DISTANCES as f64) as usize,
                lookups: 0,
            };
            distance::for_each_stratified(medium, &segment.ray, &lit, [u, v], |distance| {
                let position = segment.ray.at(distance.t_m);
                if let Some(incident) = light.li_from(world, &map.virtual_light, position) {
                    let ray = Ray::new(position, segment.ray.direction);
                    scattered.add(&distance, &ray, &incident, context.tally);
                }
            });
            context.tally.light_map_lookups += scattered.lookups as u64;
            let origin = LightOrigin { class: path.events.class_in_medium(), light: map.light };
            for k in 0..count {
                context.sink.biased(origin, nm[k], weight[k] * scattered.sum[k], weight[k] * scattered.bias[k]);
                scattered.factors.deliver_stokes(nm[k], weight[k], &scattered.stokes[k], context.sink);
            }
        }
    }
}

impl InScattering<'_, '_> {
    /// Adds the light scattered at one distance, where `ray` and the shadow ray start.
    fn add(&mut self, distance: &StratifiedDistance, ray: &Ray, incident: &LiSample, tally: &mut Tally) {
        let lookup = self.map.lookup(ray.origin);
        let selected = self.lookups == self.dark_lookup;
        self.lookups += 1;
        let weight = match (self.map.may_be_lit(&lookup), selected) {
            (true, _) => 1.0,
            (false, true) => MOST_DISTANCES as f64,
            (false, false) => return,
        };
        tally.shadow_rays += 1;
        let shadow_ray = Ray::new(ray.origin, incident.direction);
        if self.scene.geometry.occluded(&shadow_ray, None, incident.target, incident.distance) {
            return;
        }
        let directions = [-incident.direction, -ray.direction];
        let deflection = Deflection::between(directions[0], directions[1]);
        let event = self.factors.event_in_medium(self.medium, directions);
        let phase = self.wavelengths.each(|nm| self.medium.phase.eval(deflection, nm));
        let [fine, coarse] = self.map.optical_depths(&lookup, incident.distance, self.coefficients);
        for k in 0..self.wavelengths.count {
            let depth = self.extinction[k] * distance.column_m + self.absorption[k] * distance.t_m;
            let scattered =
                weight * self.scattering[k] * phase[k] * incident.irradiance * distance.strength_m * exp(-depth);
            let (fine_part, coarse_part) = (exp(-fine[k]), exp(-coarse[k]));
            let scattered = if self.factors.depends_on_polarisation() {
                let received = self.factors.received(self.wavelengths.nm[k], event.as_ref());
                self.stokes[k] += received * (scattered * fine_part);
                scattered * received.power().max(0.0)
            } else {
                scattered
            };
            let (fine, coarse) = (scattered * fine_part, scattered * coarse_part);
            self.sum[k] += fine;
            self.bias[k] += (coarse - fine) / 3.0;
        }
    }
}
