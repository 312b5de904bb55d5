//! The opening of an aperture stop: a disk, or a polygon that blades form.

use abbe_optics::aperture::Blades;
use abbe_spectra::math::rotation::unit_vector;
use abbe_spectra::math::warp;
use glam::DVec2;

/// The opening of a thin lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApertureStop {
    /// The radius in m: for a polygon, that of the circle through the corners.
    pub radius_m: f64,
    pub blades: Option<Blades>,
}

impl ApertureStop {
    /// Samples a point of the opening uniformly, in m to the right and upwards.
    pub fn sample(&self, u: [f64; 2]) -> DVec2 {
        let unit = match self.blades {
            None => warp::disk(u),
            Some(Blades { count, rotation }) => unit_vector(rotation).rotate(warp::regular_polygon(count, u)),
        };
        unit * self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;
    use std::f64::consts::PI;

    fn places(stop: ApertureStop) -> Vec<DVec2> {
        let sobol = Sobol::new(3);
        (0..1 << 14).map(|i| stop.sample([sobol.at(i, 0), sobol.at(i, 1)])).collect()
    }

    #[test]
    fn the_rotation_turns_the_corners_of_a_square() {
        let square = ApertureStop { radius_m: 2.0, blades: Some(Blades { count: 4, rotation: PI / 4.0 }) };
        let places = places(square);
        // A square with a half-diagonal of 2, turned by 45°, becomes the box |x|, |y| ≤ √2.
        let largest = places.iter().map(|p| p.x.abs().max(p.y.abs())).fold(0.0, f64::max);
        assert!(largest <= 2.0_f64.sqrt() + 1e-12 && largest > 1.39, "{largest}");
        let right = places.iter().filter(|p| p.x > 0.0 && p.y > 0.0).count() as f64 / places.len() as f64;
        assert!((right - 0.25).abs() < 1e-3, "{right}");
    }

    #[test]
    fn many_blades_make_a_round_opening() {
        let mean_square = |stop| places(stop).iter().map(|p| p.length_squared()).sum::<f64>() / f64::from(1 << 14);
        let round = mean_square(ApertureStop { radius_m: 1.0, blades: None });
        let many = mean_square(ApertureStop { radius_m: 1.0, blades: Some(Blades { count: 64, rotation: 0.1 }) });
        assert!((round - 0.5).abs() < 1e-3 && (many - 0.5).abs() < 2e-3, "{round}, {many}");
    }
}
