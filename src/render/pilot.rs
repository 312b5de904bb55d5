//! The pilot: a small render before pass 0, with random streams of its own, that fixes what passes must not learn from each other:
//! where lights aim, each pixel's first kernel radii, and how photons are shared between the two sets.
//!
//! Where things move it looks at the scene at several moments: lights aim at what is useful at any of them, and a pixel's radii are the smallest
//! of all (where light is dense at one moment and thin at another, the dense one decides how sharp the picture is, and the thin one's noise
//! weighs little). Outlines are kept only where nothing moves.

use super::crowd::{Counts, Crowds, Shares, Widths};
use super::harvest::Set;
use super::pass::{emit, shared_wavelengths};
use super::{Job, Seconds};
use crate::emit::{Aim, Arrival, CELLS, Crossing, Emitters, Receiver, Wavelengthed, trace};
use crate::error::Result;
use crate::gather::{
    CameraNumbers, Direct, Gatherer, Landing, Maps, Outline, Outlines, RADIUS_KINDS, Radii, RadiusKind, Scratch,
};
use crate::map::radius::{self, Scales};
use crate::map::{LightMaps, PhotonIndex};
use crate::math::random::{Purpose, Stream};
use crate::plan::partition::{LightPath, View};
use crate::plan::{AimPlan, IndirectPlan, MotionPlan, WavelengthPlan};
use crate::scene::Scene;
use crate::scene::sweep::Bounds;
use crate::sensor::Film;
use crate::walk::ledger::Ledger;
use crate::walk::{Sink, Tally};
use glam::DVec3;
use rayon::prelude::*;
use std::borrow::Cow;
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
    /// The probabilities with which photons in media are kept: of many, a few are near every ray, and more would only cost time.
    pub(super) kept: Shares,
}

/// Kernels for indirect light span at most this many pixels at first: beyond, their bias would outlast their noise.
const LARGEST_INDIRECT_PIXELS: f64 = 24.0;

/// Kernels for caustics, whose edges are sharp, span at most this many pixels at first, also where photons are few: a wide kernel
/// beside a caustic would spread its light into the dark for many passes.
const LARGEST_CAUSTIC_PIXELS: f64 = 3.0;

/// Neither set gets less than this share of the photons where both are in use.
const LEAST_SHARE: f64 = 0.08;

/// At how many moments the pilot looks at a scene that moves.
const MOMENTS: usize = 4;

/// The scene at the pilot's moments: in the middle of equal shares of the light that the shutter lets through.
fn scenes(job: &Job) -> Result<Vec<Cow<'_, Scene>>> {
    match job.plan.motion {
        MotionPlan::PosedPerPass if job.scene.moves() => {
            let share = |i: usize| (i as f64 + 0.5) / MOMENTS as f64;
            (0..MOMENTS).map(|i| job.scene.at(job.scene.shutter.time_s(share(i)))).collect()
        }
        MotionPlan::PosedPerPass | MotionPlan::Still => Ok(vec![Cow::Borrowed(&job.scene)]),
    }
}

impl Pilot {
    /// Flies the pilot.
    pub(super) fn fly(job: &Job, seconds: &mut Seconds) -> Result<Self> {
        let begun = Instant::now();
        let scenes = scenes(job)?;
        let plain = vec![Aim::plain(); job.scene.lights.len()];
        let aims = match job.plan.aim {
            AimPlan::Plain => plain,
            AimPlan::Learned => learn_aims(job, &scenes, plain),
        };
        let half = job.budget.photons / 2;
        let mut pilot = Self {
            aims,
            radii: Vec::new(),
            outlines: Outlines::default(),
            free_photons: half.max(1),
            shared_photons: half.max(1),
            kept: Shares::ALL,
        };
        match job.plan.wavelengths {
            WavelengthPlan::Free => (pilot.free_photons, pilot.shared_photons) = (job.budget.photons, 0),
            WavelengthPlan::Shared => (pilot.free_photons, pilot.shared_photons) = (0, job.budget.photons),
            WavelengthPlan::Both => {}
        }
        pilot.measure(job, &scenes);
        seconds.pilot += begun.elapsed().as_secs_f64();
        Ok(pilot)
    }

