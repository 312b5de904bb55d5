//! Measures how much time a render needs for a given accuracy. A study renders a scene many times,
//! and compares every picture with a reference.
//!
//! It answers four questions. How fast does the error of each integrator fall ([`curves`])? Which
//! settings reach a given error first ([`sweep`])? How much time does every effect of the plan
//! take, and how much does it change the picture ([`effects`])? Which settings should a user choose
//! for a wanted error, and how long will the render take ([`recommendation`])?
//!
//! A study has a time budget, and its film is as large as this allows ([`film`]). The noise of the
//! reference is measured and subtracted from all errors ([`reference_choice`], [`mod@reference`]).
//! Every render is a step, whose result is cached in a file for the next run. The results become
//! JSON, CSV, plots and an HTML page ([`report`], [`page`]).

mod convergence;
pub mod curves;
pub mod effects;
pub mod film;
pub mod fit;
mod monitor;
pub mod page;
pub mod recommendation;
pub mod reference;
pub mod reference_choice;
pub mod report;
mod run;
mod runner;
pub mod smooth_regions;
mod step_cache;
pub mod study_scene;
pub mod sweep;
mod time_fractions;

pub use convergence::ConvergencePoint;
pub use monitor::StudyMonitor;
pub use run::{PAGE, StudyOptions, StudyOutcome, run};
pub use study_scene::StudyScene;
pub use time_fractions::{TIME_FRACTIONS, TimeFractions};
