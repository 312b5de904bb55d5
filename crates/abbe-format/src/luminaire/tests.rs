use super::*;
use abbe_scene::light::OpeningShape;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use glam::DVec3;
use proptest::prelude::*;
use std::f64::consts::PI;

/// An LM-63 file with these angles and intensities.
fn ies(kind: u8, vertical: &[f64], horizontal: &[f64], values: &[f64]) -> String {
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let rows: Vec<String> = values.chunks(vertical.len()).map(list).collect();
    format!(
        "IESNA:LM-63-2002\n[TEST] none\n[MANUFAC] Abbe\nTILT=NONE\n1 1000 1 {} {} {kind} 2 0.2 0.6 0\n1 1 20\n{}\n{}\n{}\n",
        vertical.len(),
        horizontal.len(),
        list(vertical),
        list(horizontal),
        rows.join("\n")
    )
}

/// An EULUMDAT file with these planes. The intensities are per 1000 lm, and the lamps have 2000 lm.
fn ldt(isym: u8, all_c: &[f64], gamma: &[f64], values: &[f64]) -> String {
    let mut lines: Vec<String> = ["Abbe", "1"].map(String::from).to_vec();
    lines.push(isym.to_string());
    lines.extend([all_c.len().to_string(), "0".into(), gamma.len().to_string(), "0".into()]);
    lines.extend(["report", "Lamp", "1", "lamp.ldt", "today"].map(String::from));
    lines.extend(["600", "200", "50", "600", "200", "0", "0", "0", "0", "100", "100", "1", "0", "1"].map(String::from));
    lines.extend(["1", "LED", "2000", "4000", "80", "20"].map(String::from));
    lines.extend((0..10).map(|_| "0".to_string()));
    lines.extend(all_c.iter().chain(gamma).chain(values).map(f64::to_string));
    lines.join("\r\n") + "\r\n"
}

/// Asserts that two luminaires have the same intensity in random directions.
fn assert_same(a: &Photometry, b: &Photometry) {
    let (a, b) = (a.table().unwrap(), b.table().unwrap());
    let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
    for _ in 0..2000 {
        let direction = warp::sphere(stream.pair());
        let (left, right) = (a.at(direction), b.at(direction));
        assert!((left - right).abs() <= 1e-9 * left.max(1.0), "{direction}: {left} against {right}");
    }
    assert!((a.flux() / b.flux() - 1.0).abs() < 1e-12, "{} against {}", a.flux(), b.flux());
}

/// Maps an angle C to the angle that determines its plane.
type Fold = fn(f64) -> f64;

const GAMMA: [f64; 5] = [0.0, 20.0, 45.0, 90.0, 150.0];

/// The intensities of planes at these angles C. `fold` maps an angle to the one of its plane.
fn planes(all_c: &[f64], fold: impl Fn(f64) -> f64) -> Vec<f64> {
    let value = |c: f64, gamma: f64| 100.0 + fold(c) * (1.0 - gamma / 300.0) - 0.3 * gamma;
    all_c.iter().flat_map(|&c| GAMMA.map(|gamma| value(c, gamma))).collect()
}

fn about_c0(c: f64) -> f64 {
    if c > 180.0 { 360.0 - c } else { c }
}

fn about_c90(c: f64) -> f64 {
    // The mirror image of C is 180° − C.
    let c = if c > 270.0 { c - 360.0 } else { c };
    if c > 90.0 { 180.0 - c } else { c }
}

fn both(c: f64) -> f64 {
    let c = about_c0(c);
    if c > 90.0 { 180.0 - c } else { c }
}

fn every(step: f64, (from, to): (f64, f64)) -> Vec<f64> {
    (0..).map(|i| from + step * f64::from(i)).take_while(|angle| *angle <= to).collect()
}

#[test]
fn a_constant_intensity_has_the_flux_of_the_sphere() {
    let lamp = parse_ies(&ies(1, &[0.0, 180.0], &[0.0], &[50.0, 50.0])).unwrap();
    assert!((lamp.table().unwrap().flux() / (4.0 * PI * 50.0) - 1.0).abs() < 1e-12);
    let lamp = parse_eulumdat(&ldt(1, &[0.0], &[0.0, 180.0], &[25.0, 25.0])).unwrap();
    assert!((lamp.table().unwrap().flux() / (4.0 * PI * 50.0) - 1.0).abs() < 1e-12);
}

