//! The reference path tracer.

mod limit;
mod medium;
pub(super) mod tracer;
