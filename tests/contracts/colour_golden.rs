//! Colours of lamps, black bodies, patches, metals and lines against values computed independently.
//!
//! The values under `tests/golden` were computed with numpy and colour-science from the same
//! tables; each file states its method. Tolerances are those of the data's own description: 10⁻⁶
//! relative for XYZ, 10⁻⁵ in x, y, 0.5 K or 10⁻⁴ for colour temperatures, 10⁻⁶ for Duv, 0.05 for
//! the rendering indices.

use crate::common::near::{assert_near, assert_near_relative};
use crate::golden::golden;
use abbe_spectra::colour::{self, AdaptationTransform, CorrelatedTemperature, RgbSpace, report};
use abbe_spectra::spectrum::{BAND_NM, LUMENS_PER_WATT, Observer, SpectralLine, Spectrum, library, planck};
use serde_json::Value;

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list = value.as_array().expect("a list");
    assert_eq!(list.len(), N);
    std::array::from_fn(|i| list[i].as_f64().expect("a number"))
}

/// Returns the library's spectrum of a lamp by its name in the golden files.
fn lamp(name: &str) -> Spectrum {
    let renamed = match name {
        "LPS_D_thin" => "sodium-low-pressure",
        "LPS_D_equal" => "sodium-low-pressure-equal",
        "LPS_mono" => "sodium-d",
        "HeNe_632.8" => "helium-neon-laser",
        "Hg_medium_pressure" => "mercury-medium-pressure",
        "Hg_NIST_intensities" => "mercury-nist",
        "Ne_NIST_intensities" => "neon-nist",
        "Ne_glow_580_725" => "neon-glow",
        "H_Balmer_NIST" => "hydrogen-balmer",
        "He_NIST_intensities" => "helium-nist",
        "laser_RGB_638_520_450" => "laser-rgb",
        "BT2020_primaries_630_532_467" => "rec2020-primaries",
        "LEDmodel_white" => "led/white",
        "LEDmodel_R" => "led/red",
        "LEDmodel_G" => "led/green",
        "LEDmodel_B" => "led/blue",
        "SUN_AM0" => "sun/am0",
        "SUN_AM15G" => "sun/am1.5-global",
        "SUN_AM15D" => "sun/am1.5-direct",
        "SKY_zenith" => "sky/zenith",
        other => other,
    };
    if let Some(measured) = renamed.strip_prefix("lamp ") {
        let known = library::list()
            .iter()
            .find(|entry| entry.name.starts_with("lamp/") && entry.description.ends_with(&format!(": {measured}")));
        return library::find(known.unwrap_or_else(|| panic!("{name}")).name)
            .expect("the golden files and the library agree")
            .spectrum;
    }
    library::find(renamed).expect("the golden files and the library agree").spectrum
}

fn unit(xyz: [f64; 3], scale: f64) -> [f64; 3] {
    xyz.map(|value| value * scale / xyz[1])
}

const D50_WHITE: [f64; 3] = [0.964_240_577_465_802_6, 1.0, 0.825_127_799_994_720_2];

fn check_lamp(name: &str, light: &Spectrum, known: &Value) {
    let xyz = report::xyz(light, Observer::cie1931());
    let xyz_100 = unit(xyz, 100.0);
    assert_near_relative(name, xyz_100, numbers::<3>(&known["XYZ_Y100"]), 1e-6);
    assert_near(name, colour::xy(xyz), numbers::<2>(&known["xy"]), 1e-5);
    assert_near(name, colour::uv1976(xyz), numbers::<2>(&known["uv1976"]), 1e-5);
    let srgb = colour::xyz_to_linear_srgb(unit(xyz, 1.0));
    assert_near_relative(name, srgb, numbers::<3>(&known["linear_srgb_Y1"]), 1e-6);
    let adapted = colour::adapt(unit(xyz, 1.0), D50_WHITE, RgbSpace::Srgb.white(), AdaptationTransform::Bradford);
    let known_adapted = numbers::<3>(&known["linear_srgb_Y1_bradford_D50_to_D65"]);
    assert_near_relative(name, colour::xyz_to_linear_srgb(adapted), known_adapted, 1e-6);
    let xy_10 = colour::xy(report::xyz(light, Observer::cie1964()));
    assert_near(name, xy_10, numbers::<2>(&known["xy_10deg"]), 1e-5);
    if let Some(raw) = known.get("raw_sum_XYZ") {
        assert_near_relative(name, xyz, numbers::<3>(raw), 1e-6);
    }
    if let Some(efficacy) = known.get("luminous_efficacy_lm_per_W") {
        let found = report::ColourReport::of_light(light, Observer::cie1931())
            .expect("the golden files and the library agree")
            .efficacy_lm_per_w
            .expect("the golden files and the library agree");
        assert_near_relative(name, [found], [efficacy.as_f64().expect("a number")], 1e-6);
    }
}

