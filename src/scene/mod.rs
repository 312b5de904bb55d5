//! The scene: what stands where, of which shape.

pub mod bvh;
pub mod geometry;
pub mod mesh;
pub mod shape;
