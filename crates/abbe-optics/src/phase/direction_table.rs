//! A pdf of directions, tabulated for light of one elevation and a few wavelengths.
//!
//! The coordinates are the azimuth φ from the light's direction of travel, in [0, π], and the sine
//! z of the elevation, so that dφ dz is the solid angle. The pdf is symmetric about φ = 0, and
//! bilinear in φ and z between nodes that are evenly spaced in φ and in the elevation.

use abbe_spectra::math::elementary::{asin, sin};
use abbe_spectra::math::random::ONE_MINUS_ULP;
use std::f64::consts::PI;

/// Half-heights of [`Windows`] in nodes. In azimuth they are wider by this angle,
/// because crystals with a level axis make features along horizontal circles.
const WINDOWS: [usize; 8] = [0, 1, 2, 3, 4, 6, 8, 12];
const WIDTH_TO_HEIGHT: usize = 4;

/// Standard deviations by which the means of two windows may differ.
const NOISE: f64 = 4.0;

/// Sums over windows are differences, whose rounding errors are below this fraction of the whole.
const ROUNDING: f64 = 1e-11;

/// The nodes of a table and their solid angles.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DirectionGrid {
    /// Steps from the elevation −90° to 90°.
    rows: usize,
    /// Steps from φ = 0 to π.
    columns: usize,
    /// The sines of the elevations, ascending.
    sines: Vec<f64>,
    /// The width of each row's hat function in z.
    heights: Vec<f64>,
}

impl DirectionGrid {
    /// Creates a grid of so many steps in elevation and in azimuth.
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        let sine = |row: usize| sin(PI * (row as f64 / rows as f64 - 0.5));
        let sines: Vec<f64> = (0..=rows).map(sine).collect();
        let height = |row: usize| 0.5 * (sines[(row + 1).min(rows)] - sines[row.saturating_sub(1)]);
        Self { rows, columns, heights: (0..=rows).map(height).collect(), sines }
    }

    /// The number of nodes in a row.
    fn side(&self) -> usize {
        self.columns + 1
    }

    pub(super) fn nodes(&self) -> usize {
        self.side() * (self.rows + 1)
    }

    /// Returns the node nearest to an azimuth in rad and to the sine of an elevation.
    pub(super) fn nearest(&self, phi: f64, z: f64) -> usize {
        let row = ((asin(z) / PI + 0.5) * self.rows as f64 + 0.5) as usize;
        let column = (phi / PI * self.columns as f64 + 0.5) as usize;
        row.min(self.rows) * self.side() + column.min(self.columns)
    }

    /// The width of a column's hat function in rad.
    fn width(&self, column: usize) -> f64 {
        let whole = PI / self.columns as f64;
        if column == 0 || column == self.columns { 0.5 * whole } else { whole }
    }

    /// Returns the row and the column below a place, and the fractions of the steps above them.
    fn place(&self, phi: f64, z: f64) -> Place {
        let last = self.rows - 1;
        let mut row = (((asin(z) / PI + 0.5) * self.rows as f64).max(0.0) as usize).min(last);
        // The rounding of the arc sine may miss the row by one.
        if row > 0 && self.sines[row] > z {
            row -= 1;
        } else if row < last && self.sines[row + 1] < z {
            row += 1;
        }
        let t = ((z - self.sines[row]) / (self.sines[row + 1] - self.sines[row])).clamp(0.0, 1.0);
        let across = phi / PI * self.columns as f64;
        let column = (across as usize).min(self.columns - 1);
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
        // Each hat function is sampled below or above its node, in proportion to the step there.
        let z = {
            let (here, below, above) =
                (grid.sines[row], grid.sines[row.saturating_sub(1)], grid.sines[(row + 1).min(grid.rows)]);
            let down = (here - below) / (above - below);
            if u < down {
                here - (here - below) * falling(u / down)
            } else {
                here + (above - here) * falling((u - down) / (1.0 - down))
            }
        };
        let left = if column == 0 {
            0.0
        } else if column == grid.columns {
            1.0
        } else {
            0.5
        };
        let offset = if v < left { -falling(v / left) } else { falling((v - left) / (1.0 - left)) };
        (PI * (column as f64 + offset) / grid.columns as f64, z)
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

/// The windows over which the powers at the nodes of a grid are averaged.
pub(super) struct Windows<'g> {
    grid: &'g DirectionGrid,
    /// The sums of the heights of the rows and of the widths of the columns.
    heights: Vec<f64>,
    widths: Vec<f64>,
    whole_rows: bool,
    /// For each node, the number of its window in [`WINDOWS`].
    chosen: Vec<u8>,
}

