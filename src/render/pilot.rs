//! The pilot: a small render before pass 0, with random streams of its own, that fixes what passes must not learn from each other:
//! where lights aim, each pixel's first kernel radii, and how photons are shared between the two sets.

use super::crowd::{BeamShares, Crowds};
use super::harvest::Set;
use super::pass::{emit, shared_wavelengths};
use super::{Job, Seconds};
use crate::emit::{Aim, Arrival, CELLS, Collision, Crossing, Emitters, Receiver, Wavelengthed, trace};
use crate::gather::{
    CameraNumbers, Direct, Gatherer, Landing, Maps, Outline, Outlines, RADIUS_KINDS, Radii, RadiusKind, Scratch,
};
use crate::map::PhotonIndex;
use crate::map::radius::{self, Scales};
use crate::math::random::{Purpose, Stream};
use crate::plan::partition::{LightPath, View};
use crate::plan::{AimPlan, BetweenPlan, IndirectPlan, WavelengthPlan};
use crate::sensor::Film;
use crate::walk::ledger::Ledger;
use crate::walk::{Sink, Tally};
use rayon::prelude::*;
use std::num::NonZero;
use std::time::Instant;

/// What the pilot found.
#[derive(Debug)]
pub(super) struct Pilot {
    pub(super) aims: Vec<Aim>,
    /// First radii per pixel.
    pub(super) radii: Vec<Radii>,
    /// How far surfaces go on around what pixels see.
    pub(super) outlines: Outlines,
    pub(super) free_photons: u64,
    pub(super) shared_photons: u64,
    /// The probabilities with which beams through media are kept: of many, a few cross every ray, and more would only cost time.
    pub(super) beam_shares: BeamShares,
}

/// Kernels for indirect light span at most this many pixels at first: beyond, their bias would outlast their noise.
const LARGEST_INDIRECT_PIXELS: f64 = 24.0;

/// Kernels for caustics, whose edges are sharp, span at most this many pixels at first, also where photons are few: a wide kernel
/// beside a caustic would spread its light into the dark for many passes.
const LARGEST_CAUSTIC_PIXELS: f64 = 3.0;

/// Neither set gets less than this share of the photons where both are in use.
const LEAST_SHARE: f64 = 0.08;

impl Pilot {
    /// Flies the pilot.
    pub(super) fn fly(job: &Job, seconds: &mut Seconds) -> Self {
        let begun = Instant::now();
        let plain = vec![Aim::plain(); job.scene.lights.len()];
        let aims = match job.plan.aim {
            AimPlan::Plain => plain,
            AimPlan::Learned => learn_aims(job, plain),
        };
        let half = job.budget.photons / 2;
        let mut pilot = Self {
            aims,
            radii: Vec::new(),
            outlines: Outlines::default(),
            free_photons: half.max(1),
            shared_photons: half.max(1),
            beam_shares: BeamShares::ALL,
        };
        match job.plan.wavelengths {
            WavelengthPlan::Free => (pilot.free_photons, pilot.shared_photons) = (job.budget.photons, 0),
            WavelengthPlan::Shared => (pilot.free_photons, pilot.shared_photons) = (0, job.budget.photons),
            WavelengthPlan::Both => {}
        }
        pilot.measure(job);
        seconds.pilot += begun.elapsed().as_secs_f64();
        pilot
    }

