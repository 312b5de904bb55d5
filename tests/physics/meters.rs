//! Meters against closed forms, against the camera, and against rays traced by hand.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{example, render};
use abbe_format::resolve::resolve_meters;
use abbe_format::{FileAccess, parse_with_access};
use abbe_session::render::{Integrator, Job, MeasurementReport, NoMonitor, PointReport, StopRules, Value, on_threads};
use serde_json::{Value as Json, json};
use std::f64::consts::PI;
use std::path::Path;

fn job(scene: &Json) -> Job {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/scene.json");
    let (file, source) = parse_with_access(scene.to_string(), &folder, &[], FileAccess::default()).unwrap();
    Job::new(resolve_meters(&file, &source).unwrap()).unwrap()
}

pub(crate) fn measure(scene: &Json, integrator: Option<Integrator>, passes: u64) -> MeasurementReport {
    measure_until(scene, integrator, StopRules { passes: Some(passes), ..StopRules::default() })
}

pub(crate) fn measure_until(scene: &Json, integrator: Option<Integrator>, stop: StopRules) -> MeasurementReport {
    job(scene).measure(integrator, stop, &mut NoMonitor).unwrap().0
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Number(number) => *number,
        Value::Spectrum(_) => panic!("a spectrum"),
    }
}

/// The value, its noise and its bias.
fn reading(point: &PointReport) -> [f64; 3] {
    let of = |value: &Option<Value>| value.as_ref().map_or(0.0, number);
    [number(&point.value), of(&point.noise), of(&point.bias)]
}

/// All points of all meters.
pub(crate) fn readings(report: &MeasurementReport) -> Vec<[f64; 3]> {
    report.meters.iter().flat_map(|meter| meter.points.iter().map(reading)).collect()
}

/// An area lamp over points on black ground: each kind of receptor has a closed form for a lamp
/// that is small compared with its distance.
#[test]
#[ignore = "nightly: 4 seconds of CPU time"]
fn planes_spheres_cylinders_and_spots_have_their_closed_forms() {
    let at = |form: Json| {
        let mut meter = form;
        meter["name"] = json!("meter");
        json!({
            "objects": [],
            "lights": [{"point": {"at": [3, 4, 0], "spectrum": "E", "luminous_intensity": 100}}],
            "meters": [meter],
            "render": {"photons": 1000}
        })
    };
    let (distance2, to) = (25.0, [0.6, 0.8]);
    let cases = [
        (json!({"points": [[0, 0, 0]]}), 100.0 / distance2 * to[1]),
        (json!({"points": [[0, 0, 0]], "normal": [1, 0, 0]}), 100.0 / distance2 * to[0]),
        (json!({"points": [[0, 0, 0]], "normal": [0, -1, 0]}), 0.0),
        (json!({"sphere": {"at": [0, 0, 0]}}), 0.25 * 100.0 / distance2),
        (json!({"cylinder": {"at": [0, 0, 0]}}), 100.0 / distance2 * to[0] / PI),
        // A lamp without extent in the cone: its illuminance, divided by the solid angle.
        (
            json!({"spot": {"from": [0, 0, 0], "to": [3, 4, 0], "angle": 2}}),
            100.0 / distance2 / (2.0 * PI * (1.0 - 1.0_f64.to_radians().cos())),
        ),
    ];
    for integrator in [Integrator::Path, Integrator::Photon] {
        for (form, expected) in &cases {
            let [value, noise, _] = readings(&measure(&at(form.clone()), Some(integrator), 16))[0];
            assert!((value - expected).abs() <= 4.0 * noise + 1e-9 * expected, "{form}: {value} for {expected}");
            assert!(noise <= 1e-3 * expected, "{form}: noise {noise}");
        }
    }
}

