//! The light of a film after the diffraction at the camera's aperture.

use super::Film;
use crate::sensor::channels::band_nm;
use crate::sensor::diffraction::{Convolution, DiffractionPsf, add_product};
use crate::sensor::pixel_sums::PixelMean;
use abbe_spectra::math::random::REPLICATES;

impl Film {
    /// Returns the light of all pixels and their bands after diffraction. Each slice and each band
    /// has its own kernel. The replicates and the bias, stored only as Y over all wavelengths, are
    /// convolved with the mean kernel of all slices, weighted by their Y.
    pub(super) fn diffracted_light(&self, diffraction: &DiffractionPsf) -> (Vec<PixelMean>, Vec<f64>) {
        let convolution = Convolution::new(diffraction, (self.width, self.height));
        let value = |pixel: usize, channel: usize| self.channel(pixel, channel);
        let blank = || vec![Default::default(); 4 * self.pixel_count()];
        let (mut xy, mut z, mut mean, mut whole) = (blank(), blank(), blank(), 0.0);
        for slice in 0..diffraction.slices() {
            let [of_x, of_y, of_z] = [0, 1, 2].map(|component| self.channels.of_slice(slice, component));
            let kernel = convolution.kernel(diffraction.slice_nm(slice));
            add_product(&mut xy, &kernel, &convolution.transform(|pixel| [value(pixel, of_x), value(pixel, of_y)]));
            add_product(&mut z, &kernel, &convolution.transform(|pixel| [value(pixel, of_z), 0.0]));
            let y = (0..self.pixel_count()).map(|pixel| value(pixel, of_y)).sum::<f64>().max(f64::MIN_POSITIVE);
            mean.iter_mut().zip(kernel).for_each(|(mean, kernel)| *mean += kernel * y);
            whole += y;
        }
        mean.iter_mut().for_each(|value| *value = *value * (1.0 / whole));
        let (xy, z) = (convolution.planes(xy), convolution.planes(z));
        let mut light: Vec<PixelMean> = (0..self.pixel_count()).map(|pixel| self.light_of(pixel)).collect();
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
            let both = spread(&|pixel| [0, 1].map(|next| self.light_of(pixel).y[replicate + next]));
            light
                .iter_mut()
                .zip(both)
                .for_each(|(light, both)| light.y[replicate..replicate + 2].copy_from_slice(&both));
        }
        let bias = spread(&|pixel| self.light_of(pixel).bias);
        light.iter_mut().zip(bias).for_each(|(light, bias)| light.bias = bias);
        let bands = self.channels.bands;
        let mut values = vec![0.0; bands * self.pixel_count()];
        for band in 0..bands {
            let mut sum = blank();
            let kernel = convolution.kernel(band_nm(band, bands));
            add_product(&mut sum, &kernel, &convolution.transform(|pixel| [value(pixel, band), 0.0]));
            let plane = convolution.planes(sum);
            values.iter_mut().skip(band).step_by(bands).zip(plane).for_each(|(to, from)| *to = positive(from[0]));
        }
        (light, values)
    }
}
