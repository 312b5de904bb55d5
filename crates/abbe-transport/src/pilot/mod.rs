//! The pilot: everything that runs once before pass 0.
//!
//! The pilot has its own random streams. It fixes all data that passes must not learn from each
//! other, the [`PassParameters`](crate::pass::PassParameters). The pilot uses `pass`, and no pass
//! uses the pilot.
//!
//! - `portals` and `learned_lights`: where shadow rays go, found before [`Pilot::run`].
//! - `aims`, `importance` and `guiding_spheres`: the emission distributions.
//! - `survey`, `volume_radii`, `volume_samples`, `keep_probability`, `surface_extents` and
//!   `sensor_radii`: the first kernel radii and what belongs to them. `measure` calls them.
//! - `trial`, `small_pass`, `work`, `balance` and `camera_samples`: how many photons and how many
//!   camera samples a pass has.
//! - `coarse`: a picture to look at before the first pass.
//! - `run`: all of this, in order.

mod aims;
mod balance;
mod camera_samples;
mod coarse;
mod guiding_spheres;
mod importance;
mod keep_probability;
mod learned_lights;
mod measure;
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

pub(crate) use aims::{LearnedAims, learn_aims};
pub use coarse::coarse_path_picture;
pub use learned_lights::learn_lights;
pub use portals::find_portals;
pub use run::Pilot;
