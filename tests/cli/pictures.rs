//! `abbe compare` and `abbe probe` on synthetic pictures.

use crate::abbe_command::abbe;
use abbe_session::output::{Metadata, exr, heat, png};
use abbe_transport::sensor::{DisplayImage, Picture, SpectralBands};
use std::path::Path;
use tempfile::TempDir;

/// A folder with `a.exr` (Y = 1.1 in the left half, 1 in the right), `b.exr` (Y = 1), both with
/// error layers, and `small.exr`.
fn pictures() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let picture = |left: f64, width: usize| {
        let mut picture = Picture::black(width, 4);
        for i in 0..width * 4 {
            let y = if i % width < width / 2 { left } else { 1.0 };
            picture.xyz[i] = [0.95 * y, y, 1.09 * y];
        }
        picture.noise.fill(Some(0.03));
        picture.bias.fill(Some(0.0));
        picture
    };
    let write =
        |name: &str, picture: &Picture| exr::write(&folder.path().join(name), picture, &Metadata::new()).unwrap();
    write("a.exr", &picture(1.1, 8));
    write("b.exr", &picture(1.0, 8));
    write("small.exr", &picture(1.0, 4));
    let mut spectral = picture(1.0, 8);
    let values = (0..8 * 4 * 2).map(|i| i as f32).collect();
    spectral.bands = Some(SpectralBands { centres_nm: vec![477.5, 712.5], values });
    (spectral.noise[0], spectral.bias[0]) = (None, None);
    write("spectral.exr", &spectral);
    folder
}

#[test]
fn compare_prints_the_figures_that_the_contract_names() {
    let folder = pictures();
    let all = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--json"]).json();
    let near = |value: &serde_json::Value, known: f64| (value.as_f64().unwrap() - known).abs() < 1e-6;
    assert!(near(&all["relative_mse"], 0.5 * 0.01 / 1.01), "{all}");
    assert!(near(&all["rmse"], 0.1 / 2.0_f64.sqrt()), "{all}");
    assert!(near(&all["mean_ratio"], 1.05), "{all}");
    assert!(near(&all["z"]["share"], 0.5), "{all}");
    // The difference 0.1 exceeds 2.262 · 0.03 · √2.
    assert!(near(&all["covered"]["share"], 0.5) && all["covered"]["pixels"] == 32 && all["unknown_pixels"] == 0);
    assert!(all["relative_mse_trimmed"].is_f64() && all["delta_e_2000"]["mean"].is_f64());
    assert!(all["delta_e_2000"]["p95"].as_f64() > all["delta_e_2000"]["mean"].as_f64());

    let left = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--json", "--region", "0,0,4,4"]).json();
    assert!(near(&left["relative_mse"], 0.01 / 1.01) && near(&left["z"]["share"], 0.0), "{left}");
    let words = abbe(folder.path(), &["compare", "a.exr", "b.exr"]);
    assert!(words.status == 0 && words.out.contains("relative MSE") && words.err.is_empty(), "{}", words.out);
}

#[test]
fn a_mask_limits_what_is_compared() {
    let folder = pictures();
    let rgb = (0..8 * 4).map(|i| if i % 8 < 4 { [0; 3] } else { [255; 3] }).collect();
    png::write(&folder.path().join("mask.png"), &DisplayImage::of_srgb(8, 4, rgb)).unwrap();
    let right = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--json", "--mask", "mask.png"]).json();
    assert_eq!((right["relative_mse"].as_f64(), right["pixels"].as_u64()), (Some(0.0), Some(16)), "{right}");
}

#[test]
fn fail_above_is_a_status_of_its_own() {
    let folder = pictures();
    let status = |limit: &str| abbe(folder.path(), &["compare", "a.exr", "b.exr", "--fail-above", limit]).status;
    assert_eq!([status("0.006"), status("0.004"), status("-1")], [0, 3, 2]);
    let broken = Picture { xyz: vec![[f64::NAN; 3]; 32], ..Picture::black(8, 4) };
    exr::write(&folder.path().join("nan.exr"), &broken, &Metadata::new()).unwrap();
    assert_eq!(abbe(folder.path(), &["compare", "nan.exr", "b.exr", "--fail-above", "1e9"]).status, 3);
}

