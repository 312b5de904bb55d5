//! Optics against golden values that were computed independently in Python from the same published
//! data.

use crate::common::near::{assert_near, number};
use crate::golden::golden;
use abbe_optics::glass::{RefractiveIndex, catalogue, lines};
use abbe_optics::{fresnel, prism};
use abbe_spectra::spectrum::library;
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

#[test]
fn glass_data_match_the_catalogue() {
    let file = golden("glass.json");
    let glasses = file["glasses"].as_array().unwrap();
    assert_eq!(glasses.len(), 117);
    let (mut indices, mut transmittances) = (0, 0);
    for entry in glasses {
        let name = entry["name"].as_str().unwrap();
        let glass = catalogue::find(name).unwrap();
        for (line, n) in entry["n"].as_object().unwrap() {
            let nm = number(&file["lines_nm"][line]);
            assert_near(&format!("{name} at {line}"), glass.index.n(nm), number(n), 1e-9);
            indices += 1;
        }
        if let Some(vd) = entry.get("vd") {
            assert_near(&format!("V_d of {name}"), glass.index.vd().unwrap(), number(vd), 1e-6);
        }
        if let Some(table) = entry.get("transmittance") {
            for (key, length_m) in [("tau_10mm", 0.01), ("tau_25mm", 0.025)] {
                for (nm, tau) in numbers(&table["nm"]).into_iter().zip(numbers(&table[key])) {
                    let got = glass.internal_transmittance(nm, length_m).unwrap();
                    assert_near(&format!("{key} of {name} at {nm} nm"), got, tau, 1e-6);
                    transmittances += 1;
                }
            }
        }
    }
    assert!(indices > 900 && transmittances > 2500, "{indices} indices and {transmittances} transmittances compared");
}

#[test]
fn the_lines_are_where_the_golden_file_has_them() {
    let file = golden("glass.json");
    let ours = [
        ("h", lines::H_NM),
        ("g", lines::G_NM),
        ("F", lines::F_NM),
        ("e", lines::E_NM),
        ("d", lines::D_NM),
        ("D", lines::SODIUM_NM),
        ("C", lines::C_NM),
        ("r", lines::R_NM),
    ];
    for (line, nm) in ours {
        assert_eq!(nm, number(&file["lines_nm"][line]), "{line}");
    }
}

#[test]
fn reflectances_equal_fresnel_s_to_1e_9() {
    let file = golden("fresnel.json");
    let mut compared = 0;
    for case in file["cases"].as_array().unwrap() {
        let name = case["case"].as_str().unwrap();
        let (n1, n2) = (number(&case["n1"]), numbers(&case["n2"]));
        let angles = numbers(&case["angle_deg"]);
        for ((angle, rs), rp) in angles.iter().zip(numbers(&case["Rs"])).zip(numbers(&case["Rp"])) {
            let cos = angle.to_radians().cos();
            let (s, p) = fresnel::conductor_sp(cos, n2[0], n2[1], n1);
            assert_near(&format!("Rs of {name} at {angle}°"), s, rs, 1e-9);
            assert_near(&format!("Rp of {name} at {angle}°"), p, rp, 1e-9);
            assert_near(
                &format!("R of {name} at {angle}°"),
                fresnel::conductor(cos, n2[0], n2[1], n1),
                0.5 * (rs + rp),
                1e-9,
            );
            if n2[1] == 0.0 {
                let (s, p) = fresnel::dielectric_sp(cos, n1, n2[0]);
                assert_near(&format!("Rs of {name} at {angle}°"), s, rs, 1e-9);
                assert_near(&format!("Rp of {name} at {angle}°"), p, rp, 1e-9);
                assert_near(
                    &format!("R of {name} at {angle}°"),
                    fresnel::dielectric(cos, n1, n2[0]),
                    0.5 * (rs + rp),
                    1e-9,
                );
            }
            compared += 1;
        }
    }
    assert!(compared > 450, "{compared} angles compared");
}

#[test]
fn prism_angles_equal_snell_s() {
    let file = golden("prism.json");
    let mut compared = 0;
    for apex in ["apex60", "apex30"] {
        for (name, glass) in file[apex].as_object().unwrap() {
            let index = RefractiveIndex::catalogue(name).unwrap();
            let apex_deg = number(&glass["apex_deg"]);
            for row in glass["rows"].as_array().unwrap() {
                let nm = number(&row["wavelength_nm"]);
                let n = index.n(nm);
                let what = |angle: &str| format!("{name}, {apex_deg}°, {nm} nm, {angle}");
                let same = |angle: &str, got: Option<f64>, golden: &Value| match (got, golden.as_f64()) {
                    (Some(got), Some(golden)) => assert_near(&what(angle), got, golden, 1e-6),
                    (got, golden) => assert_eq!(got, golden, "{}", what(angle)),
                };
                assert_near(&what("n"), n, number(&row["n"]), 1e-9);
                for (incidence, deviation) in row["deviation_deg"].as_object().unwrap() {
                    let got = prism::deviation_deg(n, apex_deg, incidence.parse().unwrap());
                    same(&format!("deviation at {incidence}°"), got, deviation);
                    compared += 1;
                }
                let minimum = |key: &str| row["minimum"].get(key).unwrap_or(&Value::Null).clone();
                same("minimum", prism::minimum_deviation_deg(n, apex_deg), &minimum("min_deviation_deg"));
                let incidence = prism::minimum_deviation_incidence_deg(n, apex_deg);
                same("incidence of the minimum", incidence, &minimum("incidence_deg"));
                let least = prism::least_passing_incidence_deg(n, apex_deg);
                same("least passing incidence", least, &row["tir_below_incidence_deg"]);
                same("critical angle", fresnel::critical_angle_deg(n, 1.0), &row["critical_angle_deg"]);
                same("Brewster angle", Some(fresnel::brewster_angle_deg(1.0, n)), &row["brewster_angle_deg"]);
            }
        }
    }
    assert!(compared > 900, "{compared} deviations compared");
}

#[test]
fn metals_reflect_as_their_tables_say() {
    let file = golden("metals.json");
    let rows = file["normal_reflectance"].as_array().unwrap();
    assert_eq!(rows.len(), 77);
    for row in rows {
        let name = row["metal"].as_str().unwrap();
        let nm = number(&row["wavelength_nm"]);
        let (n, k) = library::metal(name).unwrap().index();
        assert_near(&format!("n of {name} at {nm} nm"), n.at(nm), number(&row["n"]), 1e-9);
        assert_near(&format!("k of {name} at {nm} nm"), k.at(nm), number(&row["k"]), 1e-9);
        let reflectance = fresnel::conductor(1.0, n.at(nm), k.at(nm), 1.0);
        assert_near(&format!("R of {name} at {nm} nm"), reflectance, number(&row["R_normal"]), 1e-9);
    }
}
