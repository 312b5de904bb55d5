//! The methods of spectra that concern the ultraviolet.

use super::distribution::WavelengthDistribution;
use super::ultraviolet::{STEPS, Ultraviolet, WeightedPiece, grid_nm};
use super::value::Spectrum;

impl Spectrum {
    #[must_use]
    pub(super) fn without_ultraviolet(self) -> Self {
        self.with_part_below(Some(Box::new(Ultraviolet::NONE)))
    }

    /// Returns the spectrum with values below the band of at most 1 minus another continuum.
    #[must_use]
    pub fn limited_below_band(self, other: &Self) -> Self {
        let limited = |nm: f64| {
            let most = (1.0 - other.below_band().continuum_at(nm)).max(0.0);
            self.below_band().continuum_at(nm).min(most)
        };
        let part = Ultraviolet::combined(&limited, Vec::new());
        self.with_part_below(part)
    }

    /// Returns the smallest and the largest value of the continuum below the band.
    pub fn ultraviolet_range(&self) -> (f64, f64) {
        let values = (0..=STEPS).map(|i| self.below_band().continuum_at(grid_nm(i)));
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)))
    }

    /// Returns the sum of spectrum · weight (of nm) over whole nm from 300 to 359 and lines.
    #[cold]
    #[inline(never)]
    pub fn ultraviolet_sum(&self, weight: &dyn Fn(f64) -> f64) -> f64 {
        let continuum = (0..STEPS).map(grid_nm).map(|nm| self.below_band().continuum_at(nm) * weight(nm));
        let lines = self.below_band().lines().iter().map(|line| line.power * weight(line.centre()));
        continuum.sum::<f64>() + lines.sum::<f64>()
    }

    /// Extends a pdf of wavelengths within the band to the ultraviolet, proportionally to spectrum
    /// · weight. `band_mass` is the integral of spectrum · weight over the band, and the
    /// ultraviolet gets at most the fraction `most`. Returns `None` if the spectrum has no power.
    pub fn extended_wavelengths(
        &self,
        band: Option<&WavelengthDistribution>,
        band_mass: f64,
        weight: &dyn Fn(f64) -> f64,
        most: f64,
    ) -> Option<WavelengthDistribution> {
        WavelengthDistribution::with_ultraviolet(band, band_mass, &self.weighted_ultraviolet(weight), most)
    }

    /// Returns ascending pieces of spectrum · weight in the ultraviolet; lines are narrow ones.
    fn weighted_ultraviolet(&self, weight: &dyn Fn(f64) -> f64) -> Vec<WeightedPiece> {
        let ends = self.below_band().lines().iter().flat_map(|line| [line.nm.0, line.nm.1]);
        let mut cuts: Vec<f64> = (0..=STEPS).map(grid_nm).chain(ends).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let piece = |pair: &[f64]| {
            let line = self.below_band().lines_at(0.5 * (pair[0] + pair[1]));
            let value = |nm: f64| (self.below_band().continuum_at(nm) + line) * weight(nm);
            ((pair[0], pair[1]), (value(pair[0]), value(pair[1])))
        };
        cuts.windows(2).map(piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::line::SpectralLine;
    use super::super::table::Outside;
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

    #[test]
    fn extended_pdfs_are_normalised() {
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
        let fraction = (80.0_f64 / 550.0 * 1024.0).ceil() / 1024.0;
        assert!((f64::from(below) / f64::from(count) - fraction).abs() < 1e-4, "{below} for {fraction}");
        assert_eq!(light.extended_wavelengths(None, 0.0, &|_| 1.0, 0.5).unwrap().sample(0.999).0.floor(), 359.0);
    }
}
