//! The pilot's trial: small passes that measure the variance and the work of photons and of camera
//! samples.
//!
//! The trial traces the photons of two small passes, and two camera samples per pixel in each of
//! them. The samples of a pixel in one pass differ by the noise of the camera samples. The passes
//! differ by the noise of the photons (analysis of variance with nested groups). The means of tiles
//! tell how much of the noise neighbouring pixels have in common.

use super::balance::{Variances, Work};
use super::context::{EmissionRequest, PassContext};
use super::pilot::Pilot;
use super::trace::trace_photons;
use crate::gather::{PathBuffers, PixelSampler};
use crate::map::LightMaps;
use crate::math::kronecker::golden_ratio;
use crate::math::parallel;
use crate::math::random::Purpose;
use crate::plan::partition::PerSet;
use crate::plan::{PathClass, Tally};
use crate::scene::Scene;
use crate::sensor::{Film, PixelSink, SplatSink};

/// The number of passes in the trial, and the number of camera samples per pixel in each pass.
const TRIALS: usize = 2;

/// The share of a pass's photon paths that one pass of the trial traces.
const PHOTON_SHARE: f64 = 1.0 / 16.0;

/// The least number of photon paths in one pass of the trial.
const MIN_PHOTONS: f64 = 4_000.0;

/// The trial samples square tiles of this many pixels in each direction.
const TILE: usize = 4;

/// The largest number of tiles.
const MOST_TILES: usize = 128;

/// The largest contribution of one tile to the variance, as a multiple of the mean over the tiles.
const LARGEST_TILE: f64 = 8.0;

/// The first pass number of the photons of the trial. The survey uses smaller numbers.
const FIRST_PHOTON_PASS: u64 = 1 << 32;

/// The number of light map cells along the longest side of a medium's box. The cells are coarser
/// than those of a pass.
const LIGHT_MAP_CELLS: u32 = 8;

/// Separates the camera samples of the trial from all other camera samples. The bytes of this
/// number are the word "trial" in ASCII.
const CAMERA_SEED_MASK: u64 = 0x0074_7269_616c;

/// The average numbers of instructions of the events of a pass. Callgrind measured them in
/// benches/scenes. The numbers for emission and for photons in media are times of these scenes and
/// of bodies of fog, in instructions of the average time.
mod instructions {
    pub(super) const EMITTED_PHOTON: f64 = 2_500.0;
    pub(super) const RAY: f64 = 2_700.0;
    pub(super) const STORED_PHOTON: f64 = 600.0;
    pub(super) const CONNECTION: f64 = 4_000.0;
    pub(super) const CAMERA_SAMPLE: f64 = 3_000.0;
    pub(super) const GATHERED_PHOTON: f64 = 700.0;
    pub(super) const TABULATED_PHOTON: f64 = 200.0;
    pub(super) const GATHERED_IN_MEDIUM: f64 = 5_000.0;
    pub(super) const PIXEL: f64 = 400.0;
}

/// X, Y and Z of a pixel in one pass of the trial, in W/m²/sr.
#[derive(Debug, Clone, Copy, Default)]
struct PixelLight {
    /// All light of each camera sample.
    samples: [[f64; 3]; TRIALS],
    /// The part of the samples that media scatter.
    media: [[f64; 3]; TRIALS],
    splats: [f64; 3],
}

/// One pass of the trial.
struct SmallPass {
    tiles: Vec<Vec<PixelLight>>,
    /// The splats of all pixels.
    splats: Vec<[f64; 3]>,
    /// The events of the photon paths.
    photon_tally: Tally,
    /// The events of the camera paths.
    camera_tally: Tally,
}

/// The mean of X, Y and Z in a tile, and their variances.
struct TileVariance {
    mean: [f64; 3],
    /// The part of the mean that comes from camera samples.
    mean_sampled: [f64; 3],
    /// The variance of the light that the photons of a pass on surfaces give.
    surfaces: [f64; 3],
    /// The variance of the light that the photons of a pass in media give.
    media: [f64; 3],
    /// The variance of a camera sample.
    camera: [f64; 3],
}

/// The mean of one part of the light of camera samples, and its variances.
struct SampleVariance {
    mean: [f64; 3],
    /// The variance of the light that the maps of a pass give.
    gathered: [f64; 3],
    /// The variance of a camera sample.
    camera: [f64; 3],
}

