//! The likely cause of the errors of a converter.
//!
//! Each hypothesis is a simulated converter with one fault. The hypothesis with the smallest
//! residual is the likely cause if its residual is at most [`LARGEST_RESIDUAL`].

use super::converter::{LineHandling, SampledBand, SampledCases, Sampling, WHOLE_BAND};
use super::form::{ColourForm, FormKind, d65, encoded, linear};
use super::set::{RegressionCase, RegressionSet};
use crate::colour::adaptation::{AdaptationTransform, adapt};
use crate::colour::coordinates::{from_xy, lab};
use crate::colour::space::RgbSpace;
use crate::colour::tristimulus::Xyz;
use crate::math::elementary::powf;
use crate::spectrum::{OBSERVER_NAMES, Observer};
use serde::Serialize;

/// The largest residual of a likely cause. It leaves 1 % of the sum of the squared errors. Details
/// that no hypothesis contains, such as a rounded matrix or the interpolation at lines, change
/// colours by a few per cent of the smallest error that fails, and a hypothesis of another kind
/// leaves most of the error.
pub const LARGEST_RESIDUAL: f64 = 0.1;

/// The smallest number of failed cases that can have a likely cause. A hypothesis has up to three
/// parameters, and fewer cases could agree with one by chance.
const FEWEST_FAILED: usize = 3;

/// The smallest relative deviation of a factor from 1, or from another factor, that counts.
const SCALE_DEVIATION: f64 = 0.01;

/// The name of a cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CauseName {
    /// The sums begin or end within the band.
    TruncatedBand,
    /// The samples are several nm apart.
    CoarseStep,
    /// The samples are several nm apart, and the sums begin or end within the band.
    TruncatedBandAndCoarseStep,
    /// Lines are moved to a multiple of some nm.
    RoundedLines,
    /// Lines are ignored.
    MissingLines,
    /// The emission of fluorescent samples is ignored.
    MissingFluorescence,
    /// The colour-matching functions of another observer are used.
    WrongObserver,
    /// Colours are adapted to another white, or not adapted.
    WrongAdaptation,
    /// The RGB space or Lab has another white.
    WrongWhite,
    /// The RGB space has other primaries.
    WrongPrimaries,
    /// Values are clipped, or not clipped.
    Clipping,
    /// The transfer curve is another one or missing.
    WrongTransferCurve,
    /// The transfer curve is applied twice.
    DoubledGamma,
    /// The components are in another order.
    SwappedChannels,
    /// Values are rounded, for example to 8 bits.
    RoundedValues,
    /// All values have the same wrong factor.
    WrongScale,
    /// The values of each light have a factor of their own.
    ScaledLights,
}

impl CauseName {
    /// Returns the name in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::TruncatedBand => "truncated band",
            Self::CoarseStep => "coarse step",
            Self::TruncatedBandAndCoarseStep => "truncated band and coarse step",
            Self::RoundedLines => "rounded lines",
            Self::MissingLines => "missing lines",
            Self::MissingFluorescence => "missing fluorescence",
            Self::WrongObserver => "wrong observer",
            Self::WrongAdaptation => "wrong adaptation",
            Self::WrongWhite => "wrong white",
            Self::WrongPrimaries => "wrong primaries",
            Self::Clipping => "clipping",
            Self::WrongTransferCurve => "wrong transfer curve",
            Self::DoubledGamma => "doubled gamma",
            Self::SwappedChannels => "swapped channels",
            Self::RoundedValues => "rounded values",
            Self::WrongScale => "wrong scale",
            Self::ScaledLights => "scaled lights",
        }
    }
}

/// The fault that explains the errors of a converter best.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LikelyCause {
    /// The name.
    pub name: CauseName,
    /// The form whose errors it explains: the first of [`ColourForm::ALL`] with a failed case.
    pub form: &'static str,
    /// What the converter probably does, as a clause.
    pub explanation: String,
    /// The root of the sum of squared errors that the cause leaves, relative to that of all errors.
    /// It is 0 if the cause explains everything, and at most [`LARGEST_RESIDUAL`].
    pub residual: f64,
}

/// A case with the colour of a converter in the form under test.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observation<'a> {
    pub case: &'a RegressionCase,
    pub expected: [f64; 3],
    pub found: [f64; 3],
}

