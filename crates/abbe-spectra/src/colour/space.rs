//! RGB colour spaces: sRGB, Display P3, Rec. 2020 and ACEScg.

use std::sync::OnceLock;

use super::adaptation::{AdaptationTransform, adaptation};
use super::by_name;
use super::matrix::{Matrix3, apply, diagonal, inverse, product, transposed};
use super::tristimulus::{Rgb, Xyz};
use crate::error::Result;
use crate::math::elementary::powf;
use serde::{Deserialize, Serialize};

/// An RGB space with linear components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RgbSpace {
    /// sRGB and Rec. 709 (IEC 61966-2-1).
    #[default]
    Srgb,
    /// Display P3 (SMPTE RP 431-2 primaries, D65 white).
    DisplayP3,
    /// Rec. 2020 (ITU-R BT.2020).
    Rec2020,
    /// ACEScg (AP1 primaries, ACES white; Academy S-2014-004).
    AcesCg,
}

const D65_XY: [f64; 2] = [0.3127, 0.3290];
const ACES_WHITE_XY: [f64; 2] = [0.321_68, 0.337_67];

static SRGB: SpaceMatrices = SpaceMatrices::new([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]], D65_XY);
static DISPLAY_P3: SpaceMatrices = SpaceMatrices::new([[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]], D65_XY);
static REC2020: SpaceMatrices = SpaceMatrices::new([[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]], D65_XY);
static ACES_CG: SpaceMatrices = SpaceMatrices::new([[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]], ACES_WHITE_XY);

struct SpaceMatrices {
    primaries_xy: [[f64; 2]; 3],
    white_xy: [f64; 2],
    to_xyz: Matrix3,
    from_xyz: Matrix3,
}

impl SpaceMatrices {
    /// Builds the matrices. The columns of `to_xyz` are the primaries, scaled so that the
    /// components (1, 1, 1) have Y = 1 and the chromaticity of white.
    const fn new(primaries_xy: [[f64; 2]; 3], white_xy: [f64; 2]) -> Self {
        let columns = transposed(&[of_xy(primaries_xy[0]), of_xy(primaries_xy[1]), of_xy(primaries_xy[2])]);
        let scale = apply(&inverse(&columns), of_xy(white_xy));
        let to_xyz = product(&columns, &diagonal(scale));
        Self { primaries_xy, white_xy, to_xyz, from_xyz: inverse(&to_xyz) }
    }
}

/// Returns the XYZ of a chromaticity at Y = 1.
const fn of_xy(xy: [f64; 2]) -> Xyz {
    [xy[0] / xy[1], 1.0, (1.0 - xy[0] - xy[1]) / xy[1]]
}

impl RgbSpace {
    /// Every space.
    pub const ALL: [Self; 4] = [Self::Srgb, Self::DisplayP3, Self::Rec2020, Self::AcesCg];

