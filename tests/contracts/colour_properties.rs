//! Laws of colour that hold for every input.

use abbe_spectra::colour::{self, AdaptationTransform, RgbSpace, gamut, gamut::GamutMapping, report};
use abbe_spectra::spectrum::{Observer, Outside, SpectralLine, Spectrum, library};
use proptest::prelude::*;

/// A table of two to thirty samples.
fn table() -> impl Strategy<Value = Spectrum> {
    (prop::collection::btree_set(3000_u32..9000, 2..30), prop::collection::vec(0.0..10.0_f64, 30), any::<bool>())
        .prop_map(|(nm, values, hold)| {
            let nm: Vec<f64> = nm.into_iter().map(|tenths| f64::from(tenths) / 10.0).collect();
            let outside = if hold { Outside::Hold } else { Outside::Zero };
            Spectrum::table(&nm, &values[..nm.len()], outside).expect("the samples ascend and are not negative")
        })
}

/// The sum of a table, lines and a peak.
fn spectrum() -> impl Strategy<Value = Spectrum> {
    let lines = prop::collection::vec((300.0..900.0_f64, 0.0..5.0_f64, -6.0..1.0_f64), 0..5);
    (table(), lines, 0.0..2.0_f64, 380.0..800.0_f64, -5.0..2.0_f64).prop_map(|(table, lines, weight, peak, width)| {
        let lines: Vec<SpectralLine> = lines
            .into_iter()
            .map(|(nm, power, width)| SpectralLine { nm, power, fwhm_nm: Some(10.0_f64.powf(width)) })
            .collect();
        let lines = Spectrum::lines(&lines).expect("the lines are good");
        let peak = Spectrum::gaussian(peak, 10.0_f64.powf(width)).expect("the peak is good");
        Spectrum::mix(&[(1.0, &table), (1.0, &lines), (weight, &peak)])
    })
}

fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    let scale = a.iter().chain(&b).fold(0.0_f64, |scale, value| scale.max(value.abs()));
    (0..3).all(|i| (a[i] - b[i]).abs() <= tolerance * scale)
}

