//! Gradient noise (Perlin 2002).

use super::random::mix64;
use glam::DVec3;

/// The directions from the centre of a cube to the midpoints of its edges.
const GRADIENTS: [DVec3; 12] = [
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(1.0, -1.0, 0.0),
    DVec3::new(-1.0, 1.0, 0.0),
    DVec3::new(-1.0, -1.0, 0.0),
    DVec3::new(1.0, 0.0, 1.0),
    DVec3::new(1.0, 0.0, -1.0),
    DVec3::new(-1.0, 0.0, 1.0),
    DVec3::new(-1.0, 0.0, -1.0),
    DVec3::new(0.0, 1.0, 1.0),
    DVec3::new(0.0, 1.0, -1.0),
    DVec3::new(0.0, -1.0, 1.0),
    DVec3::new(0.0, -1.0, -1.0),
];

/// Returns gradient noise with pseudorandom gradients at the points of the unit lattice, where it
/// is 0. It lies between about −0.82 and 0.82.
pub fn gradient_noise(place: DVec3, seed: u64) -> f64 {
    let corner = place.floor();
    let within = place - corner;
    let fraction = within * within * within * (within * (6.0 * within - 15.0) + 10.0);
    let slope = |x: f64, y: f64, z: f64| {
        let offset = DVec3::new(x, y, z);
        let [x, y, z] = (corner + offset).to_array().map(|c| c as i64 as u64 & 0x1f_ffff);
        let hash = mix64(seed ^ mix64(x | y << 21 | z << 42));
        GRADIENTS[(hash % GRADIENTS.len() as u64) as usize].dot(within - offset)
    };
    let mix = |a: f64, b: f64, fraction: f64| a + fraction * (b - a);
    let along_x = |y: f64, z: f64| mix(slope(0.0, y, z), slope(1.0, y, z), fraction.x);
    let along_y = |z: f64| mix(along_x(0.0, z), along_x(1.0, z), fraction.y);
    mix(along_y(0.0), along_y(1.0), fraction.z)
}
