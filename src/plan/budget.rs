//! How many passes and photons, and how much memory.

use crate::scene::Scene;

/// Passes without any stop rule.
pub const DEFAULT_PASSES: u64 = 64;

/// Photon paths a pass: enough to fill the first radii, few enough that passes are short and wavelengths many.
pub const DEFAULT_PHOTONS: u64 = 200_000;

/// Surface events a path may have.
pub const DEFAULT_MAX_DEPTH: u32 = 64;

/// Photons within the first radius.
pub const DEFAULT_NEAREST: u32 = 50;

/// Bytes of a stored photon: payload and position in the tree, and once more while it is sorted.
const PHOTON_BYTES: u64 = 2 * 56;

/// A photon path meets a few diffuse surfaces; two photons are kept on average.
const BYTES_A_PATH: u64 = 2 * PHOTON_BYTES;

/// What the pilot leaves of a pixel: four radii, the number of its outline, and a third of an outline (44 bytes, near edges only).
const PILOT_BYTES_A_PIXEL: u64 = 4 * 4 + 4 + 44 / 3;

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
    /// Seed.
    pub seed: u64,
    /// Estimated memory of film and photons.
    pub memory_bytes: u64,
}

impl Budget {
    /// The budget of a scene whose film takes `film_bytes` (the film is the sensor's business, of which the plan knows nothing).
    pub fn of(scene: &Scene, film_bytes: u64) -> Self {
        let settings = &scene.settings;
        let photons = settings.photons.unwrap_or(DEFAULT_PHOTONS);
        let (width, height) = (u64::from(scene.film.width), u64::from(scene.film.height));
        let memory_bytes = film_bytes
            .saturating_add(PILOT_BYTES_A_PIXEL.saturating_mul(width.saturating_mul(height)))
            .saturating_add(photons.saturating_mul(BYTES_A_PATH))
            .saturating_add(scene.geometry.memory_bytes() as u64);
        Self {
            passes: settings.passes.unwrap_or(DEFAULT_PASSES),
            photons,
            max_depth: settings.max_depth.unwrap_or(DEFAULT_MAX_DEPTH),
            nearest: settings.nearest.unwrap_or(DEFAULT_NEAREST),
            radius_m: settings.radius_m,
            seed: settings.seed.unwrap_or(0),
            memory_bytes,
        }
    }

    /// How many photon paths a pass may have for all to fit in this memory, to two digits; 0 if the rest alone does not.
    pub fn photons_within(&self, bytes: u64) -> u64 {
        let rest = self.memory_bytes.saturating_sub(self.photons.saturating_mul(BYTES_A_PATH));
        let photons = bytes.saturating_sub(rest) / BYTES_A_PATH;
        let digit = 10_u64.pow(photons.checked_ilog10().unwrap_or(0).saturating_sub(1));
        photons / digit * digit
    }
}