/// The luminance of a diffuse plane times π, divided by its reflectance, is the illuminance that a
/// meter on the plane reads.
#[test]
#[ignore = "takes a minute: photons and paths to a small error"]
fn a_meter_agrees_with_the_camera() {
    const REFLECTANCE: f64 = 0.6;
    let mut scene = json!({
        "camera": {"from": [0, 2, 0.01], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 1}}},
        "film": {"width": 1, "height": 1},
        "materials": {"grey": {"diffuse": {"reflectance": REFLECTANCE}}, "white": {"diffuse": {"reflectance": 0.8}}},
        "objects": [
            {"name": "floor", "shape": {"rectangle": {"width": 4, "height": 4}}, "material": "grey"},
            {"name": "wall", "shape": {"rectangle": {"width": 4, "height": 2}}, "material": "white",
             "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, 1, -1]}]}
        ],
        "lights": [{"point": {"at": [1, 1.5, 0.5], "spectrum": "D65", "luminous_flux": 1000}}]
    });
    let rendered = render(&scene, Integrator::Path, 1024);
    let (luminance, noise) = (rendered.picture.xyz[0][1], f64::from(rendered.picture.noise[0].unwrap()));
    scene["meters"] = json!([{"name": "floor", "points": [[0, 0, 0]]}]);
    for integrator in [Integrator::Path, Integrator::Photon] {
        let [value, of_meter, bias] = readings(&measure(&scene, Some(integrator), 32))[0];
        let (camera, of_camera) = (luminance * PI / REFLECTANCE, noise * PI / REFLECTANCE);
        let z = (value - camera) / (of_meter.hypot(of_camera) + bias);
        assert!(z.abs() < 3.5, "{value} and {camera}: z = {z}");
    }
}

/// Parallel light falls along −y through a glass ball onto black ground. The illuminance at a
/// distance from the axis follows from rays that this test refracts itself.
#[test]
#[ignore = "takes a minute: many photons through a ball"]
fn a_meter_reads_the_caustic_of_a_glass_ball() {
    const N: f64 = 1.5;
    const RADIUS: f64 = 0.5;
    const HEIGHT: f64 = 0.9;
    const LUX: f64 = 1000.0;
    let landing = |h: f64| {
        let (outside, inside) = ((h / RADIUS).asin(), (h / (RADIUS * N)).asin());
        // Each face turns the ray by the difference of the angles.
        let (first, last) = (outside - inside, 2.0 * (outside - inside));
        let chord = 2.0 * RADIUS * inside.cos();
        let x = h - chord * first.sin();
        let y = HEIGHT + (RADIUS * RADIUS - h * h).sqrt() - chord * first.cos();
        let s = ((outside - inside).sin() / (outside + inside).sin()).powi(2);
        let p = ((outside - inside).tan() / (outside + inside).tan()).powi(2);
        (x - y * last.tan(), 0.5 * ((1.0 - s).powi(2) + (1.0 - p).powi(2)))
    };
    // The light between two neighbouring rays falls on the ring between their landing points.
    let expected = |r: f64| {
        let steps = 200_000;
        let width = 0.004;
        let (mut flux, area) = (0.0, PI * ((r + width).powi(2) - (r - width).powi(2)));
        for i in 0..steps {
            let h = (f64::from(i) + 0.5) / f64::from(steps) * RADIUS * 0.999_99;
            let (x, transmitted) = landing(h);
            if (x.abs() - r).abs() < width {
                flux += LUX * transmitted * 2.0 * PI * h * RADIUS * 0.999_99 / f64::from(steps);
            }
        }
        flux / area
    };
    let distances = [0.04, 0.08, 0.12];
    let points: Vec<Json> = distances.iter().map(|r| json!([r, 0, 0])).collect();
    let scene = json!({
        "materials": {"glass": {"dielectric": {"ior": N}}, "black": {"diffuse": {"reflectance": 0}}},
        "objects": [
            {"name": "ball", "shape": {"sphere": {"center": [0, HEIGHT, 0], "radius": RADIUS}}, "material": "glass"},
            {"name": "ground", "shape": {"rectangle": {"width": 20, "height": 20}}, "material": "black"}
        ],
        "lights": [{"directional": {"toward": [0, -1, 0], "spectrum": "D65", "illuminance": LUX}}],
        "meters": [{"name": "caustic", "points": points}],
        // Black ground sends no paths to the ball, so a few samples of the receptors are enough.
        "render": {"photons": 100_000, "camera_samples": 16}
    });
    let report = measure(&scene, None, 64);
    assert_eq!(report.integrator, "photon");
    for (r, point) in distances.into_iter().zip(&report.meters[0].points) {
        let ([value, noise, bias], expected) = (reading(point), expected(r));
        println!("{r}: {value} ± {noise} ± {bias} for {expected}");
        assert!((value - expected).abs() < 4.0 * noise + 2.0 * bias + 0.02 * expected, "{r}: {value} for {expected}");
        assert!(noise + bias < 0.06 * expected, "{r}: noise {noise}, bias {bias}");
    }
}

