//! Direct lighting by next-event estimation, with multiple importance sampling.

pub(super) mod light_tree;
pub(super) mod lighting;
pub(super) mod openings;
pub(super) mod selection;
mod surface;