impl TileVariance {
    /// Computes the variances from the same pixels in both passes.
    fn of(first: &[PixelLight], second: &[PixelLight]) -> Self {
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
    /// Computes the variances of a part of the samples from the same pixels in both passes.
    fn of(first: &[PixelLight], second: &[PixelLight], part: fn(&PixelLight) -> [[f64; 3]; TRIALS]) -> Self {
        let mean = |[one, other]: [[f64; 3]; TRIALS], c: usize| 0.5 * (one[c] + other[c]);
        let within = |[one, other]: [[f64; 3]; TRIALS], c: usize| half_square(one[c], other[c]);
        let camera = mean_of_pixels(first, second, |a, b, c| 0.5 * (within(part(a), c) + within(part(b), c)));
        let between = mean_of_pixels(first, second, |a, b, c| half_square(mean(part(a), c), mean(part(b), c)));
        Self {
            mean: mean_of_pixels(first, second, |a, b, c| 0.5 * (mean(part(a), c) + mean(part(b), c))),
            // The mean of two camera samples has half of the variance of a sample.
            gathered: std::array::from_fn(|c| between[c] - 0.5 * camera[c]),
            camera,
        }
    }
}

impl PixelLight {
    /// Returns the mean of pixels.
    fn mean(pixels: &[Self]) -> Self {
        let share = 1.0 / pixels.len() as f64;
        let mut mean = Self::default();
        for pixel in pixels {
            for c in 0..3 {
                mean.splats[c] += share * pixel.splats[c];
                for nth in 0..TRIALS {
                    mean.samples[nth][c] += share * pixel.samples[nth][c];
                    mean.media[nth][c] += share * pixel.media[nth][c];
                }
            }
        }
        mean
    }
}

/// Returns the variance of two values, estimated from their difference.
fn half_square(one: f64, other: f64) -> f64 {
    0.5 * (one - other).powi(2)
}

/// Returns the mean of a value over pairs of equal pixels, for X, Y and Z.
fn mean_of_pixels(
    first: &[PixelLight],
    second: &[PixelLight],
    value: impl Fn(&PixelLight, &PixelLight, usize) -> f64,
) -> [f64; 3] {
    let sum = |c: usize| first.iter().zip(second).map(|(one, other)| value(one, other, c)).sum::<f64>();
    std::array::from_fn(|c| sum(c) / first.len() as f64)
}

/// Measures the variance and the work of a pass.
pub(super) fn run_trial(context: &PassContext<'_>, scene: &Scene, pilot: &Pilot) -> ([Variances; 3], Work) {
    let (width, pixels) = (scene.camera.width(), scene.camera.pixel_count());
    let tiles = tiles((width, pixels / width));
    let all = pilot.photons.free + pilot.photons.shared;
    let share = PHOTON_SHARE.max(MIN_PHOTONS / all as f64).min(1.0);
    let counts = PerSet::from_fn(|set| (pilot.photons[set] as f64 * share) as u64);
    let mut light_maps = LightMaps::default();
    if context.plan.media_plan.has_light_maps() {
        light_maps.update(scene, LIGHT_MAP_CELLS, context.budget.seed, 0);
    }
    let trials = [0, 1].map(|number| SmallPass::run(context, scene, pilot, (number, counts), &light_maps, &tiles));
    let paths = (counts.free + counts.shared) as f64;
    let samples = (TRIALS * TRIALS * tiles.iter().map(Vec::len).sum::<usize>()) as f64;
    (variances(&trials, width, paths), work(&trials, paths, samples, pixels as f64))
}

impl SmallPass {
    /// Renders the tiles with few photons. `number` is the number of the pass, and `counts`
    /// contains the number of photon paths of each set.
    fn run<'a>(
        context: &PassContext<'a>,
        scene: &'a Scene,
        pilot: &'a Pilot,
        (number, counts): (u64, PerSet<u64>),
        light_maps: &'a LightMaps<'a>,
        tiles: &[Vec<usize>],
    ) -> Self {
        let PassContext { plan, budget, .. } = *context;
        let shared = context.shared_wavelengths(0);
        let observer = scene.film.observer;
        let blank = Film::new(1, 1, observer, 0);
        let traced = PerSet::from_fn(|set| {
            let pass = FIRST_PHOTON_PASS + 2 * number + set as u64;
            let (wavelengths, count) = (shared.sampling(set), counts[set]);
            let request = EmissionRequest { wavelengths, count, purpose: Purpose::Pilot, pass };
            let source = pilot.photon_source(context, scene, request);
            trace_photons(&source, plan, set, pilot.recording(set), || blank.splat_sink())
        });
        let mut splats = vec![[0.0; 3]; scene.camera.pixel_count()];
        let (mut photon_tally, mut camera_tally) = (Tally::default(), Tally::default());
        for set in [&traced.free, &traced.shared] {
            photon_tally.add(&set.tally);
            for (pixel, xyz) in set.splats.iter().flat_map(SplatSink::splats) {
                (0..3).for_each(|c| splats[pixel as usize][c] += f64::from(xyz[c]));
            }
        }
        let maps = PerSet { free: traced.free.deposits.into_maps(), shared: traced.shared.deposits.into_maps() };
        let selector = context.light_selector(scene);
        let camera_pass = pilot.camera_pass(context, (scene, &selector), (&maps, light_maps), shared);
        let sample = |pixel: usize, nth: usize, tally: &mut Tally| {
            let mut buffers = PathBuffers::default();
            let pass = number * TRIALS as u64 + nth as u64;
            let sampler = PixelSampler::new(budget.seed ^ CAMERA_SEED_MASK, pass, pixel as u64);
            PixelSink::measure_classes::<{ PathClass::NAMES.len() }>(observer, |sink| {
                camera_pass.sample(pixel as u64, sampler, &pilot.radii.of(pixel), &mut buffers, tally, sink);
            })
        };
        let measured: Vec<(Vec<PixelLight>, Tally)> = parallel::map(tiles.iter().collect(), |tile: &Vec<usize>| {
            let mut tally = Tally::default();
            let mut light = |pixel: usize| {
                let samples: [_; TRIALS] = std::array::from_fn(|nth| sample(pixel, nth, &mut tally));
                let sum = |classes: [[f64; 3]; PathClass::NAMES.len()]| {
                    std::array::from_fn(|c| classes.iter().map(|xyz| xyz[c]).sum::<f64>())
                };
                let media = samples.map(|classes| classes[PathClass::Volume.number()]);
                PixelLight { samples: samples.map(sum), media, splats: splats[pixel] }
            };
            (tile.iter().map(|&pixel| light(pixel)).collect(), tally)
        });
        measured.iter().for_each(|(_, tally)| camera_tally.add(tally));
        let tiles = measured.into_iter().map(|(pixels, _)| pixels).collect();
        Self { tiles, splats, photon_tally, camera_tally }
    }
}

