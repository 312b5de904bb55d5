//! Textures whose texels have spectra.

use std::sync::Arc;

use super::palette::{BandValues, Palette};
use super::pattern::Pattern;
use super::pyramid::ImagePattern;
use super::value::SurfaceSpectrum;
use super::{LookupRandom, TexturePoint};
use abbe_spectra::spectrum::{BAND_NM, Outside, Spectrum};

/// The number of a texel. If a quantity does not vary, the number is not used.
pub type Texel = u32;

/// A reflectance or a transmittance that varies over a surface. All values lie in [0, 1].
///
/// Copies of a texture share their texels.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralTexture {
    pattern: Pattern,
    palette: Arc<Palette>,
}

impl SpectralTexture {
    /// Creates the texture of a picture. `colours` contains the linear sRGB colours of its pixels,
    /// row by row. The components must lie in [0, 1]. Each colour becomes a smooth reflectance.
    pub fn from_colours(pattern: ImagePattern, colours: Vec<[f32; 3]>) -> Self {
        let colours = pattern.reduced(colours.into_flattened(), 3);
        let palette = Palette::smooth(colours.as_chunks().0);
        Self { pattern: Pattern::Image(pattern), palette: Arc::new(palette) }
    }

    /// Creates the texture of a picture with bands of wavelengths. `nm` contains the wavelengths of
    /// the bands in nm, in rising order. `values` contains one value in [0, 1] for each pixel and
    /// band. The values of a pixel are adjacent.
    pub fn from_bands(pattern: ImagePattern, nm: Vec<f64>, values: Vec<f32>) -> Self {
        let bands = BandValues { values: pattern.reduced(values, nm.len()), nm };
        Self { pattern: Pattern::Image(pattern), palette: Arc::new(Palette::Bands(bands)) }
    }

    /// Creates a texture of two parts. The texel 0 of the pattern selects the first part. The
    /// values of the parts must lie in [0, 1].
    pub fn from_parts(pattern: Pattern, parts: [SurfaceSpectrum; 2]) -> Self {
        Self { pattern, palette: Arc::new(Palette::Parts(Box::new(parts))) }
    }

    /// Selects a texel at a point.
    pub fn texel(&self, point: &TexturePoint, random: &mut LookupRandom) -> Texel {
        let texel = self.pattern.texel(point, random);
        match &*self.palette {
            Palette::Smooth(_) | Palette::Bands(_) => texel,
            Palette::Parts(parts) => {
                let [first, second] = &**parts;
                if texel == 0 { first.texel(point, random) } else { first.texel_count() + second.texel(point, random) }
            }
        }
    }

    /// Returns the number of texels.
    pub fn texel_count(&self) -> Texel {
        match &*self.palette {
            Palette::Smooth(_) | Palette::Bands(_) => self.pattern.texel_count() as Texel,
            Palette::Parts(parts) => parts.iter().map(SurfaceSpectrum::texel_count).sum(),
        }
    }

    /// Returns the value of a texel at a wavelength (nm).
    #[inline]
    pub fn at(&self, texel: Texel, nm: f64) -> f64 {
        self.palette.at(texel, nm)
    }

    /// Returns the largest value of any texel at a wavelength (nm).
    pub fn largest_at(&self, nm: f64) -> f64 {
        (0..self.texel_count()).map(|texel| self.at(texel, nm)).fold(0.0, f64::max)
    }

    /// Returns true if the texels were made from RGB colours.
    pub fn is_upsampled(&self) -> bool {
        match &*self.palette {
            Palette::Smooth(_) => true,
            Palette::Bands(_) => false,
            Palette::Parts(parts) => parts.iter().any(SurfaceSpectrum::is_upsampled),
        }
    }

    /// Returns a spectrum that stands for the whole texture. A picture has the spectrum of its
    /// smallest copy, and a pattern has the mean of its two parts.
    pub fn representative(&self) -> Spectrum {
        if let Palette::Parts(parts) = &*self.palette {
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
        self.palette.memory_bytes()
    }
}
