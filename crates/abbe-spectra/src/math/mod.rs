//! General mathematics that does not deal with light.

pub mod complex;
pub mod cubic;
pub mod distribution;
pub mod elementary;
pub mod fourier;
pub mod frame;
pub mod kronecker;
pub mod noise;
pub mod quadrature;
pub mod random;
pub mod rotation;
pub mod sobol;
pub mod sort;
pub mod sphere;
pub mod sum;
pub mod warp;
