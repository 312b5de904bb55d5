//! The unified glare rating (UGR) against values that numpy computed by quadrature over the
//! luminaires, with the position index of each point.

use crate::meters::measure;
use abbe_format::resolve::resolve_meters;
use abbe_format::{FileAccess, parse_with_access};
use abbe_session::render::{Integrator, Job, NoMonitor, PointReport, StopRules, Value};
use serde_json::{Value as Json, json};
use std::path::Path;

/// Returns the value and the ends of the interval.
fn numbers(point: &PointReport) -> [f64; 3] {
    let number = |value: &Value| match value {
        Value::Number(number) => *number,
        Value::Spectrum(_) => panic!("a spectrum"),
    };
    let [low, high] = point.interval_95.as_ref().expect("an interval").each_ref().map(number);
    [number(&point.value), low, high]
}

/// Prepares a scene whose files lie in a folder.
fn job_in(folder: &Path, scene: &Json) -> Job {
    let path = folder.join("scene.json");
    let (file, source) =
        parse_with_access(scene.to_string(), &path, &[], FileAccess::default()).expect("the scene is valid");
    let scene = resolve_meters(&file, &source).expect("the files of the scene are valid");
    Job::new(scene).expect("the scene has light")
}

fn lamp(name: &str, shape: Json, luminance: f64, transform: Json) -> Json {
    json!({
        "name": name, "shape": shape, "material": "black", "transform": transform,
        "emission": {"spectrum": "A", "luminance": luminance}
    })
}

/// A lamp that faces down.
fn ceiling_lamp(name: &str, [width, height]: [f64; 2], luminance: f64, at: [f64; 3]) -> Json {
    let turned = json!([{"rotate": {"axis": [1, 0, 0], "degrees": 180}}, {"translate": at}]);
    lamp(name, json!({"rectangle": {"width": width, "height": height}}), luminance, turned)
}

fn ball(name: &str, center: [f64; 3], radius: f64, luminance: f64) -> Json {
    lamp(name, json!({"sphere": {"center": center, "radius": radius}}), luminance, json!([]))
}

/// The rating of [`office`].
const RATING: f64 = 20.963_2;

/// The illuminance at the eye in [`office`], in lx.
const LX: f64 = 205.012_8;

/// Two ceiling lamps, a ball above and a ball below the line of sight, a ceiling lamp behind a
/// plate, and a lamp behind the eye, in surroundings of 40 cd/m².
fn office() -> Json {
    json!({
        "materials": {"black": {"diffuse": {"reflectance": 0}}},
        "objects": [
            ceiling_lamp("A", [1.2, 0.3], 3000.0, [2.5, 2.8, 0.6]),
            ceiling_lamp("B", [0.6, 0.6], 2000.0, [4.0, 2.8, -2.2]),
            ceiling_lamp("hidden", [0.6, 0.6], 9000.0, [3.0, 2.8, -0.3]),
            ceiling_lamp("behind", [0.6, 0.6], 9000.0, [-2.0, 2.8, 0.0]),
            ball("C", [3.0, 1.9, 1.5], 0.1, 5000.0),
            ball("D", [1.5, 0.9, -0.5], 0.05, 4000.0),
            {"name": "plate", "shape": {"rectangle": {"width": 0.6, "height": 0.6}}, "material": "black",
             "transform": [{"rotate": {"axis": [0, 0, 1], "degrees": 90}}, {"translate": [1.5, 2.0, -0.15]}]}
        ],
        "lights": [{"environment": {"spectrum": "D65", "luminance": 40}}],
        "meters": [
            {"name": "glare", "quantity": "ugr", "points": [[0, 1.2, 0]], "normal": [1, 0, 0]},
            {"name": "light", "points": [[0, 1.2, 0]], "normal": [1, 0, 0]}
        ]
    })
}

