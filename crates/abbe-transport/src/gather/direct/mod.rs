//! Direct lighting by next-event estimation, with multiple importance sampling.

pub(super) mod learned_lights;
pub(super) mod light_tree;
mod light_trials;
pub(super) mod lighting;
pub(super) mod portals;
pub(super) mod selection;
mod surroundings;
