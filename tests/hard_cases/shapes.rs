//! Shapes: far and small, thin and defective; no ray leaks through a closed surface.

use std::sync::Arc;

use glam::DVec3;
use serde_json::Value;

use abbe_scene::geometry::Ray;
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_scene::geometry::shape::Shape;

use super::golden::golden;
use super::meshes::{At, Raw, alone, ball, glass_scene, leaks, mesh};
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "Spheres of radius 1e-6 to 0.5 at distances 1 to 1e6",
        naive: "b² − 4ac loses all digits beyond 1e8 radii: the hit is missed or lies beside the sphere",
        here: "the discriminant comes from the point of closest approach, the root does not cancel, and the hit is moved onto the surface",
        measured: "position of the hit against 50 digits, in units of 2⁻⁵³ of the distance",
        bound: Bound::AtMost(8.0),
        pace: Pace::Fast,
        measure: || spheres().0,
    },
    Case {
        name: "The distance to the same spheres",
        naive: "the same as in the previous row",
        here: "the same as in the previous row",
        measured: "relative error, compared with a value of 50 digits",
        bound: Bound::AtMost(4e-16),
        pace: Pace::Fast,
        measure: || spheres().1,
    },
    Case {
        name: "Rays from inside and outside at corners, at edges, along edges and at faces of a closed glass mesh",
        naive: "a ray at an edge hits both triangles or none",
        here: "edge signs use the same arithmetic for both triangles; an infinitesimal shift decides exact zeros",
        measured: "leaks of 400,000 paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || leaks(&ball(4), At::Everything, 400_000),
    },
    Case {
        name: "The same mesh, with a hundred million paths",
        naive: "the same as in the previous row",
        here: "the same as in the previous row",
        measured: "leaking paths, of 10⁸",
        bound: Bound::AtMost(0.0),
        pace: Pace::Slow,
        measure: || leaks(&ball(5), At::Everything, 100_000_000),
    },
    Case {
        name: "A closed needle 10⁷ times as long as wide",
        naive: "a determinant below an epsilon drops its triangles",
        here: "no epsilon: only signs decide",
        measured: "leaks of 100,000 paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || leaks(&needle(1e-7), At::Faces, 100_000),
    },
    Case {
        name: "Slivers: a ball flattened to a thickness of 1e-7",
        naive: "as above; normals consist of rounding errors",
        here: "as above",
        measured: "leaks of 100,000 paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let (corners, triangles) = ball(3);
            leaks(&(corners.iter().map(|c| *c * DVec3::new(1.0, 1e-7, 1.0)).collect(), triangles), At::Faces, 100_000)
        },
    },
    Case {
        name: "Some triangles without area",
        naive: "a normal of 0/0 propagates to the picture",
        here: "they are dropped and counted; the mesh stays closed",
        measured: "leaks of 50,000 paths, plus triangles that were not counted",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let (corners, mut triangles) = ball(2);
            let middle = corners.len() as u32 - 1;
            triangles.extend([[0, 0, 1], [middle, middle, middle], [2, 5, 2]]);
            let raw = (corners, triangles);
            let counted = mesh(raw.clone());
            leaks(&raw, At::Everything, 50_000) + 3.0 - counted.dropped() as f64
                + f64::from(u8::from(!counted.is_closed()))
        },
    },
    Case {
        name: "Every triangle twice",
        naive: "two hits at one point: a photon is absorbed twice, or glass is entered twice",
        here: "a crossed face is not hit again from the same side; entering twice counts once",
        measured: "rays that do not end in air, of 1000",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: doubled,
    },
    Case {
        name: "Glass meshes with a hole, a flipped triangle, a fin, doubled faces, or turned inside out",
        naive: "light is lost in them without a warning",
        here: "a mesh is watertight if every edge belongs to two triangles in opposite directions; the scene's notes name meshes that are not",
        measured: "defects not detected, of 5, plus false alarms on a sound mesh",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: undetected,
    },
    Case {
        name: "A lens whose surfaces almost touch at the rim (1e-12) or in the middle (1e-9)",
        naive: "entry and exit in the wrong order, or an epsilon skips one of them",
        here: "a ray leaves a convex object by another face than the one it entered",
        measured: "path length in the glass against the closed form, in m (the lens is 0.1 m wide)",
        bound: Bound::AtMost(1e-15),
        pace: Pace::Fast,
        measure: thin_lenses,
    },
];

