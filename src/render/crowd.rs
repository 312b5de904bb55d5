//! How many photons in media are near each pixel's ray: from that the first radii follow, and how many photons are worth keeping.

use super::Job;
use super::harvest::InMedia;
use super::pass::Emitted;
use crate::gather::{Maps, Radii, RadiusKind, Sightline};
use crate::map::{Cone, VolumeMaps, Width};
use crate::plan::partition::LightPath;
use crate::scene::medium::Medium;

/// Photons of one class of paths within the first radius: fewer than on a surface, since a ray sees them all along its way.
const NEAREST: f64 = 10.0;

/// Kernels for photons in media span at least this many pixels at first (radii) …
const LEAST_PIXELS: f64 = 0.7;

/// … and at most as many: caustics have edges, light that was scattered before has none.
const LARGEST_CAUSTIC_PIXELS: f64 = 4.0;
const LARGEST_INDIRECT_PIXELS: f64 = 24.0;

/// Kernels for points span at most this share of a mean free path at first: near the medium's surface, from where most of the light comes that leaves a dense
/// one, they would find nothing beyond it and lose in proportion to their width.
const LARGEST_FREE_PATHS: f64 = 0.5;

/// Beams, and points, of one class that the pilot looks at.
const PILOT_BEAMS: usize = 2_000;
const PILOT_POINTS: usize = 10_000;

/// Beams of one class that a set keeps in a pass at most.
const MOST_BEAMS: f64 = 15_000.0;

/// Points of one class that a set keeps in a pass at most: a photon that wanders through milk leaves hundreds, which tell little more than some.
const MOST_POINTS: f64 = 50_000.0;

/// The wavelength in nm at which it is judged how much of a photon's light comes out.
const JUDGED_NM: f64 = 550.0;

/// The probabilities with which photons of one class are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    pub(super) points: f64,
    pub(super) beams: f64,
}

/// The probabilities with which photons in media are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shares {
    /// Those that came from lamps through glass: they are crowded where they are.
    caustic: Share,
    /// Those that were scattered before: they are spread over everything.
    indirect: Share,
}

/// How wide first kernels may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Widths {
    pixel_angle: f64,
    /// The radius in m, if the scene states it.
    stated_m: Option<f64>,
}

/// The photons of one set and class near a ray, within the widest radius; were all of them kept.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Near {
    /// Each counts by how much of its light comes out of the medium.
    points: f64,
    beams: f64,
    /// Mean free paths of the medium within one radian as the camera sees it: where the points are, in the mean.
    free_paths: f64,
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

impl Widths {
    /// Those of a job.
    pub(super) fn of(job: &Job) -> Self {
        Self { pixel_angle: job.scene.camera.pixel_angle(), stated_m: job.budget.radius_m }
    }

    /// As wide as this many pixels, unless the scene states another width.
    fn pixels(&self, pixels: f64) -> Width {
        self.stated_m.map_or(Width::PerDistance(pixels * self.pixel_angle), Width::Stated)
    }

    /// How many times wider those are in which the pilot looks for caustics than the narrowest.
    fn widest_of_caustics(&self) -> f64 {
        if self.stated_m.is_some() { 1.0 } else { LARGEST_CAUSTIC_PIXELS / LEAST_PIXELS }
    }
}

