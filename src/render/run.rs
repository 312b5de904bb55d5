//! What grows from pass to pass.

use super::{Job, Part, Seconds};
use crate::sensor::{Film, Picture};
use crate::walk::Tally;
use crate::walk::ledger::Ledger;

/// What grows from pass to pass: all that going on later, elsewhere or together with others needs.
#[derive(Debug)]
pub struct Run {
    pub(super) film: Film,
    /// Sums over passes.
    pub(super) ledger: Ledger,
    pub(super) tally: Tally,
    pub(super) seconds: Seconds,
    pub(super) part: Part,
    /// How many passes of the part are done, the first ones.
    pub(super) done: u64,
    /// How many passes the whole picture is to have, if a number was given.
    pub(super) wanted: Option<u64>,
}

impl Run {
    /// A run of a part of the passes that has not begun.
    pub fn new(job: &Job, part: Part) -> Self {
        let film = &job.scene.film;
        let [width, height, bands] = [film.width, film.height, film.spectral_bands].map(|count| count as usize);
        let diffraction = job.diffraction.as_ref().map(|diffraction| diffraction.for_film((width, height)).into());
        Self {
            film: Film::new(width, height, film.observer, bands).diffracting(diffraction),
            ledger: Ledger::new(job.scene.materials.len()),
            tally: Tally::default(),
            seconds: Seconds::default(),
            part,
            done: 0,
            wanted: None,
        }
    }

    /// The picture so far.
    pub fn picture(&self) -> Picture {
        self.film.develop()
    }

    /// Passes done.
    pub fn passes(&self) -> u64 {
        self.done
    }

    /// The relative error of the picture so far; `None` while it is unknown.
    pub fn relative_error(&self) -> Option<f64> {
        self.film.develop_and_judge().1.map(|squares| squares.relative())
    }
}
