//! Comparison of two lights by their colours, and by the colours of surfaces under both.
//!
//! The observer or camera is assumed to be adapted to each light, so the light is the white point
//! of the CIELAB values of all surfaces under it, and a difference between the colours of the
//! lights does not count as a difference of the surfaces. It is reported separately, as a
//! [`LightDifference`] at equal luminance. The perfect diffuser has Y = 100.

use super::coordinates::lab;
use super::difference::{LightDifference, delta_e_2000, light_difference};
use super::report::{self, ColourReport};
use super::tristimulus::Xyz;
use crate::error::Result;
use crate::math::sort::sort_by_number;
use crate::spectrum::library::{self, SpectrumKind};
use crate::spectrum::{Observer, Spectrum};

/// The largest ΔE2000 of surfaces that look alike; it is hardly visible.
pub const ALIKE: f64 = 2.0;

/// The least ΔE2000 of surfaces that look clearly different.
pub const DIFFERENT: f64 = 5.0;

const CHART: &str = "colorchecker/";
const FURTHER: [&str; 2] = ["TCS", "leaf/"];

/// The results of the comparison of two lights.
#[derive(Debug, Clone, PartialEq)]
pub struct LampComparison {
    /// The colour values of the two lights.
    pub reports: [ColourReport; 2],
    /// The colour difference between the lights at the same luminance Y = 1.
    pub lights: LightDifference,
    /// The 24 patches of the ColorChecker, in the order of the chart.
    pub patches: Vec<PatchDifference>,
    /// Further surfaces: the CIE test colours and leaves.
    pub further: Vec<PatchDifference>,
    /// The pairs of surfaces that look alike under one light and different under the other (see
    /// [`ALIKE`] and [`DIFFERENT`]), by decreasing difference between their two ΔE2000 values. A
    /// pair contains indices of the elements of `patches`, followed by those of `further`.
    pub pairs: Vec<SplitPair>,
}

impl LampComparison {
    /// Compares two lights. Returns an error if a light has no luminance for the observer.
    pub fn between(lights: [&Spectrum; 2], observer: &Observer) -> Result<Self> {
        let report = |i: usize| {
            ColourReport::of_light(lights[i], observer).map_err(|error| error.on_path(format!("lights[{i}]")))
        };
        let reports = [report(0)?, report(1)?];
        let mut patches = compare_lights(lights, &surfaces(&[CHART]), observer);
        let chart = patches.len();
        patches.extend(compare_lights(lights, &surfaces(&FURTHER), observer));
        let pairs = split_pairs(&patches, ALIKE, DIFFERENT);
        let unit = |report: &ColourReport| report.xyz.map(|value| value / report.xyz[1]);
        let lights = light_difference(unit(&reports[0]), unit(&reports[1]));
        let further = patches.split_off(chart);
        Ok(Self { reports, lights, patches, further, pairs })
    }

    /// Returns the two surfaces of a pair.
    pub fn surfaces_of(&self, pair: &SplitPair) -> [&PatchDifference; 2] {
        pair.patches.map(|i| self.patches.get(i).unwrap_or_else(|| &self.further[i - self.patches.len()]))
    }

    /// Returns the mean ΔE2000 of the patches.
    pub fn mean(&self) -> f64 {
        self.patches.iter().map(|patch| patch.delta_e_2000).sum::<f64>() / self.patches.len() as f64
    }

    /// Returns the patch with the largest ΔE2000.
    pub fn worst(&self) -> &PatchDifference {
        let most = self.patches.iter().max_by(|a, b| a.delta_e_2000.total_cmp(&b.delta_e_2000));
        most.expect("the chart has patches")
    }

