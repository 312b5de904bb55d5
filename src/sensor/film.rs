//! The film: exact sums per pixel, separate for each replicate.

use super::channels::{Channels, band_nm};
use super::diffraction::{Convolution, DiffractionPsf, add_product};
use super::error_bars::{ErrorBars, ErrorSquares, PixelMeans};
use crate::math::random::REPLICATES;
use crate::math::sum::ExactSum;
use crate::sensor::picture::{Picture, SpectralBands};
use crate::spectrum::{LUMENS_PER_WATT, Observer};
use std::sync::Arc;

/// The sums of one pixel over all passes. They take 192 bytes. Each channel takes 16 more bytes.
#[derive(Debug, Clone, Copy, Default)]
struct PixelSums {
    x: ExactSum,
    z: ExactSum,
    /// Y of each replicate. The sum of the replicates is Y.
    y: [ExactSum; REPLICATES],
    /// The bias of Y as two sums: over the even replicates, and over the odd replicates. The two
    /// estimates have independent noise.
    bias: [ExactSum; 2],
}

/// The light of a pixel summed over all passes, in W/m²/sr. Each value is radiance times a
/// colour-matching function. Y is also given for each replicate.
#[derive(Debug, Clone, Copy)]
struct PixelLight {
    xyz: [f64; 3],
    y: [f64; REPLICATES],
    bias: [f64; 2],
}

impl PixelSums {
    fn light(&self) -> PixelLight {
        let y = self.y.map(|part| part.value());
        PixelLight {
            xyz: [self.x.value(), y.iter().sum(), self.z.value()],
            y,
            bias: self.bias.map(|half| half.value()),
        }
    }
}

/// The sums of all pixels. Adding passes in any order gives the same bits.
#[derive(Debug)]
pub struct Film {
    width: usize,
    height: usize,
    observer: &'static Observer,
    pixels: Vec<PixelSums>,
    channels: Channels,
    /// The sums of the channels, pixel by pixel.
    by_channel: Vec<ExactSum>,
    passes: [u64; REPLICATES],
}

/// The index of the first plane of the bias, after X and Z.
const FIRST_BIAS: usize = 2;

/// The index of the first plane of Y.
const FIRST_Y: usize = FIRST_BIAS + 2;

/// The index of the first plane of a channel.
const FIRST_CHANNEL: usize = FIRST_Y + REPLICATES;

/// Collects the light of one pixel in one pass.
#[derive(Debug)]
pub struct PixelSink<'f> {
    observer: &'static Observer,
    xyz: [f64; 3],
    bias_y: f64,
    channels: &'f Channels,
    by_channel: &'f mut [f64],
    rejected: u64,
}

/// Collects splats: the contributions of photons to pixels anywhere on the film.
#[derive(Debug)]
pub struct SplatSink {
    observer: &'static Observer,
    channels: Channels,
    splats: Vec<([f32; 3], u32)>,
    channel_splats: Vec<(f32, u32, u32)>,
    rejected: u64,
}

impl Film {
    /// Returns an unexposed film with `bands` spectral bands.
    pub fn new(width: usize, height: usize, observer: &'static Observer, bands: usize) -> Self {
        let pixels = vec![PixelSums::default(); width * height];
        let passes = [0; REPLICATES];
        let channels = Channels::default();
        Self { width, height, observer, pixels, channels, by_channel: Vec::new(), passes }
            .with_channels(Channels { bands, diffraction: None })
    }

    /// Adds this diffraction to the film. The film must still be unexposed.
    #[must_use]
    pub fn with_diffraction(self, diffraction: Option<Arc<DiffractionPsf>>) -> Self {
        let bands = self.channels.bands;
        self.with_channels(Channels { bands, diffraction })
    }

    fn with_channels(mut self, channels: Channels) -> Self {
        self.by_channel = vec![ExactSum::default(); self.pixels.len() * channels.count()];
        self.channels = channels;
        self
    }

    /// Returns the number of pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns true if the film has spectral bands or slices for diffraction.
    pub fn has_channels(&self) -> bool {
        self.channels.count() > 0
    }

    /// Returns the number of passes that the film has counted.
    pub fn passes(&self) -> u64 {
        self.passes.iter().sum()
    }

