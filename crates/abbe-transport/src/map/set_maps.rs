//! The photon maps of one set of photons.

use super::photon_map::PhotonMap;
use super::volume::VolumeMaps;
use crate::plan::partition::PerClass;

#[derive(Debug, Default)]
pub struct ClassMaps {
    pub surface: PhotonMap,
    pub volume: VolumeMaps,
}

pub type SetMaps = PerClass<ClassMaps>;