    /// Returns a sentence that says how different the lights of these names are: their colours, the
    /// colours of surfaces, and the pairs of surfaces that split.
    pub fn verdict(&self, names: [&str; 2]) -> String {
        let lights = match self.lights.delta_e_2000 {
            ..=ALIKE => "have the same colour",
            ALIKE..DIFFERENT => "differ slightly in colour",
            _ => "differ clearly in colour",
        };
        let worst = self.worst();
        let surfaces = match worst.delta_e_2000 {
            ..=ALIKE => "all surfaces look the same",
            ALIKE..DIFFERENT => "surfaces look slightly different",
            _ => "surfaces look clearly different",
        };
        let pairs = match self.pairs.len() {
            0 => "no pair of surfaces matches under only one of them".to_string(),
            1 => "1 pair of surfaces matches under only one of them".to_string(),
            count => format!("{count} pairs of surfaces match under only one of them"),
        };
        let [a, b] = names;
        let (most, patch) = (worst.delta_e_2000, worst.short_name());
        format!("{a} and {b} {lights}; {surfaces} (ΔE2000 up to {most:.1}, {patch}); {pairs}.")
    }

    /// Returns the number of all pairs of surfaces.
    pub fn pair_count(&self) -> usize {
        let surfaces = self.patches.len() + self.further.len();
        surfaces * surfaces.saturating_sub(1) / 2
    }
}

/// Returns the library's reflectances whose names begin with one of `beginnings`.
fn surfaces(beginnings: &[&str]) -> Vec<(&'static str, Spectrum)> {
    let wanted = |entry: &&library::LibraryListing| {
        entry.kind == SpectrumKind::Reflectance && beginnings.iter().any(|beginning| entry.name.starts_with(beginning))
    };
    let had = |entry: &library::LibraryListing| {
        (entry.name, library::find(entry.name).expect("a listed entry can be had").spectrum)
    };
    library::list().iter().filter(wanted).map(had).collect()
}

/// A surface under two lights, each of which is its own white point.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct PatchDifference {
    /// The name of the surface.
    pub name: String,
    /// ΔE2000 between the colour of the surface under the first light and its colour under the
    /// second light.
    pub delta_e_2000: f64,
    /// XYZ under the first and under the second light. The perfect diffuser has Y = 100.
    pub xyz: [Xyz; 2],
    /// L*, a*, b* under the first and under the second light.
    pub lab: [[f64; 3]; 2],
}

impl PatchDifference {
    /// Compares the light `xyz` from a surface, on the scale of the light `whites` of a perfect
    /// diffuser.
    fn between(name: &str, xyz: [Xyz; 2], whites: [Xyz; 2]) -> Self {
        let scaled = |values: [Xyz; 2]| [0, 1].map(|i| values[i].map(|value| 100.0 * value / whites[i][1]));
        let (xyz, whites) = (scaled(xyz), scaled(whites));
        let lab = [0, 1].map(|i| lab(xyz[i], whites[i]));
        Self { name: name.to_string(), xyz, lab, delta_e_2000: delta_e_2000(lab[0], lab[1]) }
    }

    /// Returns the name of the surface without the prefix `colorchecker/`.
    pub fn short_name(&self) -> &str {
        self.name.strip_prefix(CHART).unwrap_or(&self.name)
    }
}

/// Computes the colours of each surface under two lights, each of which is its own white point.
pub fn compare_lights(
    lights: [&Spectrum; 2],
    surfaces: &[(&str, Spectrum)],
    observer: &Observer,
) -> Vec<PatchDifference> {
    let whites = lights.map(|light| report::xyz(light, observer));
    let compare = |(name, surface): &(&str, Spectrum)| {
        let xyz = lights.map(|light| report::xyz_under(surface, light, observer));
        PatchDifference::between(name, xyz, whites)
    };
    surfaces.iter().map(compare).collect()
}

/// Compares surfaces that change wavelengths. `returned` takes a light, and returns the names of
/// the surfaces with the XYZ of the light from each, on the scale of the light.
pub fn compare_returned_light(
    lights: [&Spectrum; 2],
    returned: impl Fn(&Spectrum) -> Vec<(&'static str, Xyz)>,
    observer: &Observer,
) -> Vec<PatchDifference> {
    let whites = lights.map(|light| report::xyz(light, observer));
    let [a, b] = lights.map(returned);
    a.iter().zip(&b).map(|((name, a), (_, b))| PatchDifference::between(name, [*a, *b], whites)).collect()
}

/// Two surfaces that look alike under one light and different under the other.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitPair {
    /// The indices of the surfaces in the comparison.
    pub patches: [usize; 2],
    /// ΔE2000 between the surfaces under the first and under the second light.
    pub delta_e_2000: [f64; 2],
}

