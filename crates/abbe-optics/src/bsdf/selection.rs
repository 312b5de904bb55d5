//! The selection of one component of a mixture.

use crate::texture::{LookupRandom, ScalarTexture, SurfaceScalar, TexturePoint};
use abbe_spectra::math::random::ONE_MINUS_ULP;

/// The probabilities with which the components of a mixture are selected, by their indices.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ComponentSelection {
    /// Cumulative normalised weights, the last of which is 1. They stand for weights that vary.
    cumulative: Vec<f64>,
    /// The choice of the component at a point, if weights vary over the surface.
    choice: Option<Choice>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Choice {
    /// The component of this index.
    Component(usize),
    /// One of several choices, in proportion to their weights.
    Weighted(Vec<(SurfaceScalar, Self)>),
    /// One of several levels of roughness, in rising order: at random one of the two next to the
    /// roughness, so that the expected level equals it.
    Levels { roughness: ScalarTexture, first: f64, step: f64, levels: Vec<Self> },
}

impl ComponentSelection {
    /// Creates the selection from normalised weights, and the choice at a point if they vary.
    pub(super) fn new(weights: &[f64], choice: Option<Choice>) -> Self {
        let sums = weights.iter().scan(0.0, |sum, weight| {
            *sum += weight;
            Some(*sum)
        });
        let mut cumulative: Vec<f64> = sums.collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        Self { cumulative, choice }
    }

    pub(super) fn varies(&self) -> bool {
        self.choice.is_some()
    }

    pub(super) fn weights(&self) -> impl Iterator<Item = f64> {
        (0..self.cumulative.len()).map(|i| self.cumulative[i] - self.start(i))
    }

    fn start(&self, component: usize) -> f64 {
        if component == 0 { 0.0 } else { self.cumulative[component - 1] }
    }

    /// Returns the choice at a point, which is by weight if no weight varies over the surface.
    pub(super) fn into_choice(self) -> Choice {
        let by_weight = || {
            let part = |(i, weight)| (SurfaceScalar::Uniform(weight), Choice::Component(i));
            Choice::Weighted((0..).zip(self.weights()).map(part).collect())
        };
        self.choice.clone().unwrap_or_else(by_weight)
    }

    /// Selects a component at a point, and returns its index.
    pub(super) fn at(&self, point: &TexturePoint, random: &mut LookupRandom) -> usize {
        match &self.choice {
            Some(choice) => choice.at(point, random),
            None => self.sample_index(&mut random.uniform()),
        }
    }

    /// Selects a component, and returns its index. Rescales `u` to \[0, 1) for further use.
    pub(super) fn sample_index(&self, u: &mut f64) -> usize {
        let component = self.cumulative.partition_point(|sum| *sum <= *u).min(self.cumulative.len() - 1);
        let start = self.start(component);
        let stretched = (*u - start) / (self.cumulative[component] - start);
        *u = stretched.clamp(0.0, ONE_MINUS_ULP);
        component
    }
}

impl Choice {
    /// Adds `first` to the indices of all components.
    pub(super) fn shifted(self, first: usize) -> Self {
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
                // The same random numbers select one texel of each weight, so weights from the same
                // picture refer to the same texel. A part is chosen in proportion to these weights.
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
