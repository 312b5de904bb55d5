//! `abbe lamps`: figures against independently computed values, text output, errors and the page.

use crate::abbe_command::abbe;
use crate::common::near::assert_near;
use crate::golden::golden;
use serde_json::json;

const RED: &str = r#"{"lines": [{"nm": 620, "power": 1}]}"#;
const GREEN: &str = r#"{"lines": [{"nm": 550, "power": 1}]}"#;
/// Low-pressure sodium and its match from a red and a green line.
const SODIUM: [&str; 5] = ["lamps", "sodium-low-pressure", "--match", RED, GREEN];

#[test]
fn lamps_and_their_matches_split_the_chart_as_far_as_computed() {
    let folder = tempfile::tempdir().unwrap();
    let golden = golden("metamers.json");
    for (name, known) in golden["by_lamp"].as_object().unwrap() {
        let lamp = name.replace("lamp HPS", "sodium-high-pressure");
        let arguments = ["lamps", &lamp, "--match", "led/red", "led/green", "led/blue", "--json"];
        let said = abbe(folder.path(), &arguments);
        assert!(said.err.is_empty(), "{}", said.err);
        let found = said.json();
        for (i, known) in known["weights"].as_array().unwrap().iter().enumerate() {
            assert_near(name, &found["match"]["weights"][i], known, 1e-6 * known.as_f64().unwrap());
        }
        assert!(found["match"]["reached"] == true && found["warning"].is_null());
        assert!(found["match"]["delta_xy"].as_f64().unwrap() < 1e-9, "{found}");
        let patches = known["patches"].as_object().unwrap();
        assert_eq!(found["patches"].as_array().unwrap().len(), patches.len());
        for (i, (title, known)) in patches.iter().enumerate() {
            let patch = &found["patches"][i];
            assert!(patch["name"].as_str().unwrap().starts_with("colorchecker/"), "{patch}");
            assert_near(title, &patch["delta_e_2000"], &known["deltaE2000"], 1e-4);
        }
        assert_near(name, &found["delta_e_2000"]["mean"], &known["mean_deltaE2000"], 1e-4);
        assert_near(name, &found["delta_e_2000"]["max"], &known["max_deltaE2000"], 1e-4);
    }
}

#[test]
fn sodium_against_red_and_green_has_the_golden_values() {
    let folder = tempfile::tempdir().unwrap();
    let known = golden("sodium_match.json");
    let found = abbe(folder.path(), &[&SODIUM[..], &["--json"]].concat()).json();
    for i in 0..2 {
        assert_near("weight", &found["match"]["weights"][i], &known["weights"][i], 1e-6);
    }
    for key in ["delta_xy", "delta_y"] {
        assert_near(key, &found["match"][key], &known[key], 1e-9);
    }
    assert_near("ΔE2000", &found["match"]["delta_e_2000"], &known["delta_e_2000"], 1e-5);
    for (patch, (title, known)) in
        found["patches"].as_array().unwrap().iter().zip(known["patches"].as_object().unwrap())
    {
        assert_near(title, &patch["delta_e_2000"], known, 1e-4);
    }
    let split = found["metameric_pairs"]["split"].as_array().unwrap();
    assert_eq!(
        (split.len() as u64, &found["metameric_pairs"]["of"]),
        (known["pair_count"].as_u64().unwrap(), &780.into())
    );
    assert_eq!(split[0]["names"], serde_json::json!(["colorchecker/red", "TCS11"]));
    for i in 0..2 {
        assert_near("pair", &split[0]["delta_e_2000"][i], &known["largest_split"]["delta_e_2000"][i], 1e-4);
    }
}

#[test]
fn what_cannot_be_matched_is_said_in_words_and_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let said = abbe(folder.path(), &SODIUM);
    assert_eq!(said.status, 0);
    assert!(
        said.err.starts_with("warning: sodium-low-pressure cannot be matched with a line at 620 nm"),
        "{}",
        said.err
    );
    assert!(said.err.contains("Δxy 0.00098") && said.err.lines().count() == 1, "{}", said.err);
    assert!(said.out.contains("inexact: Δxy 0.00098, ΔE2000 0.77"), "{}", said.out);
    let json = abbe(folder.path(), &[&SODIUM[..], &["--json"]].concat()).json();
    assert!(
        json["match"]["reached"] == false && json["warning"].as_str().unwrap().contains("cannot be matched"),
        "{json}"
    );
}

