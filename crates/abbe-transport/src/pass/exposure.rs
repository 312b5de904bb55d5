//! Exposes the film: traces the camera paths of all pixels in parallel.

use super::sums::PassSums;
use crate::plan::{LightOrigin, PathClass, Tally};
use crate::sensor::{ExposedRow, FilmRow, PixelSink};
use crate::walk::{SensorResponse, Sink, StopFlag};
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

    fn stokes(&mut self, nm: f64, stokes: [f64; 3]) {
        PixelSink::stokes(self, nm, stokes);
    }

    fn separates_lights(&self) -> bool {
        PixelSink::separates_lights(self)
    }

    fn respond_of_light(&mut self, light: usize, radiance: SensorResponse) {
        PixelSink::respond_of_light(self, light, radiance.0);
    }
}

/// Exposes all rows of the film in parallel, and then adds the pass to `sums`. Returns false if the
/// flag is raised; `sums` has not changed then.
pub(super) fn expose_rows(
    sums: &mut PassSums,
    (pass, stop): (u64, &StopFlag),
    expose: impl Fn(&FilmRow<'_>, &mut Tally) -> ExposedRow + Sync,
) -> bool {
    let rows: Vec<FilmRow<'_>> = sums.film.rows().map(|row| row.of_pass(pass)).collect();
    let exposed = rows
        .into_par_iter()
        .map(|row| {
            let mut tally = Tally::default();
            let exposed = (!stop.is_raised()).then(|| expose(&row, &mut tally))?;
            Some((row, exposed, tally))
        })
        .collect::<Option<Vec<_>>>();
    let Some(exposed) = exposed.filter(|_| !stop.is_raised()) else { return false };
    let tallies = exposed
        .into_par_iter()
        .map(|(mut row, exposed, mut tally)| {
            tally.rejected += row.add(pass, &exposed);
            tally
        })
        .collect::<Vec<_>>();
    tallies.iter().for_each(|tally| sums.tally.add(tally));
    true
}
