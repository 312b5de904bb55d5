//! Spectra that are uniform, vary over a surface, or are chosen by a pattern between two such.

use std::sync::Arc;

use super::palette::{BandValues, Palette};
use super::pattern::Pattern;
use super::point::{LookupRandom, Texel, TexturePoint};
use super::pyramid::ImagePattern;
use abbe_spectra::spectrum::{BAND_NM, Outside, Spectrum};

/// A reflectance or transmittance in [0, 1] over a surface. Copies share their texels.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralTexture {
    pattern: Pattern,
    spectra: Arc<TexelSpectra>,
}

#[derive(Debug, Clone, PartialEq)]
enum TexelSpectra {
    /// The pixels of a picture.
    Picture(Palette),
    /// The texels of the first part, then those of the second part.
    Parts(Box<[SurfaceSpectrum; 2]>),
}

/// A spectrum that is uniform or varies over a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceSpectrum {
    /// The same spectrum at every point.
    Uniform(Spectrum),
    /// A spectrum for each texel.
    Textured(SpectralTexture),
}

impl SurfaceSpectrum {
    /// Returns the value at a wavelength (nm), at the texel from [`Self::texel`].
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
        if let Self::Uniform(spectrum) = self { Some(spectrum) } else { None }
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

impl SpectralTexture {
    /// Creates the texture of a picture from the linear sRGB colours of its pixels, row by row, in
    /// [0, 1]. Each becomes a smooth reflectance.
    pub fn from_colours(pattern: ImagePattern, colours: Vec<[f32; 3]>) -> Self {
        let colours = pattern.reduced(colours.into_flattened(), 3);
        let palette = Palette::smooth(colours.as_chunks().0);
        Self { pattern: Pattern::Image(pattern), spectra: Arc::new(TexelSpectra::Picture(palette)) }
    }

    /// Creates the texture of a picture with bands at the wavelengths `nm`, in rising order, from
    /// one value in [0, 1] for each band of each pixel.
    pub fn from_bands(pattern: ImagePattern, nm: Vec<f64>, values: Vec<f32>) -> Self {
        let bands = BandValues { values: pattern.reduced(values, nm.len()), nm };
        Self { pattern: Pattern::Image(pattern), spectra: Arc::new(TexelSpectra::Picture(Palette::Bands(bands))) }
    }

    /// Creates a texture of two parts in [0, 1], the first for texel 0 of the pattern.
    pub fn from_parts(pattern: Pattern, parts: [SurfaceSpectrum; 2]) -> Self {
        Self { pattern, spectra: Arc::new(TexelSpectra::Parts(Box::new(parts))) }
    }

    /// Selects a texel at a point.
    pub fn texel(&self, point: &TexturePoint, random: &mut LookupRandom) -> Texel {
        let texel = self.pattern.texel(point, random);
        match &*self.spectra {
            TexelSpectra::Picture(_) => texel,
            TexelSpectra::Parts(parts) => {
                let [first, second] = &**parts;
                if texel == 0 { first.texel(point, random) } else { first.texel_count() + second.texel(point, random) }
            }
        }
    }

    /// Returns the number of texels.
    pub fn texel_count(&self) -> Texel {
        match &*self.spectra {
            TexelSpectra::Picture(_) => self.pattern.texel_count() as Texel,
            TexelSpectra::Parts(parts) => parts.iter().map(SurfaceSpectrum::texel_count).sum(),
        }
    }

    /// Returns the value of a texel at a wavelength (nm).
    #[inline]
    pub fn at(&self, texel: Texel, nm: f64) -> f64 {
        match &*self.spectra {
            TexelSpectra::Picture(palette) => palette.at(texel, nm),
            TexelSpectra::Parts(parts) => {
                let [first, second] = &**parts;
                let count = first.texel_count();
                if texel < count { first.at(texel, nm) } else { second.at(texel - count, nm) }
            }
        }
    }

    /// Returns the largest value of any texel at a wavelength (nm).
    pub fn largest_at(&self, nm: f64) -> f64 {
        (0..self.texel_count()).map(|texel| self.at(texel, nm)).fold(0.0, f64::max)
    }

    /// Returns true if the texels were made from RGB colours.
    pub fn is_upsampled(&self) -> bool {
        match &*self.spectra {
            TexelSpectra::Picture(palette) => matches!(palette, Palette::Smooth(_)),
            TexelSpectra::Parts(parts) => parts.iter().any(SurfaceSpectrum::is_upsampled),
        }
    }

    /// Returns a typical spectrum: that of the smallest copy of a picture, or the mean of two
    /// parts.
    pub fn representative(&self) -> Spectrum {
        if let TexelSpectra::Parts(parts) = &*self.spectra {
            let [first, second] = (**parts).each_ref().map(SurfaceSpectrum::representative);
            return Spectrum::mix(&[(0.5, &first), (0.5, &second)]);
        }
        let last = self.texel_count() - 1;
        let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
        let values: Vec<f64> = nm.iter().map(|&nm| self.at(last, nm)).collect();
        Spectrum::table(&nm, &values, Outside::Hold).unwrap_or_else(|_| Spectrum::constant(self.at(last, nm[0])))
    }

    /// Returns the memory of the texels in bytes.
    pub fn memory_bytes(&self) -> usize {
        match &*self.spectra {
            TexelSpectra::Picture(palette) => palette.memory_bytes(),
            TexelSpectra::Parts(parts) => parts.iter().map(SurfaceSpectrum::memory_bytes).sum(),
        }
    }
}