#[test]
fn two_lamps_are_described_as_spectrum_describes_each() {
    let folder = tempfile::tempdir().unwrap();
    let both = abbe(folder.path(), &["lamps", "d65", "FL2", "--observer", "cie1964", "--json"]).json();
    for (key, name) in [("a", "D65"), ("b", "FL2")] {
        assert_eq!(both[key], abbe(folder.path(), &["spectrum", name, "--observer", "cie1964", "--json"]).json());
    }
    assert!(both["match"].is_null() && both["warning"].is_null());
    let with_match =
        ["lamps", "d65", "FL2", "--observer", "cie1964", "--json", "--match", "led/red", "led/green", "led/blue"];
    let with_match = abbe(folder.path(), &with_match).json();
    assert_eq!(with_match["patches"], both["patches"], "a match beside B leaves the comparison with B as it is");
    assert_eq!(with_match["match"]["weights"].as_array().unwrap().len(), 3);
    assert!(both["lights"]["delta_xy"].as_f64().unwrap() > 0.05 && both["lights"]["delta_e_2000"].is_f64());
    let same = abbe(folder.path(), &["lamps", "D65", "D65", "--json"]).json();
    assert_eq!((&same["delta_e_2000"]["max"], &same["lights"]["delta_xy"]), (&0.0.into(), &0.0.into()));
    assert_eq!(same["metameric_pairs"]["split"], serde_json::json!([]));
}

#[test]
fn the_words_form_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let said = abbe(folder.path(), &["lamps", "A", "D65"]);
    assert!(said.status == 0 && said.err.is_empty(), "{}", said.err);
    for words in ["CIE 15", "CCT           2855", "6502.6 K", "orange-yellow ", "mean ", "largest ", "\n  none\n"] {
        assert!(said.out.contains(words), "{words}: {}", said.out);
    }
    assert!(said.out.lines().all(|line| line.trim_end() == line), "{}", said.out);
    let split = abbe(folder.path(), &["lamps", "D65", "sodium-low-pressure"]).out;
    assert!(split.contains("red and TCS11 ") && split.contains("… and 37 more (--json)"), "{split}");
}

#[test]
fn wrong_lamps_are_answered_with_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let lamps = |arguments: &[&str]| abbe(folder.path(), &[&["lamps"], arguments].concat());
    lamps(&["sodium-low-presure", "D65"]).is_error(2, &["did you mean \"sodium-low-pressure\""]);
    lamps(&["D65", "D66"]).is_error(2, &["D66", "did you mean \"D65\""]);
    lamps(&["D65", "--match", "led/red", "led/gren"]).is_error(2, &["led/gren", "did you mean \"led/green\""]);
    lamps(&["D65", r#"{"blackbody": {"temperature": -3}}"#]).is_error(2, &["blackbody.temperature", "-3"]);
    lamps(&["D65"]).is_error(2, &["required", "B", "--match"]);
    lamps(&["D65", "--match"]).is_error(2, &["--match"]);
    lamps(&["D65", "no/such.csv"]).is_error(2, &["no/such.csv"]);
    std::fs::write(folder.path().join("dark.csv"), "nm,value\n360,0\n830,0\n").unwrap();
    lamps(&["D65", "dark.csv"]).is_error(2, &["lights[1]", "without luminance"]);
    lamps(&["D65", "--match", "led/red", "dark.csv"]).is_error(2, &["primaries[1]", "without colour"]);
    lamps(&["D65", "A", "--observer", "cat"]).is_error(2, &["cat", "cie1931"]);
    lamps(&["D65", "A", "--html", "no/folder.html"]).is_error(1, &["no/folder.html"]);
}

#[test]
fn the_lamp_page_is_complete_and_self_contained() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [&SODIUM[..], &["--html", "page.html"]].concat();
    assert_eq!(abbe(folder.path(), &arguments).status, 0);
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["page.html"]);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
    for words in [
        "<title>sodium-low-pressure against its match from a line at 620 nm and a line at 550 nm</title>",
        "NIST Atomic Spectra Database",
        "wavelength in nm",
        "line power; 1 is 1.273 mW/lm",
        "cannot be matched",
        "prefers-color-scheme: dark",
        "orange-yellow",
        "Metameric pairs that split",
        "Colour rendition (TM-30)",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Two spectra, the chromaticity diagram and two colour vector graphics; 24 patches with and
    // without adaptation, 12 pairs under two lamps, 24 in the table, and two fluorescent surfaces.
    assert_eq!(page.matches("<svg ").count(), 5);
    assert_eq!(page.matches("class=\"pair\"").count(), 2 * 24 + 2 * 12);
    assert_eq!(page.matches("class=\"swatch\"").count(), 24 + 2);
    let elsewhere = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!elsewhere.contains("http") && !page.contains("<script") && !page.contains("NaN"));
    // Text from the user is escaped and never becomes markup.
    let odd = r#"{"file": "<b>&.csv"}"#;
    std::fs::write(folder.path().join("<b>&.csv"), "nm,value\n360,1\n830,1\n").unwrap();
    assert_eq!(abbe(folder.path(), &["lamps", odd, "D65", "--html", "page.html"]).status, 0);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.contains("&lt;b&gt;&amp;.csv") && !page.contains("<b>&.csv"));
}

