//! The light transport of one pass: photons are traced and stored, and camera paths read them.
//!
//! The [`Pilot`] runs before pass 0. The pilot fixes all data that passes must not learn from each
//! other: the emission distributions, the first kernel radii, the number of photons per set, and
//! the probabilities of storing photons in media. Each pass then depends only on the scene, the
//! seed and its own index. The sums of all passes are in [`PassSums`].

mod aims;
mod balance;
mod camera_samples;
mod coarse;
mod context;
mod deposits;
mod exposure;
mod first_surface;
mod importance;
mod keep_probability;
mod learned_lights;
mod openings;
mod outlines;
mod path_pass;
mod photon_pass;
mod photon_paths;
mod pilot;
mod receptors;
mod recorder;
mod small_pass;
mod sums;
mod survey;
mod targets;
mod trace;
mod trial;
mod volume_radii;
mod volume_samples;
mod work;

pub use coarse::coarse_path_picture;
pub use context::PassContext;
pub use learned_lights::learn_lights;
pub use openings::find_openings;
pub use path_pass::path_pass;
pub use photon_pass::photon_pass;
pub use photon_paths::{PathQuery, PhotonPaths, RecordedPath, RecordedSegment, photon_paths};
pub use pilot::Pilot;
pub use sums::{PassSums, StageSeconds};
