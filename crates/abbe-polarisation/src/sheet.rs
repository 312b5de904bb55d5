//! Plates and piles of plates whose reflections add incoherently.

use super::diattenuating_retarder::DiattenuatingRetarder;
use super::surface::SurfaceMatrices;
use abbe_optics::fresnel;
use abbe_optics::thin_film::StackResponse;

/// An interface, a plate or a pile of plates with parallel faces. The powers of the reflections
/// between them add, separately for s and p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Reflection of light that meets the front.
    pub front: DiattenuatingRetarder,
    /// Reflection of light that meets the back.
    pub back: DiattenuatingRetarder,
    /// Transmission, which is the same in both directions.
    pub transmitted: DiattenuatingRetarder,
}

impl Sheet {
    /// Returns an interface from index `n_i` to index `n_t`, for light in front of it with the
    /// cosine of incidence `cos_i`.
    pub fn interface(cos_i: f64, n_i: f64, n_t: f64) -> Self {
        let SurfaceMatrices { reflected, transmitted } = SurfaceMatrices::dielectric(cos_i, n_i, n_t);
        let cos_t = fresnel::cos_transmitted(cos_i, n_i, n_t);
        Self { front: reflected, back: SurfaceMatrices::dielectric(cos_t, n_t, n_i).reflected, transmitted }
    }

    /// Returns a face with films, from its responses to light from the front and from the back.
    pub fn films(front: &StackResponse, back: &StackResponse) -> Self {
        let SurfaceMatrices { reflected, transmitted } = SurfaceMatrices::of_films(front);
        Self { front: reflected, back: SurfaceMatrices::of_films(back).reflected, transmitted }
    }

    /// Returns a layer that absorbs and does not reflect. `passage` is its transmittance.
    pub fn absorber(passage: f64) -> Self {
        let nothing = DiattenuatingRetarder::OPAQUE;
        Self { front: nothing, back: nothing, transmitted: DiattenuatingRetarder::IDENTITY * passage }
    }

    /// Returns a plate of index `n` in a medium of index `n_outside`. `passage` is the internal
    /// transmittance of one passage, from 0 to 1.
    pub fn plate(cos_i: f64, n_outside: f64, n: f64, passage: f64) -> Self {
        let cos_t = fresnel::cos_transmitted(cos_i, n_outside, n);
        let front = Self::interface(cos_i, n_outside, n);
        front.then(Self::absorber(passage)).then(Self::interface(cos_t, n, n_outside))
    }

    /// Returns this sheet with another one behind it, and all reflections between both.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        let between = (self.back * next.front).repeated();
        let through = |a: Self, b: DiattenuatingRetarder| a.transmitted * a.transmitted * b * between;
        Self {
            front: self.front + through(self, next.front),
            back: next.back + through(next, self.back),
            transmitted: self.transmitted * next.transmitted * between,
        }
    }

    /// Returns a pile of `count` such sheets. A pile of 0 sheets transmits everything.
    #[must_use]
    pub fn pile(self, count: u32) -> Self {
        (0..count).fold(Self::absorber(1.0), |pile, _| pile.then(self))
    }
}