/// Returns the worst position error, in units of 2⁻⁵³ of the distance, and the worst relative error
/// of the distance, for hits on spheres.
fn spheres() -> (f64, f64) {
    let numbers = |value: &Value| DVec3::from_array([0, 1, 2].map(|i| value[i].as_f64().unwrap()));
    let decimal = |value: &Value| value.as_str().unwrap().parse::<f64>().unwrap();
    let (mut place, mut distance) = (0.0_f64, 0.0_f64);
    for row in golden("hard_cases.json")["spheres"].as_array().unwrap() {
        let (origin, direction, radius) = (numbers(&row[0]), numbers(&row[1]), row[2].as_f64().unwrap());
        let truth = radius * DVec3::from_array([0, 1, 2].map(|i| decimal(&row[4][i])));
        let hit = alone(Shape::Sphere { radius }).intersect(&Ray::new(origin, direction), None, f64::INFINITY);
        let Some(hit) = hit else { return (f64::INFINITY, f64::INFINITY) };
        place = place.max((hit.position - truth).length() / (0.5 * f64::EPSILON * origin.length()));
        distance = distance.max((hit.t / decimal(&row[3]) - 1.0).abs());
    }
    (place, distance)
}

/// Two long three-sided pyramids on a common base.
fn needle(width: f64) -> Raw {
    let around = |i: f64| DVec3::new(width * (i * 2.1).cos(), 0.0, width * (i * 2.1).sin());
    let corners = vec![DVec3::Y, DVec3::NEG_Y, around(0.0), around(1.0), around(2.0)];
    (corners, vec![[0, 3, 2], [0, 4, 3], [0, 2, 4], [1, 2, 3], [1, 3, 4], [1, 4, 2]])
}

fn cube() -> Raw {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    ((0..8).map(corner).collect(), quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// Counts defective meshes that pass as sound, and sound meshes reported as defective.
fn undetected() -> f64 {
    let (corners, triangles) = cube();
    let hole = (corners.clone(), triangles[1..].to_vec());
    let [a, b, c] = triangles[0];
    let turned = (corners.clone(), [&[[a, c, b]], &triangles[1..]].concat());
    let fin = ([&corners[..], &[DVec3::splat(2.0)]].concat(), [&triangles[..], &[[a, b, 8]]].concat());
    let doubled = (corners.clone(), [&triangles[..], &triangles[..]].concat());
    let inside_out = (corners.clone(), triangles.iter().map(|&[a, b, c]| [a, c, b]).collect());
    let silent =
        [hole, turned, fin, doubled, inside_out].iter().filter(|raw| glass_scene(raw).notes.is_empty()).count();
    (silent + glass_scene(&(corners, triangles)).notes.len()) as f64
}

/// Counts rays through a cube with doubled triangles, followed like paths of light, that do not end
/// in air.
fn doubled() -> f64 {
    use abbe_scene::medium_stack::MediumStack;
    let (corners, triangles) = cube();
    let both = [&triangles[..], &triangles[..]].concat();
    let geometry = alone(Shape::Mesh(Arc::new(TriangleMesh::new(corners, None, None, both).unwrap())));
    let stays_inside = |i: i32| {
        let from = DVec3::new(0.3 + 0.3 * f64::from(i).sin(), 3.0, 0.5 + 0.3 * f64::from(i).cos());
        let towards = DVec3::new(0.5, 0.4, 0.6 + 1e-4 * f64::from(i));
        let ray = Ray::new(from, (towards - from).normalize());
        let mut medium_stack = MediumStack::AIR;
        geometry.for_each_hit(&ray, None, |hit| {
            let enters = ray.direction.dot(hit.normal) < 0.0;
            medium_stack = if enters { medium_stack.entered(0) } else { medium_stack.left(0) };
        });
        !medium_stack.is_air()
    };
    (0..1000).filter(|&i| stays_inside(i)).count() as f64
}

/// Returns the largest error of the path length in two lenses, for rays parallel to the axis.
fn thin_lenses() -> f64 {
    const RADIUS: f64 = 0.2;
    const RIM: f64 = 0.05;
    let depth = |y: f64| y * y / (RADIUS + (RADIUS * RADIUS - y * y).sqrt());
    let mut worst = 0.0_f64;
    // A biconvex lens with a rim of 1e-12, and a biconcave lens 1e-9 thick in the middle.
    for (radius, thickness) in [(RADIUS, 2.0 * depth(RIM) + 1e-12), (-RADIUS, 1e-9)] {
        let lens = Shape::Lens { radius1: radius, radius2: -radius, thickness, diameter: 2.0 * RIM };
        let geometry = alone(lens);
        for i in 0..1000 {
            let y = RIM * f64::from(i) / 1000.0;
            let (sin, cos) = f64::from(i).sin_cos();
            let ray = Ray::new(DVec3::new(y * cos, y * sin, -0.25), DVec3::Z);
            let mut places = Vec::new();
            geometry.for_each_hit(&ray, None, |hit| places.push(hit.position.z));
            let truth = thickness - 2.0 * depth(y) * radius.signum();
            let error = if let [front, back] = places[..] { (back - front - truth).abs() } else { f64::INFINITY };
            worst = worst.max(error);
        }
    }
    worst
}
