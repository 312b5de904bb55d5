//! Density estimation: the radiance that leaves a surface point, from the photons around it.

pub(super) mod gather_point;
pub(super) mod photon_light;
pub(super) mod responses;
mod surface;
pub(super) mod surface_extent;
