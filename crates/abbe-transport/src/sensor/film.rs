//! The film: exact sums per pixel, separate for each replicate.

use super::channels::{Channels, band_nm};
use super::denoising::{self, DenoisingSums};
use super::diffraction::DiffractionPsf;
use super::error_bars::{ErrorBars, PictureErrors, PixelMeans};
use super::layers::{LayerSet, NameKind, NameLayer, PictureLayers};
use super::picture::{Picture, SpectralBands};
use super::pixel_sums::{PixelMean, PixelSums, passes_by_half, replicate};
use super::readings::{Measurement, Reading, ReadingLayout};
use super::sink::{ExposedRow, FilmRow, SplatSink};
use super::unit::FilmUnit;
use abbe_spectra::colour::xyz_to_linear_srgb;
use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::math::sum::ExactSum;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer};
use rayon::prelude::*;
use std::sync::Arc;

/// The sums of all pixels. Passes in any order give the same bits.
///
/// The memory is allocated when light is added first, after the pilot of a render, so that the
/// memory of the pilot and that of the film are not needed at the same time.
#[derive(Debug)]
pub struct Film {
    width: usize,
    height: usize,
    observer: &'static Observer,
    unit: FilmUnit,
    /// The sums of the pixels. Empty if the film is unexposed.
    pixels: Vec<PixelSums>,
    channels: Channels,
    /// The sums of the channels, pixel by pixel. Empty if the film is unexposed. Those of light are
    /// divided by the unit, those of surfaces are not.
    by_channel: Vec<ExactSum>,
    /// The sums for a denoiser, if the film has them. Empty if it has none or is unexposed.
    denoising: Vec<DenoisingSums>,
    /// The names that camera samples hit: one layer for each requested kind of names.
    names: Vec<NameLayer>,
    /// The data of a measurement with meters. `None` if the film records a picture.
    pub(super) measurement: Option<Measurement>,
    pub(super) passes: [u64; REPLICATES],
    /// True if the passes miss light of an unknown amount.
    misses_light: bool,
}

/// The index of the first plane of the bias, after X and Z.
const FIRST_BIAS: usize = 2;

const FIRST_Y: usize = FIRST_BIAS + 2;

const FIRST_CHANNEL: usize = FIRST_Y + REPLICATES;

impl Film {
    /// Returns an unexposed film with `bands` spectral bands.
    pub fn new(width: usize, height: usize, observer: &'static Observer, bands: usize) -> Self {
        Self {
            width,
            height,
            observer,
            unit: FilmUnit::default(),
            pixels: Vec::new(),
            channels: Channels { bands, ..Channels::default() },
            by_channel: Vec::new(),
            denoising: Vec::new(),
            names: Vec::new(),
            measurement: None,
            passes: [0; REPLICATES],
            misses_light: false,
        }
    }

    /// Sets the unit of the sums of a film that is still unexposed.
    #[must_use]
    pub fn with_unit(self, unit: FilmUnit) -> Self {
        Self { unit, ..self }
    }

    pub fn unit(&self) -> FilmUnit {
        self.unit
    }

    /// Adds diffraction to a film that is still unexposed.
    #[must_use]
    pub fn with_diffraction(mut self, diffraction: Option<Arc<DiffractionPsf>>) -> Self {
        self.channels.diffraction = diffraction;
        self
    }

    /// Adds layers to a film that is still unexposed.
    #[must_use]
    pub fn with_layers(mut self, layers: &LayerSet) -> Self {
        let pixels = self.pixel_count();
        self.names = layers.name_tables().map(|(kind, names)| NameLayer::new(kind, names, pixels)).collect();
        self.channels.layers = Some(layers.clone().into()).filter(|_| !layers.is_empty());
        self
    }

    /// Turns the unexposed film of the width 1 into a measurement. The layout covers its rows.
    #[must_use]
    pub fn with_readings(mut self, layout: Arc<ReadingLayout>) -> Self {
        self.channels.moments = layout.moments;
        let by_replicate = vec![0.0; self.pixel_count() * self.channels.band_channels() * REPLICATES];
        self.measurement = Some(Measurement { layout, by_replicate, independent_rows: false });
        self
    }

