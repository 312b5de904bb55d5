//! The plan, proved: what a scene does not call for never happens, cannot be seen, and is off by the reasons given.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
#[expect(dead_code, reason = "shared with the tests of physics, which need more of it")]
mod common;

mod forced;
mod light_map;
mod negligible;
mod scenes;
