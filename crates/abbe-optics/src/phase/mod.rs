//! Phase functions of participating media.
//!
//! Convention: cos θ = ω_in · ω_out with both directions along the propagation of the light, so
//! forward scattering has cos θ = +1. Every phase function is a density per steradian that
//! integrates to 1 over the sphere.

mod function;
mod henyey_greenstein;
pub mod mie;
mod mixture;
mod rainbow;
mod rayleigh;
mod table;

#[cfg(test)]
mod contract;

pub use function::PhaseFunction;
pub use henyey_greenstein::MAX_MEAN_COSINE;
pub use mixture::PhaseMixture;
pub use rainbow::rainbow;
pub use table::{PhaseTable, parse as parse_table};