    fn allocate(&mut self) {
        if self.pixels.is_empty() {
            self.pixels = vec![PixelSums::default(); self.pixel_count()];
            self.by_channel = vec![ExactSum::default(); self.pixel_count() * self.channels.count()];
            let denoising = if self.channels.denoises() { self.pixel_count() } else { 0 };
            self.denoising = vec![DenoisingSums::default(); denoising];
        }
    }

    fn pixel_count(&self) -> usize {
        self.width * self.height
    }

    pub fn width(&self) -> usize {
        self.width
    }

    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns true if bands, slices or readings need the wavelength of each contribution.
    pub fn needs_wavelengths(&self) -> bool {
        self.channels.spectral_count() > 0 || self.measurement.is_some()
    }

    /// Returns true if the film records the first surfaces of camera rays in a pass.
    pub fn records_surfaces(&self, pass: u64) -> bool {
        let of_layers = self.channels.layers.as_ref().is_some_and(|layers| layers.has_surfaces());
        of_layers || (self.channels.denoises() && pass < denoising::SURFACE_PASSES)
    }

    /// Returns true if the film belongs to a measurement with meters.
    pub fn measures(&self) -> bool {
        self.measurement.is_some()
    }

    pub fn passes(&self) -> u64 {
        self.passes.iter().sum()
    }

    /// Counts also spectral bands, slices for diffraction, layers, and the light of a pass that is
    /// not yet added.
    pub fn memory_bytes(pixels: usize, bands: usize, slices: usize, layers: &LayerSet) -> usize {
        let channels = bands + 3 * slices + layers.planes();
        let names = layers.name_tables().count() * NameLayer::BYTES_PER_PIXEL;
        let denoising = if layers.denoising { size_of::<DenoisingSums>() } else { 0 };
        let sums = size_of::<PixelSums>() + channels * size_of::<ExactSum>() + names + denoising;
        pixels.saturating_mul(sums + ExposedRow::bytes_per_pixel(channels, layers.denoising))
    }

    /// Counts a pass. The light of the pass must already be added.
    pub fn count_pass(&mut self, pass: u64) {
        self.passes[replicate(pass)] += 1;
    }

