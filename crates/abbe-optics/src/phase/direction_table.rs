//! A pdf of directions, tabulated for light of one elevation and a few wavelengths.
//!
//! The coordinates are the azimuth φ from the light's direction of travel, in [0, π], and the sine
//! z of the elevation, so that dφ dz is the solid angle. The pdf is symmetric about φ = 0, and
//! bilinear in φ and z between nodes that are evenly spaced in φ and in the elevation.

use abbe_spectra::math::elementary::{asin, sin};
use abbe_spectra::math::random::ONE_MINUS_ULP;
use std::f64::consts::PI;

/// Half-heights of the windows of [`smoothed`], in nodes. In azimuth they are wider, because
/// crystals with a level axis make features along horizontal circles.
const WINDOWS: [usize; 8] = [0, 1, 2, 3, 4, 6, 8, 12];
const WIDTH_TO_HEIGHT: usize = 4;

/// Standard deviations by which the means of two windows may differ.
const NOISE: f64 = 4.0;

/// Sums over windows are differences, whose rounding errors are below this fraction of the whole.
const ROUNDING: f64 = 1e-11;

/// The nodes of a table and their solid angles.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DirectionGrid {
    /// Steps from φ = 0 to π, and from the elevation −90° to 90°.
    steps: usize,
    /// The sines of the elevations, ascending.
    sines: Vec<f64>,
    /// The width of each row's hat function in z.
    heights: Vec<f64>,
}

impl DirectionGrid {
    pub(super) fn new(steps: usize) -> Self {
        let sine = |row: usize| sin(PI * (row as f64 / steps as f64 - 0.5));
        let sines: Vec<f64> = (0..=steps).map(sine).collect();
        let height = |row: usize| 0.5 * (sines[(row + 1).min(steps)] - sines[row.saturating_sub(1)]);
        Self { steps, heights: (0..=steps).map(height).collect(), sines }
    }

    /// The number of nodes in a row, and of rows.
    fn side(&self) -> usize {
        self.steps + 1
    }

    pub(super) fn nodes(&self) -> usize {
        self.side() * self.side()
    }

    /// Returns the node nearest to an azimuth in rad and to the sine of an elevation.
    pub(super) fn nearest(&self, phi: f64, z: f64) -> usize {
        let steps = self.steps as f64;
        let row = ((asin(z) / PI + 0.5) * steps + 0.5) as usize;
        let column = (phi / PI * steps + 0.5) as usize;
        row.min(self.steps) * self.side() + column.min(self.steps)
    }

    /// The width of a column's hat function in rad.
    fn width(&self, column: usize) -> f64 {
        let whole = PI / self.steps as f64;
        if column == 0 || column == self.steps { 0.5 * whole } else { whole }
    }

    /// Returns the row and the column below a place, and the fractions of the steps above them.
    fn place(&self, phi: f64, z: f64) -> Place {
        let (steps, last) = (self.steps as f64, self.steps - 1);
        let mut row = (((asin(z) / PI + 0.5) * steps).max(0.0) as usize).min(last);
        // The rounding of the arc sine may miss the row by one.
        if row > 0 && self.sines[row] > z {
            row -= 1;
        } else if row < last && self.sines[row + 1] < z {
            row += 1;
        }
        let t = ((z - self.sines[row]) / (self.sines[row + 1] - self.sines[row])).clamp(0.0, 1.0);
        let across = phi / PI * steps;
        let column = (across as usize).min(last);
        Place { row, column, t, s: (across - column as f64).clamp(0.0, 1.0) }
    }
}

#[derive(Debug, Clone, Copy)]
struct Place {
    row: usize,
    column: usize,
    t: f64,
    s: f64,
}

/// The pdf at one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DirectionTable {
    /// Cumulative probabilities of the rows.
    rows: Vec<f32>,
    /// Cumulative probabilities of the nodes in each row, one more than nodes.
    nodes: Vec<f32>,
}

impl DirectionTable {
    /// Creates the table from the powers at the nodes, of which one is above 0.
    pub(super) fn new(grid: &DirectionGrid, powers: &[f64]) -> Self {
        let sums: Vec<f64> = powers.chunks(grid.side()).map(|row| row.iter().sum()).collect();
        let nodes = powers.chunks(grid.side()).flat_map(cumulative).collect();
        Self { rows: cumulative(&sums), nodes }
    }

