//! Photon paths: emission from the lights, and tracing through the scene.

mod aim;
pub mod connect;
mod fluorescence;
mod guiding_spheres;
mod launch;
mod light_sampler;
mod medium;
mod photon_path;
mod ribbon;
mod source;
mod spectrum_coverage;
mod strata;
mod trace;
mod visitor;

pub use aim::{Aim, CELLS};
pub use launch::{Launch, RibbonPart};
pub use light_sampler::LightSampler;
pub use photon_path::{PhotonDepth, PhotonState};
pub use ribbon::{EmittedPower, RibbonPainter, RibbonTally};
pub use source::{PhotonSource, WavelengthSampling};
pub use spectrum_coverage::SpectrumCoverage;
pub use strata::{EmissionStrata, Stratum};
pub use trace::trace;
pub use visitor::{MediumCollision, MediumCrossing, PhotonFlight, PhotonVisitor, SurfaceArrival};
