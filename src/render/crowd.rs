//! How many photons in media are near each pixel's ray: from that the first radii follow, and how many beams are worth keeping.

use super::pass::Emitted;
use crate::gather::{Leg, Maps};
use crate::map::{Beam, Cone, VolumeMaps};
use crate::plan::partition::LightPath;

/// Photons of one class of paths within the first radius: fewer than on a surface, since a ray sees them all along its way.
const NEAREST: f64 = 10.0;

/// Kernels for photons in media span at least this many pixels at first (radii) …
const LEAST_PIXELS: f64 = 0.7;

/// … and at most as many: caustics have edges, light that was scattered before has none.
const LARGEST_CAUSTIC_PIXELS: f64 = 4.0;
const LARGEST_INDIRECT_PIXELS: f64 = 24.0;

/// Beams of one class that the pilot looks at.
const PILOT_BEAMS: usize = 2_000;

/// Beams of one class that a set keeps in a pass at most.
const MOST_BEAMS: f64 = 15_000.0;

/// The probabilities with which beams are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BeamShares {
    /// Those that came from lamps through glass: they are crowded where they are.
    caustic: f64,
    /// Those that were scattered before: they are spread over everything.
    indirect: f64,
}

/// The photons of one set and class near a ray, within the widest radius.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Near {
    points: f64,
    beams: f64,
}

/// The photons of one set near a ray.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Crowd {
    caustic: Near,
    indirect: Near,
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
            let before = known.unwrap_or_default();
            *known = Some(Crowd {
                caustic: before.caustic.or_more(&maps.volume_caustic, leg, LARGEST_CAUSTIC_PIXELS * pixel_angle),
                indirect: before.indirect.or_more(&maps.volume_indirect, leg, LARGEST_INDIRECT_PIXELS * pixel_angle),
            });
        }
        crowds
    }

    /// The free set's and the shared set's.
    pub(super) fn of_sets(&self) -> [Option<Crowd>; 2] {
        [self.free, self.shared]
    }
}

impl Near {
    /// This or what is near the leg, whichever is more.
    fn or_more(self, maps: &VolumeMaps, leg: &Leg, slope: f64) -> Self {
        let Leg { ray, length_m, behind_m, .. } = *leg;
        let cone = Cone { ray, length_m, behind_m, slope };
        let mut here = Self::default();
        maps.points.along(&cone, |_| here.points += 1.0);
        maps.beams.along(&cone, |_| here.beams += 1.0);
        Self { points: self.points.max(here.points), beams: self.beams.max(here.beams) }
    }

    /// The first radius in pixels, where every beam that the pilot found stands for so many in a pass.
    fn pixels(&self, beams_a_found: f64, largest: f64) -> f64 {
        let within = |found: f64, dimensions: f64| (NEAREST / found.max(NEAREST)).powf(1.0 / dimensions);
        let share = within(self.points, 2.0).min(within(self.beams * beams_a_found, 1.0));
        (largest * share).max(LEAST_PIXELS)
    }
}

impl Crowd {
    /// The first radii of both classes, per distance from the camera, where every beam that the pilot found stands for so many in a pass.
    pub(super) fn slopes(&self, a_found: BeamShares, pixel_angle: f64) -> [f64; 2] {
        [
            pixel_angle * self.caustic.pixels(a_found.caustic, LARGEST_CAUSTIC_PIXELS),
            pixel_angle * self.indirect.pixels(a_found.indirect, LARGEST_INDIRECT_PIXELS),
        ]
    }
}

/// Leaves few of many beams for the pilot to look at; returns the share that is left.
fn thin(beams: &mut Vec<Beam>) -> f64 {
    let step = beams.len().div_ceil(PILOT_BEAMS).max(1);
    *beams = beams.iter().copied().step_by(step).collect();
    1.0 / step as f64
}

impl BeamShares {
    /// All are kept.
    pub(super) const ALL: Self = Self { caustic: 1.0, indirect: 1.0 };

    /// The share of the beams of this class. Light straight from lamps is looked for, and needs none.
    pub(super) fn of(&self, path: LightPath) -> f64 {
        match path {
            LightPath::Direct => 0.0,
            LightPath::Caustic => self.caustic,
            LightPath::Indirect => self.indirect,
        }
    }

    /// Leaves few of many beams for the pilot to look at; returns the shares that are left.
    pub(super) fn thinning(emitted: &mut Emitted) -> Self {
        Self { caustic: thin(&mut emitted.volume_caustic.beams), indirect: thin(&mut emitted.volume_indirect.beams) }
    }

    /// The lesser of two shares, by class.
    pub(super) fn least(self, other: Self) -> Self {
        Self { caustic: self.caustic.min(other.caustic), indirect: self.indirect.min(other.indirect) }
    }

    /// How many beams one stands for that was found among the share `kept`.
    pub(super) fn relative_to(self, kept: Self) -> Self {
        Self { caustic: self.caustic / kept.caustic, indirect: self.indirect / kept.indirect }
    }

    /// Shares that leave enough beams: so many that the rays that see any pass about as many as an estimate wants, in the mean, within the least radius (of caustics) or
    /// the widest (of light that was scattered before, which is smooth). More would cost time in every pass and lessen noise less than more passes do. `kept` is
    /// the share that the pilot looked at.
    pub(super) fn enough(crowds: &[Crowds], kept: Self) -> Self {
        let share = |kept: f64, radii: f64, of: fn(&Crowd) -> Near| {
            let found = crowds.iter().flat_map(Crowds::of_sets).flatten().map(|crowd| of(&crowd).beams);
            let seen = found.filter(|&beams| beams > 0.0);
            let (count, sum) = seen.fold((0.0, 0.0), |(count, sum), beams| (count + 1.0, sum + beams));
            let wanted_in = sum / f64::max(count, 1.0) / kept / radii;
            let most = kept * MOST_BEAMS / PILOT_BEAMS as f64;
            (NEAREST / wanted_in.max(NEAREST)).min(most.min(1.0))
        };
        Self {
            caustic: share(kept.caustic, LARGEST_CAUSTIC_PIXELS / LEAST_PIXELS, |crowd| crowd.caustic),
            indirect: share(kept.indirect, 1.0, |crowd| crowd.indirect),
        }
    }
}
