//! The ultraviolet part of a spectrum: the wavelengths from 300 nm to the lower end of the band.
//!
//! No sensor sees these wavelengths, and integrals over the band exclude them. They only excite
//! fluorophores, so linear pieces 1 nm wide are precise enough.

use super::band::{BAND_NM, ULTRAVIOLET_FROM_NM};
use super::continuum::Continuum;
use super::line::LineSegment;
use super::table::{self, Outside};

pub(super) const STEPS: usize = (BAND_NM.0 - ULTRAVIOLET_FROM_NM) as usize;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ultraviolet {
    /// The values at whole nanometres from 300 to 360 nm.
    values: [f64; STEPS + 1],
    lines: Vec<LineSegment>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct BelowBand<'a> {
    /// `None` if the value at the lower end of the band is held.
    pub(super) part: Option<&'a Ultraviolet>,
    pub(super) within: &'a Continuum,
}

/// A piece of a weighted spectrum: its ends in nm, and the values at the ends.
pub(super) type WeightedPiece = ((f64, f64), (f64, f64));

pub(super) fn grid_nm(i: usize) -> f64 {
    ULTRAVIOLET_FROM_NM + i as f64
}

impl Ultraviolet {
    pub(super) const NONE: Self = Self { values: [0.0; STEPS + 1], lines: Vec::new() };

    /// Samples a function, by means over 1 nm if it is `narrow`, so that narrow peaks keep their
    /// power.
    #[cold]
    #[inline(never)]
    pub(super) fn sampled(function: &dyn Fn(f64) -> f64, narrow: bool) -> Option<Box<Self>> {
        const PARTS: u32 = 16;
        let mean = |nm: f64| {
            let part = |i: u32| function(nm + (f64::from(i) + 0.5) / f64::from(PARTS) - 0.5);
            (0..PARTS).map(part).sum::<f64>() / f64::from(PARTS)
        };
        let value = |i: usize| if narrow { mean(grid_nm(i)) } else { function(grid_nm(i)) };
        Some(Box::new(Self { values: std::array::from_fn(value), ..Self::NONE }))
    }

    /// Samples a valid, non-empty table, or returns `None` if the table holds its first value over
    /// the whole ultraviolet.
    #[cold]
    #[inline(never)]
    pub(super) fn of_table(nm: &[f64], values: &[f64], outside: Outside) -> Option<Box<Self>> {
        if nm[0] >= BAND_NM.0 {
            return (outside == Outside::Zero).then(|| Box::new(Self::NONE));
        }
        let at = |x: f64| {
            let after = nm.partition_point(|&known| known <= x);
            let end = after == 0 || (after == nm.len() && x > nm[after - 1]);
            if end && outside == Outside::Zero {
                return 0.0;
            }
            if after == 0 || after == nm.len() {
                return values[after.min(nm.len() - 1)];
            }
            let t = (x - nm[after - 1]) / (nm[after] - nm[after - 1]);
            (1.0 - t) * values[after - 1] + t * values[after]
        };
        Self::sampled(&at, table::is_fine_within(nm, (ULTRAVIOLET_FROM_NM, BAND_NM.0)))
    }

    /// Returns the part of spectral lines, which may overlap, or `None` if there are none.
    pub(super) fn of_lines(lines: Vec<LineSegment>) -> Option<Box<Self>> {
        (!lines.is_empty()).then(|| Box::new(Self { lines, ..Self::NONE }))
    }

    /// Returns the value of the continuum at a wavelength in nm, from 300 to 360.
    fn continuum_at(&self, nm: f64) -> f64 {
        let place = nm - ULTRAVIOLET_FROM_NM;
        let i = (place as usize).min(STEPS - 1);
        self.values[i] + (place - i as f64) * (self.values[i + 1] - self.values[i])
    }

    fn lines_at(&self, nm: f64) -> f64 {
        let on = self.lines.iter().filter(|line| line.nm.0 <= nm && nm < line.nm.1);
        on.map(LineSegment::power_per_nm).sum()
    }

    pub(super) fn combined(of: &dyn Fn(f64) -> f64, lines: Vec<LineSegment>) -> Option<Box<Self>> {
        let mut part = Self::sampled(of, false)?;
        part.lines = lines;
        Some(part)
    }

    /// Returns the part of a weighted sum, or `None` if no term has data below the band.
    #[cold]
    #[inline(never)]
    pub(super) fn of_mix(parts: &[(f64, BelowBand<'_>)]) -> Option<Box<Self>> {
        if parts.iter().all(|(_, part)| part.part.is_none()) {
            return None;
        }
        let scaled = |(weight, part): &(f64, BelowBand<'_>)| part.part.map(|part| part.scaled(*weight).lines);
        let lines = parts.iter().filter_map(scaled).flatten().collect();
        let at = |nm| parts.iter().map(|(weight, part)| weight * part.continuum_at(nm)).sum();
        Self::combined(&at, lines)
    }

    pub(super) fn scaled(&self, factor: f64) -> Box<Self> {
        Box::new(Self {
            values: self.values.map(|value| value * factor),
            lines: self.lines.iter().map(|line| LineSegment { power: line.power * factor, ..*line }).collect(),
        })
    }
}

impl<'a> BelowBand<'a> {
    /// Returns the value at a wavelength in nm, which is 0 below 300 nm and above 360 nm.
    #[cold]
    #[inline(never)]
    pub(super) fn at(self, nm: f64) -> f64 {
        if !(ULTRAVIOLET_FROM_NM..=BAND_NM.0).contains(&nm) {
            return 0.0;
        }
        self.continuum_at(nm) + self.lines_at(nm)
    }

    /// Returns the value without lines at a wavelength in nm, from 300 to 360.
    pub(super) fn continuum_at(self, nm: f64) -> f64 {
        self.part.map_or_else(|| self.within.at(BAND_NM.0), |part| part.continuum_at(nm))
    }

    pub(super) fn lines_at(self, nm: f64) -> f64 {
        self.part.map_or(0.0, |part| part.lines_at(nm))
    }

    pub(super) fn lines(self) -> &'a [LineSegment] {
        self.part.map_or(&[], |part| &part.lines)
    }

    pub(super) fn continuum_only(self) -> Option<Box<Ultraviolet>> {
        self.part.map(|part| Box::new(Ultraviolet { values: part.values, ..Ultraviolet::NONE }))
    }

    /// Returns the part of the product with another spectrum, or `None` if neither has data below
    /// the band.
    #[cold]
    #[inline(never)]
    pub(super) fn product(self, other: BelowBand<'_>) -> Option<Box<Ultraviolet>> {
        if self.part.is_none() && other.part.is_none() {
            return None;
        }
        let weighted = |line: &LineSegment, factor: f64| LineSegment { power: line.power * factor, ..*line };
        let own = self.lines().iter().map(|line| weighted(line, other.at(line.centre())));
        let theirs = other.lines().iter().map(|line| weighted(line, self.continuum_at(line.centre())));
        let lines = own.chain(theirs).collect();
        Ultraviolet::combined(&|nm| self.continuum_at(nm) * other.continuum_at(nm), lines)
    }

    pub(super) fn complement(self) -> Option<Box<Ultraviolet>> {
        self.part?;
        Ultraviolet::combined(&|nm| 1.0 - self.continuum_at(nm), Vec::new())
    }
}
