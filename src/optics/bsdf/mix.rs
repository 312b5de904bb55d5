//! Mixtures of BSDFs. Each path samples one component of the mixture.

use super::Bsdf;
use super::sample::BsdfClass;
use crate::error::{Error, Result};
use crate::math::random::ONE_MINUS_ULP;

/// A weighted mixture of BSDFs. Each path scatters at one component. The probability of a component
/// is its normalised weight.
#[derive(Debug, Clone, PartialEq)]
pub struct MixBsdf {
    components: Vec<Bsdf>,
    /// Cumulative normalised weights; the last entry is 1.
    cumulative: Vec<f64>,
    /// The widest class among the components.
    class: BsdfClass,
}

impl MixBsdf {
    /// Creates a mixture. Each of the `parts` consists of a weight ≥ 0 and a BSDF. The weights are
    /// normalised. Nested mixtures are flattened, and parts of weight 0 are dropped.
    ///
    /// # Errors
    /// Returns an error if a weight is negative or not finite, or no weight is positive.
    pub fn new(parts: Vec<(f64, Bsdf)>) -> Result<Self> {
        if let Some((bad, _)) = parts.iter().find(|(weight, _)| !(weight.is_finite() && *weight >= 0.0)) {
            return Err(Error::input(format!("a mixture weight of {bad}")).expected("a number from 0 up"));
        }
        let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(Error::input("a mixture without a positive weight").expected("at least one positive weight"));
        }
        let (mut components, mut weights) = (Vec::new(), Vec::new());
        for (weight, bsdf) in parts.into_iter().filter(|(weight, _)| *weight > 0.0) {
            if let Bsdf::Mix(inner) = bsdf {
                for (i, inner_weight) in inner.weights().enumerate() {
                    weights.push(weight / total * inner_weight);
                    components.push(inner.components[i].clone());
                }
            } else {
                weights.push(weight / total);
                components.push(bsdf);
            }
        }
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
        Ok(Self { components, cumulative, class })
    }

    /// Returns the widest class among the components.
    pub(super) fn class(&self) -> BsdfClass {
        self.class
    }

    /// Returns the components. No component is itself a mixture.
    pub(super) fn components(&self) -> &[Bsdf] {
        &self.components
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Spectrum;

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
}
