//! The contract of every spectrum and every wavelength distribution.

use abbe_spectra::spectrum::{
    BAND_NM, Observer, Outside, SpectralLine, Spectrum, WavelengthDistribution, library, planck,
};

/// A deterministic generator of numbers in [0, 1) (SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn line(nm: f64, power: f64, fwhm_nm: Option<f64>) -> SpectralLine {
    SpectralLine { nm, power, fwhm_nm }
}

fn good<T>(result: abbe_spectra::error::Result<T>) -> T {
    result.expect("the test's own spectra are good")
}

/// One spectrum of every kind, and the hard cases.
fn spectra() -> Vec<(String, Spectrum)> {
    let named = |name: &str| good(library::find(name)).spectrum;
    let many: Vec<f64> = (0..100_000).map(|i| 400.0 + 300.0 * f64::from(i) / 99_999.0).collect();
    let many_values: Vec<f64> = (0..100_000).map(|i| 1.0 + f64::from(i % 17)).collect();
    let sodium = named("sodium-low-pressure");
    let mut spectra = vec![
        ("constant".to_string(), Spectrum::constant(0.3)),
        ("one sample".into(), good(Spectrum::table(&[500.0], &[0.7], Outside::Hold))),
        ("two samples, zero outside".into(), good(Spectrum::table(&[500.0, 510.5], &[0.0, 2.0], Outside::Zero))),
        ("held".into(), good(Spectrum::table(&[300.0, 500.0, 900.0], &[0.2, 0.9, 0.1], Outside::Hold))),
        ("spikes".into(), good(Spectrum::table(&[400.0, 400.1, 400.2, 700.0], &[0.0, 9.0, 0.0, 0.0], Outside::Zero))),
        ("100,000 samples".into(), good(Spectrum::table(&many, &many_values, Outside::Zero))),
        ("denormal".into(), good(Spectrum::table(&[400.0, 500.0, 600.0], &[1e-310, 3e-310, 0.0], Outside::Hold))),
        ("power 1e30".into(), named("D65").scaled(1e30)),
        ("line of 1e-6 nm".into(), good(Spectrum::lines(&[line(532.123_456, 3.0, Some(1e-6))]))),
        (
            "overlapping lines".into(),
            good(Spectrum::lines(&[
                line(500.0, 1.0, Some(20.0)),
                line(505.0, 2.0, Some(20.0)),
                line(505.0, 3.0, None),
                line(360.0, 1.0, None),
                line(830.0, 1.0, Some(0.5)),
            ])),
        ),
        ("gaussian".into(), good(Spectrum::gaussian(550.0, 40.0))),
        ("narrow gaussian".into(), good(Spectrum::gaussian(632.8, 0.01))),
        ("gaussian beyond the band".into(), good(Spectrum::gaussian(850.0, 30.0))),
        ("power law".into(), good(Spectrum::power_law(550.0, 1.2e-5, -4.0))),
        ("green".into(), good(Spectrum::rgb_reflectance([0.1, 0.7, 0.2]))),
        ("red".into(), good(Spectrum::rgb_reflectance([1.0, 0.0, 0.0]))),
        ("blue light".into(), good(Spectrum::rgb_light([0.2, 0.3, 4.0]))),
        ("daylight and sodium".into(), Spectrum::mix(&[(0.01, &named("D65")), (3.0, &sodium), (0.5, &sodium)])),
        ("n of gold".into(), good(library::metal("gold")).index().0),
    ];
    for temperature in [50.0, 1000.0, 2856.0, 6500.0, 1e7] {
        spectra.push((format!("black body of {temperature} K"), good(Spectrum::blackbody(temperature))));
    }
    spectra.extend(library::names().map(|name| (name.to_string(), named(name))));
    spectra
}

/// Returns all wavelengths where a spectrum or an observer may have a kink or a jump.
fn knots(spectrum: &Spectrum) -> Vec<f64> {
    let mut knots: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    knots.extend(spectrum.continuum().flat_map(|piece| [piece.nm.0, piece.nm.1]));
    knots.extend(spectrum.line_segments().iter().flat_map(|line| [line.nm.0, line.nm.1]));
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    knots
}

/// Integrates a function that is linear between the knots by the midpoint rule, which is exact for
/// it.
fn integral(knots: &[f64], function: impl Fn(f64) -> f64) -> f64 {
    knots.windows(2).map(|pair| (pair[1] - pair[0]) * function(0.5 * (pair[0] + pair[1]))).sum()
}

