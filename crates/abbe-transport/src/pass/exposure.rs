//! Exposes the film: traces the camera paths of all pixels in parallel.

use super::sums::PassSums;
use crate::plan::{LightOrigin, PathClass, Tally};
use crate::sensor::{FilmRow, PixelSink};
use crate::walk::{SensorResponse, Sink};
use rayon::prelude::*;

/// Adds the radiance of camera paths to a pixel.
impl Sink for PixelSink<'_> {
    fn radiance(&mut self, origin: LightOrigin, nm: f64, weight: f64) {
        PixelSink::radiance(self, (origin.class.number(), origin.light), nm, weight);
    }

    fn biased(&mut self, origin: LightOrigin, nm: f64, weight: f64, bias: f64) {
        PixelSink::biased(self, (origin.class.number(), origin.light), nm, weight, bias);
    }

    fn respond(&mut self, class: PathClass, radiance: SensorResponse, bias: SensorResponse) {
        PixelSink::respond(self, class.number(), radiance.0, bias.0);
    }

    fn separates_lights(&self) -> bool {
        PixelSink::separates_lights(self)
    }

    fn respond_of_light(&mut self, light: usize, radiance: SensorResponse) {
        PixelSink::respond_of_light(self, light, radiance.0);
    }
}

/// Exposes all rows of the film in parallel. `expose` returns the number of rejected samples.
pub(super) fn expose_rows(sums: &mut PassSums, expose: impl Fn(&mut FilmRow<'_>, &mut Tally) -> u64 + Sync) {
    let rows: Vec<FilmRow<'_>> = sums.film.rows().collect();
    let tallies = rows
        .into_par_iter()
        .map(|mut row| {
            let mut tally = Tally::default();
            let rejected = expose(&mut row, &mut tally);
            tally.rejected += rejected;
            tally
        })
        .collect::<Vec<_>>();
    tallies.iter().for_each(|tally| sums.tally.add(tally));
}
