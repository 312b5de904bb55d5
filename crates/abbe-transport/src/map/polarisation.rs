//! The stored polarisation of photons.

use crate::walk::PhotonPolarisation;
use abbe_polarisation::{Stokes, StokesFrame};
use abbe_spectra::spectrum::LANES;
use glam::DVec3;

/// The polarisation of a stored photon, in 24 bytes: for each lane, S1, S2 and S3, divided by S0, in
/// steps of 1/32767. The frame is the canonical one of the stored direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StoredPolarisation([[i16; 3]; LANES]);

const STEPS: f64 = 32_767.0;

impl StoredPolarisation {
    /// Stores the polarisation of a photon that travels along `travel`. A map returns the direction
    /// `stored`, which differs by a rounding error. If the photon keeps a single wavelength, `lane`
    /// is its lane.
    pub fn new(polarisation: &PhotonPolarisation, [travel, stored]: [DVec3; 2], lane: Option<usize>) -> Self {
        let rotation = StokesFrame::canonical(travel).rotation_to(StokesFrame::canonical(stored).x);
        let of_lane = |k: usize| {
            let Stokes([_, parts @ ..]) = rotation * polarisation.stokes(k);
            parts.map(|part| (part.clamp(-1.0, 1.0) * STEPS).round() as i16)
        };
        match lane {
            None => Self(std::array::from_fn(of_lane)),
            Some(lane) => Self(std::array::from_fn(|k| if k == lane { of_lane(0) } else { [0; 3] })),
        }
    }

    /// Returns the Stokes vector of a lane for a power of 1.
    #[inline]
    pub fn stokes(&self, lane: usize) -> Stokes {
        let [q, u, v] = self.0[lane].map(|part| f64::from(part) / STEPS);
        Stokes([1.0, q, u, v])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Photon, PhotonPower};

    /// Also where the canonical frames of two close directions are turned against each other.
    #[test]
    fn a_stored_photon_keeps_its_polarisation() {
        for travel in [DVec3::new(0.3, -0.4, 0.87), DVec3::new(0.6, -0.8, 1e-9), DVec3::new(-0.6, 0.3, -1e-9)] {
            let travel = travel.normalize();
            let polarisation = PhotonPolarisation([[0.6, -0.3, 0.5]; LANES]);
            let stored_direction = -Photon::new(PhotonPower::default(), -travel, DVec3::Z).to_light();
            let stored = StoredPolarisation::new(&polarisation, [travel, stored_direction], None).stokes(2);
            let (found, known) = (StokesFrame::canonical(stored_direction), StokesFrame::canonical(travel));
            let Stokes([_, q, u, v]) = found.rotation_to(known.x) * stored;
            for (found, known) in [(q, 0.6), (u, -0.3), (v, 0.5)] {
                assert!((found - known).abs() < 1e-3, "{travel}: {found} for {known}");
            }
        }
    }

    #[test]
    fn polarised_photons_take_at_most_64_bytes() {
        assert!(size_of::<Photon>() + 3 * size_of::<f32>() + size_of::<StoredPolarisation>() <= 64);
    }
}
