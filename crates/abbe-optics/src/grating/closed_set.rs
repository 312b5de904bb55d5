//! The closed set of directions among which a grating scatters light, and efficiencies that lose
//! no power and are reciprocal.
//!
//! The orders of a direction lead to directions whose orders lead to the same directions. With the
//! directions of such a set numbered by their component across the grooves, scalar theory gives the
//! efficiency e(j − i) from direction i to direction j, but leaves a part of the power in orders
//! that are evanescent. Scaling the orders of each direction to a sum of 1 repairs only that: the
//! efficiencies of light that is sent back would differ, and in uniform surroundings the grating
//! would look brighter than the surroundings, which no passive surface does. The matrix of
//! efficiencies must have the sum 1 in its rows and in its columns.
//!
//! Sinkhorn's alternate scaling of rows and columns converges slowly for a blazed grating, whose
//! matrix is nearly a permutation. This module scales once, each element by the smaller of the two
//! factors, and divides the rest of the power among the directions in proportion to what their rows
//! and columns lack. Both steps keep the symmetry of the matrix under reversal of the light, so the
//! result is reciprocal.

/// The largest number of directions in a set. In larger sets, evanescent orders have little power.
const MOST: usize = 64;

/// The efficiencies between the directions of one set, from one of them.
pub(super) struct ClosedSet {
    count: usize,
    /// The number of the direction of the light.
    from: usize,
    /// The scalar efficiency of each order from 1 − count on.
    scalar: [f64; 2 * MOST - 1],
    /// The sum of the scalar efficiencies from each direction. The sum into direction j is that
    /// from direction count − 1 − j.
    sums: [f64; MOST],
    /// What the row of each direction lacks after the scaling. The column of direction j lacks what
    /// the row of direction count − 1 − j lacks.
    missing: [f64; MOST],
    missing_sum: f64,
}

impl ClosedSet {
    /// Takes the number of directions, the number of the light's direction, and the scalar
    /// efficiency of an order. Returns `None` for a large set.
    pub(super) fn new(count: usize, from: usize, scalar: impl Fn(i32) -> f64) -> Option<Self> {
        if count > MOST || from >= count {
            return None;
        }
        let (scalar_of, mut scalar, mut sums) = (scalar, [0.0; 2 * MOST - 1], [0.0; MOST]);
        for (i, value) in scalar.iter_mut().enumerate().take(2 * count - 1) {
            *value = scalar_of(i as i32 + 1 - count as i32);
        }
        for i in 0..count {
            sums[i] = scalar[count - 1 - i..2 * count - 1 - i].iter().sum();
        }
        let mut set = Self { count, from, scalar, sums, missing: [0.0; MOST], missing_sum: 0.0 };
        for i in 0..count {
            let found: f64 = (0..count).map(|j| set.scaled_once(i, j)).sum();
            set.missing[i] = (1.0 - found).max(0.0);
        }
        set.missing_sum = set.missing[..count].iter().sum();
        Some(set)
    }

    fn scaled_once(&self, i: usize, j: usize) -> f64 {
        let largest = self.sums[i].max(self.sums[self.count - 1 - j]);
        if largest > 0.0 { self.scalar[self.count - 1 + j - i] / largest } else { 0.0 }
    }

    /// Returns the efficiency from the light's direction to direction `to`, 0 outside of the set.
    pub(super) fn efficiency(&self, to: i32) -> f64 {
        let Some(to) = usize::try_from(to).ok().filter(|&to| to < self.count) else { return 0.0 };
        let rest = self.missing[self.from] * self.missing[self.count - 1 - to];
        let rest = if self.missing_sum > 0.0 { rest / self.missing_sum } else { 0.0 };
        self.scaled_once(self.from, to) + rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grating::GratingProfile;

    fn matrix(count: usize, scalar: impl Fn(i32) -> f64) -> Vec<Vec<f64>> {
        let row = |from| {
            let set = ClosedSet::new(count, from, &scalar).expect("a small set");
            (0..count as i32).map(|to| set.efficiency(to)).collect()
        };
        (0..count).map(row).collect()
    }

    #[test]
    fn rows_and_columns_have_the_sum_1_and_reversal_is_symmetric() {
        let profiles = [
            GratingProfile::Blazed { order: 1, blaze_nm: 550.0 },
            GratingProfile::Blazed { order: -2, blaze_nm: 500.0 },
            GratingProfile::Sinusoidal { amplitude_rad: 1.2, at_nm: 550.0 },
            GratingProfile::BinaryPhase { phase_rad: 3.0, at_nm: 550.0, duty: 0.4 },
        ];
        for (profile, nm) in profiles.iter().flat_map(|profile| [(profile, 430.0), (profile, 550.0), (profile, 700.0)])
        {
            for count in [1, 2, 3, 5, 12, 40] {
                let matrix = matrix(count, |order| profile.efficiency(order, nm));
                for (i, row) in matrix.iter().enumerate() {
                    let sum: f64 = row.iter().sum();
                    let column: f64 = matrix.iter().map(|row| row[i]).sum();
                    assert!((sum - 1.0).abs() < 1e-12, "{profile:?}, {nm} nm, {count}: row {sum}");
                    assert!((column - 1.0).abs() < 1e-12, "{profile:?}, {nm} nm, {count}: column {column}");
                    for (j, forward) in row.iter().enumerate() {
                        // Light back along −j has the numbers in reverse order and negative orders.
                        let back = ClosedSet::new(count, count - 1 - j, |order| profile.efficiency(order, nm));
                        let back = back.expect("a small set").efficiency((count - 1 - i) as i32);
                        assert!((forward - back).abs() < 1e-12, "{profile:?}, {nm} nm, {count}");
                    }
                }
            }
        }
    }

    /// A grating with two directions is reciprocal only if both orders that exchange them are
    /// equal, although scalar theory gives one of them nearly all the power and the other none.
    #[test]
    fn two_directions_exchange_equal_powers() {
        let blazed = GratingProfile::Blazed { order: 1, blaze_nm: 550.0 };
        let matrix = matrix(2, |order| blazed.efficiency(order, 552.0));
        assert!((matrix[0][1] - matrix[1][0]).abs() < 1e-12 && matrix[0][1] > 0.95, "{matrix:?}");
    }
}