fn xyz() -> impl Strategy<Value = [f64; 3]> {
    [0.0..2.0_f64, 1e-6..2.0_f64, 0.0..2.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, rng_seed: prop::test_runner::RngSeed::Fixed(3), ..ProptestConfig::default() })]

    #[test]
    fn xyz_is_linear_in_the_spectrum(a in spectrum(), b in spectrum(), weights in [0.0..3.0_f64, 0.0..3.0_f64]) {
        let mixed = Spectrum::mix(&[(weights[0], &a), (weights[1], &b)]);
        for observer in [Observer::cie1931(), Observer::cie2015_10()] {
            let sum = |xyz: &dyn Fn(&Spectrum) -> [f64; 3]| {
                let (a, b) = (xyz(&a), xyz(&b));
                [0, 1, 2].map(|i| weights[0] * a[i] + weights[1] * b[i])
            };
            prop_assert!(near(observer.xyz(&mixed), sum(&|spectrum| observer.xyz(spectrum)), 1e-9));
            prop_assert!(near(report::xyz(&mixed, observer), sum(&|spectrum| report::xyz(spectrum, observer)), 1e-9));
        }
        for nm in [360.0, 412.3, 589.0, 777.7, 830.0] {
            let expected = weights[0] * a.at(nm) + weights[1] * b.at(nm);
            prop_assert!((mixed.at(nm) - expected).abs() <= 1e-9 * expected.abs().max(1e-9));
        }
    }

    #[test]
    fn chromaticity_does_not_depend_on_scale(light in spectrum(), exponent in -200.0..200.0_f64) {
        let scaled = light.scaled(10.0_f64.powf(exponent));
        for xyz in [Observer::xyz as fn(&Observer, &Spectrum) -> [f64; 3], |o, s| report::xyz(s, o)] {
            let (a, b) = (colour::xy(xyz(Observer::cie1931(), &light)), colour::xy(xyz(Observer::cie1931(), &scaled)));
            prop_assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12, "{a:?} {b:?}");
        }
    }

    #[test]
    fn sums_and_integrals_of_tables_agree(values in prop::collection::vec(0.1..1.0_f64, 95)) {
        // Tables with steps of 5 nm, as for lamps; the ends of the band have almost no weight.
        let nm: Vec<f64> = (0..95).map(|i| 360.0 + 5.0 * f64::from(i)).collect();
        let light = Spectrum::table(&nm, &values, Outside::Zero).expect("a good table");
        let observer = Observer::cie1931();
        prop_assert!(near(report::xyz(&light, observer), observer.xyz(&light), 3e-4));
    }

    #[test]
    fn a_line_has_the_interpolated_matching_functions_and_its_power(
        nm in 361.0..829.0_f64, power in 1e-3..1e3_f64, width in -6.0..-3.0_f64
    ) {
        let width = 10.0_f64.powf(width);
        // Keeps the line between two entries of the table.
        let nm = nm.floor() + nm.fract().clamp(width, 1.0 - width);
        let line = Spectrum::lines(&[SpectralLine { nm, power, fwhm_nm: Some(width) }]).expect("a good line");
        prop_assert!((line.integral() / power - 1.0).abs() < 1e-12);
        let summed: f64 = line.line_segments().iter().map(|part| part.power_per_nm() * (part.nm.1 - part.nm.0)).sum();
        prop_assert!((summed / power - 1.0).abs() < 1e-12);
        for observer in [Observer::cie1931(), Observer::cie1964(), Observer::cie2015_2(), Observer::cie2015_10()] {
            let (below, above) = (observer.xyz_bar(nm.floor()), observer.xyz_bar(nm.ceil()));
            let t = nm - nm.floor();
            let expected = [0, 1, 2].map(|i| power * (below[i] * (1.0 - t) + above[i] * t));
            // Exact up to the rounding of the box's ends.
            let rounding = 1e-9_f64;
            prop_assert!(near(observer.xyz(&line), expected, rounding), "{:?} {expected:?}", observer.xyz(&line));
            prop_assert!(near(report::xyz(&line, observer), expected, rounding));
        }
    }

    #[test]
    fn a_line_of_any_width_integrates_to_its_power(
        nm in 470.0..720.0_f64, power in 1e-30..1e30_f64, width in -6.0..2.0_f64
    ) {
        let line = SpectralLine { nm, power, fwhm_nm: Some(10.0_f64.powf(width)) };
        let line = Spectrum::lines(&[line]).expect("a good line");
        prop_assert!((line.integral() / power - 1.0).abs() < 1e-9, "{}", line.integral());
        // Sums the densities that rendering uses: at the wavelengths within, times the width.
        let summed: f64 = line.line_segments().iter().map(|part| line.at(part.centre()) * (part.nm.1 - part.nm.0)).sum();
        prop_assert!((summed / power - 1.0).abs() < 1e-9, "{summed}");
    }

    #[test]
    fn coordinates_come_back(xyz in xyz()) {
        let white = RgbSpace::Srgb.white();
        prop_assert!(near(colour::from_lab(colour::lab(xyz, white), white), xyz, 1e-9));
        prop_assert!(near(colour::from_luv(colour::luv(xyz, white), white), xyz, 1e-9));
        prop_assert!(near(colour::from_oklab(colour::oklab(xyz)), xyz, 1e-9));
        prop_assert!(near(colour::from_xy(colour::xy(xyz), xyz[1]), xyz, 1e-9));
        for transform in [AdaptationTransform::Bradford, AdaptationTransform::Cat16] {
            let a = [1.0985, 1.0, 0.3558];
            let there = colour::adapt(xyz, white, a, transform);
            prop_assert!(near(colour::adapt(there, a, white, transform), xyz, 1e-9));
        }
        for space in RgbSpace::ALL {
            let rgb = space.from_xyz(xyz);
            prop_assert!(near(space.to_xyz(rgb), xyz, 1e-9));
            prop_assert!(near(rgb.map(|component| space.decode(space.encode(component))), rgb, 1e-9));
        }
    }

    #[test]
    fn gamut_mapping_lands_inside_and_leaves_alone_what_is_inside(rgb in [-1.0..2.0_f64, -1.0..2.0_f64, -1.0..2.0_f64]) {
        for space in RgbSpace::ALL {
            let luminance = |rgb: [f64; 3]| -> f64 { space.luminance_weights().iter().zip(rgb).map(|(w, c)| w * c).sum() };
            for mapping in GamutMapping::ALL {
                let mapped = mapping.map(rgb, space);
                prop_assert!(gamut::contains(mapped), "{mapping:?} {rgb:?} {mapped:?}");
                prop_assert_eq!(mapping.map(mapped, space), mapped);
            }
            let mapped = gamut::desaturate(rgb, space);
            let kept = luminance(rgb).clamp(0.0, 1.0);
            prop_assert!((luminance(mapped) - kept).abs() < 1e-9, "{rgb:?} {mapped:?}");
        }
    }

    #[test]
    fn oklab_mapping_keeps_lightness_and_hue(rgb in [-0.3..1.3_f64, -0.3..1.3_f64, -0.3..1.3_f64]) {
        let [lightness, a, b] = colour::oklab(RgbSpace::Srgb.to_xyz(rgb));
        prop_assume!(lightness > 0.05 && lightness < 0.999);
        let mapped = colour::oklab(RgbSpace::Srgb.to_xyz(gamut::oklab(rgb, RgbSpace::Srgb)));
        prop_assert!((mapped[0] - lightness).abs() < 1e-3, "{rgb:?}: {lightness} {mapped:?}");
        let chroma = a.hypot(b);
        let turned = (mapped[1] * b - mapped[2] * a) / chroma.max(1e-9);
        prop_assert!(turned.abs() < 2e-3 && mapped[1].hypot(mapped[2]) <= chroma + 1e-3, "{rgb:?}: {mapped:?}");
    }

    #[test]
    fn ciede2000_is_symmetric_and_zero_only_for_equals(
        a in [0.0..100.0_f64, -100.0..100.0_f64, -100.0..100.0_f64],
        b in [0.0..100.0_f64, -100.0..100.0_f64, -100.0..100.0_f64],
    ) {
        let (there, back) = (colour::delta_e_2000(a, b), colour::delta_e_2000(b, a));
        prop_assert!((there - back).abs() < 1e-9 && there > 0.0);
        prop_assert_eq!(colour::delta_e_2000(a, a), 0.0);
    }

    #[test]
    fn a_match_is_never_worse_than_any_other_mix(
        target in xyz(),
        primaries in prop::collection::vec(xyz(), 1..6),
        others in prop::collection::vec(0.0..2.0_f64, 6),
    ) {
        let found = colour::match_primaries(target, &primaries).expect("everything has luminance");
        prop_assert!(found.weights.iter().all(|weight| *weight >= 0.0));
        let error = |xyz: [f64; 3]| (0..3).map(|i| (xyz[i] - target[i]).powi(2)).sum::<f64>();
        let mut other = [0.0; 3];
        for (weight, primary) in others.iter().zip(&primaries) {
            (0..3).for_each(|i| other[i] += weight * primary[i]);
        }
        prop_assert!(error(found.xyz) <= error(other) * (1.0 + 1e-9) + 1e-15);
        // The Karush–Kuhn–Tucker conditions: no primary can improve the mix.
        for (weight, primary) in found.weights.iter().zip(&primaries) {
            let slope: f64 = (0..3).map(|i| (found.xyz[i] - target[i]) * primary[i]).sum();
            prop_assert!(slope > -1e-9 && (*weight == 0.0 || slope.abs() < 1e-9), "{slope}");
        }
    }
}

