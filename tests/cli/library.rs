//! The commands `abbe spectrum`, `abbe glass` and `abbe schema`, help texts, and wrong commands.

use crate::abbe_command::{abbe, command};
use crate::common::near::assert_near;
use serde_json::Value;
use std::io::Read;
use std::process::Stdio;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn d65_has_its_published_colour() {
    let folder = tempfile::tempdir().unwrap();
    let d65 = abbe(folder.path(), &["spectrum", "d65", "--json"]).json();
    // CIE 15: sums over the table with steps of 1 nm.
    assert_near("d65: xyz", &d65["xyz"], [95.0471, 100.0, 108.8828], 1e-3);
    assert_near("d65: xy", &d65["xy"], [0.31272, 0.32903], 1e-4);
    assert_near("d65: linear_srgb", &d65["linear_srgb"], [1.0, 1.0, 1.0], 1e-3);
    assert_eq!(d65["srgb_hex"], "#ffffff");
    assert!((d65["cct_k"].as_f64().unwrap() - 6503.0).abs() < 2.0 && d65["duv"].is_f64());
    assert!((d65["ra"].as_f64().unwrap() - 100.0).abs() < 0.1);
    assert!(d65["dominant_nm"].is_f64() && d65["purity"].is_f64());
}

#[test]
fn sodium_light_is_outside_srgb() {
    let folder = tempfile::tempdir().unwrap();
    let sodium = abbe(folder.path(), &["spectrum", "sodium-low-pressure", "--json"]).json();
    assert_near("sodium: xy", &sodium["xy"], [0.5704, 0.4289], 1e-4);
    assert!(numbers(&sodium["linear_srgb"])[2] < -0.12);
}

