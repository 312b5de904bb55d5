//! Optics of surfaces, media and lenses. The functions depend only on angle, refractive index and
//! wavelength. They do not depend on the scene.
//!
//! - [`fresnel`]: reflectance and refraction at a smooth interface.
//! - [`glass`]: the refractive index n(λ) and the catalogue of glasses.
//! - [`microfacet`]: the GGX distribution of rough interfaces.
//! - [`grating`]: directions and efficiencies of diffraction gratings.
//! - [`thin_film`]: interference in stacks of thin films.
//! - [`fluorophore`]: absorption and emission of fluorescent materials.
//! - [`donaldson`]: measured bispectral matrices.
//! - [`fluorescent_samples`]: fluorescent surfaces for the comparison of lamps.
//! - [`bsdf`]: the scattering functions of surfaces.
//! - [`phase`]: the phase functions of media.
//! - [`aperture`]: polygonal apertures and their Fraunhofer diffraction.
//! - [`lens`]: ray tracing through lenses of several elements.
//! - [`prism`]: exact formulas for a prism, used as a reference in tests.

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
