//! The pilot's trial: small passes that measure the variance and the work of photons and of camera
//! samples.
//!
//! The trial traces the photons of two small passes, and two camera samples per pixel in each of
//! them. The samples of a pixel in one pass differ by the noise of the camera samples. The passes
//! differ by the noise of the photons (analysis of variance with nested groups).

use super::balance::{Variances, Work};
use super::context::{EmissionRequest, PassContext};
use super::pilot::Pilot;
use super::trace::trace_photons;
use crate::gather::{PathBuffers, PixelSampler};
use crate::map::LightMaps;
use crate::math::kronecker::golden_ratio;
use crate::math::parallel;
use crate::math::random::Purpose;
use crate::plan::Tally;
use crate::plan::partition::PerSet;
use crate::scene::Scene;
use crate::sensor::{Film, SplatSink};

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
/// benches/scenes.
mod instructions {
    pub(super) const RAY: f64 = 2_700.0;
    pub(super) const STORED_PHOTON: f64 = 600.0;
    pub(super) const CONNECTION: f64 = 4_000.0;
    pub(super) const CAMERA_SAMPLE: f64 = 3_000.0;
    pub(super) const GATHERED_PHOTON: f64 = 700.0;
    pub(super) const TABULATED_PHOTON: f64 = 200.0;
    pub(super) const GATHERED_IN_MEDIUM: f64 = 12_000.0;
    pub(super) const PIXEL: f64 = 400.0;
}

/// X, Y and Z of a pixel in one pass of the trial, in W/m²/sr.
#[derive(Debug, Clone, Copy, Default)]
struct PixelLight {
    samples: [[f64; 3]; TRIALS],
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
    /// The part of the mean that comes from splats.
    mean_splats: [f64; 3],
    /// The variance of the splats of a pass.
    splats: [f64; 3],
    /// The variance of the light that the maps of a pass give.
    gathered: [f64; 3],
    /// The variance of a camera sample.
    camera: [f64; 3],
}

