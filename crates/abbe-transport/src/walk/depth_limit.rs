//! The end of long paths.
//!
//! Russian roulette by weight alone would not end the paths of light that glass traps without loss,
//! so a second factor of the survival probability falls with the length of the path, and paths in
//! almost lossless cavities end at a cap. A scene may set a smaller limit. The light that such an
//! explicit limit removes from the picture is measured: a few truncated paths continue beyond the
//! limit, and their light becomes a part of the estimated bias.

use super::sink::{SensorResponse, Sink};
use crate::plan::{LightOrigin, PathClass};
use abbe_scene::Scene;
use abbe_spectra::math::random::Stream;

/// The cap: the largest number of surface events on a path, and of collisions with media between
/// two surfaces. Only paths in almost lossless cavities and media are so long.
pub const MAX_EVENTS: u32 = 10_000;

/// The number of surface events after which the survival probability falls with the path's length.
pub const LONG_PATH: u32 = 32;

/// One of this many paths continues beyond an explicit limit.
const PATHS_PER_TRUNCATED_PATH: f64 = 8.0;

/// The number of surface events after which a path ends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DepthLimit {
    /// The limit that the scene sets, or `None` if only the cap ends paths.
    explicit: Option<u32>,
}

impl DepthLimit {
    #[inline]
    pub fn of(scene: &Scene) -> Self {
        Self { explicit: scene.settings.max_depth }
    }

    /// Returns the largest number of surface events of a path whose light reaches the picture.
    #[inline]
    pub fn events(self) -> u32 {
        self.explicit.unwrap_or(MAX_EVENTS).min(MAX_EVENTS)
    }

    /// Returns true if the scene sets a limit below the cap.
    #[inline]
    pub fn is_explicit(self) -> bool {
        self.events() < MAX_EVENTS
    }

    /// Decides whether a path at the limit continues as truncated, and returns its factor.
    pub fn sample_truncated_path(self, stream: &mut Stream) -> Option<f64> {
        let continues = self.is_explicit() && stream.uniform() * PATHS_PER_TRUNCATED_PATH < 1.0;
        continues.then_some(PATHS_PER_TRUNCATED_PATH)
    }
}

/// Returns the factor of the survival probability of a path after surface event number `depth`.
/// Without other losses, the fraction 32/d of the paths survives event d, so the mean number of
/// events is only about 32 (1 + ln(d/32)), and no weight exceeds d/32.
#[inline]
pub fn long_path_survival(depth: u32) -> f64 {
    if depth <= LONG_PATH { 1.0 } else { f64::from(depth - 1) / f64::from(depth) }
}

/// A sink for light that a limit removes from the picture. It changes only the estimated bias
/// (estimate minus exact value), which is therefore negative.
pub struct TruncatedLight<'s> {
    pub sink: &'s mut dyn Sink,
    pub factor: f64,
}

impl Sink for TruncatedLight<'_> {
    fn radiance(&mut self, origin: LightOrigin, nm: f64, weight: f64) {
        self.sink.biased(origin, nm, 0.0, -self.factor * weight);
    }

    fn biased(&mut self, origin: LightOrigin, nm: f64, weight: f64, _bias: f64) {
        self.radiance(origin, nm, weight);
    }

    fn respond(&mut self, class: PathClass, radiance: SensorResponse, _bias: SensorResponse) {
        self.sink.respond(class, SensorResponse::default(), radiance.scaled(-self.factor));
    }
}
