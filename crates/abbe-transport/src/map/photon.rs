//! Stored photons and their compact representation.

use super::octahedral::Octahedral;
use super::photon_spectra::{PhotonSpectra, WavelengthCode};
use crate::walk::RayDensity;
use abbe_spectra::spectrum::{LANES, Lanes};
use glam::DVec3;

/// The wavelengths and powers of a stored photon, in 12 bytes.
///
/// A power has 8 bits for the exponent and 8 for the fraction. It is rounded at random, so that the
/// mean is exact, with an error of at most 1/256.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PhotonPower {
    /// The upper halves of the powers in single precision, without the sign.
    power: [u16; LANES],
    wavelengths: WavelengthCode,
}

/// The low bits of a single-precision number that a stored power lacks. The sign bit is always 0.
const DROPPED_BITS: u32 = 15;

impl PhotonPower {
    /// Stores powers, in W for free photons, and in W/nm for shared photons, whose `wavelengths`
    /// are not used. If the photon keeps a single wavelength, `lane` is its lane and `power[0]` its
    /// power. The random number `u` in [0, 1) rounds the powers.
    #[inline]
    pub fn new(wavelengths: WavelengthCode, power: Lanes, lane: Option<usize>, u: f64) -> Self {
        let dither = (u * f64::from(1 << DROPPED_BITS)) as u32;
        let power = power.map(|power| (((power as f32).to_bits() + dither) >> DROPPED_BITS) as u16);
        let power = match lane {
            None => power,
            Some(lane) => std::array::from_fn(|k| if k == lane { power[0] } else { 0 }),
        };
        Self { power, wavelengths }
    }

    /// Returns the power of each lane, 0 if the photon no longer carries it.
    #[inline]
    pub fn powers(&self) -> [f32; LANES] {
        let [a, b, c, d] = self.power;
        let power = |bits| f32::from_bits(u32::from(bits) << DROPPED_BITS);
        [power(a), power(b), power(c), power(d)]
    }

    #[inline]
    pub fn wavelength_code(&self) -> WavelengthCode {
        self.wavelengths
    }

    /// Returns each wavelength (nm) of a free photon that has power, and its power.
    #[inline]
    pub fn lanes<'s>(&self, spectra: &'s PhotonSpectra) -> impl Iterator<Item = (f64, f64)> + use<'s> {
        let (powers, code) = (self.powers(), self.wavelengths);
        let carried = (0..LANES).filter(move |&lane| powers[lane] > 0.0);
        carried.map(move |lane| (spectra.wavelength(code, lane), f64::from(powers[lane])))
    }

    /// Returns the power at the shared wavelength number `lane`, or `None` without power.
    #[inline]
    pub fn at_lane(&self, lane: usize) -> Option<f64> {
        let power = f64::from(self.powers()[lane]);
        (power > 0.0).then_some(power)
    }
}

/// A photon stored on a surface, in 20 bytes. The map adds 12 bytes for the position.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Photon {
    pub power: PhotonPower,
    /// The direction to the light, and the four lower bits of the ray density.
    to_light: u32,
    /// The encoded normal, and the other bits of the ray density.
    normal: u32,
}

/// The encoded direction to the light. Its error is below 2.8·10⁻⁴ rad.
type EncodedDirection = Octahedral<14>;

/// The encoded normal. Its error is below 1.2·10⁻³ rad.
type Normal = Octahedral<12>;

impl Photon {
    /// Takes the unit vectors back along the path, and of the normal on the side of arrival.
    #[inline]
    pub fn new(power: PhotonPower, to_light: DVec3, normal: DVec3) -> Self {
        Self { power, to_light: EncodedDirection::encode(to_light).0, normal: Normal::encode(normal).0 }
    }

    /// Adds the density of the rays of the photon's light. [`Self::new`] sets it to 0.
    #[must_use]
    pub fn with_ray_density(self, ray_density: RayDensity) -> Self {
        let bits = ray_density.to_bits();
        Self { to_light: self.to_light | (bits & 0xf) << 28, normal: self.normal | (bits >> 4) << 24, ..self }
    }

    #[inline]
    pub fn ray_density(&self) -> RayDensity {
        RayDensity::from_bits(self.to_light >> 28 | (self.normal >> 24) << 4)
    }

    /// Returns the unit direction back towards the photon's previous vertex.
    #[inline]
    pub fn to_light(&self) -> DVec3 {
        Octahedral::<14>(self.to_light & 0x0fff_ffff).decode()
    }

    /// Returns the unit normal on the side from which the photon arrived.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.normal_direction().normalize()
    }

    /// Returns a vector in the direction of [`Self::normal`]. Its length is between 0.5 and 1.
    #[inline]
    pub fn normal_direction(&self) -> DVec3 {
        Octahedral::<12>(self.normal & 0x00ff_ffff).direction()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};

    #[test]
    fn a_stored_photon_takes_32_bytes() {
        assert_eq!(size_of::<Photon>() + 3 * size_of::<f32>(), 32);
    }

    /// The error of each stored power is at most 1/256, and the mean of stored powers is exact.
    #[test]
    fn stored_powers_keep_their_mean() {
        let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
        for power in [1e-30, 0.37, 1.0, 1.0039, 2.5e7] {
            let (mut sum, count) = (0.0, 10_000);
            for _ in 0..count {
                let stored = PhotonPower::new(WavelengthCode::default(), [power; 4], None, stream.uniform());
                let stored = f64::from(stored.powers()[2]);
                assert!((stored / power - 1.0).abs() <= 1.0 / 256.0, "{power}: {stored}");
                sum += stored / power;
            }
            assert!((sum / f64::from(count) - 1.0).abs() < 1e-4, "{power}: {}", sum / f64::from(count));
        }
    }

    #[test]
    fn a_photon_of_one_wavelength_has_power_in_its_lane_only() {
        let one = PhotonPower::new(WavelengthCode::default(), [3.0, 0.0, 0.0, 0.0], Some(2), 0.5);
        assert_eq!([0, 1, 2, 3].map(|lane| one.at_lane(lane)), [None, None, Some(3.0), None]);
    }

    /// The ray density shares its bytes with the directions.
    #[test]
    fn the_parts_of_a_photon_do_not_disturb_each_other() {
        let direction = DVec3::new(-0.36, 0.48, -0.8);
        for density in [0.0, 1e-20, 3.7, 2e30] {
            let density = RayDensity::new(density);
            let photon = Photon::new(PhotonPower::default(), direction, DVec3::NEG_Y).with_ray_density(density);
            assert_eq!(photon.ray_density(), density);
            assert!((photon.to_light() - direction).length() < 2.8e-4);
            assert_eq!(photon.normal(), DVec3::NEG_Y);
        }
    }
}
