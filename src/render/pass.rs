//! One pass: emit, map, gather.

use super::crowd::Shares;
use super::harvest::{Harvest, InMedia, Placed, Set};
use super::pilot::Pilot;
use super::{Job, Run};
use crate::emit::{Emitters, Wavelengthed, trace};
use crate::error::Result;
use crate::gather::{CameraNumbers, Direct, Gatherer, Maps, PathTracer, Scratch};
use crate::map::radius::Scales;
use crate::map::{LightMaps, PhotonIndex};
use crate::math::kronecker::{golden, theodorus};
use crate::math::random::{Purpose, REPLICATES, hash64};
use crate::plan::MotionPlan;
use crate::scene::Scene;
use crate::sensor::film::FilmRow;
use crate::sensor::{PixelSink, SplatSink};
use crate::spectrum::{LANES, Lanes};
use crate::walk::ledger::Ledger;
use crate::walk::{Sink, Tally};
use rayon::prelude::*;
use std::borrow::Cow;
use std::time::Instant;

/// Photon paths that one work item follows.
const CHUNK: u64 = 2048;

/// The sensor takes what transport hands over.
impl Sink for PixelSink<'_> {
    fn radiance(&mut self, nm: f64, weight: f64) {
        PixelSink::radiance(self, nm, weight);
    }

    fn biased(&mut self, nm: f64, weight: f64, bias: f64) {
        PixelSink::biased(self, nm, weight, bias);
    }
}

/// The photons of one set in one pass.
#[derive(Debug, Default)]
pub(super) struct Emitted {
    pub(super) caustic: Vec<Placed>,
    pub(super) indirect: Vec<Placed>,
    pub(super) volume_caustic: InMedia,
    pub(super) volume_indirect: InMedia,
    pub(super) splats: Vec<SplatSink>,
    pub(super) ledger: Ledger,
    pub(super) tally: Tally,
}

impl Emitted {
    /// The set's maps.
    pub(super) fn maps(&mut self) -> Maps {
        Maps {
            caustic: PhotonIndex::build(&self.caustic),
            indirect: PhotonIndex::build(&self.indirect),
            volume_caustic: self.volume_caustic.maps(),
            volume_indirect: self.volume_indirect.maps(),
        }
    }
}

/// The wavelengths that a pass shares, with their densities: one from each of four equal shares of the lights' visible power, shifted from
/// pass to pass by the golden ratio, the replicates apart.
pub(super) fn shared_wavelengths(job: &Job, pass: u64) -> (Lanes, Lanes) {
    let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
    let shift = golden(index as u32, hash64([job.budget.seed, Purpose::Pass as u64, replicate]));
    let drawn: [(f64, f64); LANES] =
        std::array::from_fn(|k| job.choice.wavelengths.sample((shift + k as f64) / LANES as f64));
    (drawn.map(|(nm, _)| nm), drawn.map(|(_, pdf)| pdf))
}

/// The scene at the moment that a pass shares: moments are spread evenly over the light that the shutter lets through, the replicates apart,
/// and have nothing to do with the pass's wavelengths.
fn scene_of_pass<'a>(job: &'a Job, pass: u64, run: &mut Run) -> Result<Cow<'a, Scene>> {
    if job.plan.motion == MotionPlan::Still {
        return Ok(Cow::Borrowed(&job.scene));
    }
    let begun = Instant::now();
    let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
    let u = theodorus(index as u32, hash64([job.budget.seed, Purpose::Moment as u64, replicate]));
    let scene = job.scene.at(job.scene.shutter.time_s(u));
    run.tally.moments += 1;
    run.seconds.pose += begun.elapsed().as_secs_f64();
    scene
}

/// Emits a set of photons on all threads of the pool; the result does not depend on their number.
pub(super) fn emit(
    job: &Job,
    emitters: &Emitters<'_>,
    (set, shares): (Set, Shares),
    splats: impl Fn() -> SplatSink + Sync,
) -> Emitted {
    let points = emitters.points();
    let chunks: Vec<(Harvest<'_>, Ledger)> = (0..emitters.count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut harvest = Harvest::new(emitters.scene, &job.plan, (set, shares), splats());
            let mut ledger = Ledger::new(emitters.scene.materials.len());
            let indices = chunk * CHUNK..((chunk + 1) * CHUNK).min(emitters.count);
            trace(emitters, &points, indices, &mut harvest, &mut ledger);
            (harvest, ledger)
        })
        .collect();
    let mut emitted = Emitted {
        caustic: Vec::with_capacity(chunks.iter().map(|(harvest, _)| harvest.caustic.len()).sum()),
        indirect: Vec::with_capacity(chunks.iter().map(|(harvest, _)| harvest.indirect.len()).sum()),
        ..Emitted::default()
    };
    for (harvest, ledger) in chunks {
        emitted.caustic.extend_from_slice(&harvest.caustic);
        emitted.indirect.extend_from_slice(&harvest.indirect);
        emitted.volume_caustic.add(&harvest.volume_caustic);
        emitted.volume_indirect.add(&harvest.volume_indirect);
        emitted.splats.push(harvest.splats);
        emitted.tally.add(&harvest.tally);
        emitted.ledger.add(&ledger);
    }
    emitted
}

