//! The film: exact sums per pixel, kept apart by replicate.

use crate::math::random::REPLICATES;
use crate::math::sum::ExactSum;
use crate::sensor::picture::{Bands, Picture};
use crate::spectrum::{BAND_NM, LUMENS_PER_WATT, Observer};

/// One pixel's sums over all passes: 176 bytes, and 16 for each spectral band.
#[derive(Debug, Clone, Copy, Default)]
struct PixelSums {
    x: ExactSum,
    z: ExactSum,
    /// Y by replicate; their sum is Y.
    y: [ExactSum; REPLICATES],
    bias: ExactSum,
}

/// All pixels' sums. Adding passes in any order gives the same bits.
#[derive(Debug)]
pub struct Film {
    width: usize,
    height: usize,
    observer: &'static Observer,
    pixels: Vec<PixelSums>,
    band_count: usize,
    /// Band sums, pixel by pixel.
    bands: Vec<ExactSum>,
    passes: [u64; REPLICATES],
}

/// The first plane of Y, after X, Z and bias.
const FIRST_Y: usize = 3;

/// The first plane of a spectral band.
const FIRST_BAND: usize = FIRST_Y + REPLICATES;

/// Collects one pixel's light in one pass.
#[derive(Debug)]
pub struct PixelSink<'f> {
    observer: &'static Observer,
    xyz: [f64; 3],
    bias_y: f64,
    bands: &'f mut [f64],
    rejected: u64,
}

/// Collects light that photons bring to pixels all over the film.
#[derive(Debug)]
pub struct SplatSink {
    observer: &'static Observer,
    band_count: usize,
    splats: Vec<([f32; 3], u32)>,
    band_splats: Vec<(f32, u32, u32)>,
    rejected: u64,
}

/// The band number of a wavelength, of `count` equal bands over the simulated range.
fn band_of(nm: f64, count: usize) -> usize {
    let share = (nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0);
    ((share * count as f64) as usize).min(count - 1)
}

impl Film {
    /// An unexposed film.
    pub fn new(width: usize, height: usize, observer: &'static Observer, band_count: usize) -> Self {
        Self {
            width,
            height,
            observer,
            pixels: vec![PixelSums::default(); width * height],
            band_count,
            bands: vec![ExactSum::default(); width * height * band_count],
            passes: [0; REPLICATES],
        }
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// How many passes have been counted.
    pub fn passes(&self) -> u64 {
        self.passes.iter().sum()
    }

    /// Memory of the sums, in bytes.
    pub fn memory_bytes(width: usize, height: usize, band_count: usize) -> usize {
        let pixel = size_of::<PixelSums>() + band_count * size_of::<ExactSum>();
        width.saturating_mul(height).saturating_mul(pixel)
    }

    /// Counts a pass whose light has been added.
    pub fn count_pass(&mut self, pass: u64) {
        self.passes[replicate(pass)] += 1;
    }

    /// The rows of the film, each to be exposed by one worker: calls `expose(row, pixel in row, sink)` for its pixels through the
    /// returned slices.
    pub fn rows(&mut self) -> impl Iterator<Item = FilmRow<'_>> {
        let (observer, width, band_count) = (self.observer, self.width, self.band_count);
        let mut bands = self.bands.chunks_mut((width * band_count).max(1));
        self.pixels.chunks_mut(width).enumerate().map(move |(row, pixels)| FilmRow {
            first_pixel: row * width,
            observer,
            pixels,
            bands: bands.next().unwrap_or_default(),
            band_count,
        })
    }

    /// A sink for light that falls anywhere on the film.
    pub fn splat_sink(&self) -> SplatSink {
        SplatSink::new(self.observer, self.band_count)
    }

    /// Adds what a sink has collected. Returns how many contributions were dropped because they were no light.
    pub fn add_splats(&mut self, pass: u64, sink: &SplatSink) -> u64 {
        let replicate = replicate(pass);
        for &(xyz, pixel) in &sink.splats {
            let sums = &mut self.pixels[pixel as usize];
            sums.x += f64::from(xyz[0]);
            sums.y[replicate] += f64::from(xyz[1]);
            sums.z += f64::from(xyz[2]);
        }
        for &(weight, pixel, band) in &sink.band_splats {
            self.bands[pixel as usize * self.band_count + band as usize] += f64::from(weight);
        }
        sink.rejected
    }

    /// The names of the film's planes of sums: `X`, `Z`, `bias`, Y by replicate, the spectral bands.
    pub fn plane_names(&self) -> Vec<String> {
        let replicates = (0..REPLICATES).map(|r| format!("Y{r}"));
        let bands = (0..self.band_count).map(|band| format!("band{band}"));
        ["X", "Z", "bias"].map(String::from).into_iter().chain(replicates).chain(bands).collect()
    }

