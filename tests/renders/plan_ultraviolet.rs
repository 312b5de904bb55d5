//! The effect `ultraviolet`: on if a fluorescent object absorbs light of the scene below 360 nm, off
//! otherwise, and without events if it is forbidden.

use super::common::{job, render_job};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// A floor and a lamp. The lamp emits from `lamp_from_nm` on, and the dye of the floor absorbs from
/// `dye_from_nm` on. In the band, the spectra do not depend on these numbers.
fn floor(lamp_from_nm: f64, dye_from_nm: f64, forbid: &[&str]) -> Value {
    let table = |from: f64, values: [f64; 3]| match from {
        360.0 => json!({ "table": { "nm": [360, 420, 830], "values": values } }),
        _ => {
            json!({ "table": { "nm": [from, 360, 420, 830], "values": [values[0], values[0], values[1], values[2]] } })
        }
    };
    let dye = json!({ "fluorescent": {
        "reflectance": 0.8, "absorptance": table(dye_from_nm, [0.5, 0.0, 0.0]), "quantum_yield": 0.9,
        "emission": { "table": { "nm": [420, 450, 500], "values": [0, 1, 0] } }
    } });
    json!({
        "camera": { "from": [0, 2, 5], "at": [0, 0.6, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 16, "height": 16, "spectral_bands": 8 },
        "materials": { "dye": dye, "grey": { "diffuse": { "reflectance": 0.5 } } },
        "objects": [
            { "shape": { "sphere": { "radius": 0.6, "center": [0, 0.61, 0] } }, "material": "grey" },
            { "shape": { "rectangle": { "width": 8, "height": 8 } }, "material": "dye" }
        ],
        "lights": [{ "point": { "at": [1, 4, 2], "spectrum": table(lamp_from_nm, [1.0, 2.0, 1.0]), "power": 10 } }],
        "render": { "photons": 2000, "forbid": forbid }
    })
}

#[test]
fn ultraviolet_is_planned_only_where_a_dye_absorbs_it() {
    let rendered = |scene: &Value, integrator| render_job(&job(scene), integrator, 2);
    let effect = |scene: &Value| {
        let found = rendered(scene, Integrator::Photon).stats.effects["ultraviolet"].clone();
        (found.state, found.events)
    };
    let (state, events) = effect(&floor(320.0, 300.0, &[]));
    assert!(state == "on" && events > 0, "{state}, {events} events");
    for (lamp_nm, dye_nm) in [(360.0, 300.0), (320.0, 360.0), (360.0, 360.0)] {
        assert_eq!(effect(&floor(lamp_nm, dye_nm, &[])), ("off".to_string(), 0), "{lamp_nm}, {dye_nm} nm");
    }
    let forbidden = floor(320.0, 300.0, &["ultraviolet"]);
    assert_eq!(effect(&forbidden), ("forbidden".to_string(), 0));
    // Data below 360 nm change no bit of a scene that does not call for ultraviolet.
    for integrator in [Integrator::Photon, Integrator::Path] {
        let xyz = |scene: &Value| rendered(scene, integrator).picture.xyz;
        let without = xyz(&floor(360.0, 360.0, &[]));
        assert!(without == xyz(&forbidden) && without == xyz(&floor(320.0, 360.0, &[])), "{integrator:?}");
        assert_ne!(without, xyz(&floor(320.0, 300.0, &[])), "{integrator:?}");
    }
}

/// The first spectral band ends at 419 nm, and the dye emits from 420 nm on. Photons below 360 nm
/// therefore add nothing to this band, although the walls of a closed room reflect them.
#[test]
fn spectral_bands_contain_no_ultraviolet() {
    let first_band = |forbid: &[&str]| {
        let mut room = floor(320.0, 300.0, forbid);
        room["camera"] =
            json!({ "from": [0.3, 0.2, 0.1], "at": [-1, -0.3, 0.2], "lens": { "pinhole": { "fov": 60 } } });
        room["objects"] = json!([{ "shape": { "sphere": { "radius": 1 } }, "material": "dye" }]);
        room["lights"][0]["point"]["at"] = json!([0, 0, 0]);
        room["render"]["photons"] = json!(20000);
        let bands = render_job(&job(&room), Integrator::Photon, 8).picture.bands.expect("the film has bands");
        bands.values.iter().step_by(8).map(|value| f64::from(*value)).sum::<f64>()
    };
    let [with, without] = [first_band(&[]), first_band(&["ultraviolet"])];
    println!("first band: {with} with ultraviolet, {without} without");
    assert!(without > 0.0 && (with / without - 1.0).abs() < 0.03, "{with} for {without}");
}
