//! Moves passes from a run to another one as bytes, for renderers that share memory or messages
//! instead of files: the workers of a web page each render a part of the passes, and one of them
//! adds the sums. The sums move, so that each worker holds those of one film.
//!
//! The bytes belong to this version and this scene; a saved run is the format for files.

use super::job::Job;
use super::packed_sums::{pack, unpack};
use super::part::PassPart;
use super::request::Integrator;
use super::run::Run;
use crate::output::exr::hash_sums;
use abbe_spectra::error::{Error, Result};
use abbe_transport::emit::SpectrumCoverage;
use abbe_transport::pass::StageSeconds;
use abbe_transport::plan::Tally;
use abbe_transport::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};

/// Everything of some passes of a part except the sums of their film.
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    part: PassPart,
    /// The number of passes of the part before these.
    before: u64,
    /// The number of passes of the part up to the last one of these.
    done: u64,
    ledger: Ledger,
    tally: Tally,
    seconds: StageSeconds,
}

impl Run {
    /// Returns a run that continues a part after its first `done` passes, whose sums are elsewhere.
    pub fn after(job: &Job, part: PassPart, done: u64) -> Self {
        Self { done, taken: (done, 0.0), ..Self::new(job, part) }
    }

    /// Moves the passes since the last call out of the run. `send` receives a record as JSON, and
    /// then the sums of one plane of the film after another.
    pub fn take_passes(&mut self, send: &mut dyn FnMut(&[u8])) {
        let sums = &mut self.sums;
        let (before, seconds_before) = std::mem::replace(&mut self.taken, (self.done, sums.seconds.total));
        let seconds = StageSeconds { total: sums.seconds.total - seconds_before, ..sums.seconds };
        sums.seconds = StageSeconds { total: sums.seconds.total, ..StageSeconds::default() };
        let empty = Ledger::new(sums.ledger.absorbed.len());
        let (ledger, tally) = (std::mem::replace(&mut sums.ledger, empty), std::mem::take(&mut sums.tally));
        let record = Record { part: self.part, before, done: self.done, ledger, tally, seconds };
        send(&serde_json::to_vec(&record).expect("a record has text keys and no fallible values"));
        let mut bytes = Vec::new();
        for plane in 0..sums.film.light_plane_names().len() {
            pack(sums.film.plane(plane), &mut bytes);
            send(&bytes);
            bytes.clear();
        }
        sums.film.clear();
    }

    /// Returns the BLAKE3 hashes of all sums of the film as 32 hexadecimal digits. Two runs of a
    /// scene with the same passes have the same digits, on any machine.
    pub fn hash_of_sums(&self) -> String {
        format!("{:032x}", u128::from_be_bytes(hash_sums(&self.sums.film).bytes()))
    }
}

/// The sum of the passes that [`Run::take_passes`] has moved out of the runs of a job.
#[derive(Debug)]
pub struct TakenPasses {
    run: Run,
    /// The number of passes of each part.
    parts: Vec<(PassPart, u64)>,
}

impl TakenPasses {
    pub fn new(job: &Job) -> Self {
        let mut run = Run::new(job, PassPart::WHOLE);
        if job.errors_are_unknown(Integrator::Photon) {
            run.sums.film.assume_missing_light();
        }
        run.coverage = SpectrumCoverage::before_first_pass(&job.scene);
        Self { run, parts: Vec::new() }
    }

    pub fn run(&self) -> &Run {
        &self.run
    }

    /// Returns the number of passes of a part.
    pub fn of_part(&self, part: PassPart) -> u64 {
        self.parts.iter().find(|(other, _)| *other == part).map_or(0, |(_, done)| *done)
    }

    /// Adds passes of a run of this job. `pieces` are those of [`Run::take_passes`]. Returns an
    /// input error if they do not belong to this job, if a pass is contained already, or if an
    /// earlier pass of the part is missing. After an error, the sums may be incomplete.
    pub fn add(&mut self, job: &Job, pieces: impl IntoIterator<Item = impl AsRef<[u8]>>) -> Result<()> {
        let foreign = || Error::input("the bytes are not passes of this scene");
        let mut pieces = pieces.into_iter();
        let record = pieces.next().and_then(|record| serde_json::from_slice::<Record>(record.as_ref()).ok());
        let Record { part, before, done, ledger, tally, seconds } = record.ok_or_else(foreign)?;
        if done < before || before != self.of_part(part) {
            return Err(Error::input("the passes do not follow those before them"));
        }
        let is_shared = |&(other, others): &(PassPart, u64)| {
            let holds = |part: PassPart, done, pass| part.nth(pass).is_some_and(|nth| nth < done);
            let shared = if part == other { None } else { part.shared_with(other) };
            shared.is_some_and(|pass| holds(part, done, pass) && holds(other, others, pass))
        };
        if self.parts.iter().any(is_shared) {
            return Err(Error::input("two runs contain the same pass"));
        }
        let sums = &mut self.run.sums;
        let pixels = sums.film.width() * sums.film.height();
        for plane in 0..sums.film.light_plane_names().len() {
            let piece = pieces.next().and_then(|piece| unpack(piece.as_ref(), pixels)).ok_or_else(foreign)?;
            sums.film.add_plane(plane, 0, piece.into_iter());
        }
        sums.ledger.add(&ledger);
        sums.tally.add(&tally);
        sums.seconds.add(&seconds);
        let context = job.pass_context();
        for pass in (before..done).map(|nth| part.pass(nth)) {
            sums.film.count_pass(pass);
            context.add_wavelengths(pass, &mut self.run.coverage);
        }
        self.run.done += done - before;
        match self.parts.iter_mut().find(|(other, _)| *other == part) {
            Some((_, own)) => *own = done,
            None => self.parts.push((part, done)),
        }
        Ok(())
    }
}
