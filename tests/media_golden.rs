//! Media against golden values that were computed independently, in Python, from the same published data.

#[path = "golden/close.rs"]
mod close;
mod golden;

use abbe::optics::phase::Phase;
use abbe::spectrum::Spectrum;
use close::{close, number};
use golden::golden;

#[test]
fn henyey_and_greenstein_s_function_has_its_values() {
    for check in golden("media.json")["hg_checks"].as_array().unwrap() {
        let g = number(&check["g"]);
        let phase = Phase::HenyeyGreenstein { g: Spectrum::constant(g) };
        for (degrees, expected) in check["P_at_deg"].as_object().unwrap() {
            let cos = degrees.parse::<f64>().unwrap().to_radians().cos();
            let (got, expected) = (phase.at(cos, 550.0), number(expected));
            close(&format!("g = {g} at {degrees}°"), got, expected, 1e-8 * expected);
        }
    }
}
