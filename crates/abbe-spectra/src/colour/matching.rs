//! Colour matching: the mix of primaries that is closest to a target colour.

use super::difference::{LightDifference, light_difference};
use super::matrix::{Matrix3, dot};
use super::tristimulus::Xyz;
use crate::error::{Error, Result};
use crate::spectrum::Spectrum;

/// The distance in the x, y plane and the relative error of Y below which a mix matches the target.
const MATCH_TOLERANCE: f64 = 1e-4;

/// A mix of primaries with non-negative weights, and its distance from the target.
#[derive(Debug, Clone, PartialEq)]
pub struct PrimaryMatch {
    /// The factor of each primary, of which at most three are above 0.
    pub weights: Vec<f64>,
    /// XYZ of the mix, on the same scale as the target.
    pub xyz: Xyz,
    /// The remaining difference between the target and the mix, whose luminances may differ.
    pub residual: LightDifference,
    /// The relative error of Y.
    pub delta_y: f64,
}

impl PrimaryMatch {
    /// Returns true if the mix matches the target.
    pub fn is_exact(&self) -> bool {
        self.residual.delta_xy < MATCH_TOLERANCE && self.delta_y.abs() < MATCH_TOLERANCE
    }

    /// Mixes the spectra of the primaries with the weights of the match.
    pub fn mix<'a>(&self, primaries: impl IntoIterator<Item = &'a Spectrum>) -> Spectrum {
        Spectrum::mix(&self.weights.iter().copied().zip(primaries).collect::<Vec<_>>())
    }
}

/// Finds the non-negative weights of the primaries with the least squared distance in XYZ between
/// the mix and a target. Returns an error if there are no primaries, a primary has no colour, or
/// the target has no luminance.
///
/// An optimal mix needs at most three primaries, because there are three equations (Carathéodory's
/// theorem), so the best solution of all sets of at most three is returned.
pub fn match_primaries(target: Xyz, primaries: &[Xyz]) -> Result<PrimaryMatch> {
    if !(target.iter().all(|value| value.is_finite()) && target[1] > 0.0) {
        return Err(Error::input("a match target without luminance").expected("a light with luminance"));
    }
    if primaries.is_empty() {
        return Err(Error::input("a match without primaries").expected("at least one primary"));
    }
    if let Some(i) = primaries.iter().position(|xyz| !(dot(*xyz, *xyz) > 0.0 && dot(*xyz, *xyz).is_finite())) {
        return Err(Error::input("a primary without colour").on_path(format!("primaries[{i}]")));
    }
    // Unit vectors make the search independent of the scales of the primaries.
    let scales: Vec<f64> = primaries.iter().map(|xyz| dot(*xyz, *xyz).sqrt()).collect();
    let units: Vec<Xyz> = primaries.iter().zip(&scales).map(|(xyz, scale)| xyz.map(|value| value / scale)).collect();
    let wanted = target.map(|value| value / target[1]);
    let best = best_mix(wanted, &units);
    let mut weights = vec![0.0; primaries.len()];
    best.iter().for_each(|&(i, weight)| weights[i] += weight * target[1] / scales[i]);
    let mut mixed = [0.0; 3];
    for (weight, xyz) in weights.iter().zip(primaries) {
        mixed.iter_mut().zip(xyz).for_each(|(sum, value)| *sum += weight * value);
    }
    Ok(PrimaryMatch {
        xyz: mixed,
        residual: light_difference(target, mixed),
        delta_y: mixed[1] / target[1] - 1.0,
        weights,
    })
}

/// Returns the best mix of at most three primaries, as pairs of index and weight.
fn best_mix(target: Xyz, units: &[Xyz]) -> Vec<(usize, f64)> {
    let mut best = (dot(target, target), Vec::new());
    let mut offer = |set: &[usize]| {
        let Some(weights) = least_squares(target, set, units) else { return };
        let mut left = target;
        for (&i, weight) in set.iter().zip(&weights) {
            left.iter_mut().zip(units[i]).for_each(|(left, value)| *left -= weight * value);
        }
        // A larger set is accepted only if it reduces the error by more than the rounding error.
        if dot(left, left) < best.0 - 1e-20 {
            best = (dot(left, left), set.iter().copied().zip(weights).collect());
        }
    };
    for i in 0..units.len() {
        offer(&[i]);
        for j in 0..i {
            offer(&[i, j]);
            for k in 0..j {
                offer(&[i, j, k]);
            }
        }
    }
    best.1
}

/// Solves the unconstrained least-squares problem for one to three primaries. Returns `None` if a
/// weight is negative or the primaries are linearly dependent.
fn least_squares(target: Xyz, set: &[usize], units: &[Xyz]) -> Option<Vec<f64>> {
    // Orthogonalises by modified Gram–Schmidt, then substitutes backwards.
    let mut directions: Vec<Xyz> = Vec::with_capacity(3);
    let mut triangle: Matrix3 = [[0.0; 3]; 3];
    for (column, &i) in set.iter().enumerate() {
        let mut rest = units[i];
        for (row, direction) in directions.iter().enumerate() {
            let along = dot(*direction, rest);
            triangle[row][column] = along;
            rest.iter_mut().zip(direction).for_each(|(rest, part)| *rest -= along * part);
        }
        let length = dot(rest, rest).sqrt();
        if length < 1e-9 {
            return None;
        }
        triangle[column][column] = length;
        directions.push(rest.map(|value| value / length));
    }
    let mut weights = vec![0.0; set.len()];
    for row in (0..set.len()).rev() {
        let known: f64 = (row + 1..set.len()).map(|column| triangle[row][column] * weights[column]).sum();
        weights[row] = (dot(directions[row], target) - known) / triangle[row][row];
    }
    weights.iter().all(|weight| *weight >= 0.0).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_a_mix_are_recovered() {
        let primaries = [[41.0, 21.0, 2.0], [0.35, 0.71, 0.12], [18.0, 7.0, 95.0], [1.0, 1.0, 1.0]];
        let target = [0, 1, 2].map(|i| 0.3 * primaries[0][i] + 25.0 * primaries[1][i] + 0.1 * primaries[2][i]);
        let found = match_primaries(target, &primaries[..3]).unwrap();
        assert!(found.is_exact() && found.residual.delta_e_2000 < 1e-6, "{found:?}");
        for (weight, known) in found.weights.iter().zip([0.3, 25.0, 0.1]) {
            assert!((weight / known - 1.0).abs() < 1e-9, "{found:?}");
        }
        assert!(match_primaries(target, &primaries).unwrap().is_exact());
    }

    #[test]
    fn a_target_out_of_reach_gets_the_nearest_mix() {
        let found = match_primaries([0.1, 1.0, 0.1], &[[1.0, 1.0, 1.0], [1.0, 0.5, 0.1]]).unwrap();
        assert!(!found.is_exact());
        assert!(found.weights.iter().all(|weight| *weight >= 0.0));
        // The squared error must not decrease in any allowed direction.
        let left = [0, 1, 2].map(|i| found.xyz[i] - [0.1, 1.0, 0.1][i]);
        assert!(dot(left, [1.0, 1.0, 1.0]).abs() < 1e-12 || found.weights[0] == 0.0);
    }

    #[test]
    fn targets_and_primaries_without_colour_are_errors() {
        assert!(match_primaries([0.0; 3], &[[1.0; 3]]).is_err());
        assert!(match_primaries([1.0; 3], &[]).is_err());
        assert!(match_primaries([1.0; 3], &[[1.0; 3], [0.0; 3]]).unwrap_err().to_string().contains("primaries[1]"));
    }
}