    /// Returns the sine of the elevation of each row and its probability.
    pub(super) fn rows(&self, grid: &DirectionGrid) -> impl Iterator<Item = (f64, f64)> {
        let probabilities = self.rows.windows(2).map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
        grid.sines.iter().copied().zip(probabilities)
    }

    /// Returns rows with probabilities that are scaled by a function of the sine of the elevation,
    /// for [`set_rows`](Self::set_rows).
    pub(super) fn scaled_rows(&self, grid: &DirectionGrid, scale: impl Fn(f64) -> f64) -> Vec<f32> {
        cumulative(&self.rows(grid).map(|(z, probability)| probability * scale(z)).collect::<Vec<f64>>())
    }

    pub(super) fn set_rows(&mut self, cumulative: Vec<f32>) {
        self.rows = cumulative;
    }

    /// Returns the pdf per steradian at an azimuth in rad and the sine of an elevation.
    pub(super) fn eval(&self, grid: &DirectionGrid, phi: f64, z: f64) -> f64 {
        let Place { row, column, t, s } = grid.place(phi, z);
        let of_row = |row: usize| {
            let nodes = &self.nodes[row * (grid.side() + 1) + column..][..3];
            let [from, middle, to] = [0, 1, 2].map(|i| f64::from(nodes[i]));
            let [left, right] = [(middle - from) / grid.width(column), (to - middle) / grid.width(column + 1)];
            (f64::from(self.rows[row + 1]) - f64::from(self.rows[row])) / grid.heights[row]
                * (left + s * (right - left))
        };
        let (below, above) = (of_row(row), of_row(row + 1));
        0.5 * (below + t * (above - below))
    }

    /// Samples the azimuth in [0, π] and the sine of the elevation with the pdf
    /// [`eval`](Self::eval).
    pub(super) fn sample(&self, grid: &DirectionGrid, [mut u, mut v]: [f64; 2]) -> (f64, f64) {
        let row = select(&self.rows, &mut u);
        let first = row * (grid.side() + 1);
        let column = select(&self.nodes[first..first + grid.side() + 1], &mut v);
        let last = grid.steps;
        // Each hat function is sampled below or above its node, in proportion to the step there.
        let z = {
            let (here, below, above) =
                (grid.sines[row], grid.sines[row.saturating_sub(1)], grid.sines[(row + 1).min(last)]);
            let down = (here - below) / (above - below);
            if u < down {
                here - (here - below) * falling(u / down)
            } else {
                here + (above - here) * falling((u - down) / (1.0 - down))
            }
        };
        let left = if column == 0 {
            0.0
        } else if column == last {
            1.0
        } else {
            0.5
        };
        let offset = if v < left { -falling(v / left) } else { falling((v - left) / (1.0 - left)) };
        (PI * (column as f64 + offset) / last as f64, z)
    }
}

/// Samples t in [0, 1] with the pdf 2 (1 − t).
fn falling(u: f64) -> f64 {
    1.0 - (1.0 - u).max(0.0).sqrt()
}

/// Returns the cumulative probabilities from 0 to 1 in proportion to weights, or zeros.
fn cumulative(weights: &[f64]) -> Vec<f32> {
    let total: f64 = weights.iter().sum();
    let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
    let mut sum = 0.0;
    let after = weights.iter().map(|weight| {
        sum += weight;
        (sum * scale).min(1.0) as f32
    });
    let mut list: Vec<f32> = std::iter::once(0.0).chain(after).collect();
    // Rounding leaves no gap at the end.
    let top = list[list.len() - 1];
    if top > 0.0 {
        list.iter_mut().rev().take_while(|value| **value == top).for_each(|value| *value = 1.0);
    }
    list
}

/// Selects an interval of cumulative probabilities by `u` in [0, 1), which becomes a new number.
fn select(cumulative: &[f32], u: &mut f64) -> usize {
    let index = cumulative.partition_point(|&c| f64::from(c) <= *u).clamp(1, cumulative.len() - 1) - 1;
    let (from, to) = (f64::from(cumulative[index]), f64::from(cumulative[index + 1]));
    *u = ((*u - from) / (to - from)).clamp(0.0, ONE_MINUS_ULP);
    index
}

