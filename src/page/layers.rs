//! The layers of a picture that the page shows as false colours.

use abbe_spectra::colour::RgbSpace;
use abbe_transport::plan::PathClass;
use abbe_transport::sensor::Picture;

/// Returns Y of each path class at all pixels in cd/m², if the picture separates them.
pub(crate) fn class_luminance(picture: &Picture) -> Option<Vec<Vec<f32>>> {
    PathClass::NAMES.iter().map(|class| luminance(picture, class)).collect()
}

/// Returns the mean Y of each path class in cd/m², none if the picture does not separate them.
pub(crate) fn class_means(picture: &Picture) -> Vec<f64> {
    let mean = |values: Vec<f32>| values.iter().map(|&value| f64::from(value)).sum::<f64>() / values.len() as f64;
    class_luminance(picture).map_or_else(Vec::new, |classes| classes.into_iter().map(mean).collect())
}

/// Returns the number of camera samples of all pixels, or `None` if it was not recorded.
pub(crate) fn samples(picture: &Picture) -> Option<&[f32]> {
    channel(picture, "samples")
}

/// Returns the Stokes vector of Y at each pixel in cd/m², if they were recorded.
pub(crate) fn stokes(picture: &Picture) -> Option<Vec<[f32; 4]>> {
    let parts: Option<Vec<&[f32]>> = (0..4).map(|part| channel(picture, &format!("stokes.S{part}"))).collect();
    let parts = parts?;
    Some((0..parts[0].len()).map(|pixel| std::array::from_fn(|part| parts[part][pixel])).collect())
}

/// Returns the degree of polarisation of all pixels, from 0 to 1, if it was recorded.
pub(crate) fn degree(picture: &Picture) -> Option<&[f32]> {
    channel(picture, "polarisation.degree")
}

fn luminance(picture: &Picture, class: &str) -> Option<Vec<f32>> {
    let [r, g, b] = ["R", "G", "B"].map(|component| channel(picture, &format!("path.{class}.{component}")));
    let weights = RgbSpace::Srgb.luminance_weights().map(|weight| weight as f32);
    let rgb = r?.iter().zip(g?).zip(b?);
    Some(rgb.map(|((r, g), b)| weights[0] * r + weights[1] * g + weights[2] * b).collect())
}

fn channel<'p>(picture: &'p Picture, name: &str) -> Option<&'p [f32]> {
    picture.layers.channels.iter().find(|channel| channel.name == name).map(|channel| channel.values.as_slice())
}
