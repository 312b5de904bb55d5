//! A simulated converter: the XYZ of cases from the samples of a set, with a choice of faults.

use std::collections::BTreeMap;

use super::set::{RegressionCase, RegressionSet, whole_nm};
use crate::colour::tristimulus::Xyz;
use crate::spectrum::{BAND_NM, Observer, Spectrum};

/// What a converter does with spectral lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LineHandling {
    /// It evaluates all functions at the wavelength of the line.
    Exact,
    /// It moves lines to the nearest multiple of a width in nm.
    Rounded(u32),
    /// It moves lines to the next multiple of a width in nm below them.
    Floored(u32),
    /// It ignores lines.
    Missing,
}

/// How a converter samples spectra.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sampling {
    pub step_nm: u32,
    pub lines: LineHandling,
    pub observer: &'static Observer,
    /// False if the converter ignores the emission of fluorescent samples.
    pub fluoresces: bool,
}

/// The part of the spectra that a converter uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SampledBand {
    /// The first and the last sample in nm.
    pub nm: (u32, u32),
    /// True if the converter also uses the lines outside.
    pub keeps_lines: bool,
    /// True if the first and the last sample have half of the weight of the others.
    pub half_ends: bool,
}

/// The band of the sets.
pub(super) const WHOLE_BAND: SampledBand =
    SampledBand { nm: (BAND_NM.0 as u32, BAND_NM.1 as u32), keeps_lines: true, half_ends: false };

/// XYZ of the light and of the light that a sample reflects, and the power that excites
/// fluorescence.
#[derive(Debug, Clone, Copy, Default)]
struct Received {
    light: Xyz,
    reflected: Xyz,
    excitation: f64,
}

impl Received {
    fn add(&mut self, factor: f64, other: &Self) {
        for i in 0..3 {
            self.light[i] += factor * other.light[i];
            self.reflected[i] += factor * other.reflected[i];
        }
        self.excitation += factor * other.excitation;
    }
}

/// Sums over samples up to each whole nm, in steps of some nm.
#[derive(Debug)]
struct StridedSums<T>(Vec<T>);

impl<T: Copy + Default> StridedSums<T> {
    fn new(terms: Vec<T>, step: usize, add: impl Fn(&mut T, f64, &T)) -> Self {
        let mut sums = terms;
        for i in step..sums.len() {
            let earlier = sums[i - step];
            add(&mut sums[i], 1.0, &earlier);
        }
        Self(sums)
    }

    /// Returns the integral over a band: the sum times the step.
    fn integral(&self, band: SampledBand, step: usize, add: impl Fn(&mut T, f64, &T)) -> T {
        let [first, end] = [band.nm.0, band.nm.1].map(|nm| (nm - WHOLE_BAND.nm.0) as usize);
        let (last, weight) = (end - (end - first) % step, step as f64);
        let mut integral = T::default();
        // Adds a sample, or all samples up to it.
        let mut add_up_to = |i: usize, weight: f64, alone: bool| {
            add(&mut integral, weight, &self.0[i]);
            if i >= step && alone {
                add(&mut integral, -weight, &self.0[i - step]);
            }
        };
        add_up_to(last, weight, false);
        if first >= step {
            add_up_to(first - step, -weight, false);
        }
        if band.half_ends {
            add_up_to(first, -0.5 * weight, true);
            add_up_to(last, -0.5 * weight, true);
        }
        integral
    }
}

fn add_xyz(sum: &mut Xyz, factor: f64, xyz: &Xyz) {
    (0..3).for_each(|i| sum[i] += factor * xyz[i]);
}

/// The sums of a case for all bands.
struct CaseSums {
    received: StridedSums<Received>,
    lines: Vec<(f64, Received)>,
    /// XYZ of the emission.
    emitted: Option<StridedSums<Xyz>>,
}

/// A converter that has sampled some cases.
pub(super) struct SampledCases {
    step: usize,
    cases: Vec<CaseSums>,
}

