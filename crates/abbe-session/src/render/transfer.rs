//! The exact sums of a run as bytes, for renderers that share memory or messages instead of files:
//! the workers of a web page each render a part of the passes, and one of them adds the sums.
//!
//! The bytes belong to this version and this scene; a saved run is the format for files.

use super::job::Job;
use super::part::PassPart;
use super::request::Integrator;
use super::run::Run;
use crate::output::exr::hash_sums;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sum::ExactSum;
use abbe_transport::emit::SpectrumCoverage;
use abbe_transport::pass::{PassSums, StageSeconds};
use abbe_transport::plan::Tally;
use abbe_transport::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};

/// Everything of a run except the sums of its film.
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    part: PassPart,
    done: u64,
    ledger: Ledger,
    tally: Tally,
    seconds: StageSeconds,
}

const BYTES_PER_SUM: usize = size_of::<i128>();

impl Run {
    /// Returns the passes so far as bytes: the length of a record in 4 bytes, the record as JSON,
    /// and the sums of all pixels, plane by plane, as 128-bit words in little-endian order.
    pub fn to_bytes(&self) -> Vec<u8> {
        let PassSums { film, ledger, tally, seconds } = &self.sums;
        let (ledger, tally, seconds) = (ledger.clone(), *tally, *seconds);
        let record = Record { part: self.part, done: self.done, ledger, tally, seconds };
        let record = serde_json::to_vec(&record).expect("a record has text keys and no fallible values");
        let planes = film.light_plane_names().len();
        let mut bytes = Vec::with_capacity(4 + record.len() + planes * film.width() * film.height() * BYTES_PER_SUM);
        bytes.extend((record.len() as u32).to_le_bytes());
        bytes.extend(record);
        (0..planes).for_each(|plane| film.plane(plane).for_each(|sum| bytes.extend(sum.bits().to_le_bytes())));
        bytes
    }

    /// Returns the BLAKE3 hashes of all sums of the film as 32 hexadecimal digits. Two runs of a
    /// scene with the same passes have the same digits, on any machine.
    pub fn hash_of_sums(&self) -> String {
        format!("{:032x}", u128::from_be_bytes(hash_sums(&self.sums.film).bytes()))
    }
}

impl Job {
    /// Adds the passes of runs of this job, from the bytes of [`Run::to_bytes`]. The run of a
    /// single part can continue. Returns an input error if bytes do not belong to this job, or if
    /// two parts contain the same pass.
    pub fn run_of_bytes(&self, parts: &[impl AsRef<[u8]>]) -> Result<Run> {
        let mut run = Run::new(self, PassPart::WHOLE);
        if self.errors_are_unknown(Integrator::Photon) {
            run.sums.film.assume_missing_light();
        }
        run.coverage = SpectrumCoverage::before_first_pass(&self.scene);
        let context = self.pass_context();
        let mut records: Vec<Record> = Vec::with_capacity(parts.len());
        for bytes in parts {
            let record = add(bytes.as_ref(), &mut run.sums).ok_or_else(|| Error::input("the bytes are no run"))?;
            let is_shared = |other: &Record| {
                let shared = record.part.shared_with(other.part);
                let holds = |record: &Record, pass| record.part.nth(pass).is_some_and(|nth| nth < record.done);
                shared.is_some_and(|pass| holds(&record, pass) && holds(other, pass))
            };
            if records.iter().any(is_shared) {
                return Err(Error::input("two runs contain the same pass"));
            }
            for nth in 0..record.done {
                let pass = record.part.pass(nth);
                run.sums.film.count_pass(pass);
                context.add_wavelengths(pass, &mut run.coverage);
            }
            run.done += record.done;
            records.push(record);
        }
        if let [only] = records.as_slice() {
            run.part = only.part;
        }
        Ok(run)
    }
}

/// Adds the sums in bytes, and returns their record. Returns `None` if the bytes do not fit the
/// film.
fn add(bytes: &[u8], sums: &mut PassSums) -> Option<Record> {
    let (length, rest) = bytes.split_first_chunk()?;
    let (record, words) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    let record: Record = serde_json::from_slice(record).ok()?;
    let film = &mut sums.film;
    let plane_bytes = film.width() * film.height() * BYTES_PER_SUM;
    if words.len() != film.light_plane_names().len() * plane_bytes {
        return None;
    }
    for (plane, words) in words.chunks_exact(plane_bytes).enumerate() {
        let bits = words.chunks_exact(BYTES_PER_SUM).filter_map(|bits| bits.try_into().ok());
        film.add_plane(plane, 0, bits.map(|bits| ExactSum::from_bits(i128::from_le_bytes(bits))));
    }
    sums.ledger.add(&record.ledger);
    sums.tally.add(&record.tally);
    sums.seconds.add(&record.seconds);
    Some(record)
}
