//! The spectra, the cases and the expected colours of the regression sets.

use std::sync::OnceLock;

use super::form::{ColourForm, FormColours};
use crate::colour::report;
use crate::colour::tristimulus::Xyz;
use crate::error::{Error, Result};
use crate::spectrum::{BAND_NM, Observer, Outside, SpectralLine, Spectrum, library};
use serde::Serialize;

/// Continuous lamps of the library.
const LAMPS: [&str; 12] = [
    "A",
    "D50",
    "D65",
    "E",
    "C",
    "FL2",
    "FL11",
    "HP1",
    "LED-B3",
    "sodium-high-pressure",
    "led/white",
    "sun/am1.5-global",
];

/// Lamps of the library that consist of spectral lines.
const LINE_LAMPS: [&str; 8] = [
    "sodium-d",
    "sodium-low-pressure",
    "helium-neon-laser",
    "mercury-medium-pressure",
    "neon-glow",
    "hydrogen-balmer",
    "laser-rgb",
    "rec2020-primaries",
];

/// The lamps that illuminate the ColorChecker.
const CHART_LAMPS: [&str; 8] = ["A", "D50", "D65", "FL2", "FL11", "HP1", "LED-B3", "sodium-low-pressure"];

/// The names of lights of three LEDs with the colours of lamps, and the weights of `led/red`,
/// `led/green` and `led/blue`. The colours are equal, but most surfaces look different.
const LED_MATCHES: [(&str, [f64; 3]); 1] = [("led-match/HP1", [686.628812, 142.709387, 11.9683947])];

const CHART: &str = "colorchecker/";

/// The lamps of the second set: those of [`CHART_LAMPS`] that can be a white.
const WHITE_LAMPS: [&str; 7] = ["A", "D50", "D65", "FL2", "FL11", "HP1", "LED-B3"];

/// The lamps that illuminate the fluorescent samples. Mercury vapour consists of lines.
const EXCITING_LAMPS: [&str; 5] = ["D65", "A", "FL11", "LED-B3", "mercury-medium-pressure"];

/// A fluorescent sample. Its excitation and its emission are Gaussian.
struct FluorescentSample {
    name: &'static str,
    /// The reflectance.
    patch: &'static str,
    /// The emitted power per absorbed power at the peak of the excitation.
    peak_yield: f64,
    /// The peak and the full width at half maximum in nm.
    excitation_nm: [f64; 2],
    emission_nm: [f64; 2],
}

impl FluorescentSample {
    const fn new(
        name: &'static str,
        patch: &'static str,
        peak_yield: f64,
        excitation_nm: [f64; 2],
        emission_nm: [f64; 2],
    ) -> Self {
        Self { name, patch, peak_yield, excitation_nm, emission_nm }
    }
}

const FLUORESCENT: [FluorescentSample; 4] = [
    FluorescentSample::new("fluorescent/paper", "colorchecker/white", 0.4, [375.0, 45.0], [440.0, 55.0]),
    FluorescentSample::new("fluorescent/yellow", "colorchecker/yellow", 0.6, [455.0, 60.0], [515.0, 45.0]),
    FluorescentSample::new("fluorescent/orange", "colorchecker/orange", 0.7, [500.0, 70.0], [595.0, 40.0]),
    FluorescentSample::new("fluorescent/red", "colorchecker/red", 0.6, [540.0, 60.0], [620.0, 45.0]),
];

/// The group of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseGroup {
    /// Lamps with a continuous spectrum.
    Lamps,
    /// Lamps that consist of spectral lines.
    Lines,
    /// Single lines at 420, 430, … 680 nm.
    Monochromatic,
    /// The ColorChecker under lamps.
    Surfaces,
    /// The ColorChecker under LEDs with the colour of a lamp.
    Metamers,
    /// Fluorescent samples under lamps.
    Fluorescent,
}

impl CaseGroup {
    /// All groups.
    pub const ALL: [Self; 6] =
        [Self::Lamps, Self::Lines, Self::Monochromatic, Self::Surfaces, Self::Metamers, Self::Fluorescent];

    /// Returns the name of the group.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lamps => "lamps",
            Self::Lines => "lines",
            Self::Monochromatic => "monochromatic",
            Self::Surfaces => "surfaces",
            Self::Metamers => "metamers",
            Self::Fluorescent => "fluorescent",
        }
    }
}

/// What a spectrum of a set describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SpectrumRole {
    /// The power of a light per nm.
    Light,
    /// The reflectance of a surface.
    Reflectance,
    /// The power that a fluorescent sample emits at all wavelengths, relative to the light's.
    Excitation,
    /// The fraction of the emitted power per nm.
    Emission,
}

