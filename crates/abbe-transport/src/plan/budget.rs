//! The budget of a render: passes, photons, path depth and memory.

use super::fields::Plan;
use abbe_scene::Scene;
use abbe_spectra::math::elementary::exp2;
use abbe_spectra::math::random::{REPLICATES, Seed};

/// The number of passes if the request contains no stop rule.
pub const DEFAULT_PASSES: u64 = 64;

/// The least default number of photon paths per pass: enough for small first radii, and few enough
/// for many short passes, which sample many wavelengths.
pub const DEFAULT_PHOTONS: u64 = 200_000;

/// The largest default number of photon paths per pass. It limits the memory of the photons.
const MOST_DEFAULT_PHOTONS: u64 = 1_000_000;

/// Returns the default number of photon paths per pass for a film: one per pixel, so that kernels
/// cover no more pixels on a large film, and the time of photons and camera paths stays in
/// proportion.
fn photons_for_film(pixels: u64) -> u64 {
    pixels.clamp(DEFAULT_PHOTONS, MOST_DEFAULT_PHOTONS)
}

/// The number of photons within the first kernel radius.
pub const DEFAULT_NEAREST: u32 = 50;

/// The number of light map cells in the first pass, along the longest side of a medium's box.
pub const DEFAULT_LIGHT_MAP_CELLS: u32 = 32;

/// Bytes per light map node for its visibility flag.
const LIGHT_MAP_NODE_BYTES: u64 = 1;

/// The mean density of one absorbing medium at one node, twice while the map removes the media that
/// no path from the light crosses.
const LIGHT_MAP_MEDIUM_BYTES: u64 = 2 * 4;

/// A photon and its position, twice while the map sorts, with 4 bytes for the order.
const PHOTON_BYTES: u64 = 2 * 32 + 4;

/// The polarisation of a stored photon, twice while the map sorts.
const POLARISATION_BYTES: u64 = 2 * 24;

/// The photons that a path stores on average.
const PHOTONS_PER_PATH: u64 = 2;

/// The pilot's results: eight radii, the index of the surface extent, and a third of an extent of
/// 44 bytes, stored near edges only.
const PILOT_PIXEL_BYTES: u64 = 8 * 4 + 4 + 44 / 3;

/// The pilot may halve the default number of photon paths this many times.
pub const PHOTON_HALVINGS: u32 = 3;

/// The pilot may double the default number of photon paths this many times.
pub const PHOTON_DOUBLINGS: u32 = 2;

/// The numbers that fix a render. Each number comes from the scene's settings or has a default.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The number of passes if the request contains no stop rule.
    pub passes: u64,
    /// The paths per pass. Unless explicit, the pilot may halve or double them
    /// ([`PHOTON_HALVINGS`], [`PHOTON_DOUBLINGS`]).
    pub photons: u64,
    pub photons_are_explicit: bool,
    /// Per pixel and pass, if explicit. Otherwise, the pilot chooses them.
    pub camera_samples: Option<u64>,
    /// The number of photons within the first kernel radius.
    pub nearest: u32,
    /// The first kernel radius in m, if the scene fixes it.
    pub radius_m: Option<f64>,
    /// The number of light map cells in the first pass, along the longest side of a medium's box.
    pub light_map_cells: u32,
    pub seed: Seed,
    /// The estimated memory of the film, the photons, the geometry and the light maps, in bytes.
    pub memory_bytes: u64,
    /// The memory of a stored photon, in bytes.
    pub photon_bytes: u64,
    /// The largest distance (pixels) that an object moves while the shutter is open.
    pub motion_px: f64,
}

/// Returns the least number of passes with which an object that moves over `motion_px` pixels does
/// not appear as separate images: two per pixel, up to a multiple of the replicates.
fn passes_without_strobing(motion_px: f64) -> u64 {
    ((2.0 * motion_px).ceil() as u64).next_multiple_of(REPLICATES as u64)
}

/// Returns the default photon paths per pass for these passes and pixels: as many in total as for
/// the default passes, but at least 20 000 per pass, so that its estimates stay usable.
fn photons_per_pass(passes: u64, pixels: u64) -> u64 {
    const MIN_PHOTONS: u64 = 20_000;
    (photons_for_film(pixels) * DEFAULT_PASSES / passes).max(MIN_PHOTONS)
}

/// Returns the samples of each row of sensors in a pass, which takes some milliseconds, so that the
/// stop rules are checked often.
fn sensor_samples(rows: u64) -> u64 {
    const SAMPLES_PER_PASS: u64 = 1 << 15;
    (SAMPLES_PER_PASS / rows.max(1)).clamp(16, 1 << 12).next_power_of_two()
}