    /// Returns the memory of the sums in bytes, including spectral bands and slices for
    /// diffraction.
    pub fn memory_bytes(width: usize, height: usize, bands: usize, slices: usize) -> usize {
        let pixel = size_of::<PixelSums>() + (bands + 3 * slices) * size_of::<ExactSum>();
        width.saturating_mul(height).saturating_mul(pixel)
    }

    /// Returns X, Y and Z (W/m²/sr) of the light that `expose` adds to a pixel.
    pub fn measure(observer: &'static Observer, expose: impl FnOnce(&mut PixelSink<'_>)) -> [f64; 3] {
        let channels = Channels::default();
        let mut sink =
            PixelSink { observer, xyz: [0.0; 3], bias_y: 0.0, channels: &channels, by_channel: &mut [], rejected: 0 };
        expose(&mut sink);
        sink.xyz
    }

    /// Counts a pass. The light of the pass must already be added.
    pub fn count_pass(&mut self, pass: u64) {
        self.passes[replicate(pass)] += 1;
    }

    /// Returns the rows of the film. Each row can be exposed by a different thread with
    /// [`FilmRow::expose`].
    pub fn rows(&mut self) -> impl Iterator<Item = FilmRow<'_>> {
        let (observer, width, channels) = (self.observer, self.width, &self.channels);
        let mut by_channel = self.by_channel.chunks_mut((width * channels.count()).max(1));
        self.pixels.chunks_mut(width).enumerate().map(move |(row, pixels)| FilmRow {
            first_pixel: row * width,
            observer,
            pixels,
            by_channel: by_channel.next().unwrap_or_default(),
            channels,
        })
    }

    /// Returns a sink for splats. A splat can contribute to any pixel of the film.
    pub fn splat_sink(&self) -> SplatSink {
        SplatSink::new(self.observer, self.channels.clone())
    }

    /// Adds the light of a sink. Returns the number of samples that were NaN, infinite or negative
    /// and were discarded.
    pub fn add_splats(&mut self, pass: u64, sink: &SplatSink) -> u64 {
        let replicate = replicate(pass);
        for &(xyz, pixel) in &sink.splats {
            let sums = &mut self.pixels[pixel as usize];
            sums.x += f64::from(xyz[0]);
            sums.y[replicate] += f64::from(xyz[1]);
            sums.z += f64::from(xyz[2]);
        }
        let count = self.channels.count();
        for &(value, pixel, channel) in &sink.channel_splats {
            self.by_channel[pixel as usize * count + channel as usize] += f64::from(value);
        }
        sink.rejected
    }

    /// Adds the light of a sink to the estimated bias. The light is not part of the picture, so the
    /// bias is negative.
    pub fn add_lost_splats(&mut self, pass: u64, sink: &SplatSink) {
        let half = replicate(pass) % 2;
        for &(xyz, pixel) in &sink.splats {
            self.pixels[pixel as usize].bias[half] += -f64::from(xyz[1]);
        }
    }

    /// Returns the names of the planes of sums: `X`, `Z`, the bias of both halves, Y of the
    /// replicates, and the channels.
    pub fn plane_names(&self) -> Vec<String> {
        let replicates = (0..REPLICATES).map(|r| format!("Y{r}"));
        ["X", "Z", "bias0", "bias1"]
            .map(String::from)
            .into_iter()
            .chain(replicates)
            .chain(self.channels.names())
            .collect()
    }

    /// Returns the sums of one plane, pixel by pixel. `plane` is an index into
    /// [`Self::plane_names`].
    pub fn plane(&self, plane: usize) -> impl Iterator<Item = ExactSum> {
        let count = self.channels.count();
        (0..self.pixels.len()).map(move |pixel| match plane {
            0 => self.pixels[pixel].x,
            1 => self.pixels[pixel].z,
            _ if plane < FIRST_Y => self.pixels[pixel].bias[plane - FIRST_BIAS],
            _ if plane < FIRST_CHANNEL => self.pixels[pixel].y[plane - FIRST_Y],
            _ => self.by_channel[pixel * count + plane - FIRST_CHANNEL],
        })
    }

    /// Adds sums to one plane, pixel by pixel. `plane` is an index into [`Self::plane_names`].
    pub fn add_plane(&mut self, plane: usize, sums: impl Iterator<Item = ExactSum>) {
        let count = self.channels.count();
        for ((pixel, own), sum) in self.pixels.iter_mut().enumerate().zip(sums) {
            *match plane {
                0 => &mut own.x,
                1 => &mut own.z,
                _ if plane < FIRST_Y => &mut own.bias[plane - FIRST_BIAS],
                _ if plane < FIRST_CHANNEL => &mut own.y[plane - FIRST_Y],
                _ => &mut self.by_channel[pixel * count + plane - FIRST_CHANNEL],
            } += sum;
        }
    }

    /// Adds the passes of another film of the same size and bands.
    pub fn add(&mut self, other: &Self) {
        (0..self.plane_names().len()).for_each(|plane| self.add_plane(plane, other.plane(plane)));
        self.passes.iter_mut().zip(other.passes).for_each(|(own, more)| *own += more);
    }

    /// Returns the picture so far: means over the passes, with error bars.
    pub fn picture(&self) -> Picture {
        self.picture_and_error().0
    }

    /// Returns the picture so far, and the parts of the squared relative error of the picture. The
    /// parts are `None` if the error is unknown.
    pub fn picture_and_error(&self) -> (Picture, Option<ErrorSquares>) {
        let passes = self.passes() as f64;
        let mut picture = Picture::black(self.width, self.height);
        let diffracted = self.channels.diffraction.as_deref().map(|diffraction| self.diffracted_light(diffraction));
        let light =
            |pixel: usize| diffracted.as_ref().map_or_else(|| self.pixels[pixel].light(), |(light, _)| light[pixel]);
        let scale = LUMENS_PER_WATT / self.passes().max(1) as f64;
        picture.xyz.iter_mut().enumerate().for_each(|(pixel, xyz)| *xyz = light(pixel).xyz.map(|sum| sum * scale));
        let bars = self.error_bars(light);
        let squares = bars.squares(picture.mean_y());
        (picture.noise, picture.bias, picture.edge) = (bars.noise, bars.bias, bars.edge);
        let bands = self.channels.bands;
        if bands > 0 {
            let range_nm = (0..bands).map(|band| band_nm(band, bands));
            let centres_nm: Vec<f64> = range_nm.map(|(from, to)| 0.5 * (from + to)).collect();
            let (from, to) = band_nm(0, bands);
            let scale = if passes > 0.0 { 1.0 / (passes * (to - from)) } else { 0.0 };
            let values = match diffracted {
                Some((_, values)) => values.into_iter().map(|value| (value * scale) as f32).collect(),
                None => self.by_channel.iter().map(|sum| (sum.value() * scale) as f32).collect(),
            };
            picture.bands = Some(SpectralBands { centres_nm, values });
        }
        (picture, squares)
    }

    fn error_bars(&self, light: impl Fn(usize) -> PixelLight) -> ErrorBars {
        let half = |parity: usize| self.passes.iter().skip(parity).step_by(2).sum::<u64>();
        let passes_by_half = [half(0), half(1)];
        let mean = |sum: f64, passes: u64| sum * LUMENS_PER_WATT / passes.max(1) as f64;
        let measured = |pixel: usize| {
            let PixelLight { xyz, y, bias } = light(pixel);
            (xyz[1] > 0.0).then(|| PixelMeans {
                y: std::array::from_fn(|r| mean(y[r], self.passes[r])),
                bias: [0, 1].map(|half| mean(bias[half], passes_by_half[half])),
            })
        };
        ErrorBars::new((self.width, self.pixels.len()), measured, self.passes)
    }

    /// Returns the light of all pixels and their spectral bands after diffraction. Each slice and
    /// each band has its own kernel. The film stores the replicates and the bias only as sums of Y
    /// over all wavelengths. The function convolves these sums with a mean kernel: the mean of the
    /// kernels of all slices, weighted by the Y of each slice.
    fn diffracted_light(&self, diffraction: &DiffractionPsf) -> (Vec<PixelLight>, Vec<f64>) {
        let convolution = Convolution::new(diffraction, (self.width, self.height));
        let count = self.channels.count();
        let value = |pixel: usize, channel: usize| self.by_channel[pixel * count + channel].value();
        let blank = || vec![Default::default(); 4 * self.pixels.len()];
        let (mut xy, mut z, mut mean, mut whole) = (blank(), blank(), blank(), 0.0);
        for slice in 0..diffraction.slices() {
            let [of_x, of_y, of_z] = [0, 1, 2].map(|component| self.channels.of_slice(slice, component));
            let kernel = convolution.kernel(diffraction.slice_nm(slice));
            add_product(&mut xy, &kernel, &convolution.transform(|pixel| [value(pixel, of_x), value(pixel, of_y)]));
            add_product(&mut z, &kernel, &convolution.transform(|pixel| [value(pixel, of_z), 0.0]));
            let y = (0..self.pixels.len()).map(|pixel| value(pixel, of_y)).sum::<f64>().max(f64::MIN_POSITIVE);
            mean.iter_mut().zip(kernel).for_each(|(mean, kernel)| *mean += kernel * y);
            whole += y;
        }
        mean.iter_mut().for_each(|value| *value = *value * (1.0 / whole));
        let (xy, z) = (convolution.planes(xy), convolution.planes(z));
        let mut light: Vec<PixelLight> = self.pixels.iter().map(PixelSums::light).collect();
        // Rounding may give values slightly below 0.
        let positive = |value: f64| value.max(0.0);
        for ((light, xy), z) in light.iter_mut().zip(xy).zip(z) {
            light.xyz = [xy[0], xy[1], z[0]].map(positive);
        }
        let spread = |plane: &(dyn Fn(usize) -> [f64; 2] + Sync)| {
            let mut sum = blank();
            add_product(&mut sum, &mean, &convolution.transform(plane));
            convolution.planes(sum)
        };
        for replicate in (0..REPLICATES).step_by(2) {
            let both = spread(&|pixel| [0, 1].map(|next| self.pixels[pixel].y[replicate + next].value()));
            light
                .iter_mut()
                .zip(both)
                .for_each(|(light, both)| light.y[replicate..replicate + 2].copy_from_slice(&both));
        }
        let bias = spread(&|pixel| self.pixels[pixel].bias.map(|half| half.value()));
        light.iter_mut().zip(bias).for_each(|(light, bias)| light.bias = bias);
        let bands = self.channels.bands;
        let mut values = vec![0.0; bands * self.pixels.len()];
        for band in 0..bands {
            let mut sum = blank();
            let kernel = convolution.kernel(band_nm(band, bands));
            add_product(&mut sum, &kernel, &convolution.transform(|pixel| [value(pixel, band), 0.0]));
            let plane = convolution.planes(sum);
            values.iter_mut().skip(band).step_by(bands).zip(plane).for_each(|(to, from)| *to = positive(from[0]));
        }
        (light, values)
    }

    /// Returns whether any sum of light has overflowed its range.
    pub fn overflowed(&self) -> bool {
        let pixel = |p: &PixelSums| p.x.overflowed() || p.z.overflowed() || p.y.iter().any(|y| y.overflowed());
        self.pixels.iter().any(pixel) || self.by_channel.iter().any(|sum| sum.overflowed())
    }
}

