//! Polarised light in pictures: filters, reflection, piles of plates, total reflection and
//! scattering, against closed forms and golden values, with photons and with camera paths.

use crate::common::near::{assert_near, number};
use crate::common::render;
use crate::golden::golden;
use crate::textures::assert_integrators_agree_after;
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};
use std::f64::consts::PI;

const INTEGRATORS: [Integrator; 2] = [Integrator::Photon, Integrator::Path];

/// The sum of a layer over all pixels.
fn layer(rendered: &Rendered, name: &str) -> f64 {
    let channel = rendered.picture.layers.channels.iter().find(|channel| channel.name == name);
    channel.expect("the layer").values.iter().map(|&value| f64::from(value)).sum()
}

/// The Stokes vector of the whole picture, divided by S0, and the standard errors of S1 to S3. The
/// errors of pixels are added as if they were independent.
fn stokes(rendered: &Rendered) -> ([f64; 3], [f64; 3]) {
    let s0 = layer(rendered, "stokes.S0");
    let parts = [1, 2, 3].map(|part| layer(rendered, &format!("stokes.S{part}")) / s0);
    let errors = [1, 2, 3].map(|part| {
        let name = format!("stokes.noise.S{part}");
        let channel = rendered.picture.layers.channels.iter().find(|channel| channel.name == name);
        let values = &channel.expect("the layer").values;
        values.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>().sqrt() / s0
    });
    (parts, errors)
}

/// A camera that sees the origin in parallel rays, at an angle in degrees from +y towards +z.
fn seen_at(degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!({ "from": [0, 4.0 * cos, 4.0 * sin], "at": [0, 0, 0], "up": [0, sin, -cos],
            "lens": { "orthographic": { "height": 0.1 } } })
}

fn yellow() -> Value {
    json!({ "gaussian": { "peak_nm": 587.56, "fwhm_nm": 0.5 } })
}

fn scene(camera: &Value, materials: &Value, objects: &Value, lights: &Value) -> Value {
    json!({
        "camera": camera,
        "film": { "width": 4, "height": 4, "layers": ["stokes"] },
        "materials": materials, "objects": objects, "lights": lights,
        "render": { "photons": 100 }
    })
}

/// A stack of sheets, the first one farthest from the camera, before a uniform sky of light E.
fn sheets(filters: &[Value]) -> Value {
    let mut materials = serde_json::Map::new();
    let mut objects = Vec::new();
    for (i, filter) in filters.iter().enumerate() {
        materials.insert(format!("f{i}"), filter.clone());
        objects.push(json!({ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": format!("f{i}"),
                             "transform": [{ "translate": [0, i, 0] }] }));
    }
    let mut camera = seen_at(0.0);
    camera["from"] = json!([0, 20, 0]);
    let sky = json!([{ "environment": { "spectrum": "E", "illuminance": 1000 } }]);
    scene(&camera, &materials.into(), &objects.into(), &sky)
}

pub(crate) fn polariser(axis: f64) -> Value {
    json!({ "polariser": { "axis": axis } })
}

fn mean_xyz(rendered: &Rendered) -> [f64; 3] {
    let xyz = &rendered.picture.xyz;
    std::array::from_fn(|c| xyz.iter().map(|xyz| xyz[c]).sum::<f64>() / xyz.len() as f64)
}

/// Malus's law, the third polariser between two crossed ones, and the filter of the camera, whose
/// angles run as those of the sheets. A sheet uses as many random numbers as a hole.
#[test]
fn polarisers_transmit_as_malus_says() {
    for integrator in INTEGRATORS {
        let y = |scene: &Value| mean_xyz(&render(scene, integrator, 1))[1];
        let hole = json!({ "thin_dielectric": { "ior": 1 } });
        for (axes, known) in [
            (&[20.0][..], 0.5),
            (&[0.0, 30.0], 0.375),
            (&[15.0, 105.0], 0.0),
            (&[0.0, 45.0, 90.0], 0.125),
            (&[0.0, 30.0, 60.0, 90.0], 0.5 * 0.75_f64.powi(3)),
        ] {
            if integrator == Integrator::Path && axes.len() > 3 {
                // Russian roulette may end its paths there.
                continue;
            }
            let filters: Vec<Value> = axes.iter().map(|&axis| polariser(axis)).collect();
            let sky = |count: usize| y(&sheets(&vec![hole.clone(); count]));
            let found = y(&sheets(&filters)) / sky(axes.len());
            assert!((found - known).abs() < 1e-6, "{integrator:?} {axes:?}: {found} for {known}");
            let (last, first) = filters.split_last().unwrap();
            let mut at_camera = sheets(first);
            at_camera["camera"]["filter"] = last.clone();
            let found = y(&at_camera) / sky(first.len());
            assert!((found - known).abs() < 1e-6, "{integrator:?} {axes:?} at the camera: {found} for {known}");
        }
    }
}

