//! Spectral lines: narrow segments of the band with an exact power.

use super::band::{BAND_NM, ULTRAVIOLET_FROM_NM};
use super::index::BandIndex;
use crate::error::{Error, Result};
use crate::math::sort::sort_by_number;

/// The default width of a line in nm.
pub const DEFAULT_LINE_WIDTH_NM: f64 = 0.001;

/// The least width of a line or peak, in nm. It is 10⁷ times the rounding error of a wavelength.
pub(crate) const MIN_WIDTH_NM: f64 = 1e-6;

/// A spectral line as given in a scene or a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralLine {
    /// The centre wavelength in nm (in air).
    pub nm: f64,
    /// The power in W: the integral of the spectrum over the line, in its unit times nm.
    pub power: f64,
    /// The full width in nm, by default [`DEFAULT_LINE_WIDTH_NM`].
    pub fwhm_nm: Option<f64>,
}

impl SpectralLine {
    fn check(&self, i: usize) -> Result<()> {
        let place = |error: Error, field: &str| error.on_path(format!("lines[{i}].{field}"));
        if !(self.nm.is_finite() && self.nm > 0.0) {
            let what = format!("a line at {} nm", self.nm);
            return Err(place(Error::input(what).expected("a positive wavelength in nm"), "nm"));
        }
        if !(self.power.is_finite() && self.power >= 0.0) {
            let what = format!("a line with the power {}", self.power);
            return Err(place(Error::input(what).expected("a finite power of 0 or more"), "power"));
        }
        match self.fwhm_nm {
            Some(width) if !(width.is_finite() && width >= MIN_WIDTH_NM) => {
                let what = format!("a line {width} nm wide");
                Err(place(Error::input(what).expected(format!("a width of at least {MIN_WIDTH_NM} nm")), "fwhm_nm"))
            }
            Some(_) | None => Ok(()),
        }
    }

    /// Returns the part of the line in an interval, as constant power per nm, if there is one.
    fn segment(&self, (from, to): (f64, f64)) -> Option<LineSegment> {
        let half = 0.5 * self.fwhm_nm.unwrap_or(DEFAULT_LINE_WIDTH_NM);
        let (lower, upper) = (self.nm - half, self.nm + half);
        let kept = (lower.max(from), upper.min(to));
        let fraction = (kept.1 - kept.0) / (upper - lower);
        (fraction > 0.0 && self.power > 0.0).then_some(LineSegment { nm: kept, power: self.power * fraction.min(1.0) })
    }
}

/// An interval of the band with constant power per nm. The segments of a spectrum do not overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSegment {
    /// The lower and the upper end in nm.
    pub nm: (f64, f64),
    /// The power of the segment.
    pub power: f64,
}

impl LineSegment {
    /// Returns the power per nm.
    #[inline]
    pub fn power_per_nm(&self) -> f64 {
        self.power / (self.nm.1 - self.nm.0)
    }