impl TileVariance {
    /// Computes the variances from the same pixels in both passes.
    fn of(first: &[PixelLight], second: &[PixelLight]) -> Self {
        let half_square = |one: f64, other: f64| 0.5 * (one - other).powi(2);
        let gathered = |pixel: &PixelLight, c: usize| 0.5 * (pixel.samples[0][c] + pixel.samples[1][c]);
        let between_samples = |pixel: &PixelLight, c: usize| half_square(pixel.samples[0][c], pixel.samples[1][c]);
        let camera = mean_of_pixels(first, second, |a, b, c| 0.5 * (between_samples(a, c) + between_samples(b, c)));
        let between = mean_of_pixels(first, second, |a, b, c| half_square(gathered(a, c), gathered(b, c)));
        let mean_gathered = mean_of_pixels(first, second, |a, b, c| 0.5 * (gathered(a, c) + gathered(b, c)));
        let mean_splats = mean_of_pixels(first, second, |a, b, c| 0.5 * (a.splats[c] + b.splats[c]));
        let splats = mean_of_pixels(first, second, |a, b, c| half_square(a.splats[c], b.splats[c]));
        Self {
            mean: std::array::from_fn(|c| mean_gathered[c] + mean_splats[c]),
            mean_splats,
            splats,
            // The mean of two camera samples has half of the variance of a sample.
            gathered: std::array::from_fn(|c| between[c] - 0.5 * camera[c]),
            camera,
        }
    }
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
pub(super) fn run_trial(context: &PassContext<'_>, scene: &Scene, pilot: &Pilot) -> ([Variances; 2], Work) {
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
    (variances(&trials, paths), work(&trials, paths, samples, pixels as f64))
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
            Film::measure(observer, |sink| {
                camera_pass.sample(pixel as u64, sampler, &pilot.radii.of(pixel), &mut buffers, tally, sink);
            })
        };
        let measured: Vec<(Vec<PixelLight>, Tally)> = parallel::map(tiles.iter().collect(), |tile: &Vec<usize>| {
            let mut tally = Tally::default();
            let mut light = |pixel: usize| PixelLight {
                samples: std::array::from_fn(|nth| sample(pixel, nth, &mut tally)),
                splats: splats[pixel],
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

/// Returns two measures of the variance of the picture for one photon path and one camera sample:
/// the mean of the relative variances of the tiles, and the variance relative to the mean of the
/// picture. `photons` is the number of photon paths in a pass of the trial.
fn variances(trials: &[SmallPass; 2], photons: f64) -> [Variances; 2] {
    let of_tiles: Vec<TileVariance> =
        trials[0].tiles.iter().zip(&trials[1].tiles).map(|(first, second)| TileVariance::of(first, second)).collect();
    let tiles = of_tiles.len() as f64;
    let mean: [f64; 3] = std::array::from_fn(|c| of_tiles.iter().map(|tile| tile.mean[c]).sum::<f64>() / tiles);
    let measure = |per_mean2: fn(&TileVariance, f64, usize) -> f64| {
        let of_part = |part: fn(&TileVariance) -> [f64; 3]| {
            let relative = |tile: &TileVariance| {
                (0..3).map(|c| part(tile)[c] / per_mean2(tile, mean[c], c).max(f64::MIN_POSITIVE)).sum::<f64>() / 3.0
            };
            let values: Vec<f64> = of_tiles.iter().map(relative).collect();
            let limit = LARGEST_TILE * values.iter().map(|value| value.max(0.0)).sum::<f64>() / tiles;
            (values.iter().map(|value| value.min(limit)).sum::<f64>() / tiles).max(0.0)
        };
        Variances {
            traced: of_part(|tile| tile.splats) * photons,
            stored: of_part(|tile| tile.gathered) * photons,
            camera: of_part(|tile| tile.camera),
        }
    };
    let of_tile = measure(|tile, mean, c| tile.mean[c].powi(2) + 0.01 * mean.powi(2));
    let mut of_picture = measure(|_, mean, _| mean.powi(2));
    // The splats of all pixels are known, so this measure does not depend on the choice of the
    // tiles.
    let [first, second] = [&trials[0].splats, &trials[1].splats];
    let pixels = first.len() as f64;
    let relative = |c: usize| {
        let (sum, squares) = first.iter().zip(second).fold((0.0, 0.0), |(sum, squares), (first, second)| {
            (sum + 0.5 * (first[c] + second[c]), squares + 0.5 * (first[c] - second[c]).powi(2))
        });
        let of_tiles: f64 = of_tiles.iter().map(|tile| tile.mean[c] - tile.mean_splats[c]).sum::<f64>() / tiles;
        squares / pixels / (of_tiles + sum / pixels).powi(2).max(f64::MIN_POSITIVE)
    };
    of_picture.traced = (0..3).map(relative).sum::<f64>() / 3.0 * photons;
    [of_tile, of_picture]
}

/// Returns the work of the parts of a pass. `paths` is the number of photon paths in a pass of the
/// trial, `samples` is the number of camera samples in the trial, and `pixels` is the number of
/// pixels of the film.
fn work(trials: &[SmallPass; 2], paths: f64, samples: f64, pixels: f64) -> Work {
    use instructions::*;
    let count = |of: fn(&SmallPass) -> u64| trials.iter().map(|trial| of(trial) as f64).sum::<f64>();
    let stored_in_media = count(|trial| trial.photon_tally.volume_points + trial.photon_tally.volume_beams);
    let trace = RAY * count(|trial| trial.photon_tally.photon_segments)
        + CONNECTION * count(|trial| trial.photon_tally.connections)
        + STORED_PHOTON * stored_in_media;
    let rays = count(|trial| trial.camera_tally.camera_segments + trial.camera_tally.shadow_rays);
    let per_path = 1.0 / (paths * TRIALS as f64);
    let per_sample = pixels / samples;
    let surface = GATHERED_PHOTON * count(|trial| trial.camera_tally.gathered)
        + TABULATED_PHOTON * count(|trial| trial.camera_tally.tabulated);
    let medium = GATHERED_IN_MEDIUM * count(|trial| trial.camera_tally.volume_gathered);
    Work {
        pass: PIXEL * pixels,
        trace: trace * per_path,
        store: STORED_PHOTON * count(|trial| trial.photon_tally.stored) * per_path,
        sample: (CAMERA_SAMPLE * samples + RAY * rays) * per_sample,
        surface: surface * per_sample / paths,
        medium: medium * per_sample / paths,
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
                let of_map = noise(0.3);
                let samples = std::array::from_fn(|_| [2.0 + of_map + noise(0.6); 3]);
                PixelLight { samples, splats: [1.0 + noise(0.9); 3] }
            };
            let tiles: Vec<Vec<PixelLight>> = (0..TILES).map(|_| (0..16).map(|_| pixel()).collect()).collect();
            let splats = tiles.iter().flatten().map(|pixel| pixel.splats).collect();
            SmallPass { tiles, splats, photon_tally: Tally::default(), camera_tally: Tally::default() }
        };
        let [_, of_picture] = variances(&[pass(), pass()], 100.0);
        let expected = |amplitude: f64| amplitude * amplitude / 3.0 / 9.0;
        for (found, expected) in [
            (of_picture.camera, expected(0.6)),
            (of_picture.stored / 100.0, expected(0.3)),
            (of_picture.traced / 100.0, expected(0.9)),
        ] {
            assert!((found / expected - 1.0).abs() < 0.1, "{found} instead of {expected}");
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