/// The values of FL2 and LED-B1 are those of `tests/golden/rendition.json`.
#[test]
fn lamps_have_their_colour_rendition() {
    let folder = tempfile::tempdir().unwrap();
    let compared = abbe(folder.path(), &["lamps", "FL2", "LED-B1", "--json"]).json();
    for (lamp, rf, rg) in [("a", 70.1, 86.4), ("b", 84.1, 96.1)] {
        let tm30 = &compared[lamp]["tm30"];
        let near = |key: &str, known: f64| (tm30[key].as_f64().unwrap() - known).abs() < 0.1;
        assert!(near("rf", rf) && near("rg", rg), "{tm30}");
        for key in ["rf_bins", "chroma_shift_percent", "hue_shift"] {
            assert_eq!(tm30[key].as_array().unwrap().len(), 16, "{key}: {tm30}");
        }
    }
    let text = abbe(folder.path(), &["lamps", "FL2", "LED-B1"]).out;
    let row = |name: &str| {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
        line.split_whitespace().map(str::to_string).collect::<Vec<_>>()
    };
    assert_eq!(
        (row("Rf"), row("Rg")),
        (vec!["Rf".into(), "70.1".into(), "84.1".into()], vec!["Rg".into(), "86.4".into(), "96.1".into()])
    );
    // Green light has no colour temperature, and so it has no rendition.
    let green = r#"{"lines": [{"nm": 532, "power": 1}]}"#;
    let arguments = ["lamps", "FL2", green, "--json", "--html", "page.html"];
    assert!(abbe(folder.path(), &arguments).json()["b"]["tm30"].is_null());
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(
        page.matches("<svg ").count() == 4 && page.contains("Rf 70.1, Rg 86.4") && page.contains("</span> undefined")
    );
}

#[test]
fn a_third_lamp_is_compared_with_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let three = abbe(folder.path(), &["lamps", "D65", "A", "FL2", "--json"]).json();
    let two = abbe(folder.path(), &["lamps", "D65", "FL2", "--json"]).json();
    assert!(two["c"].is_null() && three["c"]["name"] == "FL2");
    for key in ["lights", "patches", "delta_e_2000", "metameric_pairs", "verdict"] {
        assert_eq!(three["c"][key], two[key], "{key}");
    }
    assert_eq!(three["c"]["ra"], two["b"]["ra"]);
    assert_eq!(three["c"]["tm30"], two["b"]["tm30"]);
    let text = abbe(folder.path(), &["lamps", "D65", "A", "FL2"]).out;
    for words in ["\nC  FL2\n", "D65 and FL2 differ clearly in colour; ", "A from C ", "ΔE2000 between A and C"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(text.lines().all(|line| line.trim_end() == line), "{text}");
    abbe(folder.path(), &["lamps", "D65", "A", "FL2", "--html", "page.html"]).is_error(2, &["--html"]);
}

/// The warning, the table and the difference of the lights state the same ΔE.
#[test]
fn a_match_has_one_colour_difference() {
    let folder = tempfile::tempdir().unwrap();
    let said = abbe(folder.path(), &SODIUM);
    let difference = |line: &str| {
        let from = line.find("Δxy").unwrap();
        line[from..].split([',', ' ']).filter(|word| !word.is_empty()).take(4).collect::<Vec<_>>().join(" ")
    };
    let lines: Vec<&str> = said.out.lines().filter(|line| line.contains("Δxy")).chain([said.err.as_str()]).collect();
    assert_eq!(lines.len(), 3, "{}", said.out);
    assert!(lines.iter().all(|line| difference(line) == difference(lines[0])), "{lines:?}");
}

/// A Lambertian luminaire: the flux is π I₀, and the beam angle is 120°.
const LAMBERTIAN: &str = "IESNA:LM-63-2002\n[MANUFAC] Abbe & <Sons>\nTILT=NONE\n1 1000 10 10 1 1 2 0.5 0.2 0\n1 1 25\n\
    0 10 20 30 40 50 60 70 80 90\n0\n100 98.481 93.969 86.603 76.604 64.279 50 34.202 17.365 0\n";