/// A Lambertian luminaire with the intensity I₀ on its axis has the flux π I₀.
#[test]
fn a_lambertian_table_has_the_flux_of_a_lambertian_source() {
    let gamma = every(1.0, (0.0, 90.0));
    let values: Vec<f64> = gamma.iter().map(|angle| 300.0 * angle.to_radians().cos()).collect();
    let lamp = parse_ies(&ies(1, &gamma, &[0.0], &values)).unwrap();
    let summary = LuminaireSummary::of(&lamp).unwrap();
    // Linear interpolation of the cosine in steps of 1° loses a fraction of about h²/12.
    assert!((summary.flux_lm / (PI * 300.0) - 1.0).abs() < 3e-5, "{}", summary.flux_lm);
    assert_eq!((summary.peak_cd, summary.peak_deg), (300.0, [0.0, 0.0]));
    assert!((summary.downward - 1.0).abs() < 1e-4);
    let beam = summary.beams[0].unwrap();
    assert!((beam.half_deg - 120.0).abs() < 1e-6, "{beam:?}");
    assert!((beam.tenth_deg - 2.0 * 0.1_f64.acos().to_degrees()).abs() < 0.01, "{beam:?}");
    assert!((summary.efficacy.unwrap() - summary.flux_lm / 20.0).abs() < 1e-9);
}

#[test]
fn symmetric_files_give_the_distribution_of_the_full_file() {
    let full = every(30.0, (0.0, 360.0));
    let cases: [(&[f64], Fold, LuminaireSymmetry); 4] = [
        (&every(30.0, (0.0, 180.0)), about_c0, LuminaireSymmetry::AboutC0),
        (&every(30.0, (90.0, 270.0)), about_c90, LuminaireSymmetry::AboutC90),
        (&every(30.0, (0.0, 90.0)), both, LuminaireSymmetry::Quadrants),
        (&[0.0], |_| 7.0, LuminaireSymmetry::Rotational),
    ];
    for (stored, fold, symmetry) in cases {
        let part = parse_ies(&ies(1, &GAMMA, stored, &planes(stored, fold))).unwrap();
        assert_eq!(part.symmetry, symmetry);
        let whole = parse_ies(&ies(1, &GAMMA, &full, &planes(&full, fold))).unwrap();
        assert_eq!(whole.symmetry, LuminaireSymmetry::None);
        assert_same(&part, &whole);
    }
    // A file without the plane at 360°.
    let open = every(30.0, (0.0, 330.0));
    let whole = parse_ies(&ies(1, &GAMMA, &full, &planes(&full, both))).unwrap();
    assert_same(&parse_ies(&ies(1, &GAMMA, &open, &planes(&open, both))).unwrap(), &whole);
}

/// The same luminaire as `.ies` and as `.ldt` has the same distribution, for all symmetries.
#[test]
fn both_formats_agree() {
    let all = every(30.0, (0.0, 330.0));
    let full = every(30.0, (0.0, 360.0));
    let cases: [(u8, Vec<f64>, Fold); 5] = [
        (0, all.clone(), |c| if c == 360.0 { 0.0 } else { c }),
        (1, vec![0.0], |_| 7.0),
        (2, every(30.0, (0.0, 180.0)), about_c0),
        (3, every(30.0, (270.0, 450.0)), about_c90),
        (4, every(30.0, (0.0, 90.0)), both),
    ];
    for (isym, stored, fold) in cases {
        let whole = parse_ies(&ies(1, &GAMMA, &full, &planes(&full, fold))).unwrap();
        let stored: Vec<f64> = stored.iter().map(|c| c % 360.0).collect();
        let halves: Vec<f64> = planes(&stored, fold).iter().map(|value| value / 2.0).collect();
        let lamp = parse_eulumdat(&ldt(isym, &all, &GAMMA, &halves)).unwrap();
        assert_same(&lamp, &whole);
        assert_eq!((lamp.lamp_lumens, lamp.input_watts), (Some(2000.0), Some(20.0)));
        assert_eq!((lamp.opening.along_c0_m, lamp.opening.along_c90_m), (0.2, 0.6));
    }
}

