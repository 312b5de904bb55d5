//! Dominant wavelength and excitation purity.

use super::coordinates::xy;
use crate::math::elementary::hypot;
use crate::spectrum::{BAND_NM, Observer};

/// The least distance from white, in the x, y plane, of a colour with a dominant wavelength.
const NEUTRAL: f64 = 1e-4;

/// The wavelength whose spectral colour, mixed with white, matches the colour (CIE 15).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DominantWavelength {
    /// The wavelength in nm, or for purples that of the complementary colour.
    pub nm: f64,
    /// True for purples, whose `nm` is the complementary wavelength.
    pub complementary: bool,
    /// Excitation purity from 0 to 1: the distance from white to the colour, relative to the
    /// distance to the diagram's boundary in the same direction.
    pub purity: f64,
}

/// Returns the dominant wavelength of x, y relative to white, or `None` for neutral colours.
pub fn dominant(colour: [f64; 2], white: [f64; 2], observer: &Observer) -> Option<DominantWavelength> {
    let direction = [colour[0] - white[0], colour[1] - white[1]];
    let distance = hypot(direction[0], direction[1]);
    if distance.is_nan() || distance < NEUTRAL {
        return None;
    }
    let locus: Vec<LocusPoint> = (BAND_NM.0 as u32..=BAND_NM.1 as u32)
        .map(f64::from)
        .map(|nm| (nm, observer.xyz_bar(nm)))
        .map(|(nm, xyz)| LocusPoint { nm, xy: xy(xyz), weight: xyz.iter().sum() })
        .filter(|point| point.weight > 0.0)
        .collect();
    if let Some((distance, nm)) = crossing(&locus, white, direction) {
        return Some(DominantWavelength { nm, complementary: false, purity: distance.recip() });
    }
    let (_, nm) = crossing(&locus, white, direction.map(|component| -component))?;
    let purple = [locus.first()?, locus.last()?];
    let (distance, _) = intersection(purple, white, direction)?;
    Some(DominantWavelength { nm, complementary: true, purity: distance.recip() })
}

struct LocusPoint {
    nm: f64,
    xy: [f64; 2],
    /// x̄ + ȳ + z̄.
    weight: f64,
}

/// Intersects a ray from white with the spectral locus, and returns the distance in units of the
/// length of `direction`, and the wavelength. The farthest intersection counts, because rounded
/// tables of colour-matching functions make the locus turn back on itself at both ends.
fn crossing(locus: &[LocusPoint], white: [f64; 2], direction: [f64; 2]) -> Option<(f64, f64)> {
    let mut farthest: Option<(f64, f64)> = None;
    for pair in locus.windows(2) {
        if let Some((distance, fraction)) = intersection([&pair[0], &pair[1]], white, direction)
            && farthest.is_none_or(|(so_far, _)| distance > so_far * (1.0 + 1e-9))
        {
            // The wavelength is not linear in the position `fraction` on the chord, which depends
            // on the weights of the two spectral colours in a mixture.
            let (from, to) = (pair[0].weight * fraction, pair[1].weight * (1.0 - fraction));
            farthest = Some((distance, pair[0].nm + (pair[1].nm - pair[0].nm) * from / (from + to)));
        }
    }
    farthest
}

/// Intersects a ray with the chord between two points. Returns the distance in units of the length
/// of `direction`, and the position on the chord from 0 to 1.
fn intersection([from, to]: [&LocusPoint; 2], white: [f64; 2], direction: [f64; 2]) -> Option<(f64, f64)> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let chord = [to.xy[0] - from.xy[0], to.xy[1] - from.xy[1]];
    let start = [from.xy[0] - white[0], from.xy[1] - white[1]];
    let denominator = cross(direction, chord);
    let (distance, fraction) = (cross(start, chord) / denominator, cross(start, direction) / denominator);
    // Adjacent chords overlap slightly, so that rounding leaves no gap between them.
    let hit = distance > 0.0 && distance.is_finite() && (-1e-9..=1.0 + 1e-9).contains(&fraction);
    hit.then(|| (distance, fraction.clamp(0.0, 1.0)))
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
