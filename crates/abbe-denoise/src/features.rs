//! First surfaces: the albedo by which light is divided, and the edges that no average crosses.

use crate::planes::{by_rows, mean_around};
use crate::samples::{Feature, Samples};

/// Light is divided by the albedo of a surface, but at least by this fraction.
const LEAST_ALBEDO: f32 = 0.02;

/// The squared differences at which two surfaces are not averaged any more: that of the normals,
/// that of the albedos, and that of the binary logarithms of the distance.
const LARGEST_SQUARES: [f32; 3] = [0.25, 0.1, 0.01];

/// The distance may differ by this multiple of its slope.
const SLOPE_FACTOR: f32 = 2.0;

/// The first surfaces of a picture, with the noise that they have at edges and out of focus.
pub(crate) struct Surfaces {
    /// The albedo by which X, Y and Z are divided, so that textures stay sharp.
    pub(crate) divisor: Vec<[f32; 3]>,
    normal: [Vec<f32>; 3],
    albedo: [Vec<f32>; 3],
    log_depth: Vec<f32>,
    /// The smaller slope of the logarithm towards both sides, by column and by row.
    slope: [Vec<f32>; 2],
    /// The variances of the mean normal, of the mean albedo and of the mean logarithm.
    variances: [Vec<f32>; 3],
}

impl Surfaces {
    pub(crate) fn new(samples: &Samples) -> Self {
        let size = samples.size();
        let [even, odd] = &samples.features;
        let pairs = || even.iter().zip(odd);
        let mean = |of: &dyn Fn(&Feature) -> f32| -> Vec<f32> { pairs().map(|(a, b)| 0.5 * (of(a) + of(b))).collect() };
        let variance = |of: &dyn Fn(&Feature) -> [f32; 3]| {
            let square = |(a, b): (&f32, f32)| 0.25 * (a - b) * (a - b);
            let own: Vec<f32> = pairs().map(|(a, b)| of(a).iter().zip(of(b)).map(square).sum()).collect();
            mean_around(&own, size, 1, 1)
        };
        let albedo = [0, 1, 2].map(|c| mean(&|f| f.albedo[c]));
        let log_depth = mean(&|f| f.log_depth);
        let slope = [(1, 0), (0, 1)].map(|(dx, dy)| {
            by_rows(size, |y, row| {
                let at = |x: usize, y: usize| log_depth[y.min(size.height - 1) * size.width + x.min(size.width - 1)];
                for (x, slope) in row.iter_mut().enumerate() {
                    let before = (at(x, y) - at(x.saturating_sub(dx), y.saturating_sub(dy))).abs();
                    *slope = before.min((at(x + dx, y + dy) - at(x, y)).abs());
                }
            })
        });
        let divisor = |i: usize| [0, 1, 2].map(|c: usize| albedo[c][i].max(LEAST_ALBEDO));
        Self {
            divisor: (0..size.count()).map(divisor).collect(),
            normal: [0, 1, 2].map(|c| mean(&|f| f.normal[c])),
            albedo,
            slope,
            variances: [variance(&|f| f.normal), variance(&|f| f.albedo), variance(&|f| [f.log_depth, 0.0, 0.0])],
            log_depth,
        }
    }

    /// Writes how different the surfaces of the pixels from `p` on are from those from `q` on, for
    /// pairs with the offset `dx`, `dy`. At 1, they are not averaged any more.
    pub(crate) fn penalties(&self, (dx, dy): (isize, isize), (p, q): (usize, usize), penalties: &mut [f32]) {
        let (dx, dy) = (dx.unsigned_abs() as f32, dy.unsigned_abs() as f32);
        for (i, penalty) in penalties.iter_mut().enumerate() {
            let (p, q) = (p + i, q + i);
            let excess = |square: f32, number: usize| {
                let [of_p, of_q] = [p, q].map(|pixel| self.variances[number][pixel]);
                (square - of_p - of_q).max(0.0) / LARGEST_SQUARES[number]
            };
            let distance = |planes: &[Vec<f32>; 3]| {
                planes.iter().map(|plane| (plane[p] - plane[q]) * (plane[p] - plane[q])).sum::<f32>()
            };
            let slope = SLOPE_FACTOR * (self.slope[0][p] * dx + self.slope[1][p] * dy);
            let depth = ((self.log_depth[p] - self.log_depth[q]).abs() - slope).max(0.0);
            *penalty = excess(distance(&self.normal), 0) + excess(distance(&self.albedo), 1) + excess(depth * depth, 2);
        }
    }
}