/// A spectrum of the set.
#[derive(Debug, Clone, PartialEq)]
pub struct RegressionSpectrum {
    /// The name. It contains no comma and no space.
    pub name: String,
    /// What the spectrum describes.
    pub role: SpectrumRole,
    /// The spectrum.
    pub spectrum: Spectrum,
}

/// A light, or a sample under a light, with its colour.
#[derive(Debug, Clone, PartialEq)]
pub struct RegressionCase {
    /// The name of the case. It contains no comma and no space.
    pub id: String,
    /// The group.
    pub group: CaseGroup,
    /// The name of the light.
    pub light: String,
    /// The name of the reflectance, or `None` if the case is the colour of the light.
    pub reflectance: Option<String>,
    /// The names of excitation and emission, if the sample is fluorescent.
    pub fluorescence: Option<[String; 2]>,
    /// The expected colour, in all forms of the set.
    pub expected: FormColours,
}

/// The spectra and the cases of a set.
#[derive(Debug)]
pub struct RegressionSet {
    /// The name and the version.
    pub name: &'static str,
    /// The forms of the expected colours.
    pub forms: &'static [ColourForm],
    /// The spectra.
    pub spectra: Vec<RegressionSpectrum>,
    /// The cases.
    pub cases: Vec<RegressionCase>,
}

