//! The reference path tracer.

mod limit;
mod medium;
mod polarised;
mod sensor;
pub(super) mod tracer;
