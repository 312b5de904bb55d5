//! Development for a display: white balance, colour space, tone curve, gamut, encoding.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::picture::Picture;
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::colour::space::encode_srgb_u8;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{Rgb, RgbSpace, Xyz};

/// The parameters of the conversion from a picture's XYZ to display codes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Development {
    pub space: RgbSpace,
    /// The XYZ of light that is shown as white, at any scale. `None` balances nothing.
    pub white: Option<Xyz>,
    /// How colours outside the colour space move into it.
    pub gamut: GamutMapping,
    /// The tone curve. It is applied before the gamut mapping.
    pub tone: ToneCurve,
}

impl Development {
    /// Returns the matrix from XYZ to linear components of the display.
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        match self.white {
            None => self.space.picture_matrix(),
            Some(white) => self.space.balanced_matrix(white),
        }
    }
}

/// Encoded colours for a display, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisplayImage {
    pub width: usize,
    pub height: usize,
    /// The colour space, which defines the primaries and the encoding.
    pub space: RgbSpace,
    /// The codes of red, green and blue of every pixel.
    pub codes: Codes,
}

/// The codes of all pixels, with enough bits per component to avoid visible steps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Codes {
    /// 8 bits per component: sRGB and Display P3.
    Eight(Vec<[u8; 3]>),
    /// Rec. 2020, whose standard requires at least 10 bits, and ACEScg, whose codes are linear.
    Sixteen(Vec<[u16; 3]>),
}

impl DisplayImage {
    /// Builds an image from `width` × `height` sRGB codes.
    pub fn of_srgb(width: usize, height: usize, rgb: Vec<[u8; 3]>) -> Self {
        Self { width, height, space: RgbSpace::Srgb, codes: Codes::Eight(rgb) }
    }
}

const PIXELS_PER_TASK: usize = 1 << 14;

/// Converts a picture on the threads of the current pool. `exposure`, in 1/(cd/m²), maps the
/// luminance 1/`exposure` to 1, which is white if the tone curve clips. NaN becomes black.
pub fn develop(picture: &Picture, exposure: f64, development: &Development) -> DisplayImage {
    let &Development { space, white: _, gamut, tone } = development;
    let matrix = development.matrix().map(|row| row.map(|entry| entry * exposure));
    let linear = |xyz: &Xyz| -> Rgb {
        // EXR files have single precision. A picture and its file give the same codes.
        let xyz = xyz.map(|component| f64::from(component as f32));
        let rgb = matrix.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]);
        gamut.map(tone.apply(rgb, space), space)
    };
    let codes = match space {
        RgbSpace::Srgb | RgbSpace::DisplayP3 => {
            Codes::Eight(coded(&picture.xyz, |xyz| linear(xyz).map(encode_srgb_u8)))
        }
        RgbSpace::Rec2020 | RgbSpace::AcesCg => {
            let sixteen = |component: f64| (65_535.0 * space.encode(component)).round() as u16;
            Codes::Sixteen(coded(&picture.xyz, |xyz| linear(xyz).map(sixteen)))
        }
    };
    DisplayImage { width: picture.width, height: picture.height, space, codes }
}

