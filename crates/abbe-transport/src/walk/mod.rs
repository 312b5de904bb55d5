//! Path segments of photons and of camera paths: the search for the next surface along a ray, the
//! media before it, and the scattering there.

mod body_mode;
mod caustic_weights;
mod crystal;
mod depth_limit;
pub mod ledger;
mod medium_segment;
mod next_interaction;
mod polarisation;
mod polarising_pane;
mod ray_state;
mod scatter;
mod scatter_coated;
mod scattered_ray;
mod sink;
mod stop_flag;
mod surface_interaction;
mod transmittance;

pub use body_mode::{BodyMode, WithBodies, WithoutBodies};
pub use caustic_weights::{CausticWeights, RayDensities, RayDensity, StratumDensity};
pub(crate) use crystal::scatter_at_crystal;
pub use depth_limit::{DepthLimit, LONG_PATH, MAX_EVENTS, TruncatedLight, long_path_survival};
pub use medium_segment::{MediumSegment, NumberedMedium, for_each_segment};
pub use next_interaction::{SegmentEnd, next_interaction, next_interaction_in_air, next_interaction_through_media};
pub use polarisation::PhotonPolarisation;
pub(crate) use polarisation::{PathMatrices, event_at_camera_filter, pane_matrix, rotation_to_picture};
pub use polarising_pane::PolarisingPane;
pub use ray_state::RayState;
pub use scatter::{scatter, scatter_all_wavelengths};
pub use scattered_ray::ScatteredRay;
pub(crate) use scattered_ray::single_lane;
pub use sink::{SensorResponse, Sink};
pub use stop_flag::{NEVER_STOP, StopFlag};
pub use surface_interaction::{SurfaceInteraction, SurfaceLookup};
pub use transmittance::{
    PathTransmittance, SegmentTransmittance, bias_of_excess, crosses_more_panes, excess_optical_depth,
    light_between_panes, path_transmittance, path_transmittance_tracked, transmittance,
};
