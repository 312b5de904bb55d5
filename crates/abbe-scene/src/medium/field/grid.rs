//! A grid of values at the centres of cells, with trilinear interpolation.
//!
//! Beyond the outermost centres, the interpolation uses their values, so the value is constant if
//! the grid has only one cell. Between two adjacent planes of centres, the value along a line is a
//! cubic polynomial, which Gauss quadrature with two points integrates exactly.

use super::FieldLine;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::quadrature::gauss2;
use glam::DVec3;
use std::ops::ControlFlow;

#[derive(Debug, Clone, PartialEq)]
pub struct FieldGrid {
    resolution: [usize; 3],
    /// At the cell centres, x fastest, then y, then z. Single precision saves memory.
    values: Vec<f32>,
    /// Along each axis.
    blocks: [usize; 3],
    /// By block.
    maxima: Vec<f32>,
}

/// The side of a block in units of cells. The largest value that is stored for a block shows
/// whether the block is empty, and bounds the value along a line through it.
const BLOCK: usize = 8;

impl FieldGrid {
    /// Creates a grid from the values at the centres of its cells, with x varying fastest, then y,
    /// then z. Returns an error if the number of values differs from the number of cells, there is
    /// no cell, or a value is negative or not finite in single precision.
    pub fn new(resolution: [usize; 3], values: impl ExactSizeIterator<Item = f64>) -> Result<Self> {
        let [x, y, z] = resolution;
        let cells = x.checked_mul(y).and_then(|cells| cells.checked_mul(z)).filter(|&cells| cells > 0);
        if cells != Some(values.len()) {
            let what = format!("{} values for {x} × {y} × {z} cells", values.len());
            return Err(Error::input(what).expected("one value for each cell, and at least one cell"));
        }
        let mut kept = Vec::with_capacity(values.len());
        for (i, value) in values.enumerate() {
            let single = value as f32;
            if !(single.is_finite() && single >= 0.0) {
                let what = format!("the value {value} in cell ({}, {}, {})", i % x, i / x % y, i / (x * y));
                return Err(Error::input(what).expected("a finite number of at least 0"));
            }
            kept.push(single);
        }
        let blocks = resolution.map(|cells| (cells - 1).div_ceil(BLOCK).max(1));
        let mut grid = Self { resolution, values: kept, blocks, maxima: Vec::new() };
        let each = |n: usize| (0..n).map(|i| [i % blocks[0], i / blocks[0] % blocks[1], i / (blocks[0] * blocks[1])]);
        grid.maxima = each(blocks.iter().product()).map(|block| grid.max_in_block(block)).collect();
        Ok(grid)
    }

    /// The largest value at the cell centres in a block, including those on its far faces.
    fn max_in_block(&self, block: [usize; 3]) -> f32 {
        let range = |axis: usize| {
            let first = block[axis] * BLOCK;
            first..(first + BLOCK + 1).min(self.resolution[axis])
        };
        let mut max = 0.0_f32;
        for z in range(2) {
            for y in range(1) {
                let row = self.resolution[0] * (y + self.resolution[1] * z);
                max = range(0).fold(max, |max, x| max.max(self.values[row + x]));
            }
        }
        max
    }

    pub(super) fn max(&self) -> f64 {
        self.maxima.iter().fold(0.0, |max: f64, &value| max.max(f64::from(value)))
    }

    pub(super) fn at(&self, local: DVec3, bounds: (DVec3, DVec3)) -> f64 {
        self.value(self.cells_per_length(bounds) * (local - bounds.0) - DVec3::splat(0.5))
    }

    /// The value at an offset from the centre of the first cell, in units of cells.
    fn value(&self, place: DVec3) -> f64 {
        let mut corner = [0; 3];
        let mut fraction = [0.0; 3];
        let mut stride = [0; 3];
        let mut step = 1;
        for axis in 0..3 {
            let last = self.resolution[axis] - 1;
            let along = place[axis].clamp(0.0, last as f64);
            corner[axis] = (along as usize).min(last.saturating_sub(1));
            fraction[axis] = along - corner[axis] as f64;
            stride[axis] = if last == 0 { 0 } else { step };
            step *= self.resolution[axis];
        }
        let first = corner[0] + self.resolution[0] * (corner[1] + self.resolution[1] * corner[2]);
        let value = |x: usize, y: usize, z: usize| {
            f64::from(self.values[first + x * stride[0] + y * stride[1] + z * stride[2]])
        };
        let mix = |a: f64, b: f64, fraction: f64| a + fraction * (b - a);
        let along_x = |y: usize, z: usize| mix(value(0, y, z), value(1, y, z), fraction[0]);
        let along_y = |z: usize| mix(along_x(0, z), along_x(1, z), fraction[1]);
        mix(along_y(0), along_y(1), fraction[2])
    }

