//! The regression set: its expected values against values computed independently, and its exported
//! spectra against its expected values.

use crate::common::near::{assert_near, assert_near_relative};
use crate::golden::golden;
use abbe_spectra::colour::regress::{CaseGroup, ColourForm, RegressionCase, RegressionSet};
use abbe_spectra::spectrum::{BAND_NM, Observer, library};
use serde_json::Value;

fn numbers(value: &Value) -> [f64; 3] {
    std::array::from_fn(|i| value[i].as_f64().expect("three numbers"))
}

/// Returns the case with this id.
fn case(id: &str) -> &'static RegressionCase {
    RegressionSet::first().cases.iter().find(|case| case.id == id).unwrap_or_else(|| panic!("no case {id}"))
}

fn xyz(case: &RegressionCase) -> [f64; 3] {
    case.expected.get(ColourForm::Xyz).expect("every case has XYZ")
}

fn linear_srgb(case: &RegressionCase) -> [f64; 3] {
    case.expected.get(ColourForm::LinearSrgb).expect("every case has linear sRGB")
}

/// Returns the name of a lamp in the golden files.
fn golden_name(name: &str) -> &str {
    match name {
        "sodium-low-pressure" => "LPS_D_thin",
        "sodium-d" => "LPS_mono",
        "helium-neon-laser" => "HeNe_632.8",
        "mercury-medium-pressure" => "Hg_medium_pressure",
        "neon-glow" => "Ne_glow_580_725",
        "hydrogen-balmer" => "H_Balmer_NIST",
        "laser-rgb" => "laser_RGB_638_520_450",
        "rec2020-primaries" => "BT2020_primaries_630_532_467",
        "led/white" => "LEDmodel_white",
        "sun/am1.5-global" => "SUN_AM15G",
        "sodium-high-pressure" => "lamp HPS",
        other => other,
    }
}

/// Returns the title of a patch in the golden files.
fn patch_title(patch: &str) -> String {
    let known = library::list().iter().find(|entry| entry.name == patch).unwrap();
    known.description.split_once(": ").unwrap().1.to_string()
}

#[test]
fn lamps_have_the_golden_colours() {
    let golden = golden("lamps.json");
    let mut checked = 0;
    for group in [CaseGroup::Lamps, CaseGroup::Lines] {
        for case in RegressionSet::first().cases.iter().filter(|case| case.group == group) {
            let name = golden_name(&case.id);
            let known = golden["illuminants"].get(name).or_else(|| golden["line_lamps"].get(name));
            let known = known.unwrap_or_else(|| panic!("{name}"));
            assert_near_relative(name, xyz(case), numbers(&known["XYZ_Y100"]), 1e-6);
            assert_near_relative(name, linear_srgb(case), numbers(&known["linear_srgb_Y1"]), 1e-6);
            checked += 1;
        }
    }
    assert_eq!(checked, 20);
}

#[test]
fn lines_have_the_golden_colours() {
    let mut checked = 0;
    for known in golden("monochromatic.json")["rows"].as_array().unwrap() {
        let nm = known["wavelength_nm"].as_f64().unwrap();
        let Some(case) = RegressionSet::first().cases.iter().find(|case| case.id == format!("line/{nm}")) else {
            continue;
        };
        let bar = numbers(&known["xyz_bar"]);
        assert_near_relative(&case.id, xyz(case), bar.map(|value| 100.0 * value / bar[1]), 1e-6);
        let srgb = numbers(&known["linear_srgb_for_Y_equal_ybar"]).map(|value| value / bar[1]);
        assert_near_relative(&case.id, linear_srgb(case), srgb, 1e-6);
        checked += 1;
    }
    assert_eq!(checked, 27);
}

