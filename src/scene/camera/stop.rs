//! The opening that a lens's stop leaves: a disk, or the polygon between its blades.

use crate::math::warp;
use crate::optics::aperture::Blades;
use glam::DVec2;

/// A lens's opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Radius in m; of a polygon, from the middle to its corners.
    pub radius_m: f64,
    /// What bounds it; round if nothing.
    pub blades: Option<Blades>,
}

impl Stop {
    /// A place in the opening, in m to the right and up; uniform for uniform `u`.
    pub fn place(&self, u: [f64; 2]) -> DVec2 {
        let unit = match self.blades {
            None => warp::disk(u),
            Some(Blades { count, rotation }) => DVec2::from_angle(rotation).rotate(warp::regular_polygon(count, u)),
        };
        unit * self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::Sobol;
    use std::f64::consts::PI;

    fn places(stop: Stop) -> Vec<DVec2> {
        let sobol = Sobol::new(3);
        (0..1 << 14).map(|i| stop.place([sobol.at(i, 0), sobol.at(i, 1)])).collect()
    }

    #[test]
    fn a_turned_square_has_its_corners_where_the_rotation_says() {
        let square = Stop { radius_m: 2.0, blades: Some(Blades { count: 4, rotation: PI / 4.0 }) };
        let places = places(square);
        // A square of half diagonal 2, turned by 45°, is the box |x|, |y| ≤ √2.
        let largest = places.iter().map(|p| p.x.abs().max(p.y.abs())).fold(0.0, f64::max);
        assert!(largest <= 2.0_f64.sqrt() + 1e-12 && largest > 1.39, "{largest}");
        let right = places.iter().filter(|p| p.x > 0.0 && p.y > 0.0).count() as f64 / places.len() as f64;
        assert!((right - 0.25).abs() < 1e-3, "{right}");
    }

    #[test]
    fn many_blades_leave_a_round_opening() {
        let mean_square = |stop| places(stop).iter().map(|p| p.length_squared()).sum::<f64>() / f64::from(1 << 14);
        let round = mean_square(Stop { radius_m: 1.0, blades: None });
        let many = mean_square(Stop { radius_m: 1.0, blades: Some(Blades { count: 64, rotation: 0.1 }) });
        assert!((round - 0.5).abs() < 1e-3 && (many - 0.5).abs() < 2e-3, "{round}, {many}");
    }
}