/// Returns whether a sample is finite and not negative. Other values indicate a bug. The caller
/// counts and discards them.
#[inline]
fn is_valid_radiance(weight: f64) -> bool {
    let is_valid_radiance = (0.0..f64::INFINITY).contains(&weight);
    debug_assert!(is_valid_radiance, "a sample of {weight} W/m²/sr");
    is_valid_radiance
}

fn replicate(pass: u64) -> usize {
    (pass % REPLICATES as u64) as usize
}

/// One row of the film.
#[derive(Debug)]
pub struct FilmRow<'f> {
    /// The index of the first pixel of the row.
    pub first_pixel: usize,
    observer: &'static Observer,
    pixels: &'f mut [PixelSums],
    channels: &'f Channels,
    by_channel: &'f mut [ExactSum],
}

impl FilmRow<'_> {
    /// Exposes every pixel of the row in this pass: calls `expose(pixel, sink)` for each pixel. The
    /// light of the pixel is the light in the sink, divided by the number of camera samples.
    /// Returns the number of samples that were NaN, infinite or negative and were discarded.
    pub fn expose(&mut self, pass: u64, samples: u64, mut expose: impl FnMut(usize, &mut PixelSink<'_>)) -> u64 {
        let replicate = replicate(pass);
        let weight = 1.0 / samples as f64;
        let count = self.channels.count();
        let mut values = vec![0.0; count];
        let mut rejected = 0;
        for (column, sums) in self.pixels.iter_mut().enumerate() {
            values.fill(0.0);
            let mut sink = PixelSink {
                observer: self.observer,
                xyz: [0.0; 3],
                bias_y: 0.0,
                channels: self.channels,
                by_channel: &mut values,
                rejected: 0,
            };
            expose(self.first_pixel + column, &mut sink);
            sums.x += weight * sink.xyz[0];
            sums.y[replicate] += weight * sink.xyz[1];
            sums.z += weight * sink.xyz[2];
            sums.bias[replicate % 2] += weight * sink.bias_y;
            rejected += sink.rejected;
            let by_channel = &mut self.by_channel[column * count..(column + 1) * count];
            by_channel.iter_mut().zip(&values).for_each(|(sum, &value)| *sum += weight * value);
        }
        rejected
    }
}

