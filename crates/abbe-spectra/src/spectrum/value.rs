//! A spectrum over the band: the sum of a piecewise-linear continuum and narrow lines.

use super::band::BAND_NM;
use super::continuum::{Continuum, LinearPiece};
use super::line::{LineSegment, Lines, MIN_WIDTH_NM, SpectralLine};
use super::planck::planck;
use super::smooth;
use super::sweep::{self, SpectrumParts};
use super::table::{self, Outside};
use super::ultraviolet::{BelowBand, Ultraviolet};
use crate::error::{Error, Result};
use crate::math::elementary::{exp, ln, powf};

/// The width of a peak in nm below which one sample per nm does not represent it well.
const NARROW_NM: f64 = 5.0;

/// A function of wavelength over the band 360–830 nm, such as power per nm, reflectance or
/// extinction: the sum of a piecewise-linear continuum, which may be discontinuous, and narrow
/// lines of exact power. Every integral is exact for it, and [`at`](Self::at) takes constant time.
///
/// It also has values from 300 to 360 nm, which matter only to fluorophores. Integrals, extremes
/// and products with colour-matching functions cover the band alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    continuum: Continuum,
    lines: Lines,
    /// The part of the continuum whose features are too narrow for a sum with one sample per nm.
    narrow: Option<Box<Continuum>>,
    /// True if a part of the spectrum was made from an RGB colour.
    upsampled: bool,
    /// The part below the band, or `None` if the value at the lower end of the band is held.
    ultraviolet: Option<Box<Ultraviolet>>,
}

impl Spectrum {
    /// Returns a spectrum with the same value everywhere in the band.
    pub fn constant(value: f64) -> Self {
        Self::from_continuum(Continuum::constant(value))
    }

    /// Builds a spectrum by linear interpolation of samples at the wavelengths `nm`, of which those
    /// outside the band give the values at its ends. Returns an error if the lists differ in length
    /// or are empty; if wavelengths do not ascend, occur twice or are not positive; if values are
    /// negative or not finite; or if there is only one sample of a spectrum that is 0 outside the
    /// table.
    pub fn table(nm: &[f64], values: &[f64], outside: Outside) -> Result<Self> {
        let continuum = table::continuum(nm, values, outside)?;
        let fine = table::is_fine(nm);
        let ultraviolet = Ultraviolet::of_table(nm, values, outside);
        let narrow = fine.then(|| Box::new(continuum.clone()));
        Ok(Self { narrow, ultraviolet, ..Self::from_continuum(continuum) })
    }

    /// Builds a spectrum from lines of exact power. Each line is a box of constant power per nm,
    /// 0.001 nm wide unless its width is given; overlapping boxes are added, and parts outside the
    /// band are cut off with their power. Returns an error if a wavelength is not positive, a power
    /// is negative or not finite, or a width is below 10⁻⁶ nm.
    pub fn lines(lines: &[SpectralLine]) -> Result<Self> {
        let ultraviolet = Ultraviolet::of_lines(Lines::below_band(lines));
        Ok(Self { lines: Lines::new(lines)?, ultraviolet, ..Self::constant(0.0) })
    }

    /// Returns the spectral radiance of a black body in W m⁻² sr⁻¹ nm⁻¹, or an error if the
    /// temperature (in K) is not positive and finite.
    pub fn blackbody(temperature_k: f64) -> Result<Self> {
        if !(temperature_k.is_finite() && temperature_k > 0.0) {
            let what = format!("a black body at {temperature_k} K");
            return Err(Error::input(what).expected("a positive temperature in K"));
        }
        Ok(Self::of_formula(|nm| planck(nm, temperature_k) * 1e-9))
    }

    /// Returns a Gaussian peak of height 1 with the centre `peak_nm` and the full width at half
    /// maximum `fwhm_nm`, or an error if the centre is not positive and finite, or the width is
    /// below 10⁻⁶ nm.
    pub fn gaussian(peak_nm: f64, fwhm_nm: f64) -> Result<Self> {
        if !(peak_nm.is_finite() && peak_nm > 0.0) {
            return Err(Error::input(format!("a peak at {peak_nm} nm")).expected("a positive wavelength in nm"));
        }
        if !(fwhm_nm.is_finite() && fwhm_nm >= MIN_WIDTH_NM) {
            let what = format!("a peak {fwhm_nm} nm wide");
            return Err(Error::input(what).expected(format!("a full width of at least {MIN_WIDTH_NM} nm")));
        }
        let sigma_nm = fwhm_nm / (8.0 * ln(2.0_f64)).sqrt();
        let shape = |nm: f64| exp(-0.5 * ((nm - peak_nm) / sigma_nm).powi(2));
        let knots: Vec<f64> = (-32..=32).map(|i| peak_nm + 0.25 * f64::from(i) * sigma_nm).collect();
        let pieces = smooth::sampled(&shape, &knots);
        let whole = BAND_NM.0 < peak_nm - 9.0 * sigma_nm && peak_nm + 9.0 * sigma_nm < BAND_NM.1;
        let area =
            if whole { sigma_nm * (2.0 * std::f64::consts::PI).sqrt() } else { smooth::integral_of(shape, &pieces) };
        let found = pieces.integral();
        let continuum = if found > 0.0 { pieces.scaled(area / found) } else { pieces };
        let narrow = (fwhm_nm < NARROW_NM).then(|| Box::new(continuum.clone()));
        let ultraviolet = Ultraviolet::sampled(&shape, narrow.is_some());
        Ok(Self { narrow, ultraviolet, ..Self::from_continuum(continuum) })
    }

