//! The denoised picture of a film.

use abbe_denoise::{Denoised, denoise};
use abbe_spectra::math::elementary::hypot;
use abbe_transport::sensor::{DenoisedPicture, Film, Picture, PictureErrors};

/// Denoises the picture of a film on the current thread pool. Returns `None` if the film has no
/// sums for it, or fewer than four passes.
///
/// The bias contains that of the picture. It is unknown if that is unknown.
pub fn denoised(film: &Film, picture: &Picture) -> Option<DenoisedPicture> {
    let Denoised { xyz, noise, bias } = denoise(&film.denoising_samples()?);
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

/// Develops the picture of a film with its denoised picture. Also returns its errors.
pub(super) fn picture_and_errors(film: &Film) -> (Picture, Option<PictureErrors>) {
    let (mut picture, errors) = film.picture_and_errors();
    picture.denoised = denoised(film, &picture);
    (picture, errors)
}
