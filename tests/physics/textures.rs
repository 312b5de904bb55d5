//! Textured surfaces: conservation of energy, the mean of a picture, and the two integrators.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, glass, overhead_camera, render};
use crate::furnace;
use abbe_session::render::Integrator;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// A white surface stays white if its reflectance, its roughness and the weights of its components
/// are textures.
#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn a_white_textured_ball_is_a_furnace() {
    let white = json!({ "checker": { "a": 1, "b": { "noise": { "a": 1, "b": 1, "scale": 3 } }, "scale": 7 } });
    let roughness = json!({ "noise": { "a": 0.2, "b": 0.9, "scale": 4 } });
    let mask = |range: [f64; 2]| json!({ "image": { "path": "textures/tiles.png", "range": range } });
    let scene = json!({
        "camera": { "from": [0, 0.4, 3], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 8, "height": 8 },
        "materials": {
            "paper": diffuse(white.clone()),
            "metal": { "conductor": { "reflectance": white.clone(), "roughness": roughness } },
            "sheet": { "translucent": { "reflectance": { "stripes": { "a": 0.2, "b": 0.8, "scale": 5 } }, "transmittance": 0.2 } },
            "mirror": { "mirror": { "reflectance": white } },
            "mixed": { "mix": [
                { "material": "paper", "weight": mask([0.0, 1.0]) },
                { "material": "metal", "weight": mask([1.0, 0.0]) },
                { "material": "mirror", "weight": 0.2 }
            ] }
        },
        "objects": [{ "shape": { "sphere": { "radius": 0.8 } }, "material": "mixed" }],
        "lights": furnace::surroundings(),
        "render": { "photons": 4000, "radius": 0.3 }
    });
    furnace::check("textured ball", &scene, (Integrator::Photon, 16));
    furnace::check("textured ball", &scene, (Integrator::Path, 64));
}

/// A square of side 2 with a picture, seen from above. A perfect diffuser has 100 cd/m².
fn textured_plane(pixels: usize, repeats: f64) -> Value {
    let picture = json!({ "image": { "path": "textures/tiles.png", "uv": { "scale": [repeats, repeats] } } });
    json!({
        "camera": overhead_camera([0.0, 0.0], 10.0, 2.0),
        "film": { "width": pixels, "height": pixels },
        "materials": { "picture": diffuse(picture) },
        "objects": [{ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "picture" }],
        "lights": [{ "directional": { "toward": [0, -1, 0], "spectrum": "D65", "illuminance": 100.0 * PI } }],
        "render": { "photons": 100 }
    })
}

/// Returns XYZ of the mean of the picture under D65, with Y = 100 for white. The values of sRGB are
/// decoded by the formulas of IEC 61966-2-1.
fn mean_of_tiles() -> [f64; 3] {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/textures/tiles.png");
    let picture = image::open(path).expect("a picture").into_rgb8();
    let linear = |value: u8| {
        let encoded = f64::from(value) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    let mut mean = [0.0; 3];
    for pixel in picture.pixels() {
        (0..3).for_each(|i| mean[i] += linear(pixel.0[i]) * 100.0 / f64::from(picture.width() * picture.height()));
    }
    let [r, g, b] = mean;
    [
        0.4124564 * r + 0.3575761 * g + 0.1804375 * b,
        0.2126729 * r + 0.7151522 * g + 0.0721750 * b,
        0.0193339 * r + 0.1191920 * g + 0.9503041 * b,
    ]
}

/// Checks that the mean of the pixels is within 0.5 % of the expected XYZ values.
fn assert_mean(name: &str, pixels: &[[f64; 3]], expected: [f64; 3]) {
    for c in 0..3 {
        let mean = pixels.iter().map(|xyz| xyz[c]).sum::<f64>() / pixels.len() as f64;
        println!("{name}, channel {c}: {mean:.3} for {:.3}", expected[c]);
        assert!((mean / expected[c] - 1.0).abs() < 0.005, "{name}: {mean} for {}", expected[c]);
    }
}

/// The mean of a rendered textured plane equals the mean of the picture in XYZ within 0.5 %. The
/// texels are larger than a pixel, about as large, or much smaller.
#[test]
fn a_textured_plane_has_the_mean_of_its_picture() {
    let expected = mean_of_tiles();
    for (pixels, repeats, passes) in [(96, 1.0, 24), (32, 1.0, 48), (16, 8.0, 96)] {
        let picture = render(&textured_plane(pixels, repeats), Integrator::Photon, passes).picture;
        assert_mean(&format!("{pixels} pixels, {repeats} repeats"), &picture.xyz, expected);
    }
}

/// A lamp behind a slide shows the mean of the picture in XYZ within 0.5 %, if each pixel covers
/// many texels.
#[test]
fn a_slide_has_the_mean_of_its_picture() {
    let expected = mean_of_tiles();
    let slide = json!({ "image": { "path": "textures/tiles.png", "uv": { "scale": [3, 3] } } });
    let scene = json!({
        "camera": overhead_camera([0.0, 0.0], 10.0, 2.0),
        "film": { "width": 16, "height": 16 },
        "materials": { "black": "absorber" },
        "objects": [{ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "black",
                      "emission": { "spectrum": "D65", "luminance": 100, "slide": slide } }],
        "render": { "photons": 100 }
    });
    for integrator in [Integrator::Photon, Integrator::Path] {
        let picture = render(&scene, integrator, 192).picture;
        assert_mean(&format!("{integrator:?}"), &picture.xyz, expected);
    }
}

/// Checks that photons and camera paths see the same light. The kernels of the photons are
/// extrapolated to radius 0.
pub(crate) fn assert_integrators_agree(name: &str, scene: &Value) {
    assert_integrators_agree_after(16, name, scene, 1e-2);
}

/// Does the same as [`assert_integrators_agree`] with this number of passes with photons, and eight
/// times as many with camera paths. The standard errors relative to the mean must be below `noise`.
pub(crate) fn assert_integrators_agree_after(passes: u64, name: &str, scene: &Value, noise: f64) {
    let photon = Measured::extrapolated_photons(scene, 0.1, passes, colour_blocks(8));
    let path = Measured::new(scene, (Integrator::Path, 8 * passes), 100..108, colour_blocks(8));
    assert_same(&format!("{name}, photon against path"), &photon, &path, noise);
}

/// A glass ball on a grey floor under a large lamp: the floor receives direct light, and the light
/// that the ball focuses. The lamp is the last object.
pub(crate) fn ball_under_a_lamp() -> Value {
    json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 32, "height": 32 },
        "materials": { "grey": diffuse(json!(0.7)), "black": "absorber", "glass": glass(1.5) },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "grey" },
            { "shape": { "sphere": { "radius": 1, "center": [0, 1.01, 0] } }, "material": "glass" },
            { "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 8000 }
    })
}

