//! The smooth part of a spectrum: a piecewise-linear function over the band, which may jump between pieces.

use super::BAND_NM;
use super::index::BandIndex;

/// A stretch of wavelengths on which a function is linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Where it begins and ends, in nm.
    pub nm: (f64, f64),
    /// The value at its beginning and at its end.
    pub values: (f64, f64),
}

impl Piece {
    /// The integral over the piece, in the value's unit times nm.
    pub fn integral(&self) -> f64 {
        (self.nm.1 - self.nm.0) * (0.5 * self.values.0 + 0.5 * self.values.1)
    }

    /// The value at `nm`, which lies in the piece.
    fn at(&self, nm: f64) -> f64 {
        let t = ((nm - self.nm.0) / (self.nm.1 - self.nm.0)).clamp(0.0, 1.0);
        self.values.0 + t * (self.values.1 - self.values.0)
    }
}

/// A piece as the inner loop wants it: the end is the next one's beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    lower: f64,
    per_width: f64,
    value: f64,
    rise: f64,
}

/// Pieces that follow each other from one end of the band to the other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Continuum {
    cells: Vec<Cell>,
    index: BandIndex,
}

impl Continuum {
    /// The same value everywhere.
    pub(crate) fn constant(value: f64) -> Self {
        Self::from_pieces(&[Piece { nm: BAND_NM, values: (value, value) }])
    }

    /// Pieces in order, each beginning where the one before ends, that cover the band; empty pieces are dropped,
    /// and a function that is constant becomes one piece.
    pub(crate) fn from_pieces(pieces: &[Piece]) -> Self {
        let first = pieces.first().map_or(0.0, |piece| piece.values.0);
        let flat = pieces.iter().all(|piece| piece.values == (first, first));
        let whole = [Piece { nm: BAND_NM, values: (first, first) }];
        let pieces = if flat { &whole } else { pieces };
        let cells: Vec<Cell> = pieces
            .iter()
            .filter(|piece| piece.nm.1 > piece.nm.0)
            .map(|piece| Cell {
                lower: piece.nm.0,
                per_width: (piece.nm.1 - piece.nm.0).recip(),
                value: piece.values.0,
                rise: piece.values.1 - piece.values.0,
            })
            .collect();
        let index = BandIndex::new(cells.iter().map(|cell| cell.lower));
        Self { cells, index }
    }

    /// A continuous function through knots (nm, value) that begin and end with the band's ends.
    pub(crate) fn from_knots(knots: &[(f64, f64)]) -> Self {
        let pieces: Vec<Piece> =
            knots.windows(2).map(|pair| Piece { nm: (pair[0].0, pair[1].0), values: (pair[0].1, pair[1].1) }).collect();
        Self::from_pieces(&pieces)
    }

    /// The value at a wavelength of the band; at a jump that of the side of longer wavelengths.
    #[inline]
    pub(crate) fn at(&self, nm: f64) -> f64 {
        if let [only] = self.cells.as_slice()
            && only.rise == 0.0
        {
            return only.value;
        }
        let cell = &self.cells[self.index.find(nm, |i| self.cells[i].lower)];
        // The minimum keeps rounding from overshooting the end, so that values never leave their piece's range.
        cell.value + ((nm - cell.lower) * cell.per_width).min(1.0) * cell.rise
    }

    /// The pieces in order.
    pub(crate) fn pieces(&self) -> impl ExactSizeIterator<Item = Piece> + '_ {
        (0..self.cells.len()).map(|i| self.piece(i))
    }

    fn piece(&self, i: usize) -> Piece {
        let cell = &self.cells[i];
        let end = self.cells.get(i + 1).map_or(BAND_NM.1, |next| next.lower);
        Piece { nm: (cell.lower, end), values: (cell.value, cell.value + cell.rise) }
    }

    /// The value, if there is only one.
    pub(crate) fn is_constant(&self) -> Option<f64> {
        match self.cells.as_slice() {
            [only] if only.rise == 0.0 => Some(only.value),
            _ => None,
        }
    }

    /// The function times a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let scale = |cell: &Cell| Cell { value: cell.value * factor, rise: cell.rise * factor, ..*cell };
        Self { cells: self.cells.iter().map(scale).collect(), index: self.index.clone() }
    }

    /// The integral over the band.
    pub(crate) fn integral(&self) -> f64 {
        self.pieces().map(|piece| piece.integral()).sum()
    }

    /// Walks along the pieces from the band's lower end.
    pub(crate) fn cursor(&self) -> ContinuumCursor<'_> {
        ContinuumCursor { continuum: self, i: 0, piece: self.piece(0) }
    }
}

/// A place in a continuum that only moves towards longer wavelengths.
#[derive(Debug, Clone)]
pub(crate) struct ContinuumCursor<'a> {
    continuum: &'a Continuum,
    i: usize,
    piece: Piece,
}

impl ContinuumCursor<'_> {
    /// The first knot beyond `nm`.
    pub(crate) fn knot_after(&mut self, nm: f64) -> f64 {
        while self.piece.nm.1 <= nm && self.i + 1 < self.continuum.cells.len() {
            self.i += 1;
            self.piece = self.continuum.piece(self.i);
        }
        self.piece.nm.1
    }

    /// The values at both ends, seen from inside, of a stretch that holds no knot and begins where `knot_after` was
    /// last asked.
    pub(crate) fn on(&self, lower: f64, upper: f64) -> (f64, f64) {
        (self.piece.at(lower), self.piece.at(upper))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_is_found_piece_by_piece_however_its_knots_crowd() {
        // 20,000 knots within one nanometre, few elsewhere.
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