    /// What emits a set of photons.
    pub(super) fn emitters<'a>(
        &'a self,
        (job, scene): (&'a Job, &'a Scene),
        wavelengths: Wavelengthed,
        count: u64,
        purpose: Purpose,
        pass: u64,
    ) -> Emitters<'a> {
        let choice = &job.choice.lights;
        let (max_depth, seed) = (job.budget.max_depth, job.budget.seed);
        let between = job.plan.between;
        Emitters { scene, choice, aims: &self.aims, wavelengths, count, max_depth, seed, purpose, pass, between }
    }

    /// Fixes the radii and the shares of the two sets.
    fn measure(&mut self, job: &Job, scenes: &[Cow<'_, Scene>]) {
        let mut findings = Findings::default();
        for (moment, scene) in (0..).zip(scenes) {
            findings.add(self.look(job, (moment, scene)));
        }
        let Findings { mut radii, seen, crowds, in_media, landings } = findings;
        let widths = Widths::of(job);
        self.kept = Shares::enough(&crowds, in_media, &widths);
        for (radii, crowds) in radii.iter_mut().zip(&crowds) {
            crowds.set_radii(radii, self.kept, &widths);
        }
        fill_unknown(&mut radii);
        self.radii = radii;
        // Where the camera moves, a pixel sees no place for long.
        if job.plan.indirect != IndirectPlan::Absent && job.scene.motions.camera.is_none() {
            let (swept, scene) = (job.scene.swept_boxes(), &scenes[0]);
            self.outlines = outlines((job, scene), (&seen, &swept), &self.radii);
        }
        self.share_photons(job, landings);
    }

    /// What all pixels find at one of the pilot's moments.
    fn look(&self, job: &Job, (moment, scene): (u64, &Scene)) -> Findings {
        let (nm, pdf) = shared_wavelengths(job, moment);
        let blank = Film::new(1, 1, scene.film.observer, 0);
        let photons = |set, wavelengths, count, pass| {
            let emitters = self.emitters((job, scene), wavelengths, count, Purpose::Pilot, pass);
            emit(job, &emitters, (set, Shares::ALL), || blank.splat_sink())
        };
        let mut free = photons(Set::Free, Wavelengthed::Free, self.free_photons, 2 * moment);
        let mut shared = photons(Set::Shared, Wavelengthed::Shared { nm, pdf }, self.shared_photons, 2 * moment + 1);
        let in_media = Counts::of(&free).or_more(Counts::of(&shared));
        let kept = [Shares::thinning(&mut free), Shares::thinning(&mut shared)];
        let (free, shared) = (free.maps(), shared.maps());
        let (empty, none) = (Maps::default(), Outlines::default());
        let gatherer = Gatherer {
            scene,
            plan: &job.plan,
            direct: Direct::new(scene, &job.choice.lights, job.plan.between),
            free: &empty,
            shared: &empty,
            light_maps: &LightMaps::default(),
            shared_nm: nm,
            shared_pdf: pdf,
            scales: Scales::of_pass(0),
            radius_m: job.budget.radius_m,
            glass: scene.camera.system().map(|system| nm.map(|nm| system.at(nm))),
            outlines: &none,
            max_depth: job.budget.max_depth,
        };
        let width = scene.camera.width();
        let rows: Vec<Findings> = (0..scene.camera.pixel_count() / width)
            .into_par_iter()
            .map(|row| {
                let pixels = row * width..(row + 1) * width;
                self.look_along_row((job, moment), &gatherer, [(&free, kept[0]), (&shared, kept[1])], pixels)
            })
            .collect();
        let mut all = Findings { in_media, ..Findings::default() };
        rows.into_iter().for_each(|row| all.append(row));
        all
    }

    fn look_along_row<'a>(
        &self,
        (job, moment): (&'a Job, u64),
        gatherer: &Gatherer<'a>,
        [free, shared]: [(&Maps, Shares); 2],
        pixels: std::ops::Range<usize>,
    ) -> Findings {
        let mut scratch = Scratch::noting();
        let widths = Widths::of(job);
        let mut found = Findings::default();
        for pixel in pixels {
            // The replicates use hashes of (seed, replicate, pixel): a seed of its own keeps the pilot apart from them.
            let numbers = CameraNumbers::new(job.budget.seed ^ 0x0070_696c_6f74, moment, pixel as u64);
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
                    (shared.0, [RadiusKind::SharedCaustic, RadiusKind::SharedIndirect])
                } else {
                    (free.0, [RadiusKind::FreeCaustic, RadiusKind::FreeIndirect])
                };
                let largest = [LARGEST_CAUSTIC_PIXELS, LARGEST_INDIRECT_PIXELS];
                for (i, map) in [&maps.caustic, &maps.indirect].into_iter().enumerate() {
                    radii[kinds[i] as usize] = first_radius(job, landing, map, largest[i]) as f32;
                }
            }
            found.crowds.push(Crowds::along(&scratch.sightlines, &gatherer.scene.media, [free, shared], &widths));
            let shared_sightlines = scratch.sightlines.iter().map(|sightline| sightline.shared);
            let used = || scratch.landings.iter().map(|landing| landing.shared).chain(shared_sightlines.clone());
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

/// What pixels tell.
#[derive(Default)]
struct Findings {
    radii: Vec<Radii>,
    /// What pixels see directly.
    seen: Vec<Option<Landing>>,
    /// How many photons in media are near the rays.
    crowds: Vec<Crowds>,
    /// How many photons in media there are.
    in_media: Counts,
    landings: [u64; 2],
}

impl Findings {
    /// Takes in what other pixels tell.
    fn append(&mut self, more: Self) {
        self.radii.extend(more.radii);
        self.seen.extend(more.seen);
        self.crowds.extend(more.crowds);
        self.in_media = self.in_media.or_more(more.in_media);
        (0..2).for_each(|set| self.landings[set] += more.landings[set]);
    }

    /// Takes in what the same pixels tell at another moment.
    fn add(&mut self, more: Self) {
        if self.radii.is_empty() {
            self.append(more);
            return;
        }
        for (radii, others) in self.radii.iter_mut().flatten().zip(more.radii.iter().flatten()) {
            *radii = if *radii > 0.0 && *others > 0.0 { radii.min(*others) } else { radii.max(*others) };
        }
        self.crowds.iter_mut().zip(more.crowds).for_each(|(here, more)| *here = here.or_more(more));
        self.in_media = self.in_media.or_more(more.in_media);
        (0..2).for_each(|set| self.landings[set] += more.landings[set]);
    }
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

/// The outlines around what pixels see directly, where their kernels for indirect light reach over an edge that nothing moves.
fn outlines((job, scene): (&Job, &Scene), (seen, swept): (&[Option<Landing>], &[Bounds]), radii: &[Radii]) -> Outlines {
    let kind = match job.plan.wavelengths {
        WavelengthPlan::Free | WavelengthPlan::Both => RadiusKind::FreeIndirect,
        WavelengthPlan::Shared => RadiusKind::SharedIndirect,
    };
    let width = scene.camera.width();
    let outline = |pixel: usize| {
        let radius = f64::from(radii[pixel][kind as usize]);
        let landing = seen[pixel].as_ref().filter(|here| may_reach_over_an_edge(seen, (pixel, here), radius, width))?;
        let moves = |bounds: &Bounds| distance(landing.position, bounds) <= 2.0 * radius;
        if swept.iter().any(moves) { None } else { Outline::around(&scene.geometry, landing, radius) }
    };
    let of_pixels: Vec<Option<Outline>> = (0..seen.len()).into_par_iter().map(outline).collect();
    Outlines::new(width, of_pixels.into_iter())
}

/// The distance of a place from a box; 0 inside.
fn distance(place: DVec3, (low, high): &Bounds) -> f64 {
    place.distance(place.clamp(*low, *high))
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
fn learn_aims(job: &Job, scenes: &[Cow<'_, Scene>], mut aims: Vec<Aim>) -> Vec<Aim> {
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
            kept: Shares::ALL,
        };
        let count = PATHS * (lights as u64).min(4);
        let chunks = count.div_ceil(CHUNK);
        let parts: Vec<Usefulness<'_>> = (0..chunks)
            .into_par_iter()
            .map(|chunk| {
                // The moments take equal turns.
                let scene = &scenes[(chunk * scenes.len() as u64 / chunks) as usize];
                let emitters = pilot.emitters((job, scene), Wavelengthed::Free, count, Purpose::Pilot, 100 + round);
                let points = emitters.points();
                let mut part = Usefulness::new(scene, lights);
                let mut ledger = Ledger::new(job.scene.materials.len());
                for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                    trace(&emitters, &points, index..index + 1, &mut part, &mut ledger);
                    part.close();
                }
                part
            })
            .collect();
        let mut whole = Usefulness::new(&job.scene, lights);
        parts.iter().for_each(|part| whole.add(part));
        aims = (0..lights).map(|light| whole.aim(light)).collect();
    }
    aims
}

/// How useful photons from each cell of each light's aiming grid are.
struct Usefulness<'a> {
    scene: &'a Scene,
    /// Paths, and sum of squared scores, per light and cell.
    paths: Vec<f64>,
    squares: Vec<f64>,
    current: usize,
    score: f64,
    /// Of the path's ways through media, the most useful one's: a photon that wanders through milk tells little more than its first ways do.
    score_in_media: f64,
}

