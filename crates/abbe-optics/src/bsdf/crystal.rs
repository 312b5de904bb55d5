//! Polished surfaces of uniaxial crystals.

use crate::glass::RefractiveIndex;
use abbe_spectra::error::Result;
use glam::DVec3;

/// A polished surface of a uniaxial crystal. The index of the body behind it is that of the
/// ordinary wave.
///
/// A crystal has two waves, and which of them a path follows is no property of its directions. The
/// paths of a renderer therefore scatter here by `abbe_polarisation::crystal`. The methods of
/// [`LocalBsdf`](super::LocalBsdf) take the surface as that of a glass with the ordinary index,
/// which suffices for estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct CrystalInterface {
    /// The index of fields along the optic axis.
    pub extraordinary: RefractiveIndex,
    /// The optic axis, a unit vector in world space.
    pub axis: DVec3,
}

impl CrystalInterface {
    /// Returns the surface with the extraordinary index of the wavelength `nm` at all wavelengths.
    pub(super) fn without_dispersion(&self, nm: f64) -> Result<Self> {
        Ok(Self { extraordinary: RefractiveIndex::constant(self.extraordinary.n(nm))?, axis: self.axis })
    }
}
