//! Numbers that are uniform or vary over a surface.

use std::sync::Arc;

use super::pattern::Pattern;
use super::point::{LookupRandom, TexturePoint};
use super::pyramid::ImagePattern;

/// A number that varies over a surface. Copies share their texels.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarTexture {
    pattern: Pattern,
    values: Arc<[f32]>,
}

impl ScalarTexture {
    /// Creates the texture of a picture from the values of its pixels, row by row.
    pub fn from_values(pattern: ImagePattern, values: Vec<f32>) -> Self {
        let values = pattern.reduced(values, 1).into();
        Self { pattern: Pattern::Image(pattern), values }
    }

    /// Creates a texture with two values, the first of which belongs to the texel 0.
    pub fn from_pair(pattern: Pattern, values: [f64; 2]) -> Self {
        Self { pattern, values: values.map(|value| value as f32).into() }
    }

    /// Returns the value of a texel selected at a point, whose expectation is filtered.
    pub fn sample(&self, point: &TexturePoint, random: &mut LookupRandom) -> f64 {
        f64::from(self.values[self.pattern.texel(point, random) as usize])
    }

    /// Returns the interpolated value at a random point of the footprint.
    pub fn value_at(&self, point: &TexturePoint, random: &mut LookupRandom) -> f64 {
        self.pattern.interpolated(point, random, |texel| f64::from(self.values[texel]))
    }

    /// Returns the smallest and the largest value.
    pub fn range(&self) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        self.values.iter().map(|&value| f64::from(value)).fold(start, |(low, high), x| (low.min(x), high.max(x)))
    }

    /// Returns the mean of a picture or of a pattern.
    pub fn mean(&self) -> f64 {
        let value = |value: &f32| f64::from(*value);
        if let Pattern::Image(_) = self.pattern {
            return self.values.last().map_or(0.0, value);
        }
        self.values.iter().map(value).sum::<f64>() / self.values.len() as f64
    }

    /// Returns the memory of the texels in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.values)
    }
}

/// A number that is uniform or varies over a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceScalar {
    /// The same number at every point.
    Uniform(f64),
    /// A number for each texel.
    Textured(ScalarTexture),
}

impl SurfaceScalar {
    /// Returns the value of a texel that is selected at a point.
    pub fn sample(&self, point: &TexturePoint, random: &mut LookupRandom) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Textured(texture) => texture.sample(point, random),
        }
    }

    /// Returns the interpolated value at a random point of the footprint.
    pub fn value_at(&self, point: &TexturePoint, random: &mut LookupRandom) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Textured(texture) => texture.value_at(point, random),
        }
    }

    /// Returns the smallest and the largest value.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Self::Uniform(value) => (*value, *value),
            Self::Textured(texture) => texture.range(),
        }
    }

    /// Returns the mean value.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Textured(texture) => texture.mean(),
        }
    }

    /// Returns true if the number varies over the surface.
    pub fn is_textured(&self) -> bool {
        matches!(self, Self::Textured(_))
    }
}
