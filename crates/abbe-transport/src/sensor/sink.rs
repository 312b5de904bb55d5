//! The sinks of a film: they collect the light of camera samples and of splats.

use super::channels::Channels;
use super::denoising::{DenoisingSums, SurfaceSums};
use super::first_surface::FirstSurface;
use super::layers::{NameKind, NameRow};
use super::pixel_sums::{PixelSums, replicate};
use super::readings::ReadingLayout;
use abbe_spectra::math::sum::ExactSum;
use abbe_spectra::spectrum::Observer;
use std::sync::Arc;

/// The number of pixels whose painted light is kept together.
const PIXELS_OF_BLOCK: usize = 128;

/// Collects the light of one pixel in one pass.
#[derive(Debug)]
pub struct PixelSink<'f> {
    observer: &'static Observer,
    pub(super) xyz: [f64; 3],
    bias_y: f64,
    channels: &'f Channels,
    by_channel: &'f mut [f64],
    /// The first channel of the polarisation, if the film records it.
    stokes_channel: Option<usize>,
    /// The objects and materials that the samples hit.
    hits: Vec<[usize; 2]>,
    /// The first surfaces of the samples, for a denoiser.
    surfaces: SurfaceSums,
    rejected: u64,
}

/// Collects splats: the contributions of photons to pixels anywhere on the film.
#[derive(Debug)]
pub struct SplatSink {
    observer: &'static Observer,
    channels: Channels,
    pub(super) splats: Vec<([f32; 3], u32)>,
    /// The number of the first splat that is a sum of painted light.
    first_painted: usize,
    pub(super) channel_splats: Vec<(f32, u32, u32)>,
    /// The sums of painted light in blocks of pixels. `None` for a block without light.
    painted: Vec<Option<Box<[f64]>>>,
    /// The biases of Y, and their pixels.
    pub(super) bias_splats: Vec<(f32, u32)>,
    /// The readings of the film, if it belongs to a measurement.
    layout: Option<Arc<ReadingLayout>>,
    /// The replicate of the pass.
    replicate: usize,
    pub(super) rejected: u64,
}

#[derive(Debug)]
pub struct FilmRow<'f> {
    pub first_pixel: usize,
    pub(super) observer: &'static Observer,
    /// The replicate of the pass.
    pub(super) replicate: usize,
    /// The inverse of the unit of the sums.
    pub(super) per_unit: f64,
    pub(super) pixels: &'f mut [PixelSums],
    pub(super) channels: &'f Channels,
    pub(super) by_channel: &'f mut [ExactSum],
    /// The bands of each replicate, if the film belongs to a measurement.
    pub(super) by_replicate: &'f mut [f64],
    /// The sums for a denoiser. Empty if the film has none.
    pub(super) denoising: &'f mut [DenoisingSums],
    pub(super) names: Vec<NameRow<'f>>,
}

/// The light of a row of the film in one pass, which is not yet added to the film.
#[derive(Debug)]
pub struct ExposedRow {
    /// X, Y, Z and the bias of Y, pixel by pixel.
    light: Vec<[f64; 4]>,
    /// The values of the channels, pixel by pixel.
    by_channel: Vec<f64>,
    /// The pixels and the objects and materials that their samples hit.
    hits: Vec<(u32, [usize; 2])>,
    /// The first surfaces of each pixel for a denoiser. Empty if the film has no sums for it.
    surfaces: Vec<SurfaceSums>,
    rejected: u64,
}

/// Returns whether a sample is finite and not negative. Others are bugs, and discarded.
#[inline]
fn is_valid_radiance(weight: f64) -> bool {
    let is_valid_radiance = (0.0..f64::INFINITY).contains(&weight);
    debug_assert!(is_valid_radiance, "a sample of {weight} W/m²/sr");
    is_valid_radiance
}

impl ExposedRow {
    /// Returns the bytes of a pixel without the hits, of which most renders have none.
    pub(super) fn bytes_per_pixel(channels: usize, denoising: bool) -> usize {
        let surfaces = if denoising { size_of::<SurfaceSums>() } else { 0 };
        size_of::<[f64; 4]>() + channels * size_of::<f64>() + surfaces
    }
}

