//! The film from the scene file to the output files: observers, white balance, gamut, colour
//! spaces.

use crate::abbe_command::{Said, abbe};
use crate::common::near::assert_near;
use abbe_session::output::exr;
use abbe_spectra::colour::{self, RgbSpace};
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer, library};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use tempfile::TempDir;

/// White paper under illuminant A, in front of surroundings of the same light.
const PAPER: &str = r#"{
  "camera": {"from": [0, 3, 0], "at": [0, 0, 0], "up": [0, 0, -1], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8, "exposure": {"ev": -4}, "tone": "clip"},
  "spectra": {"candle": {"blackbody": {"temperature": 1900}}},
  "materials": {"paper": {"diffuse": {"reflectance": 0.8}}},
  "objects": [{"name": "paper", "shape": {"rectangle": {"width": 9, "height": 9}}, "material": "paper"}],
  "lights": [{"environment": {"spectrum": "A", "illuminance": 10}}],
  "render": {"passes": 64, "photons": 16}
}"#;

fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("paper.json"), PAPER).unwrap();
    folder
}

fn render(folder: &Path, sets: &[&str]) -> Said {
    let mut words = vec!["render", "paper.json", "--quiet"];
    sets.iter().for_each(|set| words.extend(["--set", set]));
    abbe(folder, &words)
}

/// Returns a PNG's header and the mean of its pixels in 0…1.
fn png(path: &Path) -> (::png::Info<'static>, [f64; 3]) {
    let mut reader = ::png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    let components: Vec<f64> = match reader.info().bit_depth {
        ::png::BitDepth::Eight => bytes.iter().map(|&byte| f64::from(byte) / 255.0).collect(),
        ::png::BitDepth::Sixteen => {
            bytes.chunks_exact(2).map(|pair| f64::from(u16::from_be_bytes([pair[0], pair[1]])) / 65_535.0).collect()
        }
        other @ (::png::BitDepth::One | ::png::BitDepth::Two | ::png::BitDepth::Four) => panic!("{other:?} bits"),
    };
    let pixels = (components.len() / 3) as f64;
    let mean = [0, 1, 2].map(|c| components.iter().skip(c).step_by(3).sum::<f64>() / pixels);
    (reader.info().clone(), mean)
}

/// Renders with these changes and returns the PNG's header and mean colour.
fn shown(folder: &Path, sets: &[&str]) -> (::png::Info<'static>, [f64; 3]) {
    let said = render(folder, sets);
    assert_eq!(said.status, 0, "{}", said.err);
    png(&folder.join("paper.png"))
}

/// Returns the linear components of paper under illuminant A in a colour space, at the test's
/// exposure: a luminance of 8/π cd/m² times 2⁻⁴.
fn paper(space: RgbSpace) -> [f64; 3] {
    let xyz = Observer::cie1931().xyz(&library::find("A").unwrap().spectrum);
    let matrix = space.picture_matrix();
    let scale = 8.0 / std::f64::consts::PI / 16.0 / xyz[1];
    matrix.map(|row| scale * (row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]))
}

