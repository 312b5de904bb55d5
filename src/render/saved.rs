//! Runs in files: checkpoints and parts, an EXR of the picture so far with the exact sums and a record of the rest.

use super::forecast::Forecast;
use super::{Diffracting, Integrator, Job, Part, Run, Stats};
use crate::error::{Error, Result};
use crate::output::exr::{add_sums, holds_sums_of, read_metadata, write_with_sums};
use crate::output::hash::Hash;
use crate::output::metadata::{Metadata, names};
use crate::scene::Exposure;
use crate::sensor::{Development, Film, Picture, develop, exposure};
use crate::spectrum::Observer;
use crate::walk::Tally;
use crate::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The name of the record in a file's header.
const RECORD: &str = "abbe.run";

/// All that a pass depends on besides its index: runs that agree in it can share their passes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    integrator: String,
    seed: u64,
    photons: u64,
    /// Pixels per row, and rows.
    size: (u32, u32),
    spectral_bands: u32,
    /// Effects with their states.
    effects: Vec<String>,
    scene_hash: String,
}

impl Identity {
    /// What the passes of a job depend on. `scene_hash` covers the effective scene and the files that it refers to.
    pub fn of(job: &Job, integrator: Integrator, scene_hash: &str) -> Self {
        let film = &job.scene.film;
        Self {
            integrator: integrator.word().to_string(),
            seed: job.budget.seed,
            photons: job.budget.photons,
            size: (film.width, film.height),
            spectral_bands: film.spectral_bands,
            effects: job.rows.iter().map(|row| format!("{} {}", row.effect.name, row.state.word())).collect(),
            scene_hash: scene_hash.to_string(),
        }
    }

    /// The first thing in which this differs from what was expected: what it is here, and there.
    fn difference(&self, expected: &Self) -> Option<(String, String)> {
        let Self { integrator, seed, photons, size, spectral_bands, effects, scene_hash } = self;
        let effects = effects.iter().find(|effect| !expected.effects.contains(effect));
        let other_effect = expected.effects.iter().find(|effect| !self.effects.contains(effect));
        let pixels = |(width, height): (u32, u32)| format!("{width} × {height} pixels");
        let effect = |effect: Option<&String>| format!("the effect {}", effect.map_or("none", String::as_str));
        let pairs = [
            (integrator != &expected.integrator)
                .then(|| (format!("integrator {integrator}"), format!("integrator {}", expected.integrator))),
            (seed != &expected.seed).then(|| (format!("seed {seed}"), format!("seed {}", expected.seed))),
            (photons != &expected.photons)
                .then(|| (format!("{photons} photons a pass"), format!("{} photons a pass", expected.photons))),
            (size != &expected.size).then(|| (pixels(*size), pixels(expected.size))),
            (spectral_bands != &expected.spectral_bands).then(|| {
                (format!("{spectral_bands} spectral bands"), format!("{} spectral bands", expected.spectral_bands))
            }),
            (effects.is_some() || other_effect.is_some()).then(|| (effect(effects), effect(other_effect))),
            (scene_hash != &expected.scene_hash).then(|| {
                let same = "the same scene, and the files that it names as they were".to_string();
                ("another scene".to_string(), same)
            }),
        ];
        pairs.into_iter().flatten().next()
    }

    /// Refuses a file of another render.
    ///
    /// # Errors
    /// The input's: it names the difference.
    pub(super) fn check(&self, expected: &Self) -> Result<()> {
        match self.difference(expected) {
            None => Ok(()),
            Some((here, there)) => Err(Error::input(format!("was rendered with {here}")).expected(there)),
        }
    }
}

/// How a picture's colours become those of its PNG.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Showing {
    development: Development,
    exposure: Exposure,
}

impl Showing {
    /// As the job's film asks for.
    pub fn of(job: &Job) -> Self {
        let film = &job.scene.film;
        let development = Development { space: film.space, white: film.white, gamut: film.gamut };
        Self { development, exposure: film.exposure }
    }

    /// What a display shows of a picture.
    pub fn screen(&self, picture: &Picture) -> crate::sensor::Screen {
        let factor = match self.exposure {
            Exposure::Auto => exposure::automatic(picture, &self.development),
            Exposure::Ev(ev) => ev.exp2(),
            Exposure::White(luminance) => luminance.recip(),
            Exposure::None => 1.0,
        };
        develop(picture, factor, &self.development)
    }
}

/// A saved run: all of it but the film's sums, which may be large.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saved {
    pub(super) identity: Identity,
    pub(super) part: Part,
    pub(super) done: u64,
    pub(super) wanted: Option<u64>,
    ledger: Ledger,
    tally: Tally,
    pub(super) stats: Stats,
    pub(super) showing: Showing,
    diffraction: Option<Diffracting>,
    /// Of the record (with an empty hash) and the sums: tells a damaged file.
    hash: String,
}