    /// Returns the name of the space.
    pub fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb",
            Self::DisplayP3 => "display-p3",
            Self::Rec2020 => "rec2020",
            Self::AcesCg => "acescg",
        }
    }

    /// Returns a space by its name (`srgb`, `display-p3`, `rec2020` or `acescg`), or an error.
    pub fn by_name(name: &str) -> Result<Self> {
        by_name("colour space", name, &Self::ALL.map(|any| (any.name(), any)))
    }

    fn matrices(self) -> &'static SpaceMatrices {
        match self {
            Self::Srgb => &SRGB,
            Self::DisplayP3 => &DISPLAY_P3,
            Self::Rec2020 => &REC2020,
            Self::AcesCg => &ACES_CG,
        }
    }

    /// Returns the chromaticities x, y of red, green and blue.
    pub fn primaries_xy(self) -> [[f64; 2]; 3] {
        self.matrices().primaries_xy
    }

    /// Returns the chromaticity x, y of white.
    pub fn white_xy(self) -> [f64; 2] {
        self.matrices().white_xy
    }

    /// Returns the XYZ of white at Y = 1.
    pub fn white(self) -> Xyz {
        of_xy(self.white_xy())
    }

    /// Converts linear components to XYZ. (1, 1, 1) is the white of the space at Y = 1.
    #[inline]
    pub fn to_xyz(self, rgb: Rgb) -> Xyz {
        apply(&self.matrices().to_xyz, rgb)
    }

    /// Converts XYZ to linear components, without chromatic adaptation.
    #[inline]
    pub fn from_xyz(self, xyz: Xyz) -> Rgb {
        apply(&self.matrices().from_xyz, xyz)
    }

    /// Returns the matrix from XYZ to linear components that develops pictures. It includes
    /// Bradford's transform from the white of sRGB (D65), so it differs from that of
    /// [`from_xyz`](Self::from_xyz) only for ACEScg.
    pub fn picture_matrix(self) -> [[f64; 3]; 3] {
        match self {
            Self::Srgb | Self::DisplayP3 | Self::Rec2020 => self.matrices().from_xyz,
            Self::AcesCg => self.balanced_matrix(Self::Srgb.white()),
        }
    }

    /// Returns the matrix from XYZ to linear components that includes Bradford's transform from the
    /// colour `white`, of any scale, to the white of this space.
    pub fn balanced_matrix(self, white: Xyz) -> [[f64; 3]; 3] {
        product(&self.matrices().from_xyz, &adaptation(white, self.white(), AdaptationTransform::Bradford))
    }

    /// Returns the weights of the red, green and blue components in Y, whose sum is 1.
    pub fn luminance_weights(self) -> [f64; 3] {
        self.matrices().to_xyz[1]
    }

    /// Encodes a linear component as a non-linear signal by an odd function: sRGB and Display P3
    /// use the sRGB curve, Rec. 2020 has its own, and ACEScg is linear.
    pub fn encode(self, component: f64) -> f64 {
        match self {
            Self::Srgb | Self::DisplayP3 => encode_srgb(component),
            Self::Rec2020 => {
                let x = component.abs();
                let signal =
                    if x < BT2020_BETA { 4.5 * x } else { BT2020_ALPHA * powf(x, 0.45) - (BT2020_ALPHA - 1.0) };
                signal.copysign(component)
            }
            Self::AcesCg => component,
        }
    }

    /// Inverts [`encode`](Self::encode).
    pub fn decode(self, signal: f64) -> f64 {
        match self {
            Self::Srgb | Self::DisplayP3 => decode_srgb(signal),
            Self::Rec2020 => {
                let x = signal.abs();
                let component = if x < 4.5 * BT2020_BETA {
                    x / 4.5
                } else {
                    powf((x + (BT2020_ALPHA - 1.0)) / BT2020_ALPHA, 1.0 / 0.45)
                };
                component.copysign(signal)
            }
            Self::AcesCg => signal,
        }
    }
}

/// The constants of ITU-R BT.2020, precise enough for the branches to meet smoothly.
const BT2020_ALPHA: f64 = 1.099_296_826_809_442_4;
const BT2020_BETA: f64 = 0.018_053_968_510_807_807;

/// Converts XYZ to linear sRGB, not clipped. White has Y = 1.
#[inline]
pub fn xyz_to_linear_srgb(xyz: Xyz) -> Rgb {
    RgbSpace::Srgb.from_xyz(xyz)
}

/// Converts linear sRGB to XYZ. White has Y = 1.
#[inline]
pub fn linear_srgb_to_xyz(rgb: Rgb) -> Xyz {
    RgbSpace::Srgb.to_xyz(rgb)
}

/// Where the branches of the sRGB curve meet, as a linear component. The rounded thresholds of the
/// standard (0.0031308 and 0.04045) leave a gap of 10⁻⁸, and the inverse would be inexact.
const SRGB_JUNCTION: f64 = 0.003_130_668_442_500_6;

/// Encodes a linear component as an sRGB signal (IEC 61966-2-1) by an odd function.
pub fn encode_srgb(component: f64) -> f64 {
    let x = component.abs();
    let signal = if x <= SRGB_JUNCTION { 12.92 * x } else { 1.055 * powf(x, 1.0 / 2.4) - 0.055 };
    signal.copysign(component)
}

/// Inverts [`encode_srgb`].
pub fn decode_srgb(signal: f64) -> f64 {
    let x = signal.abs();
    let component = if x <= 12.92 * SRGB_JUNCTION { x / 12.92 } else { powf((x + 0.055) / 1.055, 2.4) };
    component.copysign(signal)
}

/// The entries of the table of first estimates of codes. An estimate is at most one code too low,
/// because even at 0, where the curve is steepest, an entry is 12.92 · 255 / 4096 = 0.80 codes.
const CODE_TABLE_SIZE: usize = 4096;

