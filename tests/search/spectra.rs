//! Random spectra of lights, reflectances, indices of refraction and coefficients of media.

use crate::random::Pcg;
use serde_json::{Value, json};

/// Returns the spectrum of a light: continuous, with lines, or both.
pub(crate) fn light(rng: &mut Pcg) -> Value {
    const CONTINUOUS: [&str; 8] = ["D65", "A", "E", "D50", "LED-B3", "LED-V1", "C", "HP3"];
    const LINES: [&str; 8] = [
        "FL11",
        "FL2",
        "sodium-low-pressure",
        "mercury-medium-pressure",
        "laser-rgb",
        "neon-glow",
        "HP1",
        "hydrogen-balmer",
    ];
    match rng.below(8) {
        0 | 1 => json!(rng.pick(&CONTINUOUS)),
        2 => json!(rng.pick(&LINES)),
        3 => json!({ "blackbody": { "temperature": rng.between(1800.0, 12000.0) } }),
        4 => json!({ "gaussian": { "peak_nm": rng.between(430.0, 660.0), "fwhm_nm": rng.between(5.0, 120.0) } }),
        5 => {
            let lines: Vec<Value> = (0..1 + rng.below(4))
                .map(|_| json!({ "nm": rng.between(420.0, 680.0), "power": rng.between(0.2, 1.0) }))
                .collect();
            json!({ "lines": lines })
        }
        6 => json!({ "rgb": [rng.between(0.1, 1.0), rng.between(0.1, 1.0), rng.between(0.1, 1.0)] }),
        _ => json!({ "mix": [
            { "spectrum": rng.pick(&CONTINUOUS), "weight": rng.between(0.1, 1.0) },
            { "spectrum": { "lines": [{ "nm": rng.between(430.0, 660.0), "power": 1 }] }, "weight": rng.between(0.1, 1.0) }
        ] }),
    }
}

/// Returns a reflectance up to about `highest`.
pub(crate) fn reflectance(rng: &mut Pcg, highest: f64) -> Value {
    const NAMES: [&str; 6] =
        ["colorchecker/red", "colorchecker/blue", "colorchecker/yellow", "leaf/green", "TCS12", "colorchecker/orange"];
    match rng.below(5) {
        0 | 1 => json!(rng.between(0.1, highest)),
        2 => json!({ "rgb": [rng.between(0.02, highest), rng.between(0.02, highest), rng.between(0.02, highest)] }),
        3 => json!(rng.pick(&NAMES)),
        _ => {
            let edge = rng.between(470.0, 620.0);
            let [low, high] = [rng.between(0.03, 0.3), rng.between(0.3, highest)];
            let values = if rng.chance(0.5) { [low, low, high, high] } else { [high, high, low, low] };
            json!({ "table": { "nm": [360, edge, edge + 15.0, 830], "values": values } })
        }
    }
}

/// Returns an index of refraction, dispersive or constant.
pub(crate) fn index(rng: &mut Pcg) -> Value {
    const NAMES: [&str; 8] =
        ["N-BK7", "N-SF10", "SF11", "water 20C", "diamond", "fused silica", "PMMA", "sapphire (o)"];
    match rng.below(5) {
        0 | 1 => json!(rng.between(1.05, 2.2)),
        2 | 3 => json!(rng.pick(&NAMES)),
        _ => json!({ "cauchy": { "a": rng.between(1.3, 1.7), "b": rng.log_between(0.003, 0.05) } }),
    }
}

/// Returns a coefficient spectrum whose value is about `value`.
pub(crate) fn coefficient(rng: &mut Pcg, value: f64) -> Value {
    match rng.below(4) {
        0 | 1 => json!(value),
        2 => {
            json!({ "power_law": { "reference_nm": 550, "value": value, "exponent": rng.pick(&[-4.0, -1.0, 2.0]) } })
        }
        _ => {
            let edge = rng.between(470.0, 620.0);
            let [low, high] = [value * rng.between(0.05, 1.0), value * rng.between(1.0, 2.0)];
            let values = if rng.chance(0.5) { [low, low, high, high] } else { [high, high, low, low] };
            json!({ "table": { "nm": [360, edge, edge + 15.0, 830], "values": values } })
        }
    }
}
