//! Circular and polygonal apertures and their Fraunhofer diffraction patterns.

use abbe_spectra::math::elementary::{atan2, bessel_j1, cos, sin};
use abbe_spectra::math::rotation::unit_vector;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Straight blades that form a regular polygon with its corners on the circle of the open aperture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blades {
    /// At least 3.
    pub count: u32,
    /// Rotation of the first corner in radians, anticlockwise from the right of the image, as seen
    /// along the view direction of the camera.
    pub rotation: f64,
}

impl Blades {
    /// Returns corner `number` on the unit circle, counted anticlockwise.
    fn corner(self, number: u32) -> DVec2 {
        unit_vector(self.rotation + TAU * f64::from(number) / f64::from(self.count))
    }

    /// Returns true if the polygon contains a point, in units of the circle's radius.
    pub fn contains(self, place: DVec2) -> bool {
        let sector = TAU / f64::from(self.count);
        // From the middle of the nearest blade, which is cos(sector / 2) from the centre.
        let angle = (atan2(place.y, place.x) - self.rotation).rem_euclid(sector) - 0.5 * sector;
        place.length() * cos(angle) <= cos(0.5 * sector)
    }

    /// Returns the polygon's area divided by the area of the circle.
    pub fn area_fraction(self) -> f64 {
        let sector = TAU / f64::from(self.count);
        sin(sector) / sector
    }
}

/// Returns the irradiance in the Fraunhofer pattern of an aperture, relative to that at its centre.
///
/// `place` is a position in the image in units of λN, where N is the f-number of the full circle,
/// even for a polygon. The circle has the Airy pattern (Born & Wolf, *Principles of Optics*, §8.5);
/// Lee & Mittra 1983 derive the formula for polygons by the divergence theorem.
pub fn fraunhofer(blades: Option<Blades>, place: DVec2) -> f64 {
    let q = PI * place;
    let square = q.length_squared();
    if square < 1e-12 {
        return 1.0;
    }
    let Some(blades) = blades else {
        let x = square.sqrt();
        return (2.0 * bessel_j1(x) / x).powi(2);
    };
    let amplitude = (0..blades.count).fold(DVec2::ZERO, |sum, number| {
        let (from, to) = (blades.corner(number), blades.corner(number + 1));
        let (edge, middle) = (to - from, 0.5 * (from + to));
        let half = 0.5 * q.dot(edge);
        let sinc = if half.abs() < 1e-8 { 1.0 } else { sin(half) / half };
        sum + q.perp_dot(edge) * sinc * unit_vector(-q.dot(middle))
    });
    amplitude.length_squared() / (square * PI * blades.area_fraction()).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;
    use abbe_spectra::math::warp;

    /// The first dark ring is at 1.22 λN, and the first bright ring has 1.75 % of the centre.
    #[test]
    fn airy_pattern_has_its_first_dark_and_bright_rings() {
        let dark = 1.219_669_891_266_504;
        assert!(fraunhofer(None, DVec2::new(0.6, (dark * dark - 0.36_f64).sqrt())) < 1e-20);
        assert!((fraunhofer(None, DVec2::new(0.0, 1.634_719)) - 0.017_498).abs() < 1e-6);
        assert!((fraunhofer(None, DVec2::new(1e-7, 0.0)) - 1.0).abs() < 1e-12);
    }

    /// `contains` accepts every point of `warp::regular_polygon`, and the pattern is the squared
    /// magnitude of the Fourier transform of these points.
    #[test]
    fn polygon_pattern_is_the_fourier_transform_of_its_samples() {
        let sobol = Sobol::new(9);
        for blades in
            [Blades { count: 3, rotation: 0.4 }, Blades { count: 4, rotation: 0.0 }, Blades { count: 7, rotation: 1.0 }]
        {
            let turn = DVec2::from_angle(blades.rotation);
            let drawn = |i: u32| turn.rotate(warp::regular_polygon(blades.count, [sobol.at(i, 0), sobol.at(i, 1)]));
            assert!((0..4096).all(|i| blades.contains(drawn(i) * (1.0 - 1e-12))));
            let disk = (0..1 << 14).map(|i| warp::disk([sobol.at(i, 0), sobol.at(i, 1)]));
            let passing = disk.filter(|place| blades.contains(*place)).count() as f64 / f64::from(1 << 14);
            assert!((passing - blades.area_fraction()).abs() < 2e-3, "{passing} {}", blades.area_fraction());
            for place in [DVec2::new(0.3, 0.2), DVec2::new(-1.1, 0.7), DVec2::new(0.0, 1.6)] {
                let sum: DVec2 = (0..1 << 14).map(|i| DVec2::from_angle(-PI * place.dot(drawn(i)))).sum();
                let transform = (sum / f64::from(1 << 14)).length_squared();
                assert!((fraunhofer(Some(blades), place) - transform).abs() < 1e-3, "{blades:?} {place}");
            }
        }
    }

    /// The square's pattern is a product of sinc², and 64 blades are nearly a disk.
    #[test]
    fn square_pattern_is_a_sinc_and_many_blades_approach_a_disk() {
        let square = Some(Blades { count: 4, rotation: 0.25 * PI });
        // Half of the square's side is √½ of the circle's radius.
        let x = 1.3;
        let half = PI * x * 0.5_f64.sqrt();
        assert!((fraunhofer(square, DVec2::new(x, 0.0)) - (half.sin() / half).powi(2)).abs() < 1e-12);
        let many = Some(Blades { count: 64, rotation: 0.0 });
        for place in [DVec2::new(0.5, 0.1), DVec2::new(1.0, 1.3)] {
            assert!((fraunhofer(many, place) - fraunhofer(None, place)).abs() < 2e-3);
        }
    }
}