fn coded<T: Copy + Default + Send + Sync>(xyz: &[Xyz], code: impl Fn(&Xyz) -> [T; 3] + Sync) -> Vec<[T; 3]> {
    let mut codes = vec![[T::default(); 3]; xyz.len()];
    codes.par_chunks_mut(PIXELS_PER_TASK).zip(xyz.par_chunks(PIXELS_PER_TASK)).for_each(|(codes, xyz)| {
        codes.iter_mut().zip(xyz).for_each(|(shown, xyz)| *shown = code(xyz));
    });
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::colour::linear_srgb_to_xyz;

    const LINEAR: Development =
        Development { space: RgbSpace::Srgb, white: None, gamut: GamutMapping::Desaturate, tone: ToneCurve::Clip };

    fn picture(pixels: &[[f64; 3]]) -> Picture {
        let mut picture = Picture::black(pixels.len(), 1);
        picture.xyz = pixels.iter().map(|rgb| linear_srgb_to_xyz(*rgb)).collect();
        picture
    }

    /// Converts pixels from linear sRGB to codes. The codes are scaled to the range from 0 to 1.
    fn shown(pixels: &[[f64; 3]], exposure: f64, development: &Development) -> Vec<[f64; 3]> {
        match develop(&picture(pixels), exposure, development).codes {
            Codes::Eight(codes) => codes.iter().map(|rgb| rgb.map(|code| f64::from(code) / 255.0)).collect(),
            Codes::Sixteen(codes) => codes.iter().map(|rgb| rgb.map(|code| f64::from(code) / 65_535.0)).collect(),
        }
    }

    #[test]
    fn exposure_brings_luminance_to_white() {
        let screen = develop(&picture(&[[200.0; 3], [100.0; 3], [0.0; 3]]), 1.0 / 200.0, &LINEAR);
        // Half the luminance of white has the signal 0.7354.
        assert_eq!(screen, DisplayImage::of_srgb(3, 1, vec![[255; 3], [188; 3], [0; 3]]));
    }

    #[test]
    fn colours_outside_srgb_follow_the_gamut_mapping() {
        let sodium = [2.771_426_5, 0.587_216_4, -0.128_436_9].map(|component| 0.2 * component);
        let shown = |gamut| shown(&[sodium], 1.0, &Development { gamut, ..LINEAR })[0];
        let (desaturated, clipped) = (shown(GamutMapping::Desaturate), shown(GamutMapping::Clip));
        assert_eq!((desaturated[2], clipped[2]), (0.0, 0.0));
        assert!(desaturated[0] < clipped[0], "{desaturated:?} {clipped:?}");
        let oklab = shown(GamutMapping::Oklab);
        assert!(oklab != desaturated && oklab != clipped, "{oklab:?}");
    }

    /// Every colour space encodes white as white, and keeps its own colours.
    #[test]
    fn every_space_encodes_white_and_its_own_colours() {
        for space in RgbSpace::ALL {
            let development = Development { space, ..LINEAR };
            assert_eq!(shown(&[[1.0; 3]], 1.0, &development), [[1.0; 3]], "{space:?}");
            let own = [0.25, 0.5, 0.75];
            let mut picture = picture(&[[0.0; 3]]);
            // Adapted from the white of the space to D65. Only ACEScg has another white.
            let adapted = abbe_spectra::colour::adapt(
                space.to_xyz(own),
                space.white(),
                RgbSpace::Srgb.white(),
                abbe_spectra::colour::AdaptationTransform::Bradford,
            );
            picture.xyz[0] = adapted;
            let code = match develop(&picture, 1.0, &development).codes {
                Codes::Eight(codes) => codes[0].map(|code| f64::from(code) / 255.0),
                Codes::Sixteen(codes) => codes[0].map(|code| f64::from(code) / 65_535.0),
            };
            for (code, component) in code.iter().zip(own) {
                assert!((code - space.encode(component)).abs() < 0.5 / 255.0, "{space:?}: {code}");
            }
        }
    }

    #[test]
    fn the_balanced_light_is_white_at_its_luminance() {
        // Illuminant A at half the luminance of white.
        let white = [1.0985, 1.0, 0.3558];
        let mut picture = Picture::black(1, 1);
        picture.xyz[0] = white.map(|value| 0.5 * value);
        for space in [RgbSpace::Srgb, RgbSpace::DisplayP3] {
            let development = Development { space, white: Some(white.map(|value| 7.0 * value)), ..LINEAR };
            assert_eq!(develop(&picture, 1.0, &development).codes, Codes::Eight(vec![[188; 3]]), "{space:?}");
        }
    }

    #[test]
    fn highlights_roll_off_by_default() {
        let shown = |y: f64| shown(&[[y; 3]], 1.0, &Development::default())[0][0];
        assert_eq!(shown(0.18), f64::from(118_u8) / 255.0, "middle grey stays");
        assert!(shown(1.0) < shown(2.0) && shown(2.0) < shown(4.0) && shown(4.0) < 1.0);
    }

    #[test]
    fn nan_pixels_are_black() {
        let mut broken = Picture::black(1, 1);
        broken.xyz[0] = [f64::NAN; 3];
        assert_eq!(develop(&broken, 1.0, &LINEAR).codes, Codes::Eight(vec![[0; 3]]));
    }
}
