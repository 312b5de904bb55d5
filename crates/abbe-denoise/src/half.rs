//! One half of the replicates, which decides over the averages of the other half.

use crate::features::Surfaces;
use crate::planes::Size;
use crate::samples::Samples;
use crate::{GROUPS, REPLICATES};

/// The replicates of a half.
pub(crate) const OWN: usize = REPLICATES / 2;

/// The weights of independent means, as fractions of their passes. A mean without passes has the
/// weight 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spread<const N: usize> {
    pub(crate) weights: [f32; N],
    /// The number of means with passes, minus one.
    pub(crate) degrees: f32,
}

impl<const N: usize> Spread<N> {
    pub(crate) fn new(passes: [u64; N]) -> Self {
        let all: u64 = passes.iter().sum();
        let count = passes.iter().filter(|&&passes| passes > 0).count();
        Self { weights: passes.map(|passes| passes as f32 / all as f32), degrees: count as f32 - 1.0 }
    }

    #[inline]
    pub(crate) fn mean(&self, values: [f32; N]) -> f32 {
        let mut mean = 0.0;
        for (value, weight) in values.iter().zip(self.weights) {
            mean += weight * value;
        }
        mean
    }

    /// Returns the variance of the mean, from the spread of the values.
    #[inline]
    pub(crate) fn variance(&self, values: [f32; N]) -> f32 {
        let mean = self.mean(values);
        let mut spread = 0.0;
        for (value, weight) in values.iter().zip(self.weights) {
            spread += weight * (value - mean) * (value - mean);
        }
        spread / self.degrees
    }

    /// Returns the covariance of two means, from the values of the same replicates.
    pub(crate) fn covariance(&self, a: [f32; N], b: [f32; N]) -> f32 {
        let (mean_a, mean_b) = (self.mean(a), self.mean(b));
        let products = a.iter().zip(b).zip(self.weights).map(|((a, b), weight)| weight * (a - mean_a) * (b - mean_b));
        products.sum::<f32>() / self.degrees
    }

    pub(crate) fn variance_at(&self, planes: &[Vec<f32>; N], i: usize) -> f32 {
        self.variance(std::array::from_fn(|k| planes[k][i]))
    }
}

/// The planes that a level filters. All are divided by the albedo.
#[derive(Debug)]
pub(crate) struct Half {
    pub(crate) size: Size,
    pub(crate) replicates: Spread<OWN>,
    /// The weights of the other replicates.
    pub(crate) others: Spread<OWN>,
    pub(crate) groups: Spread<{ GROUPS / 2 }>,
    /// The weights of the other groups.
    pub(crate) other_groups: Spread<{ GROUPS / 2 }>,
    /// Y of the guiding replicates.
    pub(crate) guide: [Vec<f32>; OWN],
    /// X, Y and Z of the two guiding groups.
    pub(crate) guide_colour: [[Vec<f32>; 3]; GROUPS / 2],
    /// Y of the other replicates.
    pub(crate) luma: [Vec<f32>; OWN],
    /// X, Y and Z of the other groups, averaged more widely than Y of the replicates.
    pub(crate) colour: [[Vec<f32>; 3]; GROUPS / 2],
}

impl Half {
    pub(crate) fn new(samples: &Samples, surfaces: &Surfaces, half: usize) -> Self {
        let albedo = &surfaces.divisor;
        let divided = |plane: &[f32], c: usize| -> Vec<f32> {
            plane.iter().zip(albedo).map(|(value, albedo)| value / albedo[c]).collect()
        };
        let groups = |half: usize| {
            let passes = [half, half + 2].map(|g| samples.passes[g] + samples.passes[g + GROUPS]);
            Spread::new(passes)
        };
        let colour = |group: usize| {
            let pair = [group, group + GROUPS];
            let spread = Spread::new(pair.map(|r| samples.passes[r]));
            let [a, b] = pair.map(|r| &samples.y[r]);
            let y: Vec<f32> = a.iter().zip(b).map(|(a, b)| spread.mean([*a, *b])).collect();
            [divided(&samples.x[group], 0), divided(&y, 1), divided(&samples.z[group], 2)]
        };
        let other = 1 - half;
        Self {
            size: samples.size(),
            replicates: Spread::new(std::array::from_fn(|k| samples.passes[2 * k + half])),
            others: Spread::new(std::array::from_fn(|k| samples.passes[2 * k + other])),
            groups: groups(half),
            other_groups: groups(other),
            guide: std::array::from_fn(|k| divided(&samples.y[2 * k + half], 1)),
            guide_colour: [half, half + 2].map(colour),
            luma: std::array::from_fn(|k| divided(&samples.y[2 * k + other], 1)),
            colour: [other, other + 2].map(colour),
        }
    }

    /// Returns the same planes, all 0.
    pub(crate) fn blank(&self) -> Self {
        let zeros = || vec![0.0; self.size.count()];
        Self {
            guide: std::array::from_fn(|_| zeros()),
            guide_colour: std::array::from_fn(|_| std::array::from_fn(|_| zeros())),
            luma: std::array::from_fn(|_| zeros()),
            colour: std::array::from_fn(|_| std::array::from_fn(|_| zeros())),
            ..*self
        }
    }

    /// Yields all planes, each with the number of its weights: 0 for luma and 1 for chroma.
    pub(crate) fn planes(&self) -> impl Iterator<Item = (&[f32], usize)> {
        let luma = self.guide.iter().chain(&self.luma).map(|plane| (plane.as_slice(), 0));
        luma.chain(self.guide_colour.iter().chain(&self.colour).flatten().map(|plane| (plane.as_slice(), 1)))
    }

    pub(crate) fn planes_mut(&mut self) -> impl Iterator<Item = &mut Vec<f32>> {
        let Self { guide, guide_colour, luma, colour, .. } = self;
        guide.iter_mut().chain(luma).chain(guide_colour.iter_mut().chain(colour).flatten())
    }
}