#[test]
fn any_spectrum_of_a_scene_can_be_written_inline_or_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let illuminant_a = abbe(folder.path(), &["spectrum", r#"{"blackbody": {"temperature": 2855.5}}"#, "--json"]).json();
    assert_near("illuminant_a: xy", &illuminant_a["xy"], [0.4476, 0.4074], 2e-4);
    std::fs::write(folder.path().join("lamp.csv"), "nm,value\n360,1\n830,1\n").unwrap();
    let from_file = abbe(folder.path(), &["spectrum", "lamp.csv", "--json"]).json();
    assert_near("from_file: xy", &from_file["xy"], [1.0 / 3.0, 1.0 / 3.0], 1e-4);
    let inline = abbe(folder.path(), &["spectrum", r#"{"file": "lamp.csv"}"#, "--json"]).json();
    assert_eq!(inline["xyz"], from_file["xyz"]);
    let equal = abbe(folder.path(), &["spectrum", "1", "--json"]).json();
    assert_near("equal: xyz", &equal["xyz"], &from_file["xyz"], 1e-9);
}

#[test]
fn files_with_faults_are_refused_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let spdx = |samples: &[(&str, &str)]| {
        let rows =
            samples.iter().map(|(nm, value)| format!("<SpectralData wavelength=\"{nm}\">{value}</SpectralData>\n"));
        let data: String = rows.collect();
        format!("<IESTM2714><SpectralDistribution>\n{data}</SpectralDistribution></IESTM2714>\n")
    };
    for (second, word) in [
        (("399", "1"), "ascending"),
        (("400", "1"), "twice"),
        (("410", "-1"), "negative"),
        (("410", "NaN"), "NaN"),
        (("nan", "1"), "NaN"),
        (("410", "inf"), "inf"),
        (("4e6", "1"), "wavelengths from 10"),
        (("410", "red"), "red"),
    ] {
        let samples = [("400", "0.5"), second];
        let csv: String = samples.iter().map(|(nm, value)| format!("{nm};{value}\n")).collect();
        std::fs::write(folder.path().join("a.csv"), format!("nm;W\n{csv}")).unwrap();
        std::fs::write(folder.path().join("a.spdx"), spdx(&samples)).unwrap();
        for file in ["a.csv", "a.spdx"] {
            abbe(folder.path(), &["spectrum", file]).is_error(2, &[&format!("{file}:3:"), word]);
            let inline = format!("{{\"file\": \"{file}\"}}");
            abbe(folder.path(), &["spectrum", &inline]).is_error(2, &[&format!("{file}:3:"), word]);
        }
    }
    let known = abbe(
        folder.path(),
        &["spectrum", r#"{"table": {"nm": [400, 411.5, 733.3], "values": [0.5, 1, 0.25]}}"#, "--json"],
    );
    let known = numbers(&known.json()["xyz"]);
    let samples = [("400", "0.5"), ("411.5", "1"), ("733.3", "0.25")];
    std::fs::write(folder.path().join("a.spdx"), spdx(&samples)).unwrap();
    std::fs::write(folder.path().join("a.csv"), "λ in µm\tpower\n0.4\t0.5\n0.4115\t1\n0.7333\t0.25\n").unwrap();
    for file in ["a.csv", "a.spdx"] {
        assert_near(file, &numbers(&abbe(folder.path(), &["spectrum", file, "--json"]).json()["xyz"]), &known, 1e-9);
    }
    abbe(folder.path(), &["spectrum", "missing.csv"]).is_error(2, &["missing.csv: cannot read the spectrum"]);
}

#[test]
fn a_reflectance_is_seen_relative_to_the_perfect_diffuser() {
    let folder = tempfile::tempdir().unwrap();
    let half = abbe(folder.path(), &["spectrum", "0.5", "--reflectance-under", "D65", "--json"]).json();
    assert_near("half: xyz", &half["xyz"], [47.52355, 50.0, 54.4414], 1e-3);
    assert!(["dominant_nm", "purity", "cct_k", "duv", "ra"].iter().all(|key| half[key].is_null()), "{half}");
    let ten_degrees = abbe(folder.path(), &["spectrum", "D65", "--observer", "cie1964", "--json"]).json();
    assert_near("ten_degrees: xy", &ten_degrees["xy"], [0.31382, 0.33100], 1e-4);
}

#[test]
fn wrong_spectra_are_answered_with_their_place_and_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let spectrum = |text: &str| abbe(folder.path(), &["spectrum", text]);
    spectrum("D66").is_error(2, &["D66", "did you mean \"D65\""]);
    spectrum("no/such.csv").is_error(2, &["no/such.csv"]);
    spectrum(r#"{"gausian": {"peak_nm": 500}}"#).is_error(2, &["gausian", "did you mean \"gaussian\""]);
    spectrum(r#"{"gaussian": {"peak_nm": 500, "fwhm_nm": -1}}"#).is_error(2, &["gaussian.fwhm_nm", "-1"]);
    spectrum(r#"{"blackbody": "#).is_error(2, &[]);
    spectrum("0").is_error(2, &["power"]);
    spectrum(r#"{"table": {"nm": [900, 1000], "values": [1, 1]}}"#).is_error(2, &["power"]);
    abbe(folder.path(), &["spectrum", "1.5", "--reflectance-under", "D65"]).is_error(2, &["0 to 1"]);
    abbe(folder.path(), &["spectrum", "D65", "--observer", "cat"]).is_error(2, &["cat", "cie1931"]);
    abbe(folder.path(), &["spectrum"]).is_error(2, &["required"]);
    abbe(folder.path(), &["spectrum", "D65", "--svg", "no/folder.svg"]).is_error(1, &["no/folder.svg"]);
}

#[test]
fn n_bk7_has_its_catalogue_values() {
    let folder = tempfile::tempdir().unwrap();
    let glass = abbe(folder.path(), &["glass", "n-bk7", "--at", "486.1327,656.2725", "--json"]).json();
    // Schott's data sheet: n_d 1.51680, V_d 64.17, n_F 1.52238, n_C 1.51432.
    assert_near("nd, vd", [glass["nd"].as_f64().unwrap(), glass["vd"].as_f64().unwrap()], [1.5168, 64.17], 5e-3);
    assert_near(
        "n_F, n_C",
        [glass["n"][0]["n"].as_f64().unwrap(), glass["n"][1]["n"].as_f64().unwrap()],
        [1.52238, 1.51432],
        5e-6,
    );
    assert_eq!(glass["n"][0]["nm"], 486.1327);
    assert_eq!(numbers(&glass["range_nm"]), [300.0, 2500.0]);
    assert_eq!(numbers(&glass["sellmeier"]["b"]), [1.03961212, 0.231792344, 1.01046945]);
    assert_eq!(numbers(&glass["sellmeier"]["c"]).len(), 3);
    for key in ["a", "b", "c", "max_error"] {
        assert!(glass["cauchy"][key].is_f64(), "{key}");
    }
    assert!(abbe(folder.path(), &["glass", "air (Ciddor)", "--json"]).json()["sellmeier"].is_null());
}

#[test]
fn wrong_glasses_are_answered_with_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    abbe(folder.path(), &["glass", "N-BK8"]).is_error(2, &["N-BK8", "did you mean"]);
    abbe(folder.path(), &["glass", "N-BK7", "--at", "blue"]).is_error(2, &["blue"]);
    abbe(folder.path(), &["glass", "N-BK7", "--at", "1e9"]).is_error(2, &["300 to 2500 nm"]);
}

#[test]
fn lists_name_everything() {
    let folder = tempfile::tempdir().unwrap();
    let spectra = abbe(folder.path(), &["spectrum", "--list"]);
    assert!(spectra.out.lines().any(|line| line.starts_with("sodium-low-pressure ")), "{}", spectra.out);
    let json = abbe(folder.path(), &["spectrum", "--list", "--json"]).json();
    assert_eq!(json["spectra"].as_array().unwrap().len(), spectra.out.lines().count());
    let glasses = abbe(folder.path(), &["glass", "--list"]);
    assert!(glasses.out.lines().any(|line| line.starts_with("N-SF10 ")) && glasses.err.is_empty());
    let json = abbe(folder.path(), &["glass", "--list", "--json"]).json();
    assert_eq!(json["glasses"].as_array().unwrap().len(), glasses.out.lines().count());
}

#[test]
fn plots_are_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, name) in [
        (["spectrum", "sodium-low-pressure", "--svg", "s.svg"], "s.svg"),
        (["glass", "N-SF10", "--svg", "g.svg"], "g.svg"),
    ] {
        assert_eq!(abbe(folder.path(), &arguments).status, 0);
        let svg = std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("wavelength in nm"));
    }
}

#[test]
fn the_schema_is_json_and_help_is_a_result() {
    let folder = tempfile::tempdir().unwrap();
    assert!(abbe(folder.path(), &["schema"]).json()["properties"]["camera"].is_object());
    let reference = abbe(folder.path(), &["schema", "--markdown"]);
    assert!(reference.status == 0 && reference.out.starts_with("# Scene reference"));
    let help = abbe(folder.path(), &["--help"]);
    assert!(help.status == 0 && help.err.is_empty() && help.out.contains("render"));
    let version = abbe(folder.path(), &["--version"]);
    assert_eq!(version.out.trim(), format!("abbe {}", env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_commands_are_one_line_with_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    abbe(folder.path(), &["rendr", "a.json"]).is_error(2, &["rendr", "'render'"]);
    abbe(folder.path(), &["render", "a.json", "--passs", "3"]).is_error(2, &["--passs", "'--passes'"]);
    abbe(folder.path(), &["render", "a.json", "--size", "12"]).is_error(2, &["--size", "640x360"]);
    abbe(folder.path(), &["render", "a.json", "--time", "soon"]).is_error(2, &["--time", "90s"]);
    let nothing = abbe(folder.path(), &[]);
    assert!(nothing.status == 2 && nothing.out.is_empty() && nothing.err.contains("Usage"));
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = command(folder.path())
        .arg("schema")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("abbe can be started");
    // The schema is larger than a pipe's buffer, so the program still writes after the reader has
    // closed.
    drop(child.stdout.take());
    let mut err = String::new();
    child.stderr.take().expect("it is piped").read_to_string(&mut err).unwrap();
    assert_eq!((child.wait().unwrap().code(), err.as_str()), (Some(0), ""));
}

/// Every name that a conductor may use is in the list, and its index is printed.
#[test]
fn metals_are_listed_with_their_index() {
    let folder = tempfile::tempdir().unwrap();
    let list = abbe(folder.path(), &["metal", "--list", "--json"]).json();
    let metals = list["metals"].as_array().unwrap();
    assert!(metals.len() >= 4, "{list}");
    for metal in metals {
        for key in ["symbol", "name"] {
            let found = abbe(folder.path(), &["metal", metal[key].as_str().unwrap(), "--at", "589.3", "--json"]).json();
            let reflectance = found["index"][0]["reflectance"].as_f64().unwrap();
            assert!(found["symbol"] == metal["symbol"] && (0.0..1.0).contains(&reflectance), "{found}");
        }
    }
    abbe(folder.path(), &["metal", "gould"]).is_error(2, &["gould", "gold"]);
}

#[test]
fn completions_and_manual_pages_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let script = abbe(folder.path(), &["completions", "bash"]);
    assert!(script.status == 0 && script.out.contains("--target-error"), "{}", script.err);
    let page = abbe(folder.path(), &["man", "render"]);
    assert!(page.status == 0 && page.out.contains("abbe\\-render"), "{}", page.out);
    abbe(folder.path(), &["man", "rendre"]).is_error(2, &["rendre", "render"]);
}

/// A chart in percent gives the colour of the same table in fractions, and a note about the scale.
#[test]
fn a_sample_of_a_cgats_file_is_chosen_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let chart = "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_ID SAMPLE_NAME SPECTRAL_NM400 SPECTRAL_NM550 SPECTRAL_NM700\n\
                 END_DATA_FORMAT\nBEGIN_DATA\n1 A1 0.5 1.0 1.5\n2 \"dark skin\" 10 20 40\nEND_DATA\n";
    std::fs::write(folder.path().join("chart.txt"), chart).unwrap();
    let table = r#"{"table": {"nm": [400, 550, 700], "values": [0.1, 0.2, 0.4]}}"#;
    let of = |spectrum: &[&str]| {
        let arguments = [&["spectrum"], spectrum, &["--reflectance-under", "D50", "--json"]].concat();
        abbe(folder.path(), &arguments)
    };
    let known = of(&[table]).json();
    for arguments in [
        &["chart.txt", "--sample", "dark skin"][..],
        &["chart.txt", "--sample", "2"],
        &[r#"{"file": {"path": "chart.txt", "sample": "2"}}"#],
    ] {
        let found = of(arguments);
        assert!(found.err.contains("note: chart.txt: the file has values up to 40, which are read as percent"));
        assert_near("xyz", &numbers(&found.json()["xyz"]), &numbers(&known["xyz"]), 1e-9);
    }
    assert_eq!(of(&["chart.txt", "--sample", "A1"]).json()["name"], "A1 of chart.txt");
    of(&["chart.txt"]).is_error(2, &["chart.txt:5:1: a file with 2 samples", "1 (A1), 2 (dark skin)"]);
    of(&["chart.txt", "--sample", "dark"]).is_error(2, &["chart.txt:5:1: unknown sample \"dark\""]);
    std::fs::write(folder.path().join("lamp.csv"), "nm,value\n400,1\n700,1\n").unwrap();
    of(&["lamp.csv", "--sample", "A1"]).is_error(2, &["lamp.csv", "a CGATS file"]);
}
