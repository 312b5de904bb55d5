//! Mixtures of BSDFs. Each path samples one component of the mixture.

use super::Bsdf;
use super::sample::BsdfClass;
use crate::texture::{LookupRandom, ScalarTexture, SurfaceScalar, TexturePoint};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::random::ONE_MINUS_ULP;

/// A weighted mixture of BSDFs. Each path scatters at one component. The probability of a component
/// is its normalised weight.
#[derive(Debug, Clone, PartialEq)]
pub struct MixBsdf {
    components: Vec<Bsdf>,
    /// Cumulative normalised weights; the last entry is 1. If weights vary over the surface, these
    /// weights stand for them.
    cumulative: Vec<f64>,
    /// The choice of the component at a point. `None` if no weight varies over the surface.
    choice: Option<Choice>,
    /// True if a weight or a component varies over the surface.
    textured: bool,
    /// The widest class among the components.
    class: BsdfClass,
}

/// The choice of a component at a point of a surface.
#[derive(Debug, Clone, PartialEq)]
enum Choice {
    /// The component of this index.
    Component(usize),
    /// One of several choices, in proportion to their weights.
    Weighted(Vec<(SurfaceScalar, Self)>),
    /// One of several levels of roughness, in rising order. If the roughness lies between two
    /// levels, one of them is chosen at random. The expected level equals the roughness.
    Levels {
        roughness: ScalarTexture,
        /// The roughness of the first level.
        first: f64,
        /// The difference between two levels.
        step: f64,
        /// The components of the levels.
        levels: Vec<Self>,
    },
}

/// The number of levels into which the range of roughness from 0 to 1 is divided.
const ROUGHNESS_LEVELS: f64 = 32.0;

impl MixBsdf {
    /// Creates a mixture. Each of the `parts` consists of a weight ≥ 0 and a BSDF. The weights are
    /// normalised. Nested mixtures are flattened, and parts of weight 0 are dropped.
    ///
    /// # Errors
    /// Returns an error if a weight is negative or not finite, or no weight is positive.
    pub fn new(parts: Vec<(f64, Bsdf)>) -> Result<Self> {
        Self::textured(parts.into_iter().map(|(weight, bsdf)| (SurfaceScalar::Uniform(weight), bsdf)).collect())
    }