#[test]
fn the_balanced_light_is_shown_as_white() {
    let folder = scene();
    let [red, _, blue] = shown(folder.path(), &[]).1;
    assert!(red > blue + 0.2, "unbalanced it is the orange that it is: {red} {blue}");
    let white = RgbSpace::Srgb.encode(8.0 / std::f64::consts::PI / 16.0);
    for balance in [r#"film.white_balance="A""#, r#"film.white_balance="scene""#] {
        assert_near("colour", shown(folder.path(), &[balance]).1, [white; 3], 0.01);
    }
    // If the white balance is a candle of the scene's own spectra, illuminant A appears bluish.
    let [red, _, blue] = shown(folder.path(), &[r#"film.white_balance="candle""#]).1;
    assert!(blue > red + 0.05, "{red} {blue}");
    // White balance does not change the measured XYZ.
    let xyz = exr::read(&folder.path().join("paper.exr")).unwrap().picture.xyz;
    shown(folder.path(), &[]);
    assert_eq!(xyz, exr::read(&folder.path().join("paper.exr")).unwrap().picture.xyz);
}

#[test]
fn bright_paper_rolls_off_and_the_exposure_is_printed() {
    let folder = scene();
    // The paper's luminance at this exposure is above white.
    let bright = r#"film.exposure={"ev": 0.25}"#;
    let luminance = 8.0 / std::f64::consts::PI * 0.25_f64.exp2();
    let sets = ["--set", bright, "--set", r#"film.white_balance="A""#, "--set", r#"film.tone="roll_off""#];
    let said = abbe(folder.path(), &[&["render", "paper.json"], &sets[..]].concat());
    assert!(said.err.contains("exposure EV 0.25"), "{}", said.err);
    let (_, [_, soft, _]) = png(&folder.path().join("paper.png"));
    let (_, [_, clipped, _]) = shown(folder.path(), &[bright]);
    assert!(luminance > 3.0 && clipped > 0.999 && (0.9..0.99).contains(&soft), "{luminance} {clipped} {soft}");
}

#[test]
fn the_scene_s_white_weighs_its_lamps_by_power() {
    let folder = scene();
    // Two lights with different geometry that emit 3 W of D65 and 1 W of A.
    let lamp = |spectrum: &str, x: f64, power: f64| {
        format!(r#"{{"point": {{"at": [{x}, 2, 0], "spectrum": "{spectrum}", "power": {power}}}}}"#)
    };
    let lights = format!("lights=[{}, {}]", lamp("D65", 40.0, 3.0), lamp("A", 0.0, 1.0));
    let observer = Observer::cie1931();
    let xyz = ["D65", "A"].map(|name| {
        let spectrum = library::find(name).unwrap().spectrum;
        observer.xyz(&spectrum.scaled(1.0 / spectrum.integral()))
    });
    let white = [0, 1, 2].map(|i| 3.0 * xyz[0][i] + xyz[1][i]);
    let path = folder.path().join("paper.json");
    let sets = [lights, r#"film.white_balance="scene""#.to_string()];
    let found = abbe_format::resolve::load(&path, &sets).unwrap().film.white.unwrap();
    assert_near("colour", found, white, 1e-9 * white[1]);
}

#[test]
fn whites_that_cannot_be_are_refused_in_their_place() {
    let folder = scene();
    let refused = |sets: &[&str], words: &[&str]| {
        render(folder.path(), sets).is_error(2, words);
        assert!(!folder.path().join("paper.exr").exists());
    };
    refused(&[r#"film.white_balance="D56""#], &["film.white_balance", "D56", "did you mean \"D5"]);
    refused(&[r#"film.white_balance="sodium-low-pressure""#], &["film.white_balance", "too saturated"]);
    let sodium = r#"lights[0].environment.spectrum="sodium-low-pressure""#;
    refused(&[sodium, r#"film.white_balance="scene""#], &["film.white_balance", "the scene's light", "too saturated"]);
    refused(&[r#"film.output_space="adobe""#], &["film.output_space", "adobe", "display-p3"]);
    refused(&[r#"film.gamut="perceptual""#], &["film.gamut", "perceptual", "oklab"]);
    refused(&[r#"film.observer="cie2006""#], &["film.observer", "cie2006", "cie2015_2"]);
}

#[test]
fn every_space_says_what_it_is_and_holds_the_same_colour() {
    let folder = scene();
    for space in RgbSpace::ALL {
        let (info, mean) = shown(folder.path(), &[&format!("film.output_space=\"{}\"", space.name())]);
        assert_near("colour", mean, paper(space).map(|component| space.encode(component)), 0.01);
        let points =
            info.coding_independent_code_points.map(|points| (points.color_primaries, points.transfer_function));
        let (known, depth) = match space {
            RgbSpace::Srgb => (Some((1, 13)), ::png::BitDepth::Eight),
            RgbSpace::DisplayP3 => (Some((12, 13)), ::png::BitDepth::Eight),
            RgbSpace::Rec2020 | RgbSpace::AcesCg => (None, ::png::BitDepth::Sixteen),
        };
        assert_eq!((points, info.bit_depth), (known, depth), "{space:?}");
        assert_eq!(info.icc_profile.is_some(), space != RgbSpace::Srgb, "{space:?}");
    }
}

#[test]
fn gamut_mappings_differ_where_the_light_is_outside_the_space() {
    let folder = scene();
    let sodium = r#"lights[0].environment.spectrum="sodium-low-pressure""#;
    let of = |gamut: &str| shown(folder.path(), &[sodium, &format!("film.gamut=\"{gamut}\"")]).1;
    let (clipped, desaturated, oklab) = (of("clip"), of("desaturate"), of("oklab"));
    let xyz = Observer::cie1931().xyz(&library::find("sodium-low-pressure").unwrap().spectrum);
    let raw = colour::xyz_to_linear_srgb(xyz.map(|value| value * 8.0 / std::f64::consts::PI / 16.0 / xyz[1]));
    let linear = |mean: [f64; 3]| mean.map(|code| RgbSpace::Srgb.decode(code));
    assert_near("colour", linear(clipped), colour::gamut::clip(raw), 0.01);
    assert_near("colour", linear(desaturated), colour::gamut::desaturate(raw, RgbSpace::Srgb), 0.01);
    assert_near("colour", linear(oklab), colour::gamut::oklab(raw, RgbSpace::Srgb), 0.01);
    assert!(clipped != desaturated && desaturated != oklab && clipped != oklab);
}

#[test]
fn every_observer_sees_with_its_own_functions() {
    let folder = scene();
    // Blue light, for which the observers differ most.
    let blue = r#"lights[0].environment={"spectrum": "led/blue", "irradiance": 1}"#;
    let light = library::find("led/blue").unwrap().spectrum;
    for name in ["cie1931", "cie1964", "cie2015_2", "cie2015_10"] {
        let said = render(folder.path(), &[blue, &format!("film.observer=\"{name}\""), "film.spectral_bands=1"]);
        assert_eq!(said.status, 0, "{}", said.err);
        let pixels = exr::read(&folder.path().join("paper.exr")).unwrap().picture.xyz;
        let mean = [0, 1, 2].map(|c| pixels.iter().map(|xyz| xyz[c]).sum::<f64>() / pixels.len() as f64);
        let observer = Observer::by_name(name).unwrap();
        let scale = 0.8 / std::f64::consts::PI * LUMENS_PER_WATT / light.integral();
        let known = observer.xyz(&light).map(|value| scale * value);
        assert_near("colour", mean, known, 5e-3 * known[2]);
        let said = abbe(folder.path(), &["spectrum", "led/blue", "--observer", name, "--json"]).json();
        let found: Vec<f64> = said["xy"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
        let xy = colour::xy(known);
        assert_eq!(said["observer"], name);
        assert!((found[0] - xy[0]).abs() < 3e-4 && (found[1] - xy[1]).abs() < 3e-4, "{name}: {found:?} {xy:?}");
    }
}

#[test]
fn an_exr_states_the_primaries_of_its_rgb() {
    let folder = scene();
    // The EXR holds linear Rec. 709, independent of the PNG's colour space and white.
    render(folder.path(), &[r#"film.output_space="rec2020""#, r#"film.white_balance="A""#]);
    let meta = ::exr::meta::MetaData::read_from_file(folder.path().join("paper.exr"), false).unwrap();
    let stated = meta.headers[0].shared_attributes.chromaticities.unwrap();
    let found = [stated.red, stated.green, stated.blue, stated.white].map(|xy| [xy.x(), xy.y()]);
    assert_eq!(found, [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]]);
}

#[test]
fn iso_f_number_and_shutter_time_fix_the_exposure() {
    let folder = scene();
    let lens =
        r#"camera.lens={"thin": {"focal_length_mm": 50, "f_number": 2, "focus_distance": 3, "sensor_height_mm": 24}}"#;
    let shown = |close: f64, curve: &str| {
        let shutter = format!(r#"camera.shutter={{"open": 0, "close": {close}{curve}}}"#);
        let sets = [lens, &shutter, r#"film.exposure={"iso": 100}"#, r#"lights[0].environment.spectrum="D65""#];
        assert_eq!(render(folder.path(), &sets).status, 0);
        let (_, [_, green, _]) = png(&folder.path().join("paper.png"));
        RgbSpace::Srgb.decode(green)
    };
    // White is 78/S lx·s, and the film receives 0.65·L·t/N² lx·s. The paper has 10 lx · 0.8/π.
    let expected = |seconds: f64| 0.65 * (8.0 / std::f64::consts::PI) * seconds / 4.0 / (78.0 / 100.0);
    let (whole, half) = (shown(1.0, ""), shown(0.5, ""));
    assert!((whole / expected(1.0) - 1.0).abs() < 0.01 && (half / expected(0.5) - 1.0).abs() < 0.01, "{whole}, {half}");
    let triangle = shown(1.0, r#", "curve": [[0, 0], [0.5, 1], [1, 0]]"#);
    assert!((triangle / half - 1.0).abs() < 1e-9, "{triangle}");

    let iso = r#"film.exposure={"iso": 100}"#;
    render(folder.path(), &[iso]).is_error(2, &["film.exposure.iso", "f_number", "shutter"]);
    let shut = r#"camera.shutter={"open": 1, "close": 1}"#;
    render(folder.path(), &[iso, lens, shut]).is_error(2, &["film.exposure.iso", "closes after it opens"]);
}
