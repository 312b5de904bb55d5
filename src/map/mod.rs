//! Photons → density: the kd-tree, the kernel, the radius.

pub mod index;
pub mod kernel;
pub mod photon;
pub mod radius;

pub use index::PhotonIndex;
pub use photon::Photon;
