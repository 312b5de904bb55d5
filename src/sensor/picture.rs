//! A developed picture: XYZ with error bars.

/// Radiance as seen by the observer, pixel by pixel, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// X, Y, Z per pixel; Y in cd/m².
    pub xyz: Vec<[f64; 3]>,
    /// Standard error of Y in cd/m²; −1 where unknown.
    pub noise: Vec<f32>,
    /// Estimated bias of Y in cd/m², as a magnitude; −1 where unknown.
    pub bias: Vec<f32>,
    /// 1 beside an edge of light that kernels blur, where the bias is likely larger than told; else 0; −1 where unknown.
    pub edge: Vec<f32>,
    /// Spectral radiance, if it was kept.
    pub bands: Option<Bands>,
}

/// Spectral radiance in equal bands.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// The bands' centres in nm.
    pub centres_nm: Vec<f64>,
    /// W/m²/sr/nm, pixel by pixel, band by band.
    pub values: Vec<f32>,
}

/// Image means of the error layers over the pixels where they are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorMeans {
    /// Mean standard error of Y, cd/m².
    pub noise: f64,
    /// Mean bias of Y, cd/m².
    pub bias: f64,
    /// √mean(noise² + bias²) / mean Y; `None` while noise is unknown everywhere, and never 0 while there are pixels that no light reached.
    pub relative: Option<f64>,
    /// Pixels where the error is unknown.
    pub unknown_pixels: usize,
    /// Pixels beside an edge of light, where the bias is likely larger than told.
    pub edge_pixels: usize,
}

/// Half of a 95 % interval around a value with this standard error and a bias of this magnitude. Where the bias is small, noise may lead to both sides; where it is not,
/// noise matters on the side to which it leads. By Student's t with 9 degrees of freedom, 7 of a pixel's eight replicates and 2 that it takes from its
/// neighbours: it holds from eight passes on.
pub fn half_interval_95(noise: f64, bias: f64) -> f64 {
    const TO_BOTH_SIDES: f64 = 2.262;
    const TO_ONE_SIDE: f64 = 1.833;
    (TO_BOTH_SIDES * noise).max(bias + TO_ONE_SIDE * noise)
}

impl Picture {
    /// A picture without light.
    pub fn black(width: usize, height: usize) -> Self {
        let count = width * height;
        Self {
            width,
            height,
            xyz: vec![[0.0; 3]; count],
            noise: vec![-1.0; count],
            bias: vec![-1.0; count],
            edge: vec![-1.0; count],
            bands: None,
        }
    }

    /// Mean of Y over all pixels, cd/m².
    pub fn mean_y(&self) -> f64 {
        self.xyz.iter().map(|xyz| xyz[1]).sum::<f64>() / self.xyz.len() as f64
    }

    /// A pixel's error in cd/m², noise and bias together: √(noise² + bias²); `None` where it is unknown.
    pub fn error(&self, pixel: usize) -> Option<f64> {
        self.bars(pixel).map(|(noise, bias)| noise.hypot(bias))
    }

    /// Half of the pixel's 95 % interval in cd/m², where it is compared with a value of which this standard error is known; `None` where its error is
    /// unknown.
    pub fn half_interval_95(&self, pixel: usize, other_noise: f64) -> Option<f64> {
        self.bars(pixel).map(|(noise, bias)| half_interval_95(noise.hypot(other_noise), bias))
    }

    /// A pixel's noise and bias, where both are known.
    fn bars(&self, pixel: usize) -> Option<(f64, f64)> {
        let (noise, bias) = (f64::from(self.noise[pixel]), f64::from(self.bias[pixel]));
        (noise >= 0.0 && bias >= 0.0).then_some((noise, bias))
    }

    /// The error layers' means.
    pub fn error_means(&self) -> ErrorMeans {
        let (mut noise, mut bias, mut square, mut known) = (0.0, 0.0, 0.0, 0_usize);
        for (&n, &b) in self.noise.iter().zip(&self.bias) {
            if n >= 0.0 {
                let (n, b) = (f64::from(n), f64::from(b.max(0.0)));
                noise += n;
                bias += b;
                square += n * n + b * b;
                known += 1;
            }
        }
        let count = known.max(1) as f64;
        let mean_y = self.mean_y();
        // Pixels that are known exactly say nothing about those that no light has reached yet.
        let tells = known > 0 && mean_y > 0.0 && (square > 0.0 || known == self.xyz.len());
        let relative = tells.then(|| (square / count).sqrt() / mean_y);
        ErrorMeans {
            noise: noise / count,
            bias: bias / count,
            relative,
            unknown_pixels: self.xyz.len() - known,
            edge_pixels: self.edge.iter().filter(|&&edge| edge > 0.0).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relative_error_is_never_0_while_pixels_are_unlit() {
        let mut picture = Picture::black(2, 1);
        picture.xyz[0] = [1.0; 3];
        (picture.noise[0], picture.bias[0]) = (0.0, 0.0);
        assert_eq!((picture.error_means().relative, picture.error_means().unknown_pixels), (None, 1));
        picture.noise[0] = 0.1;
        assert!((picture.error_means().relative.unwrap() - 0.2).abs() < 1e-7, "the mean Y is 1/2");
        picture.xyz[1] = [1.0; 3];
        (picture.noise, picture.bias) = (vec![0.0; 2], vec![0.0; 2]);
        assert_eq!(picture.error_means().relative, Some(0.0), "all pixels are known exactly");
    }

    #[test]
    fn an_error_is_noise_and_bias_together_and_unknown_where_either_is() {
        let mut picture = Picture::black(3, 1);
        (picture.noise, picture.bias) = (vec![0.3, 0.3, -1.0], vec![0.4, -1.0, 0.4]);
        assert!((picture.error(0).unwrap() - 0.5).abs() < 1e-6);
        assert_eq!([1, 2].map(|pixel| picture.error(pixel)), [None; 2]);
    }
}
