//! Lenses as objects of the scene: a projector, a magnifier, an eye, and a caustic seen through a
//! lens system.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{diffuse, glass, render};
use abbe_optics::lens::{ApertureCheck, TraceDirection, catalogue};
use abbe_session::render::Integrator;
use abbe_transport::sensor::Picture;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// Returns the centroid of the light within `near_px` of the brightest pixel, and its root mean
/// square distance from the centroid, in pixels right of and above the middle.
fn spot(picture: &Picture, near_px: f64) -> (DVec2, f64) {
    let middle = DVec2::new(picture.width as f64, picture.height as f64) * 0.5;
    let place = |i: usize| {
        let place = DVec2::new((i % picture.width) as f64 + 0.5, (i / picture.width) as f64 + 0.5) - middle;
        DVec2::new(place.x, -place.y)
    };
    let brightest = (0..picture.xyz.len()).max_by(|&i, &j| picture.xyz[i][1].total_cmp(&picture.xyz[j][1])).unwrap();
    let all = || picture.xyz.iter().enumerate().map(|(i, xyz)| (place(i), xyz[1]));
    let lit = || all().filter(|(at, _)| at.distance(place(brightest)) < near_px);
    let whole: f64 = lit().map(|(_, y)| y).sum();
    let centre = lit().map(|(place, y)| place * y).sum::<DVec2>() / whole;
    let square = lit().map(|(place, y)| place.distance_squared(centre) * y).sum::<f64>() / whole;
    (centre, square.sqrt())
}

/// Returns the focal length of a biconvex lens (radius, thickness, index) and the distance of its
/// principal planes from the vertices.
fn thick_lens(radius: f64, thickness: f64, n: f64) -> (f64, f64) {
    let power = (n - 1.0) * (2.0 / radius - (n - 1.0) * thickness / (n * radius * radius));
    (1.0 / power, (n - 1.0) * thickness / (n * radius * power))
}

/// A biconvex lens along −z with its middle at the origin, in mm.
fn biconvex(radius: f64, thickness: f64, diameter: f64) -> Value {
    json!({ "shape": { "lens": { "radius1": radius, "radius2": -radius, "thickness": thickness, "diameter": diameter } },
            "material": "glass", "transform": [{ "translate": [0, 0, -0.5 * thickness] }] })
}

const N: f64 = 1.5;

#[test]
fn a_projector_inverts_and_magnifies_its_slide() {
    let (focal, principal) = thick_lens(100.0, 6.0, N);
    let slide_z = 0.5 * 6.0 - principal + 1.5 * focal;
    let wall_z = -(0.5 * 6.0 - principal + 3.0 * focal);
    // 1/1.5 + 1/3 = 1: the image is inverted and twice as large.
    let height = 4.0;
    let scene = json!({
        "unit": "mm",
        "camera": { "from": [0, 0, -40], "at": [0, 0, wall_z], "lens": { "pinhole": { "fov": 8 } } },
        "film": { "width": 64, "height": 64 },
        "materials": { "glass": glass(N), "white": diffuse(0.8), "black": "absorber" },
        "objects": [
            biconvex(100.0, 6.0, 20.0),
            { "shape": { "rectangle": { "width": 300, "height": 300 } }, "material": "white",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, wall_z] }] },
            { "shape": { "disk": { "radius": 0.5 } }, "material": "black", "emission": { "spectrum": "D65", "luminance": 10000 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [0, height, slide_z] }] }
        ],
        "render": { "photons": 40000 }
    });
    let mut photons = scene.clone();
    photons["render"]["forbid"] = json!(["direct", "indirect"]);
    let picture = render(&photons, Integrator::Photon, 16).picture;
    let pixel = 2.0 * 4.0_f64.to_radians().tan() * (-40.0 - wall_z) / 64.0;
    let (centre, size) = spot(&picture, 8.0);
    println!("projector: slide's point {height} mm up, image {:.3} mm, {:.3} mm wide", centre.y * pixel, size * pixel);
    assert!((centre.y * pixel + 2.0 * height).abs() < 0.15 && (centre.x * pixel).abs() < 0.05, "{centre}");
    // The image of a uniform disk of twice the slide's radius has a mean square radius of 0.5 mm².
    // Spherical aberration adds a little.
    assert!((0.6..1.1).contains(&(size * pixel)), "{}", size * pixel);
}

#[test]
fn a_magnifier_magnifies_by_the_lens_formula() {
    let (focal, principal) = thick_lens(60.0, 6.0, N);
    // The page lies at 0.6 focal lengths behind the principal plane: its virtual image is 2.5 times
    // as large and 1.5 focal lengths away.
    let page_z = -(0.5 * 6.0 - principal + 0.6 * focal);
    let eye_z = 0.5 * 6.0 - principal + 200.0;
    let scene = |with_lens: bool| {
        let mut objects = vec![
            json!({ "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "black", "emission": { "spectrum": "E", "luminance": 100 },
                    "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, page_z] }] }),
        ];
        objects.extend(with_lens.then(|| biconvex(60.0, 6.0, 30.0)));
        json!({
            "unit": "mm",
            "camera": { "from": [0, 0, eye_z], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 4 } } },
            "film": { "width": 128, "height": 128 },
            "materials": { "glass": glass(N), "black": "absorber" },
            "objects": objects,
            "render": { "photons": 100 }
        })
    };
    let side = |with_lens: bool| {
        let picture = render(&scene(with_lens), Integrator::Photon, 16).picture;
        // The root mean square distance of a square from its middle is its side over √6.
        spot(&picture, 200.0).1 * 6.0_f64.sqrt()
    };
    let found = side(true) / side(false);
    let (distance_without, distance_with) = (eye_z - page_z, 200.0 + 1.5 * focal);
    let expected = 2.5 * distance_without / distance_with;
    println!("magnifier: {found:.3} times as large, {expected:.3} by the formula");
    assert!((found / expected - 1.0).abs() < 0.02, "{found} and {expected}");
}

