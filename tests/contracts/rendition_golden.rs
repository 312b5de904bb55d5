//! Colour rendition of TM-30 against colour-science.
//!
//! Colour-science takes the step of the light, 1 nm or 5 nm, and so does Abbe. For steps of 1 nm,
//! colour-science has samples every 1 nm, and Abbe interpolates samples of 5 nm.

use crate::golden::golden;
use abbe_spectra::colour::rendition;
use abbe_spectra::spectrum::{SpectralLine, Spectrum, library};
use serde_json::Value;

/// The tolerances of Rf and Rg, of the local fidelity and chroma shift, and of the hue shift.
const INDEX: f64 = 0.05;
const LOCAL: f64 = 0.2;
const HUE_SHIFT: f64 = 0.002;

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The largest difference between a list and its golden values.
fn largest(found: &[f64], known: &Value) -> f64 {
    let known = known.as_array().expect("a list");
    assert_eq!(found.len(), known.len());
    found.iter().zip(known).map(|(found, known)| (found - number(known)).abs()).fold(0.0, f64::max)
}

/// Returns what differs by more than its tolerance.
fn faults(name: &str, light: &Spectrum, known: &Value) -> Vec<String> {
    let found = rendition(light).unwrap();
    let mut differences = vec![
        ("rf", (found.rf - number(&known["rf"])).abs(), INDEX),
        ("rg", (found.rg - number(&known["rg"])).abs(), INDEX),
        ("rf_bins", largest(&found.rf_bins, &known["rf_bins"]), LOCAL),
        ("chroma_shift", largest(&found.chroma_shift_percent, &known["chroma_shift_percent"]), LOCAL),
        ("hue_shift", largest(&found.hue_shift, &known["hue_shift"]), HUE_SHIFT),
    ];
    if let Some(samples) = known.get("samples") {
        differences.push(("samples", largest(&found.samples, samples), LOCAL));
    }
    let mut faults = Vec::new();
    for (what, difference, tolerance) in differences {
        if difference > tolerance {
            faults.push(format!("{name}: {what} differs by {difference:.4}"));
        }
    }
    faults
}

#[test]
fn every_lamp_has_its_colour_rendition() {
    let golden = golden("rendition.json");
    let lamps = golden["library"].as_object().unwrap();
    assert!(lamps.len() >= 90);
    let wrong: Vec<String> =
        lamps.iter().flat_map(|(name, known)| faults(name, &library::find(name).unwrap().spectrum, known)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn black_bodies_have_their_colour_rendition() {
    let golden = golden("rendition.json");
    let bodies = golden["blackbodies_K"].as_object().unwrap();
    let wrong: Vec<String> = bodies
        .iter()
        .flat_map(|(kelvin, known)| faults(kelvin, &Spectrum::blackbody(kelvin.parse().unwrap()).unwrap(), known))
        .collect();
    assert!(bodies.len() == 6 && wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn laser_lines_have_their_colour_rendition() {
    let golden = golden("rendition.json");
    let lights = golden["lines"].as_object().unwrap();
    assert_eq!(lights.len(), 3);
    let mut wrong = Vec::new();
    for (name, known) in lights {
        let powers = known["powers"].as_object().unwrap();
        let lines: Vec<SpectralLine> = powers
            .iter()
            .map(|(nm, power)| SpectralLine { nm: nm.parse().unwrap(), power: number(power), fwhm_nm: None })
            .collect();
        wrong.extend(faults(name, &Spectrum::lines(&lines).unwrap(), known));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
