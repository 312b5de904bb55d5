//! How many photons in media are near each pixel's ray: from that the first radii follow, and how many beams are worth keeping.

use super::pass::Emitted;
use crate::gather::{Maps, Radii, RadiusKind, Sightline};
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
    /// Counts along the sightlines of a pixel's paths, in the free and the shared set's maps, each of which holds these shares of its beams. Of several sightlines the
    /// most crowded counts.
    pub(super) fn along(sightlines: &[Sightline], maps: [(&Maps, BeamShares); 2], pixel_angle: f64) -> Self {
        let mut crowds = Self::default();
        for sightline in sightlines {
            let ((maps, kept), known) =
                if sightline.shared { (maps[1], &mut crowds.shared) } else { (maps[0], &mut crowds.free) };
            let near = |maps, kept, pixels| Near::to(sightline, (maps, kept), pixels * pixel_angle);
            let here = Crowd {
                caustic: near(&maps.volume_caustic, kept.caustic, LARGEST_CAUSTIC_PIXELS),
                indirect: near(&maps.volume_indirect, kept.indirect, LARGEST_INDIRECT_PIXELS),
            };
            *known = Some(known.map_or(here, |known| known.or_more(here)));
        }
        crowds
    }

    /// The more crowded of two moments.
    pub(super) fn or_more(self, other: Self) -> Self {
        let more = |a: Option<Crowd>, b: Option<Crowd>| match (a, b) {
            (Some(a), Some(b)) => Some(a.or_more(b)),
            (one, None) | (None, one) => one,
        };
        Self { free: more(self.free, other.free), shared: more(self.shared, other.shared) }
    }

    /// Sets a pixel's first radii in media, where passes keep these shares of all beams.
    pub(super) fn set_radii(&self, radii: &mut Radii, shares: BeamShares, pixel_angle: f64) {
        let kinds = [
            (self.free, [RadiusKind::FreeVolumeCaustic, RadiusKind::FreeVolumeIndirect]),
            (self.shared, [RadiusKind::SharedVolumeCaustic, RadiusKind::SharedVolumeIndirect]),
        ];
        for (crowd, [caustic, indirect]) in kinds {
            let Some(crowd) = crowd else { continue };
            let pixels = [
                (caustic, crowd.caustic.pixels(shares.caustic, LARGEST_CAUSTIC_PIXELS)),
                (indirect, crowd.indirect.pixels(shares.indirect, LARGEST_INDIRECT_PIXELS)),
            ];
            pixels.into_iter().for_each(|(kind, pixels)| radii[kind as usize] = (pixels * pixel_angle) as f32);
        }
    }
}

impl Near {
    /// The photons near the sightline, within a cone of this slope; the maps hold the share `kept` of all beams.
    fn to(sightline: &Sightline, (maps, kept): (&VolumeMaps, f64), slope: f64) -> Self {
        let Sightline { ray, length_m, behind_m, .. } = *sightline;
        let cone = Cone::of_camera(ray, length_m, behind_m, slope);
        let mut here = Self::default();
        maps.points.along(&cone, |_| here.points += 1.0);
        maps.beams.along(&cone, |_| here.beams += 1.0 / kept);
        here
    }

    fn or_more(self, other: Self) -> Self {
        Self { points: self.points.max(other.points), beams: self.beams.max(other.beams) }
    }

    /// The first radius in pixels, where a pass keeps this share of all beams.
    fn pixels(&self, share: f64, largest: f64) -> f64 {
        let within = |found: f64, dimensions: f64| (NEAREST / found.max(NEAREST)).powf(1.0 / dimensions);
        let narrow = within(self.points, 2.0).min(within(self.beams * share, 1.0));
        (largest * narrow).max(LEAST_PIXELS)
    }
}

impl Crowd {
    fn or_more(self, other: Self) -> Self {
        Self { caustic: self.caustic.or_more(other.caustic), indirect: self.indirect.or_more(other.indirect) }
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

    /// Shares that leave enough beams: so many that the rays that see any pass about as many as an estimate wants, in the mean, within the least radius (of caustics) or
    /// the widest (of light that was scattered before, which is smooth). More would cost time in every pass and lessen noise less than more passes do.
    pub(super) fn enough(crowds: &[Crowds], counts: BeamCounts) -> Self {
        let share = |count: usize, radii: f64, of: fn(&Crowd) -> Near| {
            let all = crowds.iter().flat_map(|crowds| [crowds.free, crowds.shared]).flatten();
            let seen = all.map(|crowd| of(&crowd).beams).filter(|&beams| beams > 0.0);
            let (rays, sum) = seen.fold((0.0, 0.0), |(rays, sum), beams| (rays + 1.0, sum + beams));
            let within = sum / f64::max(rays, 1.0) / radii;
            (NEAREST / within.max(NEAREST)).min(MOST_BEAMS / (count as f64).max(MOST_BEAMS))
        };
        Self {
            caustic: share(counts.caustic, LARGEST_CAUSTIC_PIXELS / LEAST_PIXELS, |crowd| crowd.caustic),
            indirect: share(counts.indirect, 1.0, |crowd| crowd.indirect),
        }
    }
}

/// How many beams a set has, by class.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct BeamCounts {
    caustic: usize,
    indirect: usize,
}

impl BeamCounts {
    /// Those of emitted photons.
    pub(super) fn of(emitted: &Emitted) -> Self {
        Self { caustic: emitted.volume_caustic.beams.len(), indirect: emitted.volume_indirect.beams.len() }
    }

    /// The more of two sets or moments.
    pub(super) fn or_more(self, other: Self) -> Self {
        Self { caustic: self.caustic.max(other.caustic), indirect: self.indirect.max(other.indirect) }
    }
}
