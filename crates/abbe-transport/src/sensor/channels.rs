//! The additional channels of a film: spectral bands, slices of the spectrum with different
//! diffraction patterns, and layers.

use super::diffraction::DiffractionPsf;
use super::layers::{COMPONENTS, LayerSet};
use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::spectrum::BAND_NM;
use std::sync::Arc;

const COMPONENTS_OF_SLICE: usize = 3;

/// The additional channels of a pixel: radiance in each band, the first moments of the bands if
/// needed, X, Y and Z of each slice, of each path class and of each light group, and the sums over
/// first surfaces.
#[derive(Debug, Clone, Default)]
pub(super) struct Channels {
    pub(super) bands: usize,
    /// Each band also sums its radiance times the distance (nm) of the light from its centre.
    pub(super) moments: bool,
    pub(super) diffraction: Option<Arc<DiffractionPsf>>,
    /// The layers. `None` if the film records no layers.
    pub(super) layers: Option<Arc<LayerSet>>,
}

impl Channels {
    pub(super) fn of_path_classes(count: usize) -> Self {
        let paths = vec![String::new(); count];
        Self { layers: Some(Arc::new(LayerSet { paths, ..LayerSet::default() })), ..Self::default() }
    }

    pub(super) fn count(&self) -> usize {
        self.first_surface_channel() + self.layers.as_ref().map_or(0, |layers| layers.surface_channels().len())
    }

    /// Returns the number of channels that need the wavelength of each contribution.
    pub(super) fn spectral_count(&self) -> usize {
        self.band_channels() + COMPONENTS_OF_SLICE * self.slices()
    }

    pub(super) fn band_channels(&self) -> usize {
        if self.moments { 2 * self.bands } else { self.bands }
    }

    /// Returns the number of channels that contain light. The sums over first surfaces follow them.
    pub(super) fn first_surface_channel(&self) -> usize {
        self.spectral_count() + self.layers.as_ref().map_or(0, |layers| layers.light_channels())
    }

    fn slices(&self) -> usize {
        self.diffraction.as_ref().map_or(0, |diffraction| diffraction.slices())
    }

    pub(super) fn of_slice(&self, slice: usize, component: usize) -> usize {
        self.band_channels() + COMPONENTS_OF_SLICE * slice + component
    }

    /// Returns the names of the channels in their order.
    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        let slices = (0..self.slices()).flat_map(|slice| ["X", "Y", "Z"].map(|c| format!("slice{slice}{c}")));
        let layers = self.layers.as_deref();
        let paths = layers.map_or(0, |layers| layers.paths.len());
        let groups = layers.map_or(0, |layers| layers.light_groups.len());
        let xyz = |kind: &'static str, count| {
            (0..count).flat_map(move |number| ["X", "Y", "Z"].map(|c| format!("{kind}{number}{c}")))
        };
        let surfaces = layers.map(LayerSet::surface_channels).unwrap_or_default().into_iter().map(String::from);
        let bands = (0..self.bands).map(|band| format!("band{band}"));
        let moments = (self.bands..self.band_channels()).map(|channel| format!("moment{}", channel - self.bands));
        let replicates = if layers.is_some_and(|layers| layers.stokes) { REPLICATES } else { 0 };
        let stokes = (0..replicates).flat_map(|replicate| (1..=3).map(move |c| format!("stokes{replicate}S{c}")));
        let light = bands.chain(moments).chain(slices).chain(xyz("path", paths)).chain(xyz("light", groups));
        light.chain(stokes).chain(surfaces)
    }

    /// Returns true if the film has the sums for a denoiser.
    pub(super) fn denoises(&self) -> bool {
        self.layers.as_ref().is_some_and(|layers| layers.denoising)
    }

    /// Returns the first channel of the polarisation in a replicate, if the film records it.
    pub(super) fn stokes_channel(&self, replicate: usize) -> Option<usize> {
        let layers = self.layers.as_ref().filter(|layers| layers.stokes)?;
        Some(self.spectral_count() + layers.stokes_channel() + COMPONENTS * replicate)
    }

    pub(super) fn separates_lights(&self) -> bool {
        self.layers.as_ref().is_some_and(|layers| !layers.light_groups.is_empty())
    }

    /// Calls `add(channel, value)` for the channels of a path class and a light group, unless
    /// `None`. `xyz` is radiance times the colour-matching functions.
    pub(super) fn distribute_to_layers(
        &self,
        (class, light): (Option<usize>, Option<usize>),
        xyz: [f64; 3],
        mut add: impl FnMut(usize, f64),
    ) {
        let Some(layers) = self.layers.as_deref() else { return };
        let of_class = class.and_then(|class| layers.channel_of_class(class));
        let of_light = light.and_then(|light| layers.channel_of_light(light));
        for channel in of_class.into_iter().chain(of_light) {
            (0..COMPONENTS).for_each(|c| add(self.spectral_count() + channel + c, xyz[c]));
        }
    }

    /// Calls `add(channel, value)` for the spectral channels of light of one wavelength, with the
    /// radiance `weight`, which `xyz` multiplies by the colour-matching functions.
    pub(super) fn distribute(&self, nm: f64, weight: f64, xyz: [f64; 3], mut add: impl FnMut(usize, f64)) {
        // Light below the band only excites fluorophores.
        if self.bands > 0 && nm >= BAND_NM.0 {
            let band = band_of(nm, self.bands);
            add(band, weight);
            if self.moments {
                add(self.bands + band, weight * (nm - band_centre_nm(band, self.bands)));
            }
        }
        if let Some(diffraction) = &self.diffraction {
            let slice = diffraction.slice_of(nm);
            xyz.into_iter().enumerate().for_each(|(c, value)| add(self.of_slice(slice, c), value));
        }
    }
}

/// Returns the band of a wavelength. The simulated range is divided into `count` equal bands.
fn band_of(nm: f64, count: usize) -> usize {
    let fraction = (nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0);
    ((fraction * count as f64) as usize).min(count - 1)
}

/// Returns the centre of a band in nm.
pub(super) fn band_centre_nm(band: usize, count: usize) -> f64 {
    let (from, to) = band_nm(band, count);
    0.5 * (from + to)
}

/// Returns the lower and the upper end in nm of one of `count` equal bands.
pub(super) fn band_nm(band: usize, count: usize) -> (f64, f64) {
    let width_nm = (BAND_NM.1 - BAND_NM.0) / count as f64;
    (BAND_NM.0 + band as f64 * width_nm, BAND_NM.0 + (band + 1) as f64 * width_nm)
}
