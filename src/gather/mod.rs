//! Camera path → spectral radiance: through mirrors and glass to the first surface that scatters, and what light is there.
//! Beside it the reference path tracer.

mod camera_path;
mod direct;
mod distance;
mod estimate;
mod landing;
mod mapped_lamps;
mod media;
mod onward;
mod outline;
mod path_media;
mod path_tracer;
mod photon_gather;
mod throughput;

pub use camera_path::Scratch;
pub use direct::{Direct, power_heuristic};
pub use estimate::{Maps, RADIUS_KINDS, Radii, RadiusKind};
pub use landing::{Landing, Sightline};
pub use outline::{Outline, Outlines};
pub use path_tracer::PathTracer;
pub use photon_gather::Gatherer;

use crate::math::kronecker::golden;
use crate::math::random::{Purpose, REPLICATES, Stream, hash64};
use crate::math::sobol::{DIMENSIONS, Sobol};
use crate::scene::camera::{Aperture, Camera, SystemAt};
use crate::scene::geometry::Ray;
use glam::DVec2;

/// The random numbers of one camera sample: a pixel's samples over the passes of a replicate are low-discrepancy points, and the
/// replicates are scrambled apart.
#[derive(Debug)]
pub struct CameraNumbers {
    point: [f64; DIMENSIONS],
    /// For everything beyond the first few dimensions.
    pub stream: Stream,
    /// Shifts the wavelengths of this sample; from a sequence of its own, so that colour is correlated with nothing.
    pub wavelength: f64,
}

impl CameraNumbers {
    /// The numbers of `pixel` in `pass`.
    pub fn new(seed: u64, pass: u64, pixel: u64) -> Self {
        let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
        let key = hash64([seed, Purpose::Camera as u64, replicate, pixel]);
        Self {
            point: Sobol::new(key).point(index as u32),
            stream: Stream::new(seed, Purpose::Camera, pass, pixel),
            wavelength: golden(index as u32, hash64([key, 0x5eed])),
        }
    }

    /// Where in the pixel.
    fn film(&self) -> [f64; 2] {
        [self.point[0], self.point[1]]
    }

    /// Where on the lens.
    fn lens(&self) -> [f64; 2] {
        [self.point[2], self.point[3]]
    }

    /// Where on a lamp.
    pub fn lamp(&self) -> [f64; 3] {
        [self.point[4], self.point[5], self.point[6]]
    }

    /// The ray through the pixel.
    pub fn ray(&self, camera: &Camera, pixel: u64) -> Ray {
        let lens = match camera.aperture() {
            Aperture::Pinhole | Aperture::System(_) => [0.5; 2],
            Aperture::ThinLens { .. } => self.lens(),
        };
        camera.ray(corner(camera, pixel) + DVec2::from(self.film()), lens)
    }

    /// The ray through the pixel and the lens of real glass at a wavelength, and its weight.
    fn ray_through(&self, glass: &SystemAt<'_>, camera: &Camera, pixel: u64) -> Option<(Ray, f64)> {
        camera.ray_through(glass, corner(camera, pixel) + DVec2::from(self.film()), self.lens())
    }
}

/// The top left corner of a pixel.
fn corner(camera: &Camera, pixel: u64) -> DVec2 {
    let width = camera.width() as u64;
    DVec2::new((pixel % width) as f64, (pixel / width) as f64)
}
