//! The likely causes that `abbe regress` names, for converters that are written here in another way
//! than the hypotheses.

use abbe_spectra::colour::RgbSpace;
use abbe_spectra::colour::adaptation::{AdaptationTransform, adapt};
use abbe_spectra::colour::regress::{
    CaseGroup, CauseName, ColourForm, FormColours, RegressionCase, RegressionReport, RegressionSet,
    RegressionTolerances, compare_given, compare_groups,
};
use abbe_spectra::spectrum::{Observer, Spectrum};

/// The matrix of IEC 61966-2-1, which is rounded to four digits.
const IEC: [[f64; 3]; 3] = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];

/// The matrix of sRGB for D50 of ICC profiles, as Lindbloom publishes it.
const ICC: [[f64; 3]; 3] =
    [[3.1338561, -1.6168667, -0.4906146], [-0.9787684, 1.9161415, 0.0334540], [0.0719453, -0.2289914, 1.4052427]];

/// Returns the forms of XYZ of a sample under a white, with Y = 1 for white.
type ColourOf = fn([f64; 3], [f64; 3]) -> Vec<(ColourForm, [f64; 3])>;

/// A converter: how it samples spectra, and how it computes colours.
struct Converter {
    /// The samples in nm, with their weights.
    samples: Vec<(f64, f64)>,
    observer: &'static Observer,
    /// Returns the wavelength at which a line is evaluated, or `None` to ignore it.
    line: fn(f64) -> Option<f64>,
    /// Changes a reflectance at a wavelength.
    reflectance: fn(&Spectrum, f64) -> f64,
    colour: ColourOf,
}

/// Returns samples from one wavelength to another, with half weights at both ends.
fn trapezoids(from: u32, to: u32, step: usize) -> Vec<(f64, f64)> {
    let weight = |nm: u32| if nm == from || nm == to { 0.5 } else { 1.0 };
    (from..=to).step_by(step).map(|nm| (f64::from(nm), weight(nm) * step as f64)).collect()
}

impl Default for Converter {
    fn default() -> Self {
        Self {
            samples: trapezoids(360, 830, 1),
            observer: Observer::cie1931(),
            line: Some,
            reflectance: Spectrum::continuum_at,
            colour: |xyz, _| forms(xyz, rgb(xyz), |linear| srgb(linear.clamp(0.0, 1.0))),
        }
    }
}

fn rgb(xyz: [f64; 3]) -> [f64; 3] {
    RgbSpace::Srgb.from_xyz(xyz)
}

fn product(matrix: &[[f64; 3]; 3], xyz: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(xyz).map(|(entry, value)| entry * value).sum())
}

fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn forms(xyz: [f64; 3], linear: [f64; 3], encode: impl Fn(f64) -> f64) -> Vec<(ColourForm, [f64; 3])> {
    vec![
        (ColourForm::Xyz, xyz.map(|value| 100.0 * value)),
        (ColourForm::LinearSrgb, linear),
        (ColourForm::Srgb, linear.map(encode)),
    ]
}

impl Converter {
    fn of_case(&self, set: &RegressionSet, case: &RegressionCase) -> FormColours {
        let spectrum = |name: &str| &set.spectra.iter().find(|entry| entry.name == name).unwrap().spectrum;
        let light = spectrum(&case.light);
        let reflectance =
            |nm: f64| case.reflectance.as_deref().map_or(1.0, |name| (self.reflectance)(spectrum(name), nm));
        let (mut sample, mut white) = ([0.0; 3], [0.0; 3]);
        let mut add = |nm: f64, power: f64| {
            let (bar, reflectance) = (self.observer.xyz_bar(nm), reflectance(nm));
            for i in 0..3 {
                white[i] += power * bar[i];
                sample[i] += power * bar[i] * reflectance;
            }
        };
        for (nm, weight) in &self.samples {
            add(*nm, weight * light.continuum_at(*nm));
        }
        for line in light.line_segments() {
            if let Some(nm) = (self.line)(line.centre()) {
                add(nm, line.power);
            }
        }
        let unit = |xyz: [f64; 3]| xyz.map(|value| value / white[1]);
        (self.colour)(unit(sample), unit(white)).into_iter().collect()
    }