#[test]
fn the_page_needs_no_other_file() {
    let folder = pictures();
    let said = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--html", "page.html"]);
    assert_eq!(said.status, 0, "{}", said.err);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 6, "maps of both errors too");
    assert!(!page.contains("http") && page.contains("a.exr") && page.contains("1.050000"));
}

#[test]
fn pictures_that_cannot_be_compared_are_the_input_s_fault() {
    let folder = pictures();
    let compare = |a: &str, b: &str| abbe(folder.path(), &["compare", a, b]);
    compare("a.exr", "small.exr").is_error(2, &["8 × 4", "4 × 4", "same size"]);
    compare("a.exr", "missing.exr").is_error(2, &["missing.exr", "cannot be read"]);
    std::fs::write(folder.path().join("text.exr"), "no picture").unwrap();
    compare("text.exr", "a.exr").is_error(2, &["text.exr", "not a valid EXR"]);
    abbe(folder.path(), &["compare", "a.exr", "b.exr", "--region", "0,0,9,4"]).is_error(2, &["0,0,9,4", "8 × 4"]);
    abbe(folder.path(), &["compare", "a.exr", "b.exr", "--mask", "a.exr"]).is_error(2, &["a.exr", "PNG"]);
    abbe(folder.path(), &["compare", "a.exr", "b.exr", "--html", "no/page.html"]).is_error(1, &["no/page.html"]);
}

#[test]
fn probe_tells_all_about_a_pixel() {
    let folder = pictures();
    let pixel = abbe(folder.path(), &["probe", "spectral.exr", "3", "1", "--json", "--svg", "pixel.svg"]).json();
    assert_eq!(pixel["pixel"], serde_json::json!([3, 1]));
    assert!((pixel["xyz"][1].as_f64().unwrap() - 1.0).abs() < 1e-6);
    assert!((pixel["noise"].as_f64().unwrap() - 0.03).abs() < 1e-6 && pixel["bias"] == 0.0);
    assert_eq!(pixel["spectrum"], serde_json::json!({"nm": [477.5, 712.5], "values": [22.0, 23.0]}));
    let svg = std::fs::read_to_string(folder.path().join("pixel.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.contains("pixel 3, 1") && svg.contains("radiance in W/m²/sr/nm"));
    // Two steps that meet in the middle of the band, at 595 nm, and extend from edge to edge of the
    // plot, whose top is 25.
    let steps = "M84.00 93.28L450.00 93.28L450.00 79.52L816.00 79.52";
    assert!(svg.contains(steps), "{svg}");
    assert!((pixel["relative_error"].as_f64().unwrap() - 0.03).abs() < 1e-6);
    let interval = [0, 1].map(|end| pixel["interval_95"][end].as_f64().unwrap());
    assert!((interval[0] - 0.932_14).abs() < 1e-6 && (interval[1] - 1.067_86).abs() < 1e-6, "{interval:?}");
    let heat = ["probe", "spectral.exr", "0", "0", "--json", "--heat", "heat.png"];
    let unknown = abbe(folder.path(), &heat).json();
    assert!(["noise", "bias", "relative_error", "interval_95"].iter().all(|key| unknown[key].is_null()), "{unknown}");
    let map = image::open(folder.path().join("heat.png")).unwrap().to_rgb8();
    assert_eq!((map.dimensions(), map.get_pixel(0, 0).0), ((8, 4), heat::UNKNOWN_COLOUR));
    let words = abbe(folder.path(), &["probe", "spectral.exr", "0", "0"]).out;
    assert!(words.contains("noise of Y   unknown") && words.contains("error of Y   unknown"), "{words}");
    let plain = abbe(folder.path(), &["probe", "a.exr", "0", "0", "--json"]).json();
    assert!(plain["spectrum"].is_null() && plain["srgb_hex"].as_str().unwrap().starts_with('#'));
}

#[test]
fn probe_refuses_pixels_and_spectra_that_are_not_there() {
    let folder = pictures();
    abbe(folder.path(), &["probe", "a.exr", "8", "0"]).is_error(2, &["8, 0", "8 × 4"]);
    abbe(folder.path(), &["probe", "a.exr", "-1", "0"]).is_error(2, &["-1"]);
    abbe(folder.path(), &["probe", "a.exr", "0", "0", "--svg", "p.svg"]).is_error(2, &["--spectral-bands"]);
    assert!(!Path::new(&folder.path().join("p.svg")).exists());
}