    /// Creates a mixture whose weights may vary over the surface. The weights are normalised at
    /// each point. If all weights are 0 at a point, the first part is chosen.
    ///
    /// # Errors
    /// Returns an error if a weight is negative or not finite, or no weight is positive.
    pub fn textured(parts: Vec<(SurfaceScalar, Bsdf)>) -> Result<Self> {
        let bad = parts.iter().map(|(weight, _)| weight.range()).find(|(low, high)| !(*low >= 0.0 && high.is_finite()));
        if let Some((low, high)) = bad {
            let bad = if low >= 0.0 { high } else { low };
            return Err(Error::input(format!("a mixture weight of {bad}")).expected("a number from 0 up"));
        }
        let parts: Vec<(SurfaceScalar, Bsdf)> =
            parts.into_iter().filter(|(weight, _)| weight.range().1 > 0.0).collect();
        let total: f64 = parts.iter().map(|(weight, _)| weight.mean()).sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(Error::input("a mixture without a positive weight").expected("at least one positive weight"));
        }
        let varies = parts
            .iter()
            .any(|(weight, bsdf)| weight.is_textured() || matches!(bsdf, Bsdf::Mix(MixBsdf { choice: Some(_), .. })));
        let (mut components, mut weights, mut choices) = (Vec::new(), Vec::new(), Vec::new());
        for (weight, bsdf) in parts {
            let mean = weight.mean() / total;
            choices.push((weight, add_part(bsdf, mean, &mut components, &mut weights)));
        }
        Ok(Self::of_components(components, &weights, varies.then_some(Choice::Weighted(choices))))
    }

    /// Creates a BSDF whose roughness varies over the surface. It is a mixture of BSDFs at 33
    /// levels of roughness from 0 to 1. At a point, only the two levels next to the local roughness
    /// are chosen. `of_roughness` creates the BSDF of a level.
    ///
    /// # Errors
    /// Returns an error if the roughness lies outside \[0, 1\] at any point, or if `of_roughness`
    /// returns one.
    pub fn of_roughness(roughness: ScalarTexture, of_roughness: impl Fn(f64) -> Result<Bsdf>) -> Result<Self> {
        let (low, high) = roughness.range();
        if !(low >= 0.0 && high <= 1.0) {
            let bad = if low >= 0.0 { high } else { low };
            return Err(Error::input(format!("a roughness of {bad}")).expected("numbers from 0 to 1"));
        }
        let first = (low * ROUGHNESS_LEVELS).floor();
        let count = (high * ROUGHNESS_LEVELS).ceil() - first + 1.0;
        let step = ROUGHNESS_LEVELS.recip();
        let (mut components, mut weights, mut levels) = (Vec::new(), Vec::new(), Vec::new());
        for level in 0..count as u32 {
            let bsdf = of_roughness((first + f64::from(level)) * step)?;
            levels.push(add_part(bsdf, count.recip(), &mut components, &mut weights));
        }
        let choice = Choice::Levels { roughness, first: first * step, step, levels };
        Ok(Self::of_components(components, &weights, Some(choice)))
    }

    fn of_components(components: Vec<Bsdf>, weights: &[f64], choice: Option<Choice>) -> Self {
        let mut sum = 0.0;
        let mut cumulative: Vec<f64> = weights
            .iter()
            .map(|weight| {
                sum += weight;
                sum
            })
            .collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        let class = components.iter().map(Bsdf::class).max().unwrap_or(BsdfClass::Absorbing);
        let textured = choice.is_some() || components.iter().any(Bsdf::is_textured);
        Self { components, cumulative, choice, textured, class }
    }

    /// Returns the widest class among the components.
    pub(super) fn class(&self) -> BsdfClass {
        self.class
    }

    /// Returns the components. No component is itself a mixture.
    pub(super) fn components(&self) -> &[Bsdf] {
        &self.components
    }

    /// Returns true if a weight or a component varies over the surface.
    pub(super) fn is_textured(&self) -> bool {
        self.textured
    }

    /// Returns the mixture with each texture replaced by a uniform value that stands for it.
    pub(super) fn without_textures(self) -> Self {
        let weights: Vec<f64> = self.weights().collect();
        let components = self.components.into_iter().map(Bsdf::without_textures).collect();
        Self::of_components(components, &weights, None)
    }

    /// Returns the mixture with each component replaced. The replacements are no mixtures.
    pub(super) fn with_components(self, replace: impl Fn(Bsdf) -> Result<Bsdf>) -> Result<Self> {
        let components = self.components.into_iter().map(replace).collect::<Result<_>>()?;
        Ok(Self { components, ..self })
    }

    /// Iterates over the components. The caller must not replace a component by a mixture.
    pub(super) fn components_mut(&mut self) -> impl Iterator<Item = &mut Bsdf> {
        self.components.iter_mut()
    }

    /// Iterates over the components, each with its normalised weight.
    pub(super) fn weighted_components(&self) -> impl Iterator<Item = (f64, &Bsdf)> {
        self.weights().zip(&self.components)
    }

    fn weights(&self) -> impl Iterator<Item = f64> {
        (0..self.cumulative.len()).map(|i| self.cumulative[i] - self.start(i))
    }

    fn start(&self, component: usize) -> f64 {
        if component == 0 { 0.0 } else { self.cumulative[component - 1] }
    }

    /// Returns the component selected by `u` in \[0, 1).
    pub(super) fn sample_component(&self, mut u: f64) -> &Bsdf {
        &self.components[self.sample_index(&mut u)]
    }

    /// Selects a component at a point.
    pub(super) fn component_at(&self, point: &TexturePoint, random: &mut LookupRandom) -> &Bsdf {
        match &self.choice {
            Some(choice) => &self.components[choice.at(point, random)],
            None => self.sample_component(random.uniform()),
        }
    }

    /// Selects a component by the random number `u` in \[0, 1), and returns the index of the
    /// component. Rescales `u` to \[0, 1), so that `u` can be used again.
    pub(super) fn sample_index(&self, u: &mut f64) -> usize {
        let component = self.cumulative.partition_point(|sum| *sum <= *u).min(self.components.len() - 1);
        let start = self.start(component);
        let stretched = (*u - start) / (self.cumulative[component] - start);
        *u = stretched.clamp(0.0, ONE_MINUS_ULP);
        component
    }
}