#[test]
fn a_luminaire_is_described_with_its_polar_diagram() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.IES"), LAMBERTIAN).unwrap();
    let said = abbe(folder.path(), &["lamps", "lamp.IES", "--html", "page.html"]);
    assert!(said.status == 0 && said.err.is_empty(), "{}", said.err);
    for words in [
        "Abbe & <Sons>\n",
        "IES LM-63-2002, type C, 10 × 1 angles",
        "rotational",
        "peak            1000.0 cd at γ 0.0°",
        "beam angle      120.0° in C0–C180, 120.0° in C90–C270",
        "lm/W at 25 W",
        "0.200 m along C0 × 0.500 m",
    ] {
        assert!(said.out.contains(words), "{words}: {}", said.out);
    }
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
    assert!(page.contains("Abbe &amp; &lt;Sons&gt;") && page.matches("<svg ").count() == 1 && page.contains("1000 cd"));
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http") && !page.contains("NaN"));
    let json = abbe(folder.path(), &["lamps", "lamp.IES", "--json"]).json();
    // Linear interpolation in steps of 10° loses 0.25 % of the flux.
    let flux = std::f64::consts::PI * 1000.0;
    assert_near("flux", &json["flux_lm"], &json!(flux), 0.003 * flux);
    assert_near("downward", &json["downward"], &json!(1.0), 1e-4);
    assert_near("efficacy", &json["efficacy_lm_per_w"], &json!(flux / 25.0), 0.003 * flux / 25.0);
    let lamps = |arguments: &[&str]| abbe(folder.path(), &[&["lamps"], arguments].concat());
    lamps(&["lamp.IES", "D65"]).is_error(2, &["luminaire", "alone"]);
    lamps(&["missing.ldt"]).is_error(2, &["missing.ldt"]);
    std::fs::write(folder.path().join("bad.ies"), LAMBERTIAN.replace(" 80 90", " 80 70")).unwrap();
    lamps(&["bad.ies"]).is_error(2, &["bad.ies:6:27: a vertical angle: 70", "above the one before it, 80°"]);
}

/// The luminaire of `LAMBERTIAN` as TM-33, with a spectrum of equal power from 400 to 700 nm.
const LAMBERTIAN_TM33: &str = r#"<?xml version="1.0"?>
<IESTM33><Version>1.0</Version><Header><Manufacturer>Abbe</Manufacturer><Description>panel</Description></Header>
<Emitter><Quantity>2</Quantity><Description>LED</Description><InputWattage>25</InputWattage><LuminousData><LuminousIntensity>
<Multiplier>10</Multiplier><NumberHorz>1</NumberHorz><NumberVert>10</NumberVert>
<IntData h="0" v="0">100</IntData><IntData h="0" v="10">98.481</IntData><IntData h="0" v="20">93.969</IntData>
<IntData h="0" v="30">86.603</IntData><IntData h="0" v="40">76.604</IntData><IntData h="0" v="50">64.279</IntData>
<IntData h="0" v="60">50</IntData><IntData h="0" v="70">34.202</IntData><IntData h="0" v="80">17.365</IntData>
<IntData h="0" v="90">0</IntData></LuminousIntensity></LuminousData>
<SpectralData><EmitterSpectral><PwrData w="400">1</PwrData><PwrData w="700">1</PwrData></EmitterSpectral></SpectralData>
<EmissionAreas><BottomFace><BottomArea><Length>0.5</Length><Width>0.2</Width><LengthOffset>0</LengthOffset>
<WidthOffset>0</WidthOffset></BottomArea></BottomFace></EmissionAreas></Emitter></IESTM33>
"#;

#[test]
fn a_tm33_luminaire_has_the_figures_of_the_same_ies_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.ies"), LAMBERTIAN).unwrap();
    let known = abbe(folder.path(), &["lamps", "lamp.ies", "--json"]).json();
    for name in ["lamp.tm33", "lamp.xml"] {
        std::fs::write(folder.path().join(name), LAMBERTIAN_TM33).unwrap();
        let found = abbe(folder.path(), &["lamps", name, "--json"]).json();
        for figure in ["flux_lm", "downward", "peak_cd", "beam_deg", "field_deg", "input_watts", "symmetry"] {
            assert_eq!(found[figure], known[figure], "{figure}");
        }
        assert!(known["xy"].is_null() && (found["xy"][0].as_f64().unwrap() - 0.333).abs() < 0.01, "{found}");
    }
    let said = abbe(folder.path(), &["lamps", "lamp.xml"]);
    assert!(
        said.err.contains("note: the emitter \"LED\": the intensities are those of all 2 emitters"),
        "{}",
        said.err
    );
    for words in ["Abbe, panel\n", "IES TM-33-18, type C", "spectrum        xy 0.33", "0.200 m along C0 × 0.500 m"] {
        assert!(said.out.contains(words), "{words}: {}", said.out);
    }
    std::fs::write(folder.path().join("bad.tm33"), LAMBERTIAN_TM33.replace("v=\"80\"", "v=\"60\"")).unwrap();
    abbe(folder.path(), &["lamps", "bad.tm33"]).is_error(2, &["bad.tm33:7:", "above the one before it, 60°"]);
}