/// Clips a linear component to [0, 1] and returns its nearest 8-bit sRGB code, which is
/// [`encode_srgb`] times 255, rounded. A table saves the computation of a power.
#[inline]
pub fn encode_srgb_u8(component: f64) -> u8 {
    struct CodeTable {
        guess: Vec<u8>,
        /// The smallest linear component of each code, and NaN, which no component reaches.
        least: [f64; 257],
    }
    static TABLE: OnceLock<CodeTable> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        let mut least = [f64::NAN; 257];
        least[0] = f64::NEG_INFINITY;
        (1..256_u16).for_each(|code| least[usize::from(code)] = decode_srgb((f64::from(code) - 0.5) / 255.0));
        let code_of = |i: usize| least.partition_point(|&least| least <= i as f64 / CODE_TABLE_SIZE as f64) - 1;
        CodeTable { guess: (0..=CODE_TABLE_SIZE).map(|i| code_of(i) as u8).collect(), least }
    });
    // The conversion to an integer turns NaN into 0.
    let code = table.guess[((component * CODE_TABLE_SIZE as f64) as usize).min(CODE_TABLE_SIZE)];
    code + u8::from(component >= table.least[usize::from(code) + 1])
}

/// Clips a colour to sRGB and formats it as `#rrggbb`.
pub fn srgb_hex(rgb: Rgb) -> String {
    let [r, g, b] = rgb.map(encode_srgb_u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_of_srgb_is_the_published_one() {
        let published = [
            [3.240_969_941_904_521, -1.537_383_177_570_093, -0.498_610_760_293],
            [-0.969_243_636_280_879_4, 1.875_967_501_507_72, 0.041_555_057_407_175_56],
            [0.055_630_079_696_993_59, -0.203_976_958_888_976_5, 1.056_971_514_242_878],
        ];
        for (row, known) in SRGB.from_xyz.iter().zip(published) {
            for (entry, known) in row.iter().zip(known) {
                assert!((entry - known).abs() < 1e-14, "{entry} {known}");
            }
        }
    }

    #[test]
    fn luminance_weights_are_the_published_ones() {
        for (space, weights) in [
            (RgbSpace::Srgb, [0.2126, 0.7152, 0.0722]),
            (RgbSpace::DisplayP3, [0.2290, 0.6917, 0.0793]),
            (RgbSpace::Rec2020, [0.2627, 0.6780, 0.0593]),
            (RgbSpace::AcesCg, [0.2722, 0.6741, 0.0537]),
        ] {
            for (found, known) in space.luminance_weights().iter().zip(weights) {
                assert!((found - known).abs() < 5.1e-5, "{space:?}: {found} {known}");
            }
        }
    }

    #[test]
    fn fast_codes_are_the_rounded_codes() {
        for i in -10..=70_000 {
            let component = f64::from(i) / 65_536.0;
            let exact = (255.0 * encode_srgb(component)).round().clamp(0.0, 255.0) as u8;
            assert_eq!(encode_srgb_u8(component), exact, "{component}");
        }
        assert_eq!(encode_srgb_u8(f64::NAN), 0);
        assert_eq!(encode_srgb_u8(f64::INFINITY), 255);
        assert_eq!(srgb_hex([1.0, 0.0, decode_srgb(128.0 / 255.0)]), "#ff0080");
    }

    #[test]
    fn decoding_inverts_encoding_also_at_the_junction() {
        for space in RgbSpace::ALL {
            for i in -3000..=3000 {
                let component = f64::from(i) * 1e-5;
                assert!((space.decode(space.encode(component)) - component).abs() < 1e-12, "{space:?} {component}");
            }
            assert!((space.encode(1.0) - 1.0).abs() < 1e-12);
        }
        let gap = encode_srgb(SRGB_JUNCTION.next_up()) - encode_srgb(SRGB_JUNCTION);
        assert!(gap.abs() < 1e-12, "{gap}");
    }

    #[test]
    fn the_white_of_a_picture_is_white_in_every_space() {
        for space in RgbSpace::ALL {
            let rgb = apply(&space.picture_matrix(), RgbSpace::Srgb.white());
            assert!(rgb.iter().all(|component| (component - 1.0).abs() < 1e-12), "{space:?} {rgb:?}");
        }
    }
}
