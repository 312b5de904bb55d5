//! Chooses the film size of a study: as large as the budget allows.

use super::monitor::StudyError;
use super::runner::{RenderStep, Runner};
use super::study_scene::integrator_title;
use super::time_fractions::TIME_FRACTIONS;
use abbe_session::render::{Integrator, Job, Stats};
use abbe_spectra::error::Error;
use abbe_transport::sensor::Picture;
use serde::Serialize;

/// The film size of a study, and the scene's own film size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct StudyFilm {
    /// Pixels per row.
    pub width: u32,
    pub height: u32,
    /// Pixels per row of the scene's own film.
    pub own_width: u32,
    /// Rows of the scene's own film.
    pub own_height: u32,
}

/// The most pixels. More hardly improve error estimates, and make the page large.
const MOST_PIXELS: f64 = 65_536.0;

/// The smallest number of pixels, so that the picture stays recognisable.
const LEAST_PIXELS: f64 = 3_072.0;

/// The target number of passes for a half of the reference by photon mapping.
const PHOTON_PASSES: f64 = 200.0;

/// The target number of passes for a half of the reference by the path tracer.
const PATH_PASSES: f64 = 64.0;

/// The largest fraction of the sweep's time that pilots may take.
const PILOT_FRACTION: f64 = 0.3;

const REHEARSAL_PASSES: u64 = 2;

/// Returns the number of renders that are needed to choose the film size.
pub(super) fn steps(given: Option<&(String, Picture)>) -> usize {
    if given.is_some() { 0 } else { 2 }
}

impl StudyFilm {
    /// Chooses the film for a budget: of the size of a given reference, or small enough for all
    /// passes of the reference. Short renders (rehearsals) at a quarter of the width and height
    /// measure the time of a pass.
    pub(super) fn choose(
        runner: &mut Runner<'_>,
        job: &Job,
        given: Option<&Picture>,
        budget_seconds: f64,
        sweep_runs: usize,
    ) -> Result<Self, StudyError> {
        let (own_width, own_height) = (job.scene.film.width, job.scene.film.height);
        let own = Self { width: own_width, height: own_height, own_width, own_height };
        if let Some(reference) = given {
            let same = reference.width as u64 * u64::from(own_height) == reference.height as u64 * u64::from(own_width);
            if !same {
                let what = format!("the reference has {} × {} pixels", reference.width, reference.height);
                let expected = format!("the aspect ratio of the scene's film, {own_width} × {own_height}");
                return Err(Error::input(what).expected(expected).into());
            }
            let size = |pixels: usize| u32::try_from(pixels).map_err(|_| Error::input("the reference is too large"));
            return Ok(Self { width: size(reference.width)?, height: size(reference.height)?, ..own });
        }
        let half = 0.5 * TIME_FRACTIONS.reference * budget_seconds;
        let small = own.of_pixels((own.pixels() / 16.0).max(64.0));
        let mut pixels = own.pixels().min(MOST_PIXELS);
        for (integrator, passes) in [(Integrator::Photon, PHOTON_PASSES), (Integrator::Path, PATH_PASSES)] {
            let (name, words) = (
                format!("rehearsal-{}", integrator.word()),
                format!("rehearsal, {}", integrator_title(integrator.word())),
            );
            let step = RenderStep::new(&name, &words, 1.0)
                .with_integrator(integrator)
                .with_passes(REHEARSAL_PASSES)
                .with_changes(small.changes());
            let stats = runner.render(&step, None)?.result.stats;
            let (fixed, gather) = pass_seconds(&stats);
            // If camera paths take less time than the rest, a smaller film hardly saves time.
            let worth = (half / passes - fixed).max(fixed) / gather.max(1e-9) * small.pixels();
            // Every run of the sweep has its own pilot, whose time grows with the number of pixels.
            let pilot = stats.seconds.pilot / PILOT_FRACTION;
            let piloted = TIME_FRACTIONS.sweep * budget_seconds / sweep_runs as f64 / pilot.max(1e-9) * small.pixels();
            pixels = pixels.min(worth.min(piloted).max(LEAST_PIXELS));
        }
        Ok(own.of_pixels(pixels))
    }

    fn pixels(&self) -> f64 {
        f64::from(self.width) * f64::from(self.height)
    }

    /// The ratio of the pixel count of the scene's own film to the pixel count of the study's film.
    pub fn pixel_ratio(&self) -> f64 {
        f64::from(self.own_width) * f64::from(self.own_height) / self.pixels()
    }

    /// Returns a film of the same aspect ratio with about `pixels` pixels, at most the scene's own.
    fn of_pixels(&self, pixels: f64) -> Self {
        let scale = (pixels / self.pixels()).sqrt().min(1.0);
        let side = |own: u32| ((f64::from(own) * scale).round() as u32).max(1);
        Self { width: side(self.own_width), height: side(self.own_height), ..*self }
    }

    /// Returns the film as changes of the scene, without spectral bands, which cost time.
    pub(super) fn changes(&self) -> Vec<String> {
        let Self { width, height, .. } = self;
        vec![format!("film.width={width}"), format!("film.height={height}"), "film.spectral_bands=0".to_string()]
    }
}

/// Returns the seconds of a pass without and with the film size: of the camera paths.
pub(super) fn pass_seconds(stats: &Stats) -> (f64, f64) {
    let (seconds, passes) = (stats.seconds, stats.passes.max(1) as f64);
    ((seconds.pose + seconds.emit + seconds.map) / passes, seconds.gather / passes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_film_keeps_its_shape() {
        let own = StudyFilm { width: 640, height: 360, own_width: 640, own_height: 360 };
        let small = own.of_pixels(MOST_PIXELS);
        assert_eq!((small.width, small.height), (341, 192));
        assert!((small.pixel_ratio() - 3.52).abs() < 0.01);
        assert_eq!(own.of_pixels(1e9), own);
    }
}
