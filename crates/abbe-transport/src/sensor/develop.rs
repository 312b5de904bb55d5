//! Development for a display: white balance, colour space, chroma compression, tone curve, gamut,
//! encoding.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::bloom;
use super::exposure;
use super::picture::Picture;
use abbe_scene::Bloom;
use abbe_spectra::colour::compression::{ChromaCompression, HueLimits};
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::colour::space::encode_srgb_u8;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{Rgb, RgbSpace, Transfer, Xyz};

/// The parameters of the conversion from a picture's XYZ to display codes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Development {
    pub space: RgbSpace,
    /// The encoding of the codes.
    #[serde(default)]
    pub transfer: Transfer,
    /// The XYZ of light that is shown as white, at any scale. `None` balances nothing.
    pub white: Option<Xyz>,
    /// How colours outside the colour space move into it.
    pub gamut: GamutMapping,
    /// The tone curve. The chroma compression comes before it, and the other gamut mappings after.
    pub tone: ToneCurve,
    /// The light that the eye of the viewer scatters. `None` without bloom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bloom: Option<Bloom>,
}

/// A pixel counts for the reach of a picture if its luminance is at least this fraction of the
/// white of automatic exposure. Darker ones are black, and their chroma is noise.
const DARKEST_VISIBLE: f64 = 1e-3;

/// The fraction of the visible pixels that may lie beyond the reach of a picture, so that single
/// fireflies and glints do not take chroma from all other pixels.
const BEYOND_REACH: f64 = 1e-3;

impl Development {
    /// Returns the matrix from XYZ to linear components of the display.
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        match self.white {
            None => self.space.picture_matrix(),
            Some(white) => self.space.balanced_matrix(white),
        }
    }

    /// Returns the largest saturations of all hues for this display and white balance.
    pub fn hue_limits(&self) -> HueLimits {
        HueLimits::new(self.space, &self.matrix())
    }

    /// Returns the reach of a picture: how far its saturated colours are beyond the gamut, from 0
    /// (no colour) to 1 (the spectral locus). All but a thousandth of the visible pixels are within
    /// the reach. Only the chroma compression needs it, and the exposure has no influence.
    pub fn reach(&self, picture: &Picture) -> f64 {
        match self.gamut {
            GamutMapping::Compress => self.measured_reach(picture, &self.hue_limits()),
            GamutMapping::Desaturate | GamutMapping::Clip | GamutMapping::Oklab => 0.0,
        }
    }

    fn measured_reach(&self, picture: &Picture, limits: &HueLimits) -> f64 {
        let darkest = DARKEST_VISIBLE / exposure::automatic(picture);
        let visible: Vec<Xyz> =
            picture.xyz.iter().copied().filter(|xyz| xyz[1] >= darkest && xyz[1].is_finite()).collect();
        let matrix = self.matrix();
        let reach = |xyz: &Xyz| limits.reach(apply(&matrix, single_precision(*xyz)));
        let mut reaches: Vec<f64> = visible.par_iter().map(reach).filter(|reach| *reach > 0.0).collect();
        let beyond = (BEYOND_REACH * visible.len() as f64) as usize;
        if reaches.len() <= beyond {
            return 0.0;
        }
        *reaches.select_nth_unstable_by(beyond, |a, b| b.total_cmp(a)).1
    }
}

fn apply(matrix: &[[f64; 3]; 3], xyz: Xyz) -> Rgb {
    matrix.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// EXR files have single precision. A picture and its file give the same codes.
fn single_precision(xyz: Xyz) -> Xyz {
    xyz.map(|component| f64::from(component as f32))
}

/// Encoded colours for a display, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisplayImage {
    pub width: usize,
    pub height: usize,
    /// The colour space, which defines the primaries and the encoding.
    pub space: RgbSpace,
    /// The encoding of the codes.
    pub transfer: Transfer,
    /// The codes of red, green and blue of every pixel.
    pub codes: Codes,
}

/// The codes of all pixels, with enough bits per component to avoid visible steps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Codes {
    /// 8 bits per component: sRGB and Display P3.
    Eight(Vec<[u8; 3]>),
    /// Rec. 2020, whose standard requires at least 10 bits, PQ, and ACEScg, whose codes are linear.
    Sixteen(Vec<[u16; 3]>),
}

impl DisplayImage {
    /// Builds an image from `width` × `height` sRGB codes.
    pub fn of_srgb(width: usize, height: usize, rgb: Vec<[u8; 3]>) -> Self {
        Self { width, height, space: RgbSpace::Srgb, transfer: Transfer::OfSpace, codes: Codes::Eight(rgb) }
    }
}

const PIXELS_PER_TASK: usize = 1 << 14;

/// Converts a picture on the threads of the current pool. `exposure`, in 1/(cd/m²), maps the
/// luminance 1/`exposure` to 1, which is white if the tone curve clips. NaN becomes black.
pub fn develop(picture: &Picture, exposure: f64, development: &Development) -> DisplayImage {
    develop_with_reach(picture, exposure, development.reach(picture), development)
}

