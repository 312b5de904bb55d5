//! A spectrum: values over the band, as a continuum of linear pieces and narrow lines.

use super::continuum::{Continuum, Piece};
use super::line::{LineSegment, Lines, MIN_WIDTH_NM, SpectralLine};
use super::{BAND_NM, planck, smooth, sweep, table};
use crate::error::{Error, Result};

/// Peaks narrower than this, in nm, are not represented faithfully by samples every nm.
const NARROW_NM: f64 = 5.0;

/// What a table means beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// Nothing: the rule for lamps.
    Zero,
    /// Its end value: the rule for reflectances and for optical constants.
    Hold,
}

/// A function of wavelength over the band 360–830 nm: power per nm, reflectance, extinction, …
///
/// It is an exact piecewise-linear continuum, which may jump, plus narrow lines of exact power. Every integral over
/// it is exact for that function, and [`at`](Self::at) takes constant time.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Everything but the lines.
    continuum: Continuum,
    lines: Lines,
    /// The part of the continuum whose features are too narrow for sums over samples every nm.
    narrow: Option<Box<Continuum>>,
    /// Whether some of it was made from a colour.
    upsampled: bool,
}

impl Spectrum {
    /// The same value everywhere in the band.
    pub fn constant(value: f64) -> Self {
        Self::smooth(Continuum::constant(value))
    }

    /// Values at wavelengths in nm, linear in between. Samples beyond the band serve to interpolate at its ends.
    ///
    /// # Errors
    /// Lists of different lengths or without entries; wavelengths that do not ascend, occur twice or are not positive;
    /// values that are negative or not finite; a single sample of something that is zero elsewhere.
    pub fn table(nm: &[f64], values: &[f64], outside: Outside) -> Result<Self> {
        let continuum = table::continuum(nm, values, outside)?;
        let fine = table::is_fine(nm);
        Ok(Self { narrow: fine.then(|| Box::new(continuum.clone())), ..Self::smooth(continuum) })
    }

    /// Lines of exact power. Each is a box of constant density, 0.001 nm wide unless it says otherwise; where boxes
    /// overlap they add up; what lies outside the band is cut off with its share of the power.
    ///
    /// # Errors
    /// A wavelength that is not positive, a power that is negative or not finite, a width below 10⁻⁶ nm.
    pub fn lines(lines: &[SpectralLine]) -> Result<Self> {
        Ok(Self { lines: Lines::new(lines)?, ..Self::constant(0.0) })
    }

    /// The spectral radiance of a black body, in W m⁻² sr⁻¹ nm⁻¹.
    ///
    /// # Errors
    /// A temperature (in K) that is not positive and finite.
    pub fn blackbody(temperature_k: f64) -> Result<Self> {
        if !(temperature_k.is_finite() && temperature_k > 0.0) {
            let what = format!("a black body at {temperature_k} K");
            return Err(Error::input(what).expected("a positive temperature in K"));
        }
        Ok(Self::smooth(smooth::sampled(|nm| planck::planck(nm, temperature_k) * 1e-9, &[])))
    }

