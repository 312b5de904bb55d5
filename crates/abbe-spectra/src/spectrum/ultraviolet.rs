//! The ultraviolet part of a spectrum: the wavelengths from 300 nm to the lower end of the band.
//!
//! No sensor sees these wavelengths. They only excite fluorophores, so linear pieces 1 nm wide are
//! precise enough. Integrals over the band do not include them.

use super::line::LineSegment;
use super::table;
use super::{BAND_NM, Outside, Spectrum, WavelengthDistribution};

/// The lower end of the ultraviolet, in nm.
pub const ULTRAVIOLET_FROM_NM: f64 = 300.0;

/// The number of steps of 1 nm.
const STEPS: usize = (BAND_NM.0 - ULTRAVIOLET_FROM_NM) as usize;

/// The ultraviolet part of a spectrum.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ultraviolet {
    /// The values at whole nanometres from 300 to 360 nm.
    values: [f64; STEPS + 1],
    lines: Vec<LineSegment>,
}

/// A piece of a weighted spectrum: its ends in nm, and the values at the ends.
pub(super) type WeightedPiece = ((f64, f64), (f64, f64));

/// Returns the wavelength of a grid point in nm.
fn grid_nm(i: usize) -> f64 {
    ULTRAVIOLET_FROM_NM + i as f64
}

impl Ultraviolet {
    /// No light.
    pub(super) const NONE: Self = Self { values: [0.0; STEPS + 1], lines: Vec::new() };

    /// Samples a function. If `narrow` is true, a value is the mean over 1 nm, so that narrow peaks
    /// keep their power.
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

    /// Samples a table. Returns `None` if the table holds its first value over the whole
    /// ultraviolet. The table is valid and has at least one sample.
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

    /// Returns the parts of spectral lines that lie in the ultraviolet, or `None` if there are
    /// none. The lines may overlap.
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
        on.map(LineSegment::density).sum()
    }

    pub(super) fn scaled(&self, factor: f64) -> Box<Self> {
        Box::new(Self {
            values: self.values.map(|value| value * factor),
            lines: self.lines.iter().map(|line| LineSegment { power: line.power * factor, ..*line }).collect(),
        })
    }
}

impl Spectrum {
    /// Returns the value at an ultraviolet wavelength in nm. Without data below the band, the value
    /// at the lower end of the band is held. The value is 0 below 300 nm and above 360 nm.
    #[cold]
    #[inline(never)]
    pub(super) fn ultraviolet_at(&self, nm: f64) -> f64 {
        if !(ULTRAVIOLET_FROM_NM..=BAND_NM.0).contains(&nm) {
            return 0.0;
        }
        self.ultraviolet_continuum_at(nm) + self.ultraviolet.as_ref().map_or(0.0, |part| part.lines_at(nm))
    }

    fn ultraviolet_continuum_at(&self, nm: f64) -> f64 {
        self.ultraviolet.as_ref().map_or_else(|| self.continuum_at(BAND_NM.0), |part| part.continuum_at(nm))
    }

    fn ultraviolet_lines(&self) -> &[LineSegment] {
        self.ultraviolet.as_ref().map_or(&[], |part| &part.lines)
    }

    /// Returns the spectrum without light below the band.
    #[must_use]
    pub(super) fn without_ultraviolet(self) -> Self {
        self.with_part_below(Some(Box::new(Ultraviolet::NONE)))
    }

    /// Combines the ultraviolet parts of spectra. `of` combines the values of the continua at a
    /// wavelength.
    fn combined(of: &dyn Fn(f64) -> f64, lines: Vec<LineSegment>) -> Option<Box<Ultraviolet>> {
        let mut part = Ultraviolet::sampled(of, false)?;
        part.lines = lines;
        Some(part)
    }

