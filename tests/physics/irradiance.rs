//! A diffuse floor under each kind of light has the radiance of the closed form: L_v = ρ E_v / π.

use crate::common::compare::Measured;
use crate::common::{diffuse, glass, mean_y, overhead_camera, with_setting};
use abbe_session::render::{Integrator, Rendered};
use glam::{DQuat, DVec3};
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
    check_within(name, scene, illuminance, (integrator, passes), 5e-3);
}

fn check_within(name: &str, scene: &Value, illuminance: f64, way: (Integrator, u64), tolerance: f64) {
    let (integrator, passes) = way;
    let luminance = ALBEDO * illuminance / PI;
    let measured = Measured::new(scene, (integrator, passes), 0..4, mean_y);
    let (ratio, error) = (measured.mean(0) / luminance, measured.error(0) / luminance);
    println!("irradiance, {name}, {integrator:?}: {ratio:.5} ± {error:.5} of {luminance:.5} cd/m²");
    assert!(error < 0.3 * tolerance, "too noisy to tell");
    assert!((ratio - 1.0).abs() < tolerance, "{name}: {ratio} of the closed form");
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

/// The luminous intensity of `uneven.ies` in cd, for an offset from the luminaire to a point below
/// it. The half-plane C0 is along +x, and C90 is along −z. Only angles γ up to 60° and C from 0° to
/// 90° are supported.
fn uneven_candela([x, y, z]: [f64; 3]) -> f64 {
    let gamma = (x.hypot(z) / -y).atan().to_degrees();
    let c = (-z).atan2(x).to_degrees();
    assert!(gamma <= 60.0 && (0.0..=90.0).contains(&c), "γ {gamma}, C {c}");
    let at_60 = 300.0 + c / 90.0 * (600.0 - 300.0);
    900.0 + gamma / 60.0 * (at_60 - 900.0)
}

#[test]
fn a_luminaire_of_a_photometric_file() {
    let luminaire = json!({ "ies": { "at": [0.2, 1.1, 0.3], "toward": [0, -1, 0], "path": "physics/uneven.ies", "spectrum": "D65" } });
    // E = I(γ, C) cos γ/d².
    let from = |[a, b]: [f64; 2], [x, z]: [f64; 2]| {
        let offset = [x - a, -1.1, z - b];
        uneven_candela(offset) * 1.1 / offset.iter().map(|side| side * side).sum::<f64>().powf(1.5)
    };
    let illuminance = mean_over_view(|x, z| from([0.2, 0.3], [x, z]));
    BOTH.into_iter()
        .for_each(|way| check("luminaire", &floor(&[], std::slice::from_ref(&luminaire)), illuminance, way, 32));
    // The opening is 0.8 m along C0 and 0.3 m along C90. Its points have equal intensities.
    let mut panel = luminaire.clone();
    panel["ies"]["area"] = json!(true);
    panel["ies"]["at"] = json!([0.0, 1.1, 0.6]);
    let illuminance = mean_over_view(|x, z| {
        let side = |i: u32, length: f64| ((f64::from(i) + 0.5) / 20.0 - 0.5) * length;
        let at = |i: u32| from([side(i % 20, 0.8), 0.6 + side(i / 20, 0.3)], [x, z]);
        (0..400).map(at).sum::<f64>() / 400.0
    });
    BOTH.into_iter().for_each(|way| check("panel", &floor(&[], std::slice::from_ref(&panel)), illuminance, way, 64));
    // A stated flux replaces the flux of the file: twice the flux gives twice the illuminance.
    let half = with_flux(&luminaire, 500.0);
    let whole = with_flux(&luminaire, 1000.0);
    let luminance = |lamp: &Value| {
        Measured::new(&floor(&[], std::slice::from_ref(lamp)), (Integrator::Path, 4), 0..2, mean_y).mean(0)
    };
    assert!((luminance(&whole) / luminance(&half) - 2.0).abs() < 1e-6);
}

fn with_flux(luminaire: &Value, flux: f64) -> Value {
    let mut luminaire = luminaire.clone();
    luminaire["ies"]["luminous_flux"] = json!(flux);
    luminaire
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
    check("mirror image, connected", &scene, illuminance, Integrator::Photon, 16);
}

/// Equal energy at all wavelengths is white in every direction. All light passes a pane with index
/// 1, so that photons carry it.
#[test]
fn photons_of_a_white_lamp_are_white_in_every_direction() {
    let lamp = |x: f64| json!({ "point": { "at": [x, 1.1, 0], "spectrum": "E", "luminous_flux": 700 } });
    let pane = json!({ "name": "pane", "shape": { "box": { "size": [4, 0.02, 4] } }, "material": "clear",
                       "transform": [{ "translate": [MIDDLE, 0.8, 0] }] });
    // The whole picture, its middle, and its four quarters, 8 × 8 pixels.
    let inside = |pixel: usize| [pixel % 8, pixel / 8].iter().all(|i| (2..6).contains(i));
    let part = |of: usize, pixel: usize| match of {
        0 => true,
        1 => inside(pixel),
        quarter => quarter - 2 == pixel % 8 / 4 + 2 * (pixel / 32),
    };
    let colours = |rendered: &Rendered| {
        let sum = |of: usize, c: usize| {
            let pixels = rendered.picture.xyz.iter().enumerate().filter(|(pixel, _)| part(of, *pixel));
            pixels.map(|(_, xyz)| xyz[c]).sum::<f64>()
        };
        (0..6).flat_map(|of| [sum(of, 0) / sum(of, 1), sum(of, 2) / sum(of, 1)]).collect()
    };
    for x in [MIDDLE, MIDDLE + 1.0] {
        let scene = with_setting(&floor(std::slice::from_ref(&pane), &[lamp(x)]), "photons", 5000);
        let found = Measured::new(&scene, (Integrator::Photon, 8), 0..4, colours);
        for i in 0..12 {
            let (of, ratio, known_within) = (i / 2, ["X/Y", "Z/Y"][i % 2], if i < 2 { 0.02 } else { 0.06 });
            println!("white lamp at {x} m, part {of}: {ratio} = {:.4} ± {:.4}", found.mean(i), found.error(i));
            assert!(found.error(i) < 0.3 * known_within, "too noisy to tell");
            assert!((found.mean(i) - 1.0).abs() < known_within, "part {of}: {ratio} = {}", found.mean(i));
        }
    }
}

#[test]
fn photons_in_the_map_bring_the_light_of_a_lamps_mirror_image() {
    // The camera looks through a pane with index 1, so that the photon map estimates this light.
    let (mut objects, lamp, illuminance) = mirrored_point();
    objects.push(json!({ "name": "pane", "shape": { "box": { "size": [0.5, 0.02, 0.5] } }, "material": "clear",
                         "transform": [ { "translate": [MIDDLE, 0.4, 0] } ] }));
    let mut scene = floor(&objects, &[lamp]);
    scene["render"] = json!({ "photons": 5000, "radius": 0.02 });
    check("mirror image, from the map", &scene, illuminance, Integrator::Photon, 80);
}

fn fog(absorption: f64) -> Value {
    json!({ "fog": { "homogeneous": { "absorption": absorption, "scattering": 0, "phase": "isotropic" } } })
}

/// A box of absorbing fog is between the floor and the camera, beside the way of the light.
#[test]
fn fog_before_the_camera_attenuates_connected_photons() {
    const COEFFICIENT: f64 = 8.0;
    const THICKNESS: f64 = 0.1;
    let object = |size: [f64; 3], at: [f64; 3], material: &str| json!({ "shape": { "box": { "size": size } }, "material": material, "transform": [{ "translate": at }] });
    let pane = object([3.0, 0.02, 3.0], [MIDDLE, 0.8, 0.0], "clear");
    let box_of_fog = object([0.08, THICKNESS, 0.08], [MIDDLE, 0.42, 0.0], "fog");
    let lamp = json!({ "point": { "at": [0.2, 1.1, 0.3], "spectrum": "D65", "luminous_flux": 700 } });
    let mut scene = floor(&[pane, box_of_fog], &[lamp]);
    scene["media"] = fog(COEFFICIENT);
    scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
    scene["render"]["photons"] = json!(20000);
    let illuminance = mean_over_view(|x, z| {
        let d2 = (x - 0.2).powi(2) + 1.1_f64.powi(2) + (z - 0.3).powi(2);
        let slant = ((x - MIDDLE).powi(2) + z * z + 0.25).sqrt() / 0.5;
        700.0 / (4.0 * PI) * 1.1 / d2.powf(1.5) * (-COEFFICIENT * THICKNESS * slant).exp()
    });
    check_within("fog before the camera", &scene, illuminance, (Integrator::Photon, 4), 0.03);
}

/// In the middle of a ball of absorbing fog, light from all directions crosses the radius of the
/// ball. Shadow rays and scattered rays that leave the scene are both attenuated.
#[test]
fn uniform_surroundings_are_attenuated_by_a_ball_of_fog() {
    let (coefficient, radius) = (0.2, 5.0);
    let ball = json!({ "shape": { "sphere": { "center": [MIDDLE, 0, 0], "radius": radius } }, "material": "fog" });
    let sky = json!({ "environment": { "spectrum": "D65", "illuminance": 100 } });
    let mut scene = floor(&[ball], &[sky]);
    scene["media"] = fog(coefficient);
    scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
    scene["render"] = json!({ "photons": 100, "forbid": ["indirect"] });
    let to_camera = mean_over_view(|x, z| (-coefficient * ((x - MIDDLE).powi(2) + z * z + 0.25).sqrt()).exp());
    let illuminance = 100.0 * (-coefficient * radius).exp() * to_camera;
    check_within("sky around fog", &scene, illuminance, (Integrator::Photon, 64), 0.02);
    check_within("sky around fog", &scene, illuminance, (Integrator::Path, 256), 0.03);
}

/// A box of absorbing fog stands on the floor. Rounding does not decide whether light at the floor
/// is in the fog, also if the scene is turned.
#[test]
fn fog_that_stands_on_a_turned_floor_attenuates_both_ways() {
    let (coefficient, height) = (0.9, 0.8);
    let turn = json!({ "rotate": { "axis": [1, 2, 3], "degrees": 33.7 } });
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let turned = |v: DVec3| DQuat::from_axis_angle(axis, 33.7_f64.to_radians()) * v;
    let to_light = DVec3::new(0.5, 1.0, -0.3).normalize();
    let box_of_fog = json!({ "shape": { "box": { "size": [6, height, 6] } }, "material": "fog",
                             "transform": [{ "translate": [0, 0.5 * height, 0] }, turn] });
    let sun =
        json!({ "directional": { "toward": turned(-to_light).to_array(), "spectrum": "D65", "illuminance": 100 } });
    let mut scene = floor(&[box_of_fog], &[sun]);
    scene["objects"][0]["transform"] = json!([turn]);
    scene["camera"] = json!({ "from": turned(DVec3::new(0.0, 3.0, 0.0)).to_array(), "at": [0, 0, 0],
                              "up": turned(DVec3::NEG_Z).to_array(), "lens": { "pinhole": { "fov": 3 } } });
    scene["media"] = fog(coefficient);
    scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
    scene["render"] = json!({ "photons": 100, "forbid": ["indirect"] });
    let illuminance = 100.0 * to_light.y * (-coefficient * height * (1.0 + to_light.y.recip())).exp();
    check("fog on a turned floor", &scene, illuminance, Integrator::Photon, 64);
}

/// A translucent floor above a lamp. Photons reach its lower side through a pane, and the camera
/// sees its upper side through a pane.
#[test]
fn photons_behind_a_translucent_sheet_shine_through_it() {
    let (transmittance, flux) = (0.45, 700.0);
    let pane = |size: f64, y: f64| {
        json!({ "shape": { "box": { "size": [size, 0.02, size] } }, "material": "clear",
                "transform": [{ "translate": [MIDDLE, y, 0] }] })
    };
    let lamp = json!({ "point": { "at": [0.2, -1.1, 0.3], "spectrum": "D65", "luminous_flux": flux } });
    let mut scene = floor(&[pane(3.0, -0.5), pane(0.5, 0.4)], &[lamp]);
    scene["materials"]["grey"] = json!({ "translucent": { "reflectance": 0.2, "transmittance": transmittance } });
    scene["render"] = json!({ "photons": 20000, "radius": 0.02 });
    let illuminance = mean_over_view(|x, z| {
        let d2 = (x - 0.2).powi(2) + 1.1_f64.powi(2) + (z - 0.3).powi(2);
        flux / (4.0 * PI) * 1.1 / d2.powf(1.5)
    });
    check_within("translucent sheet", &scene, illuminance * transmittance / ALBEDO, (Integrator::Photon, 4), 0.03);
}

/// Lamp, camera and floor are in a body of index 1 and high priority. The faces of the slabs in
/// this body are hidden, and light passes them. Shadow rays and connections stop at hidden faces.
#[test]
#[ignore = "nightly: 8 seconds of CPU time"]
fn light_passes_hidden_faces_before_and_after_a_floor() {
    let slab = |size: f64, y: f64| {
        json!({ "shape": { "box": { "size": [size, 0.02, size] } }, "material": "hidden",
                "transform": [{ "translate": [MIDDLE, y, 0] }] })
    };
    let outer = json!({ "shape": { "box": { "size": [60, 60, 60] } }, "material": "outer" });
    let point = json!({ "point": { "at": [0.2, 1.1, 0.3], "spectrum": "D65", "luminous_flux": 700 } });
    let sphere = json!({ "shape": { "sphere": { "center": [0.2, 1.1, 0.3], "radius": 0.3 } }, "material": "black",
                         "emission": { "spectrum": "D65", "luminous_flux": 700 } });
    let illuminance = mean_over_view(|x, z| {
        let d2 = (x - 0.2).powi(2) + 1.1_f64.powi(2) + (z - 0.3).powi(2);
        700.0 / (4.0 * PI) * 1.1 / d2.powf(1.5)
    });
    let inside = |objects: &[Value], lights: &[Value]| {
        let mut scene = floor(&[std::slice::from_ref(&outer), objects].concat(), lights);
        scene["materials"]["outer"] = json!({ "dielectric": { "ior": 1, "priority": 1 } });
        scene["materials"]["hidden"] = json!({ "dielectric": { "ior": 1.7 } });
        scene["render"] = json!({ "photons": 5000, "radius": 0.02 });
        scene
    };
    let (low, high) = (slab(0.6, 0.2), slab(3.0, 0.7));
    let before = inside(std::slice::from_ref(&high), std::slice::from_ref(&point));
    check_within("hidden faces before the floor", &before, illuminance, (Integrator::Photon, 4), 0.06);
    let both = inside(&[low.clone(), high.clone()], std::slice::from_ref(&point));
    check_within("hidden faces on both sides", &both, illuminance, (Integrator::Photon, 4), 0.06);
    let after = inside(std::slice::from_ref(&low), &[point]);
    check_within("hidden faces after the floor", &after, illuminance, (Integrator::Photon, 4), 0.06);
    let lit_by_sphere = inside(&[low, high, sphere], &[]);
    check_within("hidden faces, sphere", &lit_by_sphere, illuminance, (Integrator::Path, 512), 0.08);
}

#[test]
fn shared_photons_carry_a_mirrored_lamps_irradiance() {
    let (objects, lamp, illuminance) = mirrored_point();
    let mut scene = floor(&objects, &[lamp]);
    scene["render"] = json!({ "photons": 5000, "radius": 0.02, "force": ["shared"] });
    check("mirror image, shared wavelengths", &scene, illuminance, Integrator::Photon, 64);
}

/// Returns the mean over the distances from −`half` to `half` of the irradiance that a kernel
/// estimates beside the terminator of a ball. The kernel has the radius 1, and the irradiance grows
/// linearly with the distance from the terminator, with slope 1 on the lit side.
fn estimate_beside_the_terminator(half: f64) -> f64 {
    const N: u32 = 60;
    let mid = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
    let kernel = |x: f64, y: f64| 2.0 / PI * (1.0 - x * x - y * y).max(0.0) * 4.0;
    let at = |distance: f64, i: u32, j: u32| {
        let (x, y) = (2.0 * mid(i) - 1.0, 2.0 * mid(j) - 1.0);
        kernel(x, y) * (distance + x).max(0.0)
    };
    let distances = (0..N).map(|k| half * (2.0 * mid(k) - 1.0));
    distances.map(|d| (0..N * N).map(|cell| at(d, cell / N, cell % N)).sum::<f64>()).sum::<f64>() / f64::from(N).powi(3)
}

/// A ball in the light of the sun from above. The shell of index 1 makes photons carry the light.
/// The picture shows the terminator. Half of its points face away from the sun, but their kernels
/// contain photons that arrived beyond the terminator.
#[test]
fn a_kernel_across_the_terminator_of_a_ball_keeps_its_photons() {
    let (radius, half) = (0.3, 0.07_f64);
    let scene = json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "up": [0, 1, 0],
                    "lens": { "pinhole": { "fov": 2.0 * (half / 4.0).atan().to_degrees() } } },
        "film": { "width": 4, "height": 4 },
        "materials": { "grey": diffuse(ALBEDO), "clear": glass(1.0) },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "grey" },
                    { "shape": { "sphere": { "radius": 1.4 } }, "material": "clear" }],
        "lights": [{ "directional": { "toward": [0, -1, 0], "spectrum": "E", "illuminance": 100 } }],
        "render": { "photons": 60000, "radius": radius }
    });
    let illuminance = 100.0 * radius * estimate_beside_the_terminator(half / radius);
    check_within("terminator of a ball", &scene, illuminance, (Integrator::Photon, 1), 0.12);
}