    /// A Gaussian peak of height 1, by its centre and its full width at half maximum, in nm.
    ///
    /// # Errors
    /// A centre that is not positive and finite, a width below 10⁻⁶ nm.
    pub fn gaussian(peak_nm: f64, fwhm_nm: f64) -> Result<Self> {
        if !(peak_nm.is_finite() && peak_nm > 0.0) {
            return Err(Error::input(format!("a peak at {peak_nm} nm")).expected("a positive wavelength in nm"));
        }
        if !(fwhm_nm.is_finite() && fwhm_nm >= MIN_WIDTH_NM) {
            let what = format!("a peak {fwhm_nm} nm wide");
            return Err(Error::input(what).expected(format!("a full width of at least {MIN_WIDTH_NM} nm")));
        }
        let sigma_nm = fwhm_nm / (8.0 * 2.0_f64.ln()).sqrt();
        let shape = |nm: f64| (-0.5 * ((nm - peak_nm) / sigma_nm).powi(2)).exp();
        let knots: Vec<f64> = (-32..=32).map(|i| peak_nm + 0.25 * f64::from(i) * sigma_nm).collect();
        let pieces = smooth::sampled(shape, &knots);
        let whole = BAND_NM.0 < peak_nm - 9.0 * sigma_nm && peak_nm + 9.0 * sigma_nm < BAND_NM.1;
        let area =
            if whole { sigma_nm * (2.0 * std::f64::consts::PI).sqrt() } else { smooth::integral_of(shape, &pieces) };
        let found = pieces.integral();
        let continuum = if found > 0.0 { pieces.scaled(area / found) } else { pieces };
        let narrow = (fwhm_nm < NARROW_NM).then(|| Box::new(continuum.clone()));
        Ok(Self { narrow, ..Self::smooth(continuum) })
    }

    /// A power of the wavelength: `value` · (λ/`reference_nm`)^`exponent` (Rayleigh scattering: −4).
    ///
    /// # Errors
    /// A reference that is not positive, a value that is negative, anything that is not finite over the band.
    pub fn power_law(reference_nm: f64, value: f64, exponent: f64) -> Result<Self> {
        let law = |nm: f64| value * (nm / reference_nm).powf(exponent);
        if !(reference_nm.is_finite() && reference_nm > 0.0) {
            let what = format!("a power law about {reference_nm} nm");
            return Err(Error::input(what).expected("a positive reference wavelength in nm"));
        }
        if !(value.is_finite() && value >= 0.0) {
            let what = format!("a power law of value {value}");
            return Err(Error::input(what).expected("a finite value of 0 or more"));
        }
        if !(exponent.is_finite() && law(BAND_NM.0).is_finite() && law(BAND_NM.1).is_finite()) {
            let what = format!("a power law with the exponent {exponent}, which overflows within the band");
            return Err(Error::input(what).expected("an exponent of ordinary size"));
        }
        Ok(Self::smooth(smooth::sampled(law, &[])))
    }

