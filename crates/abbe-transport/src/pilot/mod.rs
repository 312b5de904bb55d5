//! The pilot: everything that runs once before pass 0, with its own random streams. It fixes all
//! data that passes must not learn from each other, the
//! [`PassParameters`](crate::pass::PassParameters). `docs/method/pilot.md` describes the
//! measurements and the reasons for their constants.
//!
//! `portals` and `learned_lights` find where shadow rays go, before [`Pilot::run`] starts. `aims`,
//! `importance` and `guiding_spheres` learn the emission distributions. `measure` fixes the first
//! kernel radii and the photons that media store (`survey`, `volume_radii`, `volume_samples`,
//! `keep_probability`), and the surface extents (`surface_extents`). `trial`, `small_pass`, `work`,
//! `balance` and `camera_samples` decide how many photons and camera samples a pass has, within the
//! `pass_size` of a time limit. `sensor_radii` fixes the kernels of meters. `coarse` renders
//! pictures before the first pass.

mod aims;
mod balance;
mod camera_samples;
mod coarse;
mod gathering;
mod guiding_spheres;
mod importance;
mod keep_probability;
mod learned_lights;
mod measure;
mod pass_size;
mod portals;
mod run;
mod sensor_radii;
mod small_pass;
mod surface_extents;
mod survey;
mod trial;
mod volume_radii;
mod volume_samples;
mod work;

pub(crate) use aims::{LearnedAims, PATHS_PER_STRATUM, learn_aims};
pub use coarse::{CoarseLevel, CoarsePicture, coarse_path_picture};
pub use learned_lights::learn_lights;
pub use pass_size::PassSize;
pub use portals::find_portals;
pub use run::Pilot;