    /// The sums of one plane, by its place among the names, pixel by pixel.
    pub fn plane(&self, plane: usize) -> impl Iterator<Item = ExactSum> {
        (0..self.pixels.len()).map(move |pixel| match plane {
            0 => self.pixels[pixel].x,
            1 => self.pixels[pixel].z,
            2 => self.pixels[pixel].bias,
            _ if plane < FIRST_BAND => self.pixels[pixel].y[plane - FIRST_Y],
            _ => self.bands[pixel * self.band_count + plane - FIRST_BAND],
        })
    }

    /// Adds sums to one plane, by its place among the names, pixel by pixel.
    pub fn add_plane(&mut self, plane: usize, sums: impl Iterator<Item = ExactSum>) {
        for ((pixel, own), sum) in self.pixels.iter_mut().enumerate().zip(sums) {
            *match plane {
                0 => &mut own.x,
                1 => &mut own.z,
                2 => &mut own.bias,
                _ if plane < FIRST_BAND => &mut own.y[plane - FIRST_Y],
                _ => &mut self.bands[pixel * self.band_count + plane - FIRST_BAND],
            } += sum;
        }
    }

    /// Adds the passes of another film of the same size and bands.
    pub fn add(&mut self, other: &Self) {
        (0..self.plane_names().len()).for_each(|plane| self.add_plane(plane, other.plane(plane)));
        self.passes.iter_mut().zip(other.passes).for_each(|(own, more)| *own += more);
    }

    /// The picture so far: means over the passes, noise from the replicates, bias from the two kernels.
    pub fn develop(&self) -> Picture {
        let passes = self.passes() as f64;
        let scale = if passes > 0.0 { LUMENS_PER_WATT / passes } else { 0.0 };
        let mut picture = Picture::black(self.width, self.height);
        for (index, sums) in self.pixels.iter().enumerate() {
            let y: f64 = sums.y.iter().map(|part| part.value()).sum();
            picture.xyz[index] = [sums.x.value() * scale, y * scale, sums.z.value() * scale];
            let lit = y > 0.0;
            picture.noise[index] = match self.standard_error(sums) {
                Some(error) if lit => (error * LUMENS_PER_WATT) as f32,
                Some(_) | None => -1.0,
            };
            picture.bias[index] = if lit { (sums.bias.value() * scale) as f32 } else { -1.0 };
        }
        smooth_bias(&mut picture);
        if self.band_count > 0 {
            let width_nm = (BAND_NM.1 - BAND_NM.0) / self.band_count as f64;
            let scale = if passes > 0.0 { 1.0 / (passes * width_nm) } else { 0.0 };
            let values = self.bands.iter().map(|sum| (sum.value() * scale) as f32).collect();
            let centres_nm = (0..self.band_count).map(|i| BAND_NM.0 + (i as f64 + 0.5) * width_nm).collect();
            picture.bands = Some(Bands { centres_nm, values });
        }
        picture
    }

    /// The standard error of a pixel's mean Y (in units of W), from the means of the replicates that have passes; `None` with fewer than
    /// two. Unequal numbers of passes weigh accordingly.
    fn standard_error(&self, sums: &PixelSums) -> Option<f64> {
        let parts: Vec<(f64, f64)> = (0..REPLICATES)
            .filter(|&r| self.passes[r] > 0)
            .map(|r| (self.passes[r] as f64, sums.y[r].value() / self.passes[r] as f64))
            .collect();
        if parts.len() < 2 {
            return None;
        }
        let total: f64 = parts.iter().map(|(n, _)| n).sum();
        let mean = parts.iter().map(|(n, m)| n * m).sum::<f64>() / total;
        let spread: f64 = parts.iter().map(|(n, m)| n * (m - mean) * (m - mean)).sum();
        // Each replicate mean has variance σ²/n; Σ n (m − mean)² estimates (R − 1) σ², and the mean's variance is σ²/Σn.
        Some((spread / (parts.len() - 1) as f64 / total).sqrt())
    }

    /// Whether any sum ran out of range.
    pub fn overflowed(&self) -> bool {
        let pixel = |p: &PixelSums| p.x.overflowed() || p.z.overflowed() || p.y.iter().any(|y| y.overflowed());
        self.pixels.iter().any(pixel) || self.bands.iter().any(|sum| sum.overflowed())
    }
}