#[test]
fn extreme_spectra_have_finite_colours() {
    let observer = Observer::cie1931();
    let nm: Vec<f64> = (0..10_000).map(|i| 360.0 + 470.0 * f64::from(i) / 9_999.0).collect();
    let ramp: Vec<f64> = nm.iter().map(|nm| nm - 300.0).collect();
    let table = |nm: &[f64], values: &[f64]| Spectrum::table(nm, values, Outside::Zero).unwrap();
    let few = table(&[360.0, 830.0], &[60.0, 530.0]);
    let daylight = library::find("D65").unwrap().spectrum;
    // Each extreme light with an ordinary light of the same colour.
    for (name, extreme, ordinary) in [
        ("10,000 samples", table(&nm, &ramp), few.clone()),
        ("denormal", table(&[360.0, 830.0], &[60e-312, 530e-312]), few),
        ("power 1e30", daylight.scaled(1e30 / daylight.integral()), daylight.clone()),
        ("power 1e-30", daylight.scaled(1e-30 / daylight.integral()), daylight.clone()),
    ] {
        let [found, known] =
            [&extreme, &ordinary].map(|light| report::ColourReport::of_light(light, observer).unwrap());
        assert!(near(found.xyz, known.xyz, 1e-6), "{name}: {:?} {:?}", found.xyz, known.xyz);
        assert!(near(found.linear_srgb, known.linear_srgb, 1e-6), "{name}");
    }
    for kelvin in [50.0, 1e7] {
        let report = report::ColourReport::of_light(&Spectrum::blackbody(kelvin).unwrap(), observer).unwrap();
        assert!(report.xyz.iter().chain(&report.linear_srgb).all(|value| value.is_finite()), "{kelvin} K: {report:?}");
    }
    let one = Spectrum::table(&[500.0], &[0.7], Outside::Hold).unwrap();
    let report = report::ColourReport::of_reflectance(&one, &daylight, observer).unwrap();
    assert!((report.xyz[1] - 70.0).abs() < 1e-9, "one sample is a grey: {:?}", report.xyz);
}

#[test]
fn two_lines_match_low_pressure_sodium_closely() {
    // A red and a green line have almost the chromaticity of the sodium doublet.
    let line = |nm: f64| Spectrum::lines(&[SpectralLine { nm, power: 1.0, fwhm_nm: None }]).unwrap();
    let observer = Observer::cie1931();
    let sodium = library::find("sodium-low-pressure").unwrap().spectrum;
    let primaries = [line(620.0), line(550.0)].map(|primary| report::xyz(&primary, observer));
    let found = colour::match_primaries(report::xyz(&sodium, observer), &primaries).unwrap();
    assert!(found.residual.delta_xy < 1e-3 && found.weights.iter().all(|weight| *weight > 0.0), "{found:?}");
    let xy = colour::xy(report::xyz(&sodium, observer));
    assert!((xy[0] - 0.5704).abs() < 1e-4 && (xy[1] - 0.4290).abs() < 1e-4);
}
