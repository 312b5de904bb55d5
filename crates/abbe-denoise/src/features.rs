//! First surfaces: the demodulation of textures, and the edges that no average crosses.

use crate::planes::{Size, mean_around};
use crate::samples::{Feature, Samples};

/// The albedo below which light is not divided by it any more.
const LEAST_ALBEDO: f32 = 0.02;

/// The factors that remove the texture of the first surfaces from X, Y and Z.
pub(crate) struct Demodulation {
    /// The albedo of each pixel.
    pub(crate) albedo: Vec<[f32; 3]>,
}

impl Demodulation {
    pub(crate) fn new(samples: &Samples) -> Self {
        let [even, odd] = &samples.features;
        let mean = |(a, b): (&Feature, &Feature)| {
            std::array::from_fn(|c| (0.5 * (a.albedo[c] + b.albedo[c])).max(LEAST_ALBEDO))
        };
        Self { albedo: even.iter().zip(odd).map(mean).collect() }
    }
}

/// The features that tell surfaces apart, with the noise of their own.
pub(crate) struct Surfaces {
    pub(crate) normal: [Vec<f32>; 3],
    pub(crate) albedo: [Vec<f32>; 3],
    pub(crate) depth: Vec<f32>,
    /// The slope of the depth by column and by row.
    pub(crate) slope: [Vec<f32>; 2],
    /// The variances of the normal, the albedo and the depth.
    pub(crate) variance: [Vec<f32>; 3],
}

impl Surfaces {
    pub(crate) fn new(samples: &Samples) -> Self {
        let size = Size { width: samples.width, height: samples.height };
        let [even, odd] = &samples.features;
        let pairs = || even.iter().zip(odd);
        let mean = |of: &dyn Fn(&Feature) -> f32| pairs().map(|(a, b)| 0.5 * (of(a) + of(b))).collect::<Vec<f32>>();
        let variance = |of: &dyn Fn(&Feature) -> [f32; 3]| {
            let own: Vec<f32> = pairs()
                .map(|(a, b)| of(a).iter().zip(of(b)).map(|(a, b)| 0.25 * (a - b) * (a - b)).sum::<f32>())
                .collect();
            mean_around(&own, size, 1, 1)
        };
        let depth = mean(&|f| f.log_depth);
        let slope = [1, size.width].map(|step| {
            let last = depth.len() - 1;
            (0..depth.len())
                .map(|i| {
                    let before = depth[i] - depth[i.saturating_sub(step)];
                    let after = depth[(i + step).min(last)] - depth[i];
                    if before.abs() < after.abs() { before.abs() } else { after.abs() }
                })
                .collect()
        });
        Self {
            normal: [0, 1, 2].map(|c| mean(&|f| f.normal[c])),
            albedo: [0, 1, 2].map(|c| mean(&|f| f.albedo[c])),
            variance: [variance(&|f| f.normal), variance(&|f| f.albedo), variance(&|f| [f.log_depth, 0.0, 0.0])],
            depth,
            slope,
        }
    }
}

impl Surfaces {
    /// Writes how different the surfaces of some pixels and their partners are, relative to the
    /// difference at which they are not averaged any more.
    pub(crate) fn penalties(&self, dx: isize, dy: isize, (p, q): (usize, usize), penalties: &mut [f32]) {
        let (dx, dy) = (dx.unsigned_abs() as f32, dy.unsigned_abs() as f32);
        for (i, penalty) in penalties.iter_mut().enumerate() {
            let (p, q) = (p + i, q + i);
            let vectors = |planes: &[Vec<f32>; 3], number: usize| {
                let square: f32 = planes.iter().map(|plane| (plane[p] - plane[q]) * (plane[p] - plane[q])).sum();
                (square - self.variance[number][p] - self.variance[number][q]).max(0.0)
            };
            let (normal, albedo) = (vectors(&self.normal, 0), vectors(&self.albedo, 1));
            let slope = 2.0 * (self.slope[0][p] * dx + self.slope[1][p] * dy);
            let depth = ((self.depth[p] - self.depth[q]).abs() - slope).max(0.0);
            let depth = (depth * depth - self.variance[2][p] - self.variance[2][q]).max(0.0);
            *penalty = normal / 0.25 + albedo / tune("SA", 0.1) + depth / 0.01;
        }
    }
}
fn tune(_: &str, default: f32) -> f32 { default }
