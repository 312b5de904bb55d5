//! Reads image files as environment maps.

use crate::picture_primaries::ColourUse;
use crate::{PictureFile, light::ProjectionFile};
use abbe_scene::light::EnvironmentMap;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan2, cos};
use abbe_spectra::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::path::Path;

/// An environment map, and the scale of its pixels.
pub(super) struct EnvironmentImage {
    pub(super) map: EnvironmentMap,
    /// The mean luminance over all directions. The pixel (1, 1, 1) has the luminance 1.
    pub(super) mean_luminance: f64,
}

/// Reads a picture of all directions (EXR, HDR, PNG, JPEG, WebP) as linear sRGB, rotated by
/// `to_world`.
pub(super) fn load(path: &Path, projection: ProjectionFile, to_world: DAffine3) -> Result<EnvironmentImage> {
    let picture = PictureFile::read(path)?;
    let (width, height) = (picture.size.width, picture.size.height);
    let rgb = picture.linear(None, ColourUse::Light);
    if rgb.iter().flatten().any(|c| !c.is_finite() || *c < 0.0) {
        return Err(Error::input("the image has values that are negative or not finite").in_file(path));
    }
    let (width, height, rgb) = match projection {
        ProjectionFile::Equirectangular => (width, height, rgb),
        ProjectionFile::EqualArea if width == height => (2 * width, height, equirectangular(width, &rgb)),
        ProjectionFile::EqualArea => {
            return Err(Error::input(format!("the image has {width} × {height} pixels"))
                .expected("a square image, because its projection is \"equal_area\"")
                .in_file(path));
        }
    };
    let rgb = if to_world == DAffine3::IDENTITY { rgb } else { rotated(width, height, &rgb, to_world) };
    let lights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let [red, green, blue] = lights.map(Spectrum::rgb_light);
    let map = EnvironmentMap::new(width, height, &rgb, [&red?, &green?, &blue?])
        .ok_or_else(|| Error::input("the image is black").expected("at least one pixel above 0").in_file(path))?;
    Ok(EnvironmentImage { map, mean_luminance: mean_luminance(width, height, &rgb) })
}

/// Returns the mean luminance of an equirectangular image over all directions.
fn mean_luminance(width: usize, height: usize, rgb: &[[f32; 3]]) -> f64 {
    let luminance = |pixel: &[f32; 3]| {
        let [r, g, b] = pixel.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let edge = |row: usize| cos(PI * row as f64 / height as f64);
    let rows = rgb.chunks_exact(width).enumerate();
    let sum: f64 = rows.map(|(row, it)| (edge(row) - edge(row + 1)) * it.iter().map(luminance).sum::<f64>()).sum();
    sum / (2.0 * width as f64)
}

/// Converts a square equal-area image to an equirectangular one of twice the width (4 × 4 means).
fn equirectangular(size: usize, rgb: &[[f32; 3]]) -> Vec<[f32; 3]> {
    const SAMPLES: usize = 4;
    let (columns, rows) = (SAMPLES * 2 * size, SAMPLES * size);
    let lookup = |x: usize, y: usize| {
        let place = [(x as f64 + 0.5) / columns as f64, (y as f64 + 0.5) / rows as f64];
        let [u, v] = equal_area_point(EnvironmentMap::direction(place));
        let cell = |t: f64| ((t * size as f64) as usize).min(size - 1);
        rgb[cell(v) * size + cell(u)]
    };
    let mean = |index: usize| {
        let (column, row) = (SAMPLES * (index % (2 * size)), SAMPLES * (index / (2 * size)));
        let mut sum = [0.0_f32; 3];
        for (x, y) in (0..SAMPLES * SAMPLES).map(|i| (column + i % SAMPLES, row + i / SAMPLES)) {
            sum.iter_mut().zip(lookup(x, y)).for_each(|(sum, c)| *sum += c);
        }
        sum.map(|c| c / (SAMPLES * SAMPLES) as f32)
    };
    (0..2 * size * size).map(mean).collect()
}

/// Returns the point of an equal-area octahedral image that lies in a direction (Clarberg 2008,
/// "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD"). The coordinates are from 0 to 1.
fn equal_area_point(direction: DVec3) -> [f64; 2] {
    let [x, y, z] = direction.abs().to_array();
    let r = (1.0 - z).max(0.0).sqrt();
    let phi = if x == 0.0 && y == 0.0 { 0.0 } else { 2.0 / PI * atan2(y, x) };
    let (u, v) = (r - phi * r, phi * r);
    let (u, v) = if direction.z < 0.0 { (1.0 - v, 1.0 - u) } else { (u, v) };
    [0.5 + 0.5 * u.copysign(direction.x), 0.5 + 0.5 * v.copysign(direction.y)]
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Clarberg's mapping from the square to the sphere, written out from the paper.
    fn equal_area_direction([s, t]: [f64; 2]) -> DVec3 {
        let (u, v) = (2.0 * s - 1.0, 2.0 * t - 1.0);
        let signed = 1.0 - (u.abs() + v.abs());
        let r = 1.0 - signed.abs();
        let phi = if r == 0.0 { 1.0 } else { (v.abs() - u.abs()) / r + 1.0 } * PI / 4.0;
        let rho = r * (2.0 - r * r).sqrt();
        DVec3::new(rho * phi.cos().copysign(u), rho * phi.sin().copysign(v), (1.0 - r * r).copysign(signed))
    }

    #[test]
    fn the_equal_area_projection_is_inverted() {
        for i in 0..400 {
            let place = [(f64::from(i % 20) + 0.31) / 20.0, (f64::from(i / 20) + 0.77) / 20.0];
            let found = equal_area_point(equal_area_direction(place));
            assert!(found.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} instead of {place:?}");
        }
    }

    /// All pixels of an equal-area image have the same solid angle, so the mean is kept.
    #[test]
    fn an_equal_area_image_keeps_its_mean() {
        let size = 32;
        let rgb: Vec<[f32; 3]> = (0..size * size).map(|i| [1.0 + (i % size * (i / size)) as f32; 3]).collect();
        let mean = rgb.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / rgb.len() as f64;
        let converted = mean_luminance(2 * size, size, &equirectangular(size, &rgb));
        assert!((converted / mean - 1.0).abs() < 2e-3, "{converted} instead of {mean}");
    }
}
