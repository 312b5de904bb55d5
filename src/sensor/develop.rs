//! What a display shows of a picture: white balance, the display's colour space, its gamut, its codes.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::picture::Picture;
use crate::colour::gamut::GamutMapping;
use crate::colour::space::encode_srgb_u8;
use crate::colour::{Rgb, RgbSpace, Xyz};

/// How a picture's colours become a display's.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Development {
    /// The display's colour space.
    pub space: RgbSpace,
    /// The light that is shown as white, by its XYZ at any scale; `None` shows colours as they are.
    pub white: Option<Xyz>,
    /// What becomes of colours that the space does not hold.
    pub gamut: GamutMapping,
}

impl Development {
    /// The rows that turn XYZ into linear components of the display.
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        match self.white {
            None => self.space.picture_matrix(),
            Some(white) => self.space.balanced_matrix(white),
        }
    }
}

/// Colours of a display, rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Screen {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// What red, green and blue are, and how codes stand for light.
    pub space: RgbSpace,
    /// Red, green and blue of every pixel.
    pub codes: Codes,
}

/// The codes of all pixels, in as many bits as their space needs to show no steps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Codes {
    /// 8 bits a component: sRGB and Display P3.
    Eight(Vec<[u8; 3]>),
    /// 16 bits a component: Rec. 2020, whose standard asks for at least 10, and ACEScg, whose codes are linear.
    Sixteen(Vec<[u16; 3]>),
}

impl Screen {
    /// A screen of sRGB codes, as many as `width` × `height`.
    pub fn of_srgb(width: usize, height: usize, rgb: Vec<[u8; 3]>) -> Self {
        Self { width, height, space: RgbSpace::Srgb, codes: Codes::Eight(rgb) }
    }
}

/// Pixels that a worker develops at once.
const CHUNK: usize = 1 << 14;

/// Develops a picture: luminance times `exposure` (1/(cd/m²)) is 1 at white. What is not a number becomes black.
/// Works on all threads of the current pool.
pub fn develop(picture: &Picture, exposure: f64, development: &Development) -> Screen {
    let &Development { space, white: _, gamut } = development;
    let matrix = development.matrix().map(|row| row.map(|entry| entry * exposure));
    let linear = |xyz: &Xyz| -> Rgb {
        let rgb = matrix.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]);
        gamut.map(rgb, space)
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
    Screen { width: picture.width, height: picture.height, space, codes }
}

/// The codes of all pixels.
fn coded<T: Copy + Default + Send + Sync>(xyz: &[Xyz], code: impl Fn(&Xyz) -> [T; 3] + Sync) -> Vec<[T; 3]> {
    let mut codes = vec![[T::default(); 3]; xyz.len()];
    codes.par_chunks_mut(CHUNK).zip(xyz.par_chunks(CHUNK)).for_each(|(codes, xyz)| {
        codes.iter_mut().zip(xyz).for_each(|(shown, xyz)| *shown = code(xyz));
    });
    codes
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

    /// The codes of pixels given in linear sRGB, as numbers from 0 to 1.
    fn shown(pixels: &[[f64; 3]], exposure: f64, development: &Development) -> Vec<[f64; 3]> {
        match develop(&picture(pixels), exposure, development).codes {
            Codes::Eight(codes) => codes.iter().map(|rgb| rgb.map(|code| f64::from(code) / 255.0)).collect(),
            Codes::Sixteen(codes) => codes.iter().map(|rgb| rgb.map(|code| f64::from(code) / 65_535.0)).collect(),
        }
    }

    #[test]
    fn exposure_brings_luminance_to_white() {
        let screen = develop(&picture(&[[200.0; 3], [100.0; 3], [0.0; 3]]), 1.0 / 200.0, &Development::default());
        // Half of white's luminance is 0.7354 of the signal.
        assert_eq!(screen, Screen::of_srgb(3, 1, vec![[255; 3], [188; 3], [0; 3]]));
    }

    #[test]
    fn colours_outside_srgb_are_mapped_as_asked() {
        let sodium = [2.771_426_5, 0.587_216_4, -0.128_436_9].map(|component| 0.2 * component);
        let shown = |gamut| shown(&[sodium], 1.0, &Development { gamut, ..Development::default() })[0];
        let (desaturated, clipped) = (shown(GamutMapping::Desaturate), shown(GamutMapping::Clip));
        assert_eq!((desaturated[2], clipped[2]), (0.0, 0.0));
        assert!(desaturated[0] < clipped[0], "{desaturated:?} {clipped:?}");
        let oklab = shown(GamutMapping::Oklab);
        assert!(oklab != desaturated && oklab != clipped, "{oklab:?}");
    }

    #[test]
    fn every_space_shows_white_as_white_and_its_own_colours_as_they_are() {
        for space in RgbSpace::ALL {
            let development = Development { space, ..Development::default() };
            assert_eq!(shown(&[[1.0; 3]], 1.0, &development), [[1.0; 3]], "{space:?}");
            let own = [0.25, 0.5, 0.75];
            let mut picture = picture(&[[0.0; 3]]);
            // A colour under the space's own white, seen under D65's: only ACEScg has another.
            let adapted = crate::colour::adapt(
                space.to_xyz(own),
                space.white(),
                RgbSpace::Srgb.white(),
                crate::colour::Transform::Bradford,
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
        // Illuminant A, half as bright as white.
        let white = [1.0985, 1.0, 0.3558];
        let mut picture = Picture::black(1, 1);
        picture.xyz[0] = white.map(|value| 0.5 * value);
        for space in [RgbSpace::Srgb, RgbSpace::DisplayP3] {
            let development =
                Development { space, white: Some(white.map(|value| 7.0 * value)), ..Development::default() };
            assert_eq!(develop(&picture, 1.0, &development).codes, Codes::Eight(vec![[188; 3]]), "{space:?}");
        }
    }

    #[test]
    fn pixels_that_are_no_numbers_are_black() {
        let mut broken = Picture::black(1, 1);
        broken.xyz[0] = [f64::NAN; 3];
        assert_eq!(develop(&broken, 1.0, &Development::default()).codes, Codes::Eight(vec![[0; 3]]));
    }
}
