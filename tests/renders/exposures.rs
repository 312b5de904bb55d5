//! The brightness of the example scenes on a display.

use super::common::{example_job, render_job};
use abbe_scene::Exposure;
use abbe_session::render::{DisplaySettings, Integrator};
use abbe_spectra::colour::RgbSpace;
use abbe_transport::sensor::{Codes, Picture};

/// Scenes of many kinds: spectra and caustics in rooms, lamps in view, single lines, sky, glass.
const SCENES: [&str; 13] = [
    "prism",
    "two_prisms",
    "grating",
    "glass_ball",
    "cornell",
    "rainbow",
    "halo",
    "sodium",
    "sodium_flame",
    "neon_tube",
    "candle",
    "diamond",
    "coated_lens",
];

const SMALL: [&str; 2] = ["film.width=96", "film.height=54"];

/// The range of the median luminance relative to white. Surroundings may be dark, but not black,
/// and a picture of a white floor is not washed out.
const MEDIAN: (f64, f64) = (0.01, 0.45);

/// The range of the luminance that 1 % of the pixels exceed: every picture uses the upper part of
/// the display's range. Monochromatic light cannot be brighter than the display's primaries.
const BRIGHTEST: (f64, f64) = (0.25, 0.97);

/// Returns the median luminance of a PNG file, and the luminance that 1 % of the pixels exceed.
fn brightness(display: &DisplaySettings, picture: &Picture) -> (f64, f64) {
    let Codes::Eight(codes) = display.screen(picture).codes else { panic!("the picture is not in sRGB") };
    let luminance = |code: &[u8; 3]| -> f64 {
        let linear = code.map(|code| RgbSpace::Srgb.decode(f64::from(code) / 255.0));
        RgbSpace::Srgb.luminance_weights().iter().zip(linear).map(|(weight, component)| weight * component).sum()
    };
    let mut shown: Vec<f64> = codes.iter().map(luminance).collect();
    shown.sort_unstable_by(f64::total_cmp);
    (shown[shown.len() / 2], shown[shown.len() * 99 / 100])
}

/// Each scene has its own exposure, which is automatic in most of them, and then the automatic one.
#[test]
fn example_scenes_are_neither_dark_nor_washed_out() {
    for name in SCENES {
        let job = example_job(name, &SMALL);
        let picture = render_job(&job, Integrator::Photon, 4).picture;
        let own = DisplaySettings::of(&job);
        for display in [own, DisplaySettings { exposure: Exposure::Auto, ..own }] {
            let (median, brightest) = brightness(&display, &picture);
            let exposure = display.exposure;
            assert!((MEDIAN.0..=MEDIAN.1).contains(&median), "{name}, {exposure:?}: median {median}");
            assert!((BRIGHTEST.0..=BRIGHTEST.1).contains(&brightest), "{name}, {exposure:?}: brightest {brightest}");
        }
    }
}