impl PixelSink<'_> {
    fn add(&mut self, nm: f64, weight: f64) -> [f64; 3] {
        if !is_valid_radiance(weight) {
            self.rejected += 1;
            return [0.0; 3];
        }
        let bar = self.observer.xyz_bar(nm);
        (0..3).for_each(|c| self.xyz[c] += weight * bar[c]);
        if !self.by_channel.is_empty() {
            let by_channel = &mut *self.by_channel;
            self.channels
                .distribute(nm, weight, bar.map(|bar| weight * bar), |channel, value| by_channel[channel] += value);
        }
        bar
    }

    /// Adds radiance (W/m²/sr) at a wavelength in nm.
    pub fn radiance(&mut self, nm: f64, weight: f64) {
        self.add(nm, weight);
    }

    /// Adds a biased estimate of radiance at a wavelength (nm), and an estimate of the bias. Both
    /// estimates are in W/m²/sr.
    pub fn biased(&mut self, nm: f64, weight: f64, bias: f64) {
        let bar = self.add(nm, weight);
        if bias.is_finite() {
            self.bias_y += bias * bar[1];
        }
    }

    /// Adds the sum of many biased estimates. Each estimate of radiance (W/m²/sr) and of its bias
    /// is already multiplied by x̄, ȳ and z̄. The film must not have spectral channels, because
    /// these would need the wavelengths.
    pub fn respond(&mut self, xyz: [f64; 3], bias_xyz: [f64; 3]) {
        debug_assert!(self.by_channel.is_empty(), "spectral channels need wavelengths");
        if !xyz.into_iter().all(is_valid_radiance) {
            self.rejected += 1;
            return;
        }
        (0..3).for_each(|c| self.xyz[c] += xyz[c]);
        if bias_xyz[1].is_finite() {
            self.bias_y += bias_xyz[1];
        }
    }
}

