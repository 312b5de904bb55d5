//! The CIE standard general sky (ISO 15469:2004, CIE S 011), and the traditional overcast sky. The
//! luminance relative to the zenith is given by the gradation φ of the zenith angle Z and the
//! indicatrix f of the angle χ from the sun. The ground below has a uniform luminance.

use super::environment_map::EnvironmentMap;
use abbe_spectra::math::distribution::PiecewiseConstant2d;
use abbe_spectra::math::elementary::{acos, cos, exp, sin, sin_cos};
use abbe_spectra::math::quadrature::gauss16;
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

/// The parameters a, b, c, d and e of the 15 sky types (ISO 15469:2004, table 1).
const TYPES: [[f64; 5]; 15] = [
    [4.0, -0.7, 0.0, -1.0, 0.0],
    [4.0, -0.7, 2.0, -1.5, 0.15],
    [1.1, -0.8, 0.0, -1.0, 0.0],
    [1.1, -0.8, 2.0, -1.5, 0.15],
    [0.0, -1.0, 0.0, -1.0, 0.0],
    [0.0, -1.0, 2.0, -1.5, 0.15],
    [0.0, -1.0, 5.0, -2.5, 0.3],
    [0.0, -1.0, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.3],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.3],
    [-1.0, -0.15, 16.0, -3.0, 0.3],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

/// The traditional overcast sky of Moon and Spencer, which the standard lists after its 15 types.
const TRADITIONAL_OVERCAST: u32 = 16;

/// The size of the sampling table. The horizon is an edge between two rows.
const TABLE: (usize, usize) = (256, 256);

/// A standard sky with mean radiance 1 over all directions and its zenith in the direction +y.
#[derive(Debug)]
pub struct StandardSky {
    /// The gradation and the indicatrix, or `None` for the traditional overcast sky.
    parameters: Option<[f64; 5]>,
    to_sun: DVec3,
    /// From the relative luminance to the radiance divided by the mean radiance.
    scale: f64,
    /// The radiance of the ground divided by the mean radiance.
    ground: f64,
    /// From the unobstructed sky, divided by the mean luminance of all directions.
    horizontal_illuminance: f64,
    /// Over latitude and longitude.
    table: PiecewiseConstant2d,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunDirection {
    /// Above the horizon, in radians.
    pub elevation: f64,
    /// From north (−z) through east (+x), in radians.
    pub azimuth: f64,
}

impl SunDirection {
    pub const ZENITH: Self = Self { elevation: FRAC_PI_2, azimuth: 0.0 };

    pub fn to_vector(self) -> DVec3 {
        let (sin_azimuth, cos_azimuth) = sin_cos(self.azimuth);
        let (height, level) = sin_cos(self.elevation);
        DVec3::new(sin_azimuth * level, height, -cos_azimuth * level)
    }
}

impl StandardSky {
    /// Creates the sky of a type from 1 to 16, or returns `None`. `ground_reflectance` is π times
    /// the ground's luminance over the horizontal illuminance from the sky.
    pub fn new(number: u32, sun: SunDirection, ground_reflectance: f64) -> Option<Self> {
        let parameters = match number {
            1..=15 => Some(TYPES[number as usize - 1]),
            TRADITIONAL_OVERCAST => None,
            _ => return None,
        };
        let (to_sun, table) = (sun.to_vector(), PiecewiseConstant2d::new(1, &[1.0])?);
        let unscaled = Self { parameters, to_sun, scale: 1.0, ground: 0.0, horizontal_illuminance: 0.0, table };
        let illuminance = unscaled.upper_integral(|cos_zenith| cos_zenith);
        let ground = ground_reflectance * illuminance * FRAC_1_PI;
        let mean = (unscaled.upper_integral(|_| 1.0) + TAU * ground) / (4.0 * PI);
        let (scale, ground, horizontal_illuminance) = (1.0 / mean, ground / mean, illuminance / mean);
        let scaled = Self { scale, ground, horizontal_illuminance, ..unscaled };
        Some(Self { table: scaled.sampling_table()?, ..scaled })
    }

    /// Returns true if the luminance depends on the position of the sun.
    pub fn depends_on_sun(number: u32) -> bool {
        TYPES.get((number as usize).wrapping_sub(1)).is_some_and(|[_, _, c, _, e]| *c != 0.0 || *e != 0.0)
    }

    /// The unobstructed horizontal illuminance divided by the mean luminance of all directions.
    pub fn horizontal_illuminance(&self) -> f64 {
        self.horizontal_illuminance
    }

    /// The radiance in a direction, divided by the mean radiance of all directions.
    pub(super) fn relative_radiance(&self, direction: DVec3) -> f64 {
        if direction.y <= 0.0 {
            return self.ground;
        }
        let Some([a, b, c, d, e]) = self.parameters else {
            return self.scale * (1.0 + 2.0 * direction.y) / 3.0;
        };
        let gradation = |cos_zenith: f64| 1.0 + a * exp(b / cos_zenith);
        let indicatrix = |cos_angle: f64| {
            let angle = acos(cos_angle.clamp(-1.0, 1.0));
            1.0 + c * (exp(d * angle) - exp(d * FRAC_PI_2)) + e * cos_angle * cos_angle
        };
        let at_zenith = gradation(1.0) * indicatrix(self.to_sun.y);
        self.scale * gradation(direction.y) * indicatrix(direction.dot(self.to_sun)) / at_zenith
    }

    /// The pdf of [`Self::sample`], per steradian.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let point = EnvironmentMap::point(direction);
        let sin_theta = sin(PI * point[1]);
        if sin_theta > 0.0 { self.table.pdf(point) / (2.0 * PI * PI * sin_theta) } else { 0.0 }
    }