    fn report(&self) -> RegressionReport {
        let set = RegressionSet::first();
        let colours: Vec<(String, FormColours)> =
            set.cases.iter().map(|case| (case.id.clone(), self.of_case(set, case))).collect();
        compare_groups(set, &colours, &[], RegressionTolerances::default()).unwrap()
    }

    fn cause(&self) -> Option<CauseName> {
        let report = self.report();
        assert!(report.failed > 0, "the converter passes");
        report.cause.map(|cause| cause.name)
    }
}

fn of_colour(colour: ColourOf) -> Converter {
    Converter { colour, ..Converter::default() }
}

#[test]
fn eight_wrong_converters_have_the_right_cause() {
    let converters = [
        (CauseName::TruncatedBand, Converter { samples: trapezoids(400, 700, 1), ..Converter::default() }),
        (CauseName::WrongAdaptation, of_colour(|xyz, _| forms(xyz, product(&ICC, xyz), srgb))),
        (CauseName::Clipping, of_colour(|xyz, _| forms(xyz, rgb(xyz).map(|value| value.clamp(0.0, 1.0)), srgb))),
        (
            CauseName::WrongTransferCurve,
            of_colour(|xyz, _| forms(xyz, rgb(xyz), |linear| linear.clamp(0.0, 1.0).powf(1.0 / 2.2))),
        ),
        (CauseName::CoarseStep, Converter { samples: trapezoids(360, 830, 10), ..Converter::default() }),
        (CauseName::RoundedLines, Converter { line: |nm| Some(nm.round()), ..Converter::default() }),
        (
            CauseName::SwappedChannels,
            of_colour(|xyz, _| {
                let [r, g, b] = rgb(xyz);
                forms(xyz, [b, g, r], |linear| srgb(linear.clamp(0.0, 1.0)))
            }),
        ),
        (
            CauseName::DoubledGamma,
            of_colour(|xyz, _| forms(xyz, rgb(xyz), |linear| srgb(srgb(linear.clamp(0.0, 1.0))))),
        ),
    ];
    for (cause, converter) in converters {
        assert_eq!(converter.cause(), Some(cause));
    }
}

#[test]
fn more_wrong_converters_have_the_right_cause() {
    let samples = |from, to, step| Converter { samples: trapezoids(from, to, step), ..Converter::default() };
    let ignored = Converter { line: |_| None, ..Converter::default() };
    let observer = Converter { observer: Observer::cie1964(), ..Converter::default() };
    let converters = [
        (CauseName::TruncatedBand, samples(400, 780, 1)),
        (CauseName::TruncatedBand, samples(390, 730, 1)),
        (CauseName::CoarseStep, samples(360, 830, 5)),
        (CauseName::TruncatedBandAndCoarseStep, samples(400, 700, 5)),
        (CauseName::MissingLines, ignored),
        (CauseName::RoundedLines, Converter { line: |nm| Some((nm / 5.0).round() * 5.0), ..Converter::default() }),
        (CauseName::WrongObserver, observer),
        (
            CauseName::WrongAdaptation,
            of_colour(|xyz, white| {
                let d50 = adapt(xyz, white, [0.9642, 1.0, 0.8249], AdaptationTransform::Bradford);
                vec![(ColourForm::Xyz, d50.map(|value| 100.0 * value))]
            }),
        ),
        (
            CauseName::RoundedValues,
            of_colour(|xyz, _| {
                let code = |linear: f64| (255.0 * srgb(linear.clamp(0.0, 1.0))).round() / 255.0;
                vec![(ColourForm::Srgb, rgb(xyz).map(code))]
            }),
        ),
        (CauseName::WrongScale, of_colour(|xyz, _| vec![(ColourForm::Xyz, xyz)])),
        (
            CauseName::Clipping,
            of_colour(|xyz, _| vec![(ColourForm::Srgb, rgb(xyz).map(|linear| srgb(linear.max(0.0))))]),
        ),
    ];
    for (cause, converter) in converters {
        assert_eq!(converter.cause(), Some(cause));
    }
}

