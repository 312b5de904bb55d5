//! Cameras: apertures of radius 0 and of the size of the focus distance, focus at infinity, films
//! of one pixel and of one column, shutters and keyframes without extent.

use glam::{DVec2, DVec3};
use serde_json::{Value, json};

use abbe_format as format;
use abbe_format::resolve::resolve;
use abbe_scene::camera::Camera;
use abbe_session::render::Integrator;

use super::common::{diffuse, job, render};
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "An aperture of radius 0",
        naive: "0/0 in the density over the lens",
        here: "points of the aperture are sampled directly, without a division by a density",
        measured: "largest distance of a ray from the pinhole's ray",
        bound: Bound::AtMost(4e-16),
        pace: Pace::Fast,
        measure: || {
            let (open, pinhole) = (camera(thin(3.0, 0.0)), camera(json!({ "pinhole": { "fov": 40 } })));
            worst_ray(|film, lens| {
                let (a, b) = (open.ray(film, lens), pinhole.ray(film, lens));
                (a.direction - b.direction).length() + (a.origin - b.origin).length()
            })
        },
    },
    Case {
        name: "An aperture whose radius equals the focus distance",
        naive: "small-angle formulas miss the plane of focus",
        here: "rays are aimed at a point on that plane",
        measured: "distance of the rays from that point, relative to the focus distance",
        bound: Bound::AtMost(1e-15),
        pace: Pace::Fast,
        measure: || {
            let (wide, pinhole) = (camera(thin(3.0, 90.0)), camera(json!({ "pinhole": { "fov": 40 } })));
            worst_ray(|film, lens| {
                let chief = pinhole.ray(film, lens);
                let focus = chief.at(3.0 / chief.direction.dot(DVec3::NEG_Z));
                let ray = wide.ray(film, lens);
                (focus - ray.origin).cross(ray.direction).length() / 3.0
            })
        },
    },
    Case {
        name: "Focus at 10⁹, 10¹⁵⁰ and 10³⁰⁰ m",
        naive: "the square of the distance overflows, and rays have no direction",
        here: "the aperture offset is divided by the distance; the direction is not multiplied by it",
        measured: "angle between rays of one pixel, minus the ratio of aperture to distance",
        bound: Bound::AtMost(1e-15),
        pace: Pace::Fast,
        measure: || {
            let miss = |focus: f64| {
                let radius = 0.1_f64;
                let camera = camera(thin(focus, 2.0 * (radius / focus).atan().to_degrees()));
                worst_ray(|film, lens| {
                    let (a, b) = (camera.ray(film, lens).direction, camera.ray(film, [0.5; 2]).direction);
                    if (a.length() - 1.0).abs() < 1e-12 {
                        ((a - b).length() - 1.5 * radius / focus).max(0.0)
                    } else {
                        f64::INFINITY
                    }
                })
            };
            [1e9, 1e150, 1e300].map(miss).into_iter().fold(0.0, f64::max)
        },
    },
    Case {
        name: "A point in the plane of focus, seen through the whole aperture",
        naive: "a circle of confusion of the size of rounding crosses a pixel's edge",
        here: "the camera's connection is the exact inverse of its ray",
        measured: "aperture points that see it in another pixel, of 48 × 36 × 25",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let camera = camera(thin(3.0, 10.0));
            let mut wrong = 0_u32;
            for pixel in 0..48 * 36 {
                let film = DVec2::new(f64::from(pixel % 48) + 0.5, f64::from(pixel / 48) + 0.5);
                let chief = camera.ray(film, [0.5; 2]);
                let point = chief.at(3.0 / chief.direction.dot(DVec3::NEG_Z));
                let seen = |lens| {
                    camera
                        .connect(point, lens)
                        .is_some_and(|connection| camera.pixel_at(connection.film) == Some(pixel))
                };
                wrong += openings().filter(|&lens| !seen(lens)).count() as u32;
            }
            f64::from(wrong)
        },
    },
    Case {
        name: "A film of one pixel, and of 1 × 100,000, the largest length",
        naive: "an aspect ratio of 100,000 leaves blocks empty; neighbours of a pixel do not exist",
        here: "rows are the units of work; missing neighbours are handled",
        measured: "relative error of the mean Y under a uniform sky, with all pixels within 20 %",
        bound: Bound::AtMost(5e-3),
        pace: Pace::Fast,
        measure: || f64::max(sky_error([1, 1]), sky_error([1, 100_000])),
    },
    Case {
        name: "A shutter that opens and closes at the same instant",
        naive: "an exposure of 0 s gives 0/0",
        here: "a picture is the mean over the shutter interval, which may be a single instant",
        measured: "pixels that differ from a render without a shutter",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let still = scene(json!({ "pinhole": { "fov": 40 } }));
            let mut moment = still.clone();
            moment["camera"]["shutter"] = json!({ "open": 0.5, "close": 0.5 });
            let picture = |scene: &Value| render(scene, Integrator::Photon, 2).picture.xyz;
            picture(&still).iter().zip(&picture(&moment)).filter(|(a, b)| a != b).count() as f64
        },
    },
    Case {
        name: "Keyframes at equal times, rotations of 180° and 360° between two keyframes, a scale that crosses 0",
        naive: "0/0 between the times; the shortest arc of a full turn is no rotation; an object is flat for an instant",
        here: "refused with the keyframe's position in the scene, because the direction of rotation is ambiguous",
        measured: "scenes not refused with the keyframe's name, of 4",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let turned = |degrees: f64| json!([{ "rotate": { "axis": [0, 1, 0], "degrees": degrees } }]);
            let key = |time: f64, transform: Value| json!({ "time": time, "transform": transform });
            let scaled = |scale: f64| json!([{ "scale": scale }]);
            let ways = [
                [key(0.5, turned(0.0)), key(0.5, turned(10.0))],
                [key(0.0, turned(0.0)), key(1.0, turned(180.0))],
                [key(0.0, turned(0.0)), key(1.0, turned(360.0))],
                [key(0.0, scaled(1.0)), key(1.0, scaled(-1.0))],
            ];
            let taken = ways.into_iter().filter(|way| {
                let mut scene = scene(json!({ "pinhole": { "fov": 40 } }));
                scene["objects"][0]["motion"] = json!(way);
                let read = format::parse(scene.to_string(), "moving.json".as_ref(), &[]);
                let resolved = read.and_then(|(file, source)| resolve(&file, &source));
                !resolved.is_err_and(|error| error.to_string().contains("objects[0].motion[1]"))
            });
            taken.count() as f64
        },
    },
];

