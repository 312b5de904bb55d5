//! The random numbers of camera samples.

use crate::gather::direct::portals::{PORTAL_FRACTION, Portals};
use crate::walk::RayState;
use abbe_scene::Scene;
use abbe_scene::camera::{Aperture, Camera, SystemAt};
use abbe_scene::geometry::Ray;
use abbe_scene::meter::{Response, Sensor, SensorPoint};
use abbe_spectra::math::kronecker::golden_ratio;
use abbe_spectra::math::random::{Purpose, REPLICATES, Seed, Stream, Streams};
use abbe_spectra::math::sobol::{DIMENSIONS, Sobol};
use glam::{DVec2, DVec3};

pub(in crate::gather) struct SensorSample {
    pub(in crate::gather) point: SensorPoint,
    pub(in crate::gather) ray_state: RayState,
    /// The density with which the direction was sampled, per steradian.
    pub(in crate::gather) pdf: f64,
    /// The density of the sensor's response, divided by `pdf`.
    pub(in crate::gather) weight: f64,
}

/// The random numbers of one camera sample. Within a replicate, which has its own scrambling, the
/// samples of a pixel form a low-discrepancy sequence over all passes.
#[derive(Debug)]
pub struct PixelSampler {
    point: [f64; DIMENSIONS],
    /// Gives the random numbers for all dimensions beyond those of the low-discrepancy point.
    pub stream: Stream,
    /// The number in [0, 1) that selects the wavelengths, from a separate sequence so that they do
    /// not correlate with any other number.
    pub wavelength: f64,
}

impl PixelSampler {
    /// Creates the sampler of the only camera sample of `pixel` in `pass`.
    pub fn new(streams: Streams, pass: u64, pixel: u64) -> Self {
        Self::nth(streams, pass, pixel, (0, 1))
    }

    /// Creates the sampler of the camera sample number `nth` of the `samples` of `pixel` in `pass`.
    pub fn nth(streams: Streams, pass: u64, pixel: u64, (nth, samples): (u64, u64)) -> Self {
        let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64 * samples + nth);
        let key = streams.pass(replicate).part(pixel);
        Self {
            point: Sobol::of(key).point(index as u32),
            stream: streams.pass(pass * samples + nth).path(pixel),
            wavelength: golden_ratio(index as u32, key.second_sequence().hash()),
        }
    }

    /// Returns the position in the pixel, in [0, 1)².
    fn film(&self) -> [f64; 2] {
        [self.point[0], self.point[1]]
    }

    /// Returns the numbers in [0, 1)² that select a point of the aperture.
    fn lens(&self) -> [f64; 2] {
        [self.point[2], self.point[3]]
    }

    /// Returns the numbers in [0, 1)³ that select a light and a point of the light.
    pub fn light(&self) -> [f64; 3] {
        [self.point[4], self.point[5], self.point[6]]
    }

    /// Samples a point of a sensor and a direction from which it receives light, sometimes through
    /// the glazed `portals`, because shadow rays do not pass through glass.
    pub(in crate::gather) fn sensor_sample(&self, scene: &Scene, sensor: &Sensor, portals: &Portals) -> SensorSample {
        let streams = Seed::of_numbers(self.point).streams(Purpose::Sensor);
        let more = |number: u64| streams.pass(number).uniform();
        let ([u, v], [across, along]) = (self.film(), self.lens());
        let point = scene.sensor_point(sensor, [more(0), across, along, more(1)]);
        let (response, choice) = (point.response, more(2));
        let direction = if portals.glazed.count() > 0 && choice < PORTAL_FRACTION {
            portals.glazed.sample(point.position, choice / PORTAL_FRACTION, [u, v])
        } else {
            response.sample([u, v, across])
        };
        let pdf = sensor_pdf((point.position, response), portals, direction);
        let ray = Ray { origin: point.position, direction };
        let weight = if pdf > 0.0 { response.pdf(direction) / pdf } else { 0.0 };
        SensorSample {
            point,
            ray_state: RayState { ray, from: point.from, medium_stack: point.medium_stack },
            pdf,
            weight,
        }
    }

    pub fn ray(&self, camera: &Camera, pixel: u64) -> Ray {
        let lens = match camera.aperture() {
            Aperture::Pinhole | Aperture::Orthographic | Aperture::System(_) => [0.5; 2],
            Aperture::ThinLens { .. } => self.lens(),
        };
        camera.ray(corner(camera, pixel) + DVec2::from(self.film()), lens)
    }

    /// Returns a ray at one wavelength (nm) from the camera, or from a sensor with the density of
    /// the direction per steradian, and the bodies around its origin. Returns `None` if a lens
    /// system stops the ray.
    pub fn ray_at(&self, scene: &Scene, pixel: u64, nm: f64) -> Option<(RayState, Option<f64>)> {
        let camera = &scene.camera;
        if let Some((_, sensor)) = camera.sensor(pixel) {
            let start = self.sensor_sample(scene, sensor, Portals::NONE);
            return Some((start.ray_state, Some(start.pdf)));
        }
        let ray = match camera.system() {
            Some(system) => self.ray_through_lens(&system.at(nm), camera, pixel, None)?.0,
            None => self.ray(camera, pixel),
        };
        Some((RayState { ray, from: None, medium_stack: scene.medium_stack_of_camera(ray) }, None))
    }

    /// Returns the camera ray through a pixel and a lens system at one wavelength, with its weight,
    /// or `None` if the lens stops it. `ghost` in [0, 1) selects a ghost of the lens; `None` is the
    /// image.
    pub(in crate::gather) fn ray_through_lens(
        &self,
        system: &SystemAt<'_>,
        camera: &Camera,
        pixel: u64,
        ghost: Option<f64>,
    ) -> Option<(Ray, f64)> {
        camera.ray_through(system, corner(camera, pixel) + DVec2::from(self.film()), self.lens(), ghost)
    }
}

