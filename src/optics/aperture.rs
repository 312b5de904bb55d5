//! The shape of an opening, round or between straight blades, and the pattern that light makes behind it.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Straight blades all around an opening, whose corners lie on the circle that would bound it without them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blades {
    /// How many; at least 3.
    pub count: u32,
    /// The angle in radians by which the first corner is turned from the picture's right, anticlockwise as the camera looks.
    pub rotation: f64,
}

impl Blades {
    /// The corner of this number, counted anticlockwise, on the unit circle.
    fn corner(self, number: u32) -> DVec2 {
        DVec2::from_angle(self.rotation + TAU * f64::from(number) / f64::from(self.count))
    }

    /// Whether a place, in units of the circle's radius, lies in the opening.
    pub fn leave(self, place: DVec2) -> bool {
        let sector = TAU / f64::from(self.count);
        // From the middle of the nearest blade, whose distance from the centre is cos(sector / 2).
        let angle = (place.to_angle() - self.rotation).rem_euclid(sector) - 0.5 * sector;
        place.length() * angle.cos() <= (0.5 * sector).cos()
    }

    /// The opening's area over that of the circle.
    pub fn share(self) -> f64 {
        let sector = TAU / f64::from(self.count);
        sector.sin() / sector
    }
}

/// Fraunhofer's pattern of an opening: the irradiance relative to the middle's at a place of the image in units of λN, where N belongs to
/// the circle around the opening (Born & Wolf, *Principles of Optics*, §8.5; the polygon by the divergence theorem, Lee & Mittra 1983).
pub fn fraunhofer(blades: Option<Blades>, place: DVec2) -> f64 {
    let q = PI * place;
    let square = q.length_squared();
    if square < 1e-12 {
        return 1.0;
    }
    let Some(blades) = blades else {
        let x = square.sqrt();
        return (2.0 * libm::j1(x) / x).powi(2);
    };
    let amplitude = (0..blades.count).fold(DVec2::ZERO, |sum, number| {
        let (from, to) = (blades.corner(number), blades.corner(number + 1));
        let (edge, middle) = (to - from, 0.5 * (from + to));
        let half = 0.5 * q.dot(edge);
        let sinc = if half.abs() < 1e-8 { 1.0 } else { half.sin() / half };
        sum + q.perp_dot(edge) * sinc * DVec2::from_angle(-q.dot(middle))
    });
    amplitude.length_squared() / (square * PI * blades.share()).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::Sobol;
    use crate::math::warp;

    #[test]
    fn the_first_dark_ring_of_a_disk_lies_at_1_22_and_its_first_bright_one_has_1_75_percent() {
        let dark = 1.219_669_891_266_504;
        assert!(fraunhofer(None, DVec2::new(0.6, (dark * dark - 0.36_f64).sqrt())) < 1e-20);
        assert!((fraunhofer(None, DVec2::new(0.0, 1.634_719)) - 0.017_498).abs() < 1e-6);
        assert!((fraunhofer(None, DVec2::new(1e-7, 0.0)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn between_blades_light_passes_where_places_are_drawn_and_its_pattern_is_their_transform() {
        let sobol = Sobol::new(9);
        for blades in
            [Blades { count: 3, rotation: 0.4 }, Blades { count: 4, rotation: 0.0 }, Blades { count: 7, rotation: 1.0 }]
        {
            let turn = DVec2::from_angle(blades.rotation);
            let drawn = |i: u32| turn.rotate(warp::regular_polygon(blades.count, [sobol.at(i, 0), sobol.at(i, 1)]));
            assert!((0..4096).all(|i| blades.leave(drawn(i) * (1.0 - 1e-12))));
            let disk = (0..1 << 14).map(|i| warp::disk([sobol.at(i, 0), sobol.at(i, 1)]));
            let passing = disk.filter(|place| blades.leave(*place)).count() as f64 / f64::from(1 << 14);
            assert!((passing - blades.share()).abs() < 2e-3, "{passing} {}", blades.share());
            for place in [DVec2::new(0.3, 0.2), DVec2::new(-1.1, 0.7), DVec2::new(0.0, 1.6)] {
                let sum: DVec2 = (0..1 << 14).map(|i| DVec2::from_angle(-PI * place.dot(drawn(i)))).sum();
                let transform = (sum / f64::from(1 << 14)).length_squared();
                assert!((fraunhofer(Some(blades), place) - transform).abs() < 1e-3, "{blades:?} {place}");
            }
        }
    }

    #[test]
    fn a_square_makes_a_cross_of_sincs_and_many_blades_the_pattern_of_a_disk() {
        let square = Some(Blades { count: 4, rotation: 0.25 * PI });
        // Half its side is √½ of the circle's radius.
        let x = 1.3;
        let half = PI * x * 0.5_f64.sqrt();
        assert!((fraunhofer(square, DVec2::new(x, 0.0)) - (half.sin() / half).powi(2)).abs() < 1e-12);
        let many = Some(Blades { count: 64, rotation: 0.0 });
        for place in [DVec2::new(0.5, 0.1), DVec2::new(1.0, 1.3)] {
            assert!((fraunhofer(many, place) - fraunhofer(None, place)).abs() < 2e-3);
        }
    }
}
