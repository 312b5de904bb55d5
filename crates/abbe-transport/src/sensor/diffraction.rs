//! Diffraction at the aperture stop: the picture of each slice of the spectrum is convolved with
//! the point spread function of its wavelengths.
//!
//! This is the Fraunhofer pattern of the stop, integrated over the pixel squares, as if all light
//! of a pixel were at its centre.

use super::convolution::MirroredPlanes;
pub(super) use super::convolution::{PlaneTransform, add_product};
use abbe_spectra::math::elementary::{exp, ln};
use abbe_spectra::spectrum::BAND_NM;
use glam::DVec2;
use rayon::prelude::*;

/// The slices of the whole band, each about 5 % wide, so the pattern hardly changes in size.
const SLICES_OF_BAND: usize = 16;

/// The most wavelengths in the kernel of a slice, each with a pattern.
const WAVELENGTHS_PER_KERNEL: usize = 8;

/// The largest radius of the pattern, in λN, unless the film is smaller. Beyond it is 1/600 of the
/// light of a round stop, which is distributed inside in proportion to the pattern.
const PATTERN_RADIUS: f64 = 128.0;

/// The most samples of the pattern per λN, as for small radii.
const MAX_SAMPLES_PER_UNIT: f64 = 24.0;

/// The most samples from the centre to an edge: 8 per λN for the largest radius.
const MAX_SAMPLES_PER_RADIUS: f64 = 1024.0;

/// The point spread function of the film as a function of wavelength.
#[derive(Debug)]
pub struct DiffractionPsf {
    /// The diffraction length λN in pixels, divided by the wavelength λ in nm. N is the f-number.
    spread_px_per_nm: f64,
    /// In ascending order. Each represents an equal fraction of the light.
    light_nm: Vec<f64>,
    /// The lower ends of the slices in nm.
    edges_nm: Vec<f64>,
    /// The number of samples of the pattern per λN.
    steps: f64,
    /// The number of samples of the pattern from edge to edge.
    across: usize,
    /// The samples of the pattern, with rows from the bottom and columns from the left.
    pattern: Vec<f32>,
}

impl DiffractionPsf {
    /// Samples the pattern.
    ///
    /// `light_nm` are wavelengths (at least one, ascending) that represent equal fractions of the
    /// light. `pattern` takes positions to the right and upwards in λN, which is λ ×
    /// `spread_px_per_nm` pixels for λ in nm. The longer side of the film has `longest_px` pixels.
    pub fn new(
        spread_px_per_nm: f64,
        longest_px: usize,
        light_nm: Vec<f64>,
        pattern: impl Fn(DVec2) -> f64 + Sync,
    ) -> Self {
        let film = (longest_px as f64 + 1.0) / (light_nm[0] * spread_px_per_nm);
        let pattern_radius = PATTERN_RADIUS.min(film);
        let steps = MAX_SAMPLES_PER_UNIT.min(MAX_SAMPLES_PER_RADIUS / pattern_radius);
        let half = (pattern_radius * steps).ceil();
        let across = 2 * half as usize + 1;
        let place = |sample: usize| (sample as f64 - half) / steps;
        let sample = |i: usize| pattern(DVec2::new(place(i % across), place(i / across))) as f32;
        // A Fraunhofer pattern is point-symmetric, so half of the samples suffice.
        let middle = across * across / 2;
        let mut pattern: Vec<_> = (0..middle + 1).into_par_iter().with_min_len(across).map(sample).collect();
        pattern.extend_from_within(..middle);
        pattern[middle + 1..].reverse();
        let edges_nm = edges_nm(&light_nm);
        Self { spread_px_per_nm, light_nm, edges_nm, steps, across, pattern }
    }

    /// Returns the number of slices that contain light of these ascending wavelengths (nm).
    pub fn slices_of(light_nm: &[f64]) -> usize {
        edges_nm(light_nm).len()
    }

    pub(super) fn slices(&self) -> usize {
        self.edges_nm.len()
    }

    pub(super) fn slice_of(&self, nm: f64) -> usize {
        self.edges_nm.partition_point(|&edge| edge <= nm).saturating_sub(1)
    }

    /// Returns the lower and upper wavelength of a slice in nm.
    pub(super) fn slice_nm(&self, slice: usize) -> (f64, f64) {
        (self.edges_nm[slice], self.edges_nm.get(slice + 1).copied().unwrap_or(f64::INFINITY))
    }