/// Returns the pixels of tiles that are spread over the film.
fn tiles((width, height): (usize, usize)) -> Vec<Vec<usize>> {
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

/// The splats of a square block of pixels in both passes of the trial.
#[derive(Debug, Clone, Copy, Default)]
struct SplatBlock {
    pixels: f64,
    /// The sums over the pixels, for each pass.
    sums: [[f64; 3]; TRIALS],
    /// The sum of the variances of the pixels.
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

    /// Returns the mean of the pixels in a pass.
    fn mean(&self, pass: usize, c: usize) -> f64 {
        self.sums[pass][c] / self.pixels
    }
}

/// The mean to which a variance is relative.
#[derive(Debug, Clone, Copy)]
enum Reference {
    /// The mean of the block of pixels. The mean of the picture limits the weight of dark blocks.
    Block,
    /// The mean of the picture.
    Picture,
}

impl Reference {
    /// Returns the square by which a variance is divided.
    fn square(self, of_block: f64, of_picture: f64) -> f64 {
        let square = match self {
            Self::Block => of_block.powi(2) + 0.01 * of_picture.powi(2),
            Self::Picture => of_picture.powi(2),
        };
        square.max(f64::MIN_POSITIVE)
    }
}

/// Returns the mean of a value over X, Y and Z.
fn mean_of_components(value: impl Fn(usize) -> f64) -> f64 {
    (0..3).map(value).sum::<f64>() / 3.0
}

/// Returns three measures of the variance of the picture for one photon path and one camera sample:
/// the mean of the relative variances of the pixels, their variance relative to the mean of the
/// picture, and the mean of the relative variances of the means of square blocks. Camera samples
/// are known in some blocks, and splats are known in all of them. `photons` is the number of photon
/// paths in a pass of the trial.
fn variances(trials: &[SmallPass; 2], width: usize, photons: f64) -> [Variances; 3] {
    let pairs = || trials[0].tiles.iter().zip(&trials[1].tiles);
    let of_pixels: Vec<TileVariance> = pairs().map(|(first, second)| TileVariance::of(first, second)).collect();
    let of_means: Vec<TileVariance> = pairs()
        .map(|(first, second)| TileVariance::of(&[PixelLight::mean(first)], &[PixelLight::mean(second)]))
        .collect();
    let tiles = of_pixels.len() as f64;
    let blocks = SplatBlock::of_film([&trials[0].splats, &trials[1].splats], width);
    let mean_sampled: [f64; 3] =
        std::array::from_fn(|c| of_pixels.iter().map(|tile| tile.mean_sampled[c]).sum::<f64>() / tiles);
    let mean: [f64; 3] = std::array::from_fn(|c| {
        let splats: f64 = blocks.iter().map(|block| 0.5 * (block.sums[0][c] + block.sums[1][c])).sum();
        mean_sampled[c] + splats / trials[0].splats.len() as f64
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
            surfaces: of_part(|tile| tile.surfaces) * photons,
            media: of_part(|tile| tile.media) * photons,
            camera: of_part(|tile| tile.camera),
        }
    };
    let traced = |variance: fn(&SplatBlock, usize) -> f64, reference: Reference| {
        let of_block = |block: &SplatBlock, c: usize| 0.5 * (block.mean(0, c) + block.mean(1, c)) + mean_sampled[c];
        let relative = |block: &SplatBlock| {
            block.pixels * mean_of_components(|c| variance(block, c) / reference.square(of_block(block, c), mean[c]))
        };
        photons * blocks.iter().map(relative).sum::<f64>() / trials[0].splats.len() as f64
    };
    let of_pixel = |block: &SplatBlock, c: usize| block.variances[c] / block.pixels;
    let of_mean = |block: &SplatBlock, c: usize| half_square(block.mean(0, c), block.mean(1, c));
    [
        Variances { traced: traced(of_pixel, Reference::Block), ..sampled(&of_pixels, Reference::Block) },
        Variances { traced: traced(of_pixel, Reference::Picture), ..sampled(&of_pixels, Reference::Picture) },
        Variances { traced: traced(of_mean, Reference::Block), ..sampled(&of_means, Reference::Block) },
    ]
}

/// Returns the work of the parts of a pass. `paths` is the number of photon paths in a pass of the
/// trial, `samples` is the number of camera samples in the trial, and `pixels` is the number of
/// pixels of the film.
fn work(trials: &[SmallPass; 2], paths: f64, samples: f64, pixels: f64) -> Work {
    use instructions::*;
    let count = |of: fn(&SmallPass) -> u64| trials.iter().map(|trial| of(trial) as f64).sum::<f64>();
    let stored_in_media = count(|trial| trial.photon_tally.volume_points + trial.photon_tally.volume_beams);
    let trace = EMITTED_PHOTON * count(|trial| trial.photon_tally.photons)
        + RAY * count(|trial| trial.photon_tally.photon_segments)
        + CONNECTION * count(|trial| trial.photon_tally.connections);
    let rays = count(|trial| trial.camera_tally.camera_segments + trial.camera_tally.shadow_rays);
    let per_path = 1.0 / (paths * TRIALS as f64);
    let per_sample = pixels / samples;
    let surface = GATHERED_PHOTON * count(|trial| trial.camera_tally.gathered)
        + TABULATED_PHOTON * count(|trial| trial.camera_tally.tabulated);
    let medium = GATHERED_IN_MEDIUM * count(|trial| trial.camera_tally.volume_gathered);
    Work {
        pass: PIXEL * pixels,
        trace: trace * per_path,
        store_on_surfaces: STORED_PHOTON * count(|trial| trial.photon_tally.stored) * per_path,
        store_in_media: STORED_PHOTON * stored_in_media * per_path,
        sample: (CAMERA_SAMPLE * samples + RAY * rays) * per_sample,
        gather_on_surfaces: surface * per_sample / paths,
        gather_in_media: medium * per_sample / paths,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    /// Two passes with noise of known variance give these variances.
    #[test]
    fn nested_samples_separate_photon_noise_from_camera_noise() {
        const TILES: usize = 1000;
        let mut stream = Stream::new(1, Purpose::Pilot, 0, 0);
        // A uniform number in [−1, 1) has the variance 1/3.
        let mut noise = |amplitude: f64| amplitude * (2.0 * stream.uniform() - 1.0);
        let mut pass = || {
            let mut pixel = || {
                let (on_surfaces, in_media) = (noise(0.6), noise(0.5));
                let media = std::array::from_fn(|_| [0.5 + in_media; 3]);
                let samples = std::array::from_fn(|_| [2.0 + on_surfaces + in_media + noise(0.6); 3]);
                PixelLight { samples, media, splats: [1.0 + noise(0.9); 3] }
            };
            let tiles: Vec<Vec<PixelLight>> = (0..TILES).map(|_| (0..16).map(|_| pixel()).collect()).collect();
            let splats = tiles.iter().flatten().map(|pixel| pixel.splats).collect();
            SmallPass { tiles, splats, photon_tally: Tally::default(), camera_tally: Tally::default() }
        };
        let [_, of_picture, of_blocks] = variances(&[pass(), pass()], 100, 100.0);
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
