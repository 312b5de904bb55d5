//! General mathematics that does not deal with light: random streams, low-discrepancy points,
//! sampling routines and their densities, distributions, quadrature, exact sums and frames.

pub mod cubic;
pub mod distribution;
pub mod frame;
pub mod kronecker;
pub mod quadrature;
pub mod random;
pub mod sobol;
pub mod sphere;
pub mod sum;
pub mod warp;