    /// Returns rows that different threads can expose with [`FilmRow::expose`].
    pub fn rows(&mut self) -> impl Iterator<Item = FilmRow<'_>> {
        self.allocate();
        let (observer, width, channels) = (self.observer, self.width, &self.channels);
        let per_unit = self.unit.inverse();
        let mut by_channel = self.by_channel.chunks_mut((width * channels.count()).max(1));
        let mut denoising = self.denoising.chunks_mut(width);
        let mut names: Vec<_> = self.names.iter_mut().map(|layer| layer.rows(width)).collect();
        let bands = self.channels.band_channels() * REPLICATES;
        let (layout, mut by_replicate) = match &mut self.measurement {
            Some(measurement) => (Some(&measurement.layout), measurement.by_replicate.chunks_mut(bands.max(1))),
            None => (None, [].chunks_mut(1)),
        };
        self.pixels.chunks_mut(width).enumerate().map(move |(row, pixels)| FilmRow {
            first_pixel: row * width,
            replicate: 0,
            observer: layout.map_or(observer, |layout| layout.observer(row)),
            per_unit,
            by_replicate: by_replicate.next().unwrap_or_default(),
            pixels,
            by_channel: by_channel.next().unwrap_or_default(),
            channels,
            denoising: denoising.next().unwrap_or_default(),
            names: names.iter_mut().filter_map(|rows| rows.next()).collect(),
        })
    }

    /// Returns a sink for splats. A splat can contribute to any pixel of the film.
    pub fn splat_sink(&self) -> SplatSink {
        let layout = self.measurement.as_ref().map(|measurement| measurement.layout.clone());
        SplatSink::new(self.observer, self.channels.clone()).with_layout(layout)
    }

    /// Returns the number of samples that were NaN, infinite or negative and were discarded.
    pub fn add_splats(&mut self, pass: u64, sink: &SplatSink) -> u64 {
        self.allocate();
        let replicate = replicate(pass);
        let per_unit = self.unit.inverse();
        for &(xyz, pixel) in &sink.splats {
            let sums = &mut self.pixels[pixel as usize];
            let [x, y, z] = xyz.map(|value| per_unit * f64::from(value));
            sums.x += x;
            sums.y[replicate] += y;
            sums.z += z;
            self.denoising.get_mut(pixel as usize).into_iter().for_each(|own| own.add_light(pass, [x, z]));
        }
        let count = self.channels.count();
        for &(value, pixel, channel) in &sink.channel_splats {
            self.by_channel[pixel as usize * count + channel as usize] += per_unit * f64::from(value);
            let bands = self.channels.band_channels();
            if let Some(measurement) = self.measurement.as_mut().filter(|_| (channel as usize) < bands) {
                let place = (pixel as usize * REPLICATES + replicate) * bands + channel as usize;
                measurement.by_replicate[place] += f64::from(value);
            }
        }
        for &(bias, pixel) in &sink.bias_splats {
            self.pixels[pixel as usize].bias[replicate % 2] += per_unit * f64::from(bias);
        }
        sink.rejected
    }

    /// Adds the light of a sink to the bias, negative because the light is not part of the picture.
    pub fn add_truncated_splats(&mut self, pass: u64, sink: &SplatSink) {
        self.allocate();
        let half = replicate(pass) % 2;
        for &(xyz, pixel) in &sink.splats {
            self.pixels[pixel as usize].bias[half] += -self.unit.inverse() * f64::from(xyz[1]);
        }
    }

    /// Returns `X`, `Z`, the bias of both halves, Y of the replicates, the channels, and the
    /// entries of the lists of names.
    pub fn plane_names(&self) -> Vec<String> {
        let names = self.names.iter().flat_map(|layer| (0..layer.ranks()).map(|place| layer.kind.plane_name(place)));
        self.light_plane_names().into_iter().chain(names).collect()
    }

    /// Returns the first of [`Self::plane_names`], without names; they do not depend on the passes.
    pub fn light_plane_names(&self) -> Vec<String> {
        let replicates = (0..REPLICATES).map(|r| format!("Y{r}"));
        let first = ["X", "Z", "bias0", "bias1"].map(String::from);
        first.into_iter().chain(replicates).chain(self.channels.names()).chain(self.denoising_plane_names()).collect()
    }

    /// Yields the sums pixel by pixel, for an index into [`Self::plane_names`].
    pub fn plane(&self, plane: usize) -> impl Iterator<Item = ExactSum> {
        (0..self.pixel_count()).map(self.plane_sums(plane))
    }

    /// Returns a function of the pixel, for an index into [`Self::plane_names`].
    pub fn plane_sums(&self, plane: usize) -> impl Fn(usize) -> ExactSum {
        let count = self.channels.count();
        let first_denoising = FIRST_CHANNEL + count;
        let names =
            plane.checked_sub(first_denoising + self.denoising_planes()).and_then(|plane| self.list_of_names(plane));
        move |pixel| match plane {
            _ if let Some((layer, place)) = names => layer.pixels[pixel].to_sum(place),
            0 => self.sums_of(pixel).x,
            1 => self.sums_of(pixel).z,
            _ if plane < FIRST_Y => self.sums_of(pixel).bias[plane - FIRST_BIAS],
            _ if plane < FIRST_CHANNEL => self.sums_of(pixel).y[plane - FIRST_Y],
            _ if plane < first_denoising => self.channel_sum(pixel, plane - FIRST_CHANNEL),
            _ => self.denoising.get(pixel).map_or_else(ExactSum::default, |own| own.plane(plane - first_denoising)),
        }
    }

    /// Returns the list of a plane of names, and the place of its entries in the pixels' lists.
    fn list_of_names(&self, mut plane: usize) -> Option<(&NameLayer, usize)> {
        self.names.iter().find_map(|layer| {
            let ranks = layer.ranks();
            if plane < ranks {
                return Some((layer, plane));
            }
            plane -= ranks;
            None
        })
    }

    pub fn name_kinds(&self) -> Vec<NameKind> {
        self.names.iter().map(|layer| layer.kind).collect()
    }

    /// Adds the entries of a plane of names, pixel by pixel from the pixel `first`.
    pub fn add_names(&mut self, kind: NameKind, first: usize, entries: impl Iterator<Item = ExactSum>) {
        if let Some(layer) = self.names.iter_mut().find(|layer| layer.kind == kind) {
            layer.pixels.iter_mut().skip(first).zip(entries).for_each(|(names, entry)| names.add_sum(entry));
        }
    }

    /// Adds sums from the pixel `first` to a plane of [`Self::light_plane_names`].
    /// [`Self::add_names`] adds the others.
    pub fn add_plane(&mut self, plane: usize, first: usize, sums: impl Iterator<Item = ExactSum>) {
        self.allocate();
        let count = self.channels.count();
        for ((pixel, own), sum) in self.pixels.iter_mut().enumerate().skip(first).zip(sums) {
            let channel = plane.checked_sub(FIRST_CHANNEL);
            if let Some(plane) = channel.and_then(|channel| channel.checked_sub(count)) {
                self.denoising[pixel].add_to_plane(plane, sum);
                continue;
            }
            *match plane {
                0 => &mut own.x,
                1 => &mut own.z,
                _ if plane < FIRST_Y => &mut own.bias[plane - FIRST_BIAS],
                _ if plane < FIRST_CHANNEL => &mut own.y[plane - FIRST_Y],
                _ => &mut self.by_channel[pixel * count + plane - FIRST_CHANNEL],
            } += sum;
        }
    }

    /// Forgets the passes so far. Lists of names stay, which do not depend on the passes.
    pub fn clear(&mut self) {
        self.pixels.fill(PixelSums::default());
        self.by_channel.fill(ExactSum::default());
        self.denoising.fill(DenoisingSums::default());
        self.measurement.iter_mut().for_each(|measurement| measurement.by_replicate.fill(0.0));
        self.passes = [0; REPLICATES];
    }

    /// Returns the picture so far: means over the passes, with error bars.
    pub fn picture(&self) -> Picture {
        self.picture_and_errors().0
    }

    /// Returns also the parts of the squared relative errors, `None` if they are unknown.
    pub fn picture_and_errors(&self) -> (Picture, Option<PictureErrors>) {
        let (picture, errors) = self.picture_without_layers();
        (Picture { layers: self.layers(), ..picture }, errors)
    }

    /// Returns `None` if the error is unknown. For a measurement, both norms are the largest error
    /// of a reading.
    pub fn errors(&self) -> Option<PictureErrors> {
        match &self.measurement {
            Some(measurement) => {
                let largest = measurement.layout.largest_error(&self.readings());
                largest.map(|largest| PictureErrors { whole: largest, typical: largest, has_glints: false })
            }
            None => self.picture_without_layers().1,
        }
    }

    fn picture_without_layers(&self) -> (Picture, Option<PictureErrors>) {
        let passes = self.passes() as f64;
        let diffracted = self.channels.diffraction.as_deref().map(|diffraction| self.diffracted_light(diffraction));
        let light = |pixel: usize| diffracted.as_ref().map_or_else(|| self.light_of(pixel), |(light, _)| light[pixel]);
        let scale = LUMENS_PER_WATT / self.passes().max(1) as f64;
        let xyz: Vec<_> = (0..self.pixel_count()).map(|pixel| light(pixel).xyz.map(|sum| sum * scale)).collect();
        let (width, height) = (self.width, self.height);
        let mut picture = Picture { width, height, xyz, ..Picture::black(0, 0) };
        let bars = self.error_bars(light);
        let errors = bars.errors(&picture.xyz).filter(|_| !self.misses_light);
        (picture.noise, picture.bias, picture.edge) = (bars.noise, bars.bias, bars.edge);
        if self.misses_light {
            picture.bias.fill(None);
        }
        let bands = self.channels.bands;
        if bands > 0 {
            let centres_nm = SpectralBands::centres_nm(bands);
            let (from, to) = band_nm(0, bands);
            let scale = if passes > 0.0 { 1.0 / (passes * (to - from)) } else { 0.0 };
            let values = match diffracted {
                Some((_, values)) => values.into_iter().map(|value| (value * scale) as f32).collect(),
                None => (0..self.pixel_count() * bands)
                    .into_par_iter()
                    .map(|i| (self.channel(i / bands, i % bands) * scale) as f32)
                    .collect(),
            };
            picture.bands = Some(SpectralBands { centres_nm, values });
        }
        (picture, errors)
    }

    /// Returns the light of a spectral channel or a layer.
    fn channel(&self, pixel: usize, channel: usize) -> f64 {
        self.unit.value() * self.channel_sum(pixel, channel).value()
    }

    fn channel_sum(&self, pixel: usize, channel: usize) -> ExactSum {
        self.by_channel.get(pixel * self.channels.count() + channel).copied().unwrap_or_default()
    }

    fn layers(&self) -> PictureLayers {
        let mut layers = PictureLayers::default();
        let Some(set) = self.channels.layers.as_deref() else { return layers };
        let scale = LUMENS_PER_WATT / self.passes().max(1) as f64;
        let (light, surfaces) = (self.channels.spectral_count(), self.channels.first_surface_channel());
        let names = set.paths.iter().map(|name| format!("path.{name}"));
        let names = names.chain(set.light_groups.iter().map(|name| format!("light.{name}")));
        for (number, name) in names.enumerate() {
            let xyz = |pixel: usize| [0, 1, 2].map(|c| self.channel(pixel, light + 3 * number + c) * scale);
            let rgb: Vec<_> = (0..self.pixel_count()).map(|pixel| xyz_to_linear_srgb(xyz(pixel))).collect();
            layers.add_colours(&name, &rgb);
        }
        if set.stokes {
            self.add_stokes(&mut layers, light + set.stokes_channel());
        }
        let of_surface = |pixel: usize, channel: usize| self.channel_sum(pixel, surfaces + channel).value();
        layers.add_surfaces(set, self.pixel_count(), of_surface);
        for names in &self.names {
            layers.add_names(names, |pixel| of_surface(pixel, 0));
        }
        layers
    }

    fn sums_of(&self, pixel: usize) -> PixelSums {
        self.pixels.get(pixel).copied().unwrap_or_default()
    }

    fn light_of(&self, pixel: usize) -> PixelMean {
        self.sums_of(pixel).light(self.unit.value())
    }

    /// Returns the readings of a measurement so far. Returns none if the film records a picture.
    pub fn readings(&self) -> Vec<Reading> {
        let Some(measurement) = &self.measurement else { return Vec::new() };
        let rows = measurement.layout.rows;
        let sums = |number: usize| (number * rows..(number + 1) * rows).map(|row| self.light_of(row));
        let of_reading = |number| Reading::of_rows(sums(number), self.passes, measurement.independent_rows);
        (0..measurement.layout.readings.len()).map(of_reading).collect()
    }

    /// Declares that the rows of a reading share no random numbers. A film without meters ignores
    /// it.
    pub fn assume_independent_rows(&mut self) {
        self.measurement.iter_mut().for_each(|measurement| measurement.independent_rows = true);
    }

    /// Declares that the passes miss light of an unknown amount, so that the bias of a picture is
    /// unknown.
    pub fn assume_missing_light(&mut self) {
        self.misses_light = true;
    }

    pub fn misses_light(&self) -> bool {
        self.misses_light
    }

    /// Returns the number of passes of the even replicates and of the odd replicates.
    pub(super) fn passes_by_half(&self) -> [u64; 2] {
        passes_by_half(self.passes)
    }

    /// Returns the number of spectral bands, and the number of their channels.
    pub(super) fn bands(&self) -> (usize, usize) {
        (self.channels.bands, self.channels.band_channels())
    }

    fn error_bars(&self, light: impl Fn(usize) -> PixelMean) -> ErrorBars {
        let passes_by_half = self.passes_by_half();
        let mean = |sum: f64, passes: u64| sum * LUMENS_PER_WATT / passes.max(1) as f64;
        let measured = |pixel: usize| {
            let PixelMean { xyz, y, bias } = light(pixel);
            (xyz[1] > 0.0).then(|| PixelMeans {
                y: std::array::from_fn(|r| mean(y[r], self.passes[r])),
                bias: [0, 1].map(|half| mean(bias[half], passes_by_half[half])),
            })
        };
        ErrorBars::new((self.width, self.pixel_count()), measured, self.passes)
    }

    pub fn overflowed(&self) -> bool {
        let pixel = |p: &PixelSums| p.x.overflowed() || p.z.overflowed() || p.y.iter().any(|y| y.overflowed());
        self.pixels.iter().any(pixel) || self.by_channel.iter().any(|sum| sum.overflowed())
    }
}

mod denoised;
mod diffracted;
mod stokes;

#[cfg(test)]
mod tests;
