//! `abbe regress`: the exported set, the judgement of converters, and its reports.

use crate::abbe_command::folder::names_in;
use crate::abbe_command::{Said, abbe};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// A folder with the exported set in `set`, and its expected values as `mine.csv`.
fn exported() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let said = abbe(folder.path(), &["regress", "--export", "set"]);
    assert_eq!((said.status, said.out.as_str()), (0, ""), "{}", said.err);
    std::fs::copy(folder.path().join("set/expected.csv"), folder.path().join("mine.csv")).unwrap();
    folder
}

fn regress(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["regress"], more].concat())
}

/// Writes `mine.csv` with changed rows. `change` receives the cells of a row.
fn write_changed(folder: &Path, change: impl Fn(&mut Vec<String>)) {
    let text = std::fs::read_to_string(folder.join("set/expected.csv")).unwrap();
    let mut lines = text.lines();
    let mut changed = lines.next().unwrap().to_string() + "\n";
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_string).collect();
        change(&mut cells);
        changed += &(cells.join(",") + "\n");
    }
    std::fs::write(folder.join("mine.csv"), changed).unwrap();
}

/// Multiplies a component of a row.
fn scale(cells: &mut [String], place: usize, factor: f64) {
    cells[place] = (cells[place].parse::<f64>().unwrap() * factor).to_string();
}

#[test]
fn the_expected_values_pass_in_every_form() {
    let folder = exported();
    let at = folder.path();
    let names = ["cases.csv", "expected.csv", "lines.csv", "observer.csv", "set.json", "spectra.csv"];
    assert_eq!(names_in(&at.join("set")), names);
    for file in ["mine.csv", "set/set.json"] {
        let report = regress(at, &[file, "--json"]).json();
        assert_eq!((report["judged"].as_u64(), report["failed"].as_u64()), (Some(264), Some(0)), "{file}");
        assert_eq!(report["set"], "abbe-regress 1");
    }
    let said = regress(at, &["mine.csv", "--delta-e", "0", "--component", "0"]);
    assert!(said.status == 0 && said.out.contains("all 264 cases pass"), "{}{}", said.out, said.err);
    // The spectra have a row per nm and a column per spectrum.
    let spectra = std::fs::read_to_string(at.join("set/spectra.csv")).unwrap();
    let header: Vec<&str> = spectra.lines().next().unwrap().split(',').collect();
    assert!(spectra.lines().count() == 472 && header[0] == "nm" && header.contains(&"colorchecker/red"));
}

#[test]
fn a_wrong_component_fails_its_case_in_all_reports() {
    let folder = exported();
    let at = folder.path();
    write_changed(at, |cells| {
        if cells[0] == "FL11" {
            scale(cells, 1, 1.01);
        }
        if cells[0] == "colorchecker/red@HP1" {
            cells[5] = "NaN".to_string();
        }
    });
    let options = ["mine.csv", "--json", "--junit", "junit.xml", "--page", "page.html"];
    let said = regress(at, &options);
    assert_eq!(said.status, 3, "{}", said.err);
    assert!(said.err.contains("failed: 2 of 264 cases fail"), "{}", said.err);
    let report: Value = serde_json::from_str(&said.out).unwrap();
    let ids = [0, 1, 2].map(|i| (report["cases"][i]["id"].as_str().unwrap(), report["cases"][i]["passed"].as_bool()));
    assert_eq!(ids[..2], [("colorchecker/red@HP1", Some(false)), ("FL11", Some(false))]);
    assert_eq!(ids[2].1, Some(true));
    assert!(report["cases"][0]["fault"].as_str().unwrap().contains("not finite"), "{report}");
    assert!(report["cases"][1]["fault"].as_str().unwrap().contains("xyz differs by ΔE2000"));

    let xml = std::fs::read_to_string(at.join("junit.xml")).unwrap();
    let document = roxmltree::Document::parse(&xml).unwrap();
    let count = |tag: &str| document.descendants().filter(|node| node.has_tag_name(tag)).count();
    assert_eq!((count("testcase"), count("failure")), (264, 2));
    let failed: Vec<_> = document.descendants().filter(|node| node.has_tag_name("failure")).collect();
    let names: Vec<_> = failed.iter().map(|node| node.parent_element().unwrap().attribute("name").unwrap()).collect();
    assert_eq!(names, ["colorchecker/red@HP1", "FL11"]);

    let page = std::fs::read_to_string(at.join("page.html")).unwrap();
    assert!(page.contains("2 of 264 cases fail") && page.contains("colorchecker/red@HP1"));
    assert!(!page.contains("http") && !page.contains("<script"), "the page is self-contained");

    // The other groups pass, and a larger tolerance accepts FL11.
    assert_eq!(regress(at, &["mine.csv", "--group", "lines", "--group", "metamers"]).status, 0);
    assert_eq!(regress(at, &["mine.csv", "--group", "lamps"]).status, 3);
    assert_eq!(regress(at, &["mine.csv", "--group", "lamps", "--delta-e", "2", "--component", "2%"]).status, 0);
}