/// A retarder at 45° between crossed polarisers has the colours of Michel-Lévy's chart in light E,
/// and a quarter-wave plate makes circular light of the stated handedness.
#[test]
fn retarders_between_crossed_polarisers_have_their_colours() {
    for (nm, known) in [(550.0, [0.2352, 0.0908]), (1000.0, [0.4397, 0.2840]), (1128.0, [0.2243, 0.1356])] {
        let retarder = json!({ "retarder": { "retardance_nm": nm, "axis": 45 } });
        let scene = sheets(&[polariser(0.0), retarder, polariser(90.0)]);
        let found = mean_xyz(&render(&scene, Integrator::Photon, 64));
        let sum: f64 = found.iter().sum();
        assert_near(&format!("{nm} nm"), [found[0] / sum, found[1] / sum], &json!(known), 2e-3);
    }
    for (handedness, known) in [("right", 1.0), ("left", -1.0)] {
        let filter = json!({ "circular_polariser": { "handedness": handedness, "retardance_nm": 0.25 * 587.56 } });
        let mut scene = sheets(&[filter]);
        // Light from below the sheet meets its back, so the sheet is turned over.
        scene["objects"][0]["transform"] = json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }]);
        scene["lights"][0]["environment"]["spectrum"] = yellow();
        for integrator in INTEGRATORS {
            let ([q, u, v], _) = stokes(&render(&scene, integrator, 1));
            assert!(q.abs() < 1e-3 && u.abs() < 1e-3, "{handedness}: {q} {u}");
            assert!((v - known).abs() < 1e-4, "{handedness}: {v}");
        }
    }
}

/// A cell whose molecules turn by 90° transmits what Gooch & Tarry (1975) say, from the back as
/// well, and thick molecules that turn by 40° carry the polarisation along.
#[test]
fn liquid_crystals_turn_light() {
    let transmitted = |cell: Value, [first, last]: [f64; 2]| {
        let cell = json!({ "filters": [{ "liquid_crystal": cell }] });
        let mut scene = sheets(&[polariser(first), cell, polariser(last)]);
        scene["lights"][0]["environment"]["spectrum"] = yellow();
        let mut bare = scene.clone();
        bare["objects"] = json!([]);
        let [through, all] = [scene, bare].map(|scene| mean_xyz(&render(&scene, Integrator::Photon, 4))[1]);
        through / all
    };
    for u in [0.6, 3.0_f64.sqrt(), 2.5] {
        let cell = json!({ "retardance_nm": 0.5 * u * 587.56 });
        let parallel = 0.5 * (0.5 * PI * (1.0 + u * u).sqrt()).sin().powi(2) / (1.0 + u * u);
        // The light meets the back first, where the molecules are at 90°.
        let found = [[90.0, 90.0], [90.0, 0.0]].map(|axes| transmitted(cell.clone(), axes));
        assert!((found[0] - parallel).abs() < 2e-3, "{u}: {} for {parallel}", found[0]);
        assert!((found[1] - (0.5 - parallel)).abs() < 2e-3, "{u}: {} for {}", found[1], 0.5 - parallel);
    }
    let thick = json!({ "retardance_nm": 40_000, "twist": 40 });
    let found = [[40.0, 0.0], [40.0, 90.0]].map(|axes| transmitted(thick.clone(), axes));
    assert!((found[0] - 0.5).abs() < 2e-3 && found[1] < 2e-3, "{found:?}");
    // Turned over, the cell shows the light its front, and its molecules turn to −40° of the scene.
    let turned_over = |last: f64| {
        let cell = json!({ "filters": [{ "liquid_crystal": thick.clone() }] });
        let mut scene = sheets(&[polariser(0.0), cell, polariser(last)]);
        scene["lights"][0]["environment"]["spectrum"] = yellow();
        let flip = json!({ "rotate": { "axis": [1, 0, 0], "degrees": 180 } });
        let transform = scene["objects"][1]["transform"].as_array().cloned().unwrap_or_default();
        scene["objects"][1]["transform"] = [vec![flip], transform].concat().into();
        let mut bare = scene.clone();
        bare["objects"] = json!([]);
        let [through, all] = [scene, bare].map(|scene| mean_xyz(&render(&scene, Integrator::Photon, 4))[1]);
        through / all
    };
    let found = [140.0, 50.0, 40.0].map(turned_over);
    assert!((found[0] - 0.5).abs() < 2e-3 && found[1] < 2e-3 && found[2] < 0.1, "{found:?}");
}