/// The maps of lamps in media for a pass, if the plan has any.
fn renewed<'m, 'a>(maps: &'m mut LightMaps<'a>, job: &Job, scene: &'a Scene, pass: u64) -> &'m LightMaps<'a> {
    if job.plan.between.maps_lamps() {
        maps.renew(scene, job.budget.light_map_cells(pass), (job.budget.seed, pass));
    }
    maps
}

/// One pass of photon mapping. Maps of lamps in a scene that stands still serve the passes after it.
pub(super) fn photon_pass<'a>(
    job: &'a Job,
    pilot: &Pilot,
    light_maps: &mut LightMaps<'a>,
    (pass, run): (u64, &mut Run),
) -> Result<()> {
    let scene = scene_of_pass(job, pass, run)?;
    let begun = Instant::now();
    let (nm, pdf) = shared_wavelengths(job, pass);
    let film = &run.film;
    let sets = [
        (Set::Free, Purpose::FreePhoton, Wavelengthed::Free, pilot.free_photons),
        (Set::Shared, Purpose::SharedPhoton, Wavelengthed::Shared { nm, pdf }, pilot.shared_photons),
    ];
    let [mut free, mut shared] = sets.map(|(set, purpose, wavelengths, count)| {
        let emitters = pilot.emitters((job, &scene), wavelengths, count, purpose, pass);
        emit(job, &emitters, (set, pilot.kept), || film.splat_sink())
    });
    run.seconds.emit += begun.elapsed().as_secs_f64();

    let begun = Instant::now();
    let (free_maps, shared_maps) = (free.maps(), shared.maps());
    let mut of_this_pass = LightMaps::default();
    let light_maps = match &scene {
        Cow::Borrowed(still) => renewed(light_maps, job, still, pass),
        Cow::Owned(posed) => renewed(&mut of_this_pass, job, posed, pass),
    };
    run.seconds.map += begun.elapsed().as_secs_f64();

    let begun = Instant::now();
    let gatherer = Gatherer {
        scene: &scene,
        plan: &job.plan,
        direct: Direct::new(&scene, &job.choice.lights, job.plan.between),
        free: &free_maps,
        shared: &shared_maps,
        light_maps,
        shared_nm: nm,
        shared_pdf: pdf,
        scales: Scales::of_pass(pass),
        radius_m: job.budget.radius_m,
        glass: scene.camera.system().map(|system| nm.map(|nm| system.at(nm))),
        outlines: &pilot.outlines,
        max_depth: job.budget.max_depth,
    };
    let seed = job.budget.seed;
    expose_rows(run, |row, tally| {
        let mut scratch = Scratch::default();
        row.expose(pass, |pixel, sink| {
            let numbers = CameraNumbers::new(seed, pass, pixel as u64);
            gatherer.sample(pixel as u64, numbers, &pilot.radii[pixel], (&mut scratch, tally), sink);
        })
    });
    for emitted in [&free, &shared] {
        for splats in &emitted.splats {
            run.tally.rejected += run.film.add_splats(pass, splats);
        }
        run.tally.add(&emitted.tally);
    }
    run.film.count_pass(pass);
    run.seconds.gather += begun.elapsed().as_secs_f64();

    // Each set estimates the whole emission: the pass's ledger is their mean by number of photons.
    let total = (pilot.free_photons + pilot.shared_photons) as f64;
    for (emitted, count) in [(free, pilot.free_photons), (shared, pilot.shared_photons)] {
        let mut ledger = emitted.ledger;
        ledger.scale(count as f64 / total);
        run.ledger.add(&ledger);
    }
    Ok(())
}

/// One pass of path tracing.
pub(super) fn path_pass(job: &Job, pass: u64, run: &mut Run) -> Result<()> {
    let scene = scene_of_pass(job, pass, run)?;
    let begun = Instant::now();
    let tracer = PathTracer {
        scene: &scene,
        direct: Direct::tracked(&scene, &job.choice.lights, job.plan.between),
        between: job.plan.between,
        wavelengths: &job.choice.wavelengths,
        max_depth: job.budget.max_depth,
    };
    let seed = job.budget.seed;
    expose_rows(run, |row, tally| {
        row.expose(pass, |pixel, sink| {
            tracer.sample(pixel as u64, CameraNumbers::new(seed, pass, pixel as u64), tally, sink);
        })
    });
    run.film.count_pass(pass);
    run.seconds.gather += begun.elapsed().as_secs_f64();
    Ok(())
}

/// Exposes all rows of the film in parallel.
fn expose_rows(run: &mut Run, expose: impl Fn(&mut FilmRow<'_>, &mut Tally) -> u64 + Sync) {
    let rows: Vec<FilmRow<'_>> = run.film.rows().collect();
    let tallies: Vec<Tally> = rows
        .into_par_iter()
        .map(|mut row| {
            let mut tally = Tally::default();
            let rejected = expose(&mut row, &mut tally);
            tally.rejected += rejected;
            tally
        })
        .collect();
    tallies.iter().for_each(|tally| run.tally.add(tally));
}
