//! The analytic shapes as one enum, which dispatches each operation to its variant.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::Shape;
use super::cylinder::Cylinder;
use super::flat::FlatShape;
use super::lens::LensSolid;
use super::local::{Crossing, LocalLine, LocalSurfacePoint};
use super::polyhedron::Polyhedron;
use super::sphere::Sphere;
use crate::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::hypot;

/// An analytic shape (every shape except a mesh) that can be intersected in its local frame.
#[derive(Debug, Clone)]
pub(crate) enum Solid {
    Sphere(Sphere),
    Flat(FlatShape),
    Polyhedron(Polyhedron),
    Cylinder(Cylinder),
    Lens(LensSolid),
}

/// A point inside a body scaled by this factor is inside the body, regardless of rounding.
const INSIDE_FRACTION: f64 = 1.0 - 1e-9;

pub(crate) enum ValidShape<'a> {
    Solid(Solid),
    Mesh(&'a Arc<TriangleMesh>),
}

impl Shape {
    /// Checks the parameters. Returns an error, with the JSON path, if a number is not finite or
    /// not positive, the surfaces of a lens cannot span its diameter, or its edge has negative
    /// thickness.
    pub fn validate(&self) -> Result<()> {
        self.validated().map(|_| ())
    }

    /// Returns the corners of a local bounding box, or `None` for an invalid shape.
    pub(crate) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        Some(match self.validated().ok()? {
            ValidShape::Solid(solid) => solid.bounds(&DMat3::IDENTITY),
            ValidShape::Mesh(mesh) => bounds_of(mesh.positions().iter().copied()),
        })
    }

    /// Returns the analytic solid or the (already valid) mesh, or the errors of
    /// [`Shape::validate`].
    pub(crate) fn validated(&self) -> Result<ValidShape<'_>> {
        Ok(ValidShape::Solid(match *self {
            Self::Sphere { radius } => Solid::Sphere(Sphere { radius: positive("radius", radius)? }),
            Self::Rectangle { width, height } => Solid::Flat(FlatShape::Rectangle {
                half_width: 0.5 * positive("width", width)?,
                half_height: 0.5 * positive("height", height)?,
            }),
            Self::Disk { radius } => Solid::Flat(FlatShape::Disk { radius: positive("radius", radius)? }),
            Self::Box { size } => {
                size.to_array().into_iter().try_for_each(|extent| positive("size", extent).map(drop))?;
                Solid::Polyhedron(Polyhedron::cuboid(size))
            }
            Self::Cylinder { radius, height } => Solid::Cylinder(Cylinder {
                radius: positive("radius", radius)?,
                half_height: 0.5 * positive("height", height)?,
            }),
            Self::Prism { side, length, apex_deg } => {
                if !(apex_deg > 0.0 && apex_deg < 180.0) {
                    return Err(Error::input(format!("the apex is {apex_deg} degrees"))
                        .expected("an angle between 0 and 180 degrees")
                        .on_path("apex"));
                }
                Solid::Polyhedron(Polyhedron::prism(positive("side", side)?, positive("length", length)?, apex_deg))
            }
            Self::Lens { radius1, radius2, thickness, diameter } => {
                Solid::Lens(checked_lens(radius1, radius2, thickness, diameter)?)
            }
            Self::Mesh(ref mesh) => return Ok(ValidShape::Mesh(mesh)),
        }))
    }
}

impl Solid {
    /// Returns the first crossing with t > `after`. If the line starts on the face `start_face`,
    /// its origin counts as exactly on this face, regardless of rounding, and the search begins on
    /// the side towards which the line points.
    pub(crate) fn next_crossing(&self, line: &LocalLine, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        match self {
            Self::Sphere(sphere) => sphere.next_crossing(line, start_face, after),
            Self::Flat(flat) => flat.next_crossing(line, start_face, after),
            Self::Polyhedron(body) => body.next_crossing(line, start_face, after),
            Self::Cylinder(cylinder) => cylinder.next_crossing(line, start_face, after),
            Self::Lens(lens) => lens.next_crossing(line, start_face, after),
        }
    }

    /// Projects a point on a face or near it onto the face.
    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurfacePoint {
        match self {
            Self::Sphere(sphere) => sphere.surface(point),
            Self::Flat(flat) => flat.surface(point),
            Self::Polyhedron(body) => body.surface(point, face),
            Self::Cylinder(cylinder) => cylinder.surface(point, face),
            Self::Lens(lens) => lens.surface(point, face),
        }
    }

    /// Returns the texture coordinates of a point of a face, in [0, 1].
    pub(crate) fn uv(&self, point: DVec3, face: u32) -> [f64; 2] {
        match self {
            Self::Sphere(sphere) => sphere.uv(point),
            Self::Flat(flat) => flat.uv(point),
            Self::Polyhedron(body) => body.uv(point, face),
            Self::Cylinder(cylinder) => cylinder.uv(point, face),
            Self::Lens(lens) => lens.uv(point, face),
        }
    }

    /// Returns true if the coordinate u of a face is the azimuth about an axis.
    pub(crate) fn closes_around_axis(&self, face: u32) -> bool {
        match self {
            Self::Sphere(_) => true,
            Self::Flat(_) | Self::Polyhedron(_) => false,
            Self::Cylinder(_) => face == Cylinder::ROUND_FACE,
            Self::Lens(_) => face == LensSolid::ROUND_FACE,
        }
    }

