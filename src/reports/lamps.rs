//! Comparisons of two or three lamps, or of a lamp with its best match from primaries.

use abbe_optics::bsdf::Fluorescent;
use abbe_optics::fluorescent_samples;
use abbe_session::output::figures::difference_text;
#[cfg(feature = "pages")]
use abbe_session::output::lamps_page::{LampsPage, NamedLamp, page};
use abbe_spectra::colour::lamps::{
    ALIKE, DIFFERENT, LampComparison, PatchDifference, SplitPair, compare_returned_light,
};
use abbe_spectra::colour::{LightDifference, PrimaryMatch, Xyz, light_difference, match_primaries, report};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Spectrum};
use serde::Serialize;

use super::colour::NamedColour;
use super::named::NamedSpectrum;

#[derive(Debug)]
pub struct LampsCompared {
    pub observer: &'static Observer,
    /// The two lights: A, and either B or the match of A.
    pub lamps: [NamedSpectrum; 2],
    pub comparison: LampComparison,
    /// Fluorescent surfaces under A and B.
    pub fluorescent: Vec<PatchDifference>,
    pub third: Option<(NamedSpectrum, LampComparison)>,
    /// The match of A, if primaries were given.
    pub mix: Option<PrimaryMix>,
}

/// A mix of primaries. Its colour is as close as possible to the colour of a lamp.
#[derive(Debug)]
pub struct PrimaryMix {
    pub primaries: Vec<NamedSpectrum>,
    /// The weights of the primaries, and how well the mix matches.
    pub found: PrimaryMatch,
    /// The difference between the lamp and the mix at equal luminance.
    pub difference: LightDifference,
}

impl LampsCompared {
    /// Compares the lamp A with B, or else with its match from the primaries, and with C. Returns
    /// an error if there is neither B nor a primary, if a lamp has no luminance for the observer,
    /// or if a primary has no colour.
    pub fn of(
        a: NamedSpectrum,
        others: [Option<NamedSpectrum>; 2],
        primaries: Vec<NamedSpectrum>,
        observer: &'static Observer,
    ) -> Result<Self> {
        let mix = if primaries.is_empty() { None } else { Some(PrimaryMix::nearest(&a, primaries, observer)?) };
        let [b, c] = others;
        let b = match (b, &mix) {
            (Some(b), _) => b,
            (None, Some(mix)) => mix.lamp(&a),
            (None, None) => {
                return Err(Error::input("a second lamp is required to compare with A").expected("B or --match"));
            }
        };
        let comparison = LampComparison::between([&a.spectrum, &b.spectrum], observer)?;
        let third = match c {
            None => None,
            Some(c) => {
                let comparison = LampComparison::between([&a.spectrum, &c.spectrum], observer)?;
                Some((c, comparison))
            }
        };
        let surfaces = fluorescent_samples::surfaces()?;
        let returned = |light: &Spectrum| {
            let colours = surfaces.iter().map(|surface| xyz_of_fluorescent(surface, light, observer));
            fluorescent_samples::NAMES.into_iter().zip(colours).collect()
        };
        let fluorescent = compare_returned_light([&a.spectrum, &b.spectrum], returned, observer);
        Ok(Self { observer, lamps: [a, b], comparison, fluorescent, third, mix })
    }

    /// A warning if the mix does not match the lamp.
    pub fn warning(&self) -> Option<String> {
        let mix = self.mix.as_ref().filter(|mix| !mix.found.is_exact())?;
        let left = difference_text(mix.difference);
        Some(format!(
            "{} cannot be matched with {}; the closest mix differs by {left}, luminance {:+.4} %",
            self.lamps[0].name,
            mix.names(),
            100.0 * mix.found.delta_y
        ))
    }

    /// Returns the HTML page of the comparison, or a machine error if the PNG encoder fails.
    #[cfg(feature = "pages")]
    pub fn html(&self) -> Result<String> {
        let Self { observer, lamps, comparison, fluorescent, third: _, mix } = self;
        fn lamp(NamedSpectrum { name, origin, spectrum, .. }: &NamedSpectrum) -> NamedLamp<'_> {
            NamedLamp { name, origin, spectrum }
        }
        let primaries = mix.iter().flat_map(|mix| &mix.primaries).map(lamp).collect();
        let lamps = [lamp(&lamps[0]), lamp(&lamps[1])];
        let warning = self.warning();
        page(&LampsPage { lamps, comparison, fluorescent, observer, primaries, warning: warning.as_deref() })
    }
}

fn xyz_of_fluorescent(surface: &Fluorescent, light: &Spectrum, observer: &Observer) -> Xyz {
    let reflected = report::xyz_under(surface.reflectance(), light, observer);
    let fluorophore = &surface.fluorophore;
    let [_, excitation, _] = report::xyz_under(fluorophore.excitation_spectrum(), light, Observer::radiometric());
    let excitation = excitation + light.ultraviolet_sum(&|nm| fluorophore.excitation_spectrum().at(nm));
    let emitted = report::xyz(fluorophore.emitted_power(), observer);
    std::array::from_fn(|c| reflected[c] + excitation * fluorophore.quantum_yield() * emitted[c])
}

impl PrimaryMix {
    fn nearest(lamp: &NamedSpectrum, primaries: Vec<NamedSpectrum>, observer: &Observer) -> Result<Self> {
        let colours: Vec<[f64; 3]> = primaries.iter().map(|primary| report::xyz(&primary.spectrum, observer)).collect();
        let target = report::xyz(&lamp.spectrum, observer);
        let found = match_primaries(target, &colours)?;
        let unit = |xyz: [f64; 3]| xyz.map(|value| value / xyz[1]);
        let difference = light_difference(unit(target), unit(found.xyz));
        Ok(Self { primaries, found, difference })
    }

