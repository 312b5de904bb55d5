//! Light transport.

// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod emit;
pub mod gather;
pub mod map;
pub mod pass;
pub mod photon_paths;
pub mod pilot;
pub mod plan;
pub mod sensor;
pub mod walk;