/// A lamp with coloured stripes above a glass ball.
#[test]
#[ignore = "slow: 5 seconds of CPU time"]
fn photons_and_paths_agree_under_a_lamp_with_a_slide() {
    let mut scene = ball_under_a_lamp();
    scene["objects"][2]["emission"]["slide"] =
        json!({ "stripes": { "a": { "rgb": [0.9, 0.2, 0.1] }, "b": { "rgb": [0.1, 0.3, 0.9] }, "scale": 3 } });
    assert_integrators_agree("lamp with a slide", &scene);
}

/// A glass ball above a textured floor. The path tracer does not filter textures, so the comparison
/// also tests the filter of the camera paths.
#[test]
#[ignore = "nightly: 15 seconds of CPU time"]
fn photons_and_paths_agree_on_a_textured_floor_under_a_glass_ball() {
    let mut scene = ball_under_a_lamp();
    scene["materials"]["grey"] = diffuse(
        json!({ "image": { "path": "textures/tiles.png", "wrap": "mirror", "uv": { "scale": [3, 3], "rotate": 20 } } }),
    );
    assert_integrators_agree("textured floor under a glass ball", &scene);
}

/// A floor whose normal map leans by 30° shows the illuminance on a plane that leans by 30°. The
/// lamp stands 20° from the zenith, in the direction of the lean or opposite to it. A floor without
/// the map has the same noise, so the ratio has none.
#[test]
fn a_leaning_normal_map_shades_like_a_leaning_plane() {
    let (lean, lamp) = (30.0_f64.to_radians(), 20.0_f64.to_radians());
    // On a rectangle, u increases along x, and the top of a picture points along −z.
    for (path, along) in [("textures/leaning_right.png", [1.0, 0.0]), ("textures/leaning_up.png", [0.0, -1.0])] {
        for (sign, integrator) in [(1.0, Integrator::Photon), (-1.0, Integrator::Photon), (1.0, Integrator::Path)] {
            let toward = [-sign * along[0] * lamp.sin(), -lamp.cos(), -sign * along[1] * lamp.sin()];
            let luminance = |material: &str| {
                let scene = json!({
                    "camera": overhead_camera([0.0, 0.0], 10.0, 1.0),
                    "film": { "width": 4, "height": 4 },
                    "materials": { "grey": diffuse(json!(0.5)), "map": { "normal_map": { "material": "grey", "path": path } } },
                    "objects": [{ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": material }],
                    "lights": [{ "directional": { "toward": toward, "spectrum": "D65", "illuminance": 100.0 * PI } }],
                    "render": { "photons": 100 }
                });
                render(&scene, integrator, 4).picture.xyz.iter().map(|xyz| xyz[1]).sum::<f64>()
            };
            let (found, expected) = (luminance("map") / luminance("grey"), (lean - sign * lamp).cos() / lamp.cos());
            assert!((found / expected - 1.0).abs() < 1e-4, "{path}, {sign}: {found} for {expected}");
        }
    }
}

/// A floor and a glossy ball with waves in their normal maps, and a mirror ball.
#[test]
#[ignore = "slow: 6 seconds of CPU time"]
fn photons_and_paths_agree_on_a_floor_with_a_normal_map() {
    let scene = json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 32, "height": 32 },
        "materials": {
            "black": "absorber", "paint": { "glossy": { "reflectance": 0.5, "ior": 1.5, "roughness": 0.3 } },
            "grey": diffuse(json!(0.6)), "mirror": { "mirror": { "reflectance": 0.9 } },
            "floor": { "normal_map": { "material": "grey", "path": "textures/waves.png", "uv": { "scale": [5, 5] } } },
            "ball": { "normal_map": { "material": "paint", "path": "textures/waves.png", "strength": 0.5, "green": "down" } }
        },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "floor" },
            { "shape": { "sphere": { "radius": 0.6, "center": [-0.9, 0.61, 0] } }, "material": "ball" },
            { "shape": { "sphere": { "radius": 0.6, "center": [0.9, 0.61, 0] } }, "material": "mirror" },
            { "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 8000 }
    });
    assert_integrators_agree("normal maps", &scene);
}
