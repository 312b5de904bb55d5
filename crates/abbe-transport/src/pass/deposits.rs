//! The photons of a set, stored on surfaces and in media.

use crate::map::{ClassMaps, Photon, PhotonBeam, PhotonMap, SetMaps, VolumeMap, VolumeMaps, VolumePhoton};
use crate::plan::partition::{PerClass, PhotonClass};

/// A photon and its position in m, relative to the scene's centre.
pub(crate) type PositionedPhoton = (Photon, [f32; 3]);

/// The photons of one class stored in media.
#[derive(Debug, Default)]
pub(crate) struct VolumeDeposits {
    /// Photon points: one for each stored scattering event.
    pub(crate) points: Vec<VolumePhoton>,
    /// Photon beams: one for each stored path segment.
    pub(crate) beams: Vec<PhotonBeam>,
}

/// The stored photons of a set, or of a part of it.
#[derive(Debug, Default)]
pub(crate) struct PhotonDeposits {
    pub(crate) surface: PerClass<Vec<PositionedPhoton>>,
    /// The number of surface events of each photon in `surface`, only with an explicit limit.
    pub(crate) surface_events: PerClass<Vec<u16>>,
    pub(crate) volume: PerClass<VolumeDeposits>,
}

impl VolumeDeposits {
    fn append(&mut self, other: &Self) {
        self.points.extend_from_slice(&other.points);
        self.beams.extend_from_slice(&other.beams);
    }

    fn into_maps(self) -> VolumeMaps {
        VolumeMaps { points: VolumeMap::of_points(self.points), beams: VolumeMap::of_beams(self.beams) }
    }
}

impl PhotonDeposits {
    /// Appends photons. Their order decides the layout of the maps, so it must not vary.
    pub(crate) fn append(&mut self, other: &Self) {
        for class in PhotonClass::ALL {
            self.surface[class].extend_from_slice(&other.surface[class]);
            self.surface_events[class].extend_from_slice(&other.surface_events[class]);
            self.volume[class].append(&other.volume[class]);
        }
    }

    pub(crate) fn into_maps(self) -> SetMaps {
        let surface = self
            .surface
            .zip_with(self.surface_events, |photons, events| PhotonMap::build_with_events(&photons, &events));
        surface.zip_with(self.volume, |surface, volume| ClassMaps { surface, volume: volume.into_maps() })
    }
}
