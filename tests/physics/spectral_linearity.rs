//! Light of two lines is the sum of the light of each line. A picture in monochromatic light needs
//! no weights between wavelengths, so it checks the weights of a picture in mixed light.

use crate::common::compare::Measured;
use abbe::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// Wavelengths in nm, one in each of the two bands of the film.
const LINES: [f64; 2] = [450.0, 650.0];

/// A ball of fog in light from above, seen from the side. The fog scatters much blue light
/// backward, and less red light forward. The light has these lines, each with the same irradiance.
fn ball(lines: &[f64]) -> Value {
    let spectrum: Vec<Value> = lines.iter().map(|nm| json!({ "nm": nm, "power": 1 })).collect();
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 18 } } },
        "film": { "width": 4, "height": 4, "spectral_bands": 2 },
        "media": { "drops": { "homogeneous": { "absorption": 0, "scattering": { "table": { "nm": LINES, "values": [2, 0.8] } },
            "phase": { "henyey_greenstein": { "g": { "table": { "nm": LINES, "values": [-0.4, 0.5] } } } } } } },
        "materials": { "drops": { "boundary": { "medium": "drops" } } },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "drops" }],
        "lights": [{ "directional": { "toward": [0.2, -1, 0], "spectrum": { "lines": spectrum }, "irradiance": lines.len() } }],
        "render": { "photons": 5000, "radius": 0.15 }
    })
}

/// The same ball in front of a wide light, which scattered paths hit. The fog scatters forward at
/// one line and backward at the other.
fn ball_before_a_wide_light(lines: &[f64]) -> Value {
    let mut scene = ball(lines);
    let light = &mut scene["lights"][0]["directional"];
    light["toward"] = json!([0, -1, 0.6]);
    light["angular_diameter"] = json!(70);
    scene["media"]["drops"]["homogeneous"]["phase"] =
        json!({ "henyey_greenstein": { "g": { "table": { "nm": LINES, "values": [-0.7, 0.7] } } } });
    scene
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
        println!("{nm} nm in coloured drops, {:?}: {ratio:.4} ± {error:.4} of the line alone", way.0);
        assert!(error < noise, "too noisy to tell");
        assert!((ratio - 1.0).abs() < 3.0 * noise, "{nm} nm, {:?}: {ratio}", way.0);
    }
}

#[test]
fn two_lines_scatter_in_coloured_drops_as_each_line_alone() {
    check(ball, (Integrator::Photon, 48), 0.03);
    check(ball, (Integrator::Path, 512), 0.045);
}

/// A path follows the phase functions of all its wavelengths, so each wavelength needs its weight.
#[test]
fn paths_weight_each_line_by_its_phase_function() {
    check(ball_before_a_wide_light, (Integrator::Path, 96), 0.07);
}
