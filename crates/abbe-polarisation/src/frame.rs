//! Frames of Stokes vectors, and rotations between them.

use super::stokes::Stokes;
use abbe_spectra::math::elementary::sin_cos;
use abbe_spectra::math::frame::Frame;
use glam::DVec3;
use std::ops::Mul;

/// A rotation of a frame about the direction of travel by an angle θ, counter-clockwise as the
/// receiver sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// cos 2θ.
    pub cos: f64,
    /// sin 2θ.
    pub sin: f64,
}

impl Rotation {
    /// The rotation by 0.
    pub const NONE: Self = Self { cos: 1.0, sin: 0.0 };

    /// Returns the rotation by an angle in degrees, exact for multiples of 45°.
    pub fn degrees(angle: f64) -> Self {
        // Of 2θ, multiples of 90° are subtracted exactly.
        let quarters = (angle / 45.0).round();
        let (sin, cos) = sin_cos((2.0 * (angle - 45.0 * quarters)).to_radians());
        let (sin, cos) = match quarters.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        };
        Self { cos, sin }
    }

    /// Returns the rotation by −θ.
    #[inline]
    #[must_use]
    pub const fn inverse(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }
}

impl Mul<Stokes> for Rotation {
    type Output = Stokes;

    /// Returns the same light in the rotated frame.
    #[inline]
    fn mul(self, light: Stokes) -> Stokes {
        let [s0, s1, s2, s3] = light.0;
        Stokes([s0, self.cos * s1 + self.sin * s2, self.cos * s2 - self.sin * s1, s3])
    }
}

/// The right-handed frame (x, y, travel) of a Stokes vector. All axes are unit vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StokesFrame {
    /// The direction of travel.
    pub travel: DVec3,
    /// The axis of light with S1 = S0.
    pub x: DVec3,
}

impl StokesFrame {
    /// Returns a frame that depends only on the direction of travel, so that a photon need not
    /// store it.
    #[inline]
    pub fn canonical(travel: DVec3) -> Self {
        Self { travel, x: Frame::new(travel).to_world(DVec3::X) }
    }

    /// Returns the frame of a surface or of a scattering event: x = s is perpendicular to the plane
    /// of `travel` and `other` (a normal, or the other direction of travel), along `travel` ×
    /// `other`. Returns the canonical frame if they are parallel.
    #[inline]
    pub fn perpendicular(travel: DVec3, other: DVec3) -> Self {
        let across = travel.cross(other);
        let length = across.length();
        if length > 0.0 { Self { travel, x: across / length } } else { Self::canonical(travel) }
    }

    /// Returns the second axis, travel × x.
    #[inline]
    pub fn y(&self) -> DVec3 {
        self.travel.cross(self.x)
    }

    /// Returns the rotation from this frame to one of the same direction of travel with the first
    /// axis `x`, a unit vector.
    #[inline]
    pub fn rotation_to(&self, x: DVec3) -> Rotation {
        let (cos, sin) = (self.x.dot(x), self.y().dot(x));
        // The quotient removes the rounding errors of the axes.
        let scale = 1.0 / (cos * cos + sin * sin);
        Rotation { cos: (cos * cos - sin * sin) * scale, sin: 2.0 * cos * sin * scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_follows_the_axes() {
        let travel = DVec3::new(0.3, -0.4, 0.5).normalize();
        let frame = StokesFrame::canonical(travel);
        for degrees in [-170.0, -45.0, 0.0, 22.5, 45.0, 90.0, 135.0_f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let found = frame.rotation_to(frame.x * cos + frame.y() * sin);
            let known = Rotation::degrees(degrees);
            assert!((found.cos - known.cos).abs() < 1e-14 && (found.sin - known.sin).abs() < 1e-14, "{degrees}");
            // Light along the new axis has S1 = S0 there.
            let along = Stokes([1.0, known.cos, known.sin, 0.0]);
            assert!(((found * along).0[1] - 1.0).abs() < 1e-14 && (found * along).0[2].abs() < 1e-14);
            assert!((along.angle_of_polarisation_deg() - degrees).rem_euclid(180.0).min(1.0) < 1e-10 || degrees < 0.0);
        }
        assert_eq!(Rotation::degrees(45.0), Rotation { cos: 0.0, sin: 1.0 });
        assert_eq!(Rotation::degrees(-90.0).sin.abs(), 0.0);
    }

    #[test]
    fn frames_are_right_handed_and_perpendicular_to_the_plane() {
        let (travel, normal) = (DVec3::new(0.6, 0.0, -0.8), DVec3::Z);
        let frame = StokesFrame::perpendicular(travel, normal);
        assert!((frame.x.cross(frame.y()) - travel).length() < 1e-15);
        assert!(frame.x.dot(travel).abs() + frame.x.dot(normal).abs() < 1e-15);
        assert!(StokesFrame::perpendicular(DVec3::Z, DVec3::Z).x.is_normalized());
    }
}
