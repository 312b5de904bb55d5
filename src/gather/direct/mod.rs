//! Direct lighting by next-event estimation, with multiple importance sampling.

pub(super) mod lighting;
pub(super) mod openings;
mod surface;
