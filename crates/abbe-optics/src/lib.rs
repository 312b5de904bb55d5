//! Optics of surfaces, media and lenses, by wavelength: glasses, thin films, gratings, lens
//! designs, BSDFs and phase functions.
//!
//! No function depends on a scene: each takes wavelengths, directions and the properties of a
//! surface, a medium or a lens. The crate therefore also serves as a calculator: for the index of a
//! glass, the reflectance of a coating, the efficiencies of a grating, or the spot sizes of a Zemax
//! lens.
//!
//! To add a glass, a material or a phase function, follow the recipe in `CONTRIBUTING.md`. A new
//! material is a file in `src/bsdf/`, and a new phase function is a file in `src/phase/`.
//!
//! ```
//! use abbe_optics::glass::{RefractiveIndex, lines};
//! use abbe_optics::{fresnel, lens};
//!
//! let crown = RefractiveIndex::catalogue("N-BK7")?;
//! assert!((crown.n(lines::D_NM) - 1.5168).abs() < 1e-4);
//! let reflected = fresnel::dielectric(1.0, 1.0, crown.n(550.0));
//! assert!((reflected - 0.0424).abs() < 1e-4);
//!
//! let design = lens::catalogue::find("double-gauss")?;
//! let paraxial = design.at(lines::D_NM).paraxial()?;
//! assert!((paraxial.efl_mm - 100.0).abs() < 1.0);
//! # Ok::<(), abbe_spectra::Error>(())
//! ```
//!
//! The folder `examples/` prints the dispersion of a glass (`index_of_a_glass`), the colours of
//! soap and oil films (`film_colours`), and the figures of a Zemax file (`zemax_lens`).
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`glass`] | the refractive index n(λ), dispersion formulas, the catalogue, AGF and refractiveindex.info files |
//! | [`fresnel`] | reflectance and refraction at a smooth interface |
//! | [`thin_film`] | interference in stacks of thin films |
//! | [`grating`] | directions and efficiencies of diffraction gratings |
//! | [`lens`] | ray tracing through lenses of several elements, the lens catalogue, Zemax files |
//! | [`aperture`] | polygonal apertures and their Fraunhofer diffraction |
//! | [`microfacet`] | the GGX distribution of rough interfaces |
//! | [`fluorophore`] | absorption and emission of fluorescent materials |
//! | [`donaldson`] | measured bispectral matrices |
//! | [`fluorescent_samples`] | fluorescent surfaces for the comparison of lamps |
//! | [`texture`] | spectra and numbers that vary over a surface |
//! | [`bsdf`] | the scattering functions of surfaces |
//! | [`phase`] | the phase functions of media, Mie scattering |
//! | [`prism`] | exact formulas of a prism, as a reference for tests |
//!
//! # Units and conventions
//!
//! A wavelength is given in nm, as measured in air. Lens prescriptions are in mm and scenes in m.
//! The complex index is n + ik, and k > 0 absorbs. In the local frame of a surface, z is the
//! outward normal. Paths arrive along −`wo` and continue along `wi`, so both vectors point away
//! from the surface. The cosine of a phase function is that between the directions of propagation,
//! so forward scattering has +1. A roughness α is that of the GGX distribution.
//!
//! # Dependencies
//!
//! The crate depends on [`abbe_spectra`], whose [`Spectrum`](abbe_spectra::Spectrum) and
//! [`Error`](abbe_spectra::Error) appear in its interface. `abbe-scene` depends on this crate and
//! stores its materials, media and lenses, and `abbe-transport` evaluates them.
//! `abbe-polarisation`, `abbe-format`, `abbe-import`, `abbe-session` and the program `abbe` depend
//! on it too.

#![warn(missing_docs)]

pub mod aperture;
pub mod bsdf;
pub mod donaldson;
pub mod fluorescent_samples;
pub mod fluorophore;
pub mod fresnel;
pub mod glass;
pub mod grating;
pub mod lens;
pub mod microfacet;
pub mod phase;
pub mod prism;
pub mod texture;
pub mod thin_film;
mod zemax_text;

pub use bsdf::Bsdf;
pub use glass::RefractiveIndex;
pub use lens::Lens;
pub use phase::PhaseFunction;
