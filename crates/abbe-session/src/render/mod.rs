//! The render session: a [`Job`] is a planned scene, and [`Job::render`] runs the pilot, and then
//! passes until a stop rule is satisfied. A [`Run`] contains the sums of the passes so far, and can
//! be saved, continued, and merged with the runs of other passes.

mod denoise;
mod diffraction;
mod display;
mod forecast;
mod identity;
mod job;
mod layers;
mod measure;
mod merge;
mod missing_light;
mod monitor;
mod packed_sums;
mod part;
mod photon_paths;
mod request;
mod run;
mod saved_run;
mod scene_difference;
mod session;
mod stats;
mod stop;
mod threads;
mod transfer;

pub use abbe_transport::pass::StageSeconds;
pub use abbe_transport::photon_paths::{PathQuery, PhotonPaths, RecordedPath, RecordedSegment};
pub use abbe_transport::pilot::{CoarseLevel, CoarsePicture};
pub use denoise::denoised;
pub use diffraction::DiffractionSetup;
pub use display::DisplaySettings;
pub use forecast::{ErrorMilestone, Forecast, Forecasts, RunTimes};
pub use identity::RenderIdentity;
pub use job::Job;
pub use measure::{MeasurementReport, MeterReport, PointReport, Value};
pub use merge::{MergedPicture, PartSet};
pub use monitor::{Monitor, NoMonitor, Progress};
pub use part::PassPart;
pub use photon_paths::PointUnder;
pub use request::{Integrator, Request, StopRules};
pub use run::Run;
pub use saved_run::SavedRun;
pub use scene_difference::affects_passes;
pub use session::Rendered;
pub use stats::{EffectStats, ErrorStats, ForecastStats, LedgerStats, Stats, TypicalForecastStats};
pub use threads::{current_threads, on_threads};
pub use transfer::TakenPasses;
