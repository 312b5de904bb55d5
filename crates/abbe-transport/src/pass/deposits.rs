//! The photons of a set, stored on surfaces and in media.

use crate::map::{
    ClassMaps, Photon, PhotonBeam, PhotonMap, SetMaps, StoredPolarisation, VolumeMap, VolumeMaps, VolumePhoton,
};
use crate::plan::partition::{PerClass, PhotonClass};

/// A photon and its position in m, relative to the scene's centre.
pub(crate) type PositionedPhoton = (Photon, [f32; 3]);

/// The places of points and of beams in [`VolumeDeposits::polarisation`].
pub(super) const POINTS: usize = 0;
pub(super) const BEAMS: usize = 1;

/// The photons of one class stored in media.
#[derive(Debug, Default)]
pub(crate) struct VolumeDeposits {
    /// Photon points: one for each stored scattering event.
    pub(crate) points: Vec<VolumePhoton>,
    /// Photon beams: one for each stored path segment.
    pub(crate) beams: Vec<PhotonBeam>,
    /// The polarisation of each point and of each beam, only if the plan contains it.
    pub(crate) polarisation: [Vec<StoredPolarisation>; 2],
}

/// The stored photons of a set, or of a part of it.
#[derive(Debug, Default)]
pub(crate) struct PhotonDeposits {
    pub(crate) surface: PerClass<Vec<PositionedPhoton>>,
    /// The number of surface events of each photon in `surface`, only with an explicit limit.
    pub(crate) surface_events: PerClass<Vec<u16>>,
    /// The polarisation of each photon in `surface`, only if the plan contains it.
    pub(crate) surface_polarisation: PerClass<Vec<StoredPolarisation>>,
    pub(crate) volume: PerClass<VolumeDeposits>,
}

impl VolumeDeposits {
    fn append(&mut self, other: &Self) {
        self.points.extend_from_slice(&other.points);
        self.beams.extend_from_slice(&other.beams);
        for (own, others) in self.polarisation.iter_mut().zip(&other.polarisation) {
            own.extend_from_slice(others);
        }
    }

    fn into_maps(self) -> VolumeMaps {
        let [of_points, of_beams] = self.polarisation;
        VolumeMaps {
            points: VolumeMap::of_points(self.points, &of_points),
            beams: VolumeMap::of_beams(self.beams, of_beams),
        }
    }
}

impl PhotonDeposits {
    /// Appends photons. Their order decides the layout of the maps, so it must not vary.
    pub(crate) fn append(&mut self, other: &Self) {
        for class in PhotonClass::ALL {
            self.surface[class].extend_from_slice(&other.surface[class]);
            self.surface_events[class].extend_from_slice(&other.surface_events[class]);
            self.surface_polarisation[class].extend_from_slice(&other.surface_polarisation[class]);
            self.volume[class].append(&other.volume[class]);
        }
    }

    pub(crate) fn into_maps(self) -> SetMaps {
        let details =
            self.surface_events.zip_with(self.surface_polarisation, |events, polarisation| (events, polarisation));
        let surface = self.surface.zip_with(details, |photons, (events, polarisation)| {
            PhotonMap::build_with(&photons, &events, &polarisation)
        });
        surface.zip_with(self.volume, |surface, volume| ClassMaps { surface, volume: volume.into_maps() })
    }
}
