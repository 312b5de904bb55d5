//! The scene: as written, and what it means.

pub mod file;
