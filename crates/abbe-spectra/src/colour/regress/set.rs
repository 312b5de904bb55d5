//! The spectra, the cases and the expected colours of the regression set.

use std::sync::OnceLock;

use crate::colour::report;
use crate::colour::space::{encode_srgb, xyz_to_linear_srgb};
use crate::colour::tristimulus::{Rgb, Xyz};
use crate::spectrum::{Observer, SpectralLine, Spectrum, library};
use serde::Serialize;

/// The name and the version of the set.
pub const REGRESSION_SET: &str = "abbe-regress 1";

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
}

impl CaseGroup {
    /// All groups.
    pub const ALL: [Self; 5] = [Self::Lamps, Self::Lines, Self::Monochromatic, Self::Surfaces, Self::Metamers];

    /// Returns the name of the group.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lamps => "lamps",
            Self::Lines => "lines",
            Self::Monochromatic => "monochromatic",
            Self::Surfaces => "surfaces",
            Self::Metamers => "metamers",
        }
    }
}

/// A spectrum of the set.
#[derive(Debug, Clone, PartialEq)]
pub struct RegressionSpectrum {
    /// The name. It contains no comma and no space.
    pub name: String,
    /// True for a reflectance, and false for a light.
    pub is_reflectance: bool,
    /// The spectrum.
    pub spectrum: Spectrum,
}

/// The colour of a case, in the three forms in which converters return colours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CaseColour {
    /// XYZ. A light and the perfect diffuser have Y = 100.
    pub xyz: Xyz,
    /// Linear sRGB, neither adapted nor clipped. A light and the perfect diffuser have Y = 1.
    pub linear_srgb: Rgb,
    /// The linear components clipped to 0–1 and encoded with the curve of IEC 61966-2-1.
    pub srgb: Rgb,
}

/// A light, or a reflectance under a light, with its colour.
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
    /// The expected colour.
    pub expected: CaseColour,
}

/// The spectra and the cases of the set.
#[derive(Debug)]
pub struct RegressionSet {
    /// The spectra.
    pub spectra: Vec<RegressionSpectrum>,
    /// The cases.
    pub cases: Vec<RegressionCase>,
}

impl RegressionSet {
    /// Returns the set.
    pub fn get() -> &'static Self {
        static SET: OnceLock<RegressionSet> = OnceLock::new();
        SET.get_or_init(Self::build)
    }

    fn spectrum(&self, name: &str) -> &Spectrum {
        let named = self.spectra.iter().find(|entry| entry.name == name);
        &named.expect("a case names a spectrum of the set").spectrum
    }

    fn build() -> Self {
        let mut set = Self { spectra: Vec::new(), cases: Vec::new() };
        let line = |nm: f64| Spectrum::lines(&[SpectralLine { nm, power: 1.0, fwhm_nm: None }]);
        let lines = (42..=68).map(|tens| f64::from(10 * tens));
        LAMPS.iter().for_each(|name| set.add_light(name, CaseGroup::Lamps, of_library(name)));
        LINE_LAMPS.iter().for_each(|name| set.add_light(name, CaseGroup::Lines, of_library(name)));
        for nm in lines {
            let light = line(nm).expect("a line within the band is valid");
            set.add_light(&format!("line/{nm}"), CaseGroup::Monochromatic, light);
        }
        for (name, weights) in LED_MATCHES {
            let [red, green, blue] = ["led/red", "led/green", "led/blue"].map(of_library);
            let mix = Spectrum::mix(&[(weights[0], &red), (weights[1], &green), (weights[2], &blue)]);
            set.add_light(name, CaseGroup::Metamers, mix);
        }
        let patches: Vec<&str> = library::names().filter(|name| name.starts_with(CHART)).collect();
        for name in &patches {
            let spectrum = of_library(name);
            set.spectra.push(RegressionSpectrum { name: (*name).to_string(), is_reflectance: true, spectrum });
        }
        CHART_LAMPS.iter().for_each(|lamp| set.add_chart(&patches, lamp, CaseGroup::Surfaces));
        LED_MATCHES.iter().for_each(|(light, _)| set.add_chart(&patches, light, CaseGroup::Metamers));
        set
    }

    fn add_light(&mut self, name: &str, group: CaseGroup, spectrum: Spectrum) {
        let xyz = report::xyz(&spectrum, Observer::cie1931());
        self.cases.push(RegressionCase {
            id: name.to_string(),
            group,
            light: name.to_string(),
            reflectance: None,
            expected: CaseColour::of_xyz(xyz.map(|value| 100.0 * value / xyz[1])),
        });
        self.spectra.push(RegressionSpectrum { name: name.to_string(), is_reflectance: false, spectrum });
    }

    fn add_chart(&mut self, patches: &[&str], lamp: &str, group: CaseGroup) {
        let (light, observer) = (self.spectrum(lamp), Observer::cie1931());
        let white = report::xyz(light, observer);
        let xyz = |patch: &str| {
            report::xyz_under(self.spectrum(patch), light, observer).map(|value| 100.0 * value / white[1])
        };
        let case = |patch: &&str| RegressionCase {
            id: format!("{patch}@{lamp}"),
            group,
            light: lamp.to_string(),
            reflectance: Some((*patch).to_string()),
            expected: CaseColour::of_xyz(xyz(patch)),
        };
        let cases: Vec<RegressionCase> = patches.iter().map(case).collect();
        self.cases.extend(cases);
    }
}

impl CaseColour {
    /// Returns all forms of a colour, whose Y is relative to 100.
    fn of_xyz(xyz: Xyz) -> Self {
        let linear_srgb = xyz_to_linear_srgb(xyz.map(|value| value / 100.0));
        Self { xyz, linear_srgb, srgb: linear_srgb.map(|component| encode_srgb(component.clamp(0.0, 1.0))) }
    }
}

fn of_library(name: &str) -> Spectrum {
    library::find(name).expect("the set names spectra of the library").spectrum
}
