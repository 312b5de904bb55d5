//! Pictures that have known answers: closed forms, conservation of energy, and two methods that
//! share no estimator.
//!
//! `cargo test --release --test physics` runs the fast versions; `cargo test --release --test
//! physics -- --ignored` the slow ones. Add `--nocapture` to read the measured figures.

#[path = "../common/mod.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod common;
#[path = "../golden/mod.rs"]
mod golden;

mod bands;
mod calibration;
mod caustic_colours;
mod chart;
mod chromatic_media;
mod competing_techniques;
mod crystals;
mod depth_limits;
mod diffraction;
mod dyes;
mod final_gather;
mod fluorescence;
mod fluorescence_through_lenses;
mod fluorescent_plates;
mod free_and_shared;
mod furnace;
mod glare;
mod gratings;
mod halo;
mod interval_coverage;
mod irradiance;
mod large_worlds;
mod lens_foci;
mod lens_objects;
mod lens_reflections;
mod lens_system;
mod long_paths;
mod many_lights;
mod matrix;
mod media;
mod media_faces;
mod media_in_bodies;
mod media_kernels;
mod media_light_map;
mod media_methods;
mod media_single_scattering;
mod meter_closed_forms;
mod meters;
mod motion;
mod nesting;
mod oriented_ice;
mod orthographic;
mod photon_and_path;
mod polarised_light;
mod prism;
mod rainbow;
mod ray_files;
mod references;
mod ribbons;
mod shading_normals;
mod sky;
mod spectral_linearity;
mod textures;
mod thin_films;
mod thin_lens;
mod total_reflection;
mod ultraviolet;
mod walls;
