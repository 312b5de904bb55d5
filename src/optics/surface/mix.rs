//! Several surfaces in one place, by chance.

use super::{Class, Surface};
use crate::error::{Error, Result};
use crate::math::random::ONE_MINUS_ULP;

/// A weighted mixture: each path meets one of the components, with probability equal to its share of the weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Mix {
    components: Vec<Surface>,
    /// Running sums of the shares; the last is 1.
    cumulative: Vec<f64>,
    /// The widest of the components' classes.
    class: Class,
}

impl Mix {
    /// A mixture of `parts`, each a weight ≥ 0 (of which only the ratios count) and a surface; mixtures among them are taken apart and
    /// parts of weight 0 left out. Fails if a weight is negative or not finite, or if none is positive.
    pub fn new(parts: Vec<(f64, Surface)>) -> Result<Self> {
        if let Some((bad, _)) = parts.iter().find(|(weight, _)| !(weight.is_finite() && *weight >= 0.0)) {
            return Err(Error::input(format!("a mixture's weight of {bad}")).expected("a number from 0 up"));
        }
        let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(Error::input("a mixture without any weight").expected("at least one positive weight"));
        }
        let (mut components, mut shares) = (Vec::new(), Vec::new());
        for (weight, surface) in parts.into_iter().filter(|(weight, _)| *weight > 0.0) {
            if let Surface::Mix(inner) = surface {
                for (i, share) in inner.shares().enumerate() {
                    shares.push(weight / total * share);
                    components.push(inner.components[i].clone());
                }
            } else {
                shares.push(weight / total);
                components.push(surface);
            }
        }
        let mut sum = 0.0;
        let mut cumulative: Vec<f64> = shares
            .iter()
            .map(|share| {
                sum += share;
                sum
            })
            .collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        let class = components.iter().map(Surface::class).max().unwrap_or(Class::Absorbing);
        Ok(Self { components, cumulative, class })
    }

    /// How its components spread light: the widest of their classes.
    pub(super) fn class(&self) -> Class {
        self.class
    }

    /// The components, none of them a mixture.
    pub(super) fn components(&self) -> &[Surface] {
        &self.components
    }

    /// Each component's share and the component.
    pub(super) fn weighted(&self) -> impl Iterator<Item = (f64, &Surface)> {
        self.shares().zip(&self.components)
    }

    fn shares(&self) -> impl Iterator<Item = f64> {
        (0..self.cumulative.len()).map(|i| self.cumulative[i] - self.start(i))
    }

    fn start(&self, component: usize) -> f64 {
        if component == 0 { 0.0 } else { self.cumulative[component - 1] }
    }

    /// The component that `u` in \[0, 1) draws.
    pub(super) fn pick(&self, mut u: f64) -> &Surface {
        &self.components[self.draw(&mut u)]
    }

    /// Draws a component's number by `u` in \[0, 1), and stretches `u` back to \[0, 1).
    pub(super) fn draw(&self, u: &mut f64) -> usize {
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

    fn grey(reflectance: f64) -> Surface {
        Surface::diffuse(Spectrum::constant(reflectance)).unwrap()
    }

    #[test]
    fn weights_must_be_numbers_from_0_up_and_one_must_be_positive() {
        for weights in [vec![], vec![0.0], vec![1.0, -1.0], vec![f64::NAN], vec![f64::INFINITY]] {
            let parts = weights.iter().map(|&weight| (weight, Surface::Absorber)).collect();
            assert!(Mix::new(parts).is_err(), "{weights:?}");
        }
    }

    #[test]
    fn mixtures_in_mixtures_are_taken_apart() {
        let inner = Surface::mix(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
        let mix = Mix::new(vec![(2.0, grey(0.3)), (0.0, grey(0.9)), (2.0, inner)]).unwrap();
        assert_eq!(mix.components(), &[grey(0.3), grey(0.1), grey(0.2)]);
        assert_eq!(mix.shares().collect::<Vec<_>>(), [0.5, 0.125, 0.375]);
    }

    #[test]
    fn drawing_follows_the_shares_and_leaves_a_fresh_number() {
        let mix = Mix::new(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
        for (u, component, rest) in [(0.0, 0, 0.0), (0.125, 0, 0.5), (0.25, 1, 0.0), (0.625, 1, 0.5)] {
            let mut number = u;
            assert_eq!((mix.draw(&mut number), number), (component, rest), "u = {u}");
        }
        let mut last = ONE_MINUS_ULP;
        assert_eq!(mix.draw(&mut last), 1);
        assert!(last < 1.0);
    }
}
