//! Colorimetry: tristimulus values of light, and all quantities computed from these values.
//!
//! The XYZ values of a spectrum Φ are the integrals ∫ Φ x̄ dλ, ∫ Φ ȳ dλ and ∫ Φ z̄ dλ. The factor
//! 683 is left out, so XYZ values have a radiometric unit, like Φ. RGB values are linear unless a
//! name contains `encode`, and they may be negative or above 1 until [`gamut`] maps them.

pub mod adaptation;
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
pub use tristimulus::{Rgb, Xyz};