    /// Samples a direction, nearly in proportion to the radiance.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        EnvironmentMap::direction(self.table.sample(u).0)
    }

    /// Integrates the radiance times a function of the cosine of the zenith angle over the upper
    /// hemisphere, with these numbers of intervals in zenith angle and in azimuth.
    fn upper_integral(&self, weight: impl Fn(f64) -> f64) -> f64 {
        const PANELS: u32 = 24;
        const AZIMUTHS: u32 = 512;
        let along = |zenith: f64| {
            let (sin_zenith, cos_zenith) = sin_cos(zenith);
            let at = |i: u32| {
                let (across, along) = sin_cos(TAU * (f64::from(i) + 0.5) / f64::from(AZIMUTHS));
                self.relative_radiance(DVec3::new(sin_zenith * across, cos_zenith, sin_zenith * along))
            };
            let sum: f64 = (0..AZIMUTHS).map(at).sum();
            sum * TAU / f64::from(AZIMUTHS) * sin_zenith * weight(cos_zenith)
        };
        let edge = |i: u32| FRAC_PI_2 * f64::from(i) / f64::from(PANELS);
        (0..PANELS).map(|i| gauss16((edge(i), edge(i + 1)), along)).sum()
    }

    /// The probability of a cell over latitude and longitude is the largest radiance at its corners
    /// times its solid angle, so that no direction with light is left out.
    fn sampling_table(&self) -> Option<PiecewiseConstant2d> {
        let (columns, rows) = TABLE;
        let corner =
            |column: usize, row: f64| EnvironmentMap::direction([column as f64 / columns as f64, row / rows as f64]);
        let edge = |row: usize| cos(PI * row as f64 / rows as f64);
        // Rows at the horizon are sampled just inside themselves.
        let inset = |row: usize, column: usize| {
            [
                (column, row as f64 + 1e-3),
                (column + 1, row as f64 + 1e-3),
                (column, row as f64 + 0.999),
                (column + 1, row as f64 + 0.999),
            ]
            .map(|(column, row)| self.relative_radiance(corner(column, row)))
            .into_iter()
            .fold(0.0, f64::max)
        };
        let masses: Vec<f64> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(row, column)| inset(row, column) * (edge(row) - edge(row + 1)))
            .collect();
        PiecewiseConstant2d::new(columns, &masses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(number: u32, elevation: f64) -> StandardSky {
        let sun = SunDirection { elevation: elevation.to_radians(), azimuth: PI };
        StandardSky::new(number, sun, 0.0).unwrap()
    }

    /// The illuminances of the standard skies for a luminance of 1 cd/m² at the zenith.
    #[test]
    #[ignore = "nightly: 7 seconds of CPU time"]
    fn illuminances_agree_with_the_golden_values() {
        let golden: serde_json::Value =
            serde_json::from_str(include_str!("../../../../tests/golden/sky.json")).unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let zenith = &golden["horizontal_illuminance_per_zenith_luminance"]["values"];
        let rows = zenith.as_array().unwrap();
        assert_eq!(rows.len(), 16);
        for row in rows {
            let kind = row["type"].as_u64().unwrap() as u32;
            for elevation in [30, 45, 60] {
                let expected = number(&row[format!("sun_elevation_{elevation}")]);
                let sky = sky(kind, f64::from(elevation));
                let found = sky.horizontal_illuminance() / sky.relative_radiance(DVec3::Y);
                assert!((found / expected - 1.0).abs() < 2e-5, "type {kind}: {found} for {expected}");
            }
        }
        for block in golden["relative_luminance"].as_array().unwrap() {
            let kind = block["type"].as_u64().unwrap() as u32;
            let mut skies: Vec<(f64, StandardSky)> = Vec::new();
            for row in block["values"].as_array().unwrap() {
                let angle = number(&row["sun_zenith_angle_deg"]);
                if skies.iter().all(|(known, _)| *known != angle) {
                    skies.push((angle, sky(kind, 90.0 - angle)));
                }
                let (_, sky) = skies.iter().find(|(known, _)| *known == angle).unwrap();
                let sun = SunDirection {
                    elevation: (90.0 - number(&row["zenith_angle_deg"])).to_radians(),
                    azimuth: PI + number(&row["azimuth_from_sun_deg"]).to_radians(),
                };
                let found = sky.relative_radiance(sun.to_vector()) / sky.relative_radiance(DVec3::Y);
                assert!((found - number(&row["relative_luminance"])).abs() < 1e-8, "type {kind}: {row}");
            }
        }
    }

    /// The mean of the radiance over the samples, weighted by their densities, is 1.
    #[test]
    fn samples_have_their_pdf_and_cover_all_light() {
        use abbe_spectra::math::sobol::Sobol;
        for (number, ground) in [(1, 0.0), (5, 0.2), (12, 0.3), (15, 0.0), (16, 0.1)] {
            let sun = SunDirection { elevation: 0.9, azimuth: 2.0 };
            let sky = StandardSky::new(number, sun, ground).unwrap();
            let (sobol, n) = (Sobol::new(7), 1 << 14);
            let mut mean = 0.0;
            for i in 0..n {
                let direction = sky.sample([sobol.at(i, 0), sobol.at(i, 1)]);
                mean += sky.relative_radiance(direction) / sky.pdf(direction) / (4.0 * PI) / f64::from(n);
            }
            assert!((mean - 1.0).abs() < 1e-3, "type {number}: {mean}");
        }
    }
}
