//! From camera paths to spectral radiance: the camera walk over mirrors, glass and glossy surfaces
//! (`camera`), light straight from the lights by next-event estimation (`direct`), light of photons
//! on surfaces by density estimation (`density`), emission, scattering and attenuation along the
//! path (`media`), the glare of luminaires, the light of fluorophores (`luminescence`), and the
//! reference path tracer, which uses no photons (`path_tracer`).

mod camera;
mod camera_pass;
mod density;
mod direct;
mod glare;
mod light_trials;
mod luminescence;
mod media;
mod path_tracer;
mod polarised;

pub use camera::path::PathBuffers;
pub use camera::sampler::{PixelSampler, sensor_pdf};
pub use camera::visible_point::{CameraSegment, VisiblePoint};
pub use camera_pass::{CameraPass, TruncatedMaps};
pub use density::gather_point::{NORMAL_TOLERANCE, PLANE_TOLERANCE};
pub use density::responses::SensorResponses;
pub use density::surface_extent::{SurfaceExtent, SurfaceExtentSurvey, SurfaceExtents};
pub use direct::learned_lights::LightTrial;
pub use direct::lighting::{DirectLighting, power_heuristic};
pub use direct::portals::{PORTAL_FRACTION, PortalSpheres, Portals};
pub use direct::selection::LightSelector;
pub use glare::Glare;
pub use path_tracer::tracer::PathTracer;