    /// Returns the centre wavelength in nm.
    pub fn centre(&self) -> f64 {
        0.5 * (self.nm.0 + self.nm.1)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lines {
    segments: Vec<LineSegment>,
    index: BandIndex,
}

impl Lines {
    pub(crate) fn none() -> Self {
        Self::from_segments(Vec::new())
    }

    /// Converts lines to segments, or returns an error with the index of a line out of range.
    pub(crate) fn new(lines: &[SpectralLine]) -> Result<Self> {
        lines.iter().enumerate().try_for_each(|(i, line)| line.check(i))?;
        Ok(Self::from_segments(lines.iter().filter_map(|line| line.segment(BAND_NM)).collect()))
    }

    pub(super) fn below_band(lines: &[SpectralLine]) -> Vec<LineSegment> {
        lines.iter().filter_map(|line| line.segment((ULTRAVIOLET_FROM_NM, BAND_NM.0))).collect()
    }

    /// Builds the list from any segments, adding the power per nm of overlapping ones.
    pub(crate) fn from_segments(mut segments: Vec<LineSegment>) -> Self {
        segments.retain(|segment| segment.power > 0.0);
        sort_by_number(&mut segments, |segment| segment.nm.0);
        if segments.windows(2).any(|pair| pair[1].nm.0 < pair[0].nm.1) {
            segments = disjoint(&segments);
        }
        let index = BandIndex::new(segments.iter().map(|segment| segment.nm.0));
        Self { segments, index }
    }

    pub(crate) fn segments(&self) -> &[LineSegment] {
        &self.segments
    }

    /// Returns the power per nm at a wavelength of the band.
    #[inline]
    pub(crate) fn at(&self, nm: f64) -> f64 {
        if self.segments.is_empty() {
            return 0.0;
        }
        let segment = &self.segments[self.index.find(nm, |i| self.segments[i].nm.0)];
        if segment.nm.0 <= nm && nm < segment.nm.1 { segment.power_per_nm() } else { 0.0 }
    }

    pub(crate) fn cursor(&self) -> LineCursor<'_> {
        LineCursor { rest: &self.segments }
    }
}

/// Splits segments, sorted by their lower ends, at all ends, and adds the power per nm of overlaps.
fn disjoint(segments: &[LineSegment]) -> Vec<LineSegment> {
    let mut cuts: Vec<f64> = segments.iter().flat_map(|segment| [segment.nm.0, segment.nm.1]).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let mut parts: Vec<LineSegment> =
        cuts.windows(2).map(|pair| LineSegment { nm: (pair[0], pair[1]), power: 0.0 }).collect();
    for segment in segments {
        let from = parts.partition_point(|part| part.nm.0 < segment.nm.0);
        let within = parts[from..].iter_mut().take_while(|part| part.nm.1 <= segment.nm.1);
        for part in within {
            part.power += segment.power * ((part.nm.1 - part.nm.0) / (segment.nm.1 - segment.nm.0));
        }
    }
    parts.retain(|part| part.power > 0.0);
    parts
}

/// A position in a list of lines that moves towards longer wavelengths only.
#[derive(Debug, Clone)]
pub(crate) struct LineCursor<'a> {
    rest: &'a [LineSegment],
}

impl LineCursor<'_> {
    /// Moves to `nm` and returns the first lower or upper end of a line beyond `nm`.
    pub(crate) fn knot_after(&mut self, nm: f64) -> f64 {
        while let [first, rest @ ..] = self.rest
            && first.nm.1 <= nm
        {
            self.rest = rest;
        }
        match self.rest {
            [first, ..] if nm < first.nm.0 => first.nm.0,
            [first, ..] => first.nm.1,
            [] => BAND_NM.1,
        }
    }

    /// Returns the power per nm from `lower`, last passed to `knot_after`, to the next knot.
    pub(crate) fn values_on(&self, lower: f64) -> f64 {
        self.rest.first().filter(|segment| segment.nm.0 <= lower).map_or(0.0, LineSegment::power_per_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(nm: f64, power: f64, width: f64) -> SpectralLine {
        SpectralLine { nm, power, fwhm_nm: Some(width) }
    }

    #[test]
    fn overlapping_lines_add_up_and_keep_their_power() {
        let lines = Lines::new(&[line(500.0, 1.0, 2.0), line(500.5, 3.0, 2.0), line(500.0, 2.0, 2.0)]).unwrap();
        assert_eq!(lines.segments().len(), 3);
        let power: f64 = lines.segments().iter().map(|segment| segment.power).sum();
        assert!((power - 6.0).abs() < 1e-14);
        assert_eq!(lines.at(499.2), 1.5);
        assert_eq!(lines.at(500.0), 3.0);
        assert_eq!(lines.at(501.2), 1.5);
        assert_eq!(lines.at(501.6), 0.0);
    }

    #[test]
    fn a_line_across_the_bands_end_keeps_the_part_inside() {
        let lines = Lines::new(&[line(830.0, 2.0, 1.0), line(200.0, 5.0, 1.0)]).unwrap();
        assert_eq!(lines.segments(), &[LineSegment { nm: (829.5, 830.0), power: 1.0 }]);
    }

    #[test]
    fn errors_name_the_invalid_line() {
        let found = |bad: SpectralLine| Lines::new(&[line(500.0, 1.0, 1.0), bad]).unwrap_err().to_string();
        assert!(found(line(-5.0, 1.0, 1.0)).starts_with("lines[1].nm: a line at -5 nm"));
        assert!(found(line(500.0, f64::NAN, 1.0)).contains("lines[1].power"));
        assert!(found(line(500.0, 1.0, 1e-7)).contains("lines[1].fwhm_nm"));
    }
}