/// Checks the colour temperature if the golden value has a meaningful one.
fn check_temperature(name: &str, light: &Spectrum, known: &Value) -> Option<CorrelatedTemperature> {
    if known["cct_meaningful"] != Value::Bool(true) {
        return None;
    }
    let found =
        colour::cct_duv(report::xyz(light, Observer::cie1931())).expect("the golden files and the library agree");
    let cct_k = known["cct_K"].as_f64().expect("a number");
    assert!((found.cct_k - cct_k).abs() <= 0.5_f64.max(1e-4 * cct_k), "{name}: {} K, not {cct_k} K", found.cct_k);
    assert_near(name, [found.duv], [known["duv"].as_f64().expect("a number")], 1e-6);
    Some(found)
}

#[test]
fn every_lamp_of_the_library_has_its_colour_and_temperature() {
    let golden = golden("lamps.json");
    let lamps = golden["illuminants"].as_object().unwrap();
    assert!(lamps.len() >= 90);
    for (name, known) in lamps.iter().chain(golden["line_lamps"].as_object().unwrap()) {
        let light = lamp(name);
        check_lamp(name, &light, known);
        check_temperature(name, &light, known);
    }
}

#[test]
fn every_lamp_renders_the_test_colours_as_cie_13_3_says() {
    let golden = golden("lamps.json");
    let mut checked = 0;
    for (name, known) in golden["illuminants"].as_object().unwrap() {
        let (Some(ra), Some(special)) = (known.get("cri_Ra"), known.get("cri_R1_to_R14")) else { continue };
        let light = lamp(name);
        let temperature = colour::cct_duv(report::xyz(&light, Observer::cie1931())).unwrap();
        let found = colour::cri(&light, temperature).unwrap();
        assert_near(name, [found.ra], [ra.as_f64().unwrap()], 0.05);
        assert_near(name, found.special, numbers::<14>(special), 0.05);
        checked += 1;
    }
    assert!(checked >= 80, "{checked}");
}

#[test]
fn black_bodies_have_their_colour_luminance_and_radiance() {
    for (name, known) in golden("blackbody.json")["temperatures_K"].as_object().unwrap() {
        let temperature: f64 = name.parse().unwrap();
        let body = Spectrum::blackbody(temperature).unwrap();
        check_lamp(name, &body, known);
        let luminance = LUMENS_PER_WATT * report::xyz(&body, Observer::cie1931())[1];
        assert_near_relative(name, [luminance], [known["luminance_cd_m2"].as_f64().unwrap()], 1e-6);
        let sum: f64 = (380..=780).map(|nm| body.at(f64::from(nm))).sum();
        assert_near_relative(name, [sum], [known["radiance_380_780_W_m2_sr"].as_f64().unwrap()], 1e-6);
        for (nm, radiance) in known["spectral_radiance_W_m3_sr"].as_object().unwrap() {
            let found = planck(nm.parse().unwrap(), temperature);
            assert_near_relative(name, [found], [radiance.as_f64().unwrap()], 1e-9);
        }
    }
}

