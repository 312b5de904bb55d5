//! `abbe film` and `abbe grating`.

use crate::abbe_command::abbe;
use crate::common::near::assert_near;
use crate::golden::golden;
use serde_json::Value;

/// Returns the position of a wavelength in the list of a result.
fn place(angle: &Value, nm: f64) -> usize {
    angle["wavelength_nm"].as_array().unwrap().iter().position(|it| it.as_f64() == Some(nm)).unwrap()
}

#[test]
fn a_stack_has_its_golden_powers_and_colours() {
    let folder = tempfile::tempdir().unwrap();
    let file = golden("thin_film.json");
    let case = &file["antireflection"][0];
    let stack =
        r#"{"incident": "air", "layers": [{"ior": "MgF2", "thickness_nm": 99.7456873132}], "substrate": "N-BK7"}"#;
    std::fs::write(folder.path().join("stack.json"), stack).unwrap();
    let from_file = abbe(folder.path(), &["film", "stack.json", "--angle", "0,45,60", "--json"]).json();
    let inline = abbe(folder.path(), &["film", stack, "--angle", "0,45,60", "--json"]).json();
    assert_eq!(from_file, inline);
    for (angle, degrees) in inline["angles"].as_array().unwrap().iter().zip([0.0, 45.0, 60.0]) {
        assert_eq!(angle["degrees"].as_f64(), Some(degrees));
        let rows = case["rows"].as_array().unwrap();
        let row = rows.iter().find(|row| row["angle_deg"].as_f64() == Some(degrees)).unwrap();
        let at = place(angle, 550.0);
        let known = &case["wavelength_nm"].as_array().unwrap().iter().position(|nm| nm == 550.0).unwrap();
        for (key, name) in [("s", "Rs"), ("p", "Rp"), ("mean", "R")] {
            assert_near(name, &angle["reflectance"][key][at], &row[name][known], 1e-9);
            let both =
                angle["reflectance"][key][at].as_f64().unwrap() + angle["transmittance"][key][at].as_f64().unwrap();
            assert_near("R + T", both, 1.0, 1e-9);
        }
        let colours = case["colour"].as_array().unwrap();
        let wanted = |colour: &&Value| colour["light"] == "D65" && colour["angle_deg"].as_f64() == Some(degrees);
        if let Some(known) = colours.iter().find(wanted) {
            assert_near("xy", &angle["xy"]["reflected"], &known["reflected"]["xy"], 1e-6);
        }
    }
    let under_a = abbe(folder.path(), &["film", stack, "--lamp", "A", "--json"]).json();
    let known = case["colour"].as_array().unwrap().iter().find(|colour| colour["light"] == "A").unwrap();
    assert_near("under A", &under_a["angles"][0]["xy"]["reflected"], &known["reflected"]["xy"], 1e-6);
}

