//! A picture: XYZ with error bars.

use super::channels::band_nm;
use super::layers::PictureLayers;
use abbe_spectra::math::elementary::hypot;

/// The observer's XYZ of every pixel, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    pub width: usize,
    pub height: usize,
    /// X, Y and Z of each pixel. Y is in cd/m².
    pub xyz: Vec<[f64; 3]>,
    /// The standard error of Y in cd/m², if it is known.
    pub noise: Vec<Option<f32>>,
    /// The magnitude of the estimated bias of Y in cd/m², if it is known.
    pub bias: Vec<Option<f32>>,
    /// Kernels blur an edge of the illumination, so the bias is probably larger than the estimate.
    pub edge: Vec<Option<bool>>,
    pub bands: Option<SpectralBands>,
    pub layers: PictureLayers,
    /// The denoised picture, if it was computed.
    pub denoised: Option<DenoisedPicture>,
}

/// The XYZ of a denoised picture, with error bars of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct DenoisedPicture {
    /// X, Y and Z of each pixel. Y is in cd/m².
    pub xyz: Vec<[f64; 3]>,
    /// The standard error of Y in cd/m², if it is known.
    pub noise: Vec<Option<f32>>,
    /// The magnitude of the estimated bias of Y in cd/m², if it is known.
    pub bias: Vec<Option<f32>>,
}

/// Spectral radiance in bands of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralBands {
    pub centres_nm: Vec<f64>,
    /// Radiance in W/m²/sr/nm, pixel by pixel and band by band.
    pub values: Vec<f32>,
}

impl SpectralBands {
    /// Returns the centres of the bands in nm if the simulated range is divided into `count` bands.
    pub fn centres_nm(count: usize) -> Vec<f64> {
        let centre = |(from_nm, to_nm): (f64, f64)| 0.5 * (from_nm + to_nm);
        (0..count).map(|band| centre(band_nm(band, count))).collect()
    }
}

/// Means of the error layers over the pixels with known errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorMeans {
    /// The mean standard error of Y in cd/m².
    pub noise: f64,
    /// The mean bias of Y in cd/m².
    pub bias: f64,
    /// The root of the mean of noise² + bias², divided by the mean of Y. `None` if the noise is
    /// unknown in all pixels, or if it is 0 and some pixels have no light.
    pub relative: Option<f64>,
    pub unknown_pixels: usize,
    /// At an edge of the illumination, where the bias is probably larger than estimated.
    pub edge_pixels: usize,
}

/// Returns half the width of the 95 % interval, for a standard error and a magnitude of bias.
///
/// It is two-sided if the bias is negligible and one-sided otherwise. The factors are quantiles of
/// Student's t with 9 degrees of freedom (7 from the eight replicates of a pixel and 2 from its
/// neighbours), so they are valid only after at least eight passes.
pub fn half_interval_95(noise: f64, bias: f64) -> f64 {
    const TWO_SIDED: f64 = 2.262;
    const ONE_SIDED: f64 = 1.833;
    (TWO_SIDED * noise).max(bias + ONE_SIDED * noise)
}

impl Picture {
    /// Returns a picture without light. All errors are unknown.
    pub fn black(width: usize, height: usize) -> Self {
        let count = width * height;
        Self {
            width,
            height,
            xyz: vec![[0.0; 3]; count],
            noise: vec![None; count],
            bias: vec![None; count],
            edge: vec![None; count],
            bands: None,
            layers: PictureLayers::default(),
            denoised: None,
        }
    }