impl Saved {
    /// Writes a run with its picture so far, whole or not at all; `metadata` tells of the scene.
    ///
    /// # Errors
    /// The machine's: a folder that cannot be written to, a full disk.
    pub fn write(path: &Path, job: &Job, identity: &Identity, run: &Run, metadata: Metadata) -> Result<()> {
        let (picture, squares) = run.film.develop_and_judge();
        let so_far = (run.done, run.seconds.total, run.seconds.pilot);
        let forecast = squares.and_then(|squares| Forecast::without_history(squares, so_far));
        let mut record = Self {
            identity: identity.clone(),
            part: run.part,
            done: run.done,
            wanted: run.wanted,
            ledger: run.ledger.clone(),
            tally: run.tally,
            stats: Stats::new(job, run, &picture, forecast),
            showing: Showing::of(job),
            diffraction: job.diffraction.clone(),
            hash: String::new(),
        };
        record.hash = record.hash_with(&run.film);
        write_with_sums(path, &run.film, &picture, &metadata.with_json(RECORD, &record))
    }

    /// Reads a saved run's record; the header's texts come with it.
    ///
    /// # Errors
    /// The input's: a file that is missing, no EXR, of another version, damaged, or without exact sums.
    pub fn read(path: &Path) -> Result<(Self, Metadata)> {
        let metadata = read_metadata(path)?;
        let fault = |what: &str| Error::input(what).in_file(path);
        let text = metadata.get(RECORD).ok_or_else(|| {
            fault("holds no exact sums").expected("a part (`abbe render --part`) or a checkpoint of abbe")
        })?;
        let (version, own) = (metadata.get(names::VERSION).unwrap_or("unknown"), env!("CARGO_PKG_VERSION"));
        if version != own {
            return Err(
                fault(&format!("was written by abbe {version}")).expected(format!("version {own}, which this is"))
            );
        }
        let record: Self = serde_json::from_str(text).map_err(|_| fault("is damaged: its record cannot be read"))?;
        Ok((record, metadata))
    }

    /// The run that was saved, to go on with.
    ///
    /// # Errors
    /// The input's: a file of another render or another part (the error names the difference), or a damaged one.
    pub fn resume(path: &Path, job: &Job, identity: &Identity, part: Part) -> Result<Run> {
        let (saved, _) = Self::read(path)?;
        saved.identity.check(identity).map_err(|error| error.in_file(path))?;
        if saved.part != part {
            let what = format!("holds part {} of the passes", saved.part);
            return Err(Error::input(what).expected(format!("part {part}")).in_file(path));
        }
        let film = saved.film(path, job.scene.film.observer)?;
        let (part, done, wanted) = (saved.part, saved.done, saved.wanted);
        let seconds = saved.stats.seconds;
        Ok(Run { film, ledger: saved.ledger, tally: saved.tally, seconds, part, done, wanted })
    }

    /// Whether the part's pass of this index is among those done.
    pub(super) fn holds(&self, pass: u64) -> bool {
        self.part.nth(pass).is_some_and(|nth| nth < self.done)
    }

    /// The film with its sums.
    pub(super) fn film(&self, path: &Path, observer: &'static Observer) -> Result<Film> {
        let ((width, height), bands) = (self.identity.size, self.identity.spectral_bands);
        let [width, height, bands] = [width, height, bands].map(|count| count as usize);
        // The record may claim anything, and its hash is known only with the sums.
        if !holds_sums_of(path, (width, height), bands)? {
            return Err(Error::input("is damaged: its size is not the one that it states").in_file(path));
        }
        let diffraction = self.diffraction.as_ref().map(|diffraction| diffraction.for_film((width, height)).into());
        let film = Film::new(width, height, observer, bands);
        let mut film = film.diffracting(diffraction);
        add_sums(path, &mut film)?;
        if self.hash_with(&film) != self.hash {
            return Err(Error::input("is damaged: its sums are not those that were written").in_file(path));
        }
        (0..self.done).for_each(|nth| film.count_pass(self.part.pass(nth)));
        Ok(film)
    }

    fn hash_with(&self, film: &Film) -> String {
        let record = Self { hash: String::new(), ..self.clone() };
        let mut hash = Hash::default();
        hash.add_part(&serde_json::to_vec(&record).expect("a record has text keys and no fallible values"));
        for plane in 0..film.plane_names().len() {
            film.plane(plane).for_each(|sum| hash.add(&sum.bits().to_le_bytes()));
        }
        hash.hex()
    }
}