impl<'a> Usefulness<'a> {
    fn new(scene: &'a Scene, lights: usize) -> Self {
        let size = lights * CELLS * CELLS;
        Self { scene, paths: vec![0.0; size], squares: vec![0.0; size], current: 0, score: 0.0, score_in_media: 0.0 }
    }

    /// Ends a path.
    fn close(&mut self) {
        self.squares[self.current] += (self.score + self.score_in_media).powi(2);
        (self.score, self.score_in_media) = (0.0, 0.0);
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
        let in_view = self.scene.camera.sight(arrival.encounter.hit.position, [0.5; 2]).is_some();
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
        if *path == LightPath::Direct || !self.scene.media[*medium].scatters() || !stretch.length_m.is_finite() {
            return;
        }
        // A beam counts by how much of it is in view.
        let places = [0.1, 0.3, 0.5, 0.7, 0.9].map(|share| stretch.ray.at(share * stretch.length_m));
        let in_view = places.iter().filter(|&&place| self.scene.camera.sight(place, [0.5; 2]).is_some()).count();
        let weight = if *path == LightPath::Caustic { 1.0 } else { 0.3 };
        self.score_in_media = self.score_in_media.max(weight * 0.2 * in_view as f64);
    }

    fn depart(&mut self, light: usize, aim: [f64; 2]) {
        self.current = light * CELLS * CELLS + Aim::cell(aim);
        self.paths[self.current] += 1.0;
    }
}

/// Takes light and keeps nothing.
struct Nowhere;

impl Sink for Nowhere {
    fn radiance(&mut self, _nm: f64, _weight: f64) {}

    fn biased(&mut self, _nm: f64, _weight: f64, _bias: f64) {}
}
