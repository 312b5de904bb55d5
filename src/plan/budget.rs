//! How many passes and photons, and how much memory.

use super::Plan;
use crate::math::random::REPLICATES;
use crate::scene::Scene;

/// Passes without any stop rule.
pub const DEFAULT_PASSES: u64 = 64;

/// Photon paths a pass: enough to fill the first radii, few enough that passes are short and wavelengths many.
pub const DEFAULT_PHOTONS: u64 = 200_000;

/// Surface events a path may have.
pub const DEFAULT_MAX_DEPTH: u32 = 64;

/// Photons within the first radius.
pub const DEFAULT_NEAREST: u32 = 50;

/// Cells of the first pass's light maps along the longest side of a medium's box.
pub const DEFAULT_LIGHT_MAP_CELLS: u32 = 32;

/// Bytes of a light map's node: whether it sees the lamp,
const LIGHT_MAP_NODE_BYTES: u64 = 1;

/// and for each matter that may be on the way a mean density, once more while those of absent matters are dropped.
const LIGHT_MAP_MATTER_BYTES: u64 = 2 * 4;

/// Bytes of a stored photon: payload and position in the tree, and once more while it is sorted.
const PHOTON_BYTES: u64 = 2 * 56;

/// A photon path meets a few diffuse surfaces; two photons are kept on average.
const BYTES_A_PATH: u64 = 2 * PHOTON_BYTES;

/// What the pilot leaves of a pixel: eight radii, the number of its outline, and a third of an outline (44 bytes, near edges only).
const PILOT_BYTES_A_PIXEL: u64 = 8 * 4 + 4 + 44 / 3;

/// Numbers that fix a render, from the scene's settings or by default.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// Passes, if no other stop rule holds.
    pub passes: u64,
    /// Photon paths a pass.
    pub photons: u64,
    /// Surface events a path may have.
    pub max_depth: u32,
    /// Photons within the first radius.
    pub nearest: u32,
    /// First radius in m, if the scene fixes it.
    pub radius_m: Option<f64>,
    /// Cells of the first pass's light maps along the longest side of a medium's box.
    pub light_map_cells: u32,
    /// Seed.
    pub seed: u64,
    /// Estimated memory of film and photons.
    pub memory_bytes: u64,
    /// How far, in pixels, things move over the picture while the shutter is open.
    pub motion_px: f64,
}

/// Passes that show no steps of something that moves over so many pixels: two for each pixel, in whole rounds of the replicates.
pub fn passes_without_strobing(motion_px: f64) -> u64 {
    ((2.0 * motion_px).ceil() as u64).next_multiple_of(REPLICATES as u64)
}

/// Photon paths a pass if the scene leaves them open: as many in all as in the default number of passes, but not so few that a pass tells nothing.
fn photons_a_pass(passes: u64) -> u64 {
    const LEAST: u64 = 20_000;
    (DEFAULT_PHOTONS * DEFAULT_PASSES / passes).max(LEAST)
}

/// The most that the light maps of any pass take: boxes of media are no larger than cubes.
fn light_map_bytes(scene: &Scene, cells: u32, passes: u64) -> u64 {
    let lamps = scene.lights.iter().filter(|light| light.can_be_picked()).count() as u64;
    let media = scene.media.iter().filter(|medium| medium.scatters()).count() as u64;
    let absorbing = scene.materials.iter().filter_map(|material| material.body.as_ref()?.absorption.as_ref()).count();
    let matters = (scene.media.len() + absorbing) as u64;
    let nodes = (u64::from(grown(cells, passes.saturating_sub(1))) + 2).saturating_pow(3);
    nodes.saturating_mul((LIGHT_MAP_NODE_BYTES + matters * LIGHT_MAP_MATTER_BYTES) * lamps * media)
}

fn grown(cells: u32, pass: u64) -> u32 {
    (f64::from(cells) * (f64::from((pass + 1).ilog2()) / 6.0).exp2()).round() as u32
}

impl Budget {
    /// Whether so few passes may show a moving thing in steps.
    pub fn strobes(&self) -> bool {
        (self.passes as f64) < 2.0 * self.motion_px
    }

    /// The budget of a scene whose film takes `film_bytes` (the film is the sensor's business, of which the plan knows nothing).
    pub fn of(scene: &Scene, plan: &Plan, film_bytes: u64) -> Self {
        let settings = &scene.settings;
        let motion_px = scene.image_motion_px();
        let enough = DEFAULT_PASSES.max(passes_without_strobing(motion_px));
        let (passes, photons) =
            (settings.passes.unwrap_or(enough), settings.photons.unwrap_or_else(|| photons_a_pass(enough)));
        let light_map_cells = settings.light_map.unwrap_or(DEFAULT_LIGHT_MAP_CELLS);
        let (width, height) = (u64::from(scene.film.width), u64::from(scene.film.height));
        let memory_bytes = film_bytes
            .saturating_add(PILOT_BYTES_A_PIXEL.saturating_mul(width.saturating_mul(height)))
            .saturating_add(photons.saturating_mul(BYTES_A_PATH))
            .saturating_add(scene.geometry.memory_bytes() as u64)
            .saturating_add(if plan.between.maps_lamps() {
                light_map_bytes(scene, light_map_cells, passes)
            } else {
                0
            });
        Self {
            passes,
            photons,
            max_depth: settings.max_depth.unwrap_or(DEFAULT_MAX_DEPTH),
            nearest: settings.nearest.unwrap_or(DEFAULT_NEAREST),
            radius_m: settings.radius_m,
            light_map_cells,
            seed: settings.seed.unwrap_or(0),
            memory_bytes,
            motion_px,
        }
    }

    /// The memory where a pass keeps this many photons, instead of as many as are expected of its paths.
    pub fn memory_keeping(&self, photons: u64) -> u64 {
        let rest = self.memory_bytes.saturating_sub(self.photons.saturating_mul(BYTES_A_PATH));
        rest.saturating_add(photons.saturating_mul(PHOTON_BYTES))
    }

    /// Cells of a pass's light maps along the longest side of a medium's box: they shrink as kernels on surfaces do, whose radius falls as
    /// pass^(−1/6), but in steps, where the number of passes has doubled, so that maps of what stands still are made only then.
    pub fn light_map_cells(&self, pass: u64) -> u32 {
        grown(self.light_map_cells, pass)
    }

    /// How many photon paths a pass may have for all to fit in this memory, to two digits; 0 if the rest alone does not.
    pub fn photons_within(&self, bytes: u64) -> u64 {
        let rest = self.memory_bytes.saturating_sub(self.photons.saturating_mul(BYTES_A_PATH));
        let photons = bytes.saturating_sub(rest) / BYTES_A_PATH;
        let digit = 10_u64.pow(photons.checked_ilog10().unwrap_or(0).saturating_sub(1));
        photons / digit * digit
    }
}