/// Returns the likely cause of the errors of one form, if a hypothesis explains them. Differences
/// of at most `tolerance` count neither as error nor as residual. Values that are not finite count
/// as 0: a converter divides 0 by 0 if it ignores all light.
pub(super) fn likely_cause(
    set: &RegressionSet,
    form: ColourForm,
    observations: &[Observation<'_>],
    tolerance: f64,
) -> Option<LikelyCause> {
    let mut seen = observations.to_vec();
    seen.iter_mut().for_each(|seen| seen.found = seen.found.map(finite_or_0));
    let fails = |seen: &&Observation<'_>| form.largest_difference(seen.found, seen.expected) > tolerance;
    if seen.iter().filter(fails).count() < FEWEST_FAILED {
        return None;
    }
    let mut search = Search { form, seen: &seen, tolerance, all_errors: 0.0, best: None };
    search.all_errors = seen.iter().map(|seen| search.difference(seen, seen.expected).0).sum();
    let cases: Vec<&RegressionCase> = seen.iter().map(|seen| seen.case).collect();
    search.try_values();
    search.try_colour_faults(set, &cases);
    search.try_sampling_faults(set, &cases);
    if search.best.is_none() {
        search.try_coarse_steps(set, &cases, &bands().collect::<Vec<_>>());
    }
    search.best
}

struct Search<'a> {
    form: ColourForm,
    seen: &'a [Observation<'a>],
    tolerance: f64,
    /// The sum of all squared errors, to give up a hypothesis early.
    all_errors: f64,
    best: Option<LikelyCause>,
}

