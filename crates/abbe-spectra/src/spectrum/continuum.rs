//! The smooth part of a spectrum: piecewise linear over the band, with possible jumps.

use super::band::BAND_NM;
use super::index::BandIndex;

/// An interval of wavelengths on which a function is linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearPiece {
    /// The lower and the upper end in nm.
    pub nm: (f64, f64),
    /// The values at the lower and at the upper end.
    pub values: (f64, f64),
}

impl LinearPiece {
    /// Returns the integral over the piece, in the unit of the value times nm.
    pub fn integral(&self) -> f64 {
        (self.nm.1 - self.nm.0) * (0.5 * self.values.0 + 0.5 * self.values.1)
    }

    /// `nm` must be in the piece.
    fn at(&self, nm: f64) -> f64 {
        let t = ((nm - self.nm.0) / (self.nm.1 - self.nm.0)).clamp(0.0, 1.0);
        self.values.0 + t * (self.values.1 - self.values.0)
    }
}

/// A piece in a form for fast evaluation. Its upper end is the lower end of the next cell.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ContinuumCell {
    lower: f64,
    per_width: f64,
    value: f64,
    rise: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Continuum {
    cells: Vec<ContinuumCell>,
    index: BandIndex,
}

impl Continuum {
    pub(crate) fn constant(value: f64) -> Self {
        Self::from_pieces(&[LinearPiece { nm: BAND_NM, values: (value, value) }])
    }

    /// Builds a function from ascending pieces that cover the band without gaps. Empty pieces are
    /// dropped, and a constant function becomes one piece.
    pub(crate) fn from_pieces(pieces: &[LinearPiece]) -> Self {
        let first = pieces.first().map_or(0.0, |piece| piece.values.0);
        let flat = pieces.iter().all(|piece| piece.values == (first, first));
        let whole = [LinearPiece { nm: BAND_NM, values: (first, first) }];
        let pieces = if flat { &whole } else { pieces };
        let cells: Vec<ContinuumCell> = pieces
            .iter()
            .filter(|piece| piece.nm.1 > piece.nm.0)
            .map(|piece| ContinuumCell {
                lower: piece.nm.0,
                per_width: (piece.nm.1 - piece.nm.0).recip(),
                value: piece.values.0,
                rise: piece.values.1 - piece.values.0,
            })
            .collect();
        let index = BandIndex::new(cells.iter().map(|cell| cell.lower));
        Self { cells, index }
    }

    /// Builds a continuous function through knots (nm, value), from end to end of the band.
    pub(crate) fn from_knots(knots: &[(f64, f64)]) -> Self {
        let pieces: Vec<LinearPiece> = knots
            .windows(2)
            .map(|pair| LinearPiece { nm: (pair[0].0, pair[1].0), values: (pair[0].1, pair[1].1) })
            .collect();
        Self::from_pieces(&pieces)
    }

    /// Returns the value in the band, at a discontinuity the limit from longer wavelengths.
    #[inline]
    pub(crate) fn at(&self, nm: f64) -> f64 {
        if let [only] = self.cells.as_slice()
            && only.rise == 0.0
        {
            return only.value;
        }
        let cell = &self.cells[self.index.find(nm, |i| self.cells[i].lower)];
        // Rounding may exceed 1, and the minimum keeps values in the range of their piece.
        cell.value + ((nm - cell.lower) * cell.per_width).min(1.0) * cell.rise
    }

    pub(crate) fn pieces(&self) -> impl ExactSizeIterator<Item = LinearPiece> + '_ {
        (0..self.cells.len()).map(|i| self.piece(i))
    }

    fn piece(&self, i: usize) -> LinearPiece {
        let cell = &self.cells[i];
        let end = self.cells.get(i + 1).map_or(BAND_NM.1, |next| next.lower);
        LinearPiece { nm: (cell.lower, end), values: (cell.value, cell.value + cell.rise) }
    }

    pub(crate) fn is_constant(&self) -> Option<f64> {
        match self.cells.as_slice() {
            [only] if only.rise == 0.0 => Some(only.value),
            _ => None,
        }
    }

    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let scale =
            |cell: &ContinuumCell| ContinuumCell { value: cell.value * factor, rise: cell.rise * factor, ..*cell };
        Self { cells: self.cells.iter().map(scale).collect(), index: self.index.clone() }
    }

    pub(crate) fn integral(&self) -> f64 {
        self.pieces().map(|piece| piece.integral()).sum()
    }

    pub(crate) fn cursor(&self) -> ContinuumCursor<'_> {
        ContinuumCursor { continuum: self, i: 0, piece: self.piece(0) }
    }
}

/// A position in a continuum that moves towards longer wavelengths only.
#[derive(Debug, Clone)]
pub(crate) struct ContinuumCursor<'a> {
    continuum: &'a Continuum,
    i: usize,
    piece: LinearPiece,
}

impl ContinuumCursor<'_> {
    /// Moves to `nm` and returns the first knot beyond `nm`.
    pub(crate) fn knot_after(&mut self, nm: f64) -> f64 {
        while self.piece.nm.1 <= nm && self.i + 1 < self.continuum.cells.len() {
            self.i += 1;
            self.piece = self.continuum.piece(self.i);
        }
        self.piece.nm.1
    }

    /// Returns the values at both ends of an interval without knots, as limits from its inside. The
    /// interval must begin at the wavelength that was last passed to `knot_after`.
    pub(crate) fn values_on(&self, lower: f64, upper: f64) -> (f64, f64) {
        (self.piece.at(lower), self.piece.at(upper))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_between_crowded_knots() {
        // One nanometre contains 20,000 knots. The rest of the band contains few.
        let mut knots = vec![(360.0, 1.0), (500.0, 2.0)];
        knots.extend((1..20_000).map(|i| (500.0 + f64::from(i) / 20_000.0, f64::from(i % 7))));
        knots.extend([(501.0, 3.0), (830.0, 0.0)]);
        let continuum = Continuum::from_knots(&knots);
        for pair in knots.windows(2) {
            let middle = 0.5 * (pair[0].0 + pair[1].0);
            assert!((continuum.at(middle) - 0.5 * (pair[0].1 + pair[1].1)).abs() < 1e-6, "{middle}");
            assert_eq!(continuum.at(pair[0].0), pair[0].1);
        }
        assert_eq!(continuum.at(830.0), 0.0);
    }

    #[test]
    fn equal_values_become_one_piece() {
        let continuum = Continuum::from_knots(&[(360.0, 2.0), (400.0, 2.0), (830.0, 2.0)]);
        assert_eq!(continuum.is_constant(), Some(2.0));
        assert_eq!(continuum.integral(), 940.0);
    }
}