    /// What emits a set of photons.
    pub(super) fn emitters<'a>(
        &'a self,
        job: &'a Job,
        wavelengths: Wavelengthed,
        count: u64,
        purpose: Purpose,
        pass: u64,
    ) -> Emitters<'a> {
        let (scene, choice) = (&job.scene, &job.choice.lights);
        let (max_depth, seed) = (job.budget.max_depth, job.budget.seed);
        let volumes = job.plan.between != BetweenPlan::Clear;
        Emitters { scene, choice, aims: &self.aims, wavelengths, count, max_depth, seed, purpose, pass, volumes }
    }

    /// Fixes the radii and the shares of the two sets.
    fn measure(&mut self, job: &Job) {
        let (nm, pdf) = shared_wavelengths(job, 0);
        let observer = job.scene.film.observer;
        let blank = Film::new(1, 1, observer, 0);
        let photons = |set, wavelengths, count, pass| {
            let emitters = self.emitters(job, wavelengths, count, Purpose::Pilot, pass);
            emit(job, &emitters, (set, BeamShares::ALL), || blank.splat_sink())
        };
        let mut free = photons(Set::Free, Wavelengthed::Free, self.free_photons, 0);
        let mut shared = photons(Set::Shared, Wavelengthed::Shared { nm, pdf }, self.shared_photons, 1);
        let kept = BeamShares::thinning(&mut free).least(BeamShares::thinning(&mut shared));
        let (free, shared) = (free.maps(), shared.maps());
        let (empty, none) = (Maps::default(), Outlines::default());
        let gatherer = Gatherer {
            scene: &job.scene,
            plan: &job.plan,
            direct: Direct::new(&job.scene, &job.choice.lights),
            free: &empty,
            shared: &empty,
            shared_nm: nm,
            shared_pdf: pdf,
            scales: Scales::of_pass(0),
            glass: job.scene.camera.system().map(|system| nm.map(|nm| system.at(nm))),
            outlines: &none,
            max_depth: job.budget.max_depth,
        };
        let (width, pixel_angle) = (job.scene.camera.width(), job.scene.camera.pixel_angle());
        let rows: Vec<RowFindings> = (0..job.scene.camera.pixel_count() / width)
            .into_par_iter()
            .map(|row| self.measure_row(job, &gatherer, (&free, &shared), row * width..(row + 1) * width))
            .collect();
        let mut landings = [0_u64; 2];
        let mut seen = Vec::with_capacity(width * rows.len());
        let mut crowds = Vec::with_capacity(width * rows.len());
        for row in rows {
            self.radii.extend(row.radii);
            seen.extend(row.seen);
            crowds.extend(row.crowds);
            (0..2).for_each(|set| landings[set] += row.landings[set]);
        }
        self.beam_shares = BeamShares::enough(&crowds, kept);
        let a_found = self.beam_shares.relative_to(kept);
        for (radii, crowds) in self.radii.iter_mut().zip(&crowds) {
            let kinds = [
                [RadiusKind::FreeVolumeCaustic, RadiusKind::FreeVolumeIndirect],
                [RadiusKind::SharedVolumeCaustic, RadiusKind::SharedVolumeIndirect],
            ];
            for (kinds, crowd) in kinds.into_iter().zip(crowds.of_sets()) {
                let slopes = crowd.map(|crowd| crowd.slopes(a_found, pixel_angle));
                for (i, kind) in kinds.into_iter().enumerate() {
                    radii[kind as usize] = slopes.map_or(UNKNOWN, |slopes| slopes[i] as f32);
                }
            }
        }
        fill_unknown(&mut self.radii);
        if job.plan.indirect != IndirectPlan::Absent {
            self.outlines = outlines(job, &seen, &self.radii, width);
        }
        self.share_photons(job, landings);
    }

    fn measure_row<'a>(
        &self,
        job: &'a Job,
        gatherer: &Gatherer<'a>,
        (free, shared): (&Maps, &Maps),
        pixels: std::ops::Range<usize>,
    ) -> RowFindings {
        let mut scratch = Scratch::default();
        let count = pixels.len();
        let pixel_angle = job.scene.camera.pixel_angle();
        let mut found = RowFindings {
            radii: Vec::with_capacity(count),
            seen: Vec::with_capacity(count),
            crowds: Vec::with_capacity(count),
            landings: [0; 2],
        };
        for pixel in pixels {
            // The replicates use hashes of (seed, replicate, pixel): a seed of its own keeps the pilot apart from them.
            let numbers = CameraNumbers::new(job.budget.seed ^ 0x0070_696c_6f74, 0, pixel as u64);
            gatherer.sample(
                pixel as u64,
                numbers,
                &[0.0; RADIUS_KINDS],
                (&mut scratch, &mut Tally::default()),
                &mut Nowhere,
            );
            let mut radii = [UNKNOWN; RADIUS_KINDS];
            for landing in &scratch.landings {
                let (maps, kinds) = if landing.shared {
                    (shared, [RadiusKind::SharedCaustic, RadiusKind::SharedIndirect])
                } else {
                    (free, [RadiusKind::FreeCaustic, RadiusKind::FreeIndirect])
                };
                let largest = [LARGEST_CAUSTIC_PIXELS, LARGEST_INDIRECT_PIXELS];
                for (i, map) in [&maps.caustic, &maps.indirect].into_iter().enumerate() {
                    radii[kinds[i] as usize] = first_radius(job, landing, map, largest[i]) as f32;
                }
            }
            found.crowds.push(Crowds::along(&scratch.legs, (free, shared), pixel_angle));
            let shared_legs = scratch.legs.iter().map(|leg| leg.shared);
            let used = || scratch.landings.iter().map(|landing| landing.shared).chain(shared_legs.clone());
            let (shared_here, free_here) = (used().any(|shared| shared), used().any(|shared| !shared));
            found.landings[0] += u64::from(free_here);
            found.landings[1] += u64::from(shared_here);
            found.radii.push(radii);
            found.seen.push(scratch.landings.first().copied().filter(|landing| landing.view == View::Seen));
        }
        found
    }

    /// Shares the photons between the sets by the pixels that need them.
    fn share_photons(&mut self, job: &Job, landings: [u64; 2]) {
        if job.plan.wavelengths != WavelengthPlan::Both {
            return;
        }
        let total = (landings[0] + landings[1]).max(1) as f64;
        let share = (landings[1] as f64 / total).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
        self.shared_photons = ((job.budget.photons as f64 * share) as u64).max(1);
        self.free_photons = (job.budget.photons - self.shared_photons.min(job.budget.photons)).max(1);
    }
}

