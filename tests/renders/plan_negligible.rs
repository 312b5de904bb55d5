//! Effects that a scene calls for and that the plan still leaves out: no light reaches them, or
//! their influence has a small bound.

use super::common::compare::{Measured, compare};
use super::common::{all_y, diffuse, glass, job, overhead_camera, render, with_setting};
use abbe_session::render::Integrator;
use abbe_transport::plan::EffectState;
use serde_json::{Value, json};

/// Returns the state of an effect and its reason.
fn effect(scene: &Value, name: &str) -> (EffectState, String) {
    let rows = job(scene).rows;
    let row = rows.iter().find(|row| row.effect.name == name).unwrap();
    (row.state, row.because.clone())
}

#[track_caller]
pub(crate) fn is(scene: &Value, name: &str, state: EffectState, words: &str) {
    let (found, because) = effect(scene, name);
    assert!(found == state && because.contains(words), "{name} is {}: {because}", found.word());
}

/// A floor seen from above.
fn floor(objects: &[Value], lights: Value) -> Value {
    let mut all =
        vec![json!({ "name": "floor", "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey" })];
    all.extend_from_slice(objects);
    json!({
        "camera": overhead_camera([0.0, 0.0], 4.0, 2.0),
        "film": { "width": 12, "height": 12 },
        "materials": { "grey": diffuse(0.5), "flint": glass("N-SF10") },
        "objects": all,
        "lights": lights,
        "render": { "photons": 4000 }
    })
}

fn lamp(spectrum: Value) -> Value {
    json!([{ "point": { "at": [0.3, 3, 0.2], "spectrum": spectrum, "luminous_intensity": 1 } }])
}

fn ball(material: &str, centre: [f64; 3], radius: f64) -> Value {
    json!({ "name": "ball", "shape": { "sphere": { "center": centre, "radius": radius } }, "material": material })
}

#[test]
#[ignore = "nightly: 19 seconds of CPU time"]
fn glass_in_light_of_one_wavelength_needs_no_dispersion() {
    let line = |width: f64| lamp(json!({ "lines": [{ "nm": 589.3, "power": 1, "fwhm_nm": width }] }));
    let with = |lights| floor(&[ball("flint", [0.0, 0.5, 0.0], 0.4)], lights);
    is(&with(line(1e-3)), "dispersion", EffectState::Off, "all light is within 589.299–589.30");
    is(&with(line(1.0)), "dispersion", EffectState::On, "ball");
    is(&with(lamp(json!("D65"))), "dispersion", EffectState::On, "ball");
    // The glass refracts by its index at that line, so the caustic does not move: forced or not,
    // the picture is the same.
    let scene = with(line(1e-3));
    let forced = with_setting(&scene, "force", json!(["dispersion"]));
    is(&forced, "dispersion", EffectState::Forced, "forced by name");
    let [plain, forced] = [scene, forced].map(|scene| Measured::new(&scene, (Integrator::Photon, 16), 0..6, all_y));
    let found = compare(&plain, &forced);
    println!("dispersion of one line, forced: {found}");
    assert!(found.is_equal(), "{found}");
}

#[test]
fn what_is_shut_in_an_opaque_body_calls_for_nothing() {
    let safe = |material: &str| {
        json!({ "name": "safe", "shape": { "box": { "size": [1, 1, 1] } }, "material": material,
                                        "transform": [{ "rotate": { "axis": [0, 1, 0], "degrees": 30 } }, { "translate": [0, 0.6, 0] }] })
    };
    let shut = |material, centre| floor(&[safe(material), ball("flint", centre, 0.2)], lamp(json!("D65")));
    let scene = shut("grey", [0.0, 0.6, 0.0]);
    for name in ["dispersion", "caustics", "aim"] {
        is(&scene, name, EffectState::Off, "enclosed: ball in safe");
    }
    is(&shut("grey", [0.0, 0.6, 0.45]), "caustics", EffectState::On, "ball");
    is(&shut("flint", [0.0, 0.6, 0.0]), "caustics", EffectState::On, "safe");
    let lit = json!([{ "point": { "at": [0.3, 0.6, 0.2], "spectrum": "D65", "luminous_intensity": 1 } }]);
    is(&floor(&[safe("grey"), ball("flint", [0.0, 0.6, 0.0], 0.2)], lit), "caustics", EffectState::On, "ball");
    let mut seen = scene;
    seen["camera"] = json!({ "from": [0.3, 0.6, 0.2], "at": [0, 0.6, 0], "lens": { "pinhole": { "fov": 40 } } });
    is(&seen, "caustics", EffectState::On, "ball");
}

