//! Diffraction gratings in scenes: the angles of the orders, their share of the light, and the two
//! integrators.

use crate::common::near::number;
use crate::common::{diffuse, render};
use crate::golden::golden;
use crate::textures::assert_integrators_agree_after;
use abbe_session::render::Integrator;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// The distance from the grating to the screen, the visible width of the screen and the radius of
/// the beam, in m.
const THROW: f64 = 2.0;
const VIEW: f64 = 0.024;
const BEAM: f64 = 0.003;

/// Pixels across the view: 0.5 mm or 0.014° each, seen from the grating.
const PIXELS: u32 = 48;

/// A horizontal grating with its grooves along z. A beam arrives from above along `way_in`, and a
/// screen stands across the direction `out`, in the plane z = 0.
fn spot_scene(grating: &Value, nm: f64, way_in: DVec2, out: DVec2) -> Value {
    let at = |v: DVec2| [v.x, v.y, 0.0];
    let middle = out * THROW;
    // The screen's +y faces the grating.
    let turn = (-out).to_angle().to_degrees() - 90.0;
    json!({
        "camera": { "from": at(middle - out * 0.5), "at": at(middle), "up": [0, 0, 1],
                    "lens": { "pinhole": { "fov": 2.0 * (VIEW / 2.0 / 0.5_f64).atan().to_degrees() } } },
        "film": { "width": PIXELS, "height": PIXELS },
        "materials": { "grating": { "grating": grating }, "white": diffuse(0.8) },
        "objects": [
            { "shape": { "rectangle": { "width": 0.1, "height": 0.1 } }, "material": "grating" },
            { "shape": { "rectangle": { "width": 0.06, "height": 0.06 } }, "material": "white",
              "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": turn } }, { "translate": at(middle) } ] }
        ],
        "lights": [ { "beam": { "from": at(-way_in * 0.3), "to": [0, 0, 0], "radius": BEAM, "power": 1,
                                "spectrum": { "lines": [ { "nm": nm, "power": 1, "fwhm_nm": 0.001 } ] } } } ],
        "render": { "photons": 20000, "forbid": ["aim"] }
    })
}

/// Returns the sum of the pixels, and the angle in degrees between the spot's centroid and the
/// middle of the screen, in the plane of incidence and across it.
fn spot(scene: &Value, integrator: Integrator) -> (f64, [f64; 2]) {
    let rendered = render(scene, integrator, 1);
    let (mut sum, mut moment) = (0.0, DVec2::ZERO);
    for (index, xyz) in rendered.picture.xyz.iter().enumerate() {
        let weight = xyz[1];
        let place = DVec2::new(f64::from(index as u32 % PIXELS), f64::from(index as u32 / PIXELS)) + 0.5;
        sum += weight;
        moment += weight * (place / f64::from(PIXELS) - 0.5) * VIEW;
    }
    assert!(sum > 0.0, "the spot is not in view");
    (sum, (moment / sum).to_array().map(|metres| (metres / THROW).atan().to_degrees()))
}

/// Each order of the golden file lies within 0.02° of its angle. The spots of the orders share the
/// light as the golden efficiencies say.
#[test]
fn orders_lie_where_the_grating_equation_says() {
    let file = golden("grating.json");
    let case = file["efficiencies"].as_array().unwrap().iter().find(|case| {
        case["profile"] == "blazed" && number(&case["lines_per_mm"]) == 600.0 && number(&case["incidence_deg"]) == 30.0
    });
    let case = case.unwrap();
    let nm = number(&case["wavelength_nm"]);
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let profile = json!({ "blazed": { "order": 1, "nm": 500 } });
    for (key, sign) in [("reflectance", 1.0), ("transmittance", -1.0)] {
        let grating = json!({ "lines_per_mm": 600, "profile": profile, key: 1 });
        let mut brightness = Vec::new();
        for (i, order) in case["orders"].as_array().unwrap().iter().enumerate() {
            let x = sin + number(order) * nm * 600e-6;
            // Grazing orders would need a larger grating. The reflected beam of the order that
            // returns would hit the camera's side of the screen.
            let efficiency = number(&case["efficiency"][i]);
            if x.abs() > 0.9 || efficiency < 1e-3 || (sign > 0.0 && (x + sin).abs() < 0.05) {
                continue;
            }
            let out = DVec2::new(x, sign * (1.0 - x * x).sqrt());
            let scene = spot_scene(&grating, nm, DVec2::new(sin, -cos), out);
            let (sum, offset) = spot(&scene, Integrator::Photon);
            println!("{key}, order {order}: off by {offset:?} degrees, brightness {sum}");
            assert!(offset.iter().all(|offset| offset.abs() < 0.02), "{key}, order {order}: off by {offset:?} degrees");
            // The beam keeps its power but not its width.
            brightness.push((sum, efficiency));
        }
        assert!(brightness.len() >= 2, "{key}: {brightness:?}");
        let (whole, all): (f64, f64) = brightness.iter().fold((0.0, 0.0), |(a, b), (sum, e)| (a + sum, b + e));
        for (sum, efficiency) in &brightness {
            let (found, known) = (sum / whole, efficiency / all);
            assert!((found - known).abs() < 0.01, "{key}: {found} for {known}");
        }
    }
}

