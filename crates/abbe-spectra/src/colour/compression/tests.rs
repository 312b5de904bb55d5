use super::*;
use crate::colour::tone::ToneCurve;
use crate::colour::{decode_srgb, gamut};
use crate::spectrum::library;

const DISPLAYS: [RgbSpace; 3] = [RgbSpace::Srgb, RgbSpace::DisplayP3, RgbSpace::Rec2020];

fn limits(space: RgbSpace) -> HueLimits {
    HueLimits::new(space, &space.picture_matrix())
}

fn full(space: RgbSpace) -> ChromaCompression {
    ChromaCompression::new(limits(space), 1.0)
}

/// A wavelength in nm, and the XYZ of its light.
type Strip = Vec<(f64, Xyz)>;

/// Returns a spectrum from 380 to 700 nm whose brightest luminance is `brightest`, with the power
/// of a light at each wavelength.
fn strip(light: impl Fn(f64) -> f64, brightest: f64) -> Strip {
    let colour = |nm: f64| Observer::cie1931().xyz_bar(nm).map(|value| value * light(nm));
    let wavelengths = || (380..=700).map(f64::from);
    let largest = wavelengths().map(|nm| colour(nm)[1]).fold(0.0, f64::max);
    wavelengths().map(|nm| (nm, colour(nm).map(|value| value * brightest / largest))).collect()
}

/// Returns the strips of the tests: equal energy, daylight and an incandescent lamp.
fn strips(brightest: f64) -> [Strip; 3] {
    let of = |name: &str| library::find(name).unwrap().spectrum;
    let (daylight, lamp) = (of("D65"), of("A"));
    [strip(|_| 1.0, brightest), strip(|nm| daylight.at(nm), brightest), strip(|nm| lamp.at(nm), brightest)]
}

/// Returns the shown colours of a strip as linear components, with the default tone curve.
fn shown(strip: &Strip, compression: &ChromaCompression, space: RgbSpace) -> Vec<Rgb> {
    let linear = |xyz: &Xyz| apply(&space.picture_matrix(), *xyz);
    strip.iter().map(|(_, xyz)| ToneCurve::RollOff.apply(compression.apply(linear(xyz)), space)).collect()
}

fn oklab_of(rgb: Rgb, space: RgbSpace) -> [f64; 3] {
    oklab(apply(&inverse(&space.picture_matrix()), rgb))
}

fn hue_degrees(rgb: Rgb, space: RgbSpace) -> f64 {
    let [_, a, b] = oklab_of(rgb, space);
    atan2(b, a).to_degrees().rem_euclid(360.0)
}

fn luminance(rgb: Rgb, space: RgbSpace) -> f64 {
    dot(space.luminance_weights(), rgb)
}

/// The luminances of the brightest part of the strips, relative to white: from pictures in which
/// the tone curve is idle to pictures whose red is overexposed by most of a stop.
const BRIGHTEST: [f64; 3] = [0.2, 0.4, 0.8];

#[test]
fn the_hue_along_a_spectrum_is_monotone() {
    for space in DISPLAYS {
        let compression = full(space);
        for strip in BRIGHTEST.into_iter().flat_map(strips) {
            let hues: Vec<f64> =
                shown(&strip, &compression, space).iter().map(|rgb| hue_degrees(*rgb, space)).collect();
            // From violet (298°) over blue, green and yellow to red (20°).
            for (pair, (nm, _)) in hues.windows(2).zip(&strip) {
                assert!(pair[1] < pair[0] + 1e-3, "{space:?} at {nm} nm: {pair:?}");
            }
            assert!(hues[0] > 290.0 && hues[320] < 30.0, "{} {}", hues[0], hues[320]);
        }
    }
}

/// Every stretch of 9 nm has at least 1 % of the colour difference ΔE(OK) along the strip. The test
/// leaves out luminances below a thousandth of the brightest, which are black on a display.
#[test]
fn a_spectrum_has_no_flat_stripe() {
    for space in DISPLAYS {
        let compression = full(space);
        for strip in BRIGHTEST.into_iter().flat_map(strips) {
            let shown: Vec<[f64; 3]> =
                shown(&strip, &compression, space).iter().map(|rgb| oklab_of(*rgb, space)).collect();
            let steps: Vec<f64> = shown.windows(2).map(|pair| crate::colour::delta_e_76(pair[0], pair[1])).collect();
            let length: f64 = steps.iter().sum();
            let brightest = strip.iter().map(|(_, xyz)| xyz[1]).fold(0.0, f64::max);
            for (stretch, (nm, xyz)) in steps.windows(9).zip(&strip) {
                let fraction = stretch.iter().sum::<f64>() / length;
                assert!(
                    fraction > 0.01 || xyz[1] < 1e-3 * brightest,
                    "{space:?} from {nm} nm, brightest {brightest}: {fraction}"
                );
            }
        }
    }
}

