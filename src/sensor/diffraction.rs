//! Diffraction at the lens's opening: the picture of each slice of the spectrum is convolved with the pattern of its wavelengths.
//!
//! The pattern is Fraunhofer's, integrated over the squares of the pixels; light in a pixel counts as in its middle. Beyond its edges the film is
//! taken to go on as its mirror image, so that no light is lost there and an even picture stays even. Kernels are scaled to 1: energy is kept.

use crate::spectrum::BAND_NM;
use glam::DVec2;
use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection, FftPlanner};
use std::sync::Arc;

/// Slices of the whole band, of equal ratios of wavelength: 5 % each, so that a slice's patterns hardly differ in size.
const SLICES: usize = 16;

/// How many wavelengths' patterns make the kernel of a slice, at most.
const WAVELENGTHS: usize = 8;

/// The pattern is followed as far as this many λN, or as the film is wide; the little light beyond (of a round opening one part in 600) is
/// spread as the rest.
const REACH: f64 = 128.0;

/// Samples of the pattern to a λN: as many as this where few λN are followed, …
const MOST_STEPS: f64 = 24.0;

/// … and no more than this many from the middle to one end, 8 to a λN at least.
const MOST_SAMPLES: f64 = 1024.0;

/// How light of each wavelength spreads over the film.
#[derive(Debug)]
pub struct Diffraction {
    /// λN in pixels, for each nm of wavelength.
    spread_px_per_nm: f64,
    /// The light's wavelengths in nm, rising: each stands for an equal share.
    light_nm: Vec<f64>,
    /// Where the slices begin, in nm.
    edges_nm: Vec<f64>,
    /// Samples of the pattern to a λN.
    steps: f64,
    /// Samples of the pattern from one end to the other.
    across: usize,
    /// Rows from the bottom, columns from the left.
    pattern: Vec<f32>,
}

impl Diffraction {
    /// For light that has these wavelengths (nm, rising, at least one, each for an equal share of the light) and a pattern known at places
    /// to the right and up in units of λN, of which a nm of wavelength has `spread_px_per_nm` pixels; the film has `longest_px` on its
    /// longer side.
    pub fn new(
        spread_px_per_nm: f64,
        longest_px: usize,
        light_nm: Vec<f64>,
        pattern: impl Fn(DVec2) -> f64 + Sync,
    ) -> Self {
        let film = (longest_px as f64 + 1.0) / (light_nm[0] * spread_px_per_nm);
        let reach = REACH.min(film);
        let steps = MOST_STEPS.min(MOST_SAMPLES / reach);
        let half = (reach * steps).ceil();
        let across = 2 * half as usize + 1;
        let place = |sample: usize| (sample as f64 - half) / steps;
        let sample = |i: usize| pattern(DVec2::new(place(i % across), place(i / across))) as f32;
        // An opening's pattern is the same in opposite directions.
        let middle = across * across / 2;
        let mut pattern: Vec<f32> = (0..=middle).into_par_iter().map(sample).collect();
        pattern.extend_from_within(..middle);
        pattern[middle + 1..].reverse();
        let edges_nm = edges_nm(&light_nm);
        Self { spread_px_per_nm, light_nm, edges_nm, steps, across, pattern }
    }

    /// How many slices light of these wavelengths (nm, rising) falls into.
    pub fn slices_of(light_nm: &[f64]) -> usize {
        edges_nm(light_nm).len()
    }

    /// How many slices there are.
    pub(super) fn slices(&self) -> usize {
        self.edges_nm.len()
    }

    /// The slice of a wavelength.
    pub(super) fn slice_of(&self, nm: f64) -> usize {
        self.edges_nm.partition_point(|&edge| edge <= nm).saturating_sub(1)
    }

    /// The wavelengths in nm between which a slice lies.
    pub(super) fn slice_nm(&self, slice: usize) -> (f64, f64) {
        (self.edges_nm[slice], self.edges_nm.get(slice + 1).copied().unwrap_or(f64::INFINITY))
    }

    /// Wavelengths that stand for the light between two, `None` of which shines if the light has none there.
    fn between(&self, (from_nm, to_nm): (f64, f64)) -> Vec<f64> {
        let [first, end] = [from_nm, to_nm].map(|nm| self.light_nm.partition_point(|&light| light < nm));
        let light = &self.light_nm[first..end];
        let count = light.len().min(WAVELENGTHS);
        (0..count).map(|i| light[(2 * i + 1) * light.len() / (2 * count)]).collect()
    }
}

/// Where slices begin: only where light falls into the slice. What little light lies between counts to the slice before it, or the first.
fn edges_nm(light_nm: &[f64]) -> Vec<f64> {
    let ratio = (BAND_NM.1 / BAND_NM.0).ln() / SLICES as f64;
    let mut cells: Vec<i64> = light_nm.iter().map(|nm| ((nm / BAND_NM.0).ln() / ratio) as i64).collect();
    cells.dedup();
    cells.into_iter().map(|cell| BAND_NM.0 * (cell as f64 * ratio).exp()).collect()
}

/// A plane's Fourier transform, over the film and its mirror images.
pub(super) type Spectrum = Vec<Complex<f64>>;

/// Convolves planes of a film of one size.
pub(super) struct Convolution<'a> {
    diffraction: &'a Diffraction,
    width: usize,
    height: usize,
    /// Transforms of rows and of columns, there and back.
    rows: [Arc<dyn Fft<f64>>; 2],
    columns: [Arc<dyn Fft<f64>>; 2],
}