#[test]
fn surfaces_have_the_golden_colours() {
    let (chart, metamers) = (golden("colorchecker.json"), golden("metamers.json"));
    let mut checked = 0;
    for case in &RegressionSet::first().cases {
        let Some(patch) = &case.reflectance else { continue };
        let title = patch_title(patch);
        match case.group {
            CaseGroup::Surfaces => {
                let known = &chart["by_light"][golden_name(&case.light)]["patches"][&title];
                assert_near_relative(&case.id, xyz(case), numbers(&known["XYZ"]), 1e-6);
                assert_near(&case.id, linear_srgb(case), numbers(&known["linear_srgb_none"]), 2e-6);
            }
            CaseGroup::Metamers => {
                let known = &metamers["by_lamp"]["HP1"]["patches"][&title];
                assert_near_relative(&case.id, xyz(case), numbers(&known["XYZ_led"]), 1e-6);
            }
            CaseGroup::Lamps | CaseGroup::Lines | CaseGroup::Monochromatic | CaseGroup::Fluorescent => {
                panic!("{} is no surface", case.id)
            }
        }
        checked += 1;
    }
    assert_eq!(checked, 9 * 24);
    let (lamp, leds) = (xyz(case("HP1")), xyz(case("led-match/HP1")));
    assert_near_relative("the LEDs match the lamp", leds, lamp, 1e-6);
}

/// The sum over samples in steps of 1 nm, and over lines, gives the expected XYZ. A converter needs
/// nothing but the exported data.
#[test]
fn sums_over_the_exported_samples_are_the_expected_values() {
    let set = RegressionSet::first();
    let spectrum = |name: &str| &set.spectra.iter().find(|entry| entry.name == name).unwrap().spectrum;
    let observer = Observer::cie1931();
    for case in &set.cases {
        let light = spectrum(&case.light);
        let sum = |reflectance: &dyn Fn(f64) -> f64| {
            let mut sum = [0.0; 3];
            let mut add = |nm: f64, value: f64| {
                let bar = observer.xyz_bar(nm);
                (0..3).for_each(|i| sum[i] += value * bar[i]);
            };
            for nm in (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from) {
                add(nm, light.continuum_at(nm) * reflectance(nm));
            }
            for line in light.line_segments() {
                add(line.centre(), line.power * reflectance(line.centre()));
            }
            sum
        };
        let white = sum(&|_| 1.0)[1];
        let sum = match &case.reflectance {
            Some(patch) => sum(&|nm| spectrum(patch).continuum_at(nm)),
            None => sum(&|_| 1.0),
        };
        assert_near_relative(&case.id, sum.map(|value| 100.0 * value / white), xyz(case), 1e-9);
    }
}

/// The values of a published set never change.
#[test]
fn the_first_set_is_frozen() {
    let known = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/regress_1.csv")).unwrap();
    let rows: Vec<&str> = known.lines().skip(1).collect();
    let cases = &RegressionSet::first().cases;
    assert_eq!(rows.len(), cases.len());
    for (row, case) in rows.iter().zip(cases) {
        let (id, values) = row.split_once(',').unwrap();
        assert_eq!(id, case.id);
        let values: Vec<f64> = values.split(',').map(|value| value.parse().unwrap()).collect();
        let found: Vec<f64> = case.expected.iter().flat_map(|(_, colour)| colour).collect();
        assert_eq!(values.len(), found.len());
        for (value, found) in values.iter().zip(found) {
            assert!((value - found).abs() <= 1e-12 * value.abs().max(1.0), "{id}: {value} {found}");
        }
    }
}

/// The values of the second set are those that colour-science computes.
#[test]
fn the_second_set_has_the_golden_colours() {
    let known = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/regress_2.csv")).unwrap();
    let cases = &RegressionSet::second().cases;
    assert_eq!(known.lines().count(), cases.len());
    for (row, case) in known.lines().zip(cases) {
        let (id, values) = row.split_once(',').unwrap();
        assert_eq!(id, case.id);
        let values: Vec<f64> = values.split(',').map(|value| value.parse().unwrap()).collect();
        let forms: Vec<(ColourForm, [f64; 3])> = case.expected.iter().collect();
        assert_eq!((forms.len(), values.len()), (ColourForm::ALL.len(), 3 * forms.len()));
        for ((form, found), known) in forms.iter().zip(values.chunks_exact(3)) {
            let name = format!("{id} {}", form.name());
            assert_near(&name, *found, [known[0], known[1], known[2]], if known[1].abs() > 2.0 { 1e-5 } else { 1e-6 });
        }
    }
}