/// Converts a picture as [`develop`] does, but with the reach of another picture, so that two
/// pictures can be compared: equal colours then have equal codes.
pub fn develop_with_reach(picture: &Picture, exposure: f64, reach: f64, development: &Development) -> DisplayImage {
    let &Development { space, transfer, white: _, gamut, tone, bloom } = development;
    let bloomed = bloom.map(|eye| bloom::apply(&eye, picture));
    let xyz = bloomed.as_deref().unwrap_or(&picture.xyz);
    // Tone curves and gamuts end at 1, so an HDR display has its peak there and not its white.
    let matrix = development.matrix().map(|row| row.map(|entry| entry * exposure / transfer.peak()));
    // With the reach 0, the compression changes nothing.
    let compression = (reach > 0.0).then(|| ChromaCompression::new(development.hue_limits(), reach));
    let linear = |xyz: &Xyz| -> Rgb {
        let rgb = apply(&matrix, single_precision(*xyz));
        let rgb = compression.as_ref().map_or(rgb, |compression| compression.apply(rgb));
        gamut.map(tone.apply(rgb, space), space)
    };
    let codes = match (space, transfer) {
        (RgbSpace::Srgb | RgbSpace::DisplayP3, Transfer::OfSpace) => {
            Codes::Eight(coded(xyz, |xyz| linear(xyz).map(encode_srgb_u8)))
        }
        (RgbSpace::Rec2020 | RgbSpace::AcesCg, Transfer::OfSpace)
        | (RgbSpace::Srgb | RgbSpace::DisplayP3 | RgbSpace::Rec2020 | RgbSpace::AcesCg, Transfer::Pq) => {
            let sixteen =
                |component: f64| (65_535.0 * transfer.encode(component * transfer.peak(), space)).round() as u16;
            Codes::Sixteen(coded(xyz, |xyz| linear(xyz).map(sixteen)))
        }
    };
    DisplayImage { width: picture.width, height: picture.height, space, transfer, codes }
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
    use abbe_spectra::colour::transfer::decode_pq;

    const LINEAR: Development = Development {
        space: RgbSpace::Srgb,
        transfer: Transfer::OfSpace,
        white: None,
        gamut: GamutMapping::Desaturate,
        tone: ToneCurve::Clip,
        bloom: None,
    };

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

    /// A picture of white paper, with some pixels of light at 500 nm.
    fn paper_with(spectral: usize) -> Picture {
        let mut picture = picture(&vec![[0.5; 3]; 10_000]);
        picture.xyz[..spectral].fill([0.0049, 0.323, 0.272]);
        picture
    }

    #[test]
    fn single_fireflies_do_not_extend_the_reach() {
        let reach = |spectral: usize| Development::default().reach(&paper_with(spectral));
        assert_eq!([0, 1, 10].map(reach), [0.0; 3]);
        assert!(reach(11) > 0.99, "{}", reach(11));
        let desaturating = Development { gamut: GamutMapping::Desaturate, ..Development::default() };
        assert_eq!(desaturating.reach(&paper_with(5000)), 0.0);
    }

    /// Pixels far darker than the picture are black, and their noise does not count.
    #[test]
    fn dark_pixels_do_not_extend_the_reach() {
        let mut film = paper_with(2000);
        film.xyz[..2000].iter_mut().for_each(|xyz| *xyz = xyz.map(|value| value * 1e-4));
        assert_eq!(Development::default().reach(&film), 0.0);
    }

    /// A picture without colours beyond the gamut has the same codes as without the compression,
    /// and the exposure does not change the reach.
    #[test]
    fn the_compression_is_idle_without_spectral_colours() {
        let colours: Vec<[f64; 3]> =
            (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(|c| 0.1 * f64::from(c))).collect();
        let compress = Development { gamut: GamutMapping::Compress, ..LINEAR };
        assert!(shown(&colours, 1.0, &compress) == shown(&colours, 1.0, &LINEAR), "some codes differ");
        let spectral = shown(&vec![[-0.2, 0.5, 0.3]; 9], 1.0, &compress);
        assert!(spectral[0][0] > 0.0 && spectral[0] != shown(&[[-0.2, 0.5, 0.3]], 1.0, &LINEAR)[0], "{spectral:?}");
    }

    /// On an HDR display, white is reference white, and highlights are up to 1000 cd/m².
    #[test]
    fn pq_shows_highlights_above_white() {
        let hdr = Development { space: RgbSpace::Rec2020, transfer: Transfer::Pq, ..LINEAR };
        let luminance = |y: f64| decode_pq(shown(&[[y; 3]], 1.0, &hdr)[0][1]);
        for (y, expected) in [(0.18, 36.5), (1.0, 203.0), (4.0, 812.0), (50.0, 1000.0)] {
            assert!((luminance(y) / expected - 1.0).abs() < 2e-3, "{y}: {}", luminance(y));
        }
        let hdr = Development { tone: ToneCurve::RollOff, ..hdr };
        let luminance = |y: f64| decode_pq(shown(&[[y; 3]], 1.0, &hdr)[0][1]);
        assert!((luminance(1.0) - 203.0).abs() < 0.5 && luminance(20.0) < 1000.0 && luminance(20.0) > 950.0);
    }

    #[test]
    fn bloom_changes_the_codes_around_a_lamp() {
        let mut film = picture(&vec![[0.0; 3]; 101]);
        film.xyz[50] = linear_srgb_to_xyz([1e5; 3]);
        let with = |bloom| match develop(&film, 1.0, &Development { bloom, ..LINEAR }).codes {
            Codes::Eight(codes) => codes[60],
            Codes::Sixteen(_) => panic!("sRGB has 8 bits"),
        };
        assert_eq!(with(None), [0; 3]);
        assert!(with(Some(Bloom { fov_degrees: 40.0, age: 25.0 }))[1] > 0);
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
