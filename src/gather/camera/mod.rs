//! The camera walk: follows camera paths through mirrors and glass to the first other surface.

pub(super) mod path;
pub(super) mod sampler;
mod scatter;
pub(super) mod throughput;
pub(super) mod visible_point;
mod walk;
