//! Two lights compared by what they make of the same surfaces.

use super::coordinates::lab;
use super::difference::delta_e_2000;
use super::report;
use crate::spectrum::{Observer, Spectrum};

/// A surface under two lights; each time with that light for white.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchDifference {
    /// The surface's name.
    pub name: String,
    /// XYZ under the first and under the second light; the perfect diffuser has Y = 100.
    pub xyz: [[f64; 3]; 2],
    /// L*, a*, b* under the first and under the second light.
    pub lab: [[f64; 3]; 2],
    /// ΔE2000 between the two.
    pub delta_e_2000: f64,
}

/// What two lights make of each surface, each light being the white of its own column.
pub fn compare_lights(
    lights: [&Spectrum; 2],
    surfaces: &[(&str, &Spectrum)],
    observer: &Observer,
) -> Vec<PatchDifference> {
    let whites = lights.map(|light| report::xyz(light, observer));
    let compare = |&(name, surface): &(&str, &Spectrum)| {
        let xyz: [[f64; 3]; 2] = std::array::from_fn(|i| {
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
    fn sodium_light_splits_what_daylight_tells_apart() {
        let named = |name: &str| library::find(name).unwrap().spectrum;
        let surfaces: Vec<(&str, Spectrum)> =
            library::names().filter(|name| name.starts_with("colorchecker/")).map(|name| (name, named(name))).collect();
        let surfaces: Vec<(&str, &Spectrum)> = surfaces.iter().map(|(name, surface)| (*name, surface)).collect();
        let (d65, sodium) = (named("D65"), named("sodium-low-pressure"));
        let patches = compare_lights([&d65, &sodium], &surfaces, Observer::cie1931());
        assert_eq!(patches.len(), 24);
        let neutral = patches.iter().find(|patch| patch.name == "colorchecker/neutral-5").unwrap();
        let red = patches.iter().find(|patch| patch.name == "colorchecker/red").unwrap();
        assert!(neutral.delta_e_2000 < 2.0 && red.delta_e_2000 > 20.0, "{neutral:?} {red:?}");
        let pairs = split_pairs(&patches, 3.0, 20.0);
        assert!(!pairs.is_empty());
        for pair in &pairs {
            assert!(pair.delta_e_2000[0] >= 20.0 && pair.delta_e_2000[1] <= 3.0, "{pair:?}");
        }
        let split = |pair: &SplitPair| pair.delta_e_2000[0] - pair.delta_e_2000[1];
        assert!(pairs.windows(2).all(|two| split(&two[0]) >= split(&two[1])));
        assert!(split_pairs(&patches, -1.0, 0.0).is_empty());
    }
}