    /// Returns the ultraviolet part of a weighted sum. Returns `None` if no part has data below the
    /// band.
    #[cold]
    #[inline(never)]
    pub(super) fn ultraviolet_of_mix(parts: &[(f64, &Self)]) -> Option<Box<Ultraviolet>> {
        if parts.iter().all(|(_, part)| part.ultraviolet.is_none()) {
            return None;
        }
        let scaled = |(weight, part): &(f64, &Self)| part.ultraviolet.as_ref().map(|part| part.scaled(*weight).lines);
        let lines = parts.iter().filter_map(scaled).flatten().collect();
        let at = |nm| parts.iter().map(|(weight, part)| weight * part.ultraviolet_continuum_at(nm)).sum();
        Self::combined(&at, lines)
    }

    /// Returns the ultraviolet part of the product with another spectrum. Returns `None` if neither
    /// has data below the band.
    #[cold]
    #[inline(never)]
    pub(super) fn ultraviolet_of_product(&self, other: &Self) -> Option<Box<Ultraviolet>> {
        if self.ultraviolet.is_none() && other.ultraviolet.is_none() {
            return None;
        }
        let weighted = |line: &LineSegment, factor: f64| LineSegment { power: line.power * factor, ..*line };
        let own = self.ultraviolet_lines().iter().map(|line| weighted(line, other.ultraviolet_at(line.centre())));
        let theirs = other.ultraviolet_lines().iter();
        let theirs = theirs.map(|line| weighted(line, self.ultraviolet_continuum_at(line.centre())));
        let lines = own.chain(theirs).collect();
        Self::combined(&|nm| self.ultraviolet_continuum_at(nm) * other.ultraviolet_continuum_at(nm), lines)
    }

    /// Returns the ultraviolet part of 1 minus the continuum.
    pub(super) fn ultraviolet_of_complement(&self) -> Option<Box<Ultraviolet>> {
        self.ultraviolet.as_ref()?;
        Self::combined(&|nm| 1.0 - self.ultraviolet_continuum_at(nm), Vec::new())
    }

    /// Returns the spectrum with values below the band of at most 1 minus another continuum.
    #[must_use]
    pub fn limited_below_band(self, other: &Self) -> Self {
        let limited = |nm: f64| {
            let most = (1.0 - other.ultraviolet_continuum_at(nm)).max(0.0);
            self.ultraviolet_continuum_at(nm).min(most)
        };
        let part = Self::combined(&limited, Vec::new());
        self.with_part_below(part)
    }

    /// Returns the ultraviolet part without lines.
    pub(super) fn ultraviolet_continuum(&self) -> Option<Box<Ultraviolet>> {
        self.ultraviolet.as_ref().map(|part| Box::new(Ultraviolet { values: part.values, ..Ultraviolet::NONE }))
    }