impl Crowds {
    /// Counts along the sightlines of a pixel's paths, in the free and the shared set's maps, each of which holds these shares of its photons.
    /// Of several sightlines the most crowded counts.
    pub(super) fn along(
        sightlines: &[Sightline],
        media: &[Medium],
        maps: [(&Maps, Shares); 2],
        widths: &Widths,
    ) -> Self {
        let mut crowds = Self::default();
        for sightline in sightlines {
            let ((maps, kept), known) =
                if sightline.shared { (maps[1], &mut crowds.shared) } else { (maps[0], &mut crowds.free) };
            let near = |maps, kept, pixels| Near::to((sightline, media), (maps, kept), widths.pixels(pixels));
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

    /// Sets a pixel's first radii in media, where passes keep these shares of all photons.
    pub(super) fn set_radii(&self, radii: &mut Radii, shares: Shares, widths: &Widths) {
        let kinds = [
            (self.free, [RadiusKind::FreeVolumeCaustic, RadiusKind::FreeVolumeIndirect]),
            (self.shared, [RadiusKind::SharedVolumeCaustic, RadiusKind::SharedVolumeIndirect]),
        ];
        let angle = widths.pixel_angle;
        for (crowd, [caustic, indirect]) in kinds {
            let Some(crowd) = crowd else { continue };
            let of_caustic = crowd.caustic.radius(shares.caustic, LARGEST_CAUSTIC_PIXELS * angle);
            let of_indirect = crowd.indirect.radius(shares.indirect, LARGEST_INDIRECT_PIXELS * angle);
            radii[caustic as usize] = of_caustic.max(LEAST_PIXELS * angle) as f32;
            radii[indirect as usize] = of_indirect.max(LEAST_PIXELS * angle) as f32;
        }
    }
}

impl Near {
    /// The photons near the sightline, within this width; the maps hold the share `kept` of them.
    fn to((sightline, media): (&Sightline, &[Medium]), (maps, kept): (&VolumeMaps, Share), width: Width) -> Self {
        let Sightline { ray, length_m, behind_m, medium: number, .. } = *sightline;
        let medium = &media[number];
        let cone = Cone::of_camera(ray, length_m, behind_m, width);
        let (mut points, mut beams, mut free_paths) = (0.0, 0.0, 0.0);
        maps.points.along(&cone, |found| {
            if found.medium == number {
                let comes_out = (-medium.optical_depth(JUDGED_NM, medium.column_m(&ray, found.t))).exp();
                let across_m = (behind_m + found.t) * medium.density_at(ray.at(found.t));
                points += comes_out;
                free_paths += comes_out * medium.optical_depth(JUDGED_NM, across_m);
            }
        });
        maps.beams.along(&cone, |found| {
            if found.medium == number {
                beams += 1.0;
            }
        });
        let free_paths = if points > 0.0 { free_paths / points } else { 0.0 };
        Self { points: points / kept.points, beams: beams / kept.beams, free_paths }
    }

    fn or_more(self, other: Self) -> Self {
        Self {
            points: self.points.max(other.points),
            beams: self.beams.max(other.beams),
            free_paths: self.free_paths.max(other.free_paths),
        }
    }

    /// The first radius per distance from the camera, where a pass keeps this share of all photons; at most `largest`.
    fn radius(&self, share: Share, largest: f64) -> f64 {
        let within = |found: f64, dimensions: f64| (NEAREST / found.max(NEAREST)).powf(1.0 / dimensions);
        let narrow = within(self.points * share.points, 2.0).min(within(self.beams * share.beams, 1.0));
        (largest * narrow).min(LARGEST_FREE_PATHS / self.free_paths)
    }
}

impl Crowd {
    fn or_more(self, other: Self) -> Self {
        Self { caustic: self.caustic.or_more(other.caustic), indirect: self.indirect.or_more(other.indirect) }
    }
}

/// Leaves at most `most` of many, evenly; returns the share that is left.
fn thin<T: Copy>(photons: &mut Vec<T>, most: usize) -> f64 {
    let step = photons.len().div_ceil(most).max(1);
    *photons = photons.iter().copied().step_by(step).collect();
    1.0 / step as f64
}

impl Share {
    /// Leaves few of many for the pilot to look at; returns the share that is left.
    fn thinning(kept: &mut InMedia) -> Self {
        Self { points: thin(&mut kept.points, PILOT_POINTS), beams: thin(&mut kept.beams, PILOT_BEAMS) }
    }

    /// What leaves enough of these photons, where the rays that see any beams see `seen` of them in the mean.
    fn enough(count: Count, seen: f64) -> Self {
        let most = |count: usize, most: f64| most / (count as f64).max(most);
        Self {
            points: most(count.points, MOST_POINTS),
            beams: (NEAREST / seen.max(NEAREST)).min(most(count.beams, MOST_BEAMS)),
        }
    }
}

impl Shares {
    /// All are kept.
    pub(super) const ALL: Self =
        Self { caustic: Share { points: 1.0, beams: 1.0 }, indirect: Share { points: 1.0, beams: 1.0 } };

    /// The share of the photons of this class. Light straight from lamps is looked for, and needs none.
    pub(super) fn of(&self, path: LightPath) -> Share {
        match path {
            LightPath::Direct => Share { points: 0.0, beams: 0.0 },
            LightPath::Caustic => self.caustic,
            LightPath::Indirect => self.indirect,
        }
    }

    /// Leaves few of many photons for the pilot to look at; returns the shares that are left.
    pub(super) fn thinning(emitted: &mut Emitted) -> Self {
        let [caustic, indirect] = [&mut emitted.volume_caustic, &mut emitted.volume_indirect].map(Share::thinning);
        Self { caustic, indirect }
    }

    /// Shares that leave enough photons. Of beams so many that the rays that see any pass about as many as an estimate wants, in the mean, within
    /// the least radius (of caustics) or the widest (of light that was scattered before, which is smooth), or within the radius that the scene
    /// states. More would cost time in every pass and lessen noise less than more passes do.
    pub(super) fn enough(crowds: &[Crowds], counts: Counts, widths: &Widths) -> Self {
        let seen = |of: fn(&Crowd) -> Near| {
            let all = crowds.iter().flat_map(|crowds| [crowds.free, crowds.shared]).flatten();
            let seen = all.map(|crowd| of(&crowd).beams).filter(|&beams| beams > 0.0);
            let (rays, sum) = seen.fold((0.0, 0.0), |(rays, sum), beams| (rays + 1.0, sum + beams));
            sum / f64::max(rays, 1.0)
        };
        let of_caustics = seen(|crowd| crowd.caustic) / widths.widest_of_caustics();
        Self {
            caustic: Share::enough(counts.caustic, of_caustics),
            indirect: Share::enough(counts.indirect, seen(|crowd| crowd.indirect)),
        }
    }
}

/// How many photons in media a set has, by class.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Counts {
    caustic: Count,
    indirect: Count,
}

/// How many photons in media a set has of one class.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Count {
    points: usize,
    beams: usize,
}

impl Count {
    fn of(kept: &InMedia) -> Self {
        Self { points: kept.points.len(), beams: kept.beams.len() }
    }

    fn or_more(self, other: Self) -> Self {
        Self { points: self.points.max(other.points), beams: self.beams.max(other.beams) }
    }
}

impl Counts {
    /// Those of emitted photons.
    pub(super) fn of(emitted: &Emitted) -> Self {
        Self { caustic: Count::of(&emitted.volume_caustic), indirect: Count::of(&emitted.volume_indirect) }
    }

    /// The more of two sets or moments.
    pub(super) fn or_more(self, other: Self) -> Self {
        Self { caustic: self.caustic.or_more(other.caustic), indirect: self.indirect.or_more(other.indirect) }
    }
}