/// The intensity at H and V of photometry of types A and B, and its mirror images.
#[test]
fn types_a_and_b_are_read_at_their_angles() {
    let (h, v) = ([0.0, 10.0, 40.0], [0.0, 5.0, 30.0, 60.0]);
    let values: Vec<f64> = (0..12).map(|i| f64::from(i) + 1.0).collect();
    for kind in [2, 3] {
        let lamp = parse_ies(&ies(kind, &v, &h, &values)).unwrap();
        assert_eq!(lamp.symmetry, LuminaireSymmetry::Quadrants);
        let table = lamp.table().unwrap();
        for (i, wanted) in values.iter().enumerate() {
            let ((sin_h, cos_h), (sin_v, cos_v)) = (h[i / 4].to_radians().sin_cos(), v[i % 4].to_radians().sin_cos());
            for (right, up) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                let direction = if kind == 2 {
                    DVec3::new(right * sin_h, up * cos_h * sin_v, cos_h * cos_v)
                } else {
                    DVec3::new(right * cos_v * sin_h, up * sin_v, cos_v * cos_h)
                };
                // The outermost angles are at the edge of the table, so the test moves inwards.
                let inside = (direction + 1e-9 * DVec3::Z).normalize();
                assert!((table.at(inside) - wanted).abs() < 1e-5, "{kind} {i}: {} against {wanted}", table.at(inside));
            }
        }
        // Two quadrants may be listed in full.
        let wide_h = [-40.0, -10.0, 0.0, 10.0, 40.0];
        let wide: Vec<f64> = [2, 1, 0, 1, 2].iter().flat_map(|&row: &usize| values[4 * row..][..4].to_vec()).collect();
        assert_same(&parse_ies(&ies(kind, &v, &wide_h, &wide)).unwrap(), &lamp);
    }
}

#[test]
fn notations_of_all_versions_are_read() {
    let body = "1 1000\n2 2 1\n1 1 0 0 0 0.9 0.5 40\n0 90\n0\n100 10\n";
    let read = |text: &str| parse_ies(text).unwrap();
    let old = read(&format!("An old lamp\r\nby nobody\r\nTILT=NONE\r\n{}", body.replace('\n', "\r\n")));
    assert_eq!((old.format.as_str(), old.name.as_str()), ("IES LM-63-1986", "An old lamp"));
    assert_eq!(old.candela, [90.0, 9.0], "the multiplier, the ballast factor and the photometric factor");
    for (first, version) in
        [("IESNA91", 1991), ("IESNA:LM-63-1995", 1995), ("IESNA:LM-63-2002", 2002), ("IES:LM-63-2019", 2019)]
    {
        let lamp = read(&format!("{first}\n[MANUFAC] A\n[MORE] b\n[LUMCAT] B 7\nTILT=NONE\n{body}"));
        assert_eq!((lamp.format, lamp.name.as_str()), (format!("IES LM-63-{version}"), "A, B 7"));
        assert_eq!(lamp.candela[0], if version == 1991 { 90.0 } else { 180.0 }, "{version}");
        assert_eq!((lamp.lamp_lumens, lamp.input_watts), (Some(1000.0), Some(40.0)));
    }
    // Commas, line ends within a list, MS-DOS's end of file, absolute photometry, feet.
    let odd = read(
        "IESNA91\nTILT=INCLUDE\n1\n3\n0 15\n30\n1.0, 0.95 .9\n1,-1,1,3,1,1,1,-1.5,-1.5,0\n1 1\n30 0,45\n90 0\n5\n4 3\n\u{1a}",
    );
    assert_eq!((odd.candela.as_slice(), odd.lamp_lumens), ([5.0, 4.0, 3.0].as_slice(), None));
    assert_eq!(odd.tilt, [(0.0, 1.0), (15.0, 0.95), (30.0, 0.9)]);
    assert!((odd.tilt_factor(5.0) - (1.0 - 0.05 / 3.0)).abs() < 1e-12 && odd.tilt_factor(90.0) == 0.9);
    assert_eq!(odd.opening.shape, OpeningShape::Ellipse);
    assert!((odd.opening.along_c0_m - 0.4572).abs() < 1e-12);
}

