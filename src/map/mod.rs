//! Photon maps and kernels for density estimation: photons on surfaces, photons and beams in media,
//! kernel radii, and maps of direct light in media.

mod box_tree;
pub mod kernel;
pub mod photon;
mod photon_map;
mod query_cone;
pub mod radius;
mod set_maps;
mod volume;

pub use photon::{Photon, PhotonPower};
pub use photon_map::{NearbyPhoton, PhotonMap};
pub use query_cone::{KernelWidth, QueryCone};
pub use radius::PixelRadii;
pub use set_maps::{ClassMaps, SetMaps};
pub use volume::{
    BeamPath, LightMap, LightMapLookup, LightMaps, PhotonBeam, PhotonNearRay, VolumeMap, VolumeMaps, VolumePhoton,
};
