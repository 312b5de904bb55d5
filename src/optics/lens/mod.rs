//! Lenses of several elements: prescriptions, exact rays, and the paraxial and real quantities that follow.
//!
//! The axis is z with the first vertex at 0; the scene lies towards −z, the sensor towards +z; lengths are in mm. Outside is air,
//! n = 1. A [`Prescription`] (built in: [`catalogue`]; read: [`zemax`]) becomes a checked [`Lens`]; [`Lens::at`] is the lens as one
//! wavelength sees it, which traces rays ([`Monochromatic::trace`]) without allocating and knows its cardinal points ([`Paraxial`]).
//! [`Analysis`] is what a lens designer looks at first; [`section`] is its drawing.

mod analysis;
pub mod catalogue;
mod field;
mod paraxial;
mod prescription;
mod profile;
pub mod section;
mod trace;
pub mod zemax;

pub use analysis::{Analysis, AtLine, FieldPoint, LINES};
pub use field::Spot;
pub use paraxial::{Paraxial, Pupil};
pub use prescription::{Lens, MAX_SURFACES, Opening, Prescription, Surface, medium};
pub use profile::Profile;
pub use trace::{Limits, Loss, Monochromatic, Ray, Travel};