#[test]
fn glare_ratings_agree_with_a_quadrature() {
    for integrator in [Integrator::Path, Integrator::Photon] {
        let report = measure(&office(), Some(integrator), 8);
        let [rating, low, high] = numbers(&report.meters[0].points[0]);
        assert!((rating - RATING).abs() < 0.02, "{integrator:?}: {rating} for {RATING}");
        assert!(low < rating && rating < high && high - low < 0.05, "{low} to {high}");
        assert_eq!(report.meters[0].uniformity, None);
        let [lx, ..] = numbers(&report.meters[1].points[0]);
        assert!((lx / LX - 1.0).abs() < 2e-3, "{lx} for {LX}");
    }
}

/// The interval of the rating follows from the noise of the background.
#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn intervals_of_glare_ratings_contain_the_quadrature() {
    let mut scene = office();
    let covered = (0..40).filter(|seed| {
        scene["render"] = json!({"seed": seed, "camera_samples": 16});
        let [_, low, high] = numbers(&measure(&scene, None, 8).meters[0].points[0]);
        (low..=high).contains(&RATING)
    });
    let covered = covered.count();
    assert!((34..=40).contains(&covered), "{covered} of 40");
}

/// A luminaire file with a small luminous opening of area A: L = I/(A cos γ) and ω = A cos γ/r².
#[test]
fn a_luminaire_file_has_the_glare_of_its_intensity_and_opening() {
    const BACKGROUND: f64 = 40.0;
    let file = "IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 -1 1 4 1 1 2 0.2 0.2 0\n1 1 10\n\
                0 30 60 90\n0\n1000 800 400 0\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.ies"), file).unwrap();
    let luminaire = json!({
        "ies": {"at": [4, 2.8, 0], "toward": [0, -1, 0], "path": "lamp.ies", "area": true, "spectrum": "A"}
    });
    let scene = json!({
        "objects": [],
        "lights": [{"environment": {"spectrum": "D65", "luminance": BACKGROUND}}, luminaire],
        "meters": [{"name": "glare", "quantity": "ugr", "points": [[0, 1.2, 0]], "normal": [1, 0, 0]}]
    });
    let (height, r2) = (1.6_f64, 18.56_f64);
    let cosine = height / r2.sqrt();
    let intensity = 400.0 * (90.0 - cosine.acos().to_degrees()) / 30.0;
    let sigma = (height / 4.0).atan().to_degrees();
    let position_index = ((35.2 - 1.22) * 1e-3 * sigma + 21e-5 * sigma * sigma).exp();
    let glare = intensity.powi(2) / (0.04 * cosine * r2 * position_index.powi(2));
    let expected = 8.0 * (0.25 / BACKGROUND * glare).log10();
    for integrator in [Integrator::Path, Integrator::Photon] {
        let stop = StopRules { passes: Some(8), ..StopRules::default() };
        let (report, _) = job_in(folder.path(), &scene).measure(Some(integrator), stop, &mut NoMonitor).unwrap();
        let [rating, ..] = numbers(&report.meters[0].points[0]);
        assert!((rating - expected).abs() < 0.02, "{integrator:?}: {rating} for {expected}");
    }
}

/// Without visible luminaires, the rating has no value.
#[test]
fn no_luminaire_gives_no_glare_rating() {
    let mut scene = office();
    scene["meters"][0]["normal"] = json!([0, -1, 0]);
    scene["meters"][0]["points"] = json!([[0, 0.2, 0]]);
    let report = measure(&scene, None, 8);
    let point = &report.meters[0].points[0];
    assert!(matches!(point.value, Value::Number(number) if number.is_nan()), "{point:?}");
    assert_eq!(point.interval_95, None);
}

/// The luminance of a lamp without a luminous surface is infinite.
#[test]
fn luminaires_without_luminous_surface_are_errors() {
    let mut scene = office();
    let lamp = json!({"point": {"at": [2, 2, 0], "spectrum": "E", "luminous_intensity": 10}});
    scene["lights"].as_array_mut().unwrap().push(lamp);
    let stop = StopRules { passes: Some(1), ..StopRules::default() };
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let error = job_in(&scenes, &scene).measure(None, stop, &mut NoMonitor).unwrap_err().to_string();
    assert!(error.contains("has no luminous surface"), "{error}");
}
