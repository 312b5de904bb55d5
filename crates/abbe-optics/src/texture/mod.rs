//! Textures: quantities that vary over a surface.
//!
//! A texture consists of a [`Pattern`], which maps the texture coordinates (u, v) of a surface
//! point to the number of a *texel*, and of a value for each texel: a spectrum
//! ([`SpectralTexture`]) or a number ([`ScalarTexture`]).
//!
//! Filters are stochastic: a lookup selects one texel with the probability of its weight in the
//! filter (M. Pharr, B. Wronski, M. Salvi and M. Fajardo, "Filtering After Shading with Stochastic
//! Texture Filtering", PACM CGIT 7, 2024). Radiance is linear in the filtered quantity, so its
//! expected value is that of the complete filter. A path vertex stores only the numbers of its
//! texels, and evaluates their spectra at any wavelength.
//!
//! The texture coordinates (0, 0) denote the upper left corner of a picture, with u to the right
//! and v downwards, as in glTF.

mod mapping;
mod normal;
mod palette;
mod pattern;
mod point;
mod pyramid;
mod scalar;
mod spectral;

pub use mapping::UvTransform;
pub use normal::NormalMap;
pub use pattern::{GradientPattern, NoisePattern, Pattern};
pub use point::{LookupRandom, Texel, TexturePoint};
pub use pyramid::{Filter, ImagePattern, ImageSize, Wrap};
pub use scalar::{ScalarTexture, SurfaceScalar};
pub use spectral::{SpectralTexture, SurfaceSpectrum};