/// Returns the density with which paths from a sensor start in a direction, per steradian.
pub fn sensor_pdf((position, response): (DVec3, Response), portals: &Portals, direction: DVec3) -> f64 {
    let pdf = response.pdf(direction);
    if portals.glazed.count() == 0 {
        return pdf;
    }
    PORTAL_FRACTION * portals.glazed.pdf(position, direction) + (1.0 - PORTAL_FRACTION) * pdf
}

fn corner(camera: &Camera, pixel: u64) -> DVec2 {
    let width = camera.width() as u64;
    DVec2::new((pixel % width) as f64, (pixel / width) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the correlation of two lists of uniform numbers.
    fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
        let (sum, count) = pairs.fold((0.0, 0.0), |(sum, n), (a, b)| (sum + (a - 0.5) * (b - 0.5), n + 1.0));
        12.0 * sum / count
    }

    /// The samples of different pixels, passes and purposes are independent.
    #[test]
    fn samples_of_pixels_and_passes_are_uncorrelated() {
        let numbers = |seed: u64, pass: u64, pixel: u64| {
            let sampler = PixelSampler::new(Seed::new(seed).streams(Purpose::Camera), pass, pixel);
            let [x, y] = sampler.film();
            let [u, v, w] = sampler.light();
            [x, y, u, v, w, sampler.wavelength]
        };
        for (pass, pixel) in [(0, 1), (1, 0), (8, 0), (3, 17)] {
            for i in 0..6 {
                for j in 0..6 {
                    let pair = |seed: u64| (numbers(seed, 0, 0)[i], numbers(seed, pass, pixel)[j]);
                    // Eight passes belong to one replicate, which is stratified over its passes.
                    if pass != 8 || i != j {
                        let found = correlation((0..1000).map(pair));
                        assert!(found.abs() < 0.15, "pass {pass}, pixel {pixel}, {i} and {j}: {found}");
                    }
                }
            }
        }
    }
}
