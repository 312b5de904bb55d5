//! Tests without renders: data and formulas against independently computed values, laws that hold
//! for all arguments, the scene language, and the structure of the source.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod common;
#[path = "../golden/mod.rs"]
mod golden;

mod all_faults;
mod architecture;
mod bad_scenes;
mod body_ranks;
mod colour_golden;
mod colour_properties;
mod crystal_scene;
mod diamond_mesh;
mod fluorescence_files;
mod grating_golden;
mod lens_curves;
mod lens_golden;
mod lens_properties;
mod links;
mod media_golden;
mod media_scene;
mod optics_golden;
mod pure_properties;
mod regress_causes;
mod regress_golden;
mod rendition_golden;
mod scene_file;
mod spectrum_contract;
mod srgb_colours;
mod thin_film_golden;
