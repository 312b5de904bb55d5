//! Random streams, low-discrepancy points, warps with their densities, distributions, quadrature, exact sums, frames.

pub mod distribution;
pub mod frame;
pub mod kronecker;
pub mod quadrature;
pub mod random;
pub mod sobol;
pub mod sum;
pub mod warp;