/// Adds the components of a part to the lists of a mixture. `weight` is the normalised weight of
/// the part. Returns the choice of a component of the part.
fn add_part(bsdf: Bsdf, weight: f64, components: &mut Vec<Bsdf>, weights: &mut Vec<f64>) -> Choice {
    let first = components.len();
    let Bsdf::Mix(inner) = bsdf else {
        weights.push(weight);
        components.push(bsdf);
        return Choice::Component(first);
    };
    let inner_weights: Vec<f64> = inner.weights().collect();
    weights.extend(inner_weights.iter().map(|inner_weight| weight * inner_weight));
    components.extend(inner.components);
    let by_weight = || {
        let part = |(i, weight)| (SurfaceScalar::Uniform(weight), Choice::Component(i));
        Choice::Weighted((0..).zip(inner_weights).map(part).collect())
    };
    inner.choice.unwrap_or_else(by_weight).shifted(first)
}

impl Choice {
    /// Adds `first` to the indices of all components.
    fn shifted(self, first: usize) -> Self {
        match self {
            Self::Component(index) => Self::Component(index + first),
            Self::Weighted(parts) => {
                Self::Weighted(parts.into_iter().map(|(weight, part)| (weight, part.shifted(first))).collect())
            }
            Self::Levels { roughness, first: lowest, step, levels } => {
                let levels = levels.into_iter().map(|level| level.shifted(first)).collect();
                Self::Levels { roughness, first: lowest, step, levels }
            }
        }
    }

