//! Two lights compared: by their own colours, and by what they make of the same surfaces.
//!
//! Under each light that light is the white, as for an eye (or a camera) that has adapted to it: L*a*b* are CIELAB's
//! with the light's own XYZ for white and the perfect diffuser at Y = 100. A difference between the lights' own colours
//! thus does not count against the surfaces; it is given by itself, as a [`LightDifference`] at equal luminance.

use super::Xyz;
use super::coordinates::lab;
use super::difference::{LightDifference, delta_e_2000, light_difference};
use super::report::{self, Report};
use crate::error::Result;
use crate::spectrum::library::{self, Kind};
use crate::spectrum::{Observer, Spectrum};

/// Surfaces that differ by at most this ΔE2000 look alike: an eye hardly sees so much.
pub const ALIKE: f64 = 2.0;

/// Surfaces that differ by at least this ΔE2000 look different at a glance.
pub const DIFFERENT: f64 = 5.0;

/// Where the library keeps the chart, and the surfaces among which pairs are sought besides.
const CHART: &str = "colorchecker/";
const FURTHER: [&str; 2] = ["TCS", "leaf/"];

/// Everything by which two lights are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct LampComparison {
    /// The lights' own figures.
    pub reports: [Report; 2],
    /// How far the second light is from the first, both at Y = 1.
    pub lights: LightDifference,
    /// The 24 patches of the ColorChecker, in the chart's order.
    pub patches: Vec<PatchDifference>,
    /// Further surfaces: CIE's test colours and leaves.
    pub further: Vec<PatchDifference>,
    /// The pairs of surfaces, patches or further ones, that one light makes look [`ALIKE`] and the other
    /// [`DIFFERENT`], those that split the most first. They count on from the patches to the further surfaces.
    pub pairs: Vec<SplitPair>,
}

impl LampComparison {
    /// Compares two lights.
    ///
    /// # Errors
    /// A light without power that the observer sees.
    pub fn between(lights: [&Spectrum; 2], observer: &Observer) -> Result<Self> {
        let report =
            |i: usize| Report::of_light(lights[i], observer).map_err(|error| error.on_path(format!("lights[{i}]")));
        let reports = [report(0)?, report(1)?];
        let mut patches = compare_lights(lights, &surfaces(&[CHART]), observer);
        let chart = patches.len();
        patches.extend(compare_lights(lights, &surfaces(&FURTHER), observer));
        let pairs = split_pairs(&patches, ALIKE, DIFFERENT);
        let unit = |report: &Report| report.xyz.map(|value| value / report.xyz[1]);
        let lights = light_difference(unit(&reports[0]), unit(&reports[1]));
        let further = patches.split_off(chart);
        Ok(Self { reports, lights, patches, further, pairs })
    }

    /// The two surfaces of a pair.
    pub fn surfaces_of(&self, pair: &SplitPair) -> [&PatchDifference; 2] {
        pair.patches.map(|i| self.patches.get(i).unwrap_or_else(|| &self.further[i - self.patches.len()]))
    }

    /// Mean ΔE2000 of the patches.
    pub fn mean(&self) -> f64 {
        self.patches.iter().map(|patch| patch.delta_e_2000).sum::<f64>() / self.patches.len() as f64
    }

    /// The patch that differs most.
    pub fn worst(&self) -> &PatchDifference {
        let most = self.patches.iter().max_by(|a, b| a.delta_e_2000.total_cmp(&b.delta_e_2000));
        most.expect("the chart has patches")
    }

    /// How many pairs the surfaces form.
    pub fn pair_count(&self) -> usize {
        let surfaces = self.patches.len() + self.further.len();
        surfaces * surfaces.saturating_sub(1) / 2
    }
}

