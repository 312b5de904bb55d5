//! Tests with synthetic pictures, whose truth and noise are known.

use super::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 40;

/// Returns a number with the mean 0 and the variance 1 that depends only on its arguments.
fn noise(pixel: usize, replicate: usize, stream: usize) -> f32 {
    let mut state = (pixel as u64) << 32 ^ (replicate as u64) << 16 ^ stream as u64;
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    };
    // The sum of twelve uniform numbers has the variance 1.
    (0..12).map(|_| uniform()).sum::<f32>() - 6.0
}

/// Returns samples with one pass for each replicate. `xyz(pixel, replicate)` is its value.
fn samples(xyz: impl Fn(usize, usize) -> [f32; 3]) -> Samples {
    let count = WIDTH * HEIGHT;
    let group = |g: usize, c: usize| (0..count).map(|i| 0.5 * (xyz(i, g)[c] + xyz(i, g + GROUPS)[c])).collect();
    Samples {
        width: WIDTH,
        height: HEIGHT,
        passes: [1; REPLICATES],
        y: std::array::from_fn(|r| (0..count).map(|i| xyz(i, r)[1]).collect()),
        x: std::array::from_fn(|g| group(g, 0)),
        z: std::array::from_fn(|g| group(g, 2)),
        features: std::array::from_fn(|_| vec![Feature::NONE; count]),
    }
}

fn grey(y: impl Fn(usize, usize) -> f32) -> Samples {
    samples(|i, r| [y(i, r); 3])
}

fn original(samples: &Samples, i: usize) -> f32 {
    samples.y.iter().map(|plane| plane[i]).sum::<f32>() / REPLICATES as f32
}

/// Returns the RMS errors of the original and of the denoised picture over some pixels.
fn errors(samples: &Samples, denoised: &Denoised, truth: impl Fn(usize) -> f32, pixels: &[usize]) -> [f32; 2] {
    let rms = |of: &dyn Fn(usize) -> f32| {
        (pixels.iter().map(|&i| (of(i) - truth(i)).powi(2)).sum::<f32>() / pixels.len() as f32).sqrt()
    };
    [rms(&|i| original(samples, i)), rms(&|i| denoised.xyz[i][1])]
}

fn all() -> Vec<usize> {
    (0..WIDTH * HEIGHT).collect()
}

/// Returns the fraction of pixels whose 95 % interval contains the truth, by Student's t with nine
/// degrees of freedom.
fn covered(denoised: &Denoised, truth: impl Fn(usize) -> f32) -> f32 {
    let inside = |&i: &usize| {
        let half = (2.262 * denoised.noise[i]).max(denoised.bias[i] + 1.833 * denoised.noise[i]);
        (denoised.xyz[i][1] - truth(i)).abs() <= half
    };
    all().iter().filter(|i| inside(i)).count() as f32 / all().len() as f32
}

#[test]
fn independent_noise_on_a_wall_nearly_vanishes() {
    let samples = grey(|i, r| 2.0 + 0.4 * noise(i, r, 0));
    let denoised = denoise(&samples);
    let [before, after] = errors(&samples, &denoised, |_| 2.0, &all());
    assert!(after < before / 5.0, "{before} {after}");
    let covered = covered(&denoised, |_| 2.0);
    assert!(covered > 0.9, "{covered}");
    let mean_square = denoised.noise.iter().map(|noise| noise * noise).sum::<f32>() / denoised.noise.len() as f32;
    assert!((0.5..2.0).contains(&(mean_square.sqrt() / after)), "{} {after}", mean_square.sqrt());
    let bias = denoised.bias.iter().sum::<f32>() / denoised.bias.len() as f32;
    assert!(bias < before / 2.0, "the filter of a wall has no bias: {bias}");
}

/// Noise that all pixels share cannot be averaged away, and the error bars say so.
#[test]
fn noise_that_all_pixels_share_stays_in_the_bars() {
    let samples = grey(|_, r| 2.0 + 0.4 * noise(0, r, 1));
    let denoised = denoise(&samples);
    let shared = original(&samples, 0);
    assert!(denoised.xyz.iter().all(|xyz| (xyz[1] - shared).abs() < 1e-5));
    let values: [f32; REPLICATES] = std::array::from_fn(|r| samples.y[r][0]);
    let spread: f32 = values.iter().map(|value| (value - shared).powi(2)).sum();
    let known = (spread / (8.0 * 7.0)).sqrt();
    assert!(denoised.noise.iter().all(|noise| (noise / known - 1.0).abs() < 1e-3));
}

