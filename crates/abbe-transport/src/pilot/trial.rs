//! The pilot's trial: small passes that measure the variance and the work of photons and of camera
//! samples. The trial traces the photons of two small passes, and two camera samples per pixel in
//! each. The samples of a pixel in one pass differ by the noise of the camera samples, and the
//! passes by that of the photons (analysis of variance with nested groups). The means of tiles tell
//! how much of the noise neighbouring pixels have in common.

use super::balance::{Balance, BalanceLimits, Variances};
use super::camera_samples::{FilmNoise, ProbedPixel};
use super::gathering::{Gathering, forces_final_gather};
use super::pass_size::PassSize;
use super::small_pass::{
    SmallPass, TILE, TRIALS, TrialPhotons, TrialPixel, half_square, mean_of_components, sample_light, sample_variances,
    tiles, variance_of_sample,
};
use super::work::{self, SampleWork, Work};
use crate::gather::{CameraPass, PathBuffers};
use crate::map::LightMaps;
use crate::pass::{CameraSamples, PassContext, PassParameters};
use crate::plan::Tally;
use crate::plan::partition::PerSet;
use abbe_scene::Scene;
use std::cell::{Cell, OnceCell};
use web_time::Instant;

/// The fraction of a pass's photon paths that one pass of the trial traces.
const PHOTON_FRACTION: f64 = 1.0 / 16.0;

/// The least number of photon paths in one pass of the trial.
const MIN_PHOTONS: f64 = 4_000.0;

/// The largest contribution of one tile to the variance, as a multiple of the mean over the tiles.
const LARGEST_TILE: f64 = 8.0;

/// The cells along the longest side of a medium's box; coarser than in a pass.
const LIGHT_MAP_CELLS: u32 = 8;

/// The least fraction of noise in the variance of neighbouring pixels.
const LEAST_FRACTION_OF_NOISE: f64 = 0.1;

/// Noise in tiles beyond this multiple of the variance around comes from rare bright samples.
const RARE_SAMPLES: f64 = 4.0;

/// The pass number of the camera samples that measure the noise of the pixels.
const PROBE_PASS: u64 = (TRIALS * TRIALS) as u64;

/// The mean of X, Y and Z in a tile, and their variances.
struct TileVariance {
    mean: [f64; 3],
    /// The part of the mean that comes from camera samples.
    mean_sampled: [f64; 3],
    /// The variance of the light that the photons of a pass on surfaces give.
    surfaces: [f64; 3],
    /// The variance of the light that the photons of a pass in media give.
    media: [f64; 3],
    camera: [f64; 3],
}

/// The mean of one part of the light of camera samples, and its variances.
struct SampleVariance {
    mean: [f64; 3],
    /// The variance of the light that the maps of a pass give.
    gathered: [f64; 3],
    camera: [f64; 3],
}

impl TileVariance {
    /// Returns the variances of the pixels of each tile, and of its mean.
    fn of_tiles([first, second]: [&[Vec<TrialPixel>]; 2]) -> [Vec<Self>; 2] {
        let pairs = || first.iter().zip(second);
        let of_pixels = pairs().map(|(first, second)| Self::of(first, second));
        let of_means = pairs().map(|(first, second)| Self::of(&[TrialPixel::mean(first)], &[TrialPixel::mean(second)]));
        [of_pixels.collect(), of_means.collect()]
    }

    /// Computes the variances from the same pixels in both passes.
    fn of(first: &[TrialPixel], second: &[TrialPixel]) -> Self {
        let all = SampleVariance::of(first, second, |pixel| pixel.samples);
        let media = SampleVariance::of(first, second, |pixel| pixel.media).gathered;
        let mean_splats = mean_of_pixels(first, second, |a, b, c| 0.5 * (a.splats[c] + b.splats[c]));
        Self {
            mean: std::array::from_fn(|c| all.mean[c] + mean_splats[c]),
            mean_sampled: all.mean,
            surfaces: std::array::from_fn(|c| all.gathered[c] - media[c]),
            media,
            camera: all.camera,
        }
    }
}

impl SampleVariance {
    fn of(first: &[TrialPixel], second: &[TrialPixel], part: fn(&TrialPixel) -> [[f64; 3]; TRIALS]) -> Self {
        let mean = |[one, other]: [[f64; 3]; TRIALS], c: usize| 0.5 * (one[c] + other[c]);
        let camera = mean_of_pixels(first, second, |a, b, c| variance_of_sample([part(a), part(b)], c));
        let between = mean_of_pixels(first, second, |a, b, c| half_square(mean(part(a), c), mean(part(b), c)));
        Self {
            mean: mean_of_pixels(first, second, |a, b, c| 0.5 * (mean(part(a), c) + mean(part(b), c))),
            // The mean of two camera samples has half of the variance of a sample.
            gathered: std::array::from_fn(|c| between[c] - 0.5 * camera[c]),
            camera,
        }
    }
}