/// Measured efficiencies are the shares of the arriving light: an order with the efficiency 1 has
/// all of it.
#[test]
fn measured_efficiencies_are_the_shares_of_the_orders() {
    let nm = 550.0;
    let ramp = json!({ "table": { "nm": [500, 600], "values": [0, 0.2] } });
    let shares = json!([{ "order": 0, "efficiency": 0.2 }, { "order": 1, "efficiency": 0.6 },
                        { "order": -1, "efficiency": ramp }]);
    let brightness = |table: Value, order: i32| {
        let grating = json!({ "lines_per_mm": 600, "profile": { "table": table }, "transmittance": 1 });
        let x = f64::from(order) * nm * 600e-6;
        spot(&spot_scene(&grating, nm, DVec2::NEG_Y, DVec2::new(x, -(1.0 - x * x).sqrt())), Integrator::Photon).0
    };
    for (order, expected) in [(0, 0.2), (1, 0.6), (-1, 0.1)] {
        let all = brightness(json!([{ "order": order, "efficiency": 1 }]), order);
        let share = brightness(shares.clone(), order) / all;
        assert!((share - expected).abs() < 0.01, "order {order}: {share} for {expected}");
    }
}

/// Grooves that are turned by 90° diffract along z, and circular grooves diffract along the radius.
#[test]
fn grooves_follow_the_texture_coordinates() {
    let out = DVec3::new(0.0, 0.5, 0.75_f64.sqrt());
    let centre = json!([0.0, 0.0, 0.0]);
    for (grooves, place) in
        [(json!({ "angle": -90 }), centre.clone()), (json!({ "grooves": "circular" }), json!([0.0, 0.0, -2.0]))]
    {
        // 1000 lines per mm and 866.03 nm would be out of range: 1732 lines per mm and 500 nm.
        let mut grating = json!({ "lines_per_mm": 0.75_f64.sqrt() / 500e-6 });
        grating.as_object_mut().unwrap().extend(grooves.as_object().unwrap().clone());
        let middle = out * THROW;
        let scene = json!({
            "camera": { "from": (0.75 * middle).to_array(), "at": middle.to_array(), "up": [1, 0, 0],
                        "lens": { "pinhole": { "fov": 2.75 } } },
            "film": { "width": PIXELS, "height": PIXELS },
            "materials": { "grating": { "grating": grating }, "white": diffuse(0.8) },
            "objects": [
                { "shape": { "disk": { "radius": 8 } }, "material": "grating", "transform": [{ "translate": place }] },
                { "shape": { "sphere": { "radius": 50, "center": (middle + 50.0 * out).to_array() } }, "material": "white" }
            ],
            "lights": [ { "beam": { "from": [0, 0.3, 0], "to": [0, 0, 0], "radius": BEAM, "power": 1,
                                    "spectrum": { "lines": [ { "nm": 500, "power": 1 } ] } } } ],
            "render": { "photons": 20000, "forbid": ["aim"] }
        });
        let (_, offset) = spot(&scene, Integrator::Photon);
        println!("{grooves}: off by {offset:?} degrees");
        assert!(offset.iter().all(|offset| offset.abs() < 0.02), "{grooves}: off by {offset:?}");
    }
}

