//! Wavelength sampling: probability densities that follow a spectrum.

use super::band::BAND_NM;
use super::continuum::Continuum;
use super::index::BandIndex;
use super::observer::Observer;
use super::sweep::sweep;
use super::ultraviolet::WeightedPiece;
use super::value::Spectrum;

/// This share of the density of [`WavelengthDistribution::visually_weighted`] follows the product
/// of the power and the visual response. The other part of the density follows the power alone.
const VISUAL_WEIGHT: f64 = 0.85;

/// If the density is almost 0 at one end of a segment, every sampled wavelength has at least this
/// distance from both ends. The distance is a fraction of the width of the segment.
const END_GUARD: f64 = 1e-6;

/// The distance, in nm, between adjacent samples of the tabulated visual response. It is small
/// enough for importance sampling, and large enough for the table to stay in the first-level cache.
const VISUAL_STEP_NM: u32 = 5;

/// The guide table has at least this number of steps per segment. With four steps per segment, most
/// samples find their segment without a search.
const GUIDE_STEPS_PER_SEGMENT: usize = 4;

/// A segment of the band in which the density is a linear function of the wavelength. Reciprocals
/// are stored, so that sampling needs no divisions.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PdfSegment {
    lower: f64,
    /// The largest number below the upper end.
    last: f64,
    width: f64,
    per_width: f64,
    /// The density per nm at the lower end, and its increase from the lower to the upper end.
    pdf_per_nm: f64,
    rise: f64,
    /// The total probability of all lower segments, and the reciprocal of this segment's
    /// probability.
    before: f64,
    per_mass: f64,
}

/// A segment before normalisation. The fields are the ends of the segment in nm, the weights per nm
/// at both ends, the mass of all lower segments, and the mass of this segment.
struct UnscaledSegment {
    ends: (f64, f64),
    weights: (f64, f64),
    before: f64,
    mass: f64,
}

impl PdfSegment {
    fn new(part: &UnscaledSegment, total: f64) -> Self {
        let (lower, upper) = part.ends;
        let width = upper - lower;
        Self {
            lower,
            last: upper.next_down(),
            width,
            per_width: width.recip(),
            pdf_per_nm: part.weights.0 / total,
            rise: (part.weights.1 - part.weights.0) / total,
            before: part.before / total,
            // For the smallest masses, the quotient is infinite. The limit prevents a later product
            // of 0 and infinity, which would be NaN.
            per_mass: (total / part.mass).min(f64::MAX),
        }
    }

    #[inline]
    fn at(&self, nm: f64) -> f64 {
        self.pdf_per_nm + ((nm - self.lower) * self.per_width).min(1.0) * self.rise
    }

    /// Returns the wavelength below which the fraction `v` of the segment's mass lies.
    #[inline]
    fn quantile(&self, v: f64) -> f64 {
        let (from, to) = (self.pdf_per_nm, self.pdf_per_nm + self.rise);
        // This form of the root of the quadratic equation has no cancellation.
        let root = (from * from + v * (self.rise * (from + to))).max(0.0).sqrt();
        let mut t = v * (from + to) / (from + root);
        if from.min(to) < 1e-9 * from.max(to) {
            t = if t > 0.0 { t.clamp(END_GUARD, 1.0 - END_GUARD) } else { END_GUARD };
        }
        (self.lower + t * self.width).min(self.last)
    }
}

/// A weight of wavelengths: a linear function of a spectrum.
struct LinearWeight<'a> {
    function: &'a Spectrum,
    factor: f64,
    offset: f64,
}