/// What one row of pixels tells.
struct RowFindings {
    radii: Vec<Radii>,
    /// What pixels see directly.
    seen: Vec<Option<Landing>>,
    /// How many photons in media are near the rays.
    crowds: Vec<Crowds>,
    landings: [u64; 2],
}

/// Marks a radius that the pilot did not see.
const UNKNOWN: f32 = -1.0;

fn first_radius(job: &Job, landing: &Landing, map: &PhotonIndex, largest_pixels: f64) -> f64 {
    if let Some(fixed) = job.budget.radius_m {
        return fixed;
    }
    let footprint = landing.footprint_m;
    let nearest = NonZero::new(job.budget.nearest as usize).unwrap_or(NonZero::<usize>::MIN);
    let kth = map.kth_distance(landing.position.as_vec3().to_array(), nearest).map(f64::from);
    radius::first(kth, footprint, largest_pixels * footprint)
}

/// The outlines around what pixels see directly, where their kernels for indirect light reach over an edge.
fn outlines(job: &Job, seen: &[Option<Landing>], radii: &[Radii], width: usize) -> Outlines {
    let kind = match job.plan.wavelengths {
        WavelengthPlan::Free | WavelengthPlan::Both => RadiusKind::FreeIndirect,
        WavelengthPlan::Shared => RadiusKind::SharedIndirect,
    };
    let outline = |pixel: usize| {
        let radius = f64::from(radii[pixel][kind as usize]);
        let landing = seen[pixel].as_ref().filter(|here| may_reach_over_an_edge(seen, (pixel, here), radius, width))?;
        Outline::around(&job.scene.geometry, landing, radius)
    };
    let of_pixels: Vec<Option<Outline>> = (0..seen.len()).into_par_iter().map(outline).collect();
    Outlines::new(width, of_pixels.into_iter())
}

/// Whether a pixel a kernel away sees no surface, or one that does not continue this pixel's; or there is no such pixel.
fn may_reach_over_an_edge(
    seen: &[Option<Landing>],
    (pixel, here): (usize, &Landing),
    radius: f64,
    width: usize,
) -> bool {
    let height = seen.len() / width;
    let pixels = (radius / here.footprint_m).ceil().clamp(1.0, LARGEST_INDIRECT_PIXELS) as isize;
    let (x, y) = ((pixel % width) as isize, (pixel / width) as isize);
    let steps = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
    steps.into_iter().any(|(dx, dy)| {
        let (i, j) = (x + dx * pixels, y + dy * pixels);
        if i < 0 || j < 0 || i >= width as isize || j >= height as isize {
            return true;
        }
        seen[j as usize * width + i as usize]
            .as_ref()
            .is_none_or(|there| !here.goes_on_to(there.position, there.facing))
    })
}

/// Gives pixels whose pilot path saw nothing of a kind the median of those that did.
fn fill_unknown(radii: &mut [Radii]) {
    for kind in 0..RADIUS_KINDS {
        let mut known: Vec<f32> = radii.iter().map(|r| r[kind]).filter(|&r| r > 0.0).collect();
        known.sort_by(f32::total_cmp);
        let median = known.get(known.len() / 2).copied().unwrap_or(f32::MIN_POSITIVE);
        radii.iter_mut().filter(|r| r[kind] <= 0.0).for_each(|r| r[kind] = median);
    }
}

/// Learns where each light's photons are useful.
fn learn_aims(job: &Job, mut aims: Vec<Aim>) -> Vec<Aim> {
    /// Paths a round and light; several for each cell.
    const PATHS: u64 = 16 * (CELLS * CELLS) as u64;
    const CHUNK: u64 = 4096;
    for round in 0..2 {
        let lights = aims.len();
        let pilot = Pilot {
            aims,
            radii: Vec::new(),
            outlines: Outlines::default(),
            free_photons: 0,
            shared_photons: 0,
            beam_shares: BeamShares::ALL,
        };
        let count = PATHS * (lights as u64).min(4);
        let emitters = pilot.emitters(job, Wavelengthed::Free, count, Purpose::Pilot, 100 + round);
        let points = emitters.points();
        let parts: Vec<Usefulness<'_>> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut part = Usefulness::new(job, lights);
                let mut ledger = Ledger::new(job.scene.materials.len());
                for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                    trace(&emitters, &points, index, &mut part, &mut ledger);
                    part.close();
                }
                part
            })
            .collect();
        let mut whole = Usefulness::new(job, lights);
        parts.iter().for_each(|part| whole.add(part));
        aims = (0..lights).map(|light| whole.aim(light)).collect();
    }
    aims
}

