//! Wavelength sampling: pdfs that follow a spectrum.

use super::band::BAND_NM;
use super::continuum::Continuum;
use super::index::BandIndex;
use super::observer::Observer;
use super::sweep::sweep;
use super::ultraviolet::WeightedPiece;
use super::value::Spectrum;

/// The fraction of the pdf of [`WavelengthDistribution::visually_weighted`] that follows the power
/// times the visual response. The rest follows the power alone.
const VISUAL_WEIGHT: f64 = 0.85;

/// The least distance of a sampled wavelength from both ends of a segment, as a fraction of its
/// width, where the pdf is almost 0 at one end.
const END_GUARD: f64 = 1e-6;

/// The distance, in nm, between samples of the tabulated visual response: small enough for
/// importance sampling, and large enough for the table to stay in the first-level cache.
const VISUAL_STEP_NM: u32 = 5;

/// The least number of guide steps per segment, with which most samples need no search.
const GUIDE_STEPS_PER_SEGMENT: usize = 4;

/// A segment of the band in which the pdf is linear, stored so that sampling needs no divisions.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PdfSegment {
    lower: f64,
    /// The largest number below the upper end.
    last: f64,
    width: f64,
    per_width: f64,
    /// The pdf per nm at the lower end, and its increase to the upper end.
    pdf_per_nm: f64,
    rise: f64,
    /// The probability of all lower segments, and the reciprocal of the probability of this one.
    before: f64,
    per_mass: f64,
}

/// A segment before normalisation: its ends in nm, the weights per nm at both ends, the mass of all
/// lower segments, and its own mass.
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
            // The limit prevents infinity for the smallest masses, whose product with 0 is NaN.
            per_mass: (total / part.mass).min(f64::MAX),
        }
    }

    /// Returns the probability of the segment below `nm`, which lies in the segment.
    #[inline]
    fn below(&self, nm: f64) -> f64 {
        let t = ((nm - self.lower) * self.per_width).clamp(0.0, 1.0);
        t * self.width * (self.pdf_per_nm + 0.5 * t * self.rise)
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
    fn of(&self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

/// A piecewise-linear pdf over wavelength, in 1/nm, with a knot at each knot of the spectrum and,
/// if it is visually weighted, at each sample of the visual response, every 5 nm. A spectral line
/// becomes a narrow segment with exactly its probability.
///
/// Because it is linear between knots, the pdf is not exactly the product of the spectrum and the
/// observer. An estimator that divides by it is still unbiased, because it is positive wherever the
/// spectrum is.
#[derive(Debug, Clone, PartialEq)]
pub struct WavelengthDistribution {
    /// Segments of positive probability in ascending order, with a pdf of 0 between them.
    segments: Vec<PdfSegment>,
    by_wavelength: BandIndex,
    /// The total probability below each segment. The last entry is infinity.
    before: Vec<f64>,
    /// The guide table: for each equal step of the total probability, whose number is a power of
    /// two, the segment that contains its lower end.
    guide: Vec<u32>,
}

impl WavelengthDistribution {
    /// Returns a pdf proportional to the spectrum, or `None` if the spectrum has no power.
    pub fn new(spectrum: &Spectrum) -> Option<Self> {
        let one = Spectrum::constant(1.0);
        Self::weighted(spectrum, &LinearWeight { function: &one, factor: 1.0, offset: 0.0 })
    }

    /// Returns a mixed pdf, or `None` if the spectrum has no power: 85 % is proportional to
    /// spectrum × (x̄ + ȳ + z̄), a response tabulated every 5 nm, and 15 % to the spectrum alone,
    /// so that every wavelength with power has a positive pdf.
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

    /// Returns a pdf that is proportional to spectrum · weight at the knots of both.
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

    /// Returns a pdf of `band`, of the weight `band_mass`, and of pieces below the band, whose
    /// weight is their integral, or `None` if nothing has power. The fraction below the band is at
    /// most `most`, and it is rounded up to a multiple of 1/1024, so that the edge between the
    /// parts lies between two cells of a table of photons.
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

    /// Joins the pieces below the band, whose integral is `ultraviolet` and whose fraction of the
    /// pdf is `fraction`, with the segments of a pdf within the band.
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

    /// Samples a wavelength from the random number `u` in [0, 1), and returns it in nm with its
    /// positive [`pdf`](Self::pdf) in 1/nm. The wavelength increases with `u`, so stratified values
    /// of `u` give stratified wavelengths.
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

    /// Returns the wavelengths (nm) between which the whole probability lies.
    pub fn support(&self) -> (f64, f64) {
        (self.segments[0].lower, self.segments[self.segments.len() - 1].last)
    }

    /// Returns the probability of the wavelengths below `nm`.
    #[inline]
    pub fn cdf(&self, nm: f64) -> f64 {
        if nm < self.segments[0].lower {
            return 0.0;
        }
        let segment = &self.segments[self.by_wavelength.find(nm, |i| self.segments[i].lower)];
        segment.before + segment.below(nm)
    }

    /// Returns the pdf in 1/nm at a wavelength in nm, which is 0 outside the band.
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