impl<'g> Windows<'g> {
    /// Chooses the windows for the powers of traced rays at several wavelengths. `squares` are the
    /// sums of the squared powers of the rays.
    ///
    /// Windows grow until their effective number of rays (Kish 1965) is at least `rays`, or until
    /// the mean power per solid angle differs from that of a smaller window by more than its noise
    /// (Lepski 1991), so that bright features do not blur into their surroundings. With
    /// `whole_rows`, windows have the whole width of the table.
    pub(super) fn new(
        grid: &'g DirectionGrid,
        powers: &[Vec<f64>],
        squares: &[f64],
        rays: f64,
        whole_rows: bool,
    ) -> Self {
        let side = grid.side();
        let heights = cumulative_sums(&grid.heights);
        let widths = cumulative_sums(&(0..side).map(|column| grid.width(column)).collect::<Vec<f64>>());
        let mut windows = Self { grid, heights, widths, whole_rows, chosen: Vec::new() };
        let all: Vec<f64> = (0..grid.nodes()).map(|node| powers.iter().map(|powers| powers[node]).sum()).collect();
        let (all, squares) = (SummedArea::new(&all, side), SummedArea::new(squares, side));
        let whole = ((0, grid.rows + 1), (0, side));
        let least = [&all, &squares].map(|sums| ROUNDING * sums.within(whole));
        let moments = |window: Window| {
            let (power, square) = (all.within(window), squares.within(window));
            if power > least[0] && square > least[1] { (power, square) } else { (0.0, 0.0) }
        };
        let choose = |node: usize| {
            // The noise of a window without rays is that of one bright ray.
            let (power, square) = moments(windows.around(node, WINDOWS[WINDOWS.len() - 1]));
            let of_one_ray = if power > 0.0 { (2.0 * square / power).powi(2) } else { 0.0 };
            let (mut best, mut low, mut high) = (0, 0.0_f64, f64::INFINITY);
            for (number, half) in WINDOWS.into_iter().enumerate() {
                let here = windows.around(node, half);
                let (power, square) = moments(here);
                let noise = NOISE * (square + of_one_ray).sqrt();
                let scale = windows.solid_angle(here).recip();
                (low, high) = (low.max((power - noise) * scale), high.min((power + noise) * scale));
                if low > high {
                    break;
                }
                best = number;
                if power > 0.0 && power * power >= rays * square {
                    break;
                }
            }
            best as u8
        };
        let chosen = (0..grid.nodes()).map(choose).collect();
        windows.chosen = chosen;
        windows
    }

    /// Returns the mean powers per solid angle in the windows, at one wavelength, each times the
    /// solid angle of its node.
    pub(super) fn smoothed(&self, powers: &[f64]) -> Vec<f64> {
        let (grid, sums) = (self.grid, SummedArea::new(powers, self.grid.side()));
        let mean = |node: usize| {
            let window = self.around(node, WINDOWS[usize::from(self.chosen[node])]);
            let (row, column) = (node / grid.side(), node % grid.side());
            sums.within(window).max(0.0) * (grid.heights[row] * grid.width(column) / self.solid_angle(window))
        };
        (0..grid.nodes()).map(mean).collect()
    }

    fn around(&self, node: usize, half: usize) -> Window {
        let (grid, side) = (self.grid, self.grid.side());
        let wide = if self.whole_rows { side } else { WIDTH_TO_HEIGHT * half * grid.columns / grid.rows };
        let clip = |at: usize, half: usize, end: usize| (at.saturating_sub(half), (at + half + 1).min(end));
        (clip(node / side, half, grid.rows + 1), clip(node % side, wide, side))
    }

    fn solid_angle(&self, (rows, columns): Window) -> f64 {
        (self.heights[rows.1] - self.heights[rows.0]) * (self.widths[columns.1] - self.widths[columns.0])
    }
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
        let mut sums = vec![0.0; wide * (values.len() / side + 1)];
        for row in 0..values.len() / side {
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