#[test]
fn integrals_extremes_and_values_agree() {
    for (name, spectrum) in spectra() {
        let knots = knots(&spectrum);
        let total = spectrum.integral();
        let summed = integral(&knots, |nm| spectrum.at(nm));
        assert!((total - summed).abs() <= 1e-9 * total, "{name}: {total} {summed}");
        assert!((spectrum.product_integral(&Spectrum::constant(2.0)) - 2.0 * total).abs() <= 2e-12 * total, "{name}");
        let (min, max) = (spectrum.min(), spectrum.max());
        let mut numbers = Numbers(1);
        for _ in 0..1000 {
            let nm = BAND_NM.0 + numbers.next() * (BAND_NM.1 - BAND_NM.0);
            let value = spectrum.at(nm);
            assert!(value >= min * (1.0 - 1e-12) && value <= max * (1.0 + 1e-12), "{name} at {nm}: {value}");
        }
        for outside in [-1.0, 0.0, 299.999, 830.001, f64::NAN, f64::INFINITY] {
            assert_eq!(spectrum.at(outside), 0.0, "{name} at {outside}");
        }
    }
}

#[test]
fn products_of_spectra_are_exact() {
    // The midpoint rule is not exact for a product of two linear functions. Halving each interval
    // and extrapolating (Richardson) is exact for a cubic.
    let observer = Observer::cie1931();
    for (name, spectrum) in spectra() {
        let knots = knots(&spectrum);
        let halves: Vec<f64> = knots.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]).collect();
        let halves = [halves, vec![BAND_NM.1]].concat();
        for (i, bar) in observer.bars().iter().enumerate() {
            let product = |nm: f64| spectrum.at(nm) * observer.xyz_bar(nm)[i];
            let reference = (4.0 * integral(&halves, product) - integral(&knots, product)) / 3.0;
            let found = spectrum.product_integral(bar);
            assert!((found - reference).abs() <= 1e-9 * reference, "{name} {i}: {found} {reference}");
            assert_eq!(found, observer.xyz(&spectrum)[i]);
            let under = observer.xyz_under(&Spectrum::constant(0.5), &spectrum)[i];
            assert!((under - 0.5 * found).abs() <= 1e-12 * found, "{name} {i}");
        }
    }
}

fn distributions(spectrum: &Spectrum) -> [Option<WavelengthDistribution>; 2] {
    [WavelengthDistribution::new(spectrum), WavelengthDistribution::visually_weighted(spectrum, Observer::cie1931())]
}

/// Tells whether the power at a density is below the smallest normal number.
fn is_lost(pdf: f64, spectrum: &Spectrum) -> bool {
    pdf > 0.0 && pdf * spectrum.integral() < f64::MIN_POSITIVE
}

#[test]
fn wavelength_densities_integrate_to_1_and_cover_the_power() {
    for (name, spectrum) in spectra() {
        let knots = knots(&spectrum);
        for distribution in distributions(&spectrum) {
            let distribution = distribution.unwrap_or_else(|| panic!("{name} has power"));
            let total = integral(&knots, |nm| distribution.pdf(nm));
            assert!((total - 1.0).abs() < 1e-9, "{name}: {total}");
            for pair in knots.windows(2) {
                let middle = 0.5 * (pair[0] + pair[1]);
                let (pdf, power) = (distribution.pdf(middle), spectrum.at(middle));
                assert_eq!(pdf > 0.0, power > 0.0 || is_lost(pdf, &spectrum), "{name} at {middle}: {pdf} {power}");
            }
        }
    }
}

#[test]
fn a_sample_carries_its_own_density_also_at_the_ends() {
    let ends = [0.0, f64::MIN_POSITIVE, f64::EPSILON, 0.5, 1.0 - f64::EPSILON, 1.0_f64.next_down()];
    for (name, spectrum) in spectra() {
        for distribution in distributions(&spectrum).into_iter().flatten() {
            let mut numbers = Numbers(7);
            let mut u: Vec<f64> = ends.into_iter().chain((0..500).map(|_| numbers.next())).collect();
            u.extend((0..1000).map(|i| f64::from(i) / 1000.0));
            u.sort_by(f64::total_cmp);
            let mut last = BAND_NM.0;
            for u in u {
                let (nm, pdf) = distribution.sample(u);
                assert!((BAND_NM.0..=BAND_NM.1).contains(&nm), "{name}: {nm}");
                assert!(pdf > 0.0 && pdf.is_finite(), "{name}: {pdf} at {nm} for {u}");
                assert_eq!(pdf, distribution.pdf(nm), "{name} at {nm}");
                assert!(spectrum.at(nm) > 0.0 || is_lost(pdf, &spectrum), "{name} has no power at {nm}, drawn for {u}");
                assert!(nm >= last, "{name}: {nm} after {last}");
                last = nm;
            }
        }
    }
}