/// The flux through surfaces: a lamp in a closed black box, and parallel light through a glass ball
/// onto the ground, by both integrators that find the light.
#[test]
fn surfaces_receive_the_flux_of_their_lamps() {
    let scene = json!({
        "materials": {"black": {"diffuse": {"reflectance": 0}}},
        "objects": [{"name": "box", "shape": {"box": {"size": [2, 3, 4]}}, "material": "black"}],
        "lights": [{"point": {"at": [0.3, 0.2, -0.5], "spectrum": "D65", "luminous_flux": 800}}],
        "meters": [
            {"name": "inside", "quantity": "luminous_flux", "surface": "box", "side": "back"},
            {"name": "outside", "quantity": "luminous_flux", "surface": "box", "side": "front"},
            {"name": "mean", "surface": "box"}
        ]
    });
    let report = measure(&scene, None, 64);
    let [inside, outside, mean] = readings(&report)[..] else { panic!("three readings") };
    assert!((inside[0] - 800.0).abs() < 4.0 * inside[1] && inside[1] < 4.0, "{inside:?}");
    assert_eq!(outside[0], 0.0);
    let point = &report.meters[2].points[0];
    assert!((point.area_m2.unwrap() - 52.0).abs() < 1e-9);
    assert!((mean[0] * 52.0 / 800.0 - 1.0).abs() < 0.02 && (point.flux.unwrap() / mean[0] - 52.0).abs() < 1e-9);
}

/// The readings do not depend on the number of threads, and photons agree with paths in a daylit
/// room with a pane.
#[test]
#[ignore = "takes a minute: a daylit room by both integrators"]
fn readings_are_deterministic_and_both_integrators_agree() {
    let mut scene = example("daylit_room");
    scene["render"] = json!({"photons": 50_000, "camera_samples": 64});
    let once = |threads| on_threads(Some(threads), || measure(&scene, None, 8)).unwrap();
    let (one, two) = (once(1), once(3));
    assert_eq!(one.meters, two.meters);
    let photon = measure(&scene, Some(Integrator::Photon), 32);
    let path = measure(&scene, Some(Integrator::Path), 64);
    for (a, b) in readings(&photon).into_iter().zip(readings(&path)) {
        let z = (a[0] - b[0]) / (a[1].hypot(b[1]) + a[2]);
        assert!(z.abs() < 4.0, "{a:?} and {b:?}: z = {z}");
    }
}

/// A point on the inside of a sphere may miss the light that a glass ball focuses there. A point on
/// a flat floor, or on the outside of a sphere, does not.
#[test]
fn points_in_hollows_are_noted() {
    let scene = |at: [f64; 3], normal: [f64; 3]| {
        json!({
            "materials": {"glass": {"dielectric": {"ior": 1.5}}, "grey": {"diffuse": {"reflectance": 0.5}}},
            "objects": [
                {"name": "ball", "shape": {"sphere": {"radius": 0.2}}, "material": "glass"},
                {"name": "bowl", "shape": {"sphere": {"radius": 1}}, "material": "grey"},
                {"name": "room", "shape": {"box": {"size": [4, 4, 4]}}, "material": "grey"}
            ],
            "lights": [{"point": {"at": [0, 0.5, 0], "spectrum": "E", "luminous_flux": 1000}}],
            "meters": [{"name": "point", "points": [at], "normal": normal}],
            "render": {"photons": 1000, "camera_samples": 1}
        })
    };
    let notes = |at, normal| measure(&scene(at, normal), Some(Integrator::Photon), 8).notes.join("\n");
    let inside = notes([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]);
    assert!(inside.contains("hollow surface bowl"), "{inside}");
    for (at, normal) in [([0.0, -2.0, 0.0], [0.0, 1.0, 0.0]), ([0.0, -1.0, 0.0], [0.0, -1.0, 0.0])] {
        let other = notes(at, normal);
        assert!(!other.contains("hollow"), "{other}");
    }
}