#[test]
fn films_are_named_measured_and_plotted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("film.csv"), "nm,n,k\n360,0.2,3\n830,0.2,3\n").unwrap();
    let of = |ior: &str| {
        let stack = format!(r#"{{"layers": [{{"ior": {ior}, "thickness_nm": 30}}], "substrate": "water"}}"#);
        abbe(folder.path(), &["film", &stack, "--wavelengths", "500,600", "--json"]).json()["angles"][0].clone()
    };
    assert_eq!(of(r#"{"file": "film.csv"}"#), of(r#"{"n": 0.2, "k": 3}"#));
    assert_eq!(of(r#""silver""#), of(r#""Ag""#));
    let stack = r#"{"layers": [{"ior": "water", "thickness_nm": 300}]}"#;
    let said = abbe(folder.path(), &["film", stack, "-o", "film.svg"]);
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.out.contains("0° of incidence") && said.out.contains("reflected light under D65: xy"), "{}", said.out);
    assert!(std::fs::read_to_string(folder.path().join("film.svg")).unwrap().contains("reflectance at 0°"));
}

#[test]
fn a_wrong_stack_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("noise.csv"), "nm,n,k\n360,1.6,0.1\n500,1.6,-0.01\n830,1.6,0\n").unwrap();
    for (stack, what) in [
        (r#"{"layers": [], "substrate": {"file": "noise.csv"}}"#, "negative value -0.01 at 500 nm"),
        (r#"{"layers": [{"ior": "MgF3", "thickness_nm": 100}]}"#, "layers[0].ior"),
        (r#"{"layers": [{"ior": "MgF3", "thickness_nm": 100}]}"#, "MgF2"),
        (r#"{"layers": [{"ior": 1.4, "thickness": 100}]}"#, "thickness_nm"),
        (r#"{"layers": [{"ior": 1.4, "thickness_nm": -1}]}"#, "thickness_nm"),
        (r#"{"layers": [], "incident": "silver"}"#, "transparent"),
        (r#"{"layers": [{"ior": 1.4, "thickness_nm": {"gradient": {"a": 1, "b": 2}}}]}"#, "a number"),
        ("no such file", "neither a file nor a JSON object"),
    ] {
        let said = abbe(folder.path(), &["film", stack]);
        assert_eq!(said.status, 2, "{stack}");
        assert!(said.err.contains(what), "{stack}: {}", said.err);
    }
}

#[test]
fn a_grating_lists_its_orders_on_both_sides() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["grating", "--lines-per-mm", "600", "--wavelength", "589.3", "--angle", "0"];
    let run = |more: &[&str]| abbe(folder.path(), &[&arguments[..], more].concat());
    let orders = run(&["--json"]).json()["orders"].as_array().unwrap().clone();
    let angle = (600.0_f64 * 589.3e-6).asin().to_degrees();
    for side in ["reflected", "transmitted"] {
        let found = orders.iter().find(|it| it["side"] == side && it["order"] == 1).unwrap();
        assert_near(side, &found["degrees"], angle, 1e-7);
        assert_eq!(orders.iter().filter(|it| it["side"] == side).count(), 5, "orders −2 to 2 propagate");
    }
    let total: f64 = orders.iter().map(|it| it["efficiency"].as_f64().unwrap()).sum();
    assert_near("sum", total, 1.0, 1e-12);
    let conical = run(&["--azimuth", "30", "--reflectance", "1", "--json"]).json();
    assert!(conical["orders"][0]["azimuth_degrees"].is_f64());
    assert!(run(&[]).out.contains("efficiency"));
    let wrong = run(&["--reflectance", "2"]);
    assert!(wrong.status == 2 && wrong.err.contains("--reflectance 2"), "{}", wrong.err);
    let measured = run(&["--efficiencies", "-1=0.25,0=0.5", "--reflectance", "0", "--json"]).json();
    let efficiencies = measured["orders"].as_array().unwrap().iter().map(|it| it["efficiency"].as_f64().unwrap());
    assert_eq!(efficiencies.collect::<Vec<_>>(), [0.0, 0.25, 0.5, 0.0, 0.0], "orders −2 to 2");
    let spectroscope = run(&["--stop-mm", "2", "--slit-deg", "0.05", "--json"]).json();
    let order = spectroscope["orders"].as_array().unwrap().iter().find(|it| it["order"] == -2).unwrap();
    let cos = (1.0 - (2.0 * 600.0 * 589.3e-6_f64).powi(2)).sqrt();
    assert_near("resolving power", &order["resolving_power"], 2.0 * 2.0 * 600.0 / cos / 1.22, 1e-6);
    assert_near("slit", &order["slit_nm"], 0.05_f64.to_radians() / (2.0 * 600e-6), 1e-9);
    let wrong = run(&["--stop-mm", "2", "--azimuth", "10"]);
    assert!(wrong.status == 2 && wrong.err.contains("--azimuth"), "{}", wrong.err);
    for (list, what) in [("0=0.9,1=0.2", "a sum of 1.1"), ("0:0.9", "0=0.1,1=0.75")] {
        let wrong = run(&["--efficiencies", list]);
        assert!(wrong.status == 2 && wrong.err.contains(what), "{}", wrong.err);
    }
}
