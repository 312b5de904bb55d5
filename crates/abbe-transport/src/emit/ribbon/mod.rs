//! Ribbons: photons that paint their whole spectrum.
//!
//! Behind a dispersive surface, each wavelength λ of a photon takes its own way and lands at its own
//! point x(λ). As long as the sequence of surfaces stays the same, x is a smooth curve. A ribbon
//! traces the photon at a few wavelengths, its nodes, and paints the curve between neighbouring
//! nodes into the pixels that see it, with the power that the light emits between the wavelengths
//! at which the curve enters and leaves each pixel. A photon of a single wavelength would paint one
//! point of the curve.
//!
//! The wavelengths of a ribbon use the same random numbers, so that the light at λ is a function of
//! λ alone, and any rule that chooses an estimator for a part of the spectrum by the values of this
//! function at the nodes leaves the mean unchanged. [`nodes`] divides the spectrum: where the
//! nodes lie on a parabola, the ribbon is painted, and the other parts are sampled at one random
//! wavelength.
//!
//! A ribbon contains exactly the paths L S* R S* D: events at mirrors and at clear interfaces
//! without dispersion, one refraction or diffraction at the first dispersive surface, further
//! specular events, and a diffuse or glossy surface that the camera sees directly. [`RibbonPart`]
//! tells a photon of one wavelength whether it is such a path, which it then leaves to the ribbon.
//!
//! [`RibbonPart`]: super::RibbonPart

mod chain;
mod film_line;
mod nodes;
mod spectrum;

pub use nodes::{RibbonPainter, RibbonTally};
pub use spectrum::EmittedPower;