    /// Returns the power law `value` · (λ/`reference_nm`)^`exponent`, such as Rayleigh scattering
    /// with the exponent −4. Returns an error if the reference is not positive, the value is
    /// negative, or the function is not finite over the band.
    pub fn power_law(reference_nm: f64, value: f64, exponent: f64) -> Result<Self> {
        let law = |nm: f64| value * powf(nm / reference_nm, exponent);
        if !(reference_nm.is_finite() && reference_nm > 0.0) {
            let what = format!("a power law with the reference {reference_nm} nm");
            return Err(Error::input(what).expected("a positive reference wavelength in nm"));
        }
        if !(value.is_finite() && value >= 0.0) {
            let what = format!("a power law with the value {value}");
            return Err(Error::input(what).expected("a finite value of 0 or more"));
        }
        if !(exponent.is_finite() && law(BAND_NM.0).is_finite() && law(BAND_NM.1).is_finite()) {
            let what = format!("a power law with the exponent {exponent}, which is not finite over the band");
            return Err(Error::input(what).expected("an exponent for which the power law is finite from 360 to 830 nm"));
        }
        Ok(Self::of_formula(law))
    }

    /// Returns the sum of spectra with weights that must be finite and not negative.
    pub fn mix(parts: &[(f64, &Self)]) -> Self {
        let mut sum = Self::constant(0.0);
        for (weight, part) in parts {
            let continuum = add(&sum.continuum, &part.continuum, *weight);
            let narrow = match (sum.narrow.take(), part.narrow.as_deref()) {
                (Some(so_far), Some(more)) => Some(Box::new(add(&so_far, more, *weight))),
                (None, Some(more)) => Some(Box::new(more.scaled(*weight))),
                (so_far, None) => so_far,
            };
            let mut segments = sum.lines.segments().to_vec();
            segments.extend(scaled_segments(&part.lines, *weight));
            let upsampled = sum.upsampled || (part.upsampled && *weight > 0.0);
            sum = Self { continuum, narrow, lines: Lines::from_segments(segments), upsampled, ultraviolet: None };
        }
        let below: Vec<_> = parts.iter().map(|(weight, part)| (*weight, part.below_band())).collect();
        Self { ultraviolet: Ultraviolet::of_mix(&below), ..sum }
    }

