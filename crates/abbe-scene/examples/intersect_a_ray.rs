//! Places shapes in the world, and follows a ray straight through their surfaces.
//!
//! ```text
//! cargo run --release -p abbe-scene --example intersect_a_ray
//! ```
//!
//! The docs of `abbe_scene::builder` show a whole scene with materials, a light and a camera.

use abbe_scene::geometry::shape::{PlacedShape, Shape};
use abbe_scene::geometry::{Geometry, Ray};
use abbe_spectra::Result;
use glam::{DAffine3, DVec3};

const NAMES: [&str; 2] = ["floor", "ball"];

fn main() -> Result<()> {
    // Lengths are in m. The rectangle faces +y, and the ball hovers above it.
    let floor = Shape::Rectangle { width: 4.0, height: 4.0 };
    let ball = Shape::Sphere { radius: 0.5 };
    let above = DAffine3::from_translation(DVec3::new(0.0, 1.0, 0.0));
    let placed = vec![
        PlacedShape { shape: floor, to_world: DAffine3::IDENTITY, object: 0 },
        PlacedShape { shape: ball, to_world: above, object: 1 },
    ];
    // Positions are relative to a centre, because coordinates near 0 are the most precise.
    let centre = DVec3::new(0.0, 0.75, 0.0);
    let geometry = Geometry::build(placed, centre)?;

    let mut ray = Ray::new(DVec3::new(0.3, 3.0, 0.0) - centre, DVec3::NEG_Y);
    let mut from = None;
    while let Some(hit) = geometry.intersect(&ray, from, f64::INFINITY) {
        let (name, place) = (NAMES[hit.object as usize], hit.position + centre);
        println!("after {:.3} m: the {name} at {place:.3}, normal {:.3}", hit.t, hit.normal);
        // The next ray states the face on which it starts, so that no epsilon is needed.
        (ray, from) = (Ray::new(hit.position, ray.direction), Some(hit.surface));
    }
    Ok(())
}