/// The converters of this file ignore the emission of fluorescent samples.
#[test]
fn missing_fluorescence_is_a_cause() {
    let set = RegressionSet::second();
    let fluorescent = set.cases.iter().filter(|case| case.group == CaseGroup::Fluorescent);
    let xyz = of_colour(|xyz, _| vec![(ColourForm::Xyz, xyz.map(|value| 100.0 * value))]);
    let colours: Vec<_> = fluorescent.map(|case| (case.id.clone(), xyz.of_case(set, case))).collect();
    let report = compare_groups(set, &colours, &[CaseGroup::Fluorescent], RegressionTolerances::default()).unwrap();
    let cause = report.cause.unwrap();
    assert_eq!((report.failed, cause.name), (20, CauseName::MissingFluorescence));
    assert!(cause.residual < 1e-3, "{cause:?}");
}

#[test]
fn a_right_converter_has_no_cause() {
    let whole = (360..=830).map(|nm| (f64::from(nm), 1.0)).collect();
    let rounded_matrix = of_colour(|xyz, _| vec![(ColourForm::LinearSrgb, product(&IEC, xyz))]);
    for converter in [Converter::default(), Converter { samples: whole, ..Converter::default() }, rounded_matrix] {
        let report = converter.report();
        assert_eq!((report.failed, report.cause, report.hint), (0, None, None));
    }
}

#[test]
fn converters_that_are_wrong_in_other_ways_have_no_cause() {
    let squared = Converter { reflectance: |spectrum, nm| spectrum.continuum_at(nm).powi(2), ..Converter::default() };
    let shifted = Converter { samples: trapezoids(360, 830, 1), line: |nm| Some(nm + 3.0), ..Converter::default() };
    let converters = [
        ("squared reflectances", squared),
        ("lines moved by 3 nm", shifted),
        (
            "10 % less saturation",
            of_colour(|xyz, white| {
                let grey = white.map(|value| value * xyz[1]);
                let mixed = [0, 1, 2].map(|i| 0.9 * xyz[i] + 0.1 * grey[i]);
                vec![(ColourForm::LinearSrgb, rgb(mixed))]
            }),
        ),
        (
            "a contrast curve",
            of_colour(|xyz, _| {
                let curve = |linear: f64| {
                    let signal = srgb(linear.clamp(0.0, 1.0));
                    signal * signal * (3.0 - 2.0 * signal)
                };
                vec![(ColourForm::Srgb, rgb(xyz).map(curve))]
            }),
        ),
        ("a factor for Z", of_colour(|[x, y, z], _| vec![(ColourForm::Xyz, [x, y, 1.02 * z].map(|v| 100.0 * v))])),
        (
            "pseudorandom errors of 1 %",
            of_colour(|xyz, _| {
                let noise = |value: f64| 1.0 + 0.01 * (1e6 * value).sin();
                vec![(ColourForm::Xyz, xyz.map(|value| 100.0 * value * noise(value)))]
            }),
        ),
        (
            "half of an adaptation",
            of_colour(|xyz, white| {
                let d65 = adapt(xyz, white, [0.95047, 1.0, 1.08883], AdaptationTransform::Bradford);
                vec![(ColourForm::Xyz, [0, 1, 2].map(|i| 50.0 * (xyz[i] + d65[i])))]
            }),
        ),
        (
            "the third channel squared",
            of_colour(|xyz, _| {
                let [r, g, b] = rgb(xyz);
                vec![(ColourForm::LinearSrgb, [r, g, b * b])]
            }),
        ),
    ];
    for (what, converter) in converters {
        assert_eq!(converter.cause(), None, "{what}");
    }
}

/// Two wrong cases could agree with a hypothesis by chance.
#[test]
fn few_wrong_cases_have_no_cause() {
    let set = RegressionSet::first();
    let swapped = of_colour(|xyz, _| vec![(ColourForm::Xyz, [xyz[2], xyz[1], xyz[0]].map(|value| 100.0 * value))]);
    let cause = |count: usize| {
        let colours: Vec<(String, FormColours)> =
            set.cases[..count].iter().map(|case| (case.id.clone(), swapped.of_case(set, case))).collect();
        compare_given(set, &colours, RegressionTolerances::default()).unwrap().cause.map(|cause| cause.name)
    };
    assert_eq!((cause(2), cause(8)), (None, Some(CauseName::SwappedChannels)));
}