/// With one pass in each group, two replicates of each half are left. The pixels keep noise that
/// all share, and are cleaned of their own.
#[test]
fn four_passes_have_honest_error_bars() {
    let four = |y: &dyn Fn(usize, usize) -> f32| {
        let mut samples = grey(|i, r| if r < GROUPS { y(i, r) } else { 0.0 });
        samples.passes = std::array::from_fn(|r| u64::from(r < GROUPS));
        // The mean of a group is that of its only replicate.
        let planes: [Vec<f32>; GROUPS] = std::array::from_fn(|g| samples.y[g].clone());
        (samples.x, samples.z) = (planes.clone(), planes);
        samples
    };
    let samples = four(&|i, r| 2.0 + 0.4 * noise(i, r, 20));
    let denoised = denoise(&samples);
    let rms = (denoised.xyz.iter().map(|xyz| (xyz[1] - 2.0).powi(2)).sum::<f32>() / all().len() as f32).sqrt();
    assert!(rms < 0.2 / 4.0, "{rms} of 0.2");
    let samples = four(&|_, r| 2.0 + 0.4 * noise(0, r, 21));
    let denoised = denoise(&samples);
    let values: [f32; GROUPS] = std::array::from_fn(|r| samples.y[r][0]);
    let mean = values.iter().sum::<f32>() / 4.0;
    let known = (values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / (4.0 * 3.0)).sqrt();
    assert!(denoised.xyz.iter().all(|xyz| (xyz[1] - mean).abs() < 1e-5));
    assert!(denoised.noise.iter().all(|noise| (noise / known - 1.0).abs() < 1e-3), "{} {known}", denoised.noise[0]);
    assert!(!Samples::suffice([1, 1, 1, 0, 0, 0, 0, 0]) && Samples::suffice([1, 1, 0, 1, 0, 0, 1, 0]));
}

/// Blotches of eight pixels, as of photon maps, become smaller, and their error bars stay honest.
#[test]
fn blotches_are_averaged_over_more_than_their_size() {
    let blotch = |i: usize, r: usize| noise((i % WIDTH / 8) + 100 * (i / WIDTH / 8), r, 2);
    let samples = grey(|i, r| 2.0 + 0.4 * blotch(i, r));
    let denoised = denoise(&samples);
    let [before, after] = errors(&samples, &denoised, |_| 2.0, &all());
    assert!(after < before / 1.5, "{before} {after}");
    let covered = covered(&denoised, |_| 2.0);
    assert!(covered > 0.8, "{covered}");
}

#[test]
fn a_step_stays_a_step() {
    let truth = |i: usize| if i % WIDTH < WIDTH / 2 { 1.0 } else { 3.0 };
    let samples = grey(|i, r| truth(i) * (1.0 + 0.15 * noise(i, r, 3)));
    let denoised = denoise(&samples);
    let beside: Vec<usize> = all().into_iter().filter(|i| (i % WIDTH).abs_diff(WIDTH / 2) < 2).collect();
    let [before, after] = errors(&samples, &denoised, truth, &beside);
    assert!(after < before, "{before} {after}");
    let column = |x: usize| (0..HEIGHT).map(|y| denoised.xyz[y * WIDTH + x][1]).sum::<f32>() / HEIGHT as f32;
    assert!((column(WIDTH / 2 - 1) - 1.0).abs() < 0.04 && (column(WIDTH / 2) - 3.0).abs() < 0.12);
}

/// A caustic line of one pixel, which no feature shows, keeps its brightness and its width.
#[test]
fn a_line_of_one_pixel_keeps_its_width() {
    let truth = |i: usize| if i % WIDTH == 20 { 2.0 } else { 1.0 };
    let samples = grey(|i, r| truth(i) * (1.0 + 0.2 * noise(i, r, 4)));
    let denoised = denoise(&samples);
    let column = |x: usize| (0..HEIGHT).map(|y| denoised.xyz[y * WIDTH + x][1]).sum::<f32>() / HEIGHT as f32;
    let excess = |x: usize| column(x) - 1.0;
    assert!(excess(20) > 0.9, "{}", excess(20));
    assert!(excess(19).abs() < 0.06 && excess(21).abs() < 0.06, "{} {}", excess(19), excess(21));
}