#[test]
fn the_colorchecker_has_its_colours_under_every_lamp() {
    for (name, known) in golden("colorchecker.json")["by_light"].as_object().unwrap() {
        let light = lamp(name);
        let white = report::xyz(&light, Observer::cie1931());
        assert_near_relative(name, unit(white, 100.0), numbers::<3>(&known["white_XYZ"]), 1e-6);
        let patches = known["patches"].as_object().unwrap();
        assert_eq!(patches.len(), 24);
        for (patch, known) in patches {
            let what = format!("{patch} under {name}");
            let surface = patch_of(patch);
            let xyz = report::xyz_under(&surface, &light, Observer::cie1931()).map(|value| 100.0 * value / white[1]);
            assert_near_relative(&what, xyz, numbers::<3>(&known["XYZ"]), 1e-6);
            assert_near(&what, colour::xy(xyz), numbers::<2>(&known["xy"]), 1e-5);
            let of_unit = |xyz: [f64; 3]| colour::xyz_to_linear_srgb(xyz.map(|value| value / 100.0));
            assert_near(&what, of_unit(xyz), numbers::<3>(&known["linear_srgb_none"]), 2e-6);
            let adapted = colour::adapt(xyz, white, RgbSpace::Srgb.white(), AdaptationTransform::Bradford);
            assert_near(&what, of_unit(adapted), numbers::<3>(&known["linear_srgb_bradford"]), 2e-6);
        }
    }
}

/// Returns the library's patch for a chart title such as `neutral 8 (.23 D)`.
fn patch_of(title: &str) -> Spectrum {
    let known = library::list()
        .iter()
        .find(|entry| entry.name.starts_with("colorchecker/") && entry.description.ends_with(&format!(": {title}")));
    library::find(known.unwrap_or_else(|| panic!("{title}")).name)
        .expect("the golden files and the library agree")
        .spectrum
}

#[test]
fn monochromatic_light_has_the_colour_of_the_matching_functions() {
    let golden = golden("monochromatic.json");
    for known in golden["rows"].as_array().unwrap().iter().chain(golden["named"].as_array().unwrap()) {
        let nm = known["wavelength_nm"].as_f64().unwrap();
        let what = format!("{nm} nm");
        let bar = Observer::cie1931().xyz_bar(nm);
        assert_near_relative(&what, bar, numbers::<3>(&known["xyz_bar"]), 1e-9);
        let line = Spectrum::lines(&[SpectralLine { nm, power: 1.0, fwhm_nm: None }]).unwrap();
        // The outer half of a line at the edge of the band is cut off, which shifts the centroid.
        let on_edge = nm == BAND_NM.0 || nm == BAND_NM.1;
        let xyz = if on_edge { bar } else { report::xyz(&line, Observer::cie1931()) };
        assert_near(&what, [line.integral()], [if on_edge { 0.5 } else { 1.0 }], 1e-9);
        assert_near(&what, colour::xy(xyz), numbers::<2>(&known["xy"]), 1e-5);
        let srgb = colour::xyz_to_linear_srgb(xyz);
        assert_near_relative(&what, srgb, numbers::<3>(&known["linear_srgb_for_Y_equal_ybar"]), 1e-6);
        assert_near_relative(&what, [LUMENS_PER_WATT * xyz[1]], [known["lm_per_W"].as_f64().unwrap()], 1e-6);
    }
}