/// Programs write blanks into the first line and around the sign of `TILT=`.
#[test]
fn blanks_in_the_header_of_an_ies_file_do_not_matter() {
    for (first, tilt) in [
        ("IESNA: LM-63-2002", "TILT=NONE"),
        ("IESNA:LM-63-2002 ", "TILT = NONE"),
        ("IES: LM-63-2019", " tilt =none "),
        ("iesna : LM-63-1995 3 lamps", "TILT= NONE"),
        ("IESNA91 2", "TILT=NONE"),
        ("IESNA:LM-63-1986", "TILT=NONE"),
    ] {
        let text = format!("{first}\n[TEST] 1\n{tilt}\n1 1000 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n100 100 100\n");
        let lamp = parse_ies(&text).unwrap_or_else(|error| panic!("{first}: {error}"));
        assert!((LuminaireSummary::of(&lamp).unwrap().flux_lm - 2.0 * PI * 100.0).abs() < 1e-9, "{first}");
    }
}

/// A horizontal cylinder is flat from below: its length × its diameter.
#[test]
fn a_horizontal_cylinder_opens_as_a_rectangle() {
    for (sides, expected) in [
        ("0 1.2 -0.4", [1.2, 0.4]),
        ("1.2 0 -0.4", [0.4, 1.2]),
        ("-0.4 1.2 -0.4", [1.2, 0.4]),
        ("1.2 -0.4 -0.4", [0.4, 1.2]),
    ] {
        let text = format!("IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 2 1 1 2 {sides}\n1 1 10\n0 90\n0\n100 100\n");
        let opening = parse_ies(&text).unwrap().opening;
        let found = [opening.along_c0_m, opening.along_c90_m];
        assert_eq!((opening.shape, found), (OpeningShape::Rectangle, expected), "{sides}");
    }
}

#[test]
fn damaged_ies_files_are_refused_with_their_line() {
    let good = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 40\n0 90\n0\n100 10\n";
    assert!(parse_ies(good).is_ok());
    for (from, to, place, word) in [
        ("TILT=NONE\n", "", None, "TILT="),
        ("TILT=NONE", "TILT=other.tlt", Some((2, 1)), "tilt factors"),
        ("TILT=NONE", "TILT=", Some((2, 1)), "without a value"),
        ("LM-63-2002", "LM-63-2030", Some((1, 1)), "version"),
        ("100 10", "100", Some((7, 1)), "ends too early"),
        ("100 10", "100 10 7", Some((7, 8)), "more numbers"),
        ("100 10", "100 ten", Some((7, 5)), "\"ten\""),
        ("100 10", "100 -10", Some((7, 5)), "at least 0"),
        ("100 10", "100 nan", Some((7, 5)), "a number"),
        ("100 10", "100 1e300", Some((7, 5)), "10¹⁵"),
        ("100 10", "0 0", Some((3, 10)), "all intensities are 0"),
        ("0 90", "90 0", Some((5, 4)), "above the one before"),
        ("0 90", "0 190", Some((5, 3)), "from 0° to 180°"),
        ("1 1000 1 2 1 1", "1 1000 1 2.5 1 1", Some((3, 10)), "whole number"),
        ("1 1000 1 2 1 1", "1 1000 1 1 1 1", Some((3, 10)), "whole number"),
        ("1 1000 1 2 1 1", "1 1000 1 99999 999 1", Some((3, 10)), "intensities"),
        ("1 1000 1 2 1 1", "1 1000 1 1e99 1 1", Some((3, 10)), "whole number"),
        ("1 1000 1 2 1 1", "1 1000 1 2 1 4", Some((3, 14)), "photometric type"),
        ("1 1000 1 2 1 1 2", "1 1000 1 2 1 1 3", Some((3, 16)), "feet"),
        ("1 1000 1 2 1 1 2", "1 1000 1 2 1 2 2", Some((6, 1)), "one horizontal angle"),
        ("TILT=NONE", "[BLOCK]\nTILT=NONE", Some((2, 1)), "[BLOCK]"),
        ("TILT=NONE", "TILT=INCLUDE\n4 1 0 1", Some((3, 1)), "1, 2 or 3"),
    ] {
        let error = parse_ies(&good.replacen(from, to, 1)).unwrap_err();
        assert!(error.to_string().contains(word), "{word}: {error}");
        assert_eq!(error.location.line_column, place, "{error}");
    }
    let ranges = ies(1, &[0.0, 90.0], &[0.0, 60.0], &[1.0; 4]);
    assert!(parse_ies(&ranges).unwrap_err().to_string().contains("from 0° to 60°"));
}

