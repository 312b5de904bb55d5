//! An analytic shape, whichever it is: one match a question.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::Shape;
use super::cylinder::Cylinder;
use super::flat::Sheet;
use super::lens::Lens;
use super::line::{Crossing, Line};
use super::polyhedron::Polyhedron;
use super::sphere::Sphere;
use crate::error::{Error, Result};
use crate::math::random::ONE_MINUS_ULP;

/// A shape that is not a mesh, ready to be traced in its own frame.
#[derive(Debug, Clone)]
pub(crate) enum Solid {
    Sphere(Sphere),
    Sheet(Sheet),
    Polyhedron(Polyhedron),
    Cylinder(Cylinder),
    Lens(Lens),
}

/// What lies within this share of a body's size is inside it, whatever rounding says.
const CLEAR: f64 = 1.0 - 1e-9;

/// A point of a surface in the shape's frame: snapped to the surface, with the outward unit normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalSurface {
    pub(crate) point: DVec3,
    pub(crate) normal: DVec3,
}

/// The share of a full turn from x towards y, in [0, 1).
pub(super) fn turn(x: f64, y: f64) -> f64 {
    // A tiny negative angle would round to 1.
    (y.atan2(x) / TAU).rem_euclid(1.0).min(ONE_MINUS_ULP)
}

impl Solid {
    /// The analytic form of a shape; `None` for a mesh.
    ///
    /// # Errors
    /// Numbers that make no body: not finite, not positive, a lens whose edge has negative thickness.
    pub(crate) fn new(shape: &Shape) -> Result<Option<Self>> {
        Ok(Some(match *shape {
            Shape::Sphere { radius } => Self::Sphere(Sphere { radius: positive("radius", radius)? }),
            Shape::Rectangle { width, height } => Self::Sheet(Sheet::Rectangle {
                half_width: 0.5 * positive("width", width)?,
                half_height: 0.5 * positive("height", height)?,
            }),
            Shape::Disk { radius } => Self::Sheet(Sheet::Disk { radius: positive("radius", radius)? }),
            Shape::Box { size } => {
                for extent in size.to_array() {
                    positive("size", extent)?;
                }
                Self::Polyhedron(Polyhedron::cuboid(size))
            }
            Shape::Cylinder { radius, height } => Self::Cylinder(Cylinder {
                radius: positive("radius", radius)?,
                half_height: 0.5 * positive("height", height)?,
            }),
            Shape::Prism { side, length, apex_deg } => {
                if !(apex_deg > 0.0 && apex_deg < 180.0) {
                    return Err(Error::input(format!("the apex is {apex_deg} degrees"))
                        .expected("an angle between 0 and 180 degrees")
                        .on_path("apex"));
                }
                Self::Polyhedron(Polyhedron::prism(positive("side", side)?, positive("length", length)?, apex_deg))
            }
            Shape::Lens { radius1, radius2, thickness, diameter } => {
                Self::Lens(checked_lens(radius1, radius2, thickness, diameter)?)
            }
            Shape::Mesh(_) => return Ok(None),
        }))
    }

    /// The first crossing beyond `after`. A line that starts on face `on` is taken to be exactly on it, whatever
    /// rounding says, and its next crossing is found from the side it goes to.
    pub(crate) fn next(&self, line: &Line, on: Option<u32>, after: f64) -> Option<Crossing> {
        match self {
            Self::Sphere(sphere) => sphere.next(line, on, after),
            Self::Sheet(sheet) => sheet.next(line, on, after),
            Self::Polyhedron(body) => body.next(line, on, after),
            Self::Cylinder(cylinder) => cylinder.next(line, on, after),
            Self::Lens(lens) => lens.next(line, on, after),
        }
    }

    /// The surface of a face at a point on or near it.
    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurface {
        match self {
            Self::Sphere(sphere) => sphere.surface(point),
            Self::Sheet(sheet) => sheet.surface(point),
            Self::Polyhedron(body) => body.surface(point, face),
            Self::Cylinder(cylinder) => cylinder.surface(point, face),
            Self::Lens(lens) => lens.surface(point, face),
        }
    }

    /// Texture coordinates of a point of a face, in [0, 1].
    pub(crate) fn uv(&self, point: DVec3, face: u32) -> [f64; 2] {
        match self {
            Self::Sphere(sphere) => sphere.uv(point),
            Self::Sheet(sheet) => sheet.uv(point),
            Self::Polyhedron(body) => body.uv(point, face),
            Self::Cylinder(cylinder) => cylinder.uv(point, face),
            Self::Lens(lens) => lens.uv(point, face),
        }
    }

    /// How many faces it has.
    pub(crate) fn faces(&self) -> u32 {
        match self {
            Self::Sphere(_) | Self::Sheet(_) => 1,
            Self::Polyhedron(body) => body.faces(),
            Self::Cylinder(_) => Cylinder::FACES,
            Self::Lens(_) => Lens::FACES,
        }
    }