/// A lamp that is a thousand times as bright as the room, whose edges lie within pixels, does not
/// tint the room, although its noise hides that the room is darker.
#[test]
fn a_small_bright_lamp_does_not_tint_the_room() {
    let cover = |i: usize, r: usize| {
        let (x, y) = ((i % WIDTH).abs_diff(24), (i / WIDTH).abs_diff(20));
        match x.max(y) {
            0 | 1 => 1.0,
            2 => (0.3 + 0.3 * noise(i, r, 12)).clamp(0.0, 1.0),
            _ => 0.0,
        }
    };
    let samples = samples(|i, r| {
        let (lamp, room) = (2000.0 * cover(i, r), 1.0 + 0.3 * noise(i, r, 13));
        [room + 1.4 * lamp, room + lamp, room + 0.2 * lamp]
    });
    let denoised = denoise(&samples);
    let of_room = all().into_iter().filter(|&i| (0..REPLICATES).all(|r| cover(i, r) == 0.0));
    for i in of_room {
        let [x, y, z] = denoised.xyz[i];
        assert!((x / y - 1.0).abs() < 0.05 && (z / y - 1.0).abs() < 0.05, "{}, {}: {x} {y} {z}", i % WIDTH, i / WIDTH);
    }
}

/// The albedo of the first surfaces is a checkerboard. The light on it is smooth.
#[test]
fn a_texture_in_the_albedo_stays_sharp() {
    let albedo = |i: usize| if (i % WIDTH + i / WIDTH).is_multiple_of(2) { 0.2 } else { 0.3 };
    let mut samples = grey(|i, r| albedo(i) * 2.0 * (1.0 + 0.3 * noise(i, r, 5)));
    for plane in &mut samples.features {
        plane.iter_mut().enumerate().for_each(|(i, feature)| feature.albedo = [albedo(i); 3]);
    }
    let denoised = denoise(&samples);
    let [before, after] = errors(&samples, &denoised, |i| 2.0 * albedo(i), &all());
    assert!(after < before / 4.0, "{before} {after}");
}

