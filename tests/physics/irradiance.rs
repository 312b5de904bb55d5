//! A diffuse floor under each kind of light has the radiance of the closed form: L_v = ρ E_v / π.

use crate::common::compare::Measured;
use crate::common::{diffuse, glass, mean_y, overhead_camera, with_setting};
use abbe::render::Integrator;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The reflectance of the floor.
const ALBEDO: f64 = 0.6;

/// Half the side of the visible square of floor, whose centre is (`MIDDLE`, 0).
const HALF: f64 = 0.1;
const MIDDLE: f64 = 0.7;

/// A floor at y = 0 seen from above.
fn floor(objects: &[Value], lights: &[Value]) -> Value {
    let mut all =
        vec![json!({ "name": "floor", "shape": { "rectangle": { "width": 40, "height": 40 } }, "material": "grey" })];
    all.extend_from_slice(objects);
    json!({
        "camera": overhead_camera([MIDDLE, 0.0], 0.5, 2.0 * HALF),
        "film": { "width": 8, "height": 8 },
        "materials": { "grey": diffuse(ALBEDO), "black": "absorber", "mirror": { "mirror": { "reflectance": 1 } },
                       "clear": glass(1.0) },
        "objects": all, "lights": lights, "render": { "photons": 1000 }
    })
}

/// Returns the mean of an illuminance over the visible square.
fn mean_over_view(illuminance: impl Fn(f64, f64) -> f64) -> f64 {
    const N: u32 = 40;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(N) * 2.0 * HALF - HALF;
    (0..N * N).map(|i| illuminance(MIDDLE + at(i % N), at(i / N))).sum::<f64>() / f64::from(N * N)
}

/// Renders with an integrator and compares the mean luminance with the closed form.
fn check(name: &str, scene: &Value, illuminance: f64, integrator: Integrator, passes: u64) {
    let luminance = ALBEDO * illuminance / PI;
    let measured = Measured::new(scene, (integrator, passes), 0..4, mean_y);
    let (ratio, error) = (measured.mean(0) / luminance, measured.error(0) / luminance);
    println!("irradiance, {name}, {integrator:?}: {ratio:.5} ± {error:.5} of {luminance:.5} cd/m²");
    assert!(error < 1.5e-3, "too noisy to tell");
    assert!((ratio - 1.0).abs() < 5e-3, "{name}: {ratio} of the closed form");
}

const BOTH: [Integrator; 2] = [Integrator::Photon, Integrator::Path];

#[test]
fn a_point_lamp_of_so_many_lumens() {
    let flux = 700.0;
    let scene = floor(&[], &[json!({ "point": { "at": [0.2, 1.1, 0.3], "spectrum": "D65", "luminous_flux": flux } })]);
    let illuminance = mean_over_view(|x, z| {
        let d2 = (x - 0.2).powi(2) + 1.1_f64.powi(2) + (z - 0.3).powi(2);
        flux / (4.0 * PI) * 1.1 / d2.powf(1.5)
    });
    BOTH.into_iter().for_each(|integrator| check("point", &scene, illuminance, integrator, 32));
}

#[test]
fn a_sphere_of_so_many_lumens() {
    let flux = 900.0;
    let lamp = json!({ "name": "lamp", "shape": { "sphere": { "center": [0.2, 1.1, 0.3], "radius": 0.4 } }, "material": "black",
                       "emission": { "spectrum": "A", "luminous_flux": flux } });
    // A uniform sphere that is wholly above the horizon lights a plane like a point of the same
    // flux at its centre.
    let illuminance = mean_over_view(|x, z| {
        let d2 = (x - 0.2).powi(2) + 1.1_f64.powi(2) + (z - 0.3).powi(2);
        flux / (4.0 * PI) * 1.1 / d2.powf(1.5)
    });
    BOTH.into_iter()
        .for_each(|integrator| check("sphere", &floor(std::slice::from_ref(&lamp), &[]), illuminance, integrator, 64));
}

