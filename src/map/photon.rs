//! Stored photons and their compact representation.

use crate::spectrum::{LANES, Lanes, Wavelengths};
use crate::walk::RayDensity;
use glam::DVec3;

/// The wavelengths and powers of a stored photon, in single precision.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct PhotonPower {
    nm: [f32; LANES],
    power: [f32; LANES],
    /// The number of wavelengths in use.
    count: u8,
    /// The lane of the only wavelength. If all wavelengths are in use, the value is 0 and is
    /// ignored.
    lane: u8,
    /// The density of the rays of the photon's light. It fills the space that alignment leaves.
    ray_density: RayDensity,
}

impl PhotonPower {
    /// Stores wavelengths and their powers. The powers of free photons are in W. The powers of
    /// shared photons are in W/nm. If the photon keeps a single wavelength, `lane` is the lane of
    /// this wavelength. If the photon carries all its wavelengths, `lane` is `None`.
    #[inline]
    pub fn new(wavelengths: &Wavelengths, power: Lanes, lane: Option<usize>) -> Self {
        Self {
            nm: wavelengths.nm.map(|nm| nm as f32),
            power: power.map(|power| power as f32),
            count: wavelengths.count as u8,
            lane: lane.map_or(0, |lane| lane as u8),
            ray_density: RayDensity::NONE,
        }
    }

    /// Adds the density of the rays of the photon's light. [`Self::new`] sets it to 0.
    #[must_use]
    pub fn with_ray_density(self, ray_density: RayDensity) -> Self {
        Self { ray_density, ..self }
    }

    /// Returns the density of the rays of the photon's light.
    #[inline]
    pub fn ray_density(&self) -> RayDensity {
        self.ray_density
    }

    /// Returns each wavelength (nm) in use, and its power.
    #[inline]
    pub fn lanes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let lanes = self.nm.iter().zip(&self.power).take(usize::from(self.count));
        lanes.map(|(&nm, &power)| (f64::from(nm), f64::from(power)))
    }

    /// Returns all wavelengths (nm) and their powers. Use this function in scenes without
    /// dispersion, where photons keep all wavelengths.
    #[inline]
    pub fn all_lanes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        (0..LANES).map(|k| (f64::from(self.nm[k]), f64::from(self.power[k])))
    }

    /// Returns the power at the shared wavelength with the number `lane`. Returns `None` if the
    /// photon no longer carries that wavelength.
    pub fn at_lane(&self, lane: usize) -> Option<f64> {
        if usize::from(self.count) == LANES {
            Some(f64::from(self.power[lane]))
        } else {
            (usize::from(self.lane) == lane).then_some(f64::from(self.power[0]))
        }
    }
}

/// A photon stored on a surface. The photon takes 44 bytes. The map adds 12 bytes for the position.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct Photon {
    /// The photon's wavelengths and powers.
    pub power: PhotonPower,
    to_light: Octahedral,
    normal: Octahedral,
}

impl Photon {
    /// Creates a photon at a surface. The unit direction `to_light` points back along the photon's
    /// path. `normal` is the unit normal of the surface. The normal points to the side from which
    /// the photon arrived.
    pub fn new(power: PhotonPower, to_light: DVec3, normal: DVec3) -> Self {
        Self { power, to_light: Octahedral::encode(to_light), normal: Octahedral::encode(normal) }
    }

    /// Returns the unit direction back towards the photon's previous vertex.
    #[inline]
    pub fn to_light(&self) -> DVec3 {
        self.to_light.decode()
    }

    /// Returns the unit normal of the surface. The normal points to the side from which the photon
    /// arrived.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.normal.decode()
    }
}

/// A unit vector in octahedral encoding with 16 bits per coordinate (Cigolle et al. 2014, "A Survey
/// of Efficient Representations for Independent Unit Vectors"). The error is below 7·10⁻⁵ rad.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub(super) struct Octahedral([i16; 2]);

impl Octahedral {
    pub(super) fn encode(v: DVec3) -> Self {
        let l1 = v.x.abs() + v.y.abs() + v.z.abs();
        let (x, y) = (v.x / l1, v.y / l1);
        let (x, y) = if v.z >= 0.0 {
            (x, y)
        } else {
            ((1.0 - y.abs()) * 1.0_f64.copysign(x), (1.0 - x.abs()) * 1.0_f64.copysign(y))
        };
        let quantise = |c: f64| (c * f64::from(i16::MAX)).round() as i16;
        Self([quantise(x), quantise(y)])
    }

    pub(super) fn decode(self) -> DVec3 {
        let [x, y] = self.0.map(|c| f64::from(c) / f64::from(i16::MAX));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        DVec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{sobol::Sobol, warp};

    /// The encoding changes a direction by less than 7·10⁻⁵ rad.
    #[test]
    fn octahedral_encoding_is_accurate() {
        let sobol = Sobol::new(2);
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let random = (0..1000).map(|i| warp::sphere([sobol.at(i, 0), sobol.at(i, 1)]));
        for v in axes.into_iter().chain(random) {
            assert!((Octahedral::encode(v).decode() - v).length() < 7e-5, "{v}");
        }
    }

    /// A photon with its position fits in 64 bytes.
    #[test]
    fn a_stored_photon_fits_in_64_bytes() {
        assert!(size_of::<Photon>() + 3 * size_of::<f32>() <= 64);
    }
}