impl SplatSink {
    fn new(observer: &'static Observer, channels: Channels) -> Self {
        Self { observer, channels, splats: Vec::new(), channel_splats: Vec::new(), rejected: 0 }
    }

    /// Adds radiance (W/m²/sr) at several wavelengths to a pixel. The iterator yields pairs of a
    /// wavelength (nm) and the radiance at that wavelength.
    pub fn splat(&mut self, pixel: u32, light: impl Iterator<Item = (f64, f64)>) {
        let mut xyz = [0.0; 3];
        for (nm, weight) in light {
            if !is_valid_radiance(weight) {
                self.rejected += 1;
                continue;
            }
            let bar = self.observer.xyz_bar(nm);
            (0..3).for_each(|c| xyz[c] += weight * bar[c]);
            let splats = &mut self.channel_splats;
            self.channels.distribute(nm, weight, bar.map(|bar| weight * bar), |channel, value| {
                splats.push((value as f32, pixel, channel as u32));
            });
        }
        self.splats.push((xyz.map(|c| c as f32), pixel));
    }

    /// Returns the pixel of each splat, and X, Y and Z in W/m²/sr.
    pub fn splats(&self) -> impl Iterator<Item = (u32, [f32; 3])> {
        self.splats.iter().map(|&(xyz, pixel)| (pixel, xyz))
    }

    /// Returns the number of collected splats.
    pub fn len(&self) -> usize {
        self.splats.len()
    }

    /// Returns whether no splats were collected.
    pub fn is_empty(&self) -> bool {
        self.splats.is_empty()
    }
}

#[cfg(test)]
mod tests;
