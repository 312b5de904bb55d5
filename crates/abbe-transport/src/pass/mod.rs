//! The light transport of one pass: photons are traced and stored, and camera paths read them.
//!
//! A pass depends only on the scene, the seed, its own index, and the [`PassParameters`]. The sums
//! of all passes are in [`PassSums`].

mod context;
mod deposits;
mod exposure;
mod first_surface;
mod keep_probability;
mod parameters;
mod path_pass;
mod photon_pass;
mod recorder;
mod sensors;
mod sums;
mod trace;

pub use context::PassContext;
pub use parameters::PassParameters;
pub use path_pass::path_pass;
pub use photon_pass::photon_pass;
pub use sums::{PassSums, StageSeconds};

// For the pilot.
pub(crate) use context::EmissionRequest;
pub(crate) use deposits::{PhotonDeposits, VolumeDeposits};
pub(crate) use keep_probability::{KEEP_ALL, KeepProbability};
pub(crate) use parameters::CameraSamples;
pub(crate) use recorder::RecordingOptions;
pub(crate) use sensors::{PointDisks, crossing};
pub(crate) use trace::trace_photons;