#[test]
fn samples_follow_the_pdf() {
    const BINS: usize = 47;
    const DRAWS: usize = 40_000;
    for (name, spectrum) in spectra() {
        // Each line is a bin of its own, so that the mass of the line itself is tested.
        let width = (BAND_NM.1 - BAND_NM.0) / BINS as f64;
        let mut edges: Vec<f64> = (0..=BINS).map(|i| BAND_NM.0 + width * i as f64).collect();
        edges.extend(spectrum.line_segments().iter().flat_map(|line| [line.nm.0, line.nm.1]));
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut knots = knots(&spectrum);
        knots.extend(&edges);
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        for (kind, distribution) in distributions(&spectrum).into_iter().flatten().enumerate() {
            let mut expected = vec![0.0; edges.len() - 1];
            for pair in knots.windows(2) {
                let middle = 0.5 * (pair[0] + pair[1]);
                let bin = edges.partition_point(|&edge| edge <= middle) - 1;
                expected[bin] += DRAWS as f64 * (pair[1] - pair[0]) * distribution.pdf(middle);
            }
            let mut counts = vec![0.0; expected.len()];
            let mut numbers = Numbers(11);
            for _ in 0..DRAWS {
                let (nm, _) = distribution.sample(numbers.next());
                counts[edges.partition_point(|&edge| edge <= nm) - 1] += 1.0;
            }
            let (chi_squared, bins) = chi_squared(&counts, &expected);
            // Several hundred correct tests would not reach this by chance (Wilson and Hilferty).
            let degrees = (bins - 1.0).max(1.0);
            let z = ((chi_squared / degrees).cbrt() - (1.0 - 2.0 / (9.0 * degrees))) / (2.0 / (9.0 * degrees)).sqrt();
            assert!(z < 4.5, "{name} {kind}: χ² = {chi_squared} with {bins} bins, z = {z}");
        }
    }
}

/// χ² over bins of at least ten expected draws; smaller bins are pooled.
fn chi_squared(counts: &[f64], expected: &[f64]) -> (f64, f64) {
    let (mut sum, mut bins) = (0.0, 0.0);
    let mut pool = (0.0, 0.0);
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected < 10.0 {
            pool = (pool.0 + count, pool.1 + expected);
        } else {
            sum += (count - expected).powi(2) / expected;
            bins += 1.0;
        }
    }
    if pool.1 > 10.0 {
        sum += (pool.0 - pool.1).powi(2) / pool.1;
        bins += 1.0;
    } else {
        assert!(pool.0 < 40.0, "{} draws where {} are expected", pool.0, pool.1);
    }
    (sum, bins)
}

#[test]
fn dividing_by_the_density_gives_back_the_integral() {
    for (name, spectrum) in spectra() {
        let total = spectrum.integral();
        let [plain, important] = distributions(&spectrum).map(|distribution| distribution.expect("there is power"));
        let strata = 20_000;
        let (mut sum, mut seen) = (0.0, 0.0);
        for i in 0..strata {
            let u = (f64::from(i) + 0.5) / f64::from(strata);
            let (nm, pdf) = plain.sample(u);
            // If the density is proportional to the spectrum, all draws have the same weight.
            assert!((spectrum.at(nm) / pdf / total - 1.0).abs() < 1e-6, "{name} at {nm}");
            let (nm, pdf) = important.sample(u);
            sum += spectrum.at(nm) / pdf / f64::from(strata);
            seen += spectrum.at(nm) * Observer::cie1931().xyz_bar(nm)[1] / pdf / f64::from(strata);
        }
        assert!((sum / total - 1.0).abs() < 2e-3, "{name}: {sum} {total}");
        let luminous = Observer::cie1931().xyz(&spectrum)[1];
        assert!((seen - luminous).abs() <= 2e-3 * luminous, "{name}: {seen} {luminous}");
    }
}

#[test]
fn no_power_no_distribution() {
    let dark = [
        Spectrum::constant(0.0),
        good(Spectrum::lines(&[line(253.65, 1.0, None)])),
        good(Spectrum::table(&[900.0, 1000.0], &[1.0, 1.0], Outside::Zero)),
        good(Spectrum::blackbody(5.0)),
    ];
    for spectrum in dark {
        assert!(WavelengthDistribution::new(&spectrum).is_none());
        assert!(WavelengthDistribution::visually_weighted(&spectrum, Observer::cie1931()).is_none());
    }
}