#[test]
fn a_lens_that_blurs_nothing_by_half_a_pixel_is_a_pinhole() {
    // A pixel covers a sixth of a metre of the floor, 4 m away. Focused at infinity, a lens blurs a
    // point by its own diameter.
    let with = |objects: &[Value], radius: f64| {
        let mut scene = floor(objects, lamp(json!("D65")));
        let degrees = 2.0 * (radius / 400.0_f64).atan().to_degrees();
        let fov = scene["camera"]["lens"]["pinhole"]["fov"].clone();
        scene["camera"]["lens"] = json!({ "thin": { "fov": fov, "focus_distance": 400, "defocus_angle": degrees } });
        scene
    };
    is(&with(&[], 0.03), "depth-of-field", EffectState::Off, "0.5 are allowed");
    is(&with(&[], 0.06), "depth-of-field", EffectState::On, "aperture");
    // Closer objects are blurred more. A lens in the scene may show an object as if it were closer
    // than any.
    is(&with(&[ball("grey", [0.0, 2.0, 0.0], 0.4)], 0.03), "depth-of-field", EffectState::On, "aperture");
    is(&with(&[ball("flint", [0.0, 0.4, 0.0], 0.1)], 0.03), "depth-of-field", EffectState::On, "aperture");
}

/// Two lines 0.1 nm apart fall through a prism onto a wall 20 m away. A macro camera close to the
/// wall resolves them.
#[test]
fn close_lines_on_a_long_arm_need_dispersion() {
    let two_lines = json!({ "lines": [{ "nm": 589.25, "power": 1, "fwhm_nm": 0.001 }, { "nm": 589.35, "power": 1, "fwhm_nm": 0.001 }] });
    let wall_at = |arm: f64, distance: f64| {
        let mut scene = floor(&[ball("flint", [0.0, arm, 0.0], 0.05)], lamp(two_lines.clone()));
        scene["camera"] =
            json!({ "from": [0, distance, 0], "at": [0, 0, 0], "up": [0, 0, 1], "lens": { "pinhole": { "fov": 20 } } });
        scene
    };
    is(&wall_at(20.0, 0.02), "dispersion", EffectState::On, "ball");
    is(&wall_at(1.0, 0.5), "dispersion", EffectState::On, "ball");
}

/// The image in a concave metal may be nearer to the camera than any surface.
#[test]
fn depth_of_field_is_simulated_if_a_polished_metal_forms_images() {
    let metal = json!({ "conductor": { "metal": "silver", "roughness": 0.05 } });
    let mut scene = floor(&[ball("metal", [0.0, 0.4, 0.0], 0.1)], lamp(json!("D65")));
    scene["materials"]["metal"] = metal;
    let degrees = 2.0 * (0.03 / 400.0_f64).atan().to_degrees();
    let fov = scene["camera"]["lens"]["pinhole"]["fov"].clone();
    scene["camera"]["lens"] = json!({ "thin": { "fov": fov, "focus_distance": 400, "defocus_angle": degrees } });
    is(&scene, "depth-of-field", EffectState::On, "aperture");
}

#[test]
fn fog_and_glass_too_thin_to_be_seen_are_left_out() {
    let with = |absorption: f64, scattering: f64, depth: Value| {
        let fog = json!({ "name": "cloud", "shape": { "box": { "size": [1, 1, 1] } }, "material": "fog", "transform": [{ "translate": [0, 1, 0] }] });
        let mut scene = floor(&[fog], lamp(json!("D65")));
        scene["media"] = json!({ "fog": { "homogeneous": { "absorption": absorption, "scattering": scattering, "phase": "isotropic" } } });
        scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
        if !depth.is_null() {
            scene["render"]["max_depth"] = depth;
        }
        scene
    };
    // The longest segment through the box is √3 m, and a path has at most 10,001 segments.
    is(&with(5.7e-8, 0.0, Value::Null), "media", EffectState::Off, "9.9e-4 of its light");
    is(&with(5.8e-8, 0.0, Value::Null), "media", EffectState::On, "cloud");
    is(&with(5.7e-5, 0.0, json!(9)), "media", EffectState::Off, "9.9e-4 of its light");
    // Thin fog is visible in front of a black background.
    is(&with(0.0, 1e-9, Value::Null), "media", EffectState::On, "cloud");
    let glass = |absorption: f64| {
        let mut scene = floor(&[ball("bottle", [0.0, 0.5, 0.0], 0.5)], lamp(json!("D65")));
        scene["materials"]["bottle"] = json!({ "dielectric": { "ior": 1.5, "absorption": absorption } });
        scene
    };
    is(&glass(5.7e-8), "absorption", EffectState::Off, "9.9e-4 of its light");
    is(&glass(5.8e-8), "absorption", EffectState::On, "ball");
}

#[test]
fn negligible_effects_can_be_forced_and_forbidden() {
    let fog = json!({ "name": "cloud", "shape": { "box": { "size": [1, 1, 1] } }, "material": "fog", "transform": [{ "translate": [0, 1, 0] }] });
    let mut scene = floor(&[fog], lamp(json!("D65")));
    scene["media"] = json!({ "fog": { "homogeneous": { "absorption": 1e-9, "scattering": 0, "phase": "isotropic" } } });
    scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
    let forced = render(&with_setting(&scene, "force", json!(["media"])), Integrator::Photon, 1);
    assert!(forced.stats.effects["media"].events > 0 && forced.stats.effects["media"].state == "forced");
    let forbidden = with_setting(&scene, "forbid", json!(["media"]));
    is(&forbidden, "media", EffectState::Off, "of its light");
    assert!(job(&forbidden).scene.notes.iter().all(|note| !note.contains("lacks")));
}
