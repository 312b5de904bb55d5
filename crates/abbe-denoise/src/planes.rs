//! Planes: one number for each pixel, row by row.

use rayon::prelude::*;

/// The rows that one task computes.
pub(crate) const ROWS: usize = 32;

/// The size of a picture in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Size {
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl Size {
    pub(crate) fn count(self) -> usize {
        self.width * self.height
    }
}

/// Returns a plane whose rows `fill(y, row)` computes in parallel.
pub(crate) fn by_rows(size: Size, fill: impl Fn(usize, &mut [f32]) + Sync) -> Vec<f32> {
    let mut plane = vec![0.0; size.count()];
    plane.par_chunks_mut(size.width * ROWS).enumerate().for_each(|(block, rows)| {
        for (nth, row) in rows.chunks_mut(size.width).enumerate() {
            fill(block * ROWS + nth, row);
        }
    });
    plane
}

/// Returns the means over squares of (2 `radius` + 1)² pixels with the given spacing, as far as
/// they lie in the picture.
pub(crate) fn mean_around(plane: &[f32], size: Size, radius: usize, spacing: usize) -> Vec<f32> {
    let reach = radius * spacing;
    let across = by_rows(size, |y, row| {
        let from = &plane[y * size.width..][..size.width];
        for (x, value) in row.iter_mut().enumerate() {
            let first = x - (x.min(reach) / spacing) * spacing;
            let (mut sum, mut count) = (0.0, 0.0);
            for other in from[first..(x + reach + 1).min(size.width)].iter().step_by(spacing) {
                sum += other;
                count += 1.0;
            }
            *value = sum / count;
        }
    });
    by_rows(size, |y, row| {
        let first = y - (y.min(reach) / spacing) * spacing;
        let mut count = 0.0;
        for other in (first..(y + reach + 1).min(size.height)).step_by(spacing) {
            let from = &across[other * size.width..][..size.width];
            row.iter_mut().zip(from).for_each(|(value, other)| *value += other);
            count += 1.0;
        }
        row.iter_mut().for_each(|value| *value /= count);
    })
}
