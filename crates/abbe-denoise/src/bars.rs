//! The mean of the two halves, the guard, and the error bars.

use crate::features::Demodulation;
use crate::half::{Half, OWN};
use crate::planes::{Size, mean_around};
use crate::samples::Samples;
use crate::{Denoised, GROUPS, REPLICATES};

pub(crate) fn combine(samples: &Samples, demodulation: &Demodulation, halves: &[Half; 2]) -> Denoised {
    let size = Size { width: samples.width, height: samples.height };
    let total: f32 = samples.passes.iter().map(|n| *n as f32).sum();
    let f: [f32; REPLICATES] = samples.passes.map(|n| n as f32 / total);
    let albedo = &demodulation.albedo;
    let var = |v: &[f32; REPLICATES]| {
        let mean: f32 = v.iter().zip(f).map(|(v, f)| f * v).sum();
        let spread: f32 = v.iter().zip(f).map(|(v, f)| f * (v - mean) * (v - mean)).sum();
        (mean, spread / (REPLICATES - 1) as f32)
    };
    let filtered = |i: usize| -> [f32; REPLICATES] {
        // The half with the number h holds the planes of the other replicates.
        std::array::from_fn(|r| halves[1 - r % 2].luma[r / 2][i] * albedo[i][1])
    };
    let raw = |i: usize| -> [f32; REPLICATES] { std::array::from_fn(|r| samples.y[r][i]) };
    let count = size.count();
    let mut own = vec![0.0; count];
    let mut gain = vec![0.0; count];
    for i in 0..count {
        let (a, b) = (filtered(i), raw(i));
        let d: [f32; REPLICATES] = std::array::from_fn(|r| a[r] - b[r]);
        let (dm, _) = var(&d);
        let (_, vb) = var(&b);
        let ((am, _), (bm, _)) = (var(&a), var(&b));
        let cov: f32 = (0..REPLICATES).map(|r| f[r] * (a[r] - am) * (b[r] - bm)).sum::<f32>() / 7.0;
        own[i] = vb - cov;
        gain[i] = dm * dm;
    }
    let (own, gain) = (mean_around(&own, size, 3, 1), mean_around(&gain, size, 3, 1));
    let guard = std::env::var("GUARD").map_or(true, |v| v != "0");
    let lambda: Vec<f32> =
        own.iter().zip(&gain).map(|(v, g)| if guard { (v.max(0.0) / g.max(1e-30)).min(1.0) } else { 1.0 }).collect();
    let (mut xyz, mut variance, mut square) = (Vec::new(), Vec::new(), Vec::new());
    let [even, odd] = samples.fractions_of_halves();
    for i in 0..count {
        let (a, b) = (filtered(i), raw(i));
        let l = lambda[i];
        let v: [f32; REPLICATES] = std::array::from_fn(|r| b[r] + l * (a[r] - b[r]));
        let (mean, noise) = var(&v);
        variance.push(noise);
        let of_half = |h: usize| (0..OWN).map(|k| f[2 * k + h] * (v[2 * k + h] - b[2 * k + h])).sum::<f32>();
        square.push((of_half(0) / even) * (of_half(1) / odd));
        let c: [f32; 3] = std::array::from_fn(|c| even * halves[1].colour[c][i] + odd * halves[0].colour[c][i]);
        let scale = if c[1] > 0.0 { mean / albedo[i][1] / c[1] } else { 1.0 };
        xyz.push([albedo[i][0] * c[0] * scale, mean, albedo[i][2] * c[2] * scale]);
        let _ = GROUPS;
    }
    let around = mean_around(&variance, size, 1, 1);
    let noise = variance.iter().zip(&around).map(|(own, around)| ((7.0 * own + 2.0 * around) / 9.0).sqrt()).collect();
    let bias = mean_around(&square, size, 2, 1).into_iter().map(|square| square.max(0.0).sqrt()).collect();
    Denoised { xyz, noise, bias }
}