/// Surfaces with other normals are not averaged, even if their light is hidden by noise.
#[test]
fn surfaces_with_other_normals_are_kept_apart() {
    let left = |i: usize| i % WIDTH < WIDTH / 2;
    let truth = |i: usize| if left(i) { 1.0 } else { 1.3 };
    let mut samples = grey(|i, r| truth(i) + 0.6 * noise(i, r, 6));
    let without = denoise(&samples);
    for plane in &mut samples.features {
        let normal = |i: usize| if left(i) { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        plane.iter_mut().enumerate().for_each(|(i, feature)| feature.normal = normal(i));
    }
    let with = denoise(&samples);
    let beside: Vec<usize> = all().into_iter().filter(|i| (i % WIDTH).abs_diff(WIDTH / 2) < 3).collect();
    let [_, blurred] = errors(&samples, &without, truth, &beside);
    let [_, sharp] = errors(&samples, &with, truth, &beside);
    assert!(sharp < 0.7 * blurred, "{sharp} {blurred}");
}

/// A single very bright sample does not become a bright spot.
#[test]
fn a_single_bright_sample_does_not_become_a_spot() {
    let pixel = 20 * WIDTH + 20;
    let value = |i: usize, r: usize| if (i, r) == (pixel, 3) { 80.0 } else { 1.0 + 0.1 * noise(i, r, 7) };
    let samples = grey(value);
    let denoised = denoise(&samples);
    let [before, after] = errors(&samples, &denoised, |_| 1.0, &all());
    assert!(after < before, "{before} {after}");
    let around = all().into_iter().filter(|&i| i != pixel);
    let largest = around.map(|i| (denoised.xyz[i][1] - 1.0).abs()).fold(0.0, f32::max);
    assert!(largest < 0.3, "{largest}");
}

/// A single blue sample on a facet of 4 × 4 pixels does not colour the others, in whichever replicate
/// it is.
#[test]
fn a_single_coloured_sample_does_not_colour_its_facet() {
    let pixel = 21 * WIDTH + 21;
    let facet = |i: usize| i / WIDTH / 4 * WIDTH + i % WIDTH / 4;
    for replicate in 0..REPLICATES {
        let mut samples = samples(|i, r| {
            let white = [0, 1, 2].map(|c| 1.0 + 0.1 * noise(i, r, 21 + c));
            if (i, r) == (pixel, replicate) { [20.0, 1.2, 100.0] } else { white }
        });
        for plane in &mut samples.features {
            let normal = |i: usize| [0, 1, 2].map(|c| noise(facet(i), c, 24));
            plane.iter_mut().enumerate().for_each(|(i, feature)| feature.normal = normal(i));
        }
        let denoised = denoise(&samples);
        let excess = |i: usize| (denoised.xyz[i][2] / denoised.xyz[i][1] - 1.0).abs();
        let largest = all().into_iter().filter(|&i| i != pixel).map(excess).fold(0.0, f32::max);
        assert!(largest < 0.3, "{replicate}: {largest}");
    }
}

/// Clouds of colour are averaged although the luminance has details of one pixel.
#[test]
fn colours_are_averaged_across_details_of_luminance() {
    let truth = |i: usize| 1.0 + 2.0 * noise(i, 0, 30).abs();
    let samples = samples(|i, r| {
        let y = truth(i) * (1.0 + 0.01 * noise(i, r, 8));
        [y * (1.0 + 0.3 * noise(i, r, 9)), y, y * (1.0 + 0.3 * noise(i, r, 10))]
    });
    let denoised = denoise(&samples);
    let rms = |c: usize| {
        let ratio = |i: usize| denoised.xyz[i][c] / denoised.xyz[i][1] - 1.0;
        (all().iter().map(|&i| ratio(i).powi(2)).sum::<f32>() / all().len() as f32).sqrt()
    };
    let before = 0.3 / (REPLICATES as f32).sqrt();
    assert!(rms(0) < before / 4.0 && rms(2) < before / 4.0, "{} {} {before}", rms(0), rms(2));
    let [_, after] = errors(&samples, &denoised, truth, &all());
    assert!(after < 0.02, "the luminance stays: {after}");
}

/// Two neighbouring colours of equal luminance stay apart.
#[test]
fn an_edge_between_colours_of_equal_luminance_stays() {
    let x_of = |i: usize| if i % WIDTH < WIDTH / 2 { 1.0 } else { 1.5 };
    let samples = samples(|i, r| {
        let shared = 1.0 + 0.1 * noise(i, r, 11);
        [shared * x_of(i) * (1.0 + 0.05 * noise(i, r, 12)), shared, shared]
    });
    let denoised = denoise(&samples);
    let column = |x: usize| (0..HEIGHT).map(|y| denoised.xyz[y * WIDTH + x][0]).sum::<f32>() / HEIGHT as f32;
    assert!((column(WIDTH / 2 - 1) - 1.0).abs() < 0.05 && (column(WIDTH / 2) - 1.5).abs() < 0.05);
}

/// The replicates with more passes count more, so a wall without noise keeps the mean of all
/// passes.
#[test]
fn passes_weight_the_replicates() {
    let mut samples = grey(|_, r| 1.0 + r as f32);
    samples.passes = [3, 3, 2, 2, 2, 2, 2, 2];
    let known: f32 = samples.passes.iter().enumerate().map(|(r, n)| *n as f32 * (1.0 + r as f32)).sum::<f32>() / 18.0;
    let denoised = denoise(&samples);
    assert!(denoised.xyz.iter().all(|xyz| (xyz[1] - known).abs() < 1e-5), "{known} {:?}", denoised.xyz[0]);
}

#[test]
fn a_dark_picture_is_dark_and_finite() {
    let denoised = denoise(&grey(|_, _| 0.0));
    assert!(denoised.xyz.iter().all(|xyz| *xyz == [0.0; 3]));
    assert!(denoised.noise.iter().chain(&denoised.bias).all(|error| *error == 0.0));
}

#[test]
fn small_pictures_are_denoised() {
    for (width, height) in [(1, 1), (1, 7), (3, 1), (2, 5)] {
        let whole = grey(|i, r| 1.0 + 0.1 * noise(i, r, 13));
        let count = width * height;
        let cut = |plane: &Vec<f32>| plane[..count].to_vec();
        let samples = Samples {
            width,
            height,
            passes: whole.passes,
            y: whole.y.each_ref().map(cut),
            x: whole.x.each_ref().map(cut),
            z: whole.z.each_ref().map(cut),
            features: std::array::from_fn(|_| vec![Feature::NONE; count]),
        };
        let denoised = denoise(&samples);
        assert!(denoised.xyz.len() == count && denoised.xyz.iter().flatten().all(|value| value.is_finite()));
    }
}

#[test]
fn strips_and_threads_do_not_change_the_bits() {
    const HIGH: usize = 5 * MARGIN_ROWS;
    let plane = |r: usize| (0..8 * HIGH).map(|i| 1.0 + 0.1 * noise(i, r, 14)).collect::<Vec<f32>>();
    let samples = Samples {
        width: 8,
        height: HIGH,
        passes: [1; REPLICATES],
        y: std::array::from_fn(plane),
        x: std::array::from_fn(plane),
        z: std::array::from_fn(plane),
        features: std::array::from_fn(|_| vec![Feature::NONE; 8 * HIGH]),
    };
    let known = whole(&samples);
    assert_eq!(in_strips(&samples, 2 * MARGIN_ROWS), known);
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(single.install(|| whole(&samples)), known);
}

/// Noise that all pixels share does not hide a small step, because it cancels in differences. The
/// other noise is removed up to the step.
#[test]
fn shared_noise_does_not_hide_a_step() {
    let step = |i: usize| if i % WIDTH < WIDTH / 2 { 1.0 } else { 1.1 };
    let samples = grey(|i, r| step(i) + 0.4 * noise(0, r, 15) + 0.03 * noise(i, r, 16));
    let shared = (0..REPLICATES).map(|r| 0.4 * noise(0, r, 15)).sum::<f32>() / REPLICATES as f32;
    let denoised = denoise(&samples);
    let beside: Vec<usize> = all().into_iter().filter(|i| (i % WIDTH).abs_diff(WIDTH / 2) < 5).collect();
    let [before, after] = errors(&samples, &denoised, |i| step(i) + shared, &beside);
    assert!(after < before / 2.0, "{before} {after}");
}

/// Returns the root mean square difference of pixels that are neighbours in a row.
fn roughness(of: impl Fn(usize) -> f32) -> f32 {
    let pairs = || all().into_iter().filter(|i| i % WIDTH > 0);
    (pairs().map(|i| (of(i) - of(i - 1)).powi(2)).sum::<f32>() / pairs().count() as f32).sqrt()
}

/// Facets that differ by a factor of three stay apart under rare samples that are a hundred times
/// as bright.
#[test]
fn rare_bright_samples_do_not_hide_facets() {
    let facet = |i: usize| if i % WIDTH < WIDTH / 2 { 0.3 } else { 1.0 };
    let sparkle = |i: usize, r: usize| if noise(i, r, 3) > 2.6 { 100.0 } else { 0.0 };
    let denoised = denoise(&grey(|i, r| facet(i) * (1.0 + 0.02 * noise(i, r, 0)) + sparkle(i, r)));
    let median = |columns: std::ops::Range<usize>| {
        let inside = all().into_iter().filter(|i| columns.contains(&(i % WIDTH)));
        let mut y: Vec<f32> = inside.map(|i| denoised.xyz[i][1]).collect();
        y.sort_by(f32::total_cmp);
        y[y.len() / 2]
    };
    let (dark, bright) = (median(16..22), median(26..32));
    assert!(dark < 0.45 && bright > 1.0, "{dark} {bright}");
    let roughness = roughness(|i| denoised.xyz[i][1]);
    assert!(roughness < 0.11, "{roughness}");
}

/// A coloured patch that one pass brings has no pattern of dots.
#[test]
fn a_patch_of_colour_does_not_become_a_lattice() {
    let distance = |i: usize| ((i % WIDTH) as f32 - 24.0).hypot((i / WIDTH) as f32 - 20.0);
    let patch = |i: usize, r: usize| if r == 2 && distance(i) < 9.0 { 1.0 } else { 0.0 };
    let picture = samples(|i, r| {
        let y = 1.0 + 0.1 * noise(i, r, 0);
        [y + 0.03 * noise(i, r, 1) + patch(i, r), y + 0.3 * patch(i, r), y + 0.03 * noise(i, r, 2)]
    });
    let denoised = denoise(&picture);
    let roughness = roughness(|i| denoised.xyz[i][0] / denoised.xyz[i][1]);
    assert!(roughness < 0.006, "{roughness}");
}
