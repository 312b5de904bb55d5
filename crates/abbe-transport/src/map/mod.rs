//! Photon maps, kernels for density estimation, their radii, and maps of direct light in media.

mod box_tree;
pub mod kernel;
mod octahedral;
pub mod photon;
mod photon_map;
mod photon_spectra;
mod point_tree;
mod polarisation;
mod query_cone;
pub mod radius;
mod set_maps;
mod sphere_tree;
mod volume;

pub use photon::{Photon, PhotonPower};
pub use photon_map::{NearbyPhoton, PhotonMap};
pub use photon_spectra::{PhotonSpectra, WavelengthCode};
pub use polarisation::StoredPolarisation;
pub use query_cone::{KernelWidth, QueryCone};
pub use radius::{FirstRadii, PixelRadii};
pub use set_maps::{ClassMaps, SetMaps};
pub use sphere_tree::SphereTree;
pub use volume::{
    BeamPath, LightMap, LightMapLookup, LightMaps, MOST_MEDIA, PhotonBeam, PhotonNearRay, VolumeMap, VolumeMaps,
    VolumePhoton,
};