/// A single pixel's bias estimate is as noisy as the pixel; bias itself is smooth away from edges: average 5 × 5 neighbours. The
/// layer keeps its sign until here and is stored as a magnitude.
fn smooth_bias(picture: &mut Picture) {
    const REACH: usize = 2;
    let raw = picture.bias.clone();
    let known: Vec<bool> = picture.xyz.iter().map(|xyz| xyz[1] > 0.0).collect();
    let (width, height) = (picture.width, picture.height);
    for y in 0..height {
        for x in 0..width {
            let index = y * width + x;
            if !known[index] {
                continue;
            }
            let (mut sum, mut count) = (0.0, 0.0);
            for j in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
                for i in x.saturating_sub(REACH)..(x + REACH + 1).min(width) {
                    if known[j * width + i] {
                        sum += raw[j * width + i];
                        count += 1.0;
                    }
                }
            }
            picture.bias[index] = (sum / count).abs();
        }
    }
}

/// Whether a contribution is light: finite and not negative. What is not is a bug; it is counted, and never reaches a picture.
#[inline]
fn is_light(weight: f64) -> bool {
    let is_light = (0.0..f64::INFINITY).contains(&weight);
    debug_assert!(is_light, "a contribution of {weight} W/m²/sr");
    is_light
}

fn replicate(pass: u64) -> usize {
    (pass % REPLICATES as u64) as usize
}

/// One row of the film.
#[derive(Debug)]
pub struct FilmRow<'f> {
    /// The number of its first pixel.
    pub first_pixel: usize,
    observer: &'static Observer,
    pixels: &'f mut [PixelSums],
    bands: &'f mut [ExactSum],
    band_count: usize,
}

impl FilmRow<'_> {
    /// Exposes every pixel of the row in this pass by `expose(pixel, sink)`; returns how many contributions were dropped because they were no
    /// light.
    pub fn expose(&mut self, pass: u64, mut expose: impl FnMut(usize, &mut PixelSink<'_>)) -> u64 {
        let replicate = replicate(pass);
        let mut band_values = vec![0.0; self.band_count];
        let mut rejected = 0;
        for (column, sums) in self.pixels.iter_mut().enumerate() {
            band_values.fill(0.0);
            let mut sink =
                PixelSink { observer: self.observer, xyz: [0.0; 3], bias_y: 0.0, bands: &mut band_values, rejected: 0 };
            expose(self.first_pixel + column, &mut sink);
            sums.x += sink.xyz[0];
            sums.y[replicate] += sink.xyz[1];
            sums.z += sink.xyz[2];
            sums.bias += sink.bias_y;
            rejected += sink.rejected;
            let bands = &mut self.bands[column * self.band_count..(column + 1) * self.band_count];
            bands.iter_mut().zip(&band_values).for_each(|(sum, &value)| *sum += value);
        }
        rejected
    }
}

impl PixelSink<'_> {
    fn add(&mut self, nm: f64, weight: f64) -> [f64; 3] {
        if !is_light(weight) {
            self.rejected += 1;
            return [0.0; 3];
        }
        let bar = self.observer.xyz_bar(nm);
        (0..3).for_each(|c| self.xyz[c] += weight * bar[c]);
        if !self.bands.is_empty() {
            let band = band_of(nm, self.bands.len());
            self.bands[band] += weight;
        }
        bar
    }

    /// Adds radiance (W/m²/sr) at a wavelength.
    pub fn radiance(&mut self, nm: f64, weight: f64) {
        self.add(nm, weight);
    }

    /// Adds radiance found by density estimation, with its estimated bias.
    pub fn density(&mut self, nm: f64, weight: f64, bias: f64) {
        let bar = self.add(nm, weight);
        if bias.is_finite() {
            self.bias_y += bias * bar[1];
        }
    }
}

impl SplatSink {
    fn new(observer: &'static Observer, band_count: usize) -> Self {
        Self { observer, band_count, splats: Vec::new(), band_splats: Vec::new(), rejected: 0 }
    }

    /// Adds radiance (W/m²/sr) at several wavelengths to a pixel.
    pub fn splat(&mut self, pixel: u32, light: impl Iterator<Item = (f64, f64)>) {
        let mut xyz = [0.0; 3];
        for (nm, weight) in light {
            if !is_light(weight) {
                self.rejected += 1;
                continue;
            }
            let bar = self.observer.xyz_bar(nm);
            (0..3).for_each(|c| xyz[c] += weight * bar[c]);
            if self.band_count > 0 {
                self.band_splats.push((weight as f32, pixel, band_of(nm, self.band_count) as u32));
            }
        }
        self.splats.push((xyz.map(|c| c as f32), pixel));
    }

    /// How many splats were collected.
    pub fn len(&self) -> usize {
        self.splats.len()
    }

    /// Whether none were.
    pub fn is_empty(&self) -> bool {
        self.splats.is_empty()
    }
}