#[test]
fn damaged_eulumdat_files_are_refused_with_their_line() {
    let c = every(90.0, (0.0, 270.0));
    let good = ldt(4, &c, &[0.0, 90.0], &[10.0, 5.0, 8.0, 4.0]);
    assert!(parse_eulumdat(&good).is_ok());
    let lines: Vec<&str> = good.lines().collect();
    for (line, text, word) in [
        (3, "5", "0 to 4"),
        (3, "x", "\"x\""),
        (4, "3", "multiple of 4"),
        (4, "0", "whole number"),
        (6, "1", "whole number"),
        (24, "-1", "at least 0"),
        (26, "99", "at most 64"),
        (29, "0", "above 0"),
        (46, "400", "360°"),
        (48, "195", "from 0° to 180°"),
        (50, "", "a number"),
    ] {
        let mut changed = lines.clone();
        changed[line - 1] = text;
        let error = parse_eulumdat(&changed.join("\n")).unwrap_err();
        assert!(error.to_string().contains(word), "{line}, {word}: {error}");
    }
    let short = lines[..lines.len() - 1].join("\n");
    let error = parse_eulumdat(&short).unwrap_err();
    assert!(error.to_string().contains("ends too early"), "{error}");
    assert!(parse_eulumdat("").is_err());
    // Decimal commas and Latin-1 names are common.
    assert!(parse_eulumdat(&good.replace("\r\n8\r\n", "\r\n8,5\r\n")).is_ok());
}

#[test]
fn files_are_read_within_their_folder() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let body = "1 1000 1 2 1 1 2 0 0 0\n1 1 40\n0 90\n0\n100 10\n";
    let read = |name: &str, access| read(&folder.path().join(name), access);
    write("tilt.tlt", b"1\n2\n0 90\n1 0.5\n");
    let lamp = |tilt: &str| format!("IESNA91\n[LUMINAIRE] Stra\u{df}e\nTILT={tilt}\n{body}");
    // Latin-1 bytes.
    write("a.ies", &lamp("tilt.tlt").chars().map(|c| c as u8).collect::<Vec<u8>>());
    let found = read("a.ies", FileAccess::WithinFolder).unwrap();
    assert_eq!((found.name.as_str(), found.tilt), ("Straße", vec![(0.0, 1.0), (90.0, 0.5)]));
    write("b.ies", lamp("../tilt.tlt").as_bytes());
    let error = read("b.ies", FileAccess::WithinFolder).unwrap_err();
    assert_eq!(error.expected.as_deref(), Some(FileAccess::EXPECTED_WITHIN_FOLDER), "{error}");
    write("c.ies", lamp("missing.tlt").as_bytes());
    assert!(read("c.ies", FileAccess::Anywhere).unwrap_err().to_string().contains("missing.tlt"));
    write("d.ies", &vec![b' '; (MAX_FILE_BYTES + 1) as usize]);
    assert!(read("d.ies", FileAccess::Anywhere).unwrap_err().to_string().contains("16 MiB"));
}

proptest! {
    /// Any text gives a result or an error, and never a panic.
    #[test]
    fn any_numbers_are_read_without_panic(words in proptest::collection::vec("(-?[0-9]{1,3}|1e9|TILT=NONE|x)", 0..60), separator in "[ ,\n]") {
        let text = words.join(&separator);
        let _ = parse_eulumdat(&text);
        let _ = parse_ies(&format!("IESNA91\nTILT=NONE\n{text}"));
        let _ = parse_ies(&format!("IESNA91\nTILT=INCLUDE\n{text}")).map(|lamp| lamp.table());
    }

    /// Random numbers after valid counts and ranges.
    #[test]
    fn valid_files_have_a_table_and_a_summary(kind in 1..=3_u8, values in proptest::collection::vec(0.0..1e4_f64, 12)) {
        let lamp = parse_ies(&ies(kind, &[0.0, 30.0, 60.0, 90.0], &[0.0, 45.0, 90.0], &values));
        if let Ok(lamp) = lamp {
            let summary = LuminaireSummary::of(&lamp).unwrap();
            prop_assert!(summary.flux_lm > 0.0 && summary.flux_lm <= 4.0 * PI * summary.peak_cd * (1.0 + 1e-12));
        }
    }
}