#[test]
fn formulas_are_followed_to_a_millionth_of_their_maximum() {
    let check = |name: &str, spectrum: &Spectrum, formula: &dyn Fn(f64) -> f64| {
        let max = spectrum.max();
        let mut numbers = Numbers(5);
        for _ in 0..20_000 {
            let nm = BAND_NM.0 + numbers.next() * (BAND_NM.1 - BAND_NM.0);
            assert!((spectrum.at(nm) - formula(nm)).abs() <= 1e-6 * max, "{name} at {nm}");
        }
    };
    for temperature in [50.0, 300.0, 1000.0, 2856.0, 6500.0, 1e5, 1e7] {
        let spectrum = good(Spectrum::blackbody(temperature));
        check(&format!("{temperature} K"), &spectrum, &|nm| planck(nm, temperature) * 1e-9);
    }
    let shape = |nm: f64, peak: f64, fwhm: f64| (-4.0 * 2.0_f64.ln() * ((nm - peak) / fwhm).powi(2)).exp();
    for (peak, fwhm) in [(550.0, 40.0), (500.3, 6.0), (632.8, 1.0), (850.0, 100.0)] {
        let spectrum = good(Spectrum::gaussian(peak, fwhm));
        check(&format!("{peak} nm, {fwhm} nm"), &spectrum, &|nm| shape(nm, peak, fwhm));
    }
    let law = good(Spectrum::power_law(550.0, 2.0, -4.0));
    check("power law", &law, &|nm| 2.0 * (nm / 550.0).powi(-4));
}

#[test]
fn narrow_peaks_keep_their_area() {
    for fwhm in [1e-6, 1e-3, 0.1, 1.0, 10.0] {
        let area = fwhm * (std::f64::consts::PI / (4.0 * 2.0_f64.ln())).sqrt();
        let found = good(Spectrum::gaussian(587.561_8, fwhm)).integral();
        assert!((found / area - 1.0).abs() < 1e-9, "{fwhm}: {found} {area}");
    }
    // Half of a peak at the edge of the band lies within the band.
    let half = good(Spectrum::gaussian(830.0, 4.0)).integral();
    let whole = good(Spectrum::gaussian(600.0, 4.0)).integral();
    assert!((half / whole - 0.5).abs() < 1e-9);
}

#[test]
fn black_bodies_are_right_from_50_k_to_10_million_k() {
    // Computed with sixty decimal digits by tests/golden/make_planck.py.
    let golden: serde_json::Value = serde_json::from_str(include_str!("../golden/planck.json")).expect("JSON");
    let rows = golden["rows"].as_array().expect("rows");
    let (mut compared, mut worst) = (0, 0.0_f64);
    for row in rows {
        let [kelvin, nm] = [0, 1].map(|i| row[i].as_f64().expect("a number"));
        let known: f64 = row[2].as_str().expect("digits").parse().expect("a number");
        let found = planck(nm, kelvin);
        if known >= f64::MIN_POSITIVE {
            compared += 1;
            worst = worst.max((found / known - 1.0).abs());
        } else {
            // Below the smallest normal number, the tolerance is the spacing of numbers there.
            assert!((found - known).abs() <= f64::from_bits(1), "{kelvin} K, {nm} nm: {found:e} {known:e}");
        }
        let spectrum = good(Spectrum::blackbody(kelvin));
        assert!(spectrum.integral().is_finite() && spectrum.max().is_finite(), "{kelvin} K");
    }
    println!("{compared} radiances, worst relative error {worst:.1e}");
    assert!(compared >= 160 && worst <= 1e-10, "{worst:e}");
    // Very cold bodies emit 0 at the shortest wavelength, without an error.
    assert_eq!([25.0, 50.0, 1e-300].map(|kelvin| planck(360.0, kelvin)), [0.0; 3]);
}

