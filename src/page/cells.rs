//! The values of square cells of pixels, for a page that the reader takes along.

use super::probe::{ProbeArea, report};
use super::snapshot::{Snapshot, float_bytes};
use serde::Deserialize;

/// The largest number of cells.
const MOST_CELLS: usize = 1 << 14;

/// The cells that the page asks for.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CellQuery {
    /// The width of a cell in pixels. The last cells of a row or a column may be smaller.
    size: usize,
}

/// Returns the values that a probe of each cell reports, row by row, as 32-bit floating-point
/// numbers: X, Y, Z, the noise, the bias and the upper end of the 95 % interval of Y, the spectral
/// radiance in all bands, and its standard errors. Unknown values are NaN. Returns `None` for too
/// many cells.
pub(crate) fn values(snapshot: &Snapshot, CellQuery { size }: CellQuery) -> Option<Vec<u8>> {
    let (width, height) = (snapshot.picture.width, snapshot.picture.height);
    if size == 0 || width.div_ceil(size) * height.div_ceil(size) > MOST_CELLS {
        return None;
    }
    let corners = (0..height).step_by(size).flat_map(|y0| (0..width).step_by(size).map(move |x0| (x0, y0)));
    let areas = corners.map(|(x0, y0)| {
        let last = |first: usize, end: usize| (first + size).min(end) - 1;
        ProbeArea { x0, y0, x1: last(x0, width), y1: last(y0, height) }
    });
    let reports = areas.filter_map(|area| report(snapshot, area));
    Some(float_bytes(reports.flat_map(|report| report.numbers()).map(|value| value as f32)))
}
