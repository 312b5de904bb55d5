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
    /// √mean(noise² + bias²) / mean Y; `None` while noise is unknown everywhere.
    pub relative: Option<f64>,
    /// Pixels where the error is unknown.
    pub unknown_pixels: usize,
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
            bands: None,
        }
    }

    /// Mean of Y over all pixels, cd/m².
    pub fn mean_y(&self) -> f64 {
        self.xyz.iter().map(|xyz| xyz[1]).sum::<f64>() / self.xyz.len() as f64
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
        let relative = (known > 0 && mean_y > 0.0).then(|| (square / count).sqrt() / mean_y);
        ErrorMeans { noise: noise / count, bias: bias / count, relative, unknown_pixels: self.xyz.len() - known }
    }
}
