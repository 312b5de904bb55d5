//! The plan of a render: which effects the scene needs, and how each is computed. [`prepare()`]
//! turns the facts of a scene into a [`Plan`] by the table [`EFFECTS`], [`partition`] assigns each
//! class of light paths to an estimator, and [`budget`] sets passes, photons and memory.

pub mod budget;
mod decide;
mod effect_parts;
mod effect_table;
mod effects;
pub mod explain;
mod fields;
mod negligible;
pub mod partition;
mod path_class;
mod prepare;
mod tally;
mod unpolarised;

pub use budget::{Budget, PHOTON_DOUBLINGS, PHOTON_HALVINGS};
pub use decide::{EffectRow, EffectState};
pub use effect_table::EFFECTS;
pub use effects::{Effect, EffectId};
pub use fields::{
    AimPlan, AperturePlan, CausticPlan, DirectPlan, IndirectPlan, MediumPlan, MotionPlan, Plan, PolarisationPlan, Rim,
    VolumeDirectLighting, VolumePlan, WavelengthPlan,
};
pub use path_class::{CameraEvents, LightOrigin, PathClass};
pub use prepare::prepare;
pub use tally::Tally;