/// How useful photons from each cell of each light's aiming grid are.
struct Usefulness<'a> {
    job: &'a Job,
    /// Paths, and sum of squared scores, per light and cell.
    paths: Vec<f64>,
    squares: Vec<f64>,
    current: usize,
    score: f64,
}

impl<'a> Usefulness<'a> {
    fn new(job: &'a Job, lights: usize) -> Self {
        let size = lights * CELLS * CELLS;
        Self { job, paths: vec![0.0; size], squares: vec![0.0; size], current: 0, score: 0.0 }
    }

    /// Ends a path.
    fn close(&mut self) {
        self.squares[self.current] += self.score * self.score;
        self.score = 0.0;
    }

    fn add(&mut self, other: &Self) {
        self.paths.iter_mut().zip(&other.paths).for_each(|(a, b)| *a += b);
        self.squares.iter_mut().zip(&other.squares).for_each(|(a, b)| *a += b);
    }

    /// The aim that follows: root-mean-square scores, spread to neighbouring cells so that no narrow feature is cut off.
    fn aim(&self, light: usize) -> Aim {
        let base = light * CELLS * CELLS;
        let score = |cell: usize| {
            let paths = self.paths[base + cell];
            if paths > 0.0 { (self.squares[base + cell] / paths).sqrt() } else { 0.0 }
        };
        let raw: Vec<f64> = (0..CELLS * CELLS).map(score).collect();
        let spread: Vec<f64> = (0..CELLS * CELLS).map(|cell| spread_from_neighbours(&raw, cell)).collect();
        let mean = spread.iter().sum::<f64>() / spread.len() as f64;
        let highest = spread.iter().copied().fold(0.0, f64::max);
        // Where all cells are about equally useful there is nothing to aim at.
        if mean > 0.0 && highest > 1.5 * mean { Aim::learned(&spread) } else { Aim::plain() }
    }
}

/// The mean of a cell's score and the highest around it.
fn spread_from_neighbours(raw: &[f64], cell: usize) -> f64 {
    let (x, y) = (cell % CELLS, cell / CELLS);
    let mut highest = 0.0_f64;
    for j in y.saturating_sub(1)..(y + 2).min(CELLS) {
        for i in x.saturating_sub(1)..(x + 2).min(CELLS) {
            highest = highest.max(raw[j * CELLS + i]);
        }
    }
    0.5 * (raw[cell] + highest)
}

impl Receiver for Usefulness<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_>, _stream: &mut Stream) {
        let in_view = self.job.scene.camera.sight(arrival.encounter.hit.position, [0.5; 2]).is_some();
        self.score += match (arrival.path, in_view) {
            (LightPath::Direct, _) => 0.0,
            (LightPath::Caustic, true) => 1.0,
            (LightPath::Indirect, true) => 0.3,
            // Not in view, but perhaps in a mirror.
            (LightPath::Caustic | LightPath::Indirect, false) => 0.02,
        };
    }

    fn cross(&mut self, crossing: &Crossing<'_>, _stream: &mut Stream) {
        let Crossing { stretch, medium, path, .. } = crossing;
        if *path == LightPath::Direct || !self.job.scene.media[*medium].scatters() || !stretch.length_m.is_finite() {
            return;
        }
        // A beam counts by how much of it is in view.
        let places = [0.1, 0.3, 0.5, 0.7, 0.9].map(|share| stretch.ray.at(share * stretch.length_m));
        let in_view = places.iter().filter(|&&place| self.job.scene.camera.sight(place, [0.5; 2]).is_some()).count();
        let weight = if *path == LightPath::Caustic { 1.0 } else { 0.3 };
        self.score += weight * 0.2 * in_view as f64;
    }

    fn collide(&mut self, _collision: &Collision, _stream: &mut Stream) {}

    fn depart(&mut self, light: usize, cell: usize) {
        self.current = light * CELLS * CELLS + cell;
        self.paths[self.current] += 1.0;
    }
}

/// Takes light and keeps nothing.
struct Nowhere;

impl Sink for Nowhere {
    fn radiance(&mut self, _nm: f64, _weight: f64) {}

    fn density(&mut self, _nm: f64, _weight: f64, _bias: f64) {}
}
