//! How many photons in media are near each pixel's ray: from that the first radii follow, and how many beams are worth keeping.

use crate::gather::{Leg, Maps};
use crate::map::{Beam, Cone};

/// Photons within the first radius: fewer than on a surface, since a ray sees them all along its way.
const NEAREST: f64 = 16.0;

/// Kernels for photons in media span at first at most and at least this many pixels (radii).
const LARGEST_PIXELS: f64 = 6.0;
const LEAST_PIXELS: f64 = 0.7;

/// Beams that a set keeps in a pass at most.
const MOST_BEAMS: f64 = 20_000.0;

/// Beams that the pilot looks at.
const PILOT_BEAMS: usize = 4_000;

/// The photons of one set near a ray, within the widest radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crowd {
    points: f64,
    beams: f64,
}

/// Those of the free and of the shared set; `None` where the pixel's paths cross no medium on such wavelengths.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Crowds {
    free: Option<Crowd>,
    shared: Option<Crowd>,
}

impl Crowds {
    /// Counts along the legs of a pixel's paths. Of several the most crowded counts.
    pub(super) fn along(legs: &[Leg], (free, shared): (&Maps, &Maps), pixel_angle: f64) -> Self {
        let mut crowds = Self::default();
        for leg in legs {
            let (maps, known) = if leg.shared { (shared, &mut crowds.shared) } else { (free, &mut crowds.free) };
            let Leg { ray, length_m, behind_m, .. } = *leg;
            let cone = Cone { ray, length_m, behind_m, slope: LARGEST_PIXELS * pixel_angle };
            let mut here = Crowd { points: 0.0, beams: 0.0 };
            maps.points.along(&cone, |_| here.points += 1.0);
            maps.beams.along(&cone, |_| here.beams += 1.0);
            let before = known.unwrap_or(here);
            *known = Some(Crowd { points: before.points.max(here.points), beams: before.beams.max(here.beams) });
        }
        crowds
    }

    /// The free set's and the shared set's.
    pub(super) fn of_sets(&self) -> [Option<Crowd>; 2] {
        [self.free, self.shared]
    }
}

impl Crowd {
    /// The first radius, per distance from the camera, where every beam that the pilot found stands for `beams_a_found` in a pass.
    pub(super) fn slope(&self, beams_a_found: f64, pixel_angle: f64) -> f64 {
        let within = |found: f64, dimensions: f64| (NEAREST / found.max(NEAREST)).powf(1.0 / dimensions);
        let narrow = within(self.points, 2.0).min(within(self.beams * beams_a_found, 1.0));
        pixel_angle * (LARGEST_PIXELS * narrow).max(LEAST_PIXELS)
    }
}

/// Leaves few of many beams for the pilot to look at; each then stands for as many as come back.
pub(super) fn thin(beams: &mut Vec<Beam>) -> f64 {
    let step = beams.len().div_ceil(PILOT_BEAMS).max(1);
    *beams = beams.iter().copied().step_by(step).collect();
    step as f64
}

/// The probability with which passes keep a beam: of `beams`, at most some, and no more than enough for a typical sparse pixel at the least radius. More would
/// cost time in every pass and lessen noise less than more passes do.
pub(super) fn share(crowds: &[Crowds], beams: usize, thinning: f64) -> f64 {
    let most = (MOST_BEAMS / beams.max(1) as f64).min(1.0);
    let mut found: Vec<f64> = crowds
        .iter()
        .flat_map(Crowds::of_sets)
        .flatten()
        .map(|crowd| crowd.beams)
        .filter(|&beams| beams > 0.0)
        .collect();
    found.sort_by(f64::total_cmp);
    let sparse = found.get(found.len() / 4).copied().unwrap_or(0.0);
    let at_least_radius = sparse * thinning * LEAST_PIXELS / LARGEST_PIXELS;
    most.min(NEAREST / at_least_radius.max(NEAREST))
}
