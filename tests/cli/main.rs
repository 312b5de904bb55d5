//! The command line: what `abbe` prints, writes and returns, run as a user runs it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod abbe_command;
mod browser;
#[path = "../common/mod.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod common;
#[path = "../golden/mod.rs"]
mod golden;
mod study_scene;

mod blender_export;
mod checkpoints;
mod crystal;
mod denoise;
mod develop;
mod diffraction;
mod display_server;
mod explain;
mod film;
mod films_and_gratings;
mod frames;
mod gates;
mod guides;
mod import;
mod inputs_stay;
mod lamps;
mod layers;
mod lens;
mod library;
mod many_bodies;
mod measure;
mod pages;
mod pictures;
mod preview;
mod processors;
mod reference;
mod regress;
mod render;
mod slurm;
mod spectral_environment;
mod spectral_exr;
mod study;