#[test]
fn metameric_lamps_split_the_colorchecker_as_far_as_computed() {
    for (name, known) in golden("metamers.json")["by_lamp"].as_object().unwrap() {
        let light = lamp(name);
        let observer = Observer::cie1931();
        let primaries = ["led/red", "led/green", "led/blue"].map(|name| library::find(name).unwrap().spectrum);
        let xyz = primaries.each_ref().map(|primary| report::xyz(primary, observer));
        let found = colour::match_primaries(report::xyz(&light, observer), &xyz).unwrap();
        assert!(found.is_exact());
        assert_near_relative(name, &found.weights, numbers::<3>(&known["weights"]), 1e-6);
        let twin = found.mix(&primaries);
        let patches = known["patches"].as_object().unwrap();
        let surfaces: Vec<(&str, Spectrum)> = patches.keys().map(|title| (title.as_str(), patch_of(title))).collect();
        let compared = colour::compare_lights([&light, &twin], &surfaces, observer);
        for (patch, known) in compared.iter().zip(patches.values()) {
            let what = format!("{} under {name}", patch.name);
            assert_near_relative(&what, patch.xyz[0], numbers::<3>(&known["XYZ_lamp"]), 1e-6);
            assert_near_relative(&what, patch.xyz[1], numbers::<3>(&known["XYZ_led"]), 1e-6);
            assert_near(&what, patch.lab[0], numbers::<3>(&known["Lab_lamp"]), 1e-4);
            assert_near(&what, patch.lab[1], numbers::<3>(&known["Lab_led"]), 1e-4);
            assert_near(&what, [patch.delta_e_2000], [known["deltaE2000"].as_f64().unwrap()], 1e-4);
        }
        let mean = compared.iter().map(|patch| patch.delta_e_2000).sum::<f64>() / compared.len() as f64;
        assert_near(name, [mean], [known["mean_deltaE2000"].as_f64().unwrap()], 1e-4);
    }
}

#[test]
fn reflectances_made_from_rgb_have_its_colour_under_d65() {
    let d65 = lamp("D65");
    let white = report::xyz(&d65, Observer::cie1931())[1];
    for known in golden("rgb_to_spectrum.json")["under_D65"].as_array().unwrap() {
        let rgb = numbers::<3>(&known["rgb_linear"]);
        let surface = Spectrum::rgb_reflectance(rgb).unwrap();
        let xyz = report::xyz_under(&surface, &d65, Observer::cie1931()).map(|value| value / white);
        assert_near(&format!("{rgb:?}"), xyz, numbers::<3>(&known["target_XYZ"]), 5e-4);
        assert_near(&format!("{rgb:?}"), colour::xyz_to_linear_srgb(xyz), rgb, 1e-3);
        // Another program that fits the same family of curves must agree where the fit is well
        // determined: away from white.
        if rgb != [1.0; 3] {
            for (nm, reflectance) in known["reflectance_at"].as_object().unwrap() {
                let found = surface.at(nm.parse().unwrap());
                assert_near(&format!("{rgb:?} at {nm}"), [found], [reflectance.as_f64().unwrap()], 2e-3);
            }
        }
    }
}

#[test]
fn metals_have_their_reflectance_and_colour() {
    let golden = golden("metals.json");
    let normal = |n: f64, k: f64| ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
    for known in golden["normal_reflectance"].as_array().unwrap() {
        let name = known["metal"].as_str().unwrap();
        let nm = known["wavelength_nm"].as_f64().unwrap();
        let (n, k) = library::metal(name).unwrap().index();
        assert_near_relative(name, [n.at(nm)], [known["n"].as_f64().unwrap()], 1e-9);
        assert_near_relative(name, [k.at(nm)], [known["k"].as_f64().unwrap()], 1e-9);
        assert_near(name, [normal(n.at(nm), k.at(nm))], [known["R_normal"].as_f64().unwrap()], 1e-9);
    }
    let d65 = lamp("D65");
    let white = report::xyz(&d65, Observer::cie1931())[1];
    for (name, known) in golden["colour_under_D65"].as_object().unwrap() {
        let (n, k) = library::metal(name).unwrap().index();
        let nm: Vec<f64> = (360..=830).map(f64::from).collect();
        let values: Vec<f64> = nm.iter().map(|&nm| normal(n.at(nm), k.at(nm))).collect();
        let surface = Spectrum::table(&nm, &values, abbe_spectra::spectrum::Outside::Hold).unwrap();
        let xyz = report::xyz_under(&surface, &d65, Observer::cie1931()).map(|value| value / white);
        assert_near_relative(name, xyz, numbers::<3>(&known["XYZ"]), 1e-6);
        assert_near(name, colour::xyz_to_linear_srgb(xyz), numbers::<3>(&known["linear_srgb"]), 2e-6);
    }
}