fn thin(focus: f64, defocus_angle: f64) -> Value {
    json!({ "thin": { "fov": 40, "focus_distance": focus, "defocus_angle": defocus_angle } })
}

/// A camera at the origin that looks along −z at the rest of the scene.
fn scene(lens: Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": lens },
        "film": { "width": 48, "height": 36 },
        "materials": { "grey": diffuse(0.5) },
        "objects": [{ "shape": { "sphere": { "radius": 1, "center": [0, 0, 0] } }, "material": "grey", "transform": [{ "translate": [0, -2, 0] }] },
            { "shape": { "sphere": { "radius": 1, "center": [0, 2, 0] } }, "material": "grey" }],
        "lights": [{ "point": { "at": [0, 0, 4], "spectrum": 1, "power": 10 } }],
        "render": { "photons": 200 }
    })
}

fn camera(lens: Value) -> Camera {
    job(&scene(lens)).scene.camera
}

/// Points of the aperture, including its rim.
fn openings() -> impl Iterator<Item = [f64; 2]> {
    (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5)].map(|u| (u / 4.0).min(1.0 - f64::EPSILON)))
}

/// Returns the worst value of a measure over rays from all parts of the film and the aperture.
fn worst_ray(measure: impl Fn(DVec2, [f64; 2]) -> f64) -> f64 {
    let films = (0..100).map(|i| DVec2::new(f64::from(i % 10) * 5.33, f64::from(i / 10) * 4.0));
    films
        .flat_map(|film| openings().map(move |lens| (film, lens)))
        .map(|(film, lens)| measure(film, lens))
        .fold(0.0, f64::max)
}

/// Returns the relative error of the mean Y if the camera sees only a uniform sky of 1 cd/m².
fn sky_error([width, height]: [u32; 2]) -> f64 {
    let mut scene = scene(json!({ "pinhole": { "fov": 10 } }));
    scene["film"] = json!({ "width": width, "height": height });
    scene["lights"] = json!([{ "environment": { "spectrum": 1, "illuminance": std::f64::consts::PI } }]);
    let pixels = width * height;
    let picture = render(&scene, Integrator::Photon, u64::from((1 << 20) / pixels).min(2048)).picture;
    assert!(picture.xyz.len() == pixels as usize && picture.xyz.iter().all(|xyz| (0.8..1.2).contains(&xyz[1])));
    (picture.mean_y() - 1.0).abs()
}
