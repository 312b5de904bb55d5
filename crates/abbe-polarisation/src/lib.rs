//! Polarised light and uniaxial crystals.
//!
//! A beam is a [`Stokes`] vector in a [`StokesFrame`], and whatever light meets is a [`Mueller`]
//! matrix: surfaces, films, plates, filters, air and drops. [`crystal`] splits rays at the surfaces
//! of calcite or quartz and computes their amplitudes, and [`interference`] gives the colours of
//! crystals between polarisers.
//!
//! All types of a light path are `Copy` and allocate nothing. Elements that do not mix s and p are
//! [`DiattenuatingRetarder`]s, whose products cost four multiplications of numbers. A photon may
//! store [`Stokes<f32>`], and a camera path carries a [`Mueller`].
//!
//! ```
//! use abbe_polarisation::surface::SurfaceMatrices;
//! use abbe_polarisation::{Mueller, Rotation, Stokes, filter};
//!
//! // Water reflects light at Brewster's angle, and a polariser removes what it reflects.
//! let cos = (1.0_f64 + 1.333 * 1.333).recip().sqrt();
//! let water = SurfaceMatrices::dielectric(cos, 1.0, 1.333);
//! let reflected = water.reflected * Stokes::unpolarised(1.0);
//! assert!((reflected.degree_of_polarisation() - 1.0).abs() < 1e-12);
//! let upright = Mueller::from(filter::IDEAL_POLARISER).turned(Rotation::degrees(90.0));
//! assert!((upright * reflected).power() < 1e-12);
//! ```
//!
//! The example `glare_on_water` turns this polariser.
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`surface`] | dielectrics with total reflection, metals, films, ellipsometric angles |
//! | [`sheet`] | plates and piles of plates |
//! | [`filter`] | polarisers, retarders, circular polarisers |
//! | [`scattering`], [`sky`], [`rainbow`] | air, spheres, the clear sky, the Descartes ray |
//! | [`jones`] | Jones vectors and matrices |
//! | [`crystal`] | double refraction, amplitudes, plates, prisms, the catalogue |
//! | [`interference`] | colours between polarisers |
//!
//! # Units and conventions
//!
//! Frames are right-handed (x, y, travel). S1 = |Ex|² − |Ey|², S2 > 0 at +45°, counter-clockwise
//! from x as the receiver sees it, and S3 > 0 for right-circular light, whose field turns clockwise
//! for the receiver. At a surface, x = s is perpendicular to the plane of incidence, and y = p =
//! travel × s for the incident, the reflected and the transmitted beam alike. Fields vary as
//! exp(−iωt), so metals have n + ik; the opposite sign conjugates amplitudes and does not change
//! Mueller matrices. Wavelengths are in nm.
//!
//! # Dependencies
//!
//! The crate depends on [`abbe_optics`], for film stacks, indices and Mie series, and on
//! [`abbe_spectra`]. `abbe-format`, `abbe-transport` and the program `abbe`
//! depend on it.

#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod crystal;
mod diattenuating_retarder;
pub mod filter;
mod frame;
pub mod interference;
pub mod jones;
mod mueller;
pub mod rainbow;
pub mod scattering;
mod scattering_event;
pub mod sheet;
pub mod sky;
mod stokes;
pub mod surface;

#[cfg(test)]
mod golden;

pub use diattenuating_retarder::DiattenuatingRetarder;
pub use frame::{Rotation, StokesFrame};
pub use mueller::Mueller;
pub use scattering_event::{ScatteringEvent, SurfaceDirections, smooth_elements};
pub use stokes::Stokes;
