//! Kernels in media beside faces: photons against a Monte Carlo integrator that shares no code with
//! Abbe, and against the path tracer.

use crate::common::compare::{Measured, assert_same};
use crate::common::{all_y, block_means, diffuse, mean_y, render, with_setting};
use abbe_session::render::Integrator;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// Pixels per side of the film, and of a block.
const FILM: usize = 16;
const BLOCK: usize = 4;

/// Half of the side of the box of fog, in m.
const HALF: f64 = 0.4;

/// The scattering coefficient of the fog, in 1/m.
const SCATTERING: f64 = 2.0;

/// The height of the camera above the centre of the box, in m, and its field of view in degrees.
/// The film shows the front face.
const CAMERA: f64 = 3.0;
const FOV: f64 = 17.5;

const LIGHT: DVec3 = DVec3::new(0.9, 1.0, 0.7);

fn fog(scattering: f64) -> Value {
    json!({ "homogeneous": { "absorption": 0, "scattering": scattering, "phase": "isotropic" } })
}

fn boxed(size: [f64; 3], at: [f64; 3], material: &str) -> Value {
    json!({ "shape": { "box": { "size": size } }, "material": material, "transform": [{ "translate": at }] })
}

/// A scene with a light beside bodies of fog.
fn scene(objects: &[Value]) -> Value {
    json!({
        "camera": { "from": [0, 0, CAMERA], "at": [0, 0, 0], "lens": { "pinhole": { "fov": FOV } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "fog": fog(SCATTERING), "mist": fog(3.0) },
        "materials": { "fog": { "boundary": { "medium": "fog" } }, "mist": { "boundary": { "medium": "mist" } },
                       "white": diffuse(0.7) },
        "objects": objects,
        "lights": [{ "point": { "at": LIGHT.to_array(), "spectrum": "E", "luminous_intensity": 1 } }],
        "render": { "photons": 10000 }
    })
}

fn whole_box() -> Value {
    boxed([2.0 * HALF; 3], [0.0; 3], "fog")
}

/// Returns the distance (m) from a position in the box of fog to its faces.
fn to_faces(position: DVec3, direction: DVec3) -> f64 {
    let to_face = |axis: usize| (HALF.copysign(direction[axis]) - position[axis]) / direction[axis];
    (0..3).map(to_face).fold(f64::INFINITY, f64::min).max(0.0)
}

/// Estimates the luminance (cd/m²) of a block by random walks from the camera.
fn walked(block: [usize; 2], stream: &mut Stream) -> f64 {
    const WALKS: u32 = 30_000;
    let blocks = (FILM / BLOCK) as f64;
    let edge = (0.5 * FOV).to_radians().tan();
    let mut sum = 0.0;
    for _ in 0..WALKS {
        let [u, v] = [block[0] as f64 + stream.uniform(), block[1] as f64 + stream.uniform()].map(|at| at / blocks);
        let mut direction = DVec3::new((2.0 * u - 1.0) * edge, (1.0 - 2.0 * v) * edge, -1.0).normalize();
        let mut position = DVec3::Z * CAMERA - (CAMERA - HALF) / direction.z * direction;
        loop {
            let free = -(1.0 - stream.uniform()).ln() / SCATTERING;
            if free >= to_faces(position, direction) {
                break;
            }
            position += free * direction;
            let to_light = LIGHT - position;
            let inside = to_faces(position, to_light.normalize());
            sum += (-SCATTERING * inside).exp() / (4.0 * PI * to_light.length_squared());
            let (height, angle) = (2.0 * stream.uniform() - 1.0, TAU * stream.uniform());
            let radius = (1.0 - height * height).sqrt();
            direction = DVec3::new(radius * angle.cos(), radius * angle.sin(), height);
        }
    }
    sum / f64::from(WALKS)
}

/// Returns the means over the blocks of the film. They are means over seeds 0 to 3.
fn photon_blocks(scene: &Value) -> Vec<f64> {
    const SEEDS: u64 = 8;
    let of_seed = |seed: u64| {
        let rendered = render(&with_setting(scene, "seed", seed), Integrator::Photon, 16);
        block_means(&all_y(&rendered), FILM, BLOCK, &[true; FILM * FILM])
    };
    let runs: Vec<Vec<f64>> = (0..SEEDS).map(of_seed).collect();
    (0..runs[0].len()).map(|i| runs.iter().map(|run| run[i]).sum::<f64>() / SEEDS as f64).collect()
}

/// Fog keeps its light beside its faces. Without a correction, the mean is 7 % too low.
#[test]
fn fog_is_as_bright_beside_its_faces_as_inside() {
    let photon = photon_blocks(&scene(&[whole_box()]));
    let mut stream = Stream::new(Seed::new(7), Purpose::Camera, 0, 0);
    let side = FILM / BLOCK;
    let truth: Vec<f64> = (0..side * side).map(|i| walked([i % side, i / side], &mut stream)).collect();
    let ratios: Vec<f64> = photon.iter().zip(&truth).map(|(photon, truth)| photon / truth).collect();
    let ratio = photon.iter().sum::<f64>() / truth.iter().sum::<f64>();
    println!("mean {ratio:.4}, blocks {ratios:.3?}");
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.06), "{ratios:?}");
}

/// Photons agree with the path tracer beside curved faces, where two bodies overlap, and beside a
/// wall in the fog.
#[test]
fn fog_beside_all_kinds_of_faces_is_like_the_path_tracers() {
    let ball = json!({ "shape": { "sphere": { "radius": HALF } }, "material": "fog" });
    let cases = [
        ("ball", vec![ball]),
        ("overlap", vec![boxed([0.6; 3], [-0.1, -0.1, 0.0], "fog"), boxed([0.5; 3], [0.1, 0.1, 0.02], "mist")]),
        ("wall", vec![whole_box(), boxed([0.02, 0.5, 0.5], [0.0, -0.1, 0.05], "white")]),
    ];
    for (name, objects) in cases {
        let scene = with_setting(&scene(&objects), "photons", 4000);
        let photon = Measured::new(&scene, (Integrator::Photon, 8), 0..8, mean_y);
        let path = Measured::new(&scene, (Integrator::Path, 64), 100..108, mean_y);
        assert_same(&format!("{name}, photon against path"), &photon, &path, 1.5e-2);
    }
}
