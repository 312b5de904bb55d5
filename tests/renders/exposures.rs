//! The brightness of the example scenes on a display.

use super::common::{example_job, render_job};
use abbe_session::render::{DisplaySettings, Integrator};
use abbe_spectra::colour::RgbSpace;
use abbe_transport::sensor::Codes;

/// Spectra and caustics in rooms, lamps in view, single lines, sky, glass.
const SCENES: [&str; 11] = [
    "prism",
    "two_prisms",
    "grating",
    "glass_ball",
    "cornell",
    "rainbow",
    "sodium",
    "sodium_flame",
    "neon_tube",
    "candle",
    "coated_lens",
];

const SMALL: [&str; 3] = ["film.width=96", "film.height=54", "render.photons=20000"];

/// The range of the median luminance relative to white. Surroundings may be dark, but not black,
/// and a picture of a white floor is not washed out.
const MEDIAN: (f64, f64) = (0.01, 0.45);

/// The range of the luminance that 1 % of the pixels exceed: every picture uses the upper part of
/// the display's range. Monochromatic light cannot be brighter than the display's primaries.
const BRIGHTEST: (f64, f64) = (0.25, 0.97);

/// Renders a scene with a change, and returns the median luminance and that of the brightest 1 %.
fn brightness(name: &str, exposure: Option<&str>) -> (f64, f64) {
    let job = example_job(name, &SMALL.into_iter().chain(exposure).collect::<Vec<_>>());
    let picture = render_job(&job, Integrator::Photon, 4).picture;
    let Codes::Eight(codes) = DisplaySettings::of(&job).screen(&picture).codes else { panic!("{name} is not in sRGB") };
    let luminance = |code: &[u8; 3]| -> f64 {
        let linear = code.map(|code| RgbSpace::Srgb.decode(f64::from(code) / 255.0));
        RgbSpace::Srgb.luminance_weights().iter().zip(linear).map(|(weight, component)| weight * component).sum()
    };
    let mut shown: Vec<f64> = codes.iter().map(luminance).collect();
    shown.sort_unstable_by(f64::total_cmp);
    (shown[shown.len() / 2], shown[shown.len() * 99 / 100])
}

#[track_caller]
fn is_within(name: &str, (median, brightest): (f64, f64)) {
    assert!((MEDIAN.0..=MEDIAN.1).contains(&median), "{name}: median {median}");
    assert!((BRIGHTEST.0..=BRIGHTEST.1).contains(&brightest), "{name}: brightest {brightest}");
}

#[test]
fn example_scenes_are_neither_dark_nor_washed_out() {
    for name in SCENES {
        is_within(name, brightness(name, None));
    }
}

#[test]
fn automatic_exposure_suits_the_example_scenes() {
    for name in SCENES {
        is_within(name, brightness(name, Some(r#"film.exposure="auto""#)));
    }
}