/// Returns the mean of a value over pairs of equal pixels, for X, Y and Z.
fn mean_of_pixels(
    first: &[TrialPixel],
    second: &[TrialPixel],
    value: impl Fn(&TrialPixel, &TrialPixel, usize) -> f64,
) -> [f64; 3] {
    let sum = |c: usize| first.iter().zip(second).map(|(one, other)| value(one, other, c)).sum::<f64>();
    std::array::from_fn(|c| sum(c) / first.len() as f64)
}

/// What the trial chooses for all passes.
pub(super) struct Choice {
    pub(super) balance: Balance,
    pub(super) camera_samples: CameraSamples,
    /// True if camera paths gather indirect photons behind the first diffuse surface.
    pub(super) final_gather: bool,
    /// The largest work of a pass in instructions, if it changed the choice.
    pub(super) largest_work: Option<f64>,
}

/// Divides the work of a pass between photons and camera samples, and chooses where camera paths
/// gather photons, and the camera samples of each pixel: all the same if different numbers would
/// gain little.
pub(super) fn balanced(
    context: &PassContext<'_>,
    scene: &Scene,
    parameters: &PassParameters,
    (limits, size): (BalanceLimits, PassSize),
) -> Choice {
    let start = Instant::now();
    let (width, pixels) = (scene.camera.width(), scene.camera.pixel_count());
    let tiles = tiles((width, pixels / width));
    let all = parameters.photons.free + parameters.photons.shared;
    let fraction = PHOTON_FRACTION.max(MIN_PHOTONS / all as f64).min(1.0);
    let counts = PerSet::from_fn(|set| (parameters.photons[set] as f64 * fraction) as u64);
    let mut light_maps = LightMaps::default();
    if context.plan.media_plan.has_light_maps() {
        light_maps.update(scene, LIGHT_MAP_CELLS, context.budget.seed, 0);
    }
    let selector = context.light_selector(scene);
    let traced = [0, 1].map(|number| TrialPhotons::trace(context, scene, parameters, (number, counts)));
    let splats = traced.each_ref().map(|traced| traced.splats.as_slice());
    let painted = traced.each_ref().map(|traced| traced.painted.as_slice());
    let photons = traced.iter().map(|traced| traced.tally).sum();
    let paths = (counts.free + counts.shared) as f64;
    let (largest_work, is_limited) = (OnceCell::new(), Cell::new(false));
    let choose = |variances: [Variances; 3], work: Work, largest: f64| {
        let choice = if limits.is_fixed() { limits.plain() } else { limits.choose(variances, work) };
        if choice.work(work) <= largest {
            return choice;
        }
        is_limited.set(true);
        limits.choose_within(variances, work, largest)
    };
    let measured = |final_gather: bool| {
        let camera_passes = traced.each_ref().map(|traced| {
            let maps = (&traced.maps, &light_maps);
            let plain = parameters.camera_pass(context, (scene, &selector), maps, context.shared_wavelengths(0));
            CameraPass { final_gather, ..plain }
        });
        let passes = [0, 1].map(|n| SmallPass::run(context, parameters, &traced[n], &camera_passes[n], &tiles));
        let of_tiles = TileVariance::of_tiles(passes.each_ref().map(|pass| pass.tiles.as_slice()));
        let samples = passes.iter().map(|pass| pass.tally).sum();
        let variances = variances(&of_tiles, splats, painted, width, paths);
        let work = Work::of_trial(&photons, &samples, paths, pixels as f64);
        let measure = || size.largest_work(|| work::of_events(&photons, &samples) / start.elapsed().as_secs_f64());
        let balance = choose(variances, work, *largest_work.get_or_init(measure));
        Gathering { camera_passes, passes, variances, work, balance }
    };
    let gathering = if forces_final_gather(context) {
        measured(true)
    } else {
        let in_place = measured(false);
        let behind = context.plan.indirect.may_gather_behind().then(|| measured(true));
        behind.filter(|behind| behind.improves_on(&in_place, &tiles)).unwrap_or(in_place)
    };
    let final_gather = gathering.is_behind();
    let Gathering { camera_passes, passes, variances, work, balance } = gathering;
    let probe = |pixels: &[usize]| {
        let mut buffers = PathBuffers::default();
        let of_pixel = |&pixel: &usize| {
            let mut tally = Tally::default();
            let classes =
                sample_light(context, parameters, &camera_passes[1], (PROBE_PASS, pixel), &mut buffers, &mut tally);
            ProbedPixel {
                sample: std::array::from_fn(|c| classes.iter().map(|xyz| xyz[c]).sum()),
                splats: std::array::from_fn(|c| 0.5 * (splats[0][pixel][c] + splats[1][pixel][c])),
                work: SampleWork::of(&tally).with_photons(fraction.recip()),
            }
        };
        pixels.iter().map(of_pixel).collect()
    };
    let is_free = limits.camera_samples.is_none() && balance.has_noisy_samples(variances);
    let noise = is_free.then(|| film_noise((width, pixels / width), probe, (&passes, &tiles))).flatten();
    let samples = noise.map_or(CameraSamples::Same(balance.camera_samples), |noise| {
        let choices = noise.choices(balance.camera_samples);
        noise.samples(balance.choose_samples(variances, work, &choices))
    });
    let largest_work = largest_work.into_inner().filter(|_| is_limited.get());
    Choice { balance, camera_samples: samples, final_gather, largest_work }
}