/// Light reaches a floor and the camera through a grating and from a disc with grooves.
#[test]
#[ignore = "nightly: 12 seconds of CPU time"]
fn photons_and_paths_agree_on_gratings() {
    let scene = json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 32, "height": 32 },
        "materials": {
            "grey": diffuse(0.6), "black": "absorber",
            "sheet": { "grating": { "lines_per_mm": 300, "transmittance": 0.7, "reflectance": 0.2,
                                    "profile": { "sinusoidal": { "amplitude": 1.2, "nm": 550 } } } },
            "disc": { "grating": { "lines_per_mm": 625, "grooves": "circular",
                                   "profile": { "blazed": { "order": 1, "nm": 500 } } } }
        },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "grey" },
            { "shape": { "rectangle": { "width": 1.2, "height": 1.2 } }, "material": "sheet",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 60 } }, { "translate": [-0.8, 0.8, 0] }] },
            { "shape": { "disk": { "radius": 0.7 } }, "material": "disc",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 30 } }, { "translate": [0.9, 0.5, 0] }] },
            { "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 8000 }
    });
    // All light arrives at the shared wavelengths of a pass, so its colour is noisy.
    assert_integrators_agree_after(16, "gratings", &scene, 2e-2);
}

/// A spectroscope: a slit at a distance of 50 m, a transmission grating, and a camera behind it
/// that looks along the order `order` of `nm`. Its round stop has the diameter `stop_mm`. A pixel
/// is a sixteenth of the radius of the first dark ring.
struct Spectroscope {
    lines_per_mm: f64,
    order: f64,
    stop_mm: f64,
    nm: f64,
}

impl Spectroscope {
    const DISTANCE_M: f64 = 50.0;
    const FILM: usize = 97;
    const RING_PX: f64 = 16.0;

    fn sin_cos(&self) -> (f64, f64) {
        let sin = self.order * self.nm * 1e-6 * self.lines_per_mm;
        (sin, (1.0 - sin * sin).sqrt())
    }

    fn pixel_rad(&self) -> f64 {
        1.22 * self.nm * 1e-6 / self.stop_mm / Self::RING_PX
    }

    /// Returns Y along the spectrum, from the middle row of the picture. The slit emits a line.
    fn row(&self, line_nm: f64, slit_mm: f64) -> Vec<f64> {
        let ((sin, cos), film) = (self.sin_cos(), Self::FILM);
        // The light of an order diverges from a point at this distance, across the grooves.
        let focus_m = Self::DISTANCE_M * cos * cos;
        let scene = json!({
            "camera": { "from": [0.005 * sin, -0.005 * cos, 0], "at": [-sin, cos, 0], "up": [0, 0, 1],
                "lens": { "thin": {
                    "fov": 2.0 * (0.5 * film as f64 * self.pixel_rad()).atan().to_degrees(), "focus_distance": focus_m,
                    "defocus_angle": 2.0 * (0.5e-3 * self.stop_mm / focus_m).atan().to_degrees(), "diffraction": true
                } } },
            "film": { "width": film, "height": film },
            "materials": { "black": "absorber", "grating": { "grating": {
                "lines_per_mm": self.lines_per_mm, "profile": { "blazed": { "order": self.order, "nm": self.nm } },
                "transmittance": 1
            } } },
            "objects": [
                { "shape": { "rectangle": { "width": 0.05, "height": 0.05 } }, "material": "grating" },
                { "shape": { "rectangle": { "width": 1e-3 * slit_mm, "height": 1e-3 } }, "material": "black",
                  "emission": { "spectrum": { "lines": [{ "nm": line_nm, "power": 1, "fwhm_nm": 1e-4 }] },
                                "luminance": 1e6 },
                  "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } },
                                { "translate": [0, Self::DISTANCE_M, 0] }] }
            ],
            "render": { "photons": 100 }
        });
        let picture = render(&scene, Integrator::Photon, 32).picture;
        picture.xyz[film * (film / 2)..film * (film / 2 + 1)].iter().map(|xyz| xyz[1]).collect()
    }
}

