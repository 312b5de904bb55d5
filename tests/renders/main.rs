//! Whole renders and the plan: bit-identical pictures on any number of threads, a balanced ledger,
//! and effects that never happen where a scene does not call for them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod common;

mod camera_samples;
mod coarse_picture;
mod example_scenes;
mod exposures;
mod layers;
mod missing_light;
mod photon_paths;
mod plan_films;
mod plan_forced;
mod plan_light_map;
mod plan_negligible;
mod plan_polarisation;
mod plan_ultraviolet;
mod responses;
mod whole;
