//! A stored photon.

use crate::spectrum::{LANES, Lanes, Wavelengths};
use glam::DVec3;

/// The light that a stored photon carries.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct Load {
    nm: [f32; LANES],
    power: [f32; LANES],
    count: u8,
    lane: u8,
}

impl Load {
    /// The wavelengths with their power: W for free photons, W/nm for shared ones. Of a single wavelength `lane` says which of the shared ones it is.
    #[inline]
    pub fn new(wavelengths: &Wavelengths, power: Lanes, lane: usize) -> Self {
        let all = wavelengths.count == LANES;
        Self {
            nm: wavelengths.nm.map(|nm| nm as f32),
            power: power.map(|power| power as f32),
            count: wavelengths.count as u8,
            lane: if all { 0 } else { lane as u8 },
        }
    }

    /// Each wavelength (nm) and its power.
    #[inline]
    pub fn lanes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let lanes = self.nm.iter().zip(&self.power).take(usize::from(self.count));
        lanes.map(|(&nm, &power)| (f64::from(nm), f64::from(power)))
    }

    /// The same where photons keep all their wavelengths.
    #[inline]
    pub fn all_lanes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        (0..LANES).map(|k| (f64::from(self.nm[k]), f64::from(self.power[k])))
    }

    /// The power at the pass's shared wavelength number `lane`, if the photon still carries that.
    pub fn at_lane(&self, lane: usize) -> Option<f64> {
        if usize::from(self.count) == LANES {
            Some(f64::from(self.power[lane]))
        } else {
            (usize::from(self.lane) == lane).then_some(f64::from(self.power[0]))
        }
    }
}

/// What is kept of a photon where it met a surface: 44 bytes, and 12 more for its position in the tree.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct Photon {
    /// Its light.
    pub load: Load,
    to_light: Octahedral,
    normal: Octahedral,
}

impl Photon {
    /// A photon that came from the unit direction `to_light` to a surface of this unit normal (on the side it came from).
    pub fn new(load: Load, to_light: DVec3, normal: DVec3) -> Self {
        Self { load, to_light: Octahedral::encode(to_light), normal: Octahedral::encode(normal) }
    }

    /// The unit direction towards where the photon came from.
    #[inline]
    pub fn to_light(&self) -> DVec3 {
        self.to_light.decode()
    }

    /// The surface's unit normal on the side it came from.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.normal.decode()
    }
}

/// A unit vector on the octahedron, 16 bits a coordinate (Cigolle et al. 2014); off by less than 7·10⁻⁵ rad.
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

    #[test]
    fn directions_survive_their_sixteen_bits() {
        let sobol = Sobol::new(2);
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let random = (0..1000).map(|i| warp::sphere([sobol.at(i, 0), sobol.at(i, 1)]));
        for v in axes.into_iter().chain(random) {
            assert!((Octahedral::encode(v).decode() - v).length() < 7e-5, "{v}");
        }
    }

    #[test]
    fn a_photon_takes_no_more_than_its_share_of_memory() {
        assert!(size_of::<Photon>() + 3 * size_of::<f32>() <= 64);
    }
}
