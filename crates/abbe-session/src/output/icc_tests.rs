//! Generates the ICC profiles of RGB spaces, and checks them.

use std::path::Path;

use moxcms::{ColorProfile, LocalizableString, Matrix3d, ProfileText, ToneReprCurve, Xyzd};

use super::icc::{file_name, profile};
use abbe_spectra::colour::{AdaptationTransform, RgbSpace, Xyz, adapt, adaptation};

/// The white of the profile connection space (ICC.1:2022, 7.2.16): D50, rounded as in the header.
const D50: Xyz = [0.9642, 1.0, 0.8249];

/// The creation date of all profiles, 2020-01-01 0:00:00, as six 16-bit numbers. A constant date
/// makes the files reproducible.
const MADE: [u8; 12] = [7, 228, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0];

/// The position of the creation date in the header.
const MADE_AT: std::ops::Range<usize> = 24..36;

/// Generates the ICC profile of a colour space, a matrix profile of version 4.
fn generate(space: RgbSpace) -> Vec<u8> {
    let [red, green, blue] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|rgb| xyz_of(adapt(space.to_xyz(rgb), space.white(), D50, AdaptationTransform::Bradford)));
    let text = |text: &str| {
        let localized = LocalizableString::new("en".to_string(), "US".to_string(), text.to_string());
        Some(ProfileText::Localizable(vec![localized]))
    };
    // This profile provides only the header. The other entries are replaced below.
    let mut profile = ColorProfile::new_srgb();
    (profile.red_colorant, profile.green_colorant, profile.blue_colorant) = (red, green, blue);
    let curve = Some(curve(space));
    (profile.red_trc, profile.green_trc, profile.blue_trc) = (curve.clone(), curve.clone(), curve);
    profile.media_white_point = Some(xyz_of(D50));
    profile.chromatic_adaptation = Some(Matrix3d { v: adaptation(space.white(), D50, AdaptationTransform::Bradford) });
    profile.cicp = None;
    (profile.description, profile.copyright) = (text(title(space)), text("No copyright"));
    let mut bytes = profile.encode().unwrap();
    bytes[MADE_AT].copy_from_slice(&MADE);
    bytes
}

fn xyz_of([x, y, z]: Xyz) -> Xyzd {
    Xyzd { x, y, z }
}

fn title(space: RgbSpace) -> &'static str {
    match space {
        RgbSpace::Srgb => "sRGB",
        RgbSpace::DisplayP3 => "Display P3",
        RgbSpace::Rec2020 => "Rec. 2020",
        RgbSpace::AcesCg => "ACEScg",
    }
}

/// Returns the decoding curve. It maps a signal X to (aX + b)^g if X ≥ d, and to cX otherwise. The
/// parameters are stored in the order g, a, b, c, d (ICC.1:2022, 10.18, type 3). For a linear
/// space, the curve is an empty table.
fn curve(space: RgbSpace) -> ToneReprCurve {
    match space {
        RgbSpace::Srgb | RgbSpace::DisplayP3 => {
            ToneReprCurve::Parametric(vec![2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045])
        }
        RgbSpace::Rec2020 => {
            let alpha = 1.099_296_8;
            ToneReprCurve::Parametric(vec![1.0 / 0.45, 1.0 / alpha, (alpha - 1.0) / alpha, 1.0 / 4.5, 0.081_242_86])
        }
        RgbSpace::AcesCg => ToneReprCurve::Lut(Vec::new()),
    }
}

/// With `ABBE_BLESS`, the files are written instead of compared.
#[test]
fn the_profiles_are_up_to_date() {
    for space in RgbSpace::ALL {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/output/profiles").join(file_name(space));
        if std::env::var_os("ABBE_BLESS").is_some() {
            std::fs::write(&path, generate(space)).unwrap();
        }
        assert!(std::fs::read(&path).unwrap() == generate(space), "{space:?} is out of date; run: tests/bless");
    }
}

#[test]
fn a_profile_states_primaries_curve_and_white() {
    for space in RgbSpace::ALL {
        let read = ColorProfile::new_from_slice(profile(space)).unwrap();
        // The sum of the colorants is D50. The file stores the colorants as s15Fixed16 numbers,
        // so they are rounded.
        let sum = [
            read.red_colorant.x + read.green_colorant.x + read.blue_colorant.x,
            read.red_colorant.y + read.green_colorant.y + read.blue_colorant.y,
            read.red_colorant.z + read.green_colorant.z + read.blue_colorant.z,
        ];
        assert!(sum.iter().zip(D50).all(|(sum, white)| (sum - white).abs() < 1e-4), "{space:?} {sum:?}");
        let green = adapt(space.to_xyz([0.0, 1.0, 0.0]), space.white(), D50, AdaptationTransform::Bradford);
        let found = [read.green_colorant.x, read.green_colorant.y, read.green_colorant.z];
        assert!(found.iter().zip(green).all(|(found, known)| (found - known).abs() < 2e-5), "{space:?} {found:?}");
        for (row, known) in read.chromatic_adaptation.unwrap().v.iter().zip(adaptation(
            space.white(),
            D50,
            AdaptationTransform::Bradford,
        )) {
            assert!(row.iter().zip(known).all(|(a, b)| (a - b).abs() < 2e-5), "{space:?}");
        }
    }
}

#[test]
fn profile_curves_match_the_decoding() {
    for space in RgbSpace::ALL {
        let linear = |signal: f64| match curve(space) {
            ToneReprCurve::Lut(table) if table.is_empty() => signal,
            ToneReprCurve::Lut(table) => panic!("a table of {} entries", table.len()),
            ToneReprCurve::Parametric(numbers) => {
                let [g, a, b, c, d] = numbers[..] else { panic!("{numbers:?}") };
                let [g, a, b, c, d] = [g, a, b, c, d].map(f64::from);
                if signal >= d { (a * signal + b).powf(g) } else { c * signal }
            }
        };
        for i in 0..=1000 {
            let signal = f64::from(i) / 1000.0;
            let error = (linear(signal) - space.decode(signal)).abs();
            assert!(error < 1e-6, "{space:?} at {signal}: {error}");
        }
    }
}
