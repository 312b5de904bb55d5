//! Parameters of materials that are uniform or vary over a surface.

use super::scalar::ScalarTexture;
use super::spectral::{SpectralTexture, Texel};
use super::{LookupRandom, TexturePoint};
use abbe_spectra::spectrum::Spectrum;

/// A spectrum that is uniform or varies over a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceSpectrum {
    /// The same spectrum at every point.
    Uniform(Spectrum),
    /// A spectrum for each texel.
    Textured(SpectralTexture),
}

impl SurfaceSpectrum {
    /// Returns the value at a wavelength (nm). `texel` was selected by [`Self::texel`].
    #[inline(always)]
    pub fn at(&self, texel: Texel, nm: f64) -> f64 {
        match self {
            Self::Uniform(spectrum) => spectrum.at(nm),
            Self::Textured(texture) => texture.at(texel, nm),
        }
    }

    /// Selects a texel at a point.
    pub fn texel(&self, point: &TexturePoint, random: &mut LookupRandom) -> Texel {
        match self {
            Self::Uniform(_) => 0,
            Self::Textured(texture) => texture.texel(point, random),
        }
    }

    /// Returns the number of texels. A uniform spectrum has one.
    #[inline]
    pub fn texel_count(&self) -> Texel {
        match self {
            Self::Uniform(_) => 1,
            Self::Textured(texture) => texture.texel_count(),
        }
    }

    /// Returns the largest value at a wavelength (nm) over the surface.
    pub fn largest_at(&self, nm: f64) -> f64 {
        match self {
            Self::Uniform(spectrum) => spectrum.at(nm),
            Self::Textured(texture) => texture.largest_at(nm),
        }
    }

    /// Returns true if the spectrum varies over the surface.
    pub fn is_textured(&self) -> bool {
        self.uniform().is_none()
    }

    /// Returns the spectrum if it is uniform.
    #[inline]
    pub fn uniform(&self) -> Option<&Spectrum> {
        match self {
            Self::Uniform(spectrum) => Some(spectrum),
            Self::Textured(_) => None,
        }
    }

    /// Returns true if a spectrum was made from an RGB colour.
    pub fn is_upsampled(&self) -> bool {
        match self {
            Self::Uniform(spectrum) => spectrum.is_upsampled(),
            Self::Textured(texture) => texture.is_upsampled(),
        }
    }

    /// Returns the spectrum, or a spectrum that stands for the whole texture.
    pub fn representative(&self) -> Spectrum {
        match self {
            Self::Uniform(spectrum) => spectrum.clone(),
            Self::Textured(texture) => texture.representative(),
        }
    }

    /// Returns the uniform spectrum that stands for the whole surface.
    #[must_use]
    pub fn without_texture(self) -> Self {
        Self::Uniform(self.representative())
    }

    /// Returns the memory of the texels in bytes.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Textured(texture) => texture.memory_bytes(),
        }
    }
}

impl From<Spectrum> for SurfaceSpectrum {
    fn from(spectrum: Spectrum) -> Self {
        Self::Uniform(spectrum)
    }
}

impl From<SpectralTexture> for SurfaceSpectrum {
    fn from(texture: SpectralTexture) -> Self {
        Self::Textured(texture)
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

    /// Returns the interpolated value at a point. A footprint is sampled at one point of it.
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