#[test]
fn a_common_factor_gives_a_hint() {
    let folder = exported();
    let at = folder.path();
    write_changed(at, |cells| (1..4).for_each(|place| scale(cells, place, 0.01)));
    let said = regress(at, &["mine.csv"]);
    assert_eq!(said.status, 3);
    assert!(said.err.contains("all values of xyz are 0.0100 times the expected values"), "{}", said.err);
    // Every light has a factor of its own: the lights are not normalised.
    write_changed(at, |cells| {
        let factor = cells[0].split('@').next_back().unwrap().len() as f64;
        (4..7).for_each(|place| scale(cells, place, factor));
    });
    let said = regress(at, &["mine.csv"]);
    assert!(said.err.contains("linear_srgb have another factor for each light"), "{}", said.err);
    // A wrong case alone is not a wrong scale.
    write_changed(at, |cells| {
        let factor = if cells[0] == "A" { 1.1 } else { 1.0 };
        (1..4).for_each(|place| scale(cells, place, factor));
    });
    let said = regress(at, &["mine.csv"]);
    assert!(said.status == 3 && !said.err.contains("factor") && !said.err.contains("times"), "{}", said.err);
}

#[test]
fn a_likely_cause_is_in_all_reports() {
    let folder = exported();
    let at = folder.path();
    write_changed(at, |cells| cells.swap(4, 6));
    let said = regress(at, &["mine.csv", "--junit", "junit.xml", "--page", "page.html"]);
    let sentence = "likely cause: swapped channels: the components of linear_srgb are in the order b, g, r \
                    (this leaves 0.0 % of the error)";
    assert!(said.status == 3 && said.out.contains(sentence) && said.err.contains(sentence), "{}{}", said.out, said.err);
    let counts: Vec<&str> = said.out.lines().find(|line| line.contains(" surfaces ")).unwrap().split(' ').collect();
    assert!(counts.contains(&"192"), "{}", said.out);
    let xml = std::fs::read_to_string(at.join("junit.xml")).unwrap();
    let document = roxmltree::Document::parse(&xml).unwrap();
    let property = document.descendants().find(|node| node.has_tag_name("property")).unwrap();
    assert_eq!((property.attribute("name"), property.attribute("value")), (Some("cause"), Some(sentence)));
    assert!(std::fs::read_to_string(at.join("page.html")).unwrap().contains(sentence));
    let report = regress(at, &["mine.csv", "--json"]);
    let report: Value = serde_json::from_str(&report.out).unwrap();
    assert_eq!(
        (&report["cause"]["name"], &report["cause"]["form"]),
        (&"swapped-channels".into(), &"linear_srgb".into())
    );
    assert!(report["cause"]["residual"].as_f64().unwrap() < 1e-9);
    assert_eq!(report["hint"], report["cause"]["explanation"]);
    assert_eq!(
        (report["groups"][3]["group"].as_str(), report["groups"][3]["judged"].as_u64()),
        (Some("surfaces"), Some(192))
    );

    write_changed(at, |cells| cells[6] = (cells[6].parse::<f64>().unwrap().powi(2)).to_string());
    let said = regress(at, &["mine.csv"]);
    assert!(said.out.contains("\nno known cause explains the errors\n"), "{}", said.out);
}

