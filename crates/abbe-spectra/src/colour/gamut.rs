//! Gamut mapping: moves colours that a display cannot show to linear components in [0, 1].

use super::by_name;
use super::coordinates;
use super::space::RgbSpace;
use super::tristimulus::{Rgb, Xyz};
use crate::error::Result;
use serde::{Deserialize, Serialize};

/// The method of mapping colours into the gamut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GamutMapping {
    /// Compresses the chroma of the whole picture before the tone curve
    /// ([`ChromaCompression`](super::compression::ChromaCompression)), so that spectra keep their
    /// order and their gradations. What is outside after the tone curve is desaturated.
    #[default]
    Compress,
    /// Moves the colour towards the grey of equal luminance until it is inside the gamut.
    Desaturate,
    /// Clips each component.
    Clip,
    /// Moves the colour towards the grey of equal Oklab lightness and hue until it is inside.
    Oklab,
}

impl GamutMapping {
    /// Every mapping.
    pub const ALL: [Self; 4] = [Self::Compress, Self::Desaturate, Self::Clip, Self::Oklab];

    /// Returns the name of the mapping.
    pub fn name(self) -> &'static str {
        match self {
            Self::Compress => "compress",
            Self::Desaturate => "desaturate",
            Self::Clip => "clip",
            Self::Oklab => "oklab",
        }
    }

    /// Returns a mapping by its name (`compress`, `desaturate`, `clip` or
    /// `oklab`), or an error.
    pub fn by_name(name: &str) -> Result<Self> {
        by_name("gamut mapping", name, &Self::ALL.map(|any| (any.name(), any)))
    }

    /// Maps a colour into the gamut after the tone curve. Colours inside it are not changed.
    #[inline]
    pub fn map(self, rgb: Rgb, space: RgbSpace) -> Rgb {
        match self {
            Self::Compress | Self::Desaturate => desaturate(rgb, space),
            Self::Clip => clip(rgb),
            Self::Oklab => oklab(rgb, space),
        }
    }
}

/// Returns the brightest sRGB colour with the chromaticity of `linear_srgb`, desaturated if that is
/// outside sRGB, or black if no component is positive.
pub fn brightest(linear_srgb: Rgb) -> Rgb {
    let most = linear_srgb.into_iter().fold(0.0, f64::max);
    if most > 0.0 { desaturate(linear_srgb.map(|component| component / most), RgbSpace::Srgb) } else { [0.0; 3] }
}

/// Returns true if all components are in [0, 1].
#[inline]
pub fn contains(rgb: Rgb) -> bool {
    rgb.iter().all(|component| (0.0..=1.0).contains(component))
}

/// Clips a value to [0, 1]. NaN becomes 0, whereas `clamp` returns NaN.
#[inline]
fn unit(value: f64) -> f64 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Clips each component to [0, 1]. NaN becomes 0.
#[inline]
pub fn clip(rgb: Rgb) -> Rgb {
    rgb.map(unit)
}

/// Moves the colour towards the grey of equal luminance until it is inside the gamut. A luminance
/// in [0, 1] is preserved; above, the result is white, and below, black.
#[inline]
pub fn desaturate(rgb: Rgb, space: RgbSpace) -> Rgb {
    if contains(rgb) {
        return rgb;
    }
    let weights = space.luminance_weights();
    let luminance = weights[0] * rgb[0] + weights[1] * rgb[1] + weights[2] * rgb[2];
    let grey = unit(luminance);
    if grey != luminance {
        return [grey; 3];
    }
    // The largest fraction of the way from grey to the colour that stays inside [0, 1].
    let mut fraction: f64 = 1.0;
    for component in rgb {
        if component < 0.0 {
            fraction = fraction.min(grey / (grey - component));
        } else if component > 1.0 {
            fraction = fraction.min((1.0 - grey) / (component - grey));
        }
    }
    clip(rgb.map(|component| grey + fraction * (component - grey)))
}

/// Reduces the Oklab chroma of the colour, at constant Oklab lightness and hue, until the colour is
/// inside the gamut. The chroma is the largest possible one to a precision of one part in 10⁶.
pub fn oklab(rgb: Rgb, space: RgbSpace) -> Rgb {
    if contains(rgb) {
        return rgb;
    }
    // Oklab is relative to D65, to which the inverse picture matrix maps every white.
    let (to_d65, from_d65) = (to_d65(space), from_d65(space));
    let [lightness, a, b] = coordinates::oklab(to_d65(rgb));
    let grey = from_d65(coordinates::from_oklab([unit(lightness), 0.0, 0.0]));
    if !(lightness > 0.0 && lightness < 1.0) {
        return clip(grey);
    }
    let with_chroma = |fraction: f64| from_d65(coordinates::from_oklab([lightness, fraction * a, fraction * b]));
    let (mut inside, mut outside) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = 0.5 * (inside + outside);
        if contains(with_chroma(middle)) { inside = middle } else { outside = middle }
    }
    clip(with_chroma(inside))
}

fn to_d65(space: RgbSpace) -> impl Fn(Rgb) -> Xyz {
    let matrix = super::matrix::inverse(&space.picture_matrix());
    move |rgb| super::matrix::apply(&matrix, rgb)
}

fn from_d65(space: RgbSpace) -> impl Fn(Xyz) -> Rgb {
    let matrix = space.picture_matrix();
    move |xyz| super::matrix::apply(&matrix, xyz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sodium_light_keeps_its_luminance() {
        // Low-pressure sodium at Y = 0.3.
        let rgb = [2.771_426_5, 0.587_216_4, -0.128_436_9].map(|component| 0.3 * component);
        let mapped = desaturate(rgb, RgbSpace::Srgb);
        let luminance =
            |rgb: Rgb| -> f64 { RgbSpace::Srgb.luminance_weights().iter().zip(rgb).map(|(w, c)| w * c).sum() };
        assert!(contains(mapped) && (luminance(mapped) - luminance(rgb)).abs() < 1e-12, "{mapped:?}");
        assert_eq!(mapped[2], 0.0);
    }

    #[test]
    fn too_bright_colours_are_white_and_negative_ones_black() {
        for mapping in [GamutMapping::Compress, GamutMapping::Desaturate, GamutMapping::Oklab] {
            assert_eq!(mapping.map([9.0, 7.0, 8.0], RgbSpace::Srgb).map(|c| (c * 1e6).round()), [1e6; 3]);
            assert_eq!(mapping.map([-0.1, -0.2, -0.3], RgbSpace::Srgb), [0.0; 3]);
        }
        for mapping in GamutMapping::ALL {
            assert!(contains(mapping.map([f64::NAN, 0.5, -1.0], RgbSpace::Srgb)), "{mapping:?}");
        }
    }
}