/// A pressed disc has N = 8PC/(πDλ) fringes in the middle, and a bent beam 6MC/(b²λ) at its edges
/// and half of them halfway. A texture of the factor is a wedge.
#[test]
fn sheets_under_stress_retard_by_the_stress_optic_law() {
    let (coefficient, light_nm) = (80e-12, 587.56);
    let disc = json!({ "stress": { "coefficient": coefficient, "disc": { "load": 500, "diameter": 0.04 } } });
    let beam = json!({ "stress": { "coefficient": coefficient, "beam": { "moment": 2, "depth": 0.03 } } });
    let wedge = json!({ "retarder": { "retardance_nm": 1000, "factor": { "gradient": { "a": 0, "b": 1 } } } });
    let of_beam = 6.0 * 2.0 * coefficient / (0.03 * 0.03) * 1e9;
    let cases = [
        (&disc, 0.0, 8.0 * 500.0 * coefficient / (std::f64::consts::PI * 0.04) * 1e9),
        (&beam, 0.5, 0.5 * of_beam),
        (&beam, -0.25, 0.25 * of_beam),
        (&wedge, 0.0, 500.0),
        (&wedge, 0.5, 250.0),
    ];
    for (sheet, height, retardance_nm) in cases {
        let fringes = retardance_nm / light_nm;
        let known = 0.5 * (std::f64::consts::PI * fringes).sin().powi(2);
        // A disk lies with v along z; the picture shows the place at this fraction of its radius.
        let mut scene = sheets(&[polariser(45.0), sheet.clone(), polariser(135.0)]);
        scene["lights"][0]["environment"]["spectrum"] = yellow();
        let shape =
            if sheet == &disc { json!({ "disk": { "radius": 1 } }) } else { scene["objects"][1]["shape"].clone() };
        scene["objects"][1]["shape"] = shape;
        (scene["camera"]["from"][2], scene["camera"]["at"][2]) = (json!(-height), json!(-height));
        scene["camera"]["lens"] = json!({ "orthographic": { "height": 0.002 } });
        scene["film"]["layers"] = json!([]);
        for integrator in INTEGRATORS {
            let y = |scene: &Value| mean_xyz(&render(scene, integrator, 1))[1];
            let mut clear = scene.clone();
            for i in 0..3 {
                clear["materials"][format!("f{i}")] = json!({ "thin_dielectric": { "ior": 1 } });
            }
            let found = y(&scene) / y(&clear);
            println!("{sheet} at {height}, {integrator:?}: {found:.5} for {known:.5} ({fringes:.4} fringes)");
            assert!((found - known).abs() < 0.01, "{sheet} at {height}: {found} for {known}");
        }
    }
}

/// Glass and water reflect horizontally polarised light at Brewster's angle.
#[test]
fn surfaces_polarise_completely_at_brewster_s_angle() {
    for ior in [1.5168, 1.333] {
        let camera = seen_at(f64::atan(ior).to_degrees());
        let materials = json!({ "glass": { "dielectric": { "ior": ior, "absorption": 1e5 } } });
        let objects = json!([{ "shape": { "box": { "size": [4, 1, 4] } }, "material": "glass",
                               "transform": [{ "translate": [0, -0.5, 0] }] }]);
        let sky = json!([{ "environment": { "spectrum": yellow(), "illuminance": 1000 } }]);
        for integrator in INTEGRATORS {
            let ([q, u, v], _) = stokes(&render(&scene(&camera, &materials, &objects, &sky), integrator, 2));
            assert!((q - 1.0).abs() < 1e-6 && u.abs() < 1e-6 && v.abs() < 1e-6, "{ior}: {q} {u} {v}");
        }
    }
}