/// The corners of the gamut leave no lines: where the tone curve is idle, the steps of 1 nm change
/// by at most 0.4 % of the length of the strip from one to the next. Along the edge itself, they
/// change by 1 to 5 % at blue.
#[test]
fn a_spectrum_has_no_bright_line() {
    for space in DISPLAYS {
        let compression = full(space);
        for strip in strips(BRIGHTEST[0]) {
            let shown = shown(&strip, &compression, space);
            let shown: Vec<[f64; 3]> = shown.iter().map(|rgb| oklab_of(*rgb, space)).collect();
            let length: f64 = shown.windows(2).map(|pair| crate::colour::delta_e_76(pair[0], pair[1])).sum();
            for (three, (nm, _)) in shown.windows(3).zip(&strip) {
                let middle = [0, 1, 2].map(|i| 0.5 * (three[0][i] + three[2][i]));
                let change = 2.0 * crate::colour::delta_e_76(three[1], middle) / length;
                assert!(change < 0.004, "{space:?} at {nm} nm: {change}");
            }
        }
    }
}

/// The compression keeps the luminance, so the order of lightness along the strip is exactly that
/// of luminance where the tone curve is idle. Where it is not, the lightness has one maximum,
/// within 20 nm of the brightest wavelength: a display can show yellow brighter than green.
#[test]
fn lightness_along_a_spectrum_follows_luminance() {
    for space in DISPLAYS {
        let compression = full(space);
        for strip in BRIGHTEST.into_iter().flat_map(strips) {
            for (nm, xyz) in &strip {
                let mapped = compression.apply(apply(&space.picture_matrix(), *xyz));
                assert!((luminance(mapped, space) / xyz[1] - 1.0).abs() < 1e-9, "{space:?} {nm} nm: {mapped:?}");
            }
            let shown: Vec<f64> = shown(&strip, &compression, space).iter().map(|rgb| luminance(*rgb, space)).collect();
            let largest = |values: &[f64]| {
                let top = values.iter().copied().fold(0.0, f64::max);
                values.iter().position(|value| *value == top).unwrap()
            };
            let top = largest(&shown);
            let brightest = largest(&strip.iter().map(|(_, xyz)| xyz[1]).collect::<Vec<_>>());
            assert!(top.abs_diff(brightest) <= 20, "{space:?}: {top} {brightest}");
            for (i, pair) in shown.windows(2).enumerate() {
                assert_eq!(i < top, pair[1] > pair[0], "{space:?} from {} nm: {pair:?}", strip[i].0);
            }
        }
    }
}

#[test]
fn lightness_is_monotone_at_constant_chromaticity() {
    for space in DISPLAYS {
        let compression = full(space);
        for (nm, xyz) in strip(|_| 1.0, 1.0) {
            let lights: Strip =
                (0..200).map(|i| (nm, xyz.map(|value| value * 1.1_f64.powi(i - 120) / xyz[1]))).collect();
            let shown: Vec<f64> =
                shown(&lights, &compression, space).iter().map(|rgb| luminance(*rgb, space)).collect();
            assert!(shown.windows(2).all(|pair| pair[0] < pair[1]), "{space:?} {nm}");
        }
    }
}

#[test]
fn a_spectrum_lands_inside_the_gamut() {
    for space in RgbSpace::ALL {
        for reach in [0.0, 0.3, 1.0] {
            let compression = ChromaCompression::new(limits(space), reach);
            for (nm, xyz) in strip(|_| 1.0, 1.0) {
                let mapped = compression.apply(apply(&space.picture_matrix(), xyz.map(|value| value / xyz[1])));
                let (least, largest) =
                    (mapped[0].min(mapped[1]).min(mapped[2]), mapped.into_iter().fold(0.0, f64::max));
                // The interpolated edge is up to 1 % too large beside a primary.
                assert!(least > -1e-2 * largest, "{space:?} {reach} {nm} nm: {mapped:?}");
            }
        }
    }
}