impl<'a> Convolution<'a> {
    pub(super) fn new(diffraction: &'a Diffraction, (width, height): (usize, usize)) -> Self {
        let mut planner = FftPlanner::new();
        let mut both = |length| [FftDirection::Forward, FftDirection::Inverse].map(|way| planner.plan_fft(length, way));
        let (rows, columns) = (both(2 * width), both(2 * height));
        Self { diffraction, width, height, rows, columns }
    }

    /// The transform of a plane, or of two: one in the real part, one in the imaginary part.
    pub(super) fn transform(&self, plane: impl Fn(usize) -> [f64; 2] + Sync) -> Spectrum {
        let mirrored = |i: usize, length: usize| if i < length { i } else { 2 * length - 1 - i };
        let value = |place: usize| {
            let (x, y) = (place % (2 * self.width), place / (2 * self.width));
            let [re, im] = plane(mirrored(y, self.height) * self.width + mirrored(x, self.width));
            Complex { re, im }
        };
        self.forward((0..4 * self.width * self.height).into_par_iter().map(value).collect())
    }

    /// The planes that a transform stands for.
    pub(super) fn planes(&self, mut spectrum: Spectrum) -> Vec<[f64; 2]> {
        let (width, height) = (2 * self.width, 2 * self.height);
        process(&self.columns[1], &mut spectrum);
        let mut plane = transposed(&spectrum, height);
        process(&self.rows[1], &mut plane);
        let scale = 1.0 / (width * height) as f64;
        let pixel = |i: usize| plane[i / self.width * width + i % self.width] * scale;
        (0..self.width * self.height).map(|i| [pixel(i).re, pixel(i).im]).collect()
    }

    /// The transform of the kernel of light between two wavelengths in nm.
    pub(super) fn kernel(&self, between_nm: (f64, f64)) -> Spectrum {
        let (width, height) = (2 * self.width, 2 * self.height);
        let mut kernel = vec![0.0; width * height];
        for nm in self.diffraction.between(between_nm) {
            let spread_px = nm * self.diffraction.spread_px_per_nm;
            let step_px = spread_px / self.diffraction.steps;
            let samples = self.diffraction.across;
            let (across, down) = (overlaps(step_px, samples, width), overlaps(-step_px, samples, height));
            let resampled = |(row, lines): (&[f32], &Overlaps)| {
                if lines.is_empty() {
                    return Vec::new();
                }
                let mut pixels = vec![0.0; width];
                for (&value, overlaps) in row.iter().zip(&across) {
                    overlaps.iter().for_each(|&(pixel, share)| pixels[pixel] += f64::from(value) * share);
                }
                pixels
            };
            let rows = self.diffraction.pattern.par_chunks(samples).zip(&down).map(resampled);
            let rows: Vec<Vec<f64>> = rows.collect();
            for (row, overlaps) in rows.iter().zip(&down) {
                for &(line, share) in overlaps {
                    let pixels = &mut kernel[line * width..(line + 1) * width];
                    pixels.iter_mut().zip(row).for_each(|(pixel, value)| *pixel += share * value);
                }
            }
        }
        let whole: f64 = kernel.iter().sum();
        if whole > 0.0 {
            kernel.iter_mut().for_each(|value| *value /= whole);
        } else {
            kernel[0] = 1.0;
        }
        self.forward(kernel.into_iter().map(Complex::from).collect())
    }

    /// Over rows, then over columns; the result is stored column by column.
    fn forward(&self, mut plane: Spectrum) -> Spectrum {
        process(&self.rows[0], &mut plane);
        let mut spectrum = transposed(&plane, 2 * self.width);
        process(&self.columns[0], &mut spectrum);
        spectrum
    }
}

/// Adds the product of two transforms, times a factor, to a sum.
pub(super) fn add_product(sum: &mut Spectrum, a: &Spectrum, b: &Spectrum) {
    sum.par_iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
}

fn process(fft: &Arc<dyn Fft<f64>>, lines: &mut Spectrum) {
    lines.par_chunks_mut(fft.len()).for_each(|line| fft.process(line));
}

/// Lines of `length` values become columns.
fn transposed(lines: &Spectrum, length: usize) -> Spectrum {
    let count = lines.len() / length;
    (0..lines.len()).into_par_iter().map(|i| lines[i % count * length + i / count]).collect()
}

/// Pixels that a sample of the pattern falls into, with its share in each.
type Overlaps = Vec<(usize, f64)>;

/// The pixels of each of the samples of a line of the pattern, whose step is as many pixels; between samples the pattern is linear. Pixels are counted from
/// the middle, modulo `period`, of which they fill all at most: no light comes from farther away than the film is wide.
fn overlaps(step_px: f64, samples: usize, period: usize) -> Vec<Overlaps> {
    let half = step_px.abs();
    // The share of a sample's triangle, of half-width 1, that lies below a place.
    let below = |x: f64| {
        let x = x.clamp(-1.0, 1.0);
        if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) }
    };
    let pixels = |sample: usize| {
        let middle = (sample as f64 - (samples / 2) as f64) * step_px;
        let [first, last] = [middle - half, middle + half].map(|edge| edge.round() as i64);
        let share = |pixel: i64| {
            let [from, to] = [-0.5, 0.5].map(|side| below((pixel as f64 + side - middle) / half));
            (pixel.rem_euclid(period as i64) as usize, half * (to - from))
        };
        let farthest = period as i64 / 2;
        (first.max(-farthest)..=last.min(farthest)).map(share).collect()
    };
    (0..samples).map(pixels).collect()
}