fn pile(plates: u64) -> Value {
    let plate = |i: u64| {
        json!({ "shape": { "rectangle": { "width": 40, "height": 40 } }, "material": "plate",
                "transform": [{ "translate": [0, -0.02 * i as f64, 0] }] })
    };
    let mut objects: Vec<Value> = (0..plates).map(plate).collect();
    objects.push(json!({ "shape": { "rectangle": { "width": 30, "height": 30 } }, "material": "absorber",
                         "transform": [{ "translate": [0, -2, 0] }],
                         "emission": { "spectrum": yellow(), "luminance": 100 } }));
    let materials = json!({ "plate": { "thin_dielectric": { "ior": 1.5168 } }, "absorber": "absorber" });
    scene(&seen_at(f64::atan(1.5168).to_degrees()), &materials, &objects.into(), &json!([]))
}

/// Piles of plates at Brewster's angle transmit light of their golden degree of polarisation.
#[test]
fn piles_of_plates_polarise_as_their_golden_values_say() {
    let file = golden("polarisation.json");
    for case in file["pile_of_plates"].as_array().unwrap() {
        let (plates, known) = (case["plates"].as_u64().unwrap(), number(&case["dop_transmitted"]));
        let at_brewster = (number(&case["angle_deg"]) - 56.6038).abs() < 0.01 && number(&case["n"]) == 1.5168;
        if !(at_brewster && [1, 5, 10].contains(&plates)) {
            continue;
        }
        for (integrator, passes) in [(Integrator::Photon, 64), (Integrator::Path, 512)] {
            let ([q, ..], [error, ..]) = stokes(&render(&pile(plates), integrator, passes));
            println!("{plates} plates, {integrator:?}: {q:.4} ± {error:.4} for −{known:.4}");
            assert!((q + known).abs() < 4.0 * error + 1e-4, "{plates}: {q} ± {error} for −{known}");
            assert!(error < 0.02, "{plates}: {error}");
        }
    }
}

/// A slab of glass transmits the mean of the two polarisations, as a box as well as a thin pane.
#[test]
fn a_slab_transmits_the_sum_of_both_polarisations() {
    for degrees in [60.0_f64, 70.0, 80.0] {
        let cos = degrees.to_radians().cos();
        let inside = (1.0 - (1.0 - cos * cos) / (1.5 * 1.5)).sqrt();
        let of = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
        let faces = [of(cos, 1.5 * inside), of(1.5 * cos, inside)];
        let known = 0.5 * faces.iter().map(|face| (1.0 - face) / (1.0 + face)).sum::<f64>();
        let slab = json!([
            { "shape": { "box": { "size": [200, 0.01, 200] } }, "material": "glass" },
            { "shape": { "rectangle": { "width": 400, "height": 400 } }, "material": "absorber",
              "transform": [{ "translate": [0, -1, 0] }], "emission": { "spectrum": yellow(), "luminance": 100 } }
        ]);
        let materials = json!({ "glass": { "dielectric": { "ior": 1.5 } }, "absorber": "absorber" });
        let scene = scene(&seen_at(degrees), &materials, &slab, &json!([]));
        for (integrator, passes) in [(Integrator::Photon, 2048), (Integrator::Path, 8192)] {
            let rendered = render(&scene, integrator, passes);
            let found = mean_xyz(&rendered)[1] / 100.0;
            println!("{degrees}°, {integrator:?}: {found:.5} for {known:.5}");
            let tolerance = if integrator == Integrator::Photon { 1e-3 } else { 1e-2 };
            assert!((found / known - 1.0).abs() < tolerance, "{degrees}°: {found} for {known}");
        }
    }
}