/// The illuminance 2 m below a luminaire of 1000 cd is 250 lx, and its spectrum is that of the
/// file.
#[test]
fn a_tm33_luminaire_lights_a_scene_with_its_own_spectrum() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.tm33"), LAMBERTIAN_TM33).unwrap();
    let scene = |light: &str| {
        let scene = format!(
            r#"{{"objects": [], "lights": [{{"ies": {{"at": [0, 2, 0], "toward": [0, -1, 0], "path": "lamp.tm33"{light}}}}}],
            "meters": [{{"name": "below", "points": [[0, 0, 0]]}},
                       {{"name": "bands", "quantity": "spectral_irradiance", "points": [[0, 0, 0]]}}]}}"#
        );
        std::fs::write(folder.path().join("scene.json"), scene).unwrap();
        abbe(folder.path(), &["measure", "scene.json", "--passes", "64", "--json"])
    };
    let said = scene("");
    assert!(said.err.contains("lamp.tm33: the emitter \"LED\""), "{}", said.err);
    let report = said.json();
    assert_near("illuminance", &report["meters"][0]["points"][0]["value"], &json!(250.0), 0.5);
    let bands = &report["meters"][1];
    let nm = bands["wavelength_nm"].as_array().unwrap().iter().map(|nm| nm.as_f64().unwrap());
    let values = bands["points"][0]["value"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap());
    // 250 lx of a flat spectrum from 400 to 700 nm.
    let expected = 250.0 / (683.0 * 106.86);
    for (nm, value) in nm.zip(values) {
        let is_inside = (402.0..698.0).contains(&nm);
        assert!(if is_inside { (value / expected - 1.0).abs() < 0.2 } else { value < 0.6 * expected }, "{nm}: {value}");
        assert!(is_inside || (397.0..703.0).contains(&nm) || value == 0.0, "{nm}: {value}");
    }
    let dark = LAMBERTIAN_TM33.replace("SpectralData", "OtherData");
    std::fs::write(folder.path().join("lamp.tm33"), dark).unwrap();
    scene("").is_error(2, &["lights[0].ies", "missing key \"spectrum\""]);
    assert_near("D65", &scene(r#", "spectrum": "D65""#).json()["meters"][0]["points"][0]["value"], &json!(250.0), 0.5);
}

/// R9 of FL2 is negative (CIE 13.3: a lamp with little red).
#[test]
fn the_rendering_of_red_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    let json = abbe(folder.path(), &["lamps", "FL2", "D65", "--json"]).json();
    assert!(json["a"]["r9"].as_f64().unwrap() < 0.0 && json["b"]["r9"].as_f64().unwrap() > 99.0, "{json}");
    assert!(abbe(folder.path(), &["lamps", "FL2", "D65"]).out.contains("\nR9            -"));
}

/// The colours of the fluorescent surfaces have their golden values for a single reflection.
#[test]
fn fluorescent_surfaces_have_golden_colours() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["lamps", "D65", "A"];
    let found = abbe(folder.path(), &[&arguments[..], &["--json"]].concat()).json();
    let file = golden("fluorescence.json");
    let names = ["optical brightener on paper", "red day-glow"];
    for (surface, name) in found["fluorescent"].as_array().unwrap().iter().zip(names) {
        for (i, light) in ["D65", "A"].into_iter().enumerate() {
            let cases = file["single_reflection"].as_array().unwrap();
            let matches = |case: &&serde_json::Value| case["material"] == name && case["light"] == light;
            // Later cases of the same surface include the ultraviolet from 300 nm.
            let known = &cases.iter().rfind(matches).unwrap()["XYZ"];
            for c in 0..3 {
                let value = 100.0 * known[c].as_f64().unwrap();
                assert_near(name, &surface["xyz"][i][c], &json!(value), 1e-5 * value);
            }
        }
    }
    assert!(abbe(folder.path(), &arguments).out.contains("\n  red day-glow                 A"));
}
