//! Renders of many passes in the renderer Abbe: stop rules, forecasts, checkpoints, merging,
//! pictures and reports.
//!
//! A [`render::Job`] is a planned scene, and [`render::Job::render`] repeats passes until a stop
//! rule is satisfied. The sums of the passes form a [`render::Run`], which can be saved, continued,
//! and merged with the runs of other passes to the same bits. The module [`output`] writes pictures
//! and reports.
//!
//! ```
//! use abbe_session::render::{Request, StopRules};
//! use std::time::Duration;
//!
//! // Stop at a relative error of 1 %, but after ten minutes at the latest.
//! let time = Some(Duration::from_secs(600));
//! let stop = StopRules { target_error: Some(0.01), time, ..StopRules::default() };
//! let request = Request { stop, ..Request::default() };
//! assert_eq!(request.stop.passes, None);
//! ```
//!
//! `examples/error_bar.rs` renders a scene that is built in code, and prints a pixel with its error
//! bar.
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`render`] | jobs, stop rules, progress, forecasts, statistics, checkpoints, parts, merging |
//! | [`output`] | EXR and PNG files, comparisons, plots; HTML pages with the feature `pages` |
//!
//! # Units and conventions
//!
//! The Y of a picture is in cd/m², and so are its noise and its bias. The noise is a standard error
//! from eight replicates, so it is unknown before the eighth pass. A pass depends only on the
//! scene, the seed and its number.
//!
//! # Dependencies
//!
//! [`abbe_transport`] computes the passes of a scene of [`abbe_scene`]; [`abbe_optics`] and
//! [`abbe_spectra`] supply optics and colour, and [`abbe_denoise`] denoises pictures.

// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod output;
pub mod render;