impl RegressionSet {
    /// Returns the first set: lights and surfaces as XYZ, linear sRGB and sRGB.
    pub fn first() -> &'static Self {
        static SET: OnceLock<RegressionSet> = OnceLock::new();
        SET.get_or_init(Self::build_first)
    }

    /// Returns the second set: surfaces and fluorescent samples in all forms.
    pub fn second() -> &'static Self {
        static SET: OnceLock<RegressionSet> = OnceLock::new();
        SET.get_or_init(Self::build_second)
    }

    /// Returns a set by its number, or an error if it is neither 1 nor 2.
    pub fn by_number(number: u32) -> Result<&'static Self> {
        match number {
            1 => Ok(Self::first()),
            2 => Ok(Self::second()),
            _ => Err(Error::input(format!("there is no regression set {number}")).expected("1 or 2")),
        }
    }

    /// Returns a spectrum by the name that a case contains.
    pub(super) fn spectrum(&self, name: &str) -> &Spectrum {
        let named = self.spectra.iter().find(|entry| entry.name == name);
        &named.expect("a case names a spectrum of the set").spectrum
    }

    fn build_first() -> Self {
        let mut set =
            Self { name: "abbe-regress 1", forms: &ColourForm::ALL[..3], spectra: Vec::new(), cases: Vec::new() };
        let line = |nm: f64| Spectrum::lines(&[SpectralLine { nm, power: 1.0, fwhm_nm: None }]);
        let lines = (42..=68).map(|tens| f64::from(10 * tens));
        LAMPS.iter().for_each(|name| set.add_light(name, CaseGroup::Lamps, of_library(name)));
        LINE_LAMPS.iter().for_each(|name| set.add_light(name, CaseGroup::Lines, of_library(name)));
        for nm in lines {
            let light = line(nm).expect("a line within the band is valid");
            set.add_light(&format!("line/{nm}"), CaseGroup::Monochromatic, light);
        }
        for (name, weights) in LED_MATCHES {
            set.add_light(name, CaseGroup::Metamers, led_mix(weights));
        }
        let patches = set.add_patches();
        CHART_LAMPS.iter().for_each(|lamp| set.add_chart(&patches, lamp, CaseGroup::Surfaces));
        LED_MATCHES.iter().for_each(|(light, _)| set.add_chart(&patches, light, CaseGroup::Metamers));
        set
    }

    fn build_second() -> Self {
        let mut set = Self { name: "abbe-regress 2", forms: &ColourForm::ALL, spectra: Vec::new(), cases: Vec::new() };
        WHITE_LAMPS.iter().for_each(|name| set.add_spectrum(name, SpectrumRole::Light, of_library(name)));
        LED_MATCHES.iter().for_each(|(name, weights)| set.add_spectrum(name, SpectrumRole::Light, led_mix(*weights)));
        let mercury = EXCITING_LAMPS[EXCITING_LAMPS.len() - 1];
        set.add_spectrum(mercury, SpectrumRole::Light, of_library(mercury));
        let patches = set.add_patches();
        WHITE_LAMPS.iter().for_each(|lamp| set.add_chart(&patches, lamp, CaseGroup::Surfaces));
        LED_MATCHES.iter().for_each(|(light, _)| set.add_chart(&patches, light, CaseGroup::Metamers));
        for FluorescentSample { name, patch, peak_yield, excitation_nm, emission_nm } in FLUORESCENT {
            let names = ["excitation", "emission"].map(|part| format!("{name}/{part}"));
            let (excitation, emission) = (peak(excitation_nm), peak(emission_nm));
            let sum: f64 = whole_nm().map(|nm| emission.continuum_at(nm)).sum();
            set.add_spectrum(&names[0], SpectrumRole::Excitation, excitation.scaled(peak_yield));
            set.add_spectrum(&names[1], SpectrumRole::Emission, emission.scaled(1.0 / sum));
            for lamp in EXCITING_LAMPS {
                set.add_case(&format!("{name}@{lamp}"), CaseGroup::Fluorescent, lamp, Some(patch), Some(names.clone()));
            }
        }
        set
    }

    fn add_spectrum(&mut self, name: &str, role: SpectrumRole, spectrum: Spectrum) {
        self.spectra.push(RegressionSpectrum { name: name.to_string(), role, spectrum });
    }

    fn add_light(&mut self, name: &str, group: CaseGroup, spectrum: Spectrum) {
        self.add_spectrum(name, SpectrumRole::Light, spectrum);
        self.add_case(name, group, name, None, None);
    }

    fn add_patches(&mut self) -> Vec<&'static str> {
        let patches: Vec<&str> = library::names().filter(|name| name.starts_with(CHART)).collect();
        patches.iter().for_each(|name| self.add_spectrum(name, SpectrumRole::Reflectance, of_library(name)));
        patches
    }

    fn add_chart(&mut self, patches: &[&str], lamp: &str, group: CaseGroup) {
        patches.iter().for_each(|patch| self.add_case(&format!("{patch}@{lamp}"), group, lamp, Some(patch), None));
    }

    fn add_case(
        &mut self,
        id: &str,
        group: CaseGroup,
        light: &str,
        reflectance: Option<&str>,
        fluorescence: Option<[String; 2]>,
    ) {
        let mut case = RegressionCase {
            id: id.to_string(),
            group,
            light: light.to_string(),
            reflectance: reflectance.map(str::to_string),
            fluorescence,
            expected: FormColours::default(),
        };
        let colour = |form: &ColourForm| {
            let observer = form.observer();
            let white = report::xyz(self.spectrum(light), observer);
            let unit = |xyz: Xyz| xyz.map(|value| 100.0 * value / white[1]);
            (*form, form.of_xyz(unit(self.xyz(&case, observer)), unit(white)))
        };
        case.expected = self.forms.iter().map(colour).collect();
        self.cases.push(case);
    }

    fn xyz(&self, case: &RegressionCase, observer: &Observer) -> Xyz {
        let light = self.spectrum(&case.light);
        let Some(reflectance) = &case.reflectance else { return report::xyz(light, observer) };
        let reflected = report::xyz_under(self.spectrum(reflectance), light, observer);
        let Some([excitation, emission]) = &case.fluorescence else { return reflected };
        let excitation = self.spectrum(excitation);
        let continuum: f64 = whole_nm().map(|nm| light.continuum_at(nm) * excitation.continuum_at(nm)).sum();
        let lines: f64 =
            light.line_segments().iter().map(|line| line.power * excitation.continuum_at(line.centre())).sum();
        let emitted = report::xyz(self.spectrum(emission), observer);
        [0, 1, 2].map(|i| reflected[i] + (continuum + lines) * emitted[i])
    }
}

/// Returns the wavelengths of the samples in nm.
pub(super) fn whole_nm() -> impl Iterator<Item = f64> {
    (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from)
}

/// Returns a Gaussian peak of height 1 that is linear between whole nm.
fn peak([nm, fwhm_nm]: [f64; 2]) -> Spectrum {
    let peak = Spectrum::gaussian(nm, fwhm_nm).expect("the peaks are valid");
    let nm: Vec<f64> = whole_nm().collect();
    let values: Vec<f64> = nm.iter().map(|&nm| peak.continuum_at(nm)).collect();
    Spectrum::table(&nm, &values, Outside::Zero).expect("the samples are valid")
}

fn led_mix(weights: [f64; 3]) -> Spectrum {
    let [red, green, blue] = ["led/red", "led/green", "led/blue"].map(of_library);
    Spectrum::mix(&[(weights[0], &red), (weights[1], &green), (weights[2], &blue)])
}

fn of_library(name: &str) -> Spectrum {
    library::find(name).expect("the set names spectra of the library").spectrum
}
