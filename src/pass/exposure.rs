//! Exposes the film: traces the camera paths of all pixels in parallel.

use super::sums::PassSums;
use crate::plan::Tally;
use crate::sensor::PixelSink;
use crate::sensor::film::FilmRow;
use crate::walk::{SensorResponse, Sink};
use rayon::prelude::*;

/// Adds the radiance of camera paths to a pixel.
impl Sink for PixelSink<'_> {
    fn radiance(&mut self, nm: f64, weight: f64) {
        PixelSink::radiance(self, nm, weight);
    }

    fn biased(&mut self, nm: f64, weight: f64, bias: f64) {
        PixelSink::biased(self, nm, weight, bias);
    }

    fn respond(&mut self, radiance: SensorResponse, bias: SensorResponse) {
        PixelSink::respond(self, radiance.0, bias.0);
    }
}

/// Exposes all rows of the film in parallel. `expose` returns the number of rejected samples.
pub(super) fn expose_rows(sums: &mut PassSums, expose: impl Fn(&mut FilmRow<'_>, &mut Tally) -> u64 + Sync) {
    let rows: Vec<FilmRow<'_>> = sums.film.rows().collect();
    let tallies: Vec<Tally> = rows
        .into_par_iter()
        .map(|mut row| {
            let mut tally = Tally::default();
            let rejected = expose(&mut row, &mut tally);
            tally.rejected += rejected;
            tally
        })
        .collect();
    tallies.iter().for_each(|tally| sums.tally.add(tally));
}
