//! Reads image files as environment maps.

use crate::error::{Error, Result};
use crate::scene::light::EnvironmentMap;
use crate::spectrum::Spectrum;
use glam::DAffine3;
use std::path::Path;

/// Reads a latitude–longitude image (EXR, Radiance HDR, PNG or JPEG) as linear sRGB and rotates it
/// by `to_world`.
pub(super) fn load(path: &Path, to_world: DAffine3) -> Result<EnvironmentMap> {
    let (width, height, rgb) = read(path).map_err(|error| error.in_file(path))?;
    if rgb.iter().flatten().any(|c| !c.is_finite() || *c < 0.0) {
        return Err(Error::input("the image has values that are negative or not finite").in_file(path));
    }
    let rgb = if to_world == DAffine3::IDENTITY { rgb } else { rotated(width, height, &rgb, to_world) };
    let lights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let [red, green, blue] = lights.map(Spectrum::rgb_light);
    EnvironmentMap::new(width, height, &rgb, [&red?, &green?, &blue?])
        .ok_or_else(|| Error::input("the image is black").expected("at least one pixel above 0").in_file(path))
}

/// The width, the height and the linear RGB values of an image. The values are listed row by row,
/// and the top row is the first.
type Pixels = (usize, usize, Vec<[f32; 3]>);

fn read(path: &Path) -> Result<Pixels> {
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    if is_exr { read_exr(path) } else { read_other(path) }
}

fn read_exr(path: &Path) -> Result<Pixels> {
    use exr::prelude::*;
    check_size(path)?;
    let image = read_first_rgba_layer_from_file(
        path,
        |size, _| (size.0, vec![[0.0_f32; 3]; size.0 * size.1]),
        |(width, pixels), position, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[position.1 * *width + position.0] = [r, g, b];
        },
    )
    .map_err(|error| crate::error::Error::input(format!("the image cannot be read: {error}")))?;
    let size = image.layer_data.size;
    Ok((size.0, size.1, image.layer_data.channel_data.pixels.1))
}

/// Refuses a file if its header states far more pixels than the file can contain.
fn check_size(path: &Path) -> Result<()> {
    const ALWAYS_ALLOWED: u64 = 1 << 24;
    const MOST_PER_BYTE: u64 = 100;
    let unreadable = |error: &dyn std::fmt::Display| Error::input(format!("the image cannot be read: {error}"));
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|error| unreadable(&error))?;
    let bytes = std::fs::metadata(path).map_err(|error| unreadable(&error))?.len();
    let area = |size: exr::math::Vec2<usize>| (size.0 as u64).saturating_mul(size.1 as u64);
    let pixels = meta.headers.iter().map(|header| area(header.layer_size)).max().unwrap_or(0);
    if pixels > ALWAYS_ALLOWED.max(bytes.saturating_mul(MOST_PER_BYTE)) {
        return Err(Error::input(format!("the image is damaged: {bytes} bytes cannot hold {pixels} pixels")));
    }
    Ok(())
}

fn read_other(path: &Path) -> Result<Pixels> {
    let image = image::open(path).map_err(|error| Error::input(format!("the image cannot be read: {error}")))?;
    let linear = matches!(image, image::DynamicImage::ImageRgb32F(_) | image::DynamicImage::ImageRgba32F(_));
    let pixels = image.to_rgb32f();
    let decode = |c: f32| if linear { c } else { crate::colour::decode_srgb(f64::from(c)) as f32 };
    let rgb = pixels.pixels().map(|pixel| pixel.0.map(decode)).collect();
    Ok((pixels.width() as usize, pixels.height() as usize, rgb))
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
