//! The polarisation of a picture with the layer `stokes`.

use abbe_spectra::math::elementary::{atan2, cos, sin};
use abbe_transport::sensor::Picture;
use serde::Serialize;

/// The polarisation of a pixel, in the frame of the picture: S1 is positive for horizontal light, S2
/// at +45°, counter-clockwise, and S3 for right-circular light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PixelStokes {
    /// S0 to S3 in cd/m². S0 is Y.
    pub stokes: [f64; 4],
    /// The standard errors of S1 to S3 in cd/m².
    pub noise: [f64; 3],
    /// The degree of polarisation, from 0 to 1, without what noise adds to it.
    pub degree: f64,
    /// The angle of polarisation in degrees, from −90 to 90, counter-clockwise from the horizontal.
    pub angle_deg: f64,
}

/// Returns the polarisation of a pixel, or `None` if the picture has no layer `stokes`.
pub fn pixel_stokes(picture: &Picture, pixel: usize) -> Option<PixelStokes> {
    let value = |name: &str| {
        let channel = picture.layers.channels.iter().find(|channel| channel.name == name)?;
        channel.values.get(pixel).map(|&value| f64::from(value))
    };
    let [s1, s2, s3] = [value("stokes.S1")?, value("stokes.S2")?, value("stokes.S3")?];
    Some(PixelStokes {
        stokes: [value("stokes.S0")?, s1, s2, s3],
        noise: [value("stokes.noise.S1")?, value("stokes.noise.S2")?, value("stokes.noise.S3")?],
        degree: value("polarisation.degree")?,
        angle_deg: 0.5 * atan2(s2, s1).to_degrees(),
    })
}

/// Returns the luminance in cd/m² of each pixel through an ideal polariser, which passes light at an
/// angle in degrees counter-clockwise from the horizontal. `None` without the layer `stokes`.
pub fn analysed(picture: &Picture, angle_deg: f64) -> Option<Vec<f64>> {
    let double = 2.0 * angle_deg.to_radians();
    let (along, across) = (cos(double), sin(double));
    let of_pixel = |pixel: usize| {
        let PixelStokes { stokes: [s0, s1, s2, _], .. } = pixel_stokes(picture, pixel)?;
        Some(0.5 * (s0 + along * s1 + across * s2).max(0.0))
    };
    (0..picture.xyz.len()).map(of_pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_transport::sensor::layers::LayerChannel;

    /// Light at 30° passes an analyser at 30°, and none passes at 120°.
    #[test]
    fn an_analyser_passes_light_along_its_axis() {
        let mut picture = Picture::black(1, 1);
        let double = 60.0_f64.to_radians();
        let names = ["stokes.S0", "stokes.S1", "stokes.S2", "stokes.S3", "polarisation.degree"];
        let values = [2.0, 2.0 * double.cos(), 2.0 * double.sin(), 0.0, 1.0];
        let errors = ["stokes.noise.S1", "stokes.noise.S2", "stokes.noise.S3"].map(|name| (name, 0.0));
        for (name, value) in names.into_iter().zip(values).chain(errors) {
            picture.layers.channels.push(LayerChannel { name: name.to_string(), values: vec![value as f32] });
        }
        for (angle, known) in [(30.0, 2.0), (120.0, 0.0), (75.0, 1.0)] {
            assert!((analysed(&picture, angle).unwrap()[0] - known).abs() < 1e-6, "{angle}°");
        }
        assert!((pixel_stokes(&picture, 0).unwrap().angle_deg - 30.0).abs() < 1e-5);
        assert_eq!(analysed(&Picture::black(1, 1), 0.0), None);
    }
}