    /// Returns wavelengths that represent the light in an interval. Empty without power.
    fn between(&self, (from_nm, to_nm): (f64, f64)) -> Vec<f64> {
        let [first, end] = [from_nm, to_nm].map(|nm| self.light_nm.partition_point(|&light| light < nm));
        let light = &self.light_nm[first..end];
        let count = light.len().min(WAVELENGTHS_PER_KERNEL);
        (0..count).map(|i| light[(2 * i + 1) * light.len() / (2 * count)]).collect()
    }
}

/// Returns the lower ends of the slices that contain light. Light in a gap belongs to the slice
/// below it, and light below all slices to the first.
fn edges_nm(light_nm: &[f64]) -> Vec<f64> {
    let ratio = ln(BAND_NM.1 / BAND_NM.0) / SLICES_OF_BAND as f64;
    let mut cells: Vec<i64> = light_nm.iter().map(|nm| (ln(nm / BAND_NM.0) / ratio) as i64).collect();
    cells.dedup();
    cells.into_iter().map(|cell| BAND_NM.0 * exp(cell as f64 * ratio)).collect()
}

/// Convolves the planes of films of one size.
pub(super) struct Convolution<'a> {
    diffraction: &'a DiffractionPsf,
    planes: MirroredPlanes,
}

impl<'a> Convolution<'a> {
    pub(super) fn new(diffraction: &'a DiffractionPsf, size: (usize, usize)) -> Self {
        Self { diffraction, planes: MirroredPlanes::new(size) }
    }

    /// Transforms two real planes together, as the real and the imaginary part.
    pub(super) fn transform(&self, plane: impl Fn(usize) -> [f64; 2] + Sync) -> PlaneTransform {
        self.planes.transform(plane)
    }

    /// Returns the planes of a transform. This function is the inverse of `transform`.
    pub(super) fn planes(&self, spectrum: PlaneTransform) -> Vec<[f64; 2]> {
        self.planes.planes(spectrum)
    }

    /// Returns the transform of the kernel for light between two wavelengths in nm.
    pub(super) fn kernel(&self, between_nm: (f64, f64)) -> PlaneTransform {
        let (width, height) = self.planes.mirrored_size();
        let mut kernel = vec![0.0; width * height];
        for nm in self.diffraction.between(between_nm) {
            let spread_px = nm * self.diffraction.spread_px_per_nm;
            let step_px = spread_px / self.diffraction.steps;
            let samples = self.diffraction.across;
            let (across, down) = (overlaps(step_px, samples, width), overlaps(-step_px, samples, height));
            let resampled = |(row, lines): (&[f32], &SampleOverlaps)| {
                if lines.is_empty() {
                    return Vec::new();
                }
                let mut pixels = vec![0.0; width];
                for (&value, overlaps) in row.iter().zip(&across) {
                    overlaps.iter().for_each(|&(pixel, fraction)| pixels[pixel] += f64::from(value) * fraction);
                }
                pixels
            };
            let rows = self.diffraction.pattern.par_chunks(samples).zip(&down).map(resampled);
            let rows: Vec<Vec<f64>> = rows.collect();
            for (row, overlaps) in rows.iter().zip(&down) {
                for &(line, fraction) in overlaps {
                    let pixels = &mut kernel[line * width..(line + 1) * width];
                    pixels.iter_mut().zip(row).for_each(|(pixel, value)| *pixel += fraction * value);
                }
            }
        }
        self.planes.kernel(kernel)
    }
}

/// The pixels that overlap a sample of the pattern, and the fraction of the sample in each pixel.
type SampleOverlaps = Vec<(usize, f64)>;

/// Returns the overlaps of each sample along a line of the pattern, which is linear between
/// samples. `step_px` is the distance of samples in pixels, negative for the opposite order. Pixels
/// count from the centre modulo `period`. Overlaps farther than half a period, the width or height
/// of the film, are ignored: no light moves farther.
fn overlaps(step_px: f64, samples: usize, period: usize) -> Vec<SampleOverlaps> {
    let half = step_px.abs();
    // The integral of a triangle function from −∞ to x. The triangle has half-width 1 and area 1.
    let below = |x: f64| {
        let x = x.clamp(-1.0, 1.0);
        if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) }
    };
    let pixels = |sample: usize| {
        let middle = (sample as f64 - (samples / 2) as f64) * step_px;
        let [first, last] = [middle - half, middle + half].map(|edge| edge.round() as i64);
        let fraction = |pixel: i64| {
            let [from, to] = [-0.5, 0.5].map(|side| below((pixel as f64 + side - middle) / half));
            (pixel.rem_euclid(period as i64) as usize, half * (to - from))
        };
        let farthest = period as i64 / 2;
        (first.max(-farthest)..=last.min(farthest)).map(fraction).collect()
    };
    (0..samples).map(pixels).collect()
}