/// Smooths the powers of traced rays at the nodes of a grid, at several wavelengths. `squares` are
/// the sums of the squared powers of the rays.
///
/// Each node gets the mean power per solid angle in a window around it, the same at all
/// wavelengths. Windows grow until their effective number of rays (Kish 1965) is at least `rays`, or until the
/// mean differs from that of a smaller window by more than its noise (Lepski 1991), so that bright
/// features do not blur into their surroundings. With `whole_rows`, windows have the whole width of
/// the table.
pub(super) fn smoothed(
    grid: &DirectionGrid,
    powers: &[Vec<f64>],
    squares: &[f64],
    rays: f64,
    whole_rows: bool,
) -> Vec<Vec<f64>> {
    let side = grid.side();
    let sums: Vec<SummedArea> = powers.iter().map(|powers| SummedArea::new(powers, side)).collect();
    let all: Vec<f64> = (0..grid.nodes()).map(|node| powers.iter().map(|powers| powers[node]).sum()).collect();
    let (all, squares) = (SummedArea::new(&all, side), SummedArea::new(squares, side));
    let whole = ((0, side), (0, side));
    let least = [&all, &squares].map(|sums| ROUNDING * sums.within(whole));
    let heights = cumulative_sums(&grid.heights);
    let widths = cumulative_sums(&(0..side).map(|column| grid.width(column)).collect::<Vec<f64>>());
    let solid_angle =
        |(rows, columns): Window| (heights[rows.1] - heights[rows.0]) * (widths[columns.1] - widths[columns.0]);
    let mut out = vec![vec![0.0; grid.nodes()]; powers.len()];
    for node in 0..grid.nodes() {
        let (row, column) = (node / side, node % side);
        let window = |half: usize| {
            let wide = if whole_rows { side } else { WIDTH_TO_HEIGHT * half };
            let clip = |at: usize, half: usize| (at.saturating_sub(half), (at + half + 1).min(side));
            (clip(row, half), clip(column, wide))
        };
        let moments = |window: Window| {
            let (power, square) = (all.within(window), squares.within(window));
            if power > least[0] && square > least[1] { (power, square) } else { (0.0, 0.0) }
        };
        // The noise of a window without rays is that of one bright ray.
        let (power, square) = moments(window(WINDOWS[WINDOWS.len() - 1]));
        let of_one_ray = if power > 0.0 { (2.0 * square / power).powi(2) } else { 0.0 };
        let (mut best, mut low, mut high) = (window(WINDOWS[0]), 0.0_f64, f64::INFINITY);
        for half in WINDOWS {
            let here = window(half);
            let (power, square) = moments(here);
            let noise = NOISE * (square + of_one_ray).sqrt();
            let scale = solid_angle(here).recip();
            (low, high) = (low.max((power - noise) * scale), high.min((power + noise) * scale));
            if low > high {
                break;
            }
            best = here;
            if power > 0.0 && power * power >= rays * square {
                break;
            }
        }
        let scale = grid.heights[row] * grid.width(column) / solid_angle(best);
        for (out, sums) in out.iter_mut().zip(&sums) {
            out[node] = sums.within(best).max(0.0) * scale;
        }
    }
    out
}

/// The first row and the row after the last, and the same of columns.
type Window = ((usize, usize), (usize, usize));

fn cumulative_sums(values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let after = values.iter().map(|value| {
        sum += value;
        sum
    });
    std::iter::once(0.0).chain(after).collect()
}

/// Sums over rectangles of nodes (Crow 1984).
struct SummedArea {
    side: usize,
    sums: Vec<f64>,
}

impl SummedArea {
    fn new(values: &[f64], side: usize) -> Self {
        let wide = side + 1;
        let mut sums = vec![0.0; wide * wide];
        for row in 0..side {
            let mut along = 0.0;
            for column in 0..side {
                along += values[row * side + column];
                sums[(row + 1) * wide + column + 1] = sums[row * wide + column + 1] + along;
            }
        }
        Self { side, sums }
    }

    fn within(&self, ((from_row, to_row), (from, to)): Window) -> f64 {
        let at = |row: usize, column: usize| self.sums[row * (self.side + 1) + column];
        at(to_row, to) - at(from_row, to) - at(to_row, from) + at(from_row, from)
    }
}