/// A screen whose holes are a mixture of paint and of a pane with the index 1, as importers make of
/// masks: shadow rays pass through the holes. A meter that no light reaches has no interval.
#[test]
fn light_through_a_screen_with_holes_is_measured() {
    let hole = json!({ "thin_dielectric": { "ior": 1.0 } });
    let scene = |lights: Json, point: [f64; 3]| {
        json!({
            "materials": { "paint": { "diffuse": { "reflectance": 0.5 } }, "hole": hole,
                           "screen": { "mix": [{ "material": "paint", "weight": 1 }, { "material": "hole", "weight": 3 }] } },
            "objects": [{ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "screen" }],
            "lights": [lights], "meters": [{ "name": "m", "points": [point] }], "render": { "photons": 1000 }
        })
    };
    let sun = json!({ "directional": { "toward": [0, -1, 0], "spectrum": 1, "illuminance": 100 } });
    let lamp = json!({ "point": { "at": [0.5, 1, 0], "spectrum": 1, "luminous_intensity": 400 } });
    for light in [&sun, &lamp] {
        let report = measure_until(&scene(light.clone(), [0.5, -1.0, 0.0]), None, StopRules::default());
        let point = &report.meters[0].points[0];
        let [low, high] = point.interval_95.as_ref().expect("an interval").each_ref().map(number);
        println!("through holes: {:?} in [{low}, {high}]", point.value);
        assert!((number(&point.value) / 75.0 - 1.0).abs() < 0.02 && low <= 75.0 && 75.0 <= high, "{point:?}");
    }
    let above = measure(&scene(sun, [0.5, 1.0, 0.0]), Some(Integrator::Path), 4);
    let [value, ..] = readings(&above)[0];
    assert!(value > 99.0, "{value}");
    let lamp_below = json!({ "point": { "at": [0.5, -3, 0], "spectrum": 1, "luminous_intensity": 400 } });
    let dark = &measure(&scene(lamp_below, [0.5, 1.0, 0.0]), Some(Integrator::Path), 4).meters[0].points[0];
    assert!(number(&dark.value) == 0.0 && dark.interval_95.is_none(), "{dark:?}");
}

/// The light of a lamp with a radius of 3 mm through a ball of glass: by hand, 3.019 W on the way
/// around the ball and 0.282 W through it. The default integrator finds it.
#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn a_small_lamp_shines_through_a_ball_of_glass() {
    let scene = json!({
        "materials": { "floor": { "diffuse": { "reflectance": 0.6 } }, "glass": { "dielectric": { "ior": 1.5 } },
                       "lamp": { "diffuse": { "reflectance": 0 } } },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "floor" },
            { "shape": { "sphere": { "radius": 0.3 } }, "material": "glass", "transform": [{ "translate": [0, 0.8, 0] }] },
            { "shape": { "sphere": { "radius": 0.003 } }, "material": "lamp", "emission": { "spectrum": "E", "power": 20 },
              "transform": [{ "translate": [0, 2, 0] }] }
        ],
        "meters": [{ "name": "floor", "surface": "floor", "quantity": "radiant_flux" }]
    });
    assert_eq!(job(&scene).integrator_for_meters(), Integrator::Photon);
    let value = readings(&measure(&scene, None, 8))[0][0];
    assert!((value / 3.301 - 1.0).abs() < 0.01, "{value}");
    let by_paths = measure(&scene, Some(Integrator::Path), 8);
    assert!(by_paths.meters[0].points[0].interval_95.is_none(), "paths seldom find the lamp: {by_paths:?}");
}

/// Two parallel panes under the sun: shadow rays do not find the light that is reflected back and
/// forth between them, and the interval contains it.
#[test]
fn the_interval_contains_the_light_between_two_panes() {
    let pane = |height: f64| json!({ "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "pane", "transform": [{ "translate": [0, height, 0] }] });
    let scene = json!({
        "materials": { "pane": { "thin_dielectric": { "ior": 1.5 } } },
        "objects": [pane(1.0), pane(1.2)],
        "lights": [{ "directional": { "toward": [0, -1, 0], "spectrum": 1, "illuminance": 100 } }],
        "meters": [{ "name": "m", "points": [[0, 0, 0]] }], "render": { "photons": 1000 }
    });
    // Each pane reflects R = 2r/(1 + r) for the reflectance r of a face, and n panes transmit
    // 1/(1 + n R/(1 − R)).
    let (r, panes) = (0.04, 2.0);
    let reflected = 2.0 * r / (1.0 + r);
    let known = 100.0 / (1.0 + panes * reflected / (1.0 - reflected));
    let report = measure(&scene, Some(Integrator::Path), 16);
    let point = &report.meters[0].points[0];
    let [low, high] = point.interval_95.as_ref().expect("an interval").each_ref().map(number);
    println!("two panes: {:?} in [{low}, {high}] for {known}", point.value);
    assert!(low <= known && known <= high && high - low < 0.05 * known, "{point:?} for {known}");
}