    /// Returns the smallest and the largest value of the continuum below the band.
    pub fn ultraviolet_range(&self) -> (f64, f64) {
        let values = (0..=STEPS).map(|i| self.ultraviolet_continuum_at(grid_nm(i)));
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)))
    }

    /// Returns the sum of spectrum · weight over the whole nanometres from 300 to 359 nm and the
    /// lines. The weight is a function of the wavelength in nm.
    #[cold]
    #[inline(never)]
    pub fn ultraviolet_sum(&self, weight: &dyn Fn(f64) -> f64) -> f64 {
        let continuum = (0..STEPS).map(grid_nm).map(|nm| self.ultraviolet_continuum_at(nm) * weight(nm));
        let lines = self.ultraviolet_lines().iter().map(|line| line.power * weight(line.centre()));
        continuum.sum::<f64>() + lines.sum::<f64>()
    }

    /// Extends a density of wavelengths within the band to the ultraviolet. Below the band, the
    /// density is proportional to spectrum · weight. `band_mass` is the integral of spectrum ·
    /// weight over the band. The ultraviolet gets at most the share `most`. Returns `None` if the
    /// spectrum has no power.
    pub fn extended_wavelengths(
        &self,
        band: Option<&WavelengthDistribution>,
        band_mass: f64,
        weight: &dyn Fn(f64) -> f64,
        most: f64,
    ) -> Option<WavelengthDistribution> {
        WavelengthDistribution::with_ultraviolet(band, band_mass, &self.weighted_ultraviolet(weight), most)
    }

    /// Returns the pieces of spectrum · weight in the ultraviolet, in ascending order. A line is a
    /// narrow piece.
    fn weighted_ultraviolet(&self, weight: &dyn Fn(f64) -> f64) -> Vec<WeightedPiece> {
        let ends = self.ultraviolet_lines().iter().flat_map(|line| [line.nm.0, line.nm.1]);
        let mut cuts: Vec<f64> = (0..=STEPS).map(grid_nm).chain(ends).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let piece = |pair: &[f64]| {
            let line = self.ultraviolet.as_ref().map_or(0.0, |part| part.lines_at(0.5 * (pair[0] + pair[1])));
            let value = |nm: f64| (self.ultraviolet_continuum_at(nm) + line) * weight(nm);
            ((pair[0], pair[1]), (value(pair[0]), value(pair[1])))
        };
        cuts.windows(2).map(piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::SpectralLine;
    use super::*;

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} for {b}");
    }

    #[test]
    fn tables_hold_or_end_below_the_band() {
        let table = |from: f64, outside| Spectrum::table(&[from, 400.0], &[2.0, 4.0], outside).unwrap();
        near(table(320.0, Outside::Hold).at(310.0), 2.0);
        near(table(320.0, Outside::Zero).at(310.0), 0.0);
        near(table(320.0, Outside::Zero).at(340.0), 2.5);
        near(table(380.0, Outside::Hold).at(310.0), 2.0);
        near(table(380.0, Outside::Zero).at(310.0), 0.0);
        near(table(250.0, Outside::Zero).at(299.9), 0.0);
        near(Spectrum::constant(3.0).at(300.0), 3.0);
        near(Spectrum::power_law(350.0, 2.0, -4.0).unwrap().at(320.0), 2.0 * (350.0_f64 / 320.0).powi(4));
    }

    #[test]
    fn sums_and_products_have_an_ultraviolet_part() {
        let a = Spectrum::table(&[300.0, 400.0], &[1.0, 2.0], Outside::Hold).unwrap();
        let lines = [SpectralLine { nm: 312.6, power: 5.0, fwhm_nm: None }];
        let b = Spectrum::mix(&[(1.0, &Spectrum::constant(0.5)), (2.0, &Spectrum::lines(&lines).unwrap())]);
        near(b.ultraviolet_sum(&|_| 1.0), 30.0 + 10.0);
        near(
            a.product(&b).ultraviolet_sum(&|_| 1.0),
            10.0 * 1.126 + 0.5 * (0..60).map(|i| a.at(300.0 + f64::from(i))).sum::<f64>(),
        );
        near(a.complement().at(350.0), -0.5);
        near(b.scaled(3.0).ultraviolet_sum(&|_| 1.0), 120.0);
        near(b.continuum_only().ultraviolet_sum(&|_| 1.0), 30.0);
        near(b.integral(), 235.0);
    }

    /// Density and samples of a distribution over both parts belong together.
    #[test]
    fn extended_densities_are_normalised() {
        let lines = [SpectralLine { nm: 334.15, power: 20.0, fwhm_nm: None }];
        let light = Spectrum::mix(&[(1.0, &Spectrum::constant(1.0)), (1.0, &Spectrum::lines(&lines).unwrap())]);
        let band = WavelengthDistribution::new(&light).unwrap();
        let all = light.extended_wavelengths(Some(&band), light.integral(), &|_| 1.0, 0.5).unwrap();
        let (count, mut mean, mut below, mut last) = (100_000, 0.0, 0, 0.0);
        for i in 0..count {
            let (nm, pdf) = all.sample((f64::from(i) + 0.5) / f64::from(count));
            assert!(nm > last && pdf == all.pdf(nm), "{nm}");
            mean += light.at(nm) / pdf / f64::from(count);
            below += u32::from(nm < 360.0);
            last = nm;
        }
        assert!((mean - 550.0).abs() < 0.1, "{mean}");
        let share = (80.0_f64 / 550.0 * 1024.0).ceil() / 1024.0;
        assert!((f64::from(below) / f64::from(count) - share).abs() < 1e-4, "{below} for {share}");
        assert_eq!(light.extended_wavelengths(None, 0.0, &|_| 1.0, 0.5).unwrap().sample(0.999).0.floor(), 359.0);
    }
}
