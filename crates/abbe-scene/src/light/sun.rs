//! The position of the sun by place and time, and the illuminance of its beam.
//!
//! The position follows the formulas of low accuracy of Meeus, Astronomical Algorithms, 2nd edition
//! (1998): chapters 12 (sidereal time), 13 (horizontal coordinates), 16 (refraction), 22
//! (obliquity) and 25 (coordinates of the sun). Between 1900 and 2100, the direction is accurate to
//! 0.01°, except for the refraction near the horizon, which depends on the weather.

use super::sky::SunDirection;
use abbe_spectra::math::elementary::{asin, atan2, exp, sin, sin_cos, tan};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeographicPlace {
    /// Geodetic, positive in the north.
    pub latitude_deg: f64,
    /// Positive in the east.
    pub longitude_deg: f64,
}

/// The position of the sun as an observer sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPosition {
    /// The refracted direction of the middle of the disk, with azimuth from true north.
    pub direction: SunDirection,
    /// In astronomical units, accurate to 10⁻⁴.
    pub distance_au: f64,
}

/// The Julian day of 2000-01-01 at 12:00.
const J2000: f64 = 2_451_545.0;

/// Terrestrial minus universal time in days: 69 s (2020), 0.001° of the sun's motion.
const DELTA_T_DAYS: f64 = 69.0 / 86_400.0;

/// The horizontal parallax of the sun at 1 au.
const PARALLAX_DEG: f64 = 8.794 / 3600.0;

/// The illuminance of sunlight outside the atmosphere at 1 au, in lx (IES RP-21-84).
const SOLAR_ILLUMINANCE_LX: f64 = 127_500.0;

/// The optical depth of a clear atmosphere at the zenith for luminous flux (IES RP-21-84).
const CLEAR_OPTICAL_DEPTH: f64 = 0.21;

impl SunPosition {
    /// Returns the position at a Julian day of universal time.
    pub fn at(place: GeographicPlace, julian_day: f64) -> Self {
        let days = julian_day - J2000;
        let t = (days + DELTA_T_DAYS) / 36_525.0;
        let polynomial = |[a, b, c]: [f64; 3]| a + t * (b + t * c);
        let radians = |degrees: f64| degrees.rem_euclid(360.0).to_radians();
        let anomaly = radians(polynomial([357.529_11, 35_999.050_29, -0.000_153_7]));
        let eccentricity = polynomial([0.016_708_634, -0.000_042_037, -0.000_000_126_7]);
        let centre_deg = polynomial([1.914_602, -0.004_817, -0.000_014]) * sin(anomaly)
            + (0.019_993 - 0.000_101 * t) * sin(2.0 * anomaly)
            + 0.000_289 * sin(3.0 * anomaly);
        let (_, cos_true_anomaly) = sin_cos(anomaly + centre_deg.to_radians());
        let distance_au = 1.000_001_018 * (1.0 - eccentricity * eccentricity) / (1.0 + eccentricity * cos_true_anomaly);
        // The nutation, from the longitude of the ascending node of the moon.
        let (sin_node, cos_node) = sin_cos(radians(125.04 - 1934.136 * t));
        let nutation_deg = -0.004_78 * sin_node;
        let mean_longitude_deg = polynomial([280.466_46, 36_000.769_83, 0.000_303_2]);
        let (sin_longitude, cos_longitude) =
            sin_cos(radians(mean_longitude_deg + centre_deg - 0.005_69 + nutation_deg));
        let obliquity_deg = 23.439_291_1 - 0.013_004_17 * t + 0.002_56 * cos_node;
        let (sin_obliquity, cos_obliquity) = sin_cos(obliquity_deg.to_radians());
        let right_ascension = atan2(cos_obliquity * sin_longitude, cos_longitude);
        let sin_declination = sin_obliquity * sin_longitude;
        let cos_declination = (1.0 - sin_declination * sin_declination).sqrt();
        let sidereal_deg =
            280.460_618_37 + 360.985_647_366_29 * days + 0.000_387_933 * t * t + nutation_deg * cos_obliquity;
        let hour_angle = radians(sidereal_deg + place.longitude_deg) - right_ascension;
        let (sin_hour, cos_hour) = sin_cos(hour_angle);
        let (sin_latitude, cos_latitude) = sin_cos(place.latitude_deg.to_radians());
        let east = -cos_declination * sin_hour;
        let north = cos_latitude * sin_declination - sin_latitude * cos_declination * cos_hour;
        let up = sin_latitude * sin_declination + cos_latitude * cos_declination * cos_hour;
        let geometric_deg =
            asin(up.clamp(-1.0, 1.0)).to_degrees() - PARALLAX_DEG / distance_au * (1.0 - up * up).max(0.0).sqrt();
        let elevation = (geometric_deg + refraction_deg(geometric_deg)).to_radians();
        Self { direction: SunDirection { elevation, azimuth: atan2(east, north) }, distance_au }
    }
}

