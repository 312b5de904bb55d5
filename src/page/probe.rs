//! The values of a pixel or of a rectangle of pixels.

use super::snapshot::Snapshot;
use abbe_spectra::colour::xy;
use abbe_transport::sensor::picture::half_interval_95;
use serde::{Deserialize, Serialize};

/// A rectangle of pixels. The right column and the last row belong to it.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProbeArea {
    pub(super) x0: usize,
    pub(super) y0: usize,
    pub(super) x1: usize,
    pub(super) y1: usize,
}

#[derive(Debug, Serialize)]
pub(crate) struct AreaReport {
    picture: u64,
    passes: u64,
    area: [usize; 4],
    /// Y in cd/m².
    xyz: [f64; 3],
    /// Null if the area is black.
    xy: Option<[f64; 2]>,
    /// Standard error of Y in cd/m², or null if unknown.
    noise: Option<f64>,
    /// Estimated bias of Y in cd/m², or null if unknown.
    bias: Option<f64>,
    /// The 95 % confidence interval of Y in cd/m².
    interval_95: Option<[f64; 2]>,
    /// The centres of the bands in nm.
    nm: Vec<f64>,
    /// The spectral radiance in W/m²/sr/nm.
    values: Vec<f64>,
    /// The standard errors of the spectral radiance, or null if unknown.
    errors: Option<Vec<f64>>,
}

impl AreaReport {
    /// Returns X, Y, Z, the noise, the bias, the upper end of the 95 % interval, the values of all
    /// bands, and their standard errors. Unknown values are NaN.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let unknown = || vec![f64::NAN; self.values.len()];
        let errors = self.errors.clone().unwrap_or_else(unknown);
        let of_y = [self.noise, self.bias, self.interval_95.map(|interval| interval[1])]
            .map(|value| value.unwrap_or(f64::NAN));
        [&self.xyz[..], &of_y, &self.values, &errors].concat()
    }
}

/// Returns the mean values of an area, or `None` if it is not inside the picture. The noise of
/// neighbouring pixels is correlated, because their estimates share photons, so the noise of an
/// area is the upper bound: the mean noise of its pixels.
pub(crate) fn report(snapshot: &Snapshot, area: ProbeArea) -> Option<AreaReport> {
    let picture = &snapshot.picture;
    let ProbeArea { x0, y0, x1, y1 } = area;
    if x0 > x1 || y0 > y1 || x1 >= picture.width || y1 >= picture.height {
        return None;
    }
    let pixels: Vec<usize> = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| y * picture.width + x)).collect();
    let fraction = 1.0 / pixels.len() as f64;
    let mean = |value: &dyn Fn(usize) -> f64| pixels.iter().map(|&pixel| value(pixel)).sum::<f64>() * fraction;
    // The sum of options is `None` if one of them is.
    let known = |values: &[Option<f32>]| {
        let sum: Option<f64> = pixels.iter().map(|&pixel| values[pixel].map(f64::from)).sum();
        sum.map(|sum| sum * fraction)
    };
    let xyz = [0, 1, 2].map(|c| mean(&|pixel| picture.xyz[pixel][c]));
    let (noise, bias) = (known(&picture.noise), known(&picture.bias));
    let half_interval = noise.zip(bias).map(|(noise, bias)| half_interval_95(noise, bias));
    let count = picture.bands.as_ref().map_or(0, |bands| bands.centres_nm.len());
    let by_band = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (0..count).map(|band| mean(&|pixel| value(pixel * count + band))).collect()
    };
    let values = picture.bands.as_ref().map(|bands| by_band(&|index| f64::from(bands.values[index])));
    let errors = snapshot.band_noise.as_ref().filter(|noise| noise.at(0).is_some());
    Some(AreaReport {
        picture: snapshot.number,
        passes: snapshot.passes,
        area: [x0, y0, x1, y1],
        xyz,
        xy: (xyz.iter().sum::<f64>() > 0.0).then(|| xy(xyz)),
        noise,
        bias,
        // Luminance is not negative.
        interval_95: half_interval.map(|half_interval| [(xyz[1] - half_interval).max(0.0), xyz[1] + half_interval]),
        nm: picture.bands.as_ref().map(|bands| bands.centres_nm.clone()).unwrap_or_default(),
        values: values.unwrap_or_default(),
        errors: errors.map(|noise| by_band(&|index| noise.at(index).unwrap_or(0.0))),
    })
}
