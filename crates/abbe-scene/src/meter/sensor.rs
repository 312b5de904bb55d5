//! Sensors: the sensitive parts of meters.
//!
//! A sensor reads the mean ∫ L(ω) p(ω) dω of the radiance L over directions, where p is a pdf of
//! directions. A factor, π for all kinds of illuminance, converts this mean to the quantity of the
//! meter.

use crate::geometry::SurfaceId;
use crate::medium_stack::MediumStack;
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::warp;
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    pub shape: SensorShape,
    /// The bodies that contain the sensor. It has no meaning for surfaces.
    pub medium_stack: MediumStack,
}

/// The shape of a sensor. Positions are in m, relative to the scene's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorShape {
    Point(DVec3, Response),
    /// The surface of an object, whose points receive light like a plane.
    Surface(u32, ReceivingSide),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReceivingSide {
    /// The side of the surface normal.
    Front,
    /// The other side.
    Back,
    /// The light of both sides is summed.
    Both,
}

/// The pdf of directions, away from the sensor. All vectors are unit vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Response {
    /// A plane with this normal: cos θ/π. The reading is illuminance, divided by π.
    Plane(DVec3),
    /// A sphere: 1/(4π). The reading is the mean illuminance of the sphere's surface, divided by π.
    Sphere,
    /// The side of a cylinder with this axis: sin ε/π², where ε is the angle from the axis. The
    /// reading is the mean illuminance of the side, divided by π.
    Cylinder(DVec3),
    /// A cone around an axis, uniform in solid angle, with 1 − cos θ for the half-angle θ. The
    /// reading is the mean radiance in the cone.
    Cone(DVec3, f64),
}

#[derive(Debug, Clone, Copy)]
pub struct SensorPoint {
    pub position: DVec3,
    /// The surface on which the point lies, if the sensor is a surface.
    pub from: Option<SurfaceId>,
    pub response: Response,
    pub medium_stack: MediumStack,
}

impl Response {
    /// Samples a direction. The response of a cylinder uses all three numbers.
    pub fn sample(self, [u, v, w]: [f64; 3]) -> DVec3 {
        match self {
            Self::Plane(normal) => Frame::new(normal).to_world(warp::cosine_hemisphere([u, v])),
            Self::Sphere => warp::sphere([u, v]),
            // The side consists of planes, one for each direction around the axis.
            Self::Cylinder(axis) => {
                let normal = Frame::new(axis).to_world(warp::spherical_direction(1.0, w));
                Frame::new(normal).to_world(warp::cosine_hemisphere([u, v]))
            }
            Self::Cone(axis, one_minus_cos) => Frame::new(axis).to_world(warp::cone(one_minus_cos, [u, v])),
        }
    }

    /// Per steradian.
    pub fn pdf(self, direction: DVec3) -> f64 {
        match self {
            Self::Plane(normal) => warp::cosine_hemisphere_pdf(normal.dot(direction)),
            Self::Sphere => 0.25 * FRAC_1_PI,
            Self::Cylinder(axis) => axis.cross(direction).length() * FRAC_1_PI * FRAC_1_PI,
            Self::Cone(axis, one_minus_cos) => {
                let outside = 0.5 * (direction - axis).length_squared() > one_minus_cos;
                if outside { 0.0 } else { 1.0 / (TAU * one_minus_cos) }
            }
        }
    }

    /// Returns the normal of a plane, or 0 if the sensor receives light from both sides of every
    /// plane.
    pub fn normal(self) -> DVec3 {
        match self {
            Self::Plane(normal) => normal,
            Self::Sphere | Self::Cylinder(_) | Self::Cone(..) => DVec3::ZERO,
        }
    }

    /// Returns the factor from the mean radiance to the reading: illuminance for planes, spheres
    /// and cylinders, and luminance for cones.
    pub fn factor(self) -> f64 {
        match self {
            Self::Plane(_) | Self::Sphere | Self::Cylinder(_) => PI,
            Self::Cone(..) => 1.0,
        }
    }
}

impl Sensor {
    /// Creates a sensor at a position in m, relative to the scene's centre, in a scene of the size
    /// `extent_m`. A plane, which often lies on a surface such as a floor, is moved along its
    /// normal by a billionth of the distances, so that rounding does not put it behind the surface.
    pub fn at(position: DVec3, response: Response, extent_m: f64) -> Self {
        const SHIFT: f64 = 1e-9;
        let shifted = position + response.normal() * (SHIFT * (extent_m + position.length()));
        Self { shape: SensorShape::Point(shifted, response), medium_stack: MediumStack::AIR }
    }

    pub fn on_object(object: u32, side: ReceivingSide) -> Self {
        Self { shape: SensorShape::Surface(object, side), medium_stack: MediumStack::AIR }
    }

    pub fn position(&self) -> Option<DVec3> {
        match self.shape {
            SensorShape::Point(position, _) => Some(position),
            SensorShape::Surface(..) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;

    /// Each response samples its pdf, which has the integral 1.
    #[test]
    fn responses_sample_their_pdfs() {
        let axis = DVec3::new(0.3, -0.5, 0.8).normalize();
        let (sobol, n) = (Sobol::new(5), 1 << 15);
        for response in [Response::Plane(axis), Response::Sphere, Response::Cylinder(axis), Response::Cone(axis, 0.4)] {
            let test = |direction: DVec3| 1.0 + direction.dot(axis).powi(2) + direction.x;
            let (mut sampled, mut integrated) = (0.0, [0.0; 2]);
            for i in 0..n {
                let u = sobol.point(i);
                sampled += test(response.sample([u[0], u[1], u[2]])) / f64::from(n);
                let uniform = warp::sphere([u[3], u[4]]);
                let pdf = 4.0 * PI * response.pdf(uniform) / f64::from(n);
                integrated[0] += pdf;
                integrated[1] += pdf * test(uniform);
            }
            assert!((integrated[0] - 1.0).abs() < 2e-3, "{response:?}: {integrated:?}");
            assert!((sampled / integrated[1] - 1.0).abs() < 2e-3, "{response:?}: {sampled} {integrated:?}");
        }
    }
}