#[test]
fn the_second_set_has_more_forms_and_fluorescence() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert_eq!(regress(at, &["--export", "set", "--set", "2"]).status, 0);
    for file in ["set/expected.csv", "set/set.json"] {
        let report = regress(at, &[file, "--set", "2", "--json"]).json();
        assert_eq!((report["judged"].as_u64(), report["failed"].as_u64()), (Some(212), Some(0)), "{file}");
        assert_eq!(report["set"], "abbe-regress 2");
    }
    let cases = std::fs::read_to_string(at.join("set/cases.csv")).unwrap();
    assert!(cases.starts_with("id,group,light,reflectance,excitation,emission\n"), "{}", &cases[..100]);
    let observer = std::fs::read_to_string(at.join("set/observer.csv")).unwrap();
    assert!(observer.starts_with("nm,x_bar,y_bar,z_bar,x_cie1964,"), "{}", &observer[..100]);

    // Only Lab, with D50 as the white for all lights.
    let text = std::fs::read_to_string(at.join("set/expected.csv")).unwrap();
    let mut lab = "id,lab_L,lab_a,lab_b\n".to_string();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let xyz = [1, 2, 3].map(|i| cells[i].parse::<f64>().unwrap());
        let curve = |t: f64| if t > 0.008_856_451_679 { t.cbrt() } else { t * 7.787_037_037 + 16.0 / 116.0 };
        let [x, y, z] = [xyz[0] / 96.42, xyz[1] / 100.0, xyz[2] / 82.51].map(curve);
        lab += &format!("{},{},{},{}\n", cells[0], 116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z));
    }
    std::fs::write(at.join("lab.csv"), lab).unwrap();
    let said = regress(at, &["lab.csv", "--set", "2", "--group", "surfaces"]);
    assert!(said.out.contains("wrong white: the white of lab is D50 instead of the light"), "{}", said.out);

    regress(at, &["set/set.json"]).is_error(2, &["abbe-regress 2", "expected \"abbe-regress 1\""]);
    regress(at, &["lab.csv"]).is_error(2, &["unknown column \"lab_L\""]);
    regress(at, &["lab.csv", "--set", "2", "--group", "lamps"]).is_error(2, &["abbe-regress 2 has no group lamps"]);
    assert_eq!(regress(at, &["lab.csv", "--set", "3"]).status, 2);
}

#[test]
fn malformed_colours_are_errors_with_their_place() {
    let folder = exported();
    let at = folder.path();
    let text = std::fs::read_to_string(at.join("mine.csv")).unwrap();
    let refused = |name: &str, text: &str, words: &[&str]| {
        std::fs::write(at.join(name), text).unwrap();
        regress(at, &[name]).is_error(2, &[&[name], words].concat());
    };
    let lines: Vec<&str> = text.lines().collect();
    refused(
        "short.csv",
        &lines[..lines.len() - 2].join("\n"),
        &["2 of 264 cases are missing", "and 1 more", "--group"],
    );
    refused("id.csv", &text.replace("\nFL11,", "\nFL111,"), &["unknown case \"FL111\"", "did you mean \"FL11\""]);
    refused("twice.csv", &(text.clone() + lines[1] + "\n"), &["the case A occurs twice"]);
    refused("wide.csv", &text.replacen(lines[2], &format!("{},1", lines[2]), 1), &["wide.csv:3:1", "has 11 columns"]);
    refused("word.csv", &text.replacen(lines[3], "D65,1,2,x,4,5,6,7,8,9", 1), &["word.csv:4:1", "Z of D65 is \"x\""]);
    refused("column.csv", &text.replacen("linear_r", "linear_red", 1), &["unknown column \"linear_red\"", "linear_r"]);
    refused("two.csv", "id,X,Y\nA,1,2\n", &["only 2 of the 3 columns of xyz"]);
    refused("none.csv", "id\nA\n", &["the case A has no colour"]);
    refused("empty.csv", "", &["is empty", "id"]);
    refused("nan.json", "[{\"id\": \"A\", \"xyz\": [NaN, 1, 2]}]", &["not JSON", "null"]);
    refused("key.json", "[{\"id\": \"A\", \"XYZ\": [0, 1, 2]}]", &["cases[0]", "unknown key \"XYZ\"", "xyz"]);
    refused("three.json", "[{\"id\": \"A\", \"xyz\": [0, 1]}]", &["cases[0]", "three numbers"]);
    refused("set.json", "{\"set\": \"abbe-regress 9\", \"cases\": []}", &["abbe-regress 9", "abbe-regress 1"]);
    regress(at, &["missing.csv"]).is_error(2, &["missing.csv", "cannot be read"]);
    assert_eq!(regress(at, &[]).status, 2);
    // A null is a value that is not finite. The case fails, and the file is valid.
    std::fs::write(at.join("null.json"), "[{\"id\": \"A\", \"xyz\": [null, 1, 2]}]").unwrap();
    regress(at, &["null.json", "--group", "lamps"]).is_error(2, &["11 of 12 cases are missing"]);
}
