//! The reference path tracer.

mod medium;
pub(super) mod tracer;
