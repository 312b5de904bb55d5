//! Diffuse meshes with interpolated normals: closed forms for light that photons carry.
//!
//! The radiance of a diffuse surface is L = ρ/π E cos θ, where θ is the angle between the light and
//! the interpolated normal. The power that a photon brings arrives through the geometric surface,
//! so photons need the correction of Veach 1997, section 5.3.

use crate::common::compare::{Measured, compare};
use crate::common::{all_y, block_means, diffuse, glass, mean_y, overhead_camera};
use abbe_session::render::{Integrator, Rendered};
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::PI;

const ALBEDO: f64 = 0.6;

/// The tilt of the interpolated normals towards +x, in rad.
const TILT: f64 = PI / 12.0;

/// The direction to a distant light.
const TO_LIGHT: DVec3 = DVec3::new(-1.6, 1.0, 0.2);

fn mesh() -> Value {
    json!({ "shape": { "mesh": { "path": "physics/tilted.obj" } }, "material": "grey" })
}

/// The mesh under a distant light, seen from above. `panes` are horizontal panes of glass with
/// index 1.
fn under_a_distant_light(panes: &[[f64; 3]]) -> Value {
    let mut objects = vec![mesh()];
    objects.extend(panes.iter().map(|at| {
        json!({ "shape": { "box": { "size": [0.5, 0.02, 0.5] } }, "material": "clear", "transform": [{ "translate": at }] })
    }));
    json!({
        "camera": overhead_camera([0.0, 0.0], 0.5, 0.1), "film": { "width": 4, "height": 4 },
        "materials": { "grey": diffuse(ALBEDO), "clear": glass(1.0) },
        "objects": objects,
        "lights": [{ "directional": { "toward": (-TO_LIGHT).to_array(), "spectrum": "E", "illuminance": 1 } }],
        "render": { "photons": 5000, "radius": 0.02 }
    })
}

#[track_caller]
fn check(name: &str, scene: &Value, way: (Integrator, u64), truth: f64, tolerance: f64) {
    let seen = Measured::new(scene, way, 0..4, mean_y);
    let (ratio, error) = (seen.mean(0) / truth, seen.error(0) / truth);
    println!("interpolated normals, {name}, {:?}: {ratio:.4} ± {error:.4} of the closed form", way.0);
    assert!(error < 0.35 * tolerance, "too noisy to tell");
    assert!((ratio - 1.0).abs() < tolerance, "{name}, {:?}: {ratio}", way.0);
}

#[test]
fn a_tilted_normal_lights_a_mesh_by_all_estimators() {
    let normal = DVec3::new(TILT.sin(), TILT.cos(), 0.0);
    let truth = ALBEDO / PI * TO_LIGHT.normalize().dot(normal);
    let above = (TO_LIGHT * 0.8).to_array();
    let shadow_rays = under_a_distant_light(&[]);
    check("shadow rays", &shadow_rays, (Integrator::Photon, 64), truth, 5e-3);
    check("shadow rays", &shadow_rays, (Integrator::Path, 64), truth, 5e-3);
    check("connections", &under_a_distant_light(&[above]), (Integrator::Photon, 4), truth, 0.06);
    check("photon map", &under_a_distant_light(&[above, [0.0, 0.3, 0.0]]), (Integrator::Photon, 4), truth, 0.06);
}

/// A vertical wall beside a mesh receives light only from a bright disk on the mesh.
#[test]
fn a_mesh_with_tilted_normals_lights_a_wall_beside_it() {
    const RADIUS: f64 = 0.1;
    const WALL: f64 = 0.05;
    let scene = |radius: f64| {
        json!({
            "camera": { "from": [-1, 0.5, 0], "at": [1, 0.5, 0], "lens": { "pinhole": { "fov": 6 } } },
            "film": { "width": 4, "height": 4 },
            "materials": { "grey": diffuse(ALBEDO), "dark": diffuse(WALL) },
            "objects": [mesh(), { "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "dark",
                "transform": [{ "rotate": { "axis": [0, 0, 1], "degrees": 90 } }, { "translate": [1, 2, 0] }] }],
            "lights": [{ "beam": { "from": [0, 1, 0], "to": [0, 0, 0], "radius": RADIUS, "spectrum": "E", "luminous_flux": 1 } }],
            "render": { "photons": 5000, "radius": radius }
        })
    };
    let illuminance = 1.0 / (PI * RADIUS * RADIUS);
    let disk = ALBEDO / PI * illuminance * TILT.cos();
    // The point in the middle of the picture, and points of the disk at polar coordinates.
    let point = DVec3::new(1.0, 0.5, 0.0);
    let (rings, sectors) = (20, 40);
    let mut received = 0.0;
    for ring in 0..rings {
        for sector in 0..sectors {
            let r = RADIUS * (f64::from(ring) + 0.5) / f64::from(rings);
            let angle = 2.0 * PI * f64::from(sector) / f64::from(sectors);
            let offset = point - DVec3::new(r * angle.cos(), 0.0, r * angle.sin());
            let area = r * RADIUS / f64::from(rings) * 2.0 * PI / f64::from(sectors);
            received += disk * offset.y * offset.x / offset.length_squared().powi(2) * area;
        }
    }
    let truth = WALL / PI * received;
    check("a wall beside a mesh", &scene(0.1), (Integrator::Photon, 64), truth, 0.08);
}

/// Far from the geometric normal, a part of each lobe lies below the surface. Photons and camera
/// paths must scatter this part by the same rule: light of a large lamp that falls through a pane
/// of glass is found by photons alone, or by camera paths alone.
#[test]
fn steep_normals_scatter_photons_and_paths_alike() {
    let metal = json!({ "conductor": { "reflectance": 0.8, "roughness": 0.4 } });
    for (name, material) in [("diffuse", diffuse(ALBEDO)), ("glossy", metal)] {
        let scene = json!({
            "camera": { "from": [0.9, 0.8, 0.4], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
            "film": { "width": 8, "height": 8 },
            "materials": { "floor": material, "clear": glass(1.5), "black": diffuse(0) },
            "objects": [
                { "shape": { "mesh": { "path": "physics/steep.obj" } }, "material": "floor" },
                { "shape": { "box": { "size": [8, 0.1, 8] } }, "material": "clear", "transform": [{ "translate": [0, 1.5, 0] }] },
                { "shape": { "sphere": { "radius": 0.8 } }, "material": "black", "emission": { "spectrum": "E", "power": 5 },
                  "transform": [{ "translate": [-2, 3, 0] }] }
            ],
            "lights": [], "render": { "photons": 20000, "radius": 0.05 }
        });
        let take = |rendered: &Rendered| block_means(&all_y(rendered), 8, 4, &[true; 64]);
        let photon = Measured::new(&scene, (Integrator::Photon, 16), 0..6, take);
        let path = Measured::new(&scene, (Integrator::Path, 2000), 0..6, take);
        let found = compare(&photon, &path);
        println!("steep normals, {name}: {found}");
        assert!(found.is_equal(), "{name}: {found}");
    }
}