    /// Returns the spectrum multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            continuum: self.continuum.scaled(factor),
            lines: Lines::from_segments(scaled_segments(&self.lines, factor).collect()),
            narrow: self.narrow.as_ref().map(|narrow| Box::new(narrow.scaled(factor))),
            upsampled: self.upsampled,
            ultraviolet: self.ultraviolet.as_ref().map(|part| part.scaled(factor)),
        }
    }

    /// Returns the value at a wavelength in nm, which within a line includes its power per nm, and
    /// is 0 below 300 nm and above the band. At a discontinuity, it is the limit from the side of
    /// longer wavelengths, except at the end of a table, where it is the last sample.
    #[inline]
    pub fn at(&self, nm: f64) -> f64 {
        if !(nm >= BAND_NM.0 && nm <= BAND_NM.1) {
            return self.below_band().at(nm);
        }
        self.continuum.at(nm) + self.lines.at(nm)
    }

    /// Returns the integral over the band, in the unit of the value times nm.
    pub fn integral(&self) -> f64 {
        self.continuum.integral() + self.lines.segments().iter().map(|line| line.power).sum::<f64>()
    }

    /// Returns the exact integral of the product of two spectra over the band.
    pub fn product_integral(&self, other: &Self) -> f64 {
        sweep::product_integral([self.parts(), other.parts()])
    }

    /// Returns the largest value in the band, including the power per nm of lines.
    pub fn max(&self) -> f64 {
        self.extreme(f64::max)
    }

    /// Returns the least value in the band.
    pub fn min(&self) -> f64 {
        self.extreme(f64::min)
    }

    fn extreme(&self, of: fn(f64, f64) -> f64) -> f64 {
        let mut extreme = self.continuum.at(BAND_NM.0);
        if self.lines.segments().is_empty() {
            for piece in self.continuum.pieces() {
                extreme = of(extreme, of(piece.values.0, piece.values.1));
            }
            return extreme;
        }
        extreme = self.at(BAND_NM.0);
        sweep::sweep([self.parts()], |_, [(from, to)]| extreme = of(extreme, of(from, to)));
        extreme
    }

    /// Returns the value of a constant spectrum, or `None` if the value varies over the band.
    pub fn is_constant(&self) -> Option<f64> {
        self.continuum.is_constant().filter(|_| self.lines.segments().is_empty())
    }

    /// Returns the pieces of the continuum in ascending order.
    pub fn continuum(&self) -> impl ExactSizeIterator<Item = LinearPiece> + '_ {
        self.continuum.pieces()
    }

    /// Returns the lines in ascending order, without overlap.
    pub fn line_segments(&self) -> &[LineSegment] {
        self.lines.segments()
    }

    /// Returns the narrow part of the continuum: peaks narrower than 5 nm, and tables whose samples
    /// are closer than half a nm. A caller that sums one sample per nm must integrate it instead.
    pub(crate) fn narrow_part(&self) -> Option<Self> {
        self.narrow
            .as_ref()
            .map(|narrow| Self { narrow: self.narrow.clone(), ..Self::from_continuum((**narrow).clone()) })
    }

    /// Returns the fraction of the integral that lies in lines and in peaks narrower than 5 nm.
    pub fn line_fraction(&self) -> f64 {
        let narrow_lines = self.lines.segments().iter().filter(|line| line.nm.1 - line.nm.0 < NARROW_NM);
        // The narrow part also contains finely sampled tables. It counts only if most of its power
        // lies in a peak.
        let peaks = self.narrow.iter().map(|narrow| {
            let highest = narrow.pieces().map(|piece| piece.values.0.max(piece.values.1)).fold(0.0, f64::max);
            let area = narrow.integral();
            if area < 2.0 * NARROW_NM * highest { area } else { 0.0 }
        });
        let all = self.integral();
        if all > 0.0 { (narrow_lines.map(|line| line.power).sum::<f64>() + peaks.sum::<f64>()) / all } else { 0.0 }
    }

    /// Returns true if a part of the spectrum is a smooth estimate from the three numbers of an RGB
    /// colour.
    pub fn is_upsampled(&self) -> bool {
        self.upsampled
    }

    /// Copies the mark "made from an RGB colour" from `origin`.
    #[must_use]
    pub fn with_origin_of(self, origin: &Self) -> Self {
        Self { upsampled: origin.upsampled, ..self }
    }

    /// Returns the value of the continuum at a wavelength of the band, without lines.
    pub fn continuum_at(&self, nm: f64) -> f64 {
        self.continuum.at(nm)
    }

    /// Returns the spectrum without its lines.
    #[must_use]
    pub fn continuum_only(&self) -> Self {
        Self { lines: Lines::none(), ultraviolet: self.below_band().continuum_only(), ..self.clone() }
    }

    /// Builds a spectrum from line segments, adding the power per nm of overlapping ones.
    pub fn from_segments(segments: &[LineSegment]) -> Self {
        Self { lines: Lines::from_segments(segments.to_vec()), ..Self::constant(0.0) }
    }

    pub(super) fn upsampled(continuum: Continuum) -> Self {
        Self { upsampled: true, ..Self::from_continuum(continuum) }
    }

    pub(crate) fn from_continuum(continuum: Continuum) -> Self {
        Self { continuum, lines: Lines::none(), narrow: None, upsampled: false, ultraviolet: None }
    }

    pub(super) fn with_part_below(self, ultraviolet: Option<Box<Ultraviolet>>) -> Self {
        Self { ultraviolet, ..self }
    }

    pub(super) fn of_formula(function: impl Fn(f64) -> f64 + Sync) -> Self {
        let ultraviolet = Ultraviolet::sampled(&function, false);
        Self { ultraviolet, ..Self::from_continuum(smooth::sampled(&function, &[])) }
    }

    #[inline]
    pub(super) fn below_band(&self) -> BelowBand<'_> {
        BelowBand { part: self.ultraviolet.as_deref(), within: &self.continuum }
    }

    pub(crate) fn parts(&self) -> SpectrumParts<'_> {
        SpectrumParts { continuum: &self.continuum, lines: &self.lines }
    }
}

fn scaled_segments(lines: &Lines, factor: f64) -> impl Iterator<Item = LineSegment> + '_ {
    lines.segments().iter().map(move |line| LineSegment { power: line.power * factor, ..*line })
}

/// Returns a + weight · b.
fn add(a: &Continuum, b: &Continuum, weight: f64) -> Continuum {
    let lines = &Lines::none();
    let mut pieces = Vec::new();
    sweep::sweep([a, b].map(|continuum| SpectrumParts { continuum, lines }), |nm, [(a0, a1), (b0, b1)]| {
        pieces.push(LinearPiece { nm, values: (a0 + weight * b0, a1 + weight * b1) });
    });
    Continuum::from_pieces(&pieces)
}
