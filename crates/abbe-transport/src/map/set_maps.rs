//! The photon maps of one set of photons.

use super::photon_map::PhotonMap;
use super::volume::VolumeMaps;
use crate::plan::partition::PerClass;

/// The maps of the photons of one class.
#[derive(Debug, Default)]
pub struct ClassMaps {
    pub surface: PhotonMap,
    /// Photons in media.
    pub volume: VolumeMaps,
}

/// The maps of one set of photons, by class.
pub type SetMaps = PerClass<ClassMaps>;
