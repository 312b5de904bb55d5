//! Colorimetry: tristimulus values of light, and the quantities computed from them.
//!
//! The XYZ of a spectrum Φ are the integrals ∫ Φ x̄ dλ, ∫ Φ ȳ dλ and ∫ Φ z̄ dλ without the factor
//! 683, so they have a radiometric unit, like Φ. RGB values are linear unless a name contains
//! `encode`, and they may be negative or above 1 until [`gamut`] maps them.

pub mod adaptation;
pub mod compression;
pub mod coordinates;
pub mod difference;
pub mod dominant;
pub mod gamut;
pub mod lamps;
pub mod matching;
mod matrix;
pub mod regress;
pub mod rendering;
pub mod rendition;
pub mod report;
pub mod space;
pub mod temperature;
pub mod tone;
pub mod transfer;
mod tristimulus;

pub use adaptation::{AdaptationTransform, adapt, adaptation};
pub use coordinates::{from_lab, from_luv, from_oklab, from_xy, lab, luv, oklab, uv1960, uv1976, xy};
pub use difference::{LightDifference, delta_e_76, delta_e_2000, light_difference};
pub use dominant::{DominantWavelength, dominant};
pub use lamps::{LampComparison, PatchDifference, compare_lights};
pub use matching::{PrimaryMatch, match_primaries};
pub use rendering::{ColourRendering, cri, cri_in_steps};
pub use rendition::{ColourRendition, rendition, rendition_in_steps};
pub use report::ColourReport;
pub use space::{RgbSpace, decode_srgb, encode_srgb, encode_srgb_u8, linear_srgb_to_xyz, srgb_hex, xyz_to_linear_srgb};
pub use temperature::{CorrelatedTemperature, cct_duv};
pub use transfer::{Transfer, output_space_by_name};
pub use tristimulus::{Rgb, Xyz};

use crate::error::{Error, Result};

/// Returns the value with this name in any letter case, or an error that lists the names of all.
fn by_name<T: Copy>(kind: &str, name: &str, all: &[(&str, T)]) -> Result<T> {
    let named = all.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
    named.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(known, _)| *known).collect();
        Error::unknown_name(kind, name, names.iter().copied()).expected(names.join(", "))
    })
}
