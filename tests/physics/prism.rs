//! The deviation of each colour by a prism: the centroid of the rendered spot against Snell's law,
//! computed independently (golden/prism.json).

use crate::common::{diffuse, glass, render};
use abbe_session::render::Integrator;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// The side of the prism, the distance from its exit face to the screen, the visible width of the
/// screen and the radius of the beam, in m.
const SIDE: f64 = 0.2;
const THROW: f64 = 2.0;
const VIEW: f64 = 0.024;
const BEAM: f64 = 0.004;

/// Pixels across the view: 1 mm or 0.029° each, seen from the prism. The spot covers about six. Its
/// centroid is known far better.
const PIXELS: u32 = 24;

/// A beam's path in the prism's cross-section (x, y), with the apex up and the centroid at the
/// origin.
struct Way {
    from: DVec2,
    entry: DVec2,
    exit: DVec2,
    /// The direction behind the prism, from the golden deviation.
    out: DVec2,
}

fn way(apex_deg: f64, incidence_deg: f64, n: f64, deviation_deg: f64) -> Way {
    let half = 0.5 * apex_deg.to_radians();
    // The legs meet at the apex, 2/3 of the height above the centroid. The beam comes from the left
    // and enters the middle of the left leg, or a higher point if it would otherwise hit the base.
    let height = SIDE * half.cos();
    let apex = DVec2::new(0.0, height * 2.0 / 3.0);
    let [left, right] = [-1.0, 1.0].map(|side| DVec2::new(side * half.sin(), -half.cos()));
    let entry = apex + left * (0.25 * SIDE);
    let normal = DVec2::new(-half.cos(), half.sin());
    // Angles of incidence are positive towards the base: the beam comes from below the normal.
    let turn = |v: DVec2, angle: f64| DVec2::from_angle(angle).rotate(v);
    let way_in = turn(-normal, incidence_deg.to_radians());
    let inside = turn(-normal, (incidence_deg.to_radians().sin() / n).asin());
    // Deviation is towards the base, which is clockwise here.
    let out = turn(way_in, -deviation_deg.to_radians());
    // Solves entry + t·inside = apex + s·right.
    let to_apex = apex - entry;
    let t = to_apex.perp_dot(right) / inside.perp_dot(right);
    Way { from: entry - way_in * 0.2, entry, exit: entry + inside * t, out }
}

fn spot_scene(name: &str, apex_deg: f64, wavelength_nm: f64, way: &Way) -> Value {
    let at = |v: DVec2| [v.x, v.y, 0.0];
    let middle = way.exit + way.out * THROW;
    // The screen's +y faces the prism: rotate +y to −out about z.
    let turn = (-way.out).to_angle().to_degrees() - 90.0;
    json!({
        "camera": { "from": at(middle - way.out * 0.5), "at": at(middle), "up": [0, 0, 1],
                    "lens": { "pinhole": { "fov": 2.0 * (VIEW / 2.0 / 0.5_f64).atan().to_degrees() } } },
        "film": { "width": PIXELS, "height": PIXELS },
        "materials": { "glass": glass(name), "white": diffuse(0.8) },
        "objects": [
            { "shape": { "prism": { "side": SIDE, "length": 0.2, "apex": apex_deg } }, "material": "glass" },
            { "shape": { "rectangle": { "width": 0.1, "height": 0.1 } }, "material": "white",
              "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": turn } }, { "translate": at(middle) } ] }
        ],
        "lights": [ { "beam": { "from": at(way.from), "to": at(way.entry), "radius": BEAM, "power": 1,
                                "spectrum": { "lines": [ { "nm": wavelength_nm, "power": 1 } ] } } } ],
        "render": { "photons": 2000, "forbid": ["aim"] }
    })
}

/// Returns the angle in degrees, seen from the exit point of the beam, between the spot's centroid
/// and the middle of the screen, in the plane of the cross-section and across it.
fn offset_deg(scene: &Value) -> [f64; 2] {
    let rendered = render(scene, Integrator::Photon, 1);
    let mut sum = 0.0;
    let mut moment = DVec2::ZERO;
    for (index, xyz) in rendered.picture.xyz.iter().enumerate() {
        let weight: f64 = xyz.iter().sum();
        let place = DVec2::new(f64::from(index as u32 % PIXELS), f64::from(index as u32 / PIXELS)) + 0.5;
        sum += weight;
        moment += weight * (place / f64::from(PIXELS) - 0.5) * VIEW;
    }
    assert!(sum > 0.0, "the spot is not in view");
    (moment / sum).to_array().map(|metres| (metres / THROW).atan().to_degrees())
}

/// Checks every wavelength of a glass at one incidence. Returns their number and the largest
/// offset.
fn check_glass(name: &str, prism: &Value, incidence: &str) -> (usize, f64) {
    let apex_deg = prism["apex_deg"].as_f64().expect("an apex angle");
    let (mut count, mut worst) = (0, 0.0_f64);
    for row in prism["rows"].as_array().expect("rows") {
        let [nm, n] = ["wavelength_nm", "n"].map(|key| row[key].as_f64().expect("a number"));
        let (incidence_deg, deviation_deg) = if incidence == "minimum" {
            (row["minimum"]["incidence_deg"].as_f64(), row["minimum"]["min_deviation_deg"].as_f64())
        } else {
            (incidence.parse().ok(), row["deviation_deg"][incidence].as_f64())
        };
        // Under total reflection there is no spot.
        let (Some(incidence_deg), Some(deviation_deg)) = (incidence_deg, deviation_deg) else { continue };
        let scene = spot_scene(name, apex_deg, nm, &way(apex_deg, incidence_deg, n, deviation_deg));
        let offset = offset_deg(&scene);
        worst = worst.max(offset[0].abs()).max(offset[1].abs());
        assert!(worst < 0.02, "{name} at {nm} nm, incidence {incidence}: off by {offset:?} degrees");
        count += 1;
    }
    (count, worst)
}

fn check_prism(apex: &str, incidences: [&str; 2]) {
    let golden: Value = serde_json::from_str(include_str!("../golden/prism.json")).expect("golden/prism.json");
    let glasses = ["N-BK7", "N-SF11", "SF10", "F2", "fused silica", "diamond", "water 20C"];
    let mut total = 0;
    for name in glasses.iter().filter(|name| golden[apex].get(name).is_some()) {
        for incidence in incidences {
            let (count, worst) = check_glass(name, &golden[apex][name], incidence);
            println!("prism, {apex}, {name}, incidence {incidence}: {count} wavelengths, worst {worst:.4}°");
            total += count;
        }
    }
    assert!(total > 70, "{total} spots");
}

#[test]
fn a_prism_sends_every_wavelength_where_snell_says() {
    check_prism("apex60", ["minimum", "60"]);
}

#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn a_thin_prism_sends_every_wavelength_where_snell_says() {
    check_prism("apex30", ["minimum", "30"]);
}

#[test]
fn the_beam_crosses_the_prism_in_its_plane() {
    // Checks this file's own geometry: at minimum deviation the ray inside is parallel to the base,
    // and the path is symmetric.
    let way = way(60.0, 49.91766831, 1.530239986, 39.83533662);
    assert!((way.exit.y - way.entry.y).abs() < 1e-8 && (way.exit.x + way.entry.x).abs() < 1e-8);
    let mirrored = (way.entry - way.from).normalize() * DVec2::new(1.0, -1.0);
    assert!((way.out - mirrored).length() < 1e-8);
    assert!(way.out.extend(0.0).dot(DVec3::NEG_Y) > 0.0, "towards the base");
}