/// Without colours beyond the gamut, nothing changes. With them, colours up to 0.7 of the rounded
/// edge do not change, and neutral colours never do.
#[test]
fn colours_inside_the_gamut_stay() {
    let colours = || (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(|c| decode_srgb(f64::from(c) / 9.0)));
    for space in DISPLAYS {
        let (idle, full, limits) = (ChromaCompression::new(limits(space), 0.0), full(space), limits(space));
        let mut unchanged = 0;
        for rgb in colours() {
            let near = |mapped: Rgb| mapped.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near(idle.apply(rgb)), "{space:?} {rgb:?} {:?}", idle.apply(rgb));
            let Some((_, [_, saturation], place)) = limits.saturation(rgb) else { continue };
            if saturation < 0.699 * at(&limits.rounded, place) {
                assert_eq!(full.apply(rgb), rgb, "{space:?}");
                unchanged += 1;
            }
        }
        assert!(unchanged > 150, "{space:?}: {unchanged}");
        for y in [0.0, 1e-6, 0.18, 1.0, 50.0] {
            assert!(full.apply([y; 3]).iter().all(|component| (component - y).abs() <= 1e-6 * y), "{y}");
        }
    }
}

/// The reach of light on the locus is 1, of a primary 0, and it does not depend on brightness.
#[test]
fn reach_measures_the_way_from_the_edge_to_the_locus() {
    let limits = limits(RgbSpace::Srgb);
    for brightness in [1e-6, 1.0, 1e6] {
        for (nm, xyz) in strip(|_| 1.0, brightness) {
            let reach = limits.reach(RgbSpace::Srgb.from_xyz(xyz));
            let near_red = (600.0..620.0).contains(&nm) || (460.0..467.0).contains(&nm);
            assert!(reach > 0.99 || near_red, "{nm} nm: {reach}");
        }
        for primary in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]] {
            assert_eq!(limits.reach(primary.map(|component| component * brightness)), 0.0);
        }
    }
    let half = limits.reach([-0.06, 0.5, 0.3]);
    assert!(half > 0.02 && half < 0.5, "{half}");
}

/// A higher reach leaves less of each saturated colour, without a step.
#[test]
fn compression_grows_steadily_with_the_reach() {
    let limits = limits(RgbSpace::Srgb);
    let saturation_of = |reach: f64, rgb: Rgb| {
        let mapped = ChromaCompression::new(limits.clone(), reach).apply(rgb);
        limits.saturation(mapped).unwrap().1[1]
    };
    for rgb in [[0.9, 0.1, 0.05], [0.05, 0.8, 0.1], [0.02, 0.05, 0.7]] {
        let saturations: Vec<f64> = (0..=20).map(|i| saturation_of(f64::from(i) / 20.0, rgb)).collect();
        for pair in saturations.windows(2) {
            assert!(pair[1] <= pair[0] + 1e-12 && pair[0] - pair[1] < 0.1 * saturations[0], "{rgb:?}: {pair:?}");
        }
    }
}

#[test]
fn the_rounded_edge_is_smooth_and_inside() {
    for space in RgbSpace::ALL {
        let HueLimits { edge, rounded, locus, .. } = limits(space);
        for i in 0..HUES {
            assert!(rounded[i] <= edge[i] * (1.0 + 1e-12) && locus[i] > edge[i], "{space:?} {i}");
            let [before, here, after] = [i + HUES - 1, i, i + 1].map(|node| rounded[node % HUES]);
            assert!((before - 2.0 * here + after).abs() < 0.01 * here, "{space:?} {i}: {before} {here} {after}");
        }
    }
}

#[test]
fn impossible_colours_pass_through() {
    let compression = ChromaCompression::new(limits(RgbSpace::Srgb), 1.0);
    for rgb in [[0.0; 3], [-1.0, -2.0, -3.0], [f64::INFINITY, 1.0, 0.0]] {
        assert_eq!(compression.apply(rgb), rgb);
    }
    assert!(gamut::contains(gamut::clip(compression.apply([f64::NAN, 0.5, 0.1]))));
}

#[test]
fn places_and_directions_are_inverse() {
    for node in 0..HUES {
        let [a, b] = direction(node);
        assert!((place(a, b) - node as f64).abs() < 1e-9 && (hypot(a, b) - 1.0).abs() < 1e-12, "{node}");
    }
    let angles: Vec<f64> =
        (0..3600).map(|i| f64::from(i) * 0.1).map(|d| place(d.to_radians().cos(), d.to_radians().sin())).collect();
    assert!(angles.windows(2).all(|pair| pair[0] < pair[1]));
}
