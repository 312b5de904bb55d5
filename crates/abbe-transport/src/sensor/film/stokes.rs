//! The layers of the polarisation: Stokes vectors, the degree and the angle of polarisation.

use super::Film;
use crate::sensor::layers::PictureLayers;
use abbe_spectra::math::elementary::atan2;
use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::spectrum::LUMENS_PER_WATT;

/// S1, S2 and S3 of a pixel in cd/m², and their standard errors.
struct PixelStokes {
    parts: [f64; 3],
    errors: [f64; 3],
}

impl Film {
    /// Adds the layers of the polarisation, of which `first` is the first channel.
    ///
    /// The degree is that of the measured Stokes vector, less what its noise adds: for independent
    /// errors, E|S|² = |E S|² + Σσ².
    pub(super) fn add_stokes(&self, layers: &mut PictureLayers, first: usize) {
        let pixels: Vec<PixelStokes> = (0..self.pixel_count()).map(|pixel| self.pixel_stokes(pixel, first)).collect();
        let scale = LUMENS_PER_WATT / self.passes().max(1) as f64;
        let s0: Vec<f64> = (0..pixels.len()).map(|pixel| self.light_of(pixel).xyz[1] * scale).collect();
        layers.add("stokes.S0".to_string(), s0.iter().map(|&value| value as f32));
        for part in 0..3 {
            layers.add(format!("stokes.S{}", part + 1), pixels.iter().map(|stokes| stokes.parts[part] as f32));
        }
        for part in 0..3 {
            let errors = pixels.iter().map(|stokes| stokes.errors[part] as f32);
            layers.add(format!("stokes.noise.S{}", part + 1), errors);
        }
        let degrees = pixels.iter().zip(&s0).map(|(PixelStokes { parts, errors }, &s0)| {
            let square: f64 = parts.iter().zip(errors).map(|(part, error)| part * part - error * error).sum();
            (if s0 > 0.0 { (square.max(0.0).sqrt() / s0).min(1.0) } else { 0.0 }) as f32
        });
        layers.add("polarisation.degree".to_string(), degrees);
        let angle = |stokes: &PixelStokes| 0.5 * atan2(stokes.parts[1], stokes.parts[0]).to_degrees();
        layers.add("polarisation.angle".to_string(), pixels.iter().map(|stokes| angle(stokes) as f32));
    }

    /// Returns the means over all passes, with the standard errors of the means of the replicates.
    fn pixel_stokes(&self, pixel: usize, first: usize) -> PixelStokes {
        let total = self.passes().max(1) as f64;
        let sums = |part: usize| {
            (0..REPLICATES).map(move |replicate| (replicate, self.channel(pixel, first + 3 * replicate + part)))
        };
        let mean = |part: usize| sums(part).map(|(_, sum)| sum).sum::<f64>() / total;
        let error = |part: usize| {
            let used = self.passes.iter().filter(|&&passes| passes > 0).count();
            if used < 2 {
                return 0.0;
            }
            let squares = sums(part).filter(|&(replicate, _)| self.passes[replicate] > 0).map(|(replicate, sum)| {
                let passes = self.passes[replicate] as f64;
                passes * (sum / passes - mean(part)).powi(2)
            });
            (squares.sum::<f64>() / (used - 1) as f64 / total).sqrt()
        };
        let parts = std::array::from_fn(|part| mean(part) * LUMENS_PER_WATT);
        let errors = std::array::from_fn(|part| error(part) * LUMENS_PER_WATT);
        PixelStokes { parts, errors }
    }
}