impl FilmRow<'_> {
    /// Sets the pass in which the row is exposed.
    #[must_use]
    pub fn of_pass(self, pass: u64) -> Self {
        Self { replicate: replicate(pass), ..self }
    }

    /// Calls `expose(pixel, sink)`, which returns the camera samples of the pixel, for every pixel
    /// of the row. The light in the sink is divided by that number. The film does not change before
    /// [`Self::add`], so that a pass can end early without a trace.
    pub fn expose(&self, mut expose: impl FnMut(usize, &mut PixelSink<'_>) -> u64) -> ExposedRow {
        let surfaces = self.channels.first_surface_channel();
        let mut exposed = ExposedRow {
            light: Vec::with_capacity(self.pixels.len()),
            by_channel: vec![0.0; self.by_channel.len()],
            hits: Vec::new(),
            surfaces: Vec::with_capacity(self.denoising.len()),
            rejected: 0,
        };
        let mut by_channel = exposed.by_channel.chunks_mut(self.channels.count().max(1));
        for column in 0..self.pixels.len() {
            let values = by_channel.next().unwrap_or_default();
            let mut sink = PixelSink::new(self.observer, (self.channels, self.replicate), values);
            let weight = 1.0 / expose(self.first_pixel + column, &mut sink) as f64;
            let [x, y, z] = sink.xyz;
            exposed.light.push([x, y, z, sink.bias_y].map(|sum| weight * sum));
            exposed.rejected += sink.rejected;
            if !self.denoising.is_empty() {
                exposed.surfaces.push(sink.surfaces);
            }
            if !self.names.is_empty() {
                exposed.hits.extend(sink.hits.iter().map(|&hit| (column as u32, hit)));
            }
            // The means of surfaces divide by the number of samples, so their sums have no weight.
            values[..surfaces].iter_mut().for_each(|value| *value *= weight);
        }
        exposed
    }

    /// Adds the light of the row in a pass to the film. Returns the number of samples that were
    /// NaN, infinite or negative and were discarded.
    pub fn add(&mut self, pass: u64, exposed: &ExposedRow) -> u64 {
        let replicate = replicate(pass);
        for (sums, light) in self.pixels.iter_mut().zip(&exposed.light) {
            let [x, y, z, bias] = light.map(|sum| self.per_unit * sum);
            sums.x += x;
            sums.y[replicate] += y;
            sums.z += z;
            sums.bias[replicate % 2] += bias;
        }
        for (sums, (light, surfaces)) in self.denoising.iter_mut().zip(exposed.light.iter().zip(&exposed.surfaces)) {
            sums.add_light(pass, [light[0], light[2]].map(|sum| self.per_unit * sum));
            sums.add_surfaces(pass, surfaces);
        }
        let (count, surfaces) = (self.channels.count().max(1), self.channels.first_surface_channel());
        for (sums, values) in self.by_channel.chunks_mut(count).zip(exposed.by_channel.chunks(count)) {
            for (channel, (sum, &value)) in sums.iter_mut().zip(values).enumerate() {
                *sum += if channel < surfaces { self.per_unit * value } else { value };
            }
        }
        // The row of a measurement is one pixel.
        let bands = self.channels.band_channels();
        if let Some(sums) = self.by_replicate.get_mut(replicate * bands..(replicate + 1) * bands) {
            sums.iter_mut().zip(&exposed.by_channel).for_each(|(sum, &value)| *sum += value);
        }
        for NameRow { kind, hashes, pixels } in &mut self.names {
            for &(column, [object, material]) in &exposed.hits {
                let number = match kind {
                    NameKind::Object => object,
                    NameKind::Material => material,
                };
                pixels[column as usize].add(hashes[number], 1);
            }
        }
        exposed.rejected
    }
}

