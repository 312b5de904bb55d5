//! The denoised picture of a film.

use abbe_denoise::{Denoised, Feature, Samples, denoise};
use abbe_spectra::math::elementary::hypot;
use abbe_transport::sensor::denoising::{DenoisingMeans, MeanSurface};
use abbe_transport::sensor::{DenoisedPicture, Film, Picture};

/// Denoises the picture of a film on the current thread pool. Returns `None` if the film has no
/// sums for it, or if some replicates have no passes yet.
///
/// The bias contains that of the picture. It is unknown if that is unknown.
pub fn denoised(film: &Film, picture: &Picture) -> Option<DenoisedPicture> {
    let DenoisingMeans { y, x, z, surfaces } = film.denoising_means()?;
    let feature = |MeanSurface { albedo, normal, log_depth }| Feature { albedo, normal, log_depth };
    let features = surfaces.map(|surfaces| surfaces.into_iter().map(feature).collect());
    let (width, height, passes) = (picture.width, picture.height, film.passes_by_replicate());
    let Denoised { xyz, noise, bias } = denoise(&Samples { width, height, passes, y, x, z, features });
    let is_known = !film.misses_light();
    let total = |(own, more): (&Option<f32>, f32)| {
        is_known.then(|| hypot(f64::from(own.unwrap_or(0.0)), f64::from(more)) as f32)
    };
    let lit = |(noise, xyz): (f32, &[f32; 3])| (xyz[1] > 0.0).then_some(noise);
    Some(DenoisedPicture {
        noise: noise.into_iter().zip(&xyz).map(lit).collect(),
        bias: picture.bias.iter().zip(bias).map(total).collect(),
        xyz: xyz.into_iter().map(|xyz| xyz.map(f64::from)).collect(),
    })
}
