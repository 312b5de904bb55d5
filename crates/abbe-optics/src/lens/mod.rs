//! Lenses of several elements: prescriptions, exact ray tracing, paraxial properties, and
//! properties computed from traced rays.
//!
//! The optical axis is z, with the first vertex at z = 0, the scene towards −z and the sensor
//! towards +z. Lengths are in mm. The surrounding medium is air, n = 1.
//!
//! A [`Prescription`] comes from the built-in [`catalogue`] or from a Zemax file ([`zemax`]), and
//! [`Lens::new`] validates it. [`Lens::at`] evaluates it at one wavelength. The resulting
//! [`MonochromaticLens`] traces rays without allocation ([`MonochromaticLens::trace`]), also with
//! losses at surfaces and with ghosts ([`MonochromaticLens::trace_with_losses`]), and computes
//! focal length, foci and pupils ([`Paraxial`]). [`LensAnalysis`] computes the figures of a design,
//! [`section`] a drawing.

mod analysis;
pub mod axial_colour;
pub mod catalogue;
mod clear_apertures;
mod conditions;
mod field;
pub mod field_curves;
pub mod folded;
mod freeform;
pub mod image_quality;
mod losses;
pub mod mtf;
mod paraxial;
mod prescription;
mod profile;
pub mod ray_fans;
pub mod section;
pub mod spot_diagram;
#[cfg(test)]
mod test_lens;
mod trace;
pub mod zemax;

pub use analysis::{FieldPoint, LensAnalysis, LineFocus};
pub use conditions::{AnalysisConditions, AnalysisLine, LINES, MAX_LINES, SensorFocus};
pub use field::LensSpot;
pub use losses::GhostPair;
pub use paraxial::{Paraxial, Pupil};
pub use prescription::{ApertureSpec, Lens, LensSurface, MAX_SURFACES, Prescription, medium};
pub use profile::{SurfaceProfile, TraceDirection};
pub use trace::{ApertureCheck, LensRay, MonochromaticLens, RayLoss};