    /// The weighted sum of spectra; weights are finite and not negative.
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
            sum = Self { continuum, narrow, lines: Lines::from_segments(segments), upsampled };
        }
        sum
    }

    /// The spectrum times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            continuum: self.continuum.scaled(factor),
            lines: Lines::from_segments(scaled_segments(&self.lines, factor).collect()),
            narrow: self.narrow.as_ref().map(|narrow| Box::new(narrow.scaled(factor))),
            upsampled: self.upsampled,
        }
    }

    /// The value at a wavelength in nm: the continuum's, and within a line its power per nm besides. Outside the
    /// band it is 0; at a jump it is the value of the side of longer wavelengths, except that the last sample of a
    /// table belongs to the table.
    #[inline]
    pub fn at(&self, nm: f64) -> f64 {
        if !(nm >= BAND_NM.0 && nm <= BAND_NM.1) {
            return 0.0;
        }
        self.continuum.at(nm) + self.lines.at(nm)
    }

    /// The integral over the band, in the value's unit times nm.
    pub fn integral(&self) -> f64 {
        self.continuum.integral() + self.lines.segments().iter().map(|line| line.power).sum::<f64>()
    }

    /// The integral over the band of this spectrum times another, exact for pieces and lines alike.
    pub fn product_integral(&self, other: &Self) -> f64 {
        sweep::product_integral([self, other])
    }

    /// The largest value in the band, lines included with their power per nm.
    pub fn max(&self) -> f64 {
        self.extreme(f64::max)
    }

    /// The least value in the band.
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
        sweep::sweep([self], |_, [(from, to)]| extreme = of(extreme, of(from, to)));
        extreme
    }

    /// The value, if it is the same everywhere in the band.
    pub fn is_constant(&self) -> Option<f64> {
        self.continuum.is_constant().filter(|_| self.lines.segments().is_empty())
    }

    /// The pieces of the continuum, in order, from one end of the band to the other.
    pub fn continuum(&self) -> impl ExactSizeIterator<Item = Piece> + '_ {
        self.continuum.pieces()
    }

    /// The lines, in order and without overlap.
    pub fn line_segments(&self) -> &[LineSegment] {
        self.lines.segments()
    }

    /// The part of the continuum whose features are narrower than 5 nm, or samples closer than half a nm; sums over
    /// samples every nm must leave it to exact integration.
    pub fn narrow_part(&self) -> Option<Self> {
        self.narrow.as_ref().map(|narrow| Self { narrow: self.narrow.clone(), ..Self::smooth((**narrow).clone()) })
    }

    /// The share of the integral that lies in lines and peaks narrower than 5 nm, from 0 to 1.
    pub fn line_share(&self) -> f64 {
        let narrow_lines = self.lines.segments().iter().filter(|line| line.nm.1 - line.nm.0 < NARROW_NM);
        // The narrow part holds finely sampled tables too: those count if most of them is as narrow as a peak.
        let peaks = self.narrow.iter().map(|narrow| {
            let highest = narrow.pieces().map(|piece| piece.values.0.max(piece.values.1)).fold(0.0, f64::max);
            let area = narrow.integral();
            if area < 2.0 * NARROW_NM * highest { area } else { 0.0 }
        });
        let all = self.integral();
        if all > 0.0 { (narrow_lines.map(|line| line.power).sum::<f64>() + peaks.sum::<f64>()) / all } else { 0.0 }
    }

    /// Whether some of the spectrum was made from a colour: a smooth guess, of which only three numbers are known.
    pub fn is_upsampled(&self) -> bool {
        self.upsampled
    }

    /// The spectrum as one that was made from a colour if `origin` was.
    #[must_use]
    pub fn with_origin_of(self, origin: &Self) -> Self {
        Self { upsampled: origin.upsampled, ..self }
    }

    /// The continuum's value at a wavelength of the band, without lines.
    pub fn continuum_at(&self, nm: f64) -> f64 {
        self.continuum.at(nm)
    }

    /// The spectrum without its lines.
    #[must_use]
    pub fn continuum_only(&self) -> Self {
        Self { lines: Lines::none(), ..self.clone() }
    }

    /// A spectrum that consists of these segments; where some overlap their densities add up.
    pub(crate) fn of_segments(segments: &[LineSegment]) -> Self {
        Self { lines: Lines::from_segments(segments.to_vec()), ..Self::constant(0.0) }
    }

    pub(super) fn made_from_a_colour(continuum: Continuum) -> Self {
        Self { upsampled: true, ..Self::smooth(continuum) }
    }

    pub(crate) fn smooth(continuum: Continuum) -> Self {
        Self { continuum, lines: Lines::none(), narrow: None, upsampled: false }
    }

    pub(crate) fn continuum_part(&self) -> &Continuum {
        &self.continuum
    }

    pub(crate) fn lines_part(&self) -> &Lines {
        &self.lines
    }
}

fn scaled_segments(lines: &Lines, factor: f64) -> impl Iterator<Item = LineSegment> + '_ {
    lines.segments().iter().map(move |line| LineSegment { power: line.power * factor, ..*line })
}

/// a + weight · b.
fn add(a: &Continuum, b: &Continuum, weight: f64) -> Continuum {
    let (a, b) = (Spectrum::smooth(a.clone()), Spectrum::smooth(b.clone()));
    let mut pieces = Vec::new();
    sweep::sweep([&a, &b], |nm, [(a0, a1), (b0, b1)]| {
        pieces.push(Piece { nm, values: (a0 + weight * b0, a1 + weight * b1) });
    });
    Continuum::from_pieces(&pieces)
}