#[test]
fn a_rectangle_of_so_many_lumens() {
    let (flux, width, depth, height) = (500.0, 0.8, 0.5, 0.9);
    let lamp = json!({ "name": "lamp", "shape": { "rectangle": { "width": width, "height": depth } }, "material": "black",
                       "emission": { "spectrum": "FL2", "luminous_flux": flux },
                       "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0.1, height, 0.2] } ] });
    let luminance = flux / (PI * width * depth);
    // The form factor of a parallel rectangle with one corner above the point (standard tables of
    // view factors). The sum over the corners is signed.
    let corner = |a: f64, b: f64| {
        let (p, q) = ((a * a + height * height).sqrt(), (b * b + height * height).sqrt());
        0.5 * (a / p * (b / p).atan() + b / q * (a / q).atan())
    };
    let illuminance = mean_over_view(|x, z| {
        let [left, right] = [-0.5, 0.5].map(|s| 0.1 + s * width - x);
        let [near, far] = [-0.5, 0.5].map(|s| 0.2 + s * depth - z);
        luminance * (corner(right, far) - corner(left, far) - corner(right, near) + corner(left, near))
    });
    BOTH.into_iter().for_each(|integrator| {
        check("rectangle", &floor(std::slice::from_ref(&lamp), &[]), illuminance, integrator, 64)
    });
}

#[test]
fn a_directional_lamp_of_so_many_lux() {
    let cos = 2.0 / 6.0_f64.sqrt();
    for angular_diameter in [0.0, 8.0] {
        let lamp = json!({ "directional": { "toward": [1, -2, -1], "spectrum": "D65", "illuminance": 400,
                                            "angular_diameter": angular_diameter } });
        let name = format!("directional, {angular_diameter}° wide");
        BOTH.into_iter()
            .for_each(|integrator| check(&name, &floor(&[], std::slice::from_ref(&lamp)), 400.0 * cos, integrator, 32));
    }
}

#[test]
fn uniform_surroundings_of_so_many_lux() {
    let lamp = json!({ "environment": { "spectrum": "E", "illuminance": 250 } });
    BOTH.into_iter()
        .for_each(|integrator| check("environment", &floor(&[], std::slice::from_ref(&lamp)), 250.0, integrator, 64));
}

#[test]
fn a_beam_of_so_many_lumens() {
    // The disk of light covers the whole view: E = Φ/(π r²) · cos θ.
    let lamp = json!({ "beam": { "from": [MIDDLE - 1.0, 1.0, 0], "to": [MIDDLE, 0, 0], "radius": 0.3, "spectrum": "E",
                                 "luminous_flux": 80 } });
    let illuminance = 80.0 / (PI * 0.09) * 0.5_f64.sqrt();
    BOTH.into_iter()
        .for_each(|integrator| check("beam", &floor(&[], std::slice::from_ref(&lamp)), illuminance, integrator, 32));
}

/// A mirror wall at x = −0.5 that faces +x, with a light in front of it. The floor sees the light
/// and its mirror image at x → −1 − x.
fn mirrored_point() -> (Vec<Value>, Value, f64) {
    let wall = json!({ "name": "wall", "shape": { "rectangle": { "width": 40, "height": 40 } }, "material": "mirror",
                       "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": -90 } }, { "translate": [-0.5, 0, 0] } ] });
    let lamp = json!({ "point": { "at": [0.2, 1.1, 0.3], "spectrum": "D65", "luminous_flux": 700 } });
    let illuminance = mean_over_view(|x, z| {
        let from = |at: f64| {
            let d2 = (x - at).powi(2) + 1.1_f64.powi(2) + (z - 0.3).powi(2);
            700.0 / (4.0 * PI) * 1.1 / d2.powf(1.5)
        };
        from(0.2) + from(-1.2)
    });
    (vec![wall], lamp, illuminance)
}

#[test]
fn connected_photons_carry_a_mirrored_lamps_irradiance() {
    let (objects, lamp, illuminance) = mirrored_point();
    let scene = with_setting(&floor(&objects, &[lamp]), "photons", 20000);
    check("mirror image, connected", &scene, illuminance, Integrator::Photon, 24);
}

#[test]
fn photons_in_the_map_bring_the_light_of_a_lamps_mirror_image() {
    // The camera looks through a pane with index 1, so that the photon map estimates this light.
    let (mut objects, lamp, illuminance) = mirrored_point();
    objects.push(json!({ "name": "pane", "shape": { "box": { "size": [0.5, 0.02, 0.5] } }, "material": "clear",
                         "transform": [ { "translate": [MIDDLE, 0.4, 0] } ] }));
    let mut scene = floor(&objects, &[lamp]);
    scene["render"] = json!({ "photons": 20000, "radius": 0.02 });
    check("mirror image, from the map", &scene, illuminance, Integrator::Photon, 24);
}

#[test]
fn shared_photons_carry_a_mirrored_lamps_irradiance() {
    let (objects, lamp, illuminance) = mirrored_point();
    let mut scene = floor(&objects, &[lamp]);
    scene["render"] = json!({ "photons": 20000, "radius": 0.02, "force": ["shared"] });
    check("mirror image, shared wavelengths", &scene, illuminance, Integrator::Photon, 64);
}