/// Returns all pairs of surfaces whose ΔE2000 is at most `alike` under one light and at least
/// `different` under the other, by decreasing difference between their two ΔE2000 values.
fn split_pairs(patches: &[PatchDifference], alike: f64, different: f64) -> Vec<SplitPair> {
    let mut pairs = Vec::new();
    for i in 0..patches.len() {
        for j in 0..i {
            let delta = [0, 1].map(|light| delta_e_2000(patches[j].lab[light], patches[i].lab[light]));
            if delta[0].min(delta[1]) <= alike && delta[0].max(delta[1]) >= different {
                pairs.push(SplitPair { patches: [j, i], delta_e_2000: delta });
            }
        }
    }
    let split = |pair: &SplitPair| (pair.delta_e_2000[0] - pair.delta_e_2000[1]).abs();
    sort_by_number(&mut pairs, |pair| -split(pair));
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::library;

    #[test]
    fn surfaces_have_no_hue_under_one_line() {
        let line = |nm| Spectrum::lines(&[crate::spectrum::SpectralLine { nm, power: 1.0, fwhm_nm: None }]).unwrap();
        let compared = LampComparison::between([&line(680.0), &line(589.0)], Observer::cie1931()).unwrap();
        for patch in &compared.patches {
            assert!(patch.lab.as_flattened().iter().all(|value| value.is_finite()), "{patch:?}");
            assert!(patch.lab[0][2].abs() < 1e-9 && patch.lab[1][2].abs() < 1e-9, "{patch:?}");
        }
    }

    #[test]
    fn sodium_light_hides_differences_that_daylight_shows() {
        let named = |name: &str| library::find(name).unwrap().spectrum;
        let (d65, sodium) = (named("D65"), named("sodium-low-pressure"));
        let compared = LampComparison::between([&d65, &sodium], Observer::cie1931()).unwrap();
        let patches = &compared.patches;
        assert_eq!(patches.len(), 24);
        let neutral = patches.iter().find(|patch| patch.name == "colorchecker/neutral-5").unwrap();
        let red = patches.iter().find(|patch| patch.name == "colorchecker/red").unwrap();
        assert!(neutral.delta_e_2000 < 2.0 && red.delta_e_2000 > 20.0, "{neutral:?} {red:?}");
        assert_eq!((compared.further.len(), compared.pair_count()), (16, 40 * 39 / 2));
        let verdict = compared.verdict(["D65", "sodium"]);
        assert!(
            verdict.starts_with("D65 and sodium differ clearly in colour; surfaces look clearly different"),
            "{verdict}"
        );
        assert!(
            verdict.ends_with(&format!("; {} pairs of surfaces match under only one of them.", compared.pairs.len()))
        );
        let same = LampComparison::between([&d65, &d65], Observer::cie1931()).unwrap().verdict(["A", "B"]);
        assert!(
            same.starts_with("A and B have the same colour; all surfaces look the same (ΔE2000 up to 0.0"),
            "{same}"
        );
        assert!(compared.pairs.iter().any(|pair| pair.patches[1] >= 24));
        for pair in &compared.pairs {
            let labs = compared.surfaces_of(pair).map(|surface| surface.lab);
            let delta = [0, 1].map(|light| delta_e_2000(labs[0][light], labs[1][light]));
            assert!(delta == pair.delta_e_2000 && delta[1] <= ALIKE && delta[0] >= DIFFERENT, "{pair:?}");
        }
        let pairs = split_pairs(patches, 3.0, 20.0);
        assert!(!pairs.is_empty());
        for pair in &pairs {
            assert!(pair.delta_e_2000[0] >= 20.0 && pair.delta_e_2000[1] <= 3.0, "{pair:?}");
        }
        let split = |pair: &SplitPair| pair.delta_e_2000[0] - pair.delta_e_2000[1];
        assert!(pairs.windows(2).all(|two| split(&two[0]) >= split(&two[1])));
        assert!(split_pairs(patches, -1.0, 0.0).is_empty());
    }
}
