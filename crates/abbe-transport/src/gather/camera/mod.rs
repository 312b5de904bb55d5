//! The camera walk over mirrors, glass and glossy surfaces to the first diffuse surface.

mod direct;
pub(super) mod path;
pub(super) mod sampler;
mod scatter;
mod sensor;
pub(super) mod throughput;
pub(super) mod visible_point;
mod walk;
