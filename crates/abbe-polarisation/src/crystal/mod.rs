//! Uniaxial crystals: double refraction, amplitudes at a surface, plates and prisms.
//!
//! The crystal does not absorb, and the optical activity of quartz (21.7° per mm along its axis at
//! 589 nm) is not included. In the frame of a surface, z is the outward normal, and the crystal
//! fills z < 0. Wave vectors k are in units of ω/c, so the length of k is the index of the wave,
//! and the component of k along the surface is the same on both sides. The sources are Born & Wolf,
//! *Principles of Optics*, chapter 15, and Yeh, *Optical Waves in Layered Media*, chapter 9.

mod catalogue;
mod event;
mod indices;
mod plate;
mod prism;
mod surface;
mod wave;

pub use catalogue::{CRYSTAL_NAMES, Crystal};
pub use event::{CrystalEvent, CrystalEvents, CrystalRay, CrystalTracing};
pub use indices::UniaxialIndices;
pub use plate::{CrystalPlate, conoscopic_phase};
pub use prism::{glan_foucault_angles_deg, rochon_exits_deg, wollaston_exits_deg};
pub use surface::{CrystalSurface, SurfaceAmplitudes};
pub use wave::{CrystalMode, CrystalWave};