impl SampledCases {
    pub(super) fn new(set: &RegressionSet, cases: &[&RegressionCase], sampling: Sampling) -> Self {
        let bars: Vec<Xyz> = whole_nm().map(|nm| sampling.observer.xyz_bar(nm)).collect();
        let mut tables: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        let names = |case: &'_ RegressionCase| -> Vec<String> {
            let spectra = [Some(&case.light), case.reflectance.as_ref()].into_iter().flatten();
            spectra.chain(case.fluorescence.iter().flatten()).cloned().collect()
        };
        for spectrum in &set.spectra {
            if cases.iter().any(|case| names(case).contains(&spectrum.name)) {
                let table = whole_nm().map(|nm| spectrum.spectrum.continuum_at(nm)).collect();
                tables.insert(&spectrum.name, table);
            }
        }
        let cases = cases.iter().map(|case| CaseSums::new(set, case, sampling, &bars, &tables)).collect();
        Self { step: sampling.step_nm as usize, cases }
    }

    /// Returns XYZ of a case and of its light, scaled such that the light has Y = 100.
    pub(super) fn xyz(&self, case: usize, band: SampledBand) -> [Xyz; 2] {
        let CaseSums { received, lines, emitted } = &self.cases[case];
        let mut sum = received.integral(band, self.step, Received::add);
        let within = f64::from(band.nm.0)..=f64::from(band.nm.1);
        for (_, line) in lines.iter().filter(|(nm, _)| band.keeps_lines || within.contains(nm)) {
            sum.add(1.0, line);
        }
        if let Some(emitted) = emitted {
            add_xyz(&mut sum.reflected, sum.excitation, &emitted.integral(band, self.step, add_xyz));
        }
        [sum.reflected, sum.light].map(|xyz| xyz.map(|value| 100.0 * value / sum.light[1]))
    }
}

impl CaseSums {
    fn new(
        set: &RegressionSet,
        case: &RegressionCase,
        sampling: Sampling,
        bars: &[Xyz],
        tables: &BTreeMap<&str, Vec<f64>>,
    ) -> Self {
        let step = sampling.step_nm as usize;
        let fluorescence = case.fluorescence.as_ref().filter(|_| sampling.fluoresces);
        let received = |power: f64, reflectance: f64, excitation: f64, bar: &Xyz| Received {
            light: bar.map(|bar| power * bar),
            reflected: bar.map(|bar| power * reflectance * bar),
            excitation: power * excitation,
        };
        let table = |name: &String| &tables[name.as_str()];
        let light = table(&case.light);
        let (reflectance, excitation) =
            (case.reflectance.as_ref().map(table), fluorescence.map(|[name, _]| table(name)));
        let terms = bars.iter().enumerate().map(|(i, bar)| {
            let reflectance = reflectance.map_or(1.0, |reflectance| reflectance[i]);
            received(light[i], reflectance, excitation.map_or(0.0, |excitation| excitation[i]), bar)
        });
        let at = |name: Option<&String>, nm: f64| name.map(|name| set.spectrum(name).continuum_at(nm));
        let line = |(nm, power): (f64, f64)| {
            let reflectance = at(case.reflectance.as_ref(), nm).unwrap_or(1.0);
            let excitation = at(fluorescence.map(|[name, _]| name), nm).unwrap_or_default();
            (nm, received(power, reflectance, excitation, &sampling.observer.xyz_bar(nm)))
        };
        Self {
            received: StridedSums::new(terms.collect(), step, Received::add),
            lines: lines(set.spectrum(&case.light), sampling.lines).into_iter().map(line).collect(),
            emitted: fluorescence.map(|[_, emission]| {
                let emission = table(emission);
                let terms = bars.iter().zip(emission).map(|(bar, value)| bar.map(|bar| value * bar)).collect();
                StridedSums::new(terms, step, add_xyz)
            }),
        }
    }
}

/// Returns the wavelengths in nm and the powers of the lines of a light.
fn lines(light: &Spectrum, handling: LineHandling) -> Vec<(f64, f64)> {
    let moved = |nm: f64| match handling {
        LineHandling::Exact => Some(nm),
        LineHandling::Rounded(width) => Some((nm / f64::from(width)).round() * f64::from(width)),
        LineHandling::Floored(width) => Some((nm / f64::from(width)).floor() * f64::from(width)),
        LineHandling::Missing => None,
    };
    light.line_segments().iter().filter_map(|line| Some((moved(line.centre())?, line.power))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::regress::form::ColourForm;

    #[test]
    fn a_converter_without_faults_finds_the_expected_xyz() {
        for set in [RegressionSet::first(), RegressionSet::second()] {
            let cases: Vec<&RegressionCase> = set.cases.iter().collect();
            let observer = Observer::cie1931();
            let sampling = Sampling { step_nm: 1, lines: LineHandling::Exact, observer, fluoresces: true };
            let sampled = SampledCases::new(set, &cases, sampling);
            for (i, case) in cases.iter().enumerate() {
                let ([found, _], expected) = (sampled.xyz(i, WHOLE_BAND), case.expected.get(ColourForm::Xyz).unwrap());
                assert!(ColourForm::Xyz.largest_difference(found, expected) < 1e-9, "{}: {found:?}", case.id);
            }
        }
    }
}