/// Returns an upper bound of the light maps' bytes in any pass, for media in cubes.
fn light_map_bytes(scene: &Scene, cells: u32, passes: u64) -> u64 {
    let lights = scene.lights.iter().filter(|light| light.has_virtual_lights()).count() as u64;
    let scattering = scene.media.iter().filter(|medium| medium.scatters()).count() as u64;
    let absorbing = scene.materials.iter().filter_map(|material| material.body.as_ref()?.absorption.as_ref()).count();
    let media = (scene.media.len() + absorbing) as u64;
    let nodes = (u64::from(cells_in_pass(cells, passes.saturating_sub(1))) + 2).saturating_pow(3);
    nodes.saturating_mul((LIGHT_MAP_NODE_BYTES + media * LIGHT_MAP_MEDIUM_BYTES) * lights * scattering)
}

/// Returns the cells of a pass, from those of the first pass.
fn cells_in_pass(cells: u32, pass: u64) -> u32 {
    (f64::from(cells) * exp2(f64::from((pass + 1).ilog2()) / 6.0)).round() as u32
}

impl Budget {
    /// Returns true if there are so few passes that a moving object may appear as separate images.
    pub fn strobes(&self) -> bool {
        (self.passes as f64) < 2.0 * self.motion_px
    }

    /// `film_bytes` is the memory of the film, which the plan does not know.
    pub fn of(scene: &Scene, plan: &Plan, film_bytes: u64) -> Self {
        let settings = &scene.settings;
        let motion_px = scene.image_motion_px();
        let enough = DEFAULT_PASSES.max(passes_without_strobing(motion_px));
        let pixels = u64::from(scene.film.width).saturating_mul(u64::from(scene.film.height));
        let (passes, photons) =
            (settings.passes.unwrap_or(enough), settings.photons.unwrap_or_else(|| photons_per_pass(enough, pixels)));
        let measures = scene.measures();
        let light_map_cells = settings.light_map.unwrap_or(DEFAULT_LIGHT_MAP_CELLS);
        let photon_bytes = PHOTON_BYTES + if plan.polarisation.is_on() { POLARISATION_BYTES } else { 0 };
        let memory_bytes = film_bytes
            .saturating_add(PILOT_PIXEL_BYTES.saturating_mul(pixels))
            .saturating_add(photons.saturating_mul(PHOTONS_PER_PATH * photon_bytes))
            .saturating_add(scene.geometry.memory_bytes() as u64)
            .saturating_add(if plan.media_plan.has_light_maps() {
                light_map_bytes(scene, light_map_cells, passes)
            } else {
                0
            });
        Self {
            passes,
            photons,
            // The balance of photons and camera samples is measured on pictures.
            photons_are_explicit: settings.photons.is_some() || measures,
            camera_samples: settings.camera_samples.map(u64::from).or(measures.then(|| sensor_samples(pixels))),
            nearest: settings.nearest.unwrap_or(DEFAULT_NEAREST),
            radius_m: settings.radius_m,
            light_map_cells,
            seed: Seed::new(settings.seed.unwrap_or(0)),
            memory_bytes,
            photon_bytes,
            motion_px,
        }
    }

    /// Returns the memory in bytes of a pass that stores this number of photons.
    pub fn memory_keeping(&self, photons: u64) -> u64 {
        self.memory_without_photons().saturating_add(photons.saturating_mul(self.photon_bytes))
    }

    /// Returns the light map cells in a pass, along the longest side of a medium's box. They shrink
    /// as pass^(−1/6), like the kernel radii on surfaces, but only when the number of passes has
    /// doubled, so that most passes of a still scene reuse maps.
    pub fn light_map_cells(&self, pass: u64) -> u32 {
        cells_in_pass(self.light_map_cells, pass)
    }

    /// Returns the most photon paths per pass that fit into `bytes`, rounded down to two digits, 0
    /// if even a pass without photons is too large.
    pub fn photons_within(&self, bytes: u64) -> u64 {
        let photons = bytes.saturating_sub(self.memory_without_photons()) / (PHOTONS_PER_PATH * self.photon_bytes);
        let digit = 10_u64.pow(photons.checked_ilog10().unwrap_or(0).saturating_sub(1));
        photons / digit * digit
    }

    /// Returns the memory in bytes of all data except the photons.
    fn memory_without_photons(&self) -> u64 {
        self.memory_bytes.saturating_sub(self.photons.saturating_mul(PHOTONS_PER_PATH * self.photon_bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_film_gets_one_photon_path_per_pixel() {
        let photons = [1, 640 * 300, 512 * 512, 1920 * 1080].map(|pixels| photons_per_pass(DEFAULT_PASSES, pixels));
        assert_eq!(photons, [200_000, 200_000, 262_144, 1_000_000]);
        assert_eq!(photons_per_pass(4 * DEFAULT_PASSES, 512 * 512), 65_536, "fast motion divides them among passes");
    }
}