impl Search<'_> {
    /// Compares a hypothesis with the best one. `predicted` returns the colour of a case.
    fn test(&mut self, name: CauseName, explanation: impl Fn() -> String, predicted: impl Fn(usize) -> [f64; 3]) {
        let best = self.best.as_ref().map_or(LARGEST_RESIDUAL, |best| best.residual);
        let (mut errors, mut left) = (0.0, 0.0);
        for (i, seen) in self.seen.iter().enumerate() {
            let predicted = predicted(i).map(finite_or_0);
            let [(error, largest_error), (rest, largest_rest)] =
                [seen.expected, predicted].map(|from| self.difference(seen, from));
            if largest_error.max(largest_rest) > self.tolerance {
                errors += error;
                left += rest;
            }
            if left > best * best * self.all_errors {
                return;
            }
        }
        let residual = (left / errors).sqrt();
        if residual < best {
            let (form, explanation) = (self.form.name(), explanation());
            self.best = Some(LikelyCause { name, form, explanation, residual });
        }
    }

    /// Returns the sum of the squared differences of the components and the largest difference.
    fn difference(&self, seen: &Observation<'_>, from: [f64; 3]) -> (f64, f64) {
        let scale = self.form.scale(seen.expected);
        let differences = [0, 1, 2].map(|k| ((seen.found[k] - from[k]) / scale).abs());
        (
            differences.iter().map(|difference| difference * difference).sum(),
            differences.into_iter().fold(0.0, f64::max),
        )
    }

    /// Tests faults that change only the values of the form: scale, order, rounding, clipping and
    /// transfer curves.
    fn try_values(&mut self) {
        let (form, seen) = (self.form, self.seen);
        let (name, white, letters) = (form.name(), form.white(), form.letters());
        let unit = format!("a light and the perfect diffuser have Y = {white} in {name}");
        if let Some(factor) = factor_of(seen).filter(|factor| (factor - 1.0).abs() > SCALE_DEVIATION) {
            let what = || format!("all values of {name} are {factor:.4} times the expected values; {unit}");
            self.test(CauseName::WrongScale, what, |i| seen[i].expected.map(|value| factor * value));
        }
        if let Some(factors) = factors_by_light(seen) {
            let what = || format!("the values of {name} have another factor for each light; {unit}");
            self.test(CauseName::ScaledLights, what, |i| seen[i].expected.map(|value| factors[i] * value));
        }
        for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let what = || format!("the components of {name} are in the order {}", order.map(|k| letters[k]).join(", "));
            self.test(CauseName::SwappedChannels, what, |i| order.map(|k| seen[i].expected[k]));
        }
        for steps in [10.0, 100.0, 255.0, 1000.0] {
            let rounded = |offset: f64| move |value: f64| (value / white * steps + offset).floor() / steps * white;
            for (offset, how) in [(0.5, "rounded"), (0.0, "cut off")] {
                let what = || format!("the values of {name} are {how} to multiples of {white}/{steps}");
                self.test(CauseName::RoundedValues, what, |i| seen[i].expected.map(rounded(offset)));
            }
        }
        for (least, most, what) in [
            (0.0, white, format!("are clipped to 0–{white}")),
            (0.0, f64::INFINITY, "are clipped below 0".to_string()),
            (f64::NEG_INFINITY, white, format!("are clipped above {white}")),
        ] {
            let what = || format!("the values of {name} {what}");
            self.test(CauseName::Clipping, what, |i| seen[i].expected.map(|value| value.clamp(least, most)));
        }
        match form.kind() {
            FormKind::Linear(space) => {
                let curve = if space == RgbSpace::AcesCg { RgbSpace::Srgb } else { space };
                let what = || format!("the values of {name} are encoded with the transfer curve");
                self.test(CauseName::WrongTransferCurve, what, |i| {
                    seen[i].expected.map(|component| curve.encode(component))
                });
                self.test(CauseName::WrongTransferCurve, what, |i| encoded(curve, seen[i].expected));
                let what = || format!("the values of {name} are decoded with the transfer curve");
                self.test(CauseName::WrongTransferCurve, what, |i| {
                    seen[i].expected.map(|component| curve.decode(component))
                });
            }
            FormKind::Encoded(space) => self.try_curves(space),
            FormKind::Xyz | FormKind::Lab => {}
        }
    }

    /// Tests other transfer curves of an encoded form.
    fn try_curves(&mut self, space: RgbSpace) {
        let (seen, name) = (self.seen, self.form.name());
        let encoded = |i: usize| seen[i].expected;
        let linear = |i: usize| encoded(i).map(|signal| space.decode(signal));
        let what = || format!("the values of {name} are linear, because the transfer curve is missing");
        self.test(CauseName::WrongTransferCurve, what, linear);
        for other in
            [RgbSpace::Srgb, RgbSpace::Rec2020].into_iter().filter(|other| other.encode(0.5) != space.encode(0.5))
        {
            let what = || format!("{name} has the transfer curve of {}", other.name());
            self.test(CauseName::WrongTransferCurve, what, |i| linear(i).map(|component| other.encode(component)));
        }
        for tenths in 14..=30 {
            let gamma = f64::from(tenths) / 10.0;
            let power = |values: [f64; 3]| values.map(|value| powf(value, 1.0 / gamma));
            let what = || format!("the transfer curve of {name} is a power of 1/{gamma}");
            self.test(CauseName::WrongTransferCurve, what, |i| power(linear(i)));
            let what = || format!("a power of 1/{gamma} is applied to {name} after the transfer curve");
            self.test(CauseName::DoubledGamma, what, |i| power(encoded(i)));
        }
        let what = || format!("the transfer curve of {name} is applied twice");
        self.test(CauseName::DoubledGamma, what, |i| encoded(i).map(|signal| space.encode(signal)));
    }

    /// Tests faults between XYZ and the form: adaptation, white, primaries, and signals that are
    /// encoded without clipping.
    fn try_colour_faults(&mut self, set: &RegressionSet, cases: &[&RegressionCase]) {
        let (form, name) = (self.form, self.form.name());
        let exact = SampledCases::new(set, cases, sampling(form));
        let xyz: Vec<[Xyz; 2]> = (0..cases.len()).map(|i| exact.xyz(i, WHOLE_BAND)).collect();
        let what = || format!("{name} is not adapted to D65");
        self.test(CauseName::WrongAdaptation, what, |i| form.of_adapted_xyz(xyz[i][0], xyz[i][1]));
        for (transform, words) in TRANSFORMS {
            for (white, to) in WHITES {
                let what = || format!("{name} is adapted from the light to {white} by {words}");
                self.test(CauseName::WrongAdaptation, what, |i| {
                    let [xyz, light] = xyz[i];
                    form.of_adapted_xyz(adapted(xyz, light, xyz_of(to), transform), light)
                });
                for (from, to, direction) in
                    [(to, D65, format!("{white} to D65")), (D65, to, format!("D65 to {white}"))]
                {
                    let what = || format!("{name} is adapted from {direction} by {words}");
                    self.test(CauseName::WrongAdaptation, what, |i| {
                        let [xyz, light] = xyz[i];
                        form.of_xyz(adapted(xyz, xyz_of(from), xyz_of(to), transform), light)
                    });
                }
            }
        }
        let space = match form.kind() {
            FormKind::Linear(space) | FormKind::Encoded(space) => space,
            FormKind::Lab => {
                for (white, other) in WHITES {
                    let what = || format!("the white of {name} is {white} instead of the light");
                    self.test(CauseName::WrongWhite, what, |i| lab(xyz[i][0], xyz_of(other)));
                }
                return;
            }
            FormKind::Xyz => return,
        };
        let is_encoded = form.kind() == FormKind::Encoded(space);
        let finished = |linear: [f64; 3]| if is_encoded { encoded(space, linear) } else { linear };
        for (white, other) in WHITES {
            let gain = linear(space, xyz_of(other));
            let what = || format!("the white of the RGB space of {name} is {white}");
            self.test(CauseName::WrongWhite, what, |i| {
                let rgb = linear(space, xyz[i][0]);
                finished([0, 1, 2].map(|k| rgb[k] / gain[k]))
            });
        }
        let what = || format!("{name} is not adapted to the white of the RGB space");
        self.test(CauseName::WrongAdaptation, what, |i| finished(space.from_xyz(xyz[i][0].map(|value| value / 100.0))));
        for other in RgbSpace::ALL.into_iter().filter(|other| *other != space) {
            let what = || format!("{name} has the primaries of {}", other.name());
            self.test(CauseName::WrongPrimaries, what, |i| finished(linear(other, xyz[i][0])));
        }
        if is_encoded {
            for (least, most, what) in [
                (f64::NEG_INFINITY, f64::INFINITY, "below 0 and above 1"),
                (f64::NEG_INFINITY, 1.0, "below 0"),
                (0.0, f64::INFINITY, "above 1"),
            ] {
                let what = || format!("the values of {name} are not clipped {what}");
                self.test(CauseName::Clipping, what, |i| {
                    linear(space, xyz[i][0]).map(|component| space.encode(component.clamp(least, most)))
                });
            }
        }
    }

    /// Tests one fault of the sampling of spectra.
    fn try_sampling_faults(&mut self, set: &RegressionSet, cases: &[&RegressionCase]) {
        let form = self.form;
        let right = sampling(form);
        let exact = SampledCases::new(set, cases, right);
        for band in bands() {
            let ((from, to), whole) = (band.nm, WHOLE_BAND.nm);
            let what = || format!("the sums cover {from}–{to} nm instead of {}–{} nm", whole.0, whole.1);
            self.test_sampled(CauseName::TruncatedBand, what, &exact, band);
        }
        self.try_coarse_steps(set, cases, &[WHOLE_BAND]);
        for width in [1, 2, 5, 10] {
            for (lines, where_to) in [(LineHandling::Rounded(width), ""), (LineHandling::Floored(width), " below them")]
            {
                let moved = SampledCases::new(set, cases, Sampling { lines, ..right });
                let what = || format!("lines are moved to multiples of {width} nm{where_to}");
                self.test_sampled(CauseName::RoundedLines, what, &moved, WHOLE_BAND);
            }
        }
        let without = SampledCases::new(set, cases, Sampling { lines: LineHandling::Missing, ..right });
        self.test_sampled(CauseName::MissingLines, || "spectral lines are ignored".to_string(), &without, WHOLE_BAND);
        let without = SampledCases::new(set, cases, Sampling { fluoresces: false, ..right });
        let what = || "the emission of fluorescent samples is ignored".to_string();
        self.test_sampled(CauseName::MissingFluorescence, what, &without, WHOLE_BAND);
        for name in OBSERVER_NAMES.into_iter().filter(|name| *name != right.observer.name()) {
            let observer = Observer::by_name(name).expect("the names are known");
            let other = SampledCases::new(set, cases, Sampling { observer, ..right });
            let what = || format!("the observer is {name} instead of {}", right.observer.name());
            self.test_sampled(CauseName::WrongObserver, what, &other, WHOLE_BAND);
        }
    }

    /// Tests samples in steps of several nm, within some bands.
    fn try_coarse_steps(&mut self, set: &RegressionSet, cases: &[&RegressionCase], bands: &[SampledBand]) {
        for step_nm in [2, 4, 5, 10, 20] {
            for lines in [LineHandling::Exact, LineHandling::Rounded(step_nm)] {
                let sampled = SampledCases::new(set, cases, Sampling { step_nm, lines, ..sampling(self.form) });
                for &band in bands {
                    let (name, within) = if band == WHOLE_BAND {
                        (CauseName::CoarseStep, String::new())
                    } else {
                        (CauseName::TruncatedBandAndCoarseStep, format!(" from {} to {} nm", band.nm.0, band.nm.1))
                    };
                    let what = || format!("spectra are sampled in steps of {step_nm} nm{within}");
                    self.test_sampled(name, what, &sampled, band);
                }
            }
        }
    }

    fn test_sampled(
        &mut self,
        name: CauseName,
        explanation: impl Fn() -> String,
        sampled: &SampledCases,
        band: SampledBand,
    ) {
        let form = self.form;
        self.test(name, explanation, |i| {
            let [xyz, white] = sampled.xyz(i, band);
            form.of_xyz(xyz, white)
        });
    }
}

