//! Photons → density: the kd-tree over surfaces, what is near a ray in media, the kernel, the radius. Lamps → maps of their light in media.

pub mod index;
pub mod kernel;
mod near_ray;
pub mod photon;
pub mod radius;
mod volume;

pub use index::{Nearby, PhotonIndex};
pub use near_ray::{Cone, Width};
pub use photon::{Load, Photon};
pub use volume::{Beam, Came, LightMap, LightMaps, Look, Neighbour, VolumeMap, VolumeMaps, VolumePhoton};