    fn lamp(&self, of: &NamedSpectrum) -> NamedSpectrum {
        NamedSpectrum {
            name: format!("its match from {}", self.names()),
            origin: format!("the non-negative mix nearest to {} in XYZ: {}", of.name, self.weights_text()),
            spectrum: self.found.mix(self.primaries.iter().map(|primary| &primary.spectrum)),
            notes: Vec::new(),
        }
    }

    pub fn weights_text(&self) -> String {
        let part = |(primary, weight): (&NamedSpectrum, &f64)| format!("{weight:.6} × {}", primary.name);
        self.primaries.iter().zip(&self.found.weights).map(part).collect::<Vec<String>>().join(" + ")
    }

    fn names(&self) -> String {
        let names: Vec<&str> = self.primaries.iter().map(|primary| primary.name.as_str()).collect();
        match names.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => names.join(""),
        }
    }
}

/// The figures of a comparison.
#[derive(Debug, Serialize)]
pub struct LampsReport<'a> {
    pub a: NamedColour<'a>,
    /// The lamp B, or the match of A.
    pub b: NamedColour<'a>,
    /// The colour difference of the lamps at equal luminance, with the observer adapted to D65.
    pub lights: LightDifference,
    /// The match of A, if primaries were given.
    pub r#match: Option<LampMatch<'a>>,
    pub patches: &'a [PatchDifference],
    pub fluorescent: &'a [PatchDifference],
    /// The mean and the maximum of the colour differences of all patches.
    pub delta_e_2000: DeltaESummary,
    /// Pairs of surfaces that look alike only under one of the lamps.
    pub metameric_pairs: MetamericPairs<'a>,
    /// A sentence that says how different A and B are.
    pub verdict: String,
    pub c: Option<ThirdLamp<'a>>,
    /// A warning if the mix of the primaries does not match A.
    pub warning: Option<String>,
}

/// A third lamp, compared with A. The other fields have the meaning of those of [`LampsReport`].
#[derive(Debug, Serialize)]
pub struct ThirdLamp<'a> {
    #[serde(flatten)]
    pub colour: NamedColour<'a>,
    pub lights: LightDifference,
    pub patches: &'a [PatchDifference],
    pub delta_e_2000: DeltaESummary,
    pub metameric_pairs: MetamericPairs<'a>,
    pub verdict: String,
}

/// A mix of primaries with a colour close to that of a lamp.
#[derive(Debug, Serialize)]
pub struct LampMatch<'a> {
    pub primaries: Vec<&'a str>,
    pub weights: &'a [f64],
    #[serde(flatten)]
    pub left: LightDifference,
    /// The relative error of Y.
    pub delta_y: f64,
    /// True if the mix has the colour of the lamp.
    #[serde(rename = "reached")]
    pub exact: bool,
}

#[derive(Debug, Serialize)]
pub struct DeltaESummary {
    pub mean: f64,
    /// The maximum.
    pub max: f64,
}

impl From<&LampComparison> for DeltaESummary {
    fn from(comparison: &LampComparison) -> Self {
        Self { mean: comparison.mean(), max: comparison.worst().delta_e_2000 }
    }
}

impl<'a> From<&'a LampComparison> for MetamericPairs<'a> {
    fn from(comparison: &'a LampComparison) -> Self {
        let pair = |pair: &SplitPair| MetamericPair {
            names: comparison.surfaces_of(pair).map(|surface| surface.name.as_str()),
            delta_e_2000: pair.delta_e_2000,
        };
        let split = comparison.pairs.iter().map(pair).collect();
        Self { alike: ALIKE, different: DIFFERENT, of: comparison.pair_count(), split }
    }
}

/// Pairs of surfaces that look alike under one lamp and different under the other.
#[derive(Debug, Serialize)]
pub struct MetamericPairs<'a> {
    /// The largest ΔE2000 of two surfaces that look alike.
    pub alike: f64,
    /// The smallest ΔE2000 of two surfaces that look different.
    pub different: f64,
    pub of: usize,
    /// The pairs, from the largest difference on.
    pub split: Vec<MetamericPair<'a>>,
}

/// Two surfaces that are told apart under one lamp only.
#[derive(Debug, Serialize)]
pub struct MetamericPair<'a> {
    pub names: [&'a str; 2],
    /// The difference between the two surfaces: first under A, then under B.
    pub delta_e_2000: [f64; 2],
}

impl<'a> LampsReport<'a> {
    pub fn of(compared: &'a LampsCompared) -> Self {
        let LampsCompared { observer, lamps, comparison, fluorescent, third, mix } = compared;
        let colour = |i: usize| NamedColour::new(&lamps[i].name, &comparison.reports[i], observer, None);
        let r#match = mix.as_ref().map(|PrimaryMix { primaries, found, difference: _ }| LampMatch {
            primaries: primaries.iter().map(|primary| primary.name.as_str()).collect(),
            weights: &found.weights,
            left: found.residual,
            delta_y: found.delta_y,
            exact: found.is_exact(),
        });
        let third = third.as_ref().map(|(c, with_c)| ThirdLamp {
            colour: NamedColour::new(&c.name, &with_c.reports[1], observer, None),
            lights: with_c.lights,
            patches: &with_c.patches,
            delta_e_2000: with_c.into(),
            metameric_pairs: with_c.into(),
            verdict: with_c.verdict([&lamps[0].name, &c.name]),
        });
        Self {
            a: colour(0),
            b: colour(1),
            lights: comparison.lights,
            r#match,
            patches: &comparison.patches,
            fluorescent,
            delta_e_2000: comparison.into(),
            metameric_pairs: comparison.into(),
            verdict: comparison.verdict([&lamps[0].name, &lamps[1].name]),
            c: third,
            warning: compared.warning(),
        }
    }
}
