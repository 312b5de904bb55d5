//! Light of two lines is the sum of the light of each line. A picture in monochromatic light needs
//! no weights between wavelengths, so it checks the weights of a picture in mixed light.

use crate::common::compare::Measured;
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// Wavelengths in nm, one in each of the two bands of the film.
const LINES: [f64; 2] = [450.0, 650.0];

/// A layer of fog between the sun and a floor. Most light is scattered several times before it
/// reaches the floor. The fog scatters backward at one line and forward at the other. The light has
/// these lines, each with the same irradiance.
fn floor_below_fog(lines: &[f64]) -> Value {
    let spectrum: Vec<Value> = lines.iter().map(|nm| json!({ "nm": nm, "power": 1 })).collect();
    let by_line = |values: [f64; 2]| json!({ "table": { "nm": LINES, "values": values } });
    json!({
        "camera": { "from": [0, 0.9, 0.7], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 4, "height": 4, "spectral_bands": 2 },
        "media": { "fog": { "homogeneous": { "absorption": 0, "scattering": by_line([2.0, 1.5]),
            "phase": { "henyey_greenstein": { "g": by_line([-0.6, 0.6]) } } } } },
        "materials": { "fog": { "boundary": { "medium": "fog" } }, "grey": { "diffuse": { "reflectance": 0.3 } } },
        "objects": [
            { "shape": { "box": { "size": [8, 1, 8] } }, "material": "fog", "transform": [{ "translate": [0, 1.6, 0] }] },
            { "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "grey" }
        ],
        "lights": [{ "directional": { "toward": [0, -1, 0], "spectrum": { "lines": spectrum }, "irradiance": lines.len() } }],
        "render": { "photons": 20000, "radius": 0.2 }
    })
}

/// Returns the mean radiance of each band.
fn bands(rendered: &Rendered) -> Vec<f64> {
    let values = &rendered.picture.bands.as_ref().expect("bands").values;
    [0, 1].map(|band| values.iter().skip(band).step_by(2).map(|&value| f64::from(value)).sum()).to_vec()
}

/// Checks that each band of a scene in the light of both lines has the radiance of its line alone.
fn check(scene: impl Fn(&[f64]) -> Value, way: (Integrator, u64), noise: f64) {
    let both = Measured::new(&scene(&LINES), way, 0..6, bands);
    for (band, nm) in LINES.into_iter().enumerate() {
        let alone = Measured::new(&scene(&[nm]), way, 8..14, bands);
        let ratio = both.mean(band) / alone.mean(band);
        let error = (both.error(band) / both.mean(band)).hypot(alone.error(band) / alone.mean(band));
        println!("{nm} nm below coloured fog, {:?}: {ratio:.4} ± {error:.4} of the line alone", way.0);
        assert!(error < noise, "too noisy to tell");
        assert!((ratio - 1.0).abs() < 4.0 * error, "{nm} nm, {:?}: {ratio} ± {error}", way.0);
    }
}

#[test]
#[ignore = "nightly: 40 seconds of CPU time"]
fn two_lines_pass_coloured_fog_as_each_line_alone() {
    check(floor_below_fog, (Integrator::Photon, 12), 0.04);
    check(floor_below_fog, (Integrator::Path, 128), 0.025);
}