/// Returns the place of an extreme value of a row between two places, from a parabola through three
/// pixels. `sign` is 1 for a maximum and −1 for a minimum.
fn extreme(row: &[f64], (from, to): (usize, usize), sign: f64) -> f64 {
    let place = (from..to).max_by(|&i, &j| (sign * row[i]).total_cmp(&(sign * row[j]))).expect("a row");
    let [before, here, after] = [row[place - 1], row[place], row[place + 1]];
    place as f64 + 0.5 * (before - after) / (before - 2.0 * here + after)
}

/// The resolving power is the wavelength, divided by the difference of wavelengths that moves the
/// picture of a narrow slit to its own first dark ring. It is mN/1.22 for N grooves in front of the
/// stop.
#[test]
#[ignore = "nightly: 13 seconds of CPU time"]
fn a_grating_before_a_round_stop_has_its_resolving_power() {
    for (lines_per_mm, order, stop_mm) in [(600.0, 1.0, 2.0), (300.0, 2.0, 3.0)] {
        let spectroscope = Spectroscope { lines_per_mm, order, stop_mm, nm: 500.0 };
        const STEP_NM: f64 = 0.3;
        let [row, moved] = [500.0, 500.0 + STEP_NM].map(|nm| spectroscope.row(nm, 1.0));
        let whole = (1, Spectroscope::FILM - 1);
        let (at, next) = (extreme(&row, whole, 1.0), extreme(&moved, whole, 1.0));
        let ring = extreme(&row, (at as usize + 12, at as usize + 21), -1.0) - at;
        let found = 500.0 / (STEP_NM * ring / (next - at).abs());
        let expected = order * stop_mm * lines_per_mm / spectroscope.sin_cos().1 / 1.22;
        println!(
            "{lines_per_mm} per mm, order {order}: dark ring at {ring:.2} pixels, resolving power {found:.0} of {expected:.0}"
        );
        assert!((ring / Spectroscope::RING_PX - 1.0).abs() < 0.1, "{ring}");
        assert!((found / expected - 1.0).abs() < 0.1, "{found} of {expected}");
    }
}

/// The picture of a slit that is much wider than the dark ring has the width of the slit, divided
/// by the cosine of the angle of the order.
#[test]
#[ignore = "nightly: 4 seconds of CPU time"]
fn a_wide_slit_limits_the_resolving_power() {
    let spectroscope = Spectroscope { lines_per_mm: 600.0, order: 1.0, stop_mm: 4.0, nm: 500.0 };
    const SLIT_MM: f64 = 24.0;
    let row = spectroscope.row(500.0, SLIT_MM);
    let half = 0.5 * row[Spectroscope::FILM / 2];
    let width = row.iter().filter(|&&y| y > half).count() as f64;
    let expected = 1e-3 * SLIT_MM / Spectroscope::DISTANCE_M / spectroscope.sin_cos().1 / spectroscope.pixel_rad();
    println!("a slit of {expected:.1} pixels has the width of {width} pixels");
    assert!((width / expected - 1.0).abs() < 0.05, "{width} and {expected} pixels");
}

/// A lossless grating in uniform surroundings looks like its surroundings, also where the strong
/// order is evanescent.
#[test]
fn gratings_vanish_in_uniform_surroundings() {
    let profiles = [
        json!({ "blazed": { "order": 1, "nm": 550 } }),
        json!({ "sinusoidal": { "amplitude": 1.2, "nm": 550 } }),
        json!({ "lamellar": { "phase": 3.0, "nm": 550, "duty": 0.4 } }),
    ];
    for (profile, lines) in profiles.iter().flat_map(|profile| [300, 1200, 2000].map(|lines| (profile, lines))) {
        let grating = json!({ "lines_per_mm": lines, "profile": profile, "reflectance": 0.6, "transmittance": 0.4 });
        let scene = json!({
            "camera": { "from": [0, 0.4, 2], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 30 } } },
            "film": { "width": 4, "height": 4 },
            "materials": { "grating": { "grating": grating } },
            "objects": [{ "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "grating" }],
            "lights": [{ "environment": { "luminance": 1, "spectrum": { "lines": [{ "nm": 560, "power": 1 }] } } }],
            "render": { "photons": 1000 }
        });
        for integrator in [Integrator::Photon, Integrator::Path] {
            let mean = render(&scene, integrator, 8).picture.mean_y();
            assert!((mean - 1.0).abs() < 1e-3, "{profile}, {lines} per mm, {integrator:?}: {mean}");
        }
    }
}