#[test]
fn an_eye_gathers_parallel_light_on_its_retina() {
    // A reduced eye: one surface of radius 5.55 mm in front of water of n = 4/3, which focuses 22.2
    // mm behind it. The retina is translucent, and a camera behind it sees the image.
    let (radius, n) = (5.55, 4.0 / 3.0);
    let focus = n * radius / (n - 1.0);
    let scene = |retina: f64| {
        json!({
            "unit": "mm",
            "camera": { "from": [0, 0, 60], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 6 } } },
            "film": { "width": 63, "height": 63 },
            "materials": { "water": glass(n), "retina": { "translucent": { "reflectance": 0.2, "transmittance": 0.6 } } },
            "objects": [
                { "shape": { "lens": { "radius1": radius, "radius2": 0, "thickness": retina, "diameter": 8 } }, "material": "water" },
                { "shape": { "disk": { "radius": 4 } }, "material": "retina",
                  "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, retina + 0.001] }] } ],
            "lights": [ { "beam": { "from": [0, 0, -50], "to": [0, 0, 0], "radius": 1, "spectrum": "E", "power": 1 } } ],
            "render": { "photons": 20000, "forbid": ["indirect"] }
        })
    };
    let [sharp, near] = [focus, 0.6 * focus].map(|retina| {
        let picture = render(&scene(retina), Integrator::Photon, 8).picture;
        let pixel = 2.0 * 3.0_f64.to_radians().tan() * (60.0 - retina) / 63.0;
        let (centre, size) = spot(&picture, 200.0);
        assert!(centre.length() < 0.5, "the light falls on the axis: {centre}");
        size * pixel
    });
    // The root mean square of a uniform disk of radius 1 mm is 0.707 mm. At 0.6 of the distance to
    // the focus, 0.4 of it remains.
    println!(
        "eye: spot of {sharp:.4} mm in focus, {near:.4} mm at 0.6 of the focal distance (a disk's {:.4})",
        0.4 * 0.5_f64.sqrt()
    );
    assert!(sharp < 0.05, "{sharp}");
    assert!((near / (0.4 * 0.5_f64.sqrt()) - 1.0).abs() < 0.04, "{near}");
}

#[test]
#[ignore = "nightly: 10 seconds of CPU time"]
fn a_caustic_seen_through_a_lens_system_is_sharp() {
    // A beam that a ball focuses on the wall, beside the lens axis. The beam comes from the side,
    // so that the ball does not hide the view.
    let place = DVec3::new(0.03, 0.02, -3.0);
    let back = DVec3::new(1.0, 0.4, 1.0).normalize();
    // The focus of a ball is n·R/(2(n − 1)) from its centre.
    let (ball, n) = (0.02, 1.5);
    let centre = place + back * n * ball / (2.0 * (n - 1.0));
    let lamp = |distance: f64| (place + back * distance).to_array();
    let scene = json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1],
                    "lens": { "system": { "prescription": "double gauss", "focus_distance": 3, "f_number": 4, "sensor_height_mm": 3 } } },
        "film": { "width": 64, "height": 64 },
        "materials": { "glass": glass(n), "white": diffuse(0.8) },
        "objects": [
            { "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "white",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, place.z] }] },
            { "shape": { "sphere": { "radius": ball, "center": centre.to_array() } }, "material": "glass" } ],
        "lights": [ { "beam": { "from": lamp(0.5), "to": lamp(0.1), "radius": 0.002, "spectrum": "E", "power": 1 } } ],
        "render": { "photons": 20000, "radius": 0.0005, "forbid": ["indirect"] }
    });
    let picture = render(&scene, Integrator::Photon, 32).picture;
    let (found, size) = spot(&picture, 6.0);
    let lens = catalogue::find("double gauss").unwrap().stopped_down(4.0).unwrap();
    let at = lens.at(587.5618);
    let sensor_z = lens.length_mm() + at.image_distance_mm(3000.0).unwrap();
    let chief = DVec3::new(1e3 * place.x, 1e3 * place.y, 1e3 * place.z);
    let rays = (0..400).filter_map(|i| {
        let aim = DVec3::new(f64::from(i % 20 - 10) * 2.0, f64::from(i / 20 - 10) * 2.0, 0.0);
        let ray = abbe_optics::lens::LensRay { origin: chief, direction: (aim - chief).normalize() };
        at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).ok()
    });
    let (sum, count) =
        rays.fold((DVec2::ZERO, 0.0), |(sum, count), ray| (sum + ray.at_z(sensor_z).truncate(), count + 1.0));
    let expected = -sum / count / (3.0 / 64.0);
    println!("caustic through a double Gauss: at {found:.2} pixels, traced {expected:.2}; {size:.2} pixels wide (RMS)");
    assert!((found - expected).length() < 0.5, "{found} and {expected}");
    assert!(size < 2.0, "{size}");
}