/// The library's reflectances whose names begin so.
fn surfaces(beginnings: &[&str]) -> Vec<(&'static str, Spectrum)> {
    let wanted = |entry: &&library::Listing| {
        entry.kind == Kind::Reflectance && beginnings.iter().any(|beginning| entry.name.starts_with(beginning))
    };
    let had =
        |entry: &library::Listing| (entry.name, library::find(entry.name).expect("a listed entry can be had").spectrum);
    library::list().iter().filter(wanted).map(had).collect()
}

/// A surface under two lights; each time with that light for white.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchDifference {
    /// The surface's name.
    pub name: String,
    /// XYZ under the first and under the second light; the perfect diffuser has Y = 100.
    pub xyz: [Xyz; 2],
    /// L*, a*, b* under the first and under the second light.
    pub lab: [[f64; 3]; 2],
    /// ΔE2000 between the two.
    pub delta_e_2000: f64,
}

impl PatchDifference {
    /// The name without that of the chart.
    pub fn short_name(&self) -> &str {
        self.name.strip_prefix(CHART).unwrap_or(&self.name)
    }
}

/// What two lights make of each surface, each light being the white of its own column.
pub fn compare_lights(
    lights: [&Spectrum; 2],
    surfaces: &[(&str, Spectrum)],
    observer: &Observer,
) -> Vec<PatchDifference> {
    let whites = lights.map(|light| report::xyz(light, observer));
    let compare = |(name, surface): &(&str, Spectrum)| {
        let xyz: [Xyz; 2] = std::array::from_fn(|i| {
            report::xyz_under(surface, lights[i], observer).map(|value| 100.0 * value / whites[i][1])
        });
        let lab = [0, 1].map(|i| lab(xyz[i], whites[i].map(|value| 100.0 * value / whites[i][1])));
        PatchDifference { name: name.to_string(), xyz, lab, delta_e_2000: delta_e_2000(lab[0], lab[1]) }
    };
    surfaces.iter().map(compare).collect()
}

/// Two surfaces that look alike under one light and different under the other.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitPair {
    /// The surfaces' numbers in the comparison.
    pub patches: [usize; 2],
    /// ΔE2000 between the surfaces under the first and under the second light.
    pub delta_e_2000: [f64; 2],
}

/// The pairs of surfaces whose difference is at most `alike` under one light and at least `different` under the
/// other, those that split the most first.
pub fn split_pairs(patches: &[PatchDifference], alike: f64, different: f64) -> Vec<SplitPair> {
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
    pairs.sort_by(|a, b| split(b).total_cmp(&split(a)));
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::library;

    #[test]
    fn a_light_without_any_blue_shows_surfaces_without_hue() {
        let line = |nm| Spectrum::lines(&[crate::spectrum::SpectralLine { nm, power: 1.0, fwhm_nm: None }]).unwrap();
        let compared = LampComparison::between([&line(680.0), &line(589.0)], Observer::cie1931()).unwrap();
        for patch in &compared.patches {
            assert!(patch.lab.as_flattened().iter().all(|value| value.is_finite()), "{patch:?}");
            assert!(patch.lab[0][2].abs() < 1e-9 && patch.lab[1][2].abs() < 1e-9, "{patch:?}");
        }
    }

    #[test]
    fn sodium_light_splits_what_daylight_tells_apart() {
        let named = |name: &str| library::find(name).unwrap().spectrum;
        let (d65, sodium) = (named("D65"), named("sodium-low-pressure"));
        let compared = LampComparison::between([&d65, &sodium], Observer::cie1931()).unwrap();
        let patches = &compared.patches;
        assert_eq!(patches.len(), 24);
        let neutral = patches.iter().find(|patch| patch.name == "colorchecker/neutral-5").unwrap();
        let red = patches.iter().find(|patch| patch.name == "colorchecker/red").unwrap();
        assert!(neutral.delta_e_2000 < 2.0 && red.delta_e_2000 > 20.0, "{neutral:?} {red:?}");
        assert_eq!((compared.further.len(), compared.pair_count()), (16, 40 * 39 / 2));
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
