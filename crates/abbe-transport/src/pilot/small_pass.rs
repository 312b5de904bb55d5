//! The small passes of the trial: few photons, and camera samples in tiles of the film.

use crate::gather::{CameraPass, PathBuffers, PixelSampler};
use crate::map::SetMaps;
use crate::pass::{EmissionRequest, PassContext, PassParameters, trace_photons};
use crate::plan::partition::PerSet;
use crate::plan::{PathClass, Tally};
use crate::sensor::{Film, PixelSink, SplatSink};
use abbe_scene::Scene;
use abbe_spectra::math::kronecker::golden_ratio;
use abbe_spectra::math::random::Purpose;
use rayon::prelude::*;

/// The number of passes in the trial, and the number of camera samples per pixel in each pass.
pub(super) const TRIALS: usize = 2;

/// The trial samples square tiles of this many pixels in each direction.
pub(super) const TILE: usize = 4;

const MOST_TILES: usize = 128;

/// X, Y and Z of a pixel in one pass of the trial, in W/m²/sr.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TrialPixel {
    pub(super) samples: [[f64; 3]; TRIALS],
    /// The part of the samples that media scatter.
    pub(super) media: [[f64; 3]; TRIALS],
    pub(super) splats: [f64; 3],
}

pub(super) struct SmallPass {
    pub(super) tiles: Vec<Vec<TrialPixel>>,
    pub(super) tally: Tally,
}

pub(super) struct TrialPhotons {
    number: u64,
    pub(super) maps: PerSet<SetMaps>,
    pub(super) splats: Vec<[f64; 3]>,
    /// The part of the splats that ribbons paint. Empty without ribbons.
    pub(super) painted: Vec<[f64; 3]>,
    pub(super) tally: Tally,
}

pub(super) fn mean_of_components(value: impl Fn(usize) -> f64) -> f64 {
    (0..3).map(value).sum::<f64>() / 3.0
}

impl TrialPixel {
    pub(super) fn mean(pixels: &[Self]) -> Self {
        let fraction = 1.0 / pixels.len() as f64;
        let mut mean = Self::default();
        for pixel in pixels {
            for c in 0..3 {
                mean.splats[c] += fraction * pixel.splats[c];
                for nth in 0..TRIALS {
                    mean.samples[nth][c] += fraction * pixel.samples[nth][c];
                    mean.media[nth][c] += fraction * pixel.media[nth][c];
                }
            }
        }
        mean
    }
}

impl TrialPhotons {
    /// Traces few photons in the pass `number`, with these `counts` of paths of each set.
    pub(super) fn trace(
        context: &PassContext<'_>,
        scene: &Scene,
        parameters: &PassParameters,
        (number, counts): (u64, PerSet<u64>),
    ) -> Self {
        let shared = context.shared_wavelengths(0);
        let blank = Film::new(1, 1, scene.film.observer, 0);
        let traced = PerSet::from_fn(|set| {
            let pass = 2 * number + set as u64;
            let (wavelengths, count) = (shared.sampling(set), counts[set]);
            let request = EmissionRequest { wavelengths, count, purpose: Purpose::TrialPhoton, pass };
            let source = parameters.photon_source(context, scene, request);
            trace_photons(&source, context.plan, set, parameters.recording(set), || blank.splat_sink())
        });
        let mut splats = vec![[0.0; 3]; scene.camera.pixel_count()];
        let mut painted = if context.plan.ribbons { splats.clone() } else { Vec::new() };
        let mut tally = Tally::default();
        for set in [&traced.free, &traced.shared] {
            tally.add(&set.tally);
            for (pixel, xyz, is_painted) in set.splats.iter().flat_map(SplatSink::splats) {
                let pixel = pixel as usize;
                (0..3).for_each(|c| splats[pixel][c] += f64::from(xyz[c]));
                if is_painted {
                    (0..3).for_each(|c| painted[pixel][c] += f64::from(xyz[c]));
                }
            }
        }
        let maps = PerSet { free: traced.free.deposits.into_maps(), shared: traced.shared.deposits.into_maps() };
        Self { number, maps, splats, painted, tally }
    }
}

/// Takes a camera sample of a pixel. Returns X, Y and Z of each path class.
pub(super) fn sample_light<'a>(
    context: &PassContext<'_>,
    parameters: &PassParameters,
    camera_pass: &CameraPass<'a>,
    (pass, pixel): (u64, usize),
    buffers: &mut PathBuffers<'a>,
    tally: &mut Tally,
) -> [[f64; 3]; PathClass::NAMES.len()] {
    let sampler = PixelSampler::new(context.budget.seed.streams(Purpose::TrialCamera), pass, pixel as u64);
    PixelSink::measure_classes(camera_pass.scene.film.observer, |sink| {
        camera_pass.sample(pixel as u64, sampler, &parameters.radii.of(pixel), buffers, tally, sink);
    })
}

