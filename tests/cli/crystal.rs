//! `abbe crystal`, and the amplitudes of `abbe film`.

use crate::abbe_command::abbe;
use crate::common::near::{assert_near, number};
use crate::golden::golden;
use serde_json::Value;

#[test]
fn a_crystal_has_its_golden_indices_and_colours() {
    let folder = tempfile::tempdir().unwrap();
    let file = golden("birefringence.json");
    let row = &file["indices"][0];
    let list = row["wavelength_nm"].as_array().unwrap().iter().map(Value::to_string).collect::<Vec<_>>().join(",");
    let calcite = abbe(folder.path(), &["crystal", "Calcite", "--at", &list, "--json"]).json();
    for (i, found) in calcite["index"].as_array().unwrap().iter().enumerate() {
        assert_near("n_o", &found["n_o"], &row["n_o"][i], 1e-9);
        assert_near("n_e", &found["n_e"], &row["n_e"][i], 1e-9);
        assert_near("n_e - n_o", &found["birefringence"], &row["n_e_minus_n_o"][i], 1e-9);
    }
    // At normal incidence, the golden refraction has the axis at 45° to the wave vector.
    let known = &file["refraction"][0]["e"];
    let sodium = abbe(folder.path(), &["crystal", "calcite", "--at", "589.2938", "--json"]).json();
    assert_near("walk-off", &sodium["index"][0]["walk_off_deg"], &known["walk_off_deg"], 1e-7);
    assert_near("index", &sodium["index"][0]["n_wave"], &known["n"], 1e-9);
    let strip = &file["michel_levy"][2];
    let thickness = strip["thickness_um"].as_array().unwrap().iter().map(Value::to_string).collect::<Vec<_>>();
    let arguments = ["crystal", "quartz", "--lamp", "A", "--thickness", &thickness.join(","), "--json"];
    let found = abbe(folder.path(), &arguments).json()["michel_levy"].clone();
    assert_eq!(found["lamp"], "A");
    for (i, plate) in found["plates"].as_array().unwrap().iter().enumerate() {
        assert_near("path", &plate["path_difference_nm"], &strip["retardance_nm_at_D"][i], 1e-6);
        assert_near("XYZ", &plate["xyz"], &strip["crossed"]["XYZ"][i], 1e-6);
    }
}

#[test]
fn the_strip_of_a_crystal_is_printed_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["strip.png", "strip.svg"] {
        let said = abbe(folder.path(), &["crystal", "quartz", "-o", name]);
        assert_eq!(said.status, 0, "{}", said.err);
        assert!(said.out.contains("between crossed polarisers under D65") && said.out.contains("#000000"));
    }
    let svg = std::fs::read_to_string(folder.path().join("strip.svg")).unwrap();
    assert!(svg.contains("quartz between crossed polarisers under D65"));
    let picture = image::open(folder.path().join("strip.png")).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (1250, 120));
    // Black at 0, and the purple of the first order near 550 nm.
    assert!(picture.get_pixel(0, 60).0.iter().all(|&code| code < 3));
    let [r, g, b] = picture.get_pixel(275, 60).0;
    assert!(r > g && b > g, "{r} {g} {b}");
}

#[test]
fn crystals_are_listed_and_wrong_requests_refused() {
    let folder = tempfile::tempdir().unwrap();
    let list = abbe(folder.path(), &["crystal", "--list"]).out;
    assert_eq!(list.lines().count(), 6);
    for name in list.lines() {
        assert_eq!(abbe(folder.path(), &["crystal", name]).status, 0, "{name}");
    }
    for (arguments, what) in [
        (&["crystal", "calcit"][..], "did you mean \"calcite\""),
        (&["crystal", "calcite", "--at", "5000"], "wavelengths from 204 to 2172 nm"),
        (&["crystal", "calcite", "-o", "strip.gif"], "a name that ends in .png or .svg"),
        (&["crystal", "calcite", "--thickness", "thin"], "a thickness in µm"),
    ] {
        let said = abbe(folder.path(), arguments);
        assert_eq!(said.status, 2, "{arguments:?}");
        assert!(said.err.contains(what), "{arguments:?}: {}", said.err);
    }
}

/// The golden file has fields that vary as exp(+iωt), so its amplitudes are the complex conjugates.
#[test]
fn amplitudes_of_a_film_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let stack = r#"{"layers": [{"ior": "MgF2", "thickness_nm": 99.8}], "substrate": "N-BK7"}"#;
    let arguments = ["film", stack, "--angle", "45", "--wavelengths", "550"];
    let found = abbe(folder.path(), &[&arguments[..], &["--json"]].concat()).json()["angles"][0].clone();
    let films = golden("polarisation.json")["films"].as_array().unwrap().clone();
    for (case, key) in films.iter().zip(["reflected_field", "transmitted_field"]) {
        for (name, amplitude) in [("s", "amplitude_s"), ("p", "amplitude_p")] {
            let known = [number(&case[amplitude][0]), -number(&case[amplitude][1])];
            assert_near(key, &found[key][name][0], known, 1e-9);
            let phase = known[1].atan2(known[0]).to_degrees();
            assert_near(key, &found[key][format!("phase_{name}_deg")][0], phase, 1e-6);
        }
    }
    let (s, p) = (&films[0]["amplitude_s"], &films[0]["amplitude_p"]);
    let length = |pair: &Value| number(&pair[0]).hypot(number(&pair[1]));
    let psi = length(p).atan2(length(s)).to_degrees();
    assert_near("Ψ", &found["ellipsometry"]["psi_deg"][0], psi, 1e-7);
    assert_near("Δ", &found["ellipsometry"]["delta_deg"][0], &films[0]["delta_deg"], 1e-7);
    let text = abbe(folder.path(), &arguments).out;
    assert!(text.contains("Ψ°") && text.contains(" 164.66"), "{text}");
}
