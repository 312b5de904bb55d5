//! How large the pictures of a study are: as large as its budget allows.

use super::course::{Order, Workshop};
use super::report::title_of;
use super::{Halt, SHARES};
use crate::error::Error;
use crate::render::{Integrator, Job, Stats};
use crate::sensor::Picture;
use serde::Serialize;

/// The film of a study, beside the scene's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct StudyFilm {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels per row of the scene's own film.
    pub own_width: u32,
    /// Rows of the scene's own film.
    pub own_height: u32,
}

/// More pixels tell little more about errors, and make the page heavy.
const MOST_PIXELS: f64 = 65_536.0;

/// Fewer would be no picture.
const LEAST_PIXELS: f64 = 3_072.0;

/// Each half of the reference is to have so many passes …
const PHOTON_PASSES: f64 = 200.0;

/// … or so many of the path tracer.
const PATH_PASSES: f64 = 64.0;

/// Pilots may take this share of the sweep's time.
const PILOT_SHARE: f64 = 0.3;

/// Passes of a rehearsal.
const REHEARSED: u64 = 2;

/// How many renders choosing the film takes.
pub(super) fn steps(given: Option<&(String, Picture)>) -> usize {
    if given.is_some() { 0 } else { 2 }
}

impl StudyFilm {
    /// The film for a budget in seconds: that of the given reference, or one small enough for a reference of enough passes, by a rehearsal at
    /// a quarter of the size.
    pub(super) fn choose(
        workshop: &mut Workshop<'_>,
        job: &Job,
        given: Option<&Picture>,
        (budget, sweep_runs): (f64, usize),
    ) -> Result<Self, Halt> {
        let (own_width, own_height) = (job.scene.film.width, job.scene.film.height);
        let own = Self { width: own_width, height: own_height, own_width, own_height };
        if let Some(reference) = given {
            let same = reference.width as u64 * u64::from(own_height) == reference.height as u64 * u64::from(own_width);
            if !same {
                let what = format!("the reference has {} × {} pixels", reference.width, reference.height);
                let expected = format!("the shape of the scene's film, {own_width} × {own_height}");
                return Err(Error::input(what).expected(expected).into());
            }
            let size = |pixels: usize| u32::try_from(pixels).map_err(|_| Error::input("the reference is too large"));
            return Ok(Self { width: size(reference.width)?, height: size(reference.height)?, ..own });
        }
        let half = 0.5 * SHARES.reference * budget;
        let small = own.of_pixels((own.pixels() / 16.0).max(64.0));
        let mut pixels = own.pixels().min(MOST_PIXELS);
        for (integrator, passes) in [(Integrator::Photon, PHOTON_PASSES), (Integrator::Path, PATH_PASSES)] {
            let (name, words) =
                (format!("rehearsal-{}", integrator.word()), format!("rehearsal, {}", title_of(integrator.word())));
            let order = Order::new(&name, &words, 1.0).by(integrator).until(REHEARSED).changed(small.changes());
            let stats = workshop.render(&order, None)?.found.stats;
            let (fixed, gather) = pass_seconds(&stats);
            // A film smaller than one whose camera paths take as long as all else would hardly save time.
            let worth = (half / passes - fixed).max(fixed) / gather.max(1e-9) * small.pixels();
            // Every run of the sweep has a pilot of its own, which looks at every pixel.
            let pilot = stats.seconds.pilot / PILOT_SHARE;
            let piloted = SHARES.sweep * budget / sweep_runs as f64 / pilot.max(1e-9) * small.pixels();
            pixels = pixels.min(worth.min(piloted).max(LEAST_PIXELS));
        }
        Ok(own.of_pixels(pixels))
    }

    fn pixels(&self) -> f64 {
        f64::from(self.width) * f64::from(self.height)
    }

    /// How many times as many pixels the scene's own film has.
    pub fn pixel_ratio(&self) -> f64 {
        f64::from(self.own_width) * f64::from(self.own_height) / self.pixels()
    }

    /// A film of the same shape with about so many pixels, not more than the scene's own.
    fn of_pixels(&self, pixels: f64) -> Self {
        let scale = (pixels / self.pixels()).sqrt().min(1.0);
        let side = |own: u32| ((f64::from(own) * scale).round() as u32).max(1);
        Self { width: side(self.own_width), height: side(self.own_height), ..*self }
    }

    /// The film as changes of the scene. Spectral bands cost time, and no error is measured in them.
    pub(super) fn changes(&self) -> Vec<String> {
        let Self { width, height, .. } = self;
        vec![format!("film.width={width}"), format!("film.height={height}"), "film.spectral_bands=0".to_string()]
    }
}

/// What a pass takes whatever the film's size, and what its camera paths take.
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
