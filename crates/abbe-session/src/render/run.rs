//! The state of a render between two passes.

use super::denoise::denoised;
use super::job::Job;
use super::part::PassPart;
use abbe_transport::emit::SpectrumCoverage;
use abbe_transport::pass::{PassSums, StageSeconds};
use abbe_transport::pilot::PassSize;
use abbe_transport::plan::Tally;
use abbe_transport::sensor::{Film, FilmUnit, Picture, PictureErrors, Reading, ReadingSpectrum};
use abbe_transport::walk::ledger::Ledger;
use std::time::Duration;
use web_time::Instant;

/// The state of a render between two passes, which can continue elsewhere and be merged.
#[derive(Debug)]
pub struct Run {
    pub(super) sums: PassSums,
    pub(super) part: PassPart,
    /// The number of completed passes of the part. These are the first passes of the part.
    pub(super) done: u64,
    /// The number of these passes whose sums are in another run, and their time in s.
    pub(super) taken: (u64, f64),
    /// The passes at which the whole picture stops, or `None` without limit.
    pub(super) wanted: Option<u64>,
    /// The spectra that the shared wavelengths of the completed passes have sampled.
    pub(super) coverage: SpectrumCoverage,
    /// The largest work of a pass in instructions, if the time limit made the passes smaller.
    pub(super) largest_work: Option<f64>,
}

impl Run {
    pub fn new(job: &Job, part: PassPart) -> Self {
        let film = &job.scene.film;
        let [width, height, bands] = [film.width, film.height, film.spectral_bands].map(|count| count as usize);
        let diffraction = job.diffraction.as_ref().map(|diffraction| diffraction.for_film((width, height)).into());
        let blank = Film::new(width, height, film.observer, bands).with_unit(FilmUnit::of(&job.scene));
        let blank = blank.with_diffraction(diffraction).with_layers(&job.layers);
        let sums = PassSums {
            film: match &job.readings {
                Some(layout) => blank.with_readings(layout.clone()),
                None => blank,
            },
            ledger: Ledger::new(job.scene.materials.len()),
            tally: Tally::default(),
            seconds: StageSeconds::default(),
        };
        Self {
            sums,
            part,
            done: 0,
            taken: (0, 0.0),
            wanted: None,
            coverage: SpectrumCoverage::default(),
            largest_work: None,
        }
    }

    pub fn picture(&self) -> Picture {
        self.sums.film.picture()
    }

    /// Returns the picture so far with its denoised picture, if the film has the sums for it.
    pub fn picture_with_denoised(&self) -> Picture {
        let picture = self.picture();
        Picture { denoised: denoised(&self.sums.film, &picture), ..picture }
    }

    /// Returns true if the film collects what the denoiser needs, also before the fourth pass.
    pub fn denoises(&self) -> bool {
        self.sums.film.denoises()
    }

    pub fn readings(&self) -> Vec<Reading> {
        self.sums.film.readings()
    }

    /// Returns the spectrum of a reading. Returns `None` if no meter needs a spectrum.
    pub fn reading_spectrum(&self, number: usize) -> Option<ReadingSpectrum> {
        self.sums.film.reading_spectrum(number)
    }

    pub fn passes(&self) -> u64 {
        self.done
    }

    /// Returns the size of the passes that follow. A new run with a time limit has passes of which
    /// several fit into it, and a continued run those of its beginning. Parts of a picture have the
    /// passes of the whole.
    pub(super) fn pass_size(&self, time: Option<Duration>, start: Instant) -> PassSize {
        match (self.largest_work, time) {
            (Some(work), _) => PassSize::AtMost(work),
            (None, Some(time)) if self.done == 0 && self.part == PassPart::WHOLE => {
                start.checked_add(time).map_or(PassSize::Free, PassSize::Until)
            }
            (None, _) => PassSize::Free,
        }
    }

    /// Returns the number of photons that the lights have emitted.
    pub fn photons(&self) -> u64 {
        self.sums.tally.photons
    }

    /// Returns the root mean square error of the picture, divided by its mean luminance, or `None`
    /// if it is unknown.
    pub fn relative_error(&self) -> Option<f64> {
        self.errors().map(|errors| errors.whole.relative())
    }

    /// Returns the error of a typical pixel, or `None` if it is unknown.
    pub fn typical_error(&self) -> Option<f64> {
        self.errors().map(|errors| errors.typical.relative())
    }

    /// Returns the parts of the squared relative errors, or `None` if they are unknown, or if the
    /// passes lack the light of a spectrum.
    pub(super) fn errors(&self) -> Option<PictureErrors> {
        self.coverage.is_complete().then(|| self.sums.film.errors()).flatten()
    }
}