/// Light that is linear at 45° is circular after the two total reflections of Fresnel's rhomb.
#[test]
fn a_fresnel_rhomb_makes_circular_light() {
    let (n, degrees) = (1.51_f64, 54.623_105_441_2_f64);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (height, length) = (1.0, 2.0 * degrees.to_radians().tan());
    // The section in the plane of incidence: the ends are perpendicular to the light.
    let lean = height * cos / sin;
    let section = [[0.0, 0.0], [length, 0.0], [length + lean, height], [lean, height]];
    let positions: Vec<[f64; 3]> =
        [-1.0, 1.0].iter().flat_map(|z| section.iter().map(move |[x, y]| [*x, *y, *z])).collect();
    let indices = json!([
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7]
    ]);
    let exit = [0.5 * lean + length, 0.5 * height];
    let entry = [0.5 * lean, 0.5 * height];
    let camera = json!({ "from": [exit[0] + 4.0 * sin, exit[1] - 4.0 * cos, 0], "at": [exit[0], exit[1], 0],
                         "up": [0, 0, 1], "lens": { "orthographic": { "height": 0.1 } } });
    let objects = json!([
        { "shape": { "triangles": { "positions": positions, "indices": indices } }, "material": "glass" },
        { "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "polariser", "transform": [
            { "rotate": { "axis": [0, 0, 1], "degrees": degrees } },
            { "translate": [entry[0] - sin, entry[1] + cos, 0] }] },
        { "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "lamp", "transform": [
            { "rotate": { "axis": [0, 0, 1], "degrees": degrees + 180.0 } },
            { "translate": [entry[0] - 2.0 * sin, entry[1] + 2.0 * cos, 0] }],
          "emission": { "spectrum": yellow(), "luminance": 100 } }
    ]);
    let materials =
        json!({ "glass": { "dielectric": { "ior": n } }, "polariser": polariser(45.0), "lamp": "absorber" });
    let scene = scene(&camera, &materials, &objects, &json!([]));
    // Of the light, 0.2 % is reflected back and forth between the ends, and arrives with the
    // opposite handedness. Few of the samples follow it.
    let back_and_forth = ((n - 1.0) / (n + 1.0)).powi(4);
    let expected = (1.0 - back_and_forth) / (1.0 + back_and_forth);
    for integrator in INTEGRATORS {
        let ([q, u, v], _) = stokes(&render(&scene, integrator, 6400));
        println!("{integrator:?}: {q:.5} {u:.5} {v:.5}, expected {expected:.5}");
        assert!(q.abs() < 1e-3 && u.abs() < 1e-3 && (v.abs() - expected).abs() < 1.5e-3, "{q} {u} {v}");
    }
}

/// A ball of a thin medium under a sun at this angle from the point behind the camera.
fn scattered(phase: &Value, degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let camera =
        json!({ "from": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "orthographic": { "height": 0.2 } } });
    let objects = json!([{ "shape": { "sphere": { "radius": 0.5 } }, "material": "haze" }]);
    let materials = json!({ "haze": { "boundary": { "medium": "haze" } } });
    let sun = json!([{ "directional": { "toward": [-sin, 0, -cos], "spectrum": yellow(), "illuminance": 1000 } }]);
    let mut scene = scene(&camera, &materials, &objects, &sun);
    scene["media"] = json!({ "haze": { "homogeneous": { "absorption": 0, "scattering": 0.001, "phase": phase } } });
    scene
}

/// Skylight at 90° from the sun, small spheres, and both bows of rain are polarised across the plane
/// of scattering.
#[test]
fn air_and_rain_polarise_the_light_that_they_scatter() {
    let air = (1.0 - 0.0279) / (1.0 + 0.0279);
    let rain = json!("rainbow");
    let small = json!({ "mie": { "radius_um": 0.02, "ior": 1.5 } });
    // The bows of many sizes of drops, with light from all rays, are less polarised than the
    // Descartes ray alone: 0.924 and 0.807.
    for (phase, degrees, known, tolerance) in [
        (&json!("rayleigh"), 90.0, air, 1e-4),
        (&small, 90.0, 1.0, 0.01),
        (&rain, 41.7, 0.89, 0.04),
        (&rain, 51.4, 0.72, 0.06),
    ] {
        let ([q, u, v], _) = stokes(&render(&scattered(phase, degrees), Integrator::Photon, 8));
        println!("{phase} at {degrees}°: {q:.4}");
        assert!((q + known).abs() < tolerance && u.abs() < 1e-3 && v.abs() < 1e-3, "{phase}: {q} for −{known}");
    }
}