    pub(crate) fn faces(&self) -> u32 {
        match self {
            Self::Sphere(_) | Self::Flat(_) => 1,
            Self::Polyhedron(body) => body.faces(),
            Self::Cylinder(_) => Cylinder::FACES,
            Self::Lens(_) => LensSolid::FACES,
        }
    }

    /// Returns the area of a face in the local frame.
    pub(crate) fn area(&self, face: u32) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.area(),
            Self::Flat(flat) => flat.area(),
            Self::Polyhedron(body) => body.area(face),
            Self::Cylinder(cylinder) => cylinder.area(face),
            Self::Lens(lens) => lens.area(face),
        }
    }

    /// Samples a point of a face uniformly by area in the local frame.
    pub(crate) fn sample(&self, face: u32, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Sphere(sphere) => sphere.sample(u),
            Self::Flat(flat) => flat.sample(u),
            Self::Polyhedron(body) => body.sample(face, u),
            Self::Cylinder(cylinder) => cylinder.sample(face, u),
            Self::Lens(lens) => lens.sample(face, u),
        }
    }

    /// Returns true if the shape bounds a volume.
    pub(crate) fn is_closed(&self) -> bool {
        !matches!(self, Self::Flat(_))
    }

    /// Returns true if a point lies inside the body, with a margin larger than rounding. Returns
    /// `false` for flat shapes and for lenses, which need not be convex.
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        match self {
            Self::Sphere(sphere) => point.length() < INSIDE_FRACTION * sphere.radius,
            Self::Polyhedron(body) => body.contains(point / INSIDE_FRACTION),
            Self::Cylinder(Cylinder { radius, half_height }) => {
                hypot(point.x, point.z) < INSIDE_FRACTION * radius && point.y.abs() < INSIDE_FRACTION * half_height
            }
            Self::Flat(_) | Self::Lens(_) => false,
        }
    }

    /// Returns true if all faces are flat, so that a linear map scales their areas by constants.
    pub(crate) fn has_flat_faces(&self) -> bool {
        matches!(self, Self::Flat(_) | Self::Polyhedron(_))
    }

    /// Returns true if a linear map scales the area of a face alike at all points that differ only
    /// in their distance along the axis, or from the axis.
    pub(crate) fn has_straight_sides(&self) -> bool {
        self.has_flat_faces() || matches!(self, Self::Cylinder(_))
    }

    pub(crate) fn sphere_radius(&self) -> Option<f64> {
        if let Self::Sphere(sphere) = self { Some(sphere.radius) } else { None }
    }

    /// Returns half of the width and half of the height of a rectangle.
    pub(crate) fn rectangle(&self) -> Option<(f64, f64)> {
        let Self::Flat(FlatShape::Rectangle { half_width, half_height }) = *self else { return None };
        Some((half_width, half_height))
    }

    /// Returns the smallest and largest coordinates of the shape after a linear map.
    pub(crate) fn bounds(&self, linear: &DMat3) -> (DVec3, DVec3) {
        let row = |axis| DVec3::new(linear.x_axis[axis], linear.y_axis[axis], linear.z_axis[axis]);
        let rows = [row(0), row(1), row(2)];
        let symmetric = |half_size: [f64; 3]| (-DVec3::from_array(half_size), DVec3::from_array(half_size));
        match *self {
            Self::Sphere(Sphere { radius }) => symmetric(rows.map(|r| radius * r.length())),
            Self::Flat(FlatShape::Rectangle { half_width, half_height }) => {
                symmetric(rows.map(|r| half_width * r.x.abs() + half_height * r.z.abs()))
            }
            Self::Flat(FlatShape::Disk { radius }) => symmetric(rows.map(|r| radius * hypot(r.x, r.z))),
            Self::Polyhedron(ref body) => bounds_of(body.corners().map(|corner| *linear * corner)),
            Self::Cylinder(Cylinder { radius, half_height }) => {
                symmetric(rows.map(|r| radius * hypot(r.x, r.z) + half_height * r.y.abs()))
            }
            Self::Lens(ref lens) => {
                let [low, high] =
                    [-1.0, 1.0].map(|sign| DVec3::from_array(rows.map(|r| sign * lens.support(sign * r))));
                (low, high)
            }
        }
    }
}

pub(crate) fn bounds_of(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let nothing = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
    points.fold(nothing, |(low, high), point| (low.min(point), high.max(point)))
}

fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Error::input(format!("the {name} is {value}")).expected("a positive number").on_path(name))
}

fn checked_lens(radius1: f64, radius2: f64, thickness: f64, diameter: f64) -> Result<LensSolid> {
    positive("thickness", thickness)?;
    positive("diameter", diameter)?;
    for (name, radius) in [("radius1", radius1), ("radius2", radius2)] {
        if !radius.is_finite() || (radius != 0.0 && radius.abs() < 0.5 * diameter) {
            return Err(Error::input(format!("a surface of radius {radius} cannot span a diameter of {diameter}"))
                .expected("a radius of at least half the diameter, or 0 for a plane")
                .on_path(name));
        }
    }
    let lens = LensSolid::new(radius1, radius2, thickness, diameter);
    let (front, back) = lens.rims();
    if back < front {
        return Err(Error::input(format!("the lens's edge would be {} thick", back - front))
            .expected("a larger thickness, flatter surfaces or a smaller diameter")
            .on_path("thickness"));
    }
    Ok(lens)
}