impl LinearWeight<'_> {
    /// Returns the weight at a value of the spectrum.
    fn of(&self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

/// A piecewise-linear density over wavelength, in 1/nm. It has a knot at each knot of the spectrum
/// and, if it is visually weighted, at each sample of the visual response, every 5 nm. A spectral
/// line becomes a narrow segment, which has exactly the probability of the line.
///
/// The density is linear between knots, so it is not exactly the product of the spectrum and the
/// observer. Nevertheless, an estimator that divides by the density is unbiased, because the
/// density is positive wherever the spectrum is positive.
#[derive(Debug, Clone, PartialEq)]
pub struct WavelengthDistribution {
    /// Segments of positive probability in ascending order. The density is 0 between them.
    segments: Vec<PdfSegment>,
    by_wavelength: BandIndex,
    /// The total probability below each segment. The last entry is infinity.
    before: Vec<f64>,
    /// The guide table: the segment that contains the lower end of each of the equal steps into
    /// which the interval [0, 1] of total probability is divided. The number of steps is a power of
    /// two.
    guide: Vec<u32>,
}

impl WavelengthDistribution {
    /// Returns a density proportional to the spectrum, or `None` if the spectrum has no power.
    pub fn new(spectrum: &Spectrum) -> Option<Self> {
        let one = Spectrum::constant(1.0);
        Self::weighted(spectrum, &LinearWeight { function: &one, factor: 1.0, offset: 0.0 })
    }

    /// Returns a mixed density, or `None` if the spectrum has no power. A share of 85 % is
    /// proportional to spectrum × (x̄ + ȳ + z̄). The response x̄ + ȳ + z̄ is tabulated every 5 nm.
    /// A share of 15 % is proportional to the spectrum alone, so that every wavelength with power
    /// has a positive density.
    pub fn visually_weighted(spectrum: &Spectrum, observer: &Observer) -> Option<Self> {
        let nm = (BAND_NM.0 as u32..=BAND_NM.1 as u32).step_by(VISUAL_STEP_NM as usize).map(f64::from);
        let knots: Vec<(f64, f64)> = nm.map(|nm| (nm, observer.sum_bar().at(nm))).collect();
        let visible_weight = Spectrum::from_continuum(Continuum::from_knots(&knots));
        let (all, visible) = (spectrum.integral(), spectrum.product_integral(&visible_weight));
        let ratio = all / visible;
        if ratio.is_finite() {
            let factor = VISUAL_WEIGHT * ratio;
            return Self::weighted(
                spectrum,
                &LinearWeight { function: &visible_weight, factor, offset: 1.0 - VISUAL_WEIGHT },
            );
        }
        Self::new(spectrum)
    }

    /// Returns a density that is proportional to spectrum · weight at the knots of the spectrum and
    /// of the weight.
    fn weighted(spectrum: &Spectrum, weight: &LinearWeight<'_>) -> Option<Self> {
        let peak = spectrum.max();
        if !(peak.is_finite() && peak > 0.0) {
            return None;
        }
        let mut parts = Vec::new();
        let mut total = 0.0;
        sweep([spectrum.parts(), weight.function.parts()], |(lower, upper), [power, function]| {
            let from = power.0 / peak * weight.of(function.0);
            let to = power.1 / peak * weight.of(function.1);
            let mass = (upper - lower) * (0.5 * from + 0.5 * to);
            if mass > 0.0 {
                parts.push(UnscaledSegment { ends: (lower, upper), weights: (from, to), before: total, mass });
                total += mass;
            }
        });
        (total > 0.0 && total.is_finite()).then(|| Self::normalised(&parts, total))
    }

    /// Returns a density with a share below the band, or `None` if nothing has power. `band` is
    /// the density within the band. Its weight is `band_mass`. Below the band, the density is
    /// proportional to the pieces. Their integral is their weight, but their share is at most
    /// `most`. The share is rounded up to a multiple of 1/1024. The edge between the two parts then
    /// lies between two cells of a table of photons.
    #[cold]
    #[inline(never)]
    pub(super) fn with_ultraviolet(
        band: Option<&Self>,
        band_mass: f64,
        pieces: &[WeightedPiece],
        most: f64,
    ) -> Option<Self> {
        const STEPS: f64 = 1024.0;
        let mass = |((from, to), values): &WeightedPiece| (to - from) * (0.5 * values.0 + 0.5 * values.1);
        let ultraviolet: f64 = pieces.iter().map(mass).sum();
        let Some(band) = band.filter(|_| ultraviolet > 0.0) else {
            let fraction = f64::from(u8::from(ultraviolet > 0.0));
            return if fraction > 0.0 { Self::of_pieces(pieces, &[], ultraviolet, fraction) } else { band.cloned() };
        };
        let fraction = ((STEPS * ultraviolet / (ultraviolet + band_mass)).ceil() / STEPS).min(most);
        Self::of_pieces(pieces, &band.segments, ultraviolet, fraction)
    }

    /// Joins the pieces below the band, whose integral is `ultraviolet` and whose share of the density
    /// is `fraction`, with the segments of a density within the band.
    fn of_pieces(pieces: &[WeightedPiece], band: &[PdfSegment], ultraviolet: f64, fraction: f64) -> Option<Self> {
        let scale = fraction / ultraviolet;
        let below = pieces.iter().map(|&(ends, values)| (ends, (scale * values.0, scale * values.1)));
        let within = band.iter().map(|segment| {
            let values = (segment.pdf_per_nm, segment.pdf_per_nm + segment.rise);
            let ends = (segment.lower, segment.last.next_up());
            (ends, ((1.0 - fraction) * values.0, (1.0 - fraction) * values.1))
        });
        let (mut parts, mut total) = (Vec::new(), 0.0);
        for (ends, weights) in below.chain(within) {
            let mass = (ends.1 - ends.0) * (0.5 * weights.0 + 0.5 * weights.1);
            if mass > 0.0 {
                parts.push(UnscaledSegment { ends, weights, before: total, mass });
                total += mass;
            }
        }
        (total > 0.0 && total.is_finite()).then(|| Self::normalised(&parts, total))
    }

    fn normalised(parts: &[UnscaledSegment], total: f64) -> Self {
        let segments: Vec<PdfSegment> = parts.iter().map(|part| PdfSegment::new(part, total)).collect();
        let before: Vec<f64> = segments.iter().map(|segment| segment.before).chain([f64::INFINITY]).collect();
        let steps = (GUIDE_STEPS_PER_SEGMENT * segments.len()).next_power_of_two();
        let mut guide = Vec::with_capacity(steps);
        let mut segment = 0;
        for step in 0..steps {
            while before[segment + 1] <= step as f64 / steps as f64 {
                segment += 1;
            }
            guide.push(segment as u32);
        }
        let by_wavelength = BandIndex::new(segments.iter().map(|segment| segment.lower));
        Self { segments, by_wavelength, before, guide }
    }

    /// Samples a wavelength from the random number `u` in [0, 1). Returns the wavelength in nm and
    /// its density in 1/nm. The wavelength increases with `u`, so stratified values of `u` give
    /// stratified wavelengths. The density is positive and equals [`pdf`](Self::pdf) at the
    /// wavelength.
    #[inline(always)]
    pub fn sample(&self, u: f64) -> (f64, f64) {
        // The product is exact because the number of steps is a power of two.
        let step = ((u * self.guide.len() as f64) as usize).min(self.guide.len() - 1);
        let mut i = self.guide[step] as usize;
        while self.before[i + 1] <= u {
            i += 1;
        }
        let segment = &self.segments[i];
        let nm = segment.quantile(((u - segment.before) * segment.per_mass).clamp(0.0, 1.0));
        (nm, segment.at(nm))
    }

    /// Returns the density in 1/nm at a wavelength in nm, which is 0 outside the band.
    #[inline]
    pub fn pdf(&self, nm: f64) -> f64 {
        let first = self.segments[0].lower;
        let last = self.segments[self.segments.len() - 1].last;
        if !(nm >= first && nm <= last) {
            return 0.0;
        }
        let segment = &self.segments[self.by_wavelength.find(nm, |i| self.segments[i].lower)];
        if nm <= segment.last { segment.at(nm) } else { 0.0 }
    }
}
