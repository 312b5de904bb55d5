//! Unit vectors in octahedral encoding (Cigolle et al. 2014, "A Survey of Efficient Representations
//! for Independent Unit Vectors").

use glam::DVec3;

/// A unit vector with `BITS` bits per coordinate, in the lower 2·`BITS` bits. The error is below
/// 7·10⁻⁵ rad for 16 bits, and doubles with each missing bit. The six axes have no error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Octahedral<const BITS: u32>(pub(super) u32);

impl<const BITS: u32> Octahedral<BITS> {
    /// The largest value of a coordinate. The smallest value is its negative.
    const LARGEST: i32 = (1 << (BITS - 1)) - 1;

    const MASK: u32 = (1 << BITS) - 1;

    pub(super) fn encode(v: DVec3) -> Self {
        let l1 = v.x.abs() + v.y.abs() + v.z.abs();
        let (x, y) = (v.x / l1, v.y / l1);
        let (x, y) = if v.z >= 0.0 {
            (x, y)
        } else {
            ((1.0 - y.abs()) * 1.0_f64.copysign(x), (1.0 - x.abs()) * 1.0_f64.copysign(y))
        };
        let quantise = |c: f64| ((c * f64::from(Self::LARGEST)).round() as i32 + Self::LARGEST) as u32;
        Self(quantise(x) | quantise(y) << BITS)
    }

    #[inline]
    pub(super) fn decode(self) -> DVec3 {
        self.direction().normalize()
    }

    /// Returns a vector of this direction. The sum of the absolute values of its coordinates is 1.
    #[inline]
    pub(super) fn direction(self) -> DVec3 {
        let coordinate = |bits: u32| f64::from(bits as i32 - Self::LARGEST) * (1.0 / f64::from(Self::LARGEST));
        let (x, y) = (coordinate(self.0 & Self::MASK), coordinate((self.0 >> BITS) & Self::MASK));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        DVec3::new(x - fold.copysign(x), y - fold.copysign(y), z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::{sobol::Sobol, warp};

    /// Returns the largest error of random directions and of the axes, in rad.
    fn largest_error<const BITS: u32>() -> f64 {
        let sobol = Sobol::new(2);
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        for axis in axes {
            assert_eq!(Octahedral::<BITS>::encode(axis).decode(), axis);
        }
        let random = (0..1000).map(|i| warp::sphere([sobol.at(i, 0), sobol.at(i, 1)]));
        random.map(|v| (Octahedral::<BITS>::encode(v).decode() - v).length()).fold(0.0, f64::max)
    }

    #[test]
    fn octahedral_encoding_is_accurate() {
        assert!(largest_error::<16>() < 7e-5, "{}", largest_error::<16>());
        assert!(largest_error::<14>() < 2.8e-4, "{}", largest_error::<14>());
        assert!(largest_error::<12>() < 1.2e-3, "{}", largest_error::<12>());
    }
}
