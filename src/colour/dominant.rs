//! Dominant wavelength and purity.

use super::coordinates::xy;
use crate::spectrum::{BAND_NM, Observer};

/// Colours nearer than this to white, in x, y, have no dominant wavelength.
const NEUTRAL: f64 = 1e-4;

/// The spectral colour that mixes with white to a colour (CIE 15).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dominant {
    /// Its wavelength in nm; for purples that of the complementary colour.
    pub nm: f64,
    /// Whether `nm` is the complementary wavelength, because the colour is a purple.
    pub complementary: bool,
    /// Excitation purity: how far the colour stands from white towards the edge of the chromaticity diagram, 0 to 1.
    pub purity: f64,
}

/// The dominant wavelength of a chromaticity x, y against a white's; none for neutral colours.
pub fn dominant(colour: [f64; 2], white: [f64; 2], observer: &Observer) -> Option<Dominant> {
    let direction = [colour[0] - white[0], colour[1] - white[1]];
    let distance = direction[0].hypot(direction[1]);
    if distance.is_nan() || distance < NEUTRAL {
        return None;
    }
    let locus: Vec<Point> = (BAND_NM.0 as u32..=BAND_NM.1 as u32)
        .map(f64::from)
        .map(|nm| (nm, observer.xyz_bar(nm)))
        .map(|(nm, xyz)| Point { nm, xy: xy(xyz), weight: xyz.iter().sum() })
        .filter(|point| point.weight > 0.0)
        .collect();
    if let Some((distance, nm)) = crossing(&locus, white, direction) {
        return Some(Dominant { nm, complementary: false, purity: distance.recip() });
    }
    let (_, nm) = crossing(&locus, white, direction.map(|component| -component))?;
    let purple = [locus.first()?, locus.last()?];
    let (distance, _) = intersection(purple, white, direction)?;
    Some(Dominant { nm, complementary: true, purity: distance.recip() })
}

/// A spectral colour.
struct Point {
    nm: f64,
    xy: [f64; 2],
    /// x̄ + ȳ + z̄.
    weight: f64,
}

/// Where a ray from white leaves the diagram through the spectral colours: the distance in units of `direction`, and
/// the wavelength. Of several crossings (the locus turns back on itself by rounding at both ends) the farthest.
fn crossing(locus: &[Point], white: [f64; 2], direction: [f64; 2]) -> Option<(f64, f64)> {
    let mut farthest: Option<(f64, f64)> = None;
    for pair in locus.windows(2) {
        if let Some((distance, share)) = intersection([&pair[0], &pair[1]], white, direction)
            && farthest.is_none_or(|(so_far, _)| distance > so_far * (1.0 + 1e-9))
        {
            // Along the chord of two mixed colours the share runs with their weights, not with the wavelength.
            let (from, to) = (pair[0].weight * share, pair[1].weight * (1.0 - share));
            farthest = Some((distance, pair[0].nm + (pair[1].nm - pair[0].nm) * from / (from + to)));
        }
    }
    farthest
}

/// Where a ray meets the chord of two points: the distance in units of `direction`, and the share of the chord.
fn intersection([from, to]: [&Point; 2], white: [f64; 2], direction: [f64; 2]) -> Option<(f64, f64)> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let chord = [to.xy[0] - from.xy[0], to.xy[1] - from.xy[1]];
    let start = [from.xy[0] - white[0], from.xy[1] - white[1]];
    let denominator = cross(direction, chord);
    let (distance, share) = (cross(start, chord) / denominator, cross(start, direction) / denominator);
    // Neighbouring chords overlap by a hair, so that rounding leaves no gap between them.
    let hit = distance > 0.0 && distance.is_finite() && (-1e-9..=1.0 + 1e-9).contains(&share);
    hit.then(|| (distance, share.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const E: [f64; 2] = [1.0 / 3.0; 2];

    #[test]
    fn a_spectral_colour_is_its_own_dominant_wavelength() {
        let observer = Observer::cie1931();
        for nm in [420.0, 450.5, 480.0, 520.3, 550.0, 589.2938, 620.0, 660.7] {
            let found = dominant(xy(observer.xyz_bar(nm)), E, observer).unwrap();
            assert!((found.nm - nm).abs() < 1e-6 && (found.purity - 1.0).abs() < 1e-9, "{nm} {found:?}");
            assert!(!found.complementary);
        }
    }

    #[test]
    fn purples_have_a_complementary_wavelength() {
        let found = dominant([0.35, 0.15], E, Observer::cie1931()).unwrap();
        assert!(found.complementary && (500.0..570.0).contains(&found.nm), "{found:?}");
        assert!(found.purity > 0.0 && found.purity < 1.0);
        assert_eq!(dominant(E, E, Observer::cie1931()), None);
    }
}
