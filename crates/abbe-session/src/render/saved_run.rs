//! Saved runs (checkpoints and parts): EXR files with the picture so far, the exact sums of the
//! film, and a record of everything else in the header.

use super::diffraction::DiffractionSetup;
use super::display::DisplaySettings;
use super::forecast::{Forecasts, RunTimes};
use super::identity::RenderIdentity;
use super::job::Job;
use super::part::PassPart;
use super::run::Run;
use super::stats::Stats;
use crate::output::exr::{add_sums, hash_sums, holds_sums_of, read_metadata, write_with_sums};
use crate::output::hash::{IdentityHash, SumsHash};
use crate::output::metadata::{Metadata, names};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Observer;
use abbe_transport::emit::SpectrumCoverage;
use abbe_transport::pass::PassSums;
use abbe_transport::plan::Tally;
use abbe_transport::sensor::{Film, FilmUnit};
use abbe_transport::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The name of the record in the file's header.
const RECORD: &str = "abbe.run";

/// The record of a saved run: everything except the sums of the film, which may be large.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedRun {
    pub(super) identity: RenderIdentity,
    pub(super) part: PassPart,
    pub(super) done: u64,
    pub(super) wanted: Option<u64>,
    /// The largest work of a pass in instructions, if the time limit made the passes smaller.
    #[serde(default)]
    largest_work: Option<f64>,
    unit: FilmUnit,
    ledger: Ledger,
    tally: Tally,
    pub(super) stats: Stats,
    #[serde(rename = "showing")]
    pub(super) display: DisplaySettings,
    diffraction: Option<DiffractionSetup>,
    /// Of the sums and of the record with this field empty. It reveals damage to the file.
    hash: String,
}

impl SavedRun {
    /// Writes a run and its picture so far, atomically. `metadata` describes the scene. Returns a
    /// machine error if the file cannot be written.
    pub fn write(path: &Path, job: &Job, identity: &RenderIdentity, run: &Run, metadata: Metadata) -> Result<()> {
        let PassSums { film, ledger, tally, seconds } = &run.sums;
        let (picture, errors) = film.picture_and_errors();
        let times = RunTimes::of(run.done, seconds);
        let forecast = errors.and_then(|errors| Forecasts::without_history(errors, times));
        let mut record = Self {
            identity: identity.clone(),
            part: run.part,
            done: run.done,
            wanted: run.wanted,
            largest_work: run.largest_work,
            unit: film.unit(),
            ledger: ledger.clone(),
            tally: *tally,
            stats: Stats::new(job, run, &picture, forecast, &[]),
            display: DisplaySettings::of(job),
            diffraction: job.diffraction.clone(),
            hash: String::new(),
        };
        record.hash = record.hash_with(hash_sums(film));
        write_with_sums(path, film, &picture, &metadata.with_json(RECORD, &record))
    }

    /// Reads the record of a saved run, and the header of its file. Returns an input error if the
    /// file is missing, is not an EXR file, was written by another version, is damaged, or has no
    /// exact sums.
    pub fn read(path: &Path) -> Result<(Self, Metadata)> {
        let metadata = read_metadata(path)?;
        let fault = |what: &str| Error::input(what).in_file(path);
        let text = metadata
            .get(RECORD)
            .ok_or_else(|| fault("contains no exact sums").expected("a part or a checkpoint that abbe has written"))?;
        let (version, own) = (metadata.get(names::VERSION).unwrap_or("unknown"), env!("CARGO_PKG_VERSION"));
        if version != own {
            return Err(fault(&format!("was written by abbe {version}")).expected(format!("version {own}")));
        }
        let mut record: Self =
            serde_json::from_str(text).map_err(|_| fault("is damaged: its record cannot be read"))?;
        record.identity = record.identity.with_scene_of(&metadata);
        Ok((record, metadata))
    }

    /// Reads a saved run to continue it. Returns an input error that names the difference if the
    /// file is damaged, or belongs to another render or another part.
    pub fn resume(path: &Path, job: &Job, identity: &RenderIdentity, part: PassPart) -> Result<Run> {
        let (saved, _) = Self::read(path)?;
        saved.identity.check(identity).map_err(|error| error.in_file(path))?;
        if saved.part != part {
            let what = format!("contains part {} of the passes", saved.part);
            return Err(Error::input(what).expected(format!("part {part}")).in_file(path));
        }
        let film = saved.film(path, job.scene.film.observer)?;
        let Self { part, done, wanted, largest_work, .. } = saved;
        let sums = PassSums { film, ledger: saved.ledger, tally: saved.tally, seconds: saved.stats.seconds };
        Ok(Run { sums, part, done, taken: (0, 0.0), wanted, coverage: SpectrumCoverage::default(), largest_work })
    }

    /// Returns true if the pass is done. `pass` is the index of the pass in the picture.
    pub(super) fn holds(&self, pass: u64) -> bool {
        self.part.nth(pass).is_some_and(|nth| nth < self.done)
    }

    fn film(&self, path: &Path, observer: &'static Observer) -> Result<Film> {
        let mut film = self.blank_film(path, observer)?;
        self.add_to(path, &mut film)?;
        Ok(film)
    }

    /// Returns an unexposed film for the sums, or an input error if the file is damaged.
    pub(super) fn blank_film(&self, path: &Path, observer: &'static Observer) -> Result<Film> {
        let ([width, height], bands) = self.identity.film_size();
        let layers = self.identity.layers();
        // The record is not verified yet, so the film is allocated only if the file has this size.
        if !holds_sums_of(path, (width, height), bands + layers.planes())? {
            return Err(Error::input("is damaged: its size differs from the size in its record").in_file(path));
        }
        let diffraction = self.diffraction.as_ref().map(|diffraction| diffraction.for_film((width, height)).into());
        let mut film = Film::new(width, height, observer, bands).with_unit(self.unit);
        if !self.stats.unfound_lights.is_empty() {
            film.assume_missing_light();
        }
        Ok(film.with_diffraction(diffraction).with_layers(layers))
    }

    /// Adds the sums of the file to a film, and counts its passes. Returns an input error if the
    /// file is damaged; the film is then useless.
    pub(super) fn add_to(&self, path: &Path, film: &mut Film) -> Result<()> {
        let hash = add_sums(path, film)?;
        if self.hash_with(hash) != self.hash {
            return Err(Error::input("is damaged: its sums have changed since they were written").in_file(path));
        }
        (0..self.done).for_each(|nth| film.count_pass(self.part.pass(nth)));
        Ok(())
    }

    fn hash_with(&self, sums: SumsHash) -> String {
        let record = Self { hash: String::new(), ..self.clone() };
        let mut hash = IdentityHash::default();
        hash.add_part(&serde_json::to_vec(&record).expect("a record has text keys and no fallible values"));
        hash.add(&sums.bytes());
        hash.hex()
    }
}
