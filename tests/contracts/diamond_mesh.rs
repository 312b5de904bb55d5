//! The brilliant-cut diamond of `scenes/diamond.json`, constructed from the planes of its facets.
//!
//! `tests/bless` writes `scenes/meshes/brilliant.obj`. Proportions after Tolkowsky 1919: table 53 %, crown 34.5°, pavilion 40.75°. The star
//! facets and the halves follow from the points where they meet.

use crate::common::generated::is_up_to_date;
use abbe_format::FileAccess;
use abbe_format::mesh;
use glam::DVec3;
use std::fmt::Write;
use std::path::Path;

/// The plane of a facet: points p of the stone have `normal · p ≤ offset`. The girdle has radius 1,
/// and the axis is +y.
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Plane {
    /// Makes the plane through three points that faces away from the stone's centre.
    fn through(a: DVec3, b: DVec3, c: DVec3) -> Self {
        let normal = (b - a).cross(c - a).normalize();
        let normal = if normal.dot(a - DVec3::new(0.0, 0.05, 0.0)) < 0.0 { -normal } else { normal };
        Self { normal, offset: normal.dot(a) }
    }

    /// Makes the plane through a point whose normal has this azimuth and elevation.
    fn facing(azimuth_deg: f64, elevation_deg: f64, through: DVec3) -> Self {
        let normal = around(azimuth_deg, elevation_deg.to_radians().cos(), elevation_deg.to_radians().sin());
        Self { normal, offset: normal.dot(through) }
    }
}

/// Returns a point by azimuth, radius and height.
fn around(azimuth_deg: f64, radius: f64, height: f64) -> DVec3 {
    let azimuth = azimuth_deg.to_radians();
    DVec3::new(radius * azimuth.cos(), height, radius * azimuth.sin())
}

/// Returns the intersection of three planes.
fn meeting(a: &Plane, b: &Plane, c: &Plane) -> Option<DVec3> {
    let determinant = a.normal.dot(b.normal.cross(c.normal));
    (determinant.abs() > 1e-9).then(|| {
        (b.normal.cross(c.normal) * a.offset
            + c.normal.cross(a.normal) * b.offset
            + a.normal.cross(b.normal) * c.offset)
            / determinant
    })
}

fn facets() -> Vec<Plane> {
    const TABLE: f64 = 0.53;
    const CROWN_DEG: f64 = 34.5;
    const PAVILION_DEG: f64 = 40.75;
    const STAR_DEG: f64 = 21.5;
    const GIRDLE: f64 = 0.04;
    const LOWER_HALVES_REACH: f64 = 0.23;
    let table_height = GIRDLE + (1.0 - TABLE) * CROWN_DEG.to_radians().tan();
    let culet = -PAVILION_DEG.to_radians().tan();
    let bezel = |k: f64| Plane::facing(45.0 * k, 90.0 - CROWN_DEG, around(45.0 * k, 1.0, GIRDLE));
    let star = |k: f64| {
        let azimuth = 45.0 * k + 22.5;
        let edge = TABLE * 22.5_f64.to_radians().cos();
        Plane::facing(azimuth, 90.0 - STAR_DEG, around(azimuth, edge, table_height))
    };
    let mut planes = vec![Plane { normal: DVec3::Y, offset: table_height }];
    for k in 0..8 {
        let k = f64::from(k);
        planes.push(bezel(k));
        planes.push(star(k));
        planes.push(Plane::facing(45.0 * k, PAVILION_DEG - 90.0, DVec3::new(0.0, culet, 0.0)));
        // The facets between two mains, on both sides of the middle at 22.5°.
        let tip = meeting(&star(k), &bezel(k), &bezel(k + 1.0)).expect("star and bezels meet in a point");
        let middle = 45.0 * k + 22.5;
        let slope = PAVILION_DEG.to_radians().tan() * 22.5_f64.to_radians().cos();
        let low = around(middle, LOWER_HALVES_REACH, culet + LOWER_HALVES_REACH * slope);
        for side in [45.0 * k, 45.0 * (k + 1.0)] {
            planes.push(Plane::through(around(side, 1.0, GIRDLE), around(middle, 1.0, GIRDLE), tip));
            planes.push(Plane::through(around(side, 1.0, 0.0), around(middle, 1.0, 0.0), low));
            let foot = around(side, 1.0, 0.0);
            planes.push(Plane::through(foot, around(middle, 1.0, 0.0), foot + DVec3::Y));
        }
    }
    planes
}

/// Returns the stone as an OBJ file: vertices where three planes meet inside all others, and faces
/// in order around each plane.
fn brilliant_obj() -> String {
    let planes = facets();
    let mut corners: Vec<DVec3> = Vec::new();
    for i in 0..planes.len() {
        for j in i + 1..planes.len() {
            for k in j + 1..planes.len() {
                let Some(point) = meeting(&planes[i], &planes[j], &planes[k]) else { continue };
                let inside = planes.iter().all(|plane| plane.normal.dot(point) <= plane.offset + 1e-9);
                if inside && corners.iter().all(|corner| (*corner - point).length() > 1e-6) {
                    corners.push(point);
                }
            }
        }
    }
    let mut text = String::from(
        "# A brilliant-cut diamond, girdle radius 1, axis +y. Written by tests/diamond_mesh.rs.\no brilliant\n",
    );
    for corner in &corners {
        // Rounded before printing, and without a negative zero.
        let corner = (*corner * 1e9).round() / 1e9 + DVec3::ZERO;
        writeln!(text, "v {:.9} {:.9} {:.9}", corner.x, corner.y, corner.z).expect("a string takes all");
    }
    for plane in &planes {
        let mut face: Vec<usize> =
            (0..corners.len()).filter(|&i| (plane.normal.dot(corners[i]) - plane.offset).abs() < 1e-8).collect();
        let centre = face.iter().map(|&i| corners[i]).sum::<DVec3>() / face.len() as f64;
        let u = plane.normal.any_orthonormal_vector();
        let v = plane.normal.cross(u);
        let angle = |i: usize| (corners[i] - centre).dot(v).atan2((corners[i] - centre).dot(u));
        face.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
        let indices: Vec<String> = face.iter().map(|i| (i + 1).to_string()).collect();
        writeln!(text, "f {}", indices.join(" ")).expect("a string takes all");
    }
    text
}

#[test]
fn the_brilliant_is_as_its_planes_say_and_closed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes/brilliant.obj");
    let text = brilliant_obj();
    is_up_to_date("scenes/meshes/brilliant.obj", &text);
    // Table, 8 stars, 8 bezels, 16 upper and 16 lower halves, 16 girdle facets, 8 pavilion mains.
    assert_eq!(text.lines().filter(|line| line.starts_with("f ")).count(), 73);
    let parts = mesh::load(&path, FileAccess::WithinFolder).unwrap().parts;
    assert_eq!(parts.len(), 1);
    assert!(parts[0].mesh.is_closed() && parts[0].mesh.signed_volume() > 0.0);
}
