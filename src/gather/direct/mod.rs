//! Direct lighting by next-event estimation, with multiple importance sampling.

pub(super) mod lighting;
mod surface;