impl SmallPass {
    #[inline(never)]
    pub(super) fn run(
        context: &PassContext<'_>,
        parameters: &PassParameters,
        traced: &TrialPhotons,
        camera_pass: &CameraPass<'_>,
        tiles: &[Vec<usize>],
    ) -> Self {
        let measured: Vec<(Vec<TrialPixel>, Tally)> = tiles
            .into_par_iter()
            .map(|tile: &Vec<usize>| {
                let (mut buffers, mut tally) = (PathBuffers::default(), Tally::default());
                let mut light = |pixel: usize| {
                    let samples: [_; TRIALS] = std::array::from_fn(|nth| {
                        let pass = traced.number * TRIALS as u64 + nth as u64;
                        sample_light(context, parameters, camera_pass, (pass, pixel), &mut buffers, &mut tally)
                    });
                    let sum = |classes: [[f64; 3]; PathClass::NAMES.len()]| {
                        std::array::from_fn(|c| classes.iter().map(|xyz| xyz[c]).sum::<f64>())
                    };
                    let media = samples.map(|classes| classes[PathClass::Volume.number()]);
                    TrialPixel { samples: samples.map(sum), media, splats: traced.splats[pixel] }
                };
                (tile.iter().map(|&pixel| light(pixel)).collect(), tally)
            })
            .collect::<Vec<_>>();
        let tally = measured.iter().map(|&(_, tally)| tally).sum();
        Self { tiles: measured.into_iter().map(|(pixels, _)| pixels).collect(), tally }
    }
}

/// Returns the pixels of tiles that are spread over the film.
pub(super) fn tiles((width, height): (usize, usize)) -> Vec<Vec<usize>> {
    let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
    let wanted = (columns * rows).min(MOST_TILES);
    // The golden ratio spreads the tiles over the columns.
    let mut corners: Vec<(usize, usize)> = (0..wanted)
        .map(|i| ((i * rows / wanted), (golden_ratio(i as u32, 0) * columns as f64) as usize))
        .map(|(row, column)| (row * TILE, column * TILE))
        .collect();
    corners.sort_unstable();
    corners.dedup();
    let pixels = |(y, x): (usize, usize)| {
        let rows = y..(y + TILE).min(height);
        rows.flat_map(move |y| (x..(x + TILE).min(width)).map(move |x| y * width + x)).collect()
    };
    corners.into_iter().map(pixels).collect()
}

/// Returns the variance of two values, estimated from their difference.
pub(super) fn half_square(one: f64, other: f64) -> f64 {
    0.5 * (one - other).powi(2)
}

/// Returns the variance of X, Y or Z, from the samples of both passes.
pub(super) fn variance_of_sample(passes: [[[f64; 3]; TRIALS]; 2], c: usize) -> f64 {
    let [first, second] = passes.map(|[one, other]| half_square(one[c], other[c]));
    0.5 * (first + second)
}

/// Returns the pixels of the tiles and the variance of a camera sample in each of them.
pub(super) fn sample_variances<'p>(
    [first, second]: &'p [SmallPass; 2],
    tiles: &'p [Vec<usize>],
) -> impl Iterator<Item = (usize, [f64; 3])> + use<'p> {
    let light = first.tiles.iter().flatten().zip(second.tiles.iter().flatten());
    tiles.iter().flatten().zip(light).map(|(&pixel, (first, second))| {
        (pixel, std::array::from_fn(|c| variance_of_sample([first.samples, second.samples], c)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_small_film_and_spread_over_a_large_one() {
        let mut small: Vec<usize> = tiles((9, 7)).concat();
        small.sort_unstable();
        assert!(small.windows(2).all(|pair| pair[0] < pair[1]) && small.len() > 40, "{}", small.len());
        let large = tiles((640, 360));
        assert!(large.len() > 120 && large.iter().all(|tile| tile.len() == TILE * TILE));
        let in_quarter = |left: bool, top: bool| {
            let corners = large.iter().map(|tile| (tile[0] % 640 < 320, tile[0] / 640 < 180));
            corners.filter(|&corner| corner == (left, top)).count()
        };
        assert!(
            [(true, true), (true, false), (false, true), (false, false)].iter().all(|&(l, t)| in_quarter(l, t) > 24)
        );
    }
}