fn finite_or_0(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The sampling of a converter without faults.
fn sampling(form: ColourForm) -> Sampling {
    Sampling { step_nm: 1, lines: LineHandling::Exact, observer: form.observer(), fluoresces: true }
}

/// Returns the truncated bands, with limits at multiples of 5 nm.
fn bands() -> impl Iterator<Item = SampledBand> {
    let ends = (620..=WHOLE_BAND.nm.1).step_by(5);
    let starts = (WHOLE_BAND.nm.0..=450).step_by(5);
    let limits = starts.flat_map(move |start| ends.clone().map(move |end| (start, end)));
    let variants = [(true, false), (true, true), (false, false), (false, true)];
    let bands = move |nm| variants.map(|(keeps_lines, half_ends)| SampledBand { nm, keeps_lines, half_ends });
    limits.flat_map(bands).filter(|band| band.nm != WHOLE_BAND.nm)
}

type Whitepoint = [f64; 2];

const D65: Whitepoint = [0.3127, 0.3290];

/// Whites that converters assume, and their chromaticities (CIE 15, Academy TB-2018-001).
const WHITES: [(&str, Whitepoint); 6] = [
    ("D50", [0.3457, 0.3585]),
    ("D65", D65),
    ("A", [0.447_57, 0.407_45]),
    ("C", [0.310_06, 0.316_16]),
    ("E", [1.0 / 3.0, 1.0 / 3.0]),
    ("the white of ACES", [0.321_68, 0.337_67]),
];

/// Transforms of adaptation. `None` scales X, Y and Z.
const TRANSFORMS: [(Option<AdaptationTransform>, &str); 3] = [
    (Some(AdaptationTransform::Bradford), "Bradford's transform"),
    (Some(AdaptationTransform::Cat16), "CAT16"),
    (None, "factors for X, Y and Z"),
];

fn xyz_of(white: Whitepoint) -> Xyz {
    if white == D65 { d65() } else { from_xy(white, 100.0) }
}

fn adapted(xyz: Xyz, from: Xyz, to: Xyz, transform: Option<AdaptationTransform>) -> Xyz {
    match transform {
        Some(transform) => adapt(xyz, from, to, transform),
        None => [0, 1, 2].map(|k| xyz[k] * to[k] / from[k] * from[1] / to[1]),
    }
}

/// Returns the factor between found and expected colours with the least squared error.
fn factor_of<'a>(seen: impl IntoIterator<Item = &'a Observation<'a>>) -> Option<f64> {
    let (products, squares) = seen.into_iter().fold((0.0, 0.0), |(products, squares), seen| {
        let product: f64 = seen.found.iter().zip(seen.expected).map(|(found, expected)| found * expected).sum();
        (products + product, squares + seen.expected.iter().map(|value| value * value).sum::<f64>())
    });
    Some(products / squares).filter(|factor| *factor > 0.0)
}

/// Returns for each case the factor of its light, if the lights have different factors.
fn factors_by_light(seen: &[Observation<'_>]) -> Option<Vec<f64>> {
    let of_light = |light: &str| factor_of(seen.iter().filter(|seen| seen.case.light == light));
    let factors = seen.iter().map(|seen| of_light(&seen.case.light)).collect::<Option<Vec<f64>>>()?;
    let (least, most) = factors.iter().fold((f64::INFINITY, 0.0), |(least, most), &f| (f.min(least), f.max(most)));
    (most / least - 1.0 > SCALE_DEVIATION).then_some(factors)
}
