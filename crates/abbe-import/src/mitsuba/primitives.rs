//! Shapes that Mitsuba defines by formulas, as shapes of the scene file.
//!
//! Shapes with textures become triangles, which can have Mitsuba's texture coordinates.

use abbe_format::without_nulls;
use abbe_spectra::math::elementary::sin_cos;
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// The number of flat strips that replace a cylinder.
const STRIPS: u32 = 96;

/// The number of triangles that replace a disk with a texture. Its area is 0.9998 of the disk's.
const FAN: u32 = 192;

/// A shape, and the transform steps that come before the transform of the Mitsuba shape.
pub(super) struct BasicShape {
    pub(super) shape: Value,
    pub(super) steps: Vec<Value>,
}

impl BasicShape {
    fn new(shape: Value) -> Self {
        Self { shape, steps: Vec::new() }
    }
}

/// Rotates the y axis, which a flat shape faces, to +z or −z.
fn facing_z(flipped: bool) -> Value {
    json!({"rotate": {"axis": [1, 0, 0], "degrees": if flipped { -90 } else { 90 }}})
}

/// Returns the square from (−1, −1, 0) to (1, 1, 0), which faces +z.
pub(super) fn rectangle(textured: bool, flipped: bool) -> BasicShape {
    if !textured {
        let shape = json!({"rectangle": {"width": 2, "height": 2}});
        return BasicShape { shape, steps: vec![facing_z(flipped)] };
    }
    let indices = if flipped { [[0, 2, 1], [0, 3, 2]] } else { [[0, 1, 2], [0, 2, 3]] };
    BasicShape::new(json!({"triangles": {
        "positions": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "indices": indices,
        "uv": [[0, 0], [1, 0], [1, 1], [0, 1]]
    }}))
}

/// Returns the disk of radius 1 in the plane z = 0, which faces +z. In Mitsuba, u is the distance
/// from the centre, and v is the angle. A disk with a texture becomes a fan of triangles.
pub(super) fn disk(textured: bool, flipped: bool) -> BasicShape {
    if !textured {
        return BasicShape { shape: json!({"disk": {"radius": 1}}), steps: vec![facing_z(flipped)] };
    }
    let (mut positions, mut uv, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for segment in 0..=FAN {
        let turn = f64::from(segment) / f64::from(FAN);
        let (sin, cos) = sin_cos(TAU * turn);
        positions.extend([[0.0; 3], [cos, sin, 0.0]]);
        uv.extend([[0.0, turn + 0.5 / f64::from(FAN)], [1.0, turn]]);
        if segment < FAN {
            let rim = 2 * segment + 1;
            indices.push(if flipped { [rim - 1, rim + 2, rim] } else { [rim - 1, rim, rim + 2] });
        }
    }
    BasicShape::new(json!({"triangles": {"positions": positions, "indices": indices, "uv": uv}}))
}

/// Returns a sphere. Its poles are on the z axis if the sphere has a texture.
pub(super) fn sphere(centre: DVec3, radius: f64, textured: bool) -> BasicShape {
    if textured {
        let shape = json!({"sphere": {"radius": radius}});
        return BasicShape { shape, steps: vec![facing_z(false), json!({"translate": centre.to_array()})] };
    }
    let center = (centre != DVec3::ZERO).then(|| centre.to_array());
    BasicShape::new(json!({"sphere": without_nulls(json!({"radius": radius, "center": center}))}))
}

/// Returns the cube from (−1, −1, −1) to (1, 1, 1).
pub(super) fn cube(textured: bool, flipped: bool) -> BasicShape {
    if !textured && !flipped {
        return BasicShape::new(json!({"box": {"size": [2, 2, 2]}}));
    }
    // Each face is a list of corners in counter-clockwise order seen from outside.
    const FACES: [[[i32; 3]; 4]; 6] = [
        [[1, -1, -1], [1, -1, 1], [-1, -1, 1], [-1, -1, -1]],
        [[1, 1, -1], [-1, 1, -1], [-1, 1, 1], [1, 1, 1]],
        [[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]],
        [[1, -1, 1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1]],
        [[-1, -1, 1], [-1, 1, 1], [-1, 1, -1], [-1, -1, -1]],
        [[1, 1, -1], [1, -1, -1], [-1, -1, -1], [-1, 1, -1]],
    ];
    let uv: Vec<[i32; 2]> = FACES.iter().flat_map(|_| [[0, 1], [1, 1], [1, 0], [0, 0]]).collect();
    let corners = (0..FACES.len()).map(|face| 4 * face);
    let indices: Vec<[usize; 3]> = corners
        .flat_map(|first| [[first, first + 1, first + 2], [first + 3, first, first + 2]])
        .map(|[a, b, c]| if flipped { [a, c, b] } else { [a, b, c] })
        .collect();
    BasicShape::new(json!({"triangles": {"positions": FACES.as_flattened(), "indices": indices, "uv": uv}}))
}

/// Returns the side of a cylinder as flat strips with smooth normals, or `None` if it is flat.
pub(super) fn cylinder(from: DVec3, to: DVec3, radius: f64, flipped: bool) -> Option<BasicShape> {
    let axis = (to - from).try_normalize().filter(|_| radius > 0.0)?;
    // Mitsuba has the same directions of u = 0 and u = 1/4.
    let (across, along) = axis.any_orthonormal_pair();
    let (mut positions, mut normals, mut uv, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for strip in 0..=STRIPS {
        let turn = f64::from(strip) / f64::from(STRIPS);
        let (sin, cos) = sin_cos(TAU * turn);
        let outward = across * cos + along * sin;
        for (end, v) in [(from, 0), (to, 1)] {
            positions.push((end + radius * outward).to_array());
            normals.push((if flipped { -outward } else { outward }).to_array());
            uv.push([json!(turn), json!(v)]);
        }
        if strip < STRIPS {
            let first = 2 * strip;
            let [a, b, c, d] = [first, first + 2, first + 3, first + 1];
            indices.extend(if flipped { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] });
        }
    }
    Some(BasicShape::new(json!({"triangles": {
        "positions": positions, "indices": indices, "normals": normals, "uv": uv
    }})))
}
