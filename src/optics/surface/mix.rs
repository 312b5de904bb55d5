//! Several surfaces in one place, by chance.

use super::Surface;
use crate::error::{Error, Result};

/// A weighted mixture: each path meets one of the components, with probability equal to its share of the weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Mix {
    components: Vec<Surface>,
    /// Running sums of the shares; the last is 1.
    cumulative: Vec<f64>,
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
        Ok(Self { components, cumulative })
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

    /// Draws a component's number by `u` in \[0, 1), and stretches `u` back to \[0, 1).
    pub(super) fn draw(&self, u: &mut f64) -> usize {
        let component = self.cumulative.partition_point(|sum| *sum <= *u).min(self.components.len() - 1);
        let start = self.start(component);
        let stretched = (*u - start) / (self.cumulative[component] - start);
        *u = stretched.clamp(0.0, 1.0 - f64::EPSILON / 2.0);
        component
    }
}
