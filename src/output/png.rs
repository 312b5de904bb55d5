//! What a screen shows of a picture: 8-bit sRGB.

use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::file;
use crate::colour::gamut::GamutMapping;
use crate::colour::{RgbSpace, encode_srgb_u8, xyz_to_linear_srgb};
use crate::error::{Error, Result};
use crate::sensor::Picture;

/// Colours of a screen, rows from the top, 8 bits a component.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Screen {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of every pixel, sRGB.
    pub rgb: Vec<[u8; 3]>,
}

/// Develops a picture for a screen: luminance times `exposure` (1/(cd/m²)) is 1 at white; colours that sRGB does not
/// hold are mapped as `gamut` says. What is not a number becomes black.
pub fn develop(picture: &Picture, exposure: f64, gamut: GamutMapping) -> Screen {
    let shown = |xyz: &[f64; 3]| {
        let linear = xyz_to_linear_srgb(xyz.map(|value| value * exposure));
        gamut.map(linear, RgbSpace::Srgb).map(encode_srgb_u8)
    };
    Screen { width: picture.width, height: picture.height, rgb: picture.xyz.iter().map(shown).collect() }
}

impl Screen {
    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// The machine's: a picture that the format cannot hold.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive);
        let too_large = || Error::machine("the picture is too large for PNG");
        let width = u32::try_from(self.width).map_err(|_| too_large())?;
        let height = u32::try_from(self.height).map_err(|_| too_large())?;
        encoder
            .write_image(self.rgb.as_flattened(), width, height, ExtendedColorType::Rgb8)
            .map_err(|error| Error::machine(format!("cannot be written as PNG: {error}")))?;
        Ok(bytes)
    }

    /// Writes a PNG file, whole or not at all.
    ///
    /// # Errors
    /// The machine's: a folder that is missing or cannot be written to, a full disk.
    pub fn write_png(&self, path: &Path) -> Result<()> {
        let bytes = self.png().map_err(|error| error.in_file(path))?;
        file::write_whole(path, &bytes)
    }
}

/// Reads a mask: true where any component of a PNG's pixel but its opacity is not zero.
///
/// # Errors
/// The input's: a file that is missing or no PNG, a size other than `width` × `height`.
pub fn read_mask(path: &Path, width: usize, height: usize) -> Result<Vec<bool>> {
    let wrong = |what: String| Error::input(what).in_file(path);
    let bytes = std::fs::read(path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let mask = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png)
        .map_err(|error| wrong(format!("is not a sound PNG file: {error}")))?
        .into_rgb16();
    if (mask.width() as usize, mask.height() as usize) != (width, height) {
        let what = format!("a mask of {} × {} pixels", mask.width(), mask.height());
        return Err(wrong(what).expected(format!("the pictures' size, {width} × {height}")));
    }
    Ok(mask.pixels().map(|pixel| pixel.0 != [0; 3]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::linear_srgb_to_xyz;

    fn picture(pixels: &[[f64; 3]]) -> Picture {
        let mut picture = Picture::black(pixels.len(), 1);
        picture.xyz = pixels.iter().map(|rgb| linear_srgb_to_xyz(*rgb)).collect();
        picture
    }

    #[test]
    fn exposure_brings_luminance_to_white() {
        let screen = develop(&picture(&[[200.0; 3], [100.0; 3], [0.0; 3]]), 1.0 / 200.0, GamutMapping::Desaturate);
        // Half of white's luminance is 0.7354 of the signal.
        assert_eq!(screen.rgb, [[255; 3], [188; 3], [0; 3]]);
    }

    #[test]
    fn colours_outside_srgb_are_mapped_as_asked() {
        let sodium = [2.771_426_5, 0.587_216_4, -0.128_436_9].map(|component| 0.2 * component);
        let shown = |gamut| develop(&picture(&[sodium]), 1.0, gamut).rgb[0];
        let (desaturated, clipped) = (shown(GamutMapping::Desaturate), shown(GamutMapping::Clip));
        assert_eq!((desaturated[2], clipped[2]), (0, 0));
        assert!(desaturated[0] < clipped[0], "{desaturated:?} {clipped:?}");
        let oklab = shown(GamutMapping::Oklab);
        assert!(oklab != desaturated && oklab != clipped, "{oklab:?}");
    }

    #[test]
    fn pixels_that_are_no_numbers_are_black() {
        let mut broken = Picture::black(1, 1);
        broken.xyz[0] = [f64::NAN; 3];
        assert_eq!(develop(&broken, 1.0, GamutMapping::Desaturate).rgb, [[0; 3]]);
    }

    #[test]
    fn a_png_holds_the_screen_s_pixels() {
        let screen = Screen { width: 2, height: 1, rgb: vec![[1, 2, 3], [250, 128, 0]] };
        let image = image::load_from_memory(&screen.png().unwrap()).unwrap().into_rgb8();
        assert_eq!((image.width(), image.height()), (2, 1));
        assert_eq!(image.into_raw(), screen.rgb.as_flattened());
    }

    #[test]
    fn a_mask_counts_what_is_not_zero_and_must_fit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mask.png");
        Screen { width: 3, height: 1, rgb: vec![[0; 3], [0, 0, 1], [255; 3]] }.write_png(&path).unwrap();
        assert_eq!(read_mask(&path, 3, 1).unwrap(), [false, true, true]);
        let error = read_mask(&path, 4, 1).unwrap_err();
        assert!(error.to_string().contains("expected the pictures' size, 4 × 1"), "{error}");
        std::fs::write(&path, "no picture").unwrap();
        assert_eq!(read_mask(&path, 3, 1).unwrap_err().exit_status(), 2);
    }
}