/// Measures the noise of camera samples on the film by `probe`, which samples some pixels, and
/// `passes`, the light of `tiles`.
///
/// The samples of neighbouring pixels differ by noise and by details of the picture. The tiles have
/// several samples of the same pixel, so they tell which fraction of the variance is noise. If this
/// is much more than 1, rare bright samples, which the few samples around a pixel do not show,
/// cause most of the noise. The result is then `None`, as for a film of few pixels.
fn film_noise(
    size: (usize, usize),
    probe: impl Fn(&[usize]) -> Vec<ProbedPixel> + Sync,
    (passes, tiles): (&[SmallPass; 2], &[Vec<usize>]),
) -> Option<FilmNoise> {
    let noise = FilmNoise::measure(size, probe)?;
    let fraction = noise.ratio_of(sample_variances(passes, tiles));
    (fraction <= RARE_SAMPLES).then(|| noise.scaled(fraction.max(LEAST_FRACTION_OF_NOISE)))
}

/// The splats of a square block of pixels in both passes of the trial.
#[derive(Debug, Clone, Copy, Default)]
struct SplatBlock {
    pixels: f64,
    /// The sums over the pixels, for each pass.
    sums: [[f64; 3]; TRIALS],
    variances: [f64; 3],
}

impl SplatBlock {
    /// Divides the film into blocks of [`TILE`] × [`TILE`] pixels.
    fn of_film([first, second]: [&[[f64; 3]]; 2], width: usize) -> Vec<Self> {
        let columns = width.div_ceil(TILE);
        let mut blocks = vec![Self::default(); columns * (first.len() / width).div_ceil(TILE)];
        for (pixel, (first, second)) in first.iter().zip(second).enumerate() {
            let block = &mut blocks[pixel / width / TILE * columns + pixel % width / TILE];
            block.pixels += 1.0;
            for c in 0..3 {
                block.sums[0][c] += first[c];
                block.sums[1][c] += second[c];
                block.variances[c] += half_square(first[c], second[c]);
            }
        }
        blocks
    }

    fn mean(&self, pass: usize, c: usize) -> f64 {
        self.sums[pass][c] / self.pixels
    }
}

/// The mean to which a variance is relative.
#[derive(Debug, Clone, Copy)]
enum Reference {
    /// The mean of the block of pixels. The mean of the picture limits the weight of dark blocks.
    Block,
    Picture,
}

impl Reference {
    fn square(self, of_block: f64, of_picture: f64) -> f64 {
        let square = match self {
            Self::Block => of_block.powi(2) + 0.01 * of_picture.powi(2),
            Self::Picture => of_picture.powi(2),
        };
        square.max(f64::MIN_POSITIVE)
    }
}