    fn cells_per_length(&self, bounds: (DVec3, DVec3)) -> DVec3 {
        let [x, y, z] = self.resolution.map(|cells| cells as f64);
        DVec3::new(x, y, z) / (bounds.1 - bounds.0)
    }

    /// Converts a line to coordinates in units of cells from the centre of the first cell.
    fn in_centres(&self, line: &FieldLine, bounds: (DVec3, DVec3)) -> FieldLine {
        let scale = self.cells_per_length(bounds);
        FieldLine { origin: scale * (line.origin - bounds.0) - DVec3::splat(0.5), direction: scale * line.direction }
    }

    /// The largest value that is stored for a block on the line, which bounds the value along it.
    pub(super) fn majorant(&self, line: &FieldLine, interval: (f64, f64), bounds: (DVec3, DVec3)) -> f64 {
        let mut max = 0.0_f32;
        let _ = self.for_each_block(&self.in_centres(line, bounds), interval, |_, bound| {
            max = max.max(bound);
            ControlFlow::Continue(())
        });
        f64::from(max)
    }

    /// Divides the line at planes of cell centres, and visits the pieces in no empty block.
    pub(super) fn for_each_piece(
        &self,
        line: &FieldLine,
        interval: (f64, f64),
        bounds: (DVec3, DVec3),
        mut visit: impl FnMut((f64, f64)) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let line = self.in_centres(line, bounds);
        let planes = self.resolution.map(|cells| cells as i64 - 1);
        self.for_each_block(&line, interval, |piece, bound| {
            if bound > 0.0 { for_each_step(&line, piece, planes, &mut visit) } else { ControlFlow::Continue(()) }
        })
    }

    fn for_each_block(
        &self,
        line: &FieldLine,
        interval: (f64, f64),
        mut visit: impl FnMut((f64, f64), f32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let per_block = 1.0 / BLOCK as f64;
        let blocks = FieldLine { origin: per_block * line.origin, direction: per_block * line.direction };
        let planes = self.blocks.map(|count| count as i64 - 1);
        for_each_step(&blocks, interval, planes, |piece| {
            let middle = blocks.at(0.5 * (piece.0 + piece.1));
            let index = |axis: usize| (middle[axis].max(0.0) as usize).min(self.blocks[axis] - 1);
            let block = index(0) + self.blocks[0] * (index(1) + self.blocks[1] * index(2));
            visit(piece, self.maxima[block])
        })
    }

    pub(super) fn integral(&self, line: &FieldLine, piece: (f64, f64), bounds: (DVec3, DVec3)) -> f64 {
        let line = self.in_centres(line, bounds);
        gauss2(piece, |t| self.value(line.at(t)))
    }
}

/// Visits the pieces of a line between integer planes from 0 to `last` (Amanatides & Woo 1987).
fn for_each_step(
    line: &FieldLine,
    (from, to): (f64, f64),
    last: [i64; 3],
    mut visit: impl FnMut((f64, f64)) -> ControlFlow<()>,
) -> ControlFlow<()> {
    // For each axis: the next plane, and the parameter at which the line crosses it, computed from
    // the integer so that rounding errors do not accumulate.
    let start = line.at(from);
    let mut plane = [0_i64; 3];
    let crossing = |axis: usize, plane: i64| {
        let (origin, along) = (line.origin[axis], line.direction[axis]);
        if along == 0.0 || plane < 0 || plane > last[axis] { f64::INFINITY } else { (plane as f64 - origin) / along }
    };
    let mut next = [0.0; 3];
    for axis in 0..3 {
        let forth = line.direction[axis] > 0.0;
        let place = start[axis].clamp(-1.0, last[axis] as f64 + 1.0);
        plane[axis] = if forth { (place.floor() as i64 + 1).max(0) } else { (place.ceil() as i64 - 1).min(last[axis]) };
        next[axis] = crossing(axis, plane[axis]);
    }
    let mut t = from;
    while t < to {
        let end = next[0].min(next[1]).min(next[2]).min(to);
        for axis in 0..3 {
            if next[axis] <= end {
                plane[axis] += if line.direction[axis] > 0.0 { 1 } else { -1 };
                next[axis] = crossing(axis, plane[axis]);
            }
        }
        // Rounding may place the first crossing before the start.
        if end > t {
            visit((t, end))?;
            t = end;
        }
    }
    ControlFlow::Continue(())
}