#[test]
fn what_cannot_be_a_table_is_named() {
    let fault = |nm: &[f64], values: &[f64]| match Spectrum::table(nm, values, Outside::Zero) {
        Ok(_) => panic!("{nm:?} {values:?} is a table"),
        Err(error) => error.to_string(),
    };
    assert!(fault(&[], &[]).contains("without entries"));
    assert!(fault(&[500.0], &[1.0]).contains("single sample"));
    assert!(fault(&[500.0, 510.0], &[1.0]).contains("2 wavelengths and 1 values"));
    assert!(fault(&[500.0, 490.0], &[1.0, 1.0]).contains("[1]: the wavelength 490 nm after 500 nm"));
    assert!(fault(&[500.0, 500.0], &[1.0, 1.0]).contains("[1]: the wavelength 500 nm, which occurs twice"));
    assert!(fault(&[500.0, 510.0], &[1.0, -1.0]).contains("[1]: the negative value -1"));
    assert!(fault(&[500.0, 510.0], &[f64::NAN, 1.0]).contains("[0]: the value NaN"));
    assert!(fault(&[500.0, f64::NAN], &[1.0, 1.0]).contains("[1]: the wavelength NaN"));
    assert!(fault(&[500.0, 510.0], &[1.0, f64::INFINITY]).contains("[1]: the value inf"));
    assert!(fault(&[-500.0, 510.0], &[1.0, 1.0]).contains("[0]: the wavelength -500"));
}

#[test]
fn what_cannot_be_computed_is_an_error() {
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        assert!(Spectrum::blackbody(bad).is_err());
        assert!(Spectrum::gaussian(bad, 10.0).is_err() && Spectrum::gaussian(500.0, bad).is_err());
        assert!(Spectrum::power_law(bad, 1.0, 1.0).is_err());
    }
    assert!(Spectrum::power_law(500.0, -1.0, 1.0).is_err() && Spectrum::power_law(1e-3, 1.0, 1e9).is_err());
    for bad in [f64::NAN, -0.1, 1.1] {
        assert!(Spectrum::rgb_reflectance([0.5, bad, 0.5]).is_err());
    }
    for bad in [f64::NAN, -0.1, f64::INFINITY] {
        assert!(Spectrum::rgb_light([0.5, bad, 0.5]).is_err());
    }
}

#[test]
fn lines_and_narrow_peaks_are_told_from_what_is_smooth() {
    let share = |spectrum: &Spectrum| spectrum.line_fraction();
    let named = |name: &str| share(&good(library::find(name)).spectrum);
    for smooth in ["D65", "A", "E", "led/white", "led/red", "sun/am1.5-global"] {
        assert_eq!(named(smooth), 0.0, "{smooth}");
    }
    for lines in ["sodium-low-pressure", "mercury-medium-pressure", "helium-neon-laser", "laser-rgb"] {
        assert!((named(lines) - 1.0).abs() < 1e-9, "{lines}: {}", named(lines));
    }
    assert!((share(&good(Spectrum::gaussian(532.0, 0.1))) - 1.0).abs() < 1e-9, "a laser");
    assert_eq!(share(&good(Spectrum::gaussian(532.0, 20.0))), 0.0);
    assert_eq!(share(&good(Spectrum::lines(&[line(500.0, 1.0, Some(20.0))]))), 0.0, "a box of 20 nm is no line");
    // Fine steps do not become lines.
    let nm: Vec<f64> = (0..4701).map(|i| 360.0 + 0.1 * f64::from(i)).collect();
    assert_eq!(share(&good(Spectrum::table(&nm, &vec![1.0; nm.len()], Outside::Zero))), 0.0);
    let half = Spectrum::mix(&[
        (1.0, &Spectrum::constant(1.0 / 470.0)),
        (1.0, &good(Spectrum::lines(&[line(500.0, 1.0, None)]))),
    ]);
    assert!((share(&half) - 0.5).abs() < 1e-9);
    assert_eq!(share(&Spectrum::constant(0.0)), 0.0);
}

#[test]
fn the_last_sample_of_a_lamps_table_belongs_to_it() {
    let lamp = good(Spectrum::table(&[380.0, 780.0], &[2.0, 3.0], Outside::Zero));
    assert_eq!([379.999, 380.0, 780.0, 780.001].map(|nm| lamp.at(nm).round()), [0.0, 2.0, 3.0, 0.0]);
}

#[test]
fn lights_of_a_colour_have_its_xyz() {
    for rgb in [[1.0, 1.0, 1.0], [0.2, 0.3, 4.0], [30.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.0]] {
        let found = Observer::cie1931().xyz(&good(Spectrum::rgb_light(rgb)));
        let back = abbe_spectra::colour::xyz_to_linear_srgb(found);
        let scale = rgb.iter().copied().fold(0.0, f64::max);
        for i in 0..3 {
            assert!((back[i] - rgb[i]).abs() <= 1e-3 * scale, "{rgb:?}: {back:?}");
        }
    }
}
