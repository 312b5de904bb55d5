//! What a film keeps by wavelength besides X, Y and Z: spectral bands for those who ask, and slices that are diffracted differently.

use super::diffraction::Diffraction;
use crate::spectrum::BAND_NM;
use std::sync::Arc;

/// X, Y and Z of a slice.
const OF_A_SLICE: usize = 3;

/// The channels of a pixel: radiance in each spectral band, then X, Y and Z of each slice.
#[derive(Debug, Clone, Default)]
pub(super) struct Channels {
    pub(super) bands: usize,
    pub(super) diffraction: Option<Arc<Diffraction>>,
}

impl Channels {
    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.bands + OF_A_SLICE * self.slices()
    }

    fn slices(&self) -> usize {
        self.diffraction.as_ref().map_or(0, |diffraction| diffraction.slices())
    }

    /// The channel of a component of a slice.
    pub(super) fn of_slice(&self, slice: usize, component: usize) -> usize {
        self.bands + OF_A_SLICE * slice + component
    }

    /// Their names.
    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        let slices = (0..self.slices()).flat_map(|slice| ["X", "Y", "Z"].map(|c| format!("slice{slice}{c}")));
        (0..self.bands).map(|band| format!("band{band}")).chain(slices)
    }

    /// Hands light of a wavelength, of which the observer sees `xyz`, to its channels by `add(channel, value)`.
    pub(super) fn split(&self, nm: f64, weight: f64, xyz: [f64; 3], mut add: impl FnMut(usize, f64)) {
        if self.bands > 0 {
            add(band_of(nm, self.bands), weight);
        }
        if let Some(diffraction) = &self.diffraction {
            let slice = diffraction.slice_of(nm);
            xyz.into_iter().enumerate().for_each(|(c, value)| add(self.of_slice(slice, c), value));
        }
    }
}

/// The band number of a wavelength, of `count` equal bands over the simulated range.
fn band_of(nm: f64, count: usize) -> usize {
    let share = (nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0);
    ((share * count as f64) as usize).min(count - 1)
}

/// The wavelengths in nm between which a band lies, of `count` equal ones.
pub(super) fn band_nm(band: usize, count: usize) -> (f64, f64) {
    let width_nm = (BAND_NM.1 - BAND_NM.0) / count as f64;
    (BAND_NM.0 + band as f64 * width_nm, BAND_NM.0 + (band + 1) as f64 * width_nm)
}
