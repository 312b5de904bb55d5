//! A picture with spectral bands that lights another scene.

use crate::abbe_command::abbe;
use abbe_session::output::exr;
use serde_json::json;
use std::path::Path;

/// The number of bands, each 47 nm wide.
const BANDS: usize = 10;

/// Renders a scene in which a light fills the picture, and returns the mean radiance of each band
/// over all pixels in W/m²/sr/nm.
fn bands_of(folder: &Path, name: &str, lights: serde_json::Value, objects: serde_json::Value) -> Vec<f64> {
    let scene = json!({
        "camera": {"from": [0, 0, 0], "at": [0, 0, -1], "lens": {"pinhole": {"fov": 40}}},
        "film": {"width": 8, "height": 4, "spectral_bands": BANDS},
        "materials": {"black": "absorber"}, "objects": objects, "lights": lights,
        "render": {"passes": 256, "photons": 50}
    });
    std::fs::write(folder.join(format!("{name}.json")), scene.to_string()).unwrap();
    let said = abbe(folder, &["render", &format!("{name}.json"), "--quiet"]);
    assert_eq!(said.status, 0, "{}", said.err);
    let bands = exr::read(&folder.join(format!("{name}.exr"))).unwrap().picture.bands.unwrap();
    let mean =
        |band: usize| bands.values.iter().skip(band).step_by(BANDS).map(|value| f64::from(*value)).sum::<f64>() / 32.0;
    (0..BANDS).map(mean).collect()
}

/// The picture of a coloured light becomes the environment of another scene, whose picture has the
/// same radiance in each band. An upsampled colour would not: it is smooth, and has no dark bands.
#[test]
fn a_picture_with_bands_lights_a_scene_with_its_radiances() {
    let folder = tempfile::tempdir().unwrap();
    let wall = json!([{"shape": {"rectangle": {"width": 60, "height": 60}}, "material": "black",
        "emission": {"spectrum": {"table": {"nm": [500, 501, 640, 641], "values": [0, 1, 3, 0]}}, "radiance": 280},
        "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, 0, -3]}]}]);
    let lamp = bands_of(folder.path(), "lamp", json!([]), wall);
    let lit = json!([{"environment": {"image": "lamp.exr"}}]);
    let seen = bands_of(
        folder.path(),
        "seen",
        lit,
        json!([{"shape": {"sphere": {"radius": 0.1}}, "material": "black",
        "transform": [{"translate": [0, 0, 9]}]}]),
    );
    // The bands from 548 to 642 nm are bright, and those beside them dark.
    assert!(lamp[4] > 1.0 && lamp[5] > 1.5 && lamp[7] == 0.0 && lamp[1] == 0.0, "{lamp:?}");
    for (band, (lamp, seen)) in lamp.iter().zip(&seen).enumerate() {
        assert!((seen - lamp).abs() <= 0.02 * lamp + 0.005, "band {band}: {seen} instead of {lamp}");
    }
}