    /// Enlarges a picture by bilinear interpolation of X, Y and Z. A pixel becomes `factor` ×
    /// `factor` pixels, with the same centre of the picture and unknown errors.
    #[must_use]
    pub fn enlarged(&self, factor: usize, (width, height): (usize, usize)) -> Self {
        // The two pixels of a row or column around a position, and the fraction of the second.
        let between = |position: usize, large: usize, small: usize| {
            let centred = (position as f64 + 0.5 - 0.5 * large as f64) / factor as f64;
            let position = (centred + 0.5 * small as f64 - 0.5).clamp(0.0, (small - 1) as f64);
            (position as usize, (position as usize + 1).min(small - 1), position.fract())
        };
        let columns: Vec<_> = (0..width).map(|x| between(x, width, self.width)).collect();
        let mut enlarged = Self::black(width, height);
        for (y, row) in enlarged.xyz.chunks_exact_mut(width).enumerate() {
            let (above, below, down) = between(y, height, self.height);
            for (xyz, &(left, right, across)) in row.iter_mut().zip(&columns) {
                let at = |x: usize, y: usize, c: usize| self.xyz[y * self.width + x][c];
                let mix = |y: usize, c: usize| (1.0 - across) * at(left, y, c) + across * at(right, y, c);
                *xyz = std::array::from_fn(|c| (1.0 - down) * mix(above, c) + down * mix(below, c));
            }
        }
        enlarged
    }

    /// Returns the denoised picture with its error bars, without bands, layers and edges. `None` if
    /// it was not computed.
    pub fn denoised(&self) -> Option<Self> {
        let DenoisedPicture { xyz, noise, bias } = self.denoised.clone()?;
        Some(Self { xyz, noise, bias, ..Self::black(self.width, self.height) })
    }

    /// Returns true if the denoised picture is better by its own error bars: its RMS error and
    /// the error of its typical pixel are known, and below those of this picture.
    pub fn is_safe_to_denoise(&self) -> bool {
        let Some(denoised) = self.denoised() else { return false };
        // In cd/m²: a few glints can have almost all of the RMS error, with or without the denoiser, and
        // the means of the pictures differ by chance.
        let errors = |picture: &Self| {
            let typical = picture.error_distribution().map(|errors| errors.typical);
            picture.error_means().relative.map(|relative| relative * picture.mean_y()).zip(typical)
        };
        let is_below = |(own, raw): ((f64, f64), (f64, f64))| own.0 < raw.0 && own.1 < raw.1;
        errors(&denoised).zip(errors(self)).is_some_and(is_below)
    }

    /// Returns the mean of Y (cd/m²) over all pixels.
    pub fn mean_y(&self) -> f64 {
        self.xyz.iter().map(|xyz| xyz[1]).sum::<f64>() / self.xyz.len() as f64
    }

    /// Returns √(noise² + bias²) in cd/m², `None` if one is unknown.
    pub fn error(&self, pixel: usize) -> Option<f64> {
        self.bars(pixel).map(|(noise, bias)| hypot(noise, bias))
    }

    /// Returns half the width of a pixel's 95 % interval in cd/m², for a value with the standard
    /// error `other_noise`. `None` if the error of the pixel is unknown.
    pub fn half_interval_95(&self, pixel: usize, other_noise: f64) -> Option<f64> {
        self.bars(pixel).map(|(noise, bias)| half_interval_95(hypot(noise, other_noise), bias))
    }

    /// Returns the noise and the bias of a pixel if both are known.
    fn bars(&self, pixel: usize) -> Option<(f64, f64)> {
        self.noise[pixel].zip(self.bias[pixel]).map(|(noise, bias)| (f64::from(noise), f64::from(bias)))
    }