/// A lamp above a floor that reflects little, with these sheets and bodies in between.
fn lamp_over_a_floor(materials: &Value, objects: &[Value], filter: Option<&Value>) -> Value {
    let mut all = vec![
        json!({ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "grey" }),
        json!({ "shape": { "sphere": { "radius": 0.1 } }, "material": "absorber",
                "transform": [{ "translate": [0.4, 1.6, 0.2] }], "emission": { "spectrum": "E", "power": 100 } }),
    ];
    all.extend(objects.iter().cloned());
    let mut materials = materials.clone();
    materials["grey"] = json!({ "diffuse": { "reflectance": 0.3 } });
    materials["absorber"] = json!("absorber");
    let mut scene = json!({
        "camera": { "from": [0, 0.5, 0], "at": [0, 0, 0], "up": [0, 0, 1], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 16, "height": 16 },
        "materials": materials, "objects": all,
        "render": { "photons": 20000 }
    });
    if let Some(filter) = filter {
        scene["camera"]["filter"] = filter.clone();
    }
    scene
}

fn sheet(height: f64, tilt: f64, material: &str) -> Value {
    json!({ "shape": { "rectangle": { "width": 3, "height": 3 } }, "material": material,
            "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": tilt } }, { "translate": [0, height, 0] }] })
}

/// Photons carry Stokes vectors and camera paths Mueller matrices, and both give the same picture:
/// through crossed filters and a retarder, behind an oblique pane, and at a glossy floor.
#[test]
fn photons_and_paths_agree_on_polarised_light() {
    let filters = json!({ "p": polariser(0.0), "q": polariser(60.0), "r": { "retarder": { "retardance_nm": 700,
        "axis": 30 } }, "pane": { "thin_dielectric": { "ior": 1.8 } } });
    let mut glossy = lamp_over_a_floor(&json!({}), &[], Some(&polariser(90.0)));
    glossy["materials"]["grey"] = json!({ "glossy": { "reflectance": 0.1, "ior": 1.5, "roughness": 0.4 } });
    glossy["camera"]["from"] = json!([-0.8, 0.6, 0]);
    let cases = [
        ("filters", lamp_over_a_floor(&filters, &[sheet(1.2, 0.0, "p"), sheet(0.8, 10.0, "q")], None)),
        (
            "a retarder between filters",
            lamp_over_a_floor(&filters, &[sheet(1.2, 0.0, "p"), sheet(1.0, 0.0, "r"), sheet(0.8, 10.0, "q")], None),
        ),
        ("an oblique pane", lamp_over_a_floor(&filters, &[sheet(1.2, 55.0, "pane"), sheet(0.6, 0.0, "p")], None)),
        ("a glossy floor", glossy),
    ];
    for (name, scene) in cases {
        assert_integrators_agree_after(16, name, &scene, 2e-2);
    }
}

/// A quarter-wave plate makes circular light of what a polariser behind it transmits. In the other
/// order, the light is linear.
#[test]
fn sheets_act_in_the_order_in_which_light_meets_them() {
    let plate = json!({ "retarder": { "axis": 45, "retardance_nm": 0.25 * 587.56 } });
    for integrator in INTEGRATORS {
        for (filters, circular) in [([polariser(0.0), plate.clone()], 1.0), ([plate.clone(), polariser(0.0)], 0.0)] {
            let mut scene = sheets(&filters);
            scene["lights"][0]["environment"]["spectrum"] = yellow();
            let ([q, u, v], _) = stokes(&render(&scene, integrator, 1));
            assert!((v.abs() - circular).abs() < 1e-4, "{integrator:?} {filters:?}: {q} {u} {v}");
            assert!((q.hypot(u) - (1.0 - circular)).abs() < 1e-3, "{integrator:?} {filters:?}: {q} {u} {v}");
        }
    }
}

/// Light from the front of a circular polariser leaves circular, and light from its back linear.
#[test]
fn circular_polarisers_depend_on_their_side() {
    let filter = json!({ "circular_polariser": { "handedness": "right", "retardance_nm": 0.25 * 587.56 } });
    for (degrees, circular) in [(0.0, 0.0), (180.0, 1.0)] {
        let mut scene = sheets(std::slice::from_ref(&filter));
        scene["objects"][0]["transform"] = json!([{ "rotate": { "axis": [1, 0, 0], "degrees": degrees } }]);
        scene["lights"][0]["environment"]["spectrum"] = yellow();
        let ([q, u, v], _) = stokes(&render(&scene, Integrator::Photon, 1));
        assert!((v - circular).abs() < 1e-4, "{degrees}°: {q} {u} {v}");
        assert!(((q * q + u * u).sqrt() - (1.0 - circular)).abs() < 1e-3, "{degrees}°: {q} {u} {v}");
    }
}
