//! Rotations and their angles, by [`super::elementary`]. The functions of the crate `glam` that
//! compute sines or angles call the C library, so the renderer does not use them.

use super::elementary::{acos, sin, sin_cos};
use glam::{DMat3, DQuat, DVec2, DVec3};

/// Returns the unit vector at an angle from the x axis, in radians towards the y axis.
#[inline]
pub fn unit_vector(angle: f64) -> DVec2 {
    let (sin, cos) = sin_cos(angle);
    DVec2::new(cos, sin)
}

/// Returns the right-handed rotation about a unit vector by an angle in radians.
pub fn quaternion(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = sin_cos(0.5 * angle);
    let vector = axis * sin;
    DQuat::from_xyzw(vector.x, vector.y, vector.z, cos)
}

/// Returns the right-handed rotations about the x, y and z axes by angles in radians.
pub fn about_axes(angles: [f64; 3]) -> [DMat3; 3] {
    let [(sin_x, cos_x), (sin_y, cos_y), (sin_z, cos_z)] = angles.map(sin_cos);
    [
        DMat3::from_cols(DVec3::X, DVec3::new(0.0, cos_x, sin_x), DVec3::new(0.0, -sin_x, cos_x)),
        DMat3::from_cols(DVec3::new(cos_y, 0.0, -sin_y), DVec3::Y, DVec3::new(sin_y, 0.0, cos_y)),
        DMat3::from_cols(DVec3::new(cos_z, sin_z, 0.0), DVec3::new(-sin_z, cos_z, 0.0), DVec3::Z),
    ]
}

/// Returns the angle of the rotation between two orientations in radians, from 0 to π.
pub fn angle_between(a: DQuat, b: DQuat) -> f64 {
    2.0 * acos(a.dot(b).abs().min(1.0))
}

/// Interpolates along the shorter arc (Shoemake 1985), from `from` to an orientation equal to `to`.
pub fn slerp(from: DQuat, to: DQuat, fraction: f64) -> DQuat {
    let cosine = from.dot(to);
    // Both signs of a quaternion are the same orientation.
    let (to, cosine) = if cosine < 0.0 { (-to, -cosine) } else { (to, cosine) };
    if cosine > 1.0 - f64::EPSILON {
        return (from * (1.0 - fraction) + to * fraction).normalize();
    }
    let angle = acos(cosine);
    (from * sin((1.0 - fraction) * angle) + to * sin(fraction * angle)) / sin(angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn rotations_agree_with_glam() {
        let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
        let start = DQuat::from_axis_angle(DVec3::Y, 0.7);
        for i in -40..=40 {
            let angle = 0.1 * PI * f64::from(i);
            assert!(unit_vector(angle).abs_diff_eq(DVec2::from_angle(angle), 1e-15));
            let turned = quaternion(axis, angle);
            assert!(turned.abs_diff_eq(DQuat::from_axis_angle(axis, angle), 1e-15));
            let [x, y, z] = about_axes([angle, 0.5 * angle, -angle]);
            assert!(x.abs_diff_eq(DMat3::from_rotation_x(angle), 1e-15));
            assert!(y.abs_diff_eq(DMat3::from_rotation_y(0.5 * angle), 1e-15));
            assert!(z.abs_diff_eq(DMat3::from_rotation_z(-angle), 1e-15));
            // The cosine limits the accuracy of small angles.
            assert!((angle_between(start, turned) - start.angle_between(turned)).abs() < 1e-7);
            for fraction in [0.0, 0.25, 0.9, 1.0] {
                let found = slerp(start, turned, fraction);
                assert!(found.abs_diff_eq(start.slerp(turned, fraction), 1e-12), "{angle} {fraction}");
            }
        }
        assert_eq!(slerp(start, start, 0.5), start);
        assert_eq!(angle_between(start, -start), 0.0);
    }
}