/// Resolves a scene with one luminaire and one point light of 1000 lm.
fn scene_with(folder: &Path, keys: &str) -> Result<abbe_scene::Scene> {
    let text = format!(
        r#"{{"camera": {{"from": [0, 1, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 35}}}}}},
        "film": {{"width": 4, "height": 4}}, "materials": {{"white": {{"diffuse": {{"reflectance": 0.8}}}}}},
        "objects": [{{"shape": {{"sphere": {{"radius": 1}}}}, "material": "white"}}],
        "lights": [{{"ies": {{"at": [0, 3, 0], "spectrum": "A", {keys}}}}},
          {{"point": {{"at": [0, 3, 0], "spectrum": "A", "luminous_flux": 1000}}}}]}}"#
    );
    let path = folder.join("scene.json");
    let (scene, source) = crate::parse(&text, &path, &[])?;
    crate::resolve::resolve(&scene, &source)
}

#[test]
fn the_file_sets_the_flux_unless_the_scene_states_it() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let lamp = ies(1, &[0.0, 180.0], &[0.0], &[50.0, 50.0]);
    write("lamp.ies", &lamp);
    write("tilt.ies", &lamp.replace("TILT=NONE", "TILT=INCLUDE\n1\n2\n0 90\n1 0.5"));
    // The power in W that corresponds to 1000 lm is that of the second light.
    let kilolumens = |keys: &str| {
        let scene = scene_with(folder.path(), keys).unwrap();
        let power = |light: usize| scene.lights[light].power_w(scene.extent());
        power(0) / power(1)
    };
    let down = r#""toward": [0, -1, 0], "path": "lamp.ies""#;
    let flux = 4.0 * PI * 50.0 / 1000.0;
    assert!((kilolumens(down) / flux - 1.0).abs() < 1e-12);
    assert!((kilolumens(&format!(r#"{down}, "luminous_flux": 250"#)) / 0.25 - 1.0).abs() < 1e-12);
    assert!((kilolumens(&format!(r#"{down}, "area": true"#)) / flux - 1.0).abs() < 1e-12);
    // A horizontal luminaire is tilted by 90°. A transform tilts it too.
    assert!((kilolumens(r#""toward": [1, 0, 0], "path": "tilt.ies""#) / flux - 0.5).abs() < 1e-12);
    let turn = r#""transform": [{"rotate": {"axis": [0, 0, 1], "degrees": 45}}]"#;
    assert!((kilolumens(&format!(r#""toward": [0, -1, 0], "path": "tilt.ies", {turn}"#)) / flux - 0.75).abs() < 1e-9);
    let scene = scene_with(folder.path(), &format!(r#"{down}, "power": 7"#)).unwrap();
    assert!((scene.lights[0].power_w(scene.extent()) - 7.0).abs() < 1e-12);
}

#[test]
fn faults_of_a_luminaire_name_the_file_and_the_key() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let lamp = ies(1, &[0.0, 180.0], &[0.0], &[50.0, 50.0]);
    write("bad.ies", &lamp.replace("50 50", "50 x"));
    write("point.ies", &lamp.replace("0.2 0.6 0", "0 0 0"));
    let error = |keys: &str| {
        let error = scene_with(folder.path(), &format!(r#""toward": [0, -1, 0], {keys}"#)).unwrap_err();
        assert_eq!(error.exit_status(), 2, "{error}");
        error.to_string()
    };
    let bad = error(r#""path": "bad.ies""#);
    assert!(bad.contains("bad.ies:9:4: lights[0].ies.path: an intensity: \"x\"; expected a number"), "{bad}");
    assert!(error(r#""path": "../lamp.ies""#).contains("leads out of the folder"));
    assert!(error(r#""path": "none.ies""#).contains("none.ies: lights[0].ies.path: cannot read the luminaire"));
    let point = error(r#""path": "point.ies", "area": true"#);
    assert!(point.contains("lights[0].ies.area: the luminaire file states no luminous opening"), "{point}");
}