/// Measures the variance of the picture for one photon path and one camera sample: the mean of the
/// relative variances of the pixels, their variance relative to the mean of the picture, and the
/// mean of the relative variances of the means of square blocks. Camera samples are known in some
/// blocks, splats in all; `painted` is the part of them that ribbons paint. `photons` is the number
/// of paths in a pass of the trial.
fn variances(
    [of_pixels, of_means]: &[Vec<TileVariance>; 2],
    splats: [&[[f64; 3]]; 2],
    painted: [&[[f64; 3]]; 2],
    width: usize,
    photons: f64,
) -> [Variances; 3] {
    let tiles = of_pixels.len() as f64;
    let pixels = splats[0].len() as f64;
    let blocks = SplatBlock::of_film(splats, width);
    let painted_blocks = SplatBlock::of_film(painted, width);
    let mean_sampled: [f64; 3] =
        std::array::from_fn(|c| of_pixels.iter().map(|tile| tile.mean_sampled[c]).sum::<f64>() / tiles);
    let mean: [f64; 3] = std::array::from_fn(|c| {
        let splats: f64 = blocks.iter().map(|block| 0.5 * (block.sums[0][c] + block.sums[1][c])).sum();
        mean_sampled[c] + splats / pixels
    });
    let sampled = |variances: &[TileVariance], reference: Reference| {
        let of_part = |part: fn(&TileVariance) -> [f64; 3]| {
            let relative =
                |tile: &TileVariance| mean_of_components(|c| part(tile)[c] / reference.square(tile.mean[c], mean[c]));
            let values: Vec<f64> = variances.iter().map(relative).collect();
            let limit = LARGEST_TILE * values.iter().map(|value| value.max(0.0)).sum::<f64>() / tiles;
            (values.iter().map(|value| value.min(limit)).sum::<f64>() / tiles).max(0.0)
        };
        Variances {
            traced: 0.0,
            ribbons: 0.0,
            surfaces: of_part(|tile| tile.surfaces) * photons,
            media: of_part(|tile| tile.media) * photons,
            camera: of_part(|tile| tile.camera),
        }
    };
    // The splats of ribbons and the others have independent noise, because they are different paths.
    let of_splats = |variance: fn(&SplatBlock, usize) -> f64, reference: Reference| {
        let square = |block: &SplatBlock, c: usize| {
            reference.square(0.5 * (block.mean(0, c) + block.mean(1, c)) + mean_sampled[c], mean[c])
        };
        let sum_of = |parts: &[SplatBlock]| {
            let relative = |(part, block): (&SplatBlock, &SplatBlock)| {
                block.pixels * mean_of_components(|c| variance(part, c) / square(block, c))
            };
            photons * parts.iter().zip(&blocks).map(relative).sum::<f64>() / pixels
        };
        let (all, ribbons) = (sum_of(&blocks), sum_of(&painted_blocks));
        ((all - ribbons).max(0.0), ribbons)
    };
    let of_pixel = |block: &SplatBlock, c: usize| block.variances[c] / block.pixels;
    let of_mean = |block: &SplatBlock, c: usize| half_square(block.mean(0, c), block.mean(1, c));
    let with_splats = |variances: Variances, (traced, ribbons): (f64, f64)| Variances { traced, ribbons, ..variances };
    [
        with_splats(sampled(of_pixels, Reference::Block), of_splats(of_pixel, Reference::Block)),
        with_splats(sampled(of_pixels, Reference::Picture), of_splats(of_pixel, Reference::Picture)),
        with_splats(sampled(of_means, Reference::Block), of_splats(of_mean, Reference::Block)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};

    #[test]
    fn nested_samples_separate_photon_noise_from_camera_noise() {
        const TILES: usize = 1000;
        let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
        // A uniform number in [−1, 1) has the variance 1/3.
        let mut noise = |amplitude: f64| amplitude * (2.0 * stream.uniform() - 1.0);
        let mut pass = || {
            let mut pixel = || {
                let (on_surfaces, in_media) = (noise(0.6), noise(0.5));
                let media = std::array::from_fn(|_| [0.5 + in_media; 3]);
                let samples = std::array::from_fn(|_| [2.0 + on_surfaces + in_media + noise(0.6); 3]);
                TrialPixel { samples, media, splats: [1.0 + noise(0.9); 3] }
            };
            (0..TILES).map(|_| (0..16).map(|_| pixel()).collect()).collect()
        };
        let passes: [Vec<Vec<TrialPixel>>; 2] = [pass(), pass()];
        let splats =
            passes.each_ref().map(|tiles| tiles.iter().flatten().map(|pixel| pixel.splats).collect::<Vec<_>>());
        let of_tiles = TileVariance::of_tiles(passes.each_ref().map(Vec::as_slice));
        let [_, of_picture, of_blocks] =
            variances(&of_tiles, splats.each_ref().map(Vec::as_slice), [&[]; 2], 100, 100.0);
        let expected = |amplitude: f64| amplitude * amplitude / 3.0 / 9.0;
        for (found, in_blocks, expected) in [
            (of_picture.camera, of_blocks.camera, expected(0.6)),
            (of_picture.surfaces / 100.0, of_blocks.surfaces / 100.0, expected(0.6)),
            (of_picture.media / 100.0, of_blocks.media / 100.0, expected(0.5)),
            (of_picture.traced / 100.0, of_blocks.traced / 100.0, expected(0.9)),
        ] {
            assert!((found / expected - 1.0).abs() < 0.1, "{found} instead of {expected}");
            // The noise of the pixels is independent, so the mean of 16 pixels has a 16th of it.
            assert!((16.0 * in_blocks / expected - 1.0).abs() < 0.3, "{in_blocks} instead of {expected}/16");
        }
    }
}
