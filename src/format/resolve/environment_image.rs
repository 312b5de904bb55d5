//! Reads image files as environment maps.

use crate::error::{Error, Result};
use crate::format::PictureFile;
use crate::scene::light::EnvironmentMap;
use crate::spectrum::Spectrum;
use glam::DAffine3;
use std::path::Path;

/// Reads a latitude–longitude image (EXR, Radiance HDR, PNG or JPEG) as linear sRGB and rotates it
/// by `to_world`.
pub(super) fn load(path: &Path, to_world: DAffine3) -> Result<EnvironmentMap> {
    let picture = PictureFile::read(path)?;
    let (width, height) = (picture.size.width, picture.size.height);
    let rgb = picture.linear_rgb(None);
    if rgb.iter().flatten().any(|c| !c.is_finite() || *c < 0.0) {
        return Err(Error::input("the image has values that are negative or not finite").in_file(path));
    }
    let rgb = if to_world == DAffine3::IDENTITY { rgb } else { rotated(width, height, &rgb, to_world) };
    let lights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let [red, green, blue] = lights.map(Spectrum::rgb_light);
    EnvironmentMap::new(width, height, &rgb, [&red?, &green?, &blue?])
        .ok_or_else(|| Error::input("the image is black").expected("at least one pixel above 0").in_file(path))
}

/// Returns the image of the rotated environment. To find the value of a pixel, the function rotates
/// the direction of the pixel back, and looks up the value of the original image in this direction.
fn rotated(width: usize, height: usize, rgb: &[[f32; 3]], to_world: DAffine3) -> Vec<[f32; 3]> {
    let back = to_world.matrix3.inverse();
    (0..width * height)
        .map(|index| {
            let centre = [(index % width) as f64 + 0.5, (index / width) as f64 + 0.5];
            let direction = EnvironmentMap::direction([centre[0] / width as f64, centre[1] / height as f64]);
            let [u, v] = EnvironmentMap::point((back * direction).normalize());
            let column = ((u * width as f64) as usize).min(width - 1);
            let row = ((v * height as f64) as usize).min(height - 1);
            rgb[row * width + column]
        })
        .collect()
}