    /// Area of a face in its own frame.
    pub(crate) fn area(&self, face: u32) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.area(),
            Self::Sheet(sheet) => sheet.area(),
            Self::Polyhedron(body) => body.area(face),
            Self::Cylinder(cylinder) => cylinder.area(face),
            Self::Lens(lens) => lens.area(face),
        }
    }

    /// A point uniform over a face, by area in its own frame.
    pub(crate) fn sample(&self, face: u32, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Sphere(sphere) => sphere.sample(u),
            Self::Sheet(sheet) => sheet.sample(u),
            Self::Polyhedron(body) => body.sample(face, u),
            Self::Cylinder(cylinder) => cylinder.sample(face, u),
            Self::Lens(lens) => lens.sample(face, u),
        }
    }

    /// Whether it bounds a volume (rectangle and disk do not).
    pub(crate) fn is_closed(&self) -> bool {
        match self {
            Self::Sheet(_) => false,
            Self::Sphere(_) | Self::Polyhedron(_) | Self::Cylinder(_) | Self::Lens(_) => true,
        }
    }

    /// Whether a point lies inside, clear of the surface by more than rounding; a sheet and a lens, which need not be convex, are not asked.
    pub(crate) fn holds(&self, point: DVec3) -> bool {
        match self {
            Self::Sphere(sphere) => point.length() < CLEAR * sphere.radius,
            Self::Polyhedron(body) => body.holds(point / CLEAR),
            Self::Cylinder(Cylinder { radius, half_height }) => {
                point.x.hypot(point.z) < CLEAR * radius && point.y.abs() < CLEAR * half_height
            }
            Self::Sheet(_) | Self::Lens(_) => false,
        }
    }

    /// Whether all faces are flat, so that a linear map scales the area of each evenly.
    pub(crate) fn has_flat_faces(&self) -> bool {
        match self {
            Self::Sheet(_) | Self::Polyhedron(_) => true,
            Self::Sphere(_) | Self::Cylinder(_) | Self::Lens(_) => false,
        }
    }

    /// The radius, of a sphere.
    pub(crate) fn sphere_radius(&self) -> Option<f64> {
        match self {
            Self::Sphere(sphere) => Some(sphere.radius),
            Self::Sheet(_) | Self::Polyhedron(_) | Self::Cylinder(_) | Self::Lens(_) => None,
        }
    }

    /// Half the width and half the height, of a rectangle.
    pub(crate) fn rectangle(&self) -> Option<(f64, f64)> {
        match *self {
            Self::Sheet(Sheet::Rectangle { half_width, half_height }) => Some((half_width, half_height)),
            Self::Sheet(Sheet::Disk { .. })
            | Self::Sphere(_)
            | Self::Polyhedron(_)
            | Self::Cylinder(_)
            | Self::Lens(_) => None,
        }
    }

    /// Least and largest coordinates after a linear map.
    pub(crate) fn bounds(&self, linear: &DMat3) -> (DVec3, DVec3) {
        let row = |axis| DVec3::new(linear.x_axis[axis], linear.y_axis[axis], linear.z_axis[axis]);
        let rows = [row(0), row(1), row(2)];
        let symmetric = |reach: [f64; 3]| (-DVec3::from_array(reach), DVec3::from_array(reach));
        match *self {
            Self::Sphere(Sphere { radius }) => symmetric(rows.map(|r| radius * r.length())),
            Self::Sheet(Sheet::Rectangle { half_width, half_height }) => {
                symmetric(rows.map(|r| half_width * r.x.abs() + half_height * r.z.abs()))
            }
            Self::Sheet(Sheet::Disk { radius }) => symmetric(rows.map(|r| radius * r.x.hypot(r.z))),
            Self::Polyhedron(ref body) => around(body.corners().map(|corner| *linear * corner)),
            Self::Cylinder(Cylinder { radius, half_height }) => {
                symmetric(rows.map(|r| radius * r.x.hypot(r.z) + half_height * r.y.abs()))
            }
            Self::Lens(ref lens) => {
                let [low, high] = [-1.0, 1.0].map(|sign| DVec3::from_array(rows.map(|r| sign * lens.reach(sign * r))));
                (low, high)
            }
        }
    }
}

/// Least and largest coordinates of some points.
pub(crate) fn around(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let nothing = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
    points.fold(nothing, |(low, high), point| (low.min(point), high.max(point)))
}

fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Error::input(format!("the {name} is {value}")).expected("a positive number").on_path(name))
}

fn checked_lens(radius1: f64, radius2: f64, thickness: f64, diameter: f64) -> Result<Lens> {
    positive("thickness", thickness)?;
    positive("diameter", diameter)?;
    for (name, radius) in [("radius1", radius1), ("radius2", radius2)] {
        if !radius.is_finite() || (radius != 0.0 && radius.abs() < 0.5 * diameter) {
            return Err(Error::input(format!("a surface of radius {radius} cannot span a diameter of {diameter}"))
                .expected("a radius of at least half the diameter, or 0 for a plane")
                .on_path(name));
        }
    }
    let lens = Lens::new(radius1, radius2, thickness, diameter);
    let (front, back) = lens.rims();
    if back < front {
        return Err(Error::input(format!("the lens's edge would be {} thick", back - front))
            .expected("a larger thickness, flatter surfaces or a smaller diameter")
            .on_path("thickness"));
    }
    Ok(lens)
}