impl<'f> PixelSink<'f> {
    pub(super) fn new(
        observer: &'static Observer,
        (channels, replicate): (&'f Channels, usize),
        by_channel: &'f mut [f64],
    ) -> Self {
        Self {
            observer,
            xyz: [0.0; 3],
            bias_y: 0.0,
            channels,
            by_channel,
            stokes_channel: channels.stokes_channel(replicate),
            hits: Vec::new(),
            surfaces: SurfaceSums::default(),
            rejected: 0,
        }
    }

    /// Returns X, Y and Z (W/m²/sr) of each path class that `expose` adds to a pixel.
    pub fn measure_classes<const CLASSES: usize>(
        observer: &'static Observer,
        expose: impl FnOnce(&mut PixelSink<'_>),
    ) -> [[f64; 3]; CLASSES] {
        let channels = Channels::of_path_classes(CLASSES);
        let mut xyz = [[0.0; 3]; CLASSES];
        expose(&mut PixelSink::new(observer, (&channels, 0), xyz.as_flattened_mut()));
        xyz
    }

    #[inline]
    fn add(&mut self, origin: (usize, usize), nm: f64, weight: f64) -> [f64; 3] {
        if !is_valid_radiance(weight) {
            self.rejected += 1;
            return [0.0; 3];
        }
        let bar = self.observer.xyz_bar(nm);
        (0..3).for_each(|c| self.xyz[c] += weight * bar[c]);
        if !self.by_channel.is_empty() {
            self.add_to_channels(origin, nm, weight, bar);
        }
        bar
    }

    #[inline(never)]
    fn add_to_channels(&mut self, (class, light): (usize, usize), nm: f64, weight: f64, bar: [f64; 3]) {
        let (by_channel, xyz) = (&mut *self.by_channel, bar.map(|bar| weight * bar));
        self.channels.distribute(nm, weight, xyz, |channel, value| by_channel[channel] += value);
        let origin = (Some(class), Some(light));
        self.channels.distribute_to_layers(origin, xyz, |channel, value| by_channel[channel] += value);
    }

    /// Adds radiance (W/m²/sr) at a wavelength in nm. `origin` is the path class and the light.
    pub fn radiance(&mut self, origin: (usize, usize), nm: f64, weight: f64) {
        self.add(origin, nm, weight);
    }

    /// Adds radiance and its bias at a wavelength (nm), in W/m²/sr. See [`Self::radiance`].
    pub fn biased(&mut self, origin: (usize, usize), nm: f64, weight: f64, bias: f64) {
        let bar = self.add(origin, nm, weight);
        if bias.is_finite() {
            self.bias_y += bias * bar[1];
        }
    }

    /// Adds S1, S2 and S3 (W/m²/sr) at a wavelength (nm) in the frame of the picture. S0 is the
    /// radiance, which [`Self::radiance`] adds.
    pub fn stokes(&mut self, nm: f64, stokes: [f64; 3]) {
        let Some(first) = self.stokes_channel else { return };
        let bar = self.observer.xyz_bar(nm)[1];
        let sums = &mut self.by_channel[first..first + stokes.len()];
        sums.iter_mut().zip(stokes).for_each(|(sum, value)| *sum += if value.is_finite() { bar * value } else { 0.0 });
    }

    /// Adds the sum of many biased estimates of one path class, in W/m²/sr times x̄, ȳ and z̄, to a
    /// film without spectral channels, which would need the wavelengths.
    pub fn respond(&mut self, class: usize, xyz: [f64; 3], bias_xyz: [f64; 3]) {
        debug_assert!(self.channels.spectral_count() == 0, "spectral channels need wavelengths");
        if !xyz.into_iter().all(is_valid_radiance) {
            self.rejected += 1;
            return;
        }
        (0..3).for_each(|c| self.xyz[c] += xyz[c]);
        if !self.by_channel.is_empty() {
            self.respond_in_layers((Some(class), None), xyz);
        }
        if bias_xyz[1].is_finite() {
            self.bias_y += bias_xyz[1];
        }
    }

    #[inline]
    pub fn separates_lights(&self) -> bool {
        !self.by_channel.is_empty() && self.channels.separates_lights()
    }

    /// Adds a part of the next [`Self::respond`] to the layer of a light: the part of this light.
    pub fn respond_of_light(&mut self, light: usize, xyz: [f64; 3]) {
        self.respond_in_layers((None, Some(light)), xyz);
    }

    #[inline(never)]
    fn respond_in_layers(&mut self, origin: (Option<usize>, Option<usize>), xyz: [f64; 3]) {
        let by_channel = &mut *self.by_channel;
        self.channels.distribute_to_layers(origin, xyz, |channel, value| by_channel[channel] += value);
    }

    /// Adds the first surface of a camera sample. `None` means that the camera ray hits nothing.
    pub fn add_surface(&mut self, surface: Option<&FirstSurface>) {
        let first = self.channels.first_surface_channel();
        if let Some(layers) = &self.channels.layers {
            layers.add_surface(&mut self.by_channel[first..], surface);
        }
        if self.channels.denoises() {
            self.surfaces.add_sample(surface);
        }
        self.hits.extend(surface.map(|surface| [surface.object, surface.material]));
    }
}

impl SplatSink {
    pub(super) fn new(observer: &'static Observer, channels: Channels) -> Self {
        let (splats, channel_splats, painted, bias_splats) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self {
            observer,
            channels,
            splats,
            first_painted: 0,
            channel_splats,
            painted,
            bias_splats,
            layout: None,
            replicate: 0,
            rejected: 0,
        }
    }

    pub(super) fn with_layout(self, layout: Option<Arc<ReadingLayout>>) -> Self {
        Self { layout, ..self }
    }

    /// Sets the pass of the splats.
    #[must_use]
    pub fn of_pass(self, pass: u64) -> Self {
        Self { replicate: replicate(pass), ..self }
    }

    /// Adds pairs of a wavelength (nm) and of S1, S2 and S3; see [`PixelSink::stokes`].
    pub fn stokes(&mut self, pixel: u32, light: impl Iterator<Item = (f64, [f64; 3])>) {
        let Some(first) = self.channels.stokes_channel(self.replicate) else { return };
        let mut sums = [0.0; 3];
        for (nm, stokes) in light {
            let bar = self.observer.xyz_bar(nm)[1];
            (0..3).for_each(|c| sums[c] += bar * stokes[c]);
        }
        let sums = (first as u32..).zip(sums).filter(|(_, sum)| sum.is_finite());
        self.channel_splats.extend(sums.map(|(channel, sum)| (sum as f32, pixel, channel)));
    }

    fn observer_of(&self, pixel: u32) -> &'static Observer {
        self.layout.as_ref().map_or(self.observer, |layout| layout.observer(pixel as usize))
    }

    /// Adds pairs of a wavelength (nm) and the bias (W/m²/sr) there.
    pub fn bias(&mut self, pixel: u32, bias: impl Iterator<Item = (f64, f64)>) {
        let observer = self.observer_of(pixel);
        let sum: f64 = bias.map(|(nm, bias)| bias * observer.xyz_bar(nm)[1]).sum();
        if sum.is_finite() {
            self.bias_splats.push((sum as f32, pixel));
        }
    }

    /// Adds pairs of wavelength (nm) and radiance (W/m²/sr). `origin` is path class and light.
    pub fn splat(&mut self, origin: (usize, usize), pixel: u32, light: impl Iterator<Item = (f64, f64)>) {
        let mut xyz = [0.0; 3];
        let observer = self.observer_of(pixel);
        let splats = &mut self.channel_splats;
        for (nm, weight) in light {
            if !is_valid_radiance(weight) {
                self.rejected += 1;
                continue;
            }
            let bar = observer.xyz_bar(nm);
            (0..3).for_each(|c| xyz[c] += weight * bar[c]);
            self.channels.distribute(nm, weight, bar.map(|bar| weight * bar), |channel, value| {
                splats.push((value as f32, pixel, channel as u32));
            });
        }
        let (class, light) = origin;
        self.channels.distribute_to_layers((Some(class), Some(light)), xyz, |channel, value| {
            splats.push((value as f32, pixel, channel as u32));
        });
        self.splats.push((xyz.map(|c| c as f32), pixel));
    }

    /// Returns the number of spectral bands.
    pub fn bands(&self) -> usize {
        self.channels.bands
    }

    /// Adds radiance (W/m²/sr) at a wavelength (nm) to a sum for each pixel, which is cheaper than
    /// many splats. [`Self::gather_painted`] then makes one splat of each sum. The film must not
    /// belong to a measurement.
    #[inline]
    pub fn paint(&mut self, (class, light): (usize, usize), pixel: u32, nm: f64, weight: f64) {
        if !is_valid_radiance(weight) {
            self.rejected += 1;
            return;
        }
        let xyz = self.observer.xyz_bar(nm).map(|bar| weight * bar);
        let (block, within) = (pixel as usize / PIXELS_OF_BLOCK, pixel as usize % PIXELS_OF_BLOCK);
        if block >= self.painted.len() {
            self.painted.resize_with(block + 1, || None);
        }
        let channels = self.channels.first_surface_channel();
        let values = 3 + channels;
        let sums = self.painted[block].get_or_insert_with(|| vec![0.0; values * PIXELS_OF_BLOCK].into());
        let sums = &mut sums[values * within..values * (within + 1)];
        (0..3).for_each(|c| sums[c] += xyz[c]);
        if channels > 0 {
            let mut add = |channel: usize, value: f64| sums[3 + channel] += value;
            self.channels.distribute(nm, weight, xyz, &mut add);
            self.channels.distribute_to_layers((Some(class), Some(light)), xyz, &mut add);
        }
    }

    /// Makes splats of the sums of [`Self::paint`], which are the last splats of the sink.
    pub fn gather_painted(&mut self) {
        self.first_painted = self.splats.len();
        let values = 3 + self.channels.first_surface_channel();
        for (block, sums) in std::mem::take(&mut self.painted).iter().enumerate() {
            for (within, sums) in sums.iter().flat_map(|sums| sums.chunks_exact(values).enumerate()) {
                let pixel = (block * PIXELS_OF_BLOCK + within) as u32;
                let (xyz, channels) = sums.split_at(3);
                if xyz.iter().any(|&sum| sum > 0.0) {
                    self.splats.push(([xyz[0], xyz[1], xyz[2]].map(|c| c as f32), pixel));
                }
                let channels = (0..).zip(channels).filter(|(_, sum)| **sum != 0.0);
                self.channel_splats.extend(channels.map(|(channel, &sum)| (sum as f32, pixel, channel)));
            }
        }
    }

    /// Returns the pixel of each splat, X, Y and Z in W/m²/sr, and whether it is painted light.
    pub fn splats(&self) -> impl Iterator<Item = (u32, [f32; 3], bool)> {
        let numbered = self.splats.iter().enumerate();
        numbered.map(|(number, &(xyz, pixel))| (pixel, xyz, number >= self.first_painted))
    }

    pub fn len(&self) -> usize {
        self.splats.len()
    }

    pub fn is_empty(&self) -> bool {
        self.splats.is_empty()
    }
}