    pub fn error_means(&self) -> ErrorMeans {
        let (mut noise, mut bias, mut square, mut known) = (0.0, 0.0, 0.0, 0_usize);
        for (&n, &b) in self.noise.iter().zip(&self.bias) {
            if let Some(n) = n {
                let (n, b) = (f64::from(n), f64::from(b.unwrap_or(0.0)));
                noise += n;
                bias += b;
                square += n * n + b * b;
                known += 1;
            }
        }
        let count = known.max(1) as f64;
        let mean_y = self.mean_y();
        // Lit pixels that all have the error 0 do not represent those without light yet.
        let is_known = known > 0 && mean_y > 0.0 && (square > 0.0 || known == self.xyz.len());
        let relative = is_known.then(|| (square / count).sqrt() / mean_y);
        ErrorMeans {
            noise: noise / count,
            bias: bias / count,
            relative,
            unknown_pixels: self.xyz.len() - known,
            edge_pixels: self.edge.iter().filter(|edge| **edge == Some(true)).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lamp with an error of its own, which the denoiser does not change, on a noisy wall. The
    /// denoised wall is a little darker.
    #[test]
    fn a_glint_does_not_hide_that_the_denoiser_helps() {
        let count = 100;
        let of_wall = |lamp: f32, wall: f32| {
            (0..count).map(|i| Some(if i == 0 { lamp } else { wall })).collect::<Vec<Option<f32>>>()
        };
        let xyz = |wall: f64| (0..count).map(|i| [if i == 0 { 1000.0 } else { wall }; 3]).collect::<Vec<_>>();
        let mut picture = Picture::black(count, 1);
        (picture.xyz, picture.noise, picture.bias) = (xyz(1.0), of_wall(100.0, 0.2), of_wall(0.0, 0.0));
        let denoised = |wall: f64, noise: f32| DenoisedPicture {
            xyz: xyz(wall),
            noise: of_wall(100.0, noise),
            bias: of_wall(0.0, 0.0),
        };
        picture.denoised = Some(denoised(0.9, 0.05));
        assert!(picture.is_safe_to_denoise());
        picture.denoised = Some(denoised(0.9, 0.3));
        assert!(!picture.is_safe_to_denoise());
    }

    #[test]
    fn an_enlarged_gradient_keeps_its_values() {
        let (small, factor, (width, height)) = ((5, 4), 3, (13, 11));
        let mut picture = Picture::black(small.0, small.1);
        for (i, xyz) in picture.xyz.iter_mut().enumerate() {
            let (x, y) = ((i % small.0) as f64 + 0.5 - 2.5, (i / small.0) as f64 + 0.5 - 2.0);
            *xyz = [x, y, 1.0];
        }
        let enlarged = picture.enlarged(factor, (width, height));
        for (i, [x, y, z]) in enlarged.xyz.iter().enumerate() {
            let wanted = [((i % width) as f64 + 0.5 - 6.5) / 3.0, ((i / width) as f64 + 0.5 - 5.5) / 3.0];
            let inside = [wanted[0].clamp(-2.0, 2.0), wanted[1].clamp(-1.5, 1.5)];
            assert!((x - inside[0]).abs() < 1e-12 && (y - inside[1]).abs() < 1e-12 && (z - 1.0).abs() < 1e-12);
        }
        assert!(enlarged.noise.iter().all(Option::is_none));
    }

    /// The quantiles of Student's t with 9 degrees of freedom are 2.262 (97.5 %) and 1.833 (95 %).
    #[test]
    fn intervals_take_students_quantiles_of_nine_degrees() {
        assert!((half_interval_95(1.0, 0.0) - 2.262_157).abs() < 5e-4);
        assert!((half_interval_95(1.0, 5.0) - (5.0 + 1.833_113)).abs() < 5e-4);
        assert!((half_interval_95(0.0, 0.3) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_relative_error_is_never_0_while_pixels_are_unlit() {
        let mut picture = Picture::black(2, 1);
        picture.xyz[0] = [1.0; 3];
        (picture.noise[0], picture.bias[0]) = (Some(0.0), Some(0.0));
        assert_eq!((picture.error_means().relative, picture.error_means().unknown_pixels), (None, 1));
        picture.noise[0] = Some(0.1);
        assert!((picture.error_means().relative.unwrap() - 0.2).abs() < 1e-7, "the mean Y is 1/2");
        picture.xyz[1] = [1.0; 3];
        (picture.noise, picture.bias) = (vec![Some(0.0); 2], vec![Some(0.0); 2]);
        assert_eq!(picture.error_means().relative, Some(0.0), "all pixels are known exactly");
    }

    /// Checks that the error combines noise and bias, and is unknown if one of them is unknown.
    #[test]
    fn an_error_combines_noise_and_bias() {
        let mut picture = Picture::black(3, 1);
        (picture.noise, picture.bias) = (vec![Some(0.3), Some(0.3), None], vec![Some(0.4), None, Some(0.4)]);
        assert!((picture.error(0).unwrap() - 0.5).abs() < 1e-6);
        assert_eq!([1, 2].map(|pixel| picture.error(pixel)), [None; 2]);
    }
}