/// Returns the refraction in degrees at an elevation without refraction, for 1010 hPa and 10 °C
/// (Sæmundsson's formula, Meeus 16.4). It is 0 if the whole disk is below the horizon.
fn refraction_deg(elevation_deg: f64) -> f64 {
    /// The least elevation of the middle of the disk at which a part of the disk is visible.
    const SUNRISE_DEG: f64 = -0.8333;
    if elevation_deg < SUNRISE_DEG {
        return 0.0;
    }
    // The formula is slightly negative at the zenith.
    (1.02 / 60.0 / tan((elevation_deg + 10.3 / (elevation_deg + 5.11)).to_radians())).max(0.0)
}

/// Returns the illuminance in lx of the beam of the sun under a clear sky, on a plane that faces
/// the sun (IES RP-21-84, Recommended Practice for the Calculation of Daylight Availability): the
/// relative air mass 1/sin(elevation) attenuates the beam.
pub fn clear_beam_lx(elevation: f64, distance_au: f64) -> f64 {
    SOLAR_ILLUMINANCE_LX / (distance_au * distance_au) * exp(-CLEAR_OPTICAL_DEPTH / sin(elevation))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The positions agree with the SPA algorithm, which is accurate to 0.0003°.
    #[test]
    fn positions_agree_with_the_golden_values() {
        let golden: serde_json::Value =
            serde_json::from_str(include_str!("../../../../tests/golden/sun.json")).unwrap();
        let cases = golden["cases"].as_array().unwrap();
        assert!(cases.len() >= 20);
        for case in cases {
            let number = |key: &str| case[key].as_f64().unwrap();
            let place = GeographicPlace { latitude_deg: number("latitude"), longitude_deg: number("longitude") };
            let found = SunPosition::at(place, number("julian_day"));
            let (elevation, azimuth) = (number("elevation").to_radians(), number("azimuth").to_radians());
            let expected = SunDirection { elevation, azimuth }.to_vector();
            let angle_deg = found.direction.to_vector().angle_between(expected).to_degrees();
            assert!(angle_deg < 0.01, "{angle_deg}°: {case} {found:?}");
            assert!((found.distance_au - number("distance_au")).abs() < 1e-4, "{case} {found:?}");
        }
    }

    /// Under a clear sky, the beam has 127.5 klx · exp(−0.21 · 2) at an elevation of 30°.
    #[test]
    fn the_beam_of_a_clear_sky_is_attenuated_by_the_air_mass() {
        let lx = clear_beam_lx(30.0_f64.to_radians(), 1.0);
        assert!((lx - 83_773.0).abs() < 1.0, "{lx}");
        assert!((clear_beam_lx(30.0_f64.to_radians(), 2.0) / lx - 0.25).abs() < 1e-12);
        assert_eq!(clear_beam_lx(0.0, 1.0), 0.0);
    }
}
