//! Density estimation on surfaces: computes the radiance that leaves a point from the photons
//! around this point.

pub(super) mod gather_point;
pub(super) mod responses;
mod surface;
pub(super) mod surface_extent;