    /// Returns the index of the component that is selected at a point.
    fn at(&self, point: &TexturePoint, random: &mut LookupRandom) -> usize {
        match self {
            Self::Component(index) => *index,
            Self::Weighted(parts) => {
                // One texel of each weight is selected, by the same random numbers. Weights from
                // the same picture therefore refer to the same texel. A part is chosen with the
                // probability of its share of these weights.
                let of_texel = random.clone();
                *random = LookupRandom::new(random.uniform());
                let mut chosen = &parts[0].1;
                let mut total = 0.0;
                for (weight, part) in parts {
                    let weight = weight.sample(point, &mut of_texel.clone());
                    total += weight;
                    if random.uniform() * total < weight {
                        chosen = part;
                    }
                }
                chosen.at(point, random)
            }
            Self::Levels { roughness, first, step, levels } => {
                let level = ((roughness.sample(point, random) - first) / step).max(0.0);
                let index = level as usize + usize::from(random.uniform() < level.fract());
                levels[index.min(levels.len() - 1)].at(point, random)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{Filter, ImagePattern, ImageSize, UvTransform, Wrap};
    use abbe_spectra::spectrum::Spectrum;

    fn grey(reflectance: f64) -> Bsdf {
        Bsdf::diffuse(Spectrum::constant(reflectance)).unwrap()
    }

    #[test]
    fn weights_must_be_numbers_from_0_up_and_one_must_be_positive() {
        for weights in [vec![], vec![0.0], vec![1.0, -1.0], vec![f64::NAN], vec![f64::INFINITY]] {
            let parts = weights.iter().map(|&weight| (weight, Bsdf::Absorber)).collect();
            assert!(MixBsdf::new(parts).is_err(), "{weights:?}");
        }
    }

    #[test]
    fn nested_mixtures_are_flattened() {
        let inner = Bsdf::mix(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
        let mix = MixBsdf::new(vec![(2.0, grey(0.3)), (0.0, grey(0.9)), (2.0, inner)]).unwrap();
        assert_eq!(mix.components(), &[grey(0.3), grey(0.1), grey(0.2)]);
        assert_eq!(mix.weights().collect::<Vec<_>>(), [0.5, 0.125, 0.375]);
    }

    /// `sample_index` selects components by weight and rescales the random number.
    #[test]
    fn sampling_follows_the_weights_and_reuses_the_number() {
        let mix = MixBsdf::new(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
        for (u, component, rest) in [(0.0, 0, 0.0), (0.125, 0, 0.5), (0.25, 1, 0.0), (0.625, 1, 0.5)] {
            let mut number = u;
            assert_eq!((mix.sample_index(&mut number), number), (component, rest), "u = {u}");
        }
        let mut last = ONE_MINUS_ULP;
        assert_eq!(mix.sample_index(&mut last), 1);
        assert!(last < 1.0);
    }

    fn picture(values: &[f32]) -> ScalarTexture {
        let size = ImageSize { width: values.len(), height: 1 };
        let pattern = ImagePattern::new(size, [Wrap::Clamp; 2], Filter::Nearest, UvTransform::IDENTITY).unwrap();
        ScalarTexture::from_values(pattern, values.to_vec())
    }

    /// Returns how often each component is selected at a point.
    fn frequencies(mix: &MixBsdf, u: f64) -> Vec<f64> {
        let (mut counts, mut random, point) =
            (vec![0.0; mix.components.len()], LookupRandom::new(0.6), TexturePoint::new([u, 0.5]));
        for _ in 0..40_000 {
            let found = mix.component_at(&point, &mut random);
            counts[mix.components.iter().position(|component| component == found).unwrap()] += 1.0 / 40_000.0;
        }
        counts
    }

    fn close(found: &[f64], expected: &[f64]) -> bool {
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01)
    }

    /// The weights of a textured mixture are normalised at each point, also for a nested mixture.
    #[test]
    fn textured_weights_select_components_at_each_point() {
        let inner = Bsdf::mix(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
        let weight = SurfaceScalar::Textured(picture(&[0.0, 1.0, 3.0]));
        let mix = MixBsdf::textured(vec![(weight, inner), (SurfaceScalar::Uniform(1.0), grey(0.3))]).unwrap();
        for (u, expected) in [(0.1, [0.0, 0.0, 1.0]), (0.5, [0.125, 0.375, 0.5]), (0.9, [0.1875, 0.5625, 0.25])] {
            let found = frequencies(&mix, u);
            assert!(close(&found, &expected), "{u}: {found:?}");
        }
    }

    /// Between two levels of roughness, the mean of the selected levels is the roughness.
    #[test]
    fn textured_roughness_selects_the_neighbouring_levels() {
        let mix = MixBsdf::of_roughness(picture(&[0.25, 0.335]), |roughness| Ok(grey(roughness))).unwrap();
        assert_eq!(mix.components, [8.0, 9.0, 10.0, 11.0].map(|level| grey(level / 32.0)));
        assert!(close(&frequencies(&mix, 0.2), &[1.0, 0.0, 0.0, 0.0]));
        let found = frequencies(&mix, 0.8);
        assert!(close(&found, &[0.0, 0.0, 0.28, 0.72]), "{found:?}");
        assert!(MixBsdf::of_roughness(picture(&[0.5, 1.5]), |roughness| Ok(grey(roughness))).is_err());
    }
}
