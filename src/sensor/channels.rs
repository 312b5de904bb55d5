//! The additional channels of a film: spectral bands, and slices of the spectrum. The slices have
//! different diffraction patterns.

use super::diffraction::DiffractionPsf;
use crate::spectrum::BAND_NM;
use std::sync::Arc;

/// The number of components of a slice: X, Y and Z.
const COMPONENTS_OF_SLICE: usize = 3;

/// The additional channels of a pixel: radiance in each spectral band, then X, Y and Z of each
/// slice.
#[derive(Debug, Clone, Default)]
pub(super) struct Channels {
    pub(super) bands: usize,
    pub(super) diffraction: Option<Arc<DiffractionPsf>>,
}

impl Channels {
    /// Returns the number of channels.
    pub(super) fn count(&self) -> usize {
        self.bands + COMPONENTS_OF_SLICE * self.slices()
    }

    fn slices(&self) -> usize {
        self.diffraction.as_ref().map_or(0, |diffraction| diffraction.slices())
    }

    /// Returns the index of the channel that stores one component of a slice.
    pub(super) fn of_slice(&self, slice: usize, component: usize) -> usize {
        self.bands + COMPONENTS_OF_SLICE * slice + component
    }

    /// Returns the names of the channels in their order.
    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        let slices = (0..self.slices()).flat_map(|slice| ["X", "Y", "Z"].map(|c| format!("slice{slice}{c}")));
        (0..self.bands).map(|band| format!("band{band}")).chain(slices)
    }

    /// Distributes light of one wavelength to its channels: calls `add(channel, value)` for each
    /// channel. `weight` is the radiance. `xyz` is the radiance times the colour-matching
    /// functions.
    pub(super) fn distribute(&self, nm: f64, weight: f64, xyz: [f64; 3], mut add: impl FnMut(usize, f64)) {
        if self.bands > 0 {
            add(band_of(nm, self.bands), weight);
        }
        if let Some(diffraction) = &self.diffraction {
            let slice = diffraction.slice_of(nm);
            xyz.into_iter().enumerate().for_each(|(c, value)| add(self.of_slice(slice, c), value));
        }
    }
}

/// Returns the band of a wavelength. The simulated range is divided into `count` equal bands.
fn band_of(nm: f64, count: usize) -> usize {
    let share = (nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0);
    ((share * count as f64) as usize).min(count - 1)
}

/// Returns the lower and the upper wavelength of a band, in nm. The simulated range is divided into
/// `count` equal bands.
pub(super) fn band_nm(band: usize, count: usize) -> (f64, f64) {
    let width_nm = (BAND_NM.1 - BAND_NM.0) / count as f64;
    (BAND_NM.0 + band as f64 * width_nm, BAND_NM.0 + (band + 1) as f64 * width_nm)
}
