//! Denoises a ramp of brightness with noise of 20 %, and prints the error before and after.
//!
//!     cargo run -p abbe-denoise --example denoise_a_ramp

use abbe_denoise::{Feature, GROUPS, Samples, denoise};

const WIDTH: usize = 64;
const HEIGHT: usize = 32;

/// The brightness of a pixel without noise.
fn truth(pixel: usize) -> f32 {
    1.0 + (pixel % WIDTH) as f32 / WIDTH as f32
}

/// The brightness in a replicate, with uniform noise.
fn noisy(pixel: usize, replicate: usize) -> f32 {
    let hash = (pixel * 8 + replicate) as u64;
    let hash = hash.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let uniform = ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f32 / (1 << 24) as f32;
    truth(pixel) * (1.0 + 0.2 * 12_f32.sqrt() * (uniform - 0.5))
}

fn main() {
    let y: [Vec<f32>; 8] = std::array::from_fn(|r| (0..WIDTH * HEIGHT).map(|pixel| noisy(pixel, r)).collect());
    let grey: [Vec<f32>; GROUPS] =
        std::array::from_fn(|g| y[g].iter().zip(&y[g + GROUPS]).map(|(a, b)| 0.5 * (a + b)).collect());
    let features = std::array::from_fn(|_| vec![Feature::NONE; WIDTH * HEIGHT]);
    let rms = |value: &dyn Fn(usize) -> f32| {
        let squares = (0..WIDTH * HEIGHT).map(|pixel| (value(pixel) / truth(pixel) - 1.0).powi(2));
        100.0 * (squares.sum::<f32>() / (WIDTH * HEIGHT) as f32).sqrt()
    };
    let before = rms(&|pixel| y.iter().map(|plane| plane[pixel]).sum::<f32>() / 8.0);
    let samples =
        Samples { width: WIDTH, height: HEIGHT, passes: [1; 8], x: grey.clone(), y: y.clone(), z: grey, features };
    let denoised = denoise(&samples);
    println!("error before: {before:.2} %, denoised: {:.2} %", rms(&|pixel| denoised.xyz[pixel][1]));
}
