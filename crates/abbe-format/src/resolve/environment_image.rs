//! Reads image files as environment maps.

use crate::picture_file::{BandPicture, contents};
use crate::picture_primaries::ColourUse;
use crate::{PictureFile, light::ProjectionFile};
use abbe_scene::light::{EnvironmentBands, EnvironmentMap};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan2, cos};
use abbe_spectra::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::path::Path;

/// An environment map, and the scale of its pixels.
pub(super) struct EnvironmentImage {
    pub(super) map: EnvironmentMap,
    pub(super) scale: ImageScale,
}

/// The scale of the pixels of a picture.
pub(super) enum ImageScale {
    /// The mean luminance over all directions. The pixel (1, 1, 1) has the luminance 1.
    Colours { mean_luminance: f64 },
    /// The mean radiance over all directions in W/m²/sr over 360–830 nm.
    Radiance { mean_radiance: f64 },
    /// The picture has spectral bands in a unit that is not one of radiance.
    UnknownUnit(String),
}

/// The units of spectral radiance, without blanks. The layout of Fichet, Pacanowski and Wilkie
/// leaves out "per nm".
const RADIANCE_UNITS: [&str; 2] = ["W.m^-2.sr^-1", "W.m^-2.sr^-1.nm^-1"];

/// Reads a picture of all directions (EXR, HDR, PNG, JPEG, WebP), rotated by `to_world`. The
/// spectral channels of an EXR file are spectral radiances; all other pictures are linear sRGB.
pub(super) fn load(path: &Path, projection: ProjectionFile, to_world: DAffine3) -> Result<EnvironmentImage> {
    let bytes = contents(path)?;
    let image = match BandPicture::of_light(&bytes) {
        Ok(Some(bands)) => spectral(bands, projection, to_world),
        Ok(None) => colours(&bytes, projection, to_world),
        Err(error) => Err(error),
    };
    image.map_err(|error| error.in_file(path))
}

/// Returns the map of a picture with spectral bands.
fn spectral(picture: BandPicture, projection: ProjectionFile, to_world: DAffine3) -> Result<EnvironmentImage> {
    let BandPicture { size, nm, values, emissive_units } = picture;
    let (width, height, values) = upright((size.width, size.height), values, nm.len(), projection, to_world)?;
    let bands = EnvironmentBands::new(&nm, values)?;
    let (map, mean_radiance) = EnvironmentMap::from_bands(width, height, bands)
        .ok_or_else(|| Error::input("the image is black within 360–830 nm").expected("at least one value above 0"))?;
    let unit: Option<String> = emissive_units.map(|unit| unit.split_whitespace().collect());
    let scale = match unit {
        Some(unit) if !RADIANCE_UNITS.contains(&unit.as_str()) => ImageScale::UnknownUnit(unit),
        Some(_) | None => ImageScale::Radiance { mean_radiance },
    };
    Ok(EnvironmentImage { map, scale })
}

/// Returns the map of a picture as linear sRGB.
fn colours(bytes: &[u8], projection: ProjectionFile, to_world: DAffine3) -> Result<EnvironmentImage> {
    let picture = PictureFile::decode(bytes)?;
    let (width, height) = (picture.size.width, picture.size.height);
    let rgb = picture.linear(None, ColourUse::Light);
    if rgb.iter().flatten().any(|c| !c.is_finite() || *c < 0.0) {
        return Err(Error::input("the image has values that are negative or not finite"));
    }
    let (width, height, values) = upright((width, height), rgb.into_flattened(), 3, projection, to_world)?;
    let (rgb, _) = values.as_chunks::<3>();
    let lights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let [red, green, blue] = lights.map(Spectrum::rgb_light);
    let map = EnvironmentMap::new(width, height, rgb, [&red?, &green?, &blue?])
        .ok_or_else(|| Error::input("the image is black").expected("at least one pixel above 0"))?;
    Ok(EnvironmentImage { map, scale: ImageScale::Colours { mean_luminance: mean_luminance(width, height, rgb) } })
}

/// Converts the values of an image, with `channels` of them in each pixel, to an equirectangular
/// image that is rotated by `to_world`. Returns it with its width and height.
fn upright(
    (width, height): (usize, usize),
    values: Vec<f32>,
    channels: usize,
    projection: ProjectionFile,
    to_world: DAffine3,
) -> Result<(usize, usize, Vec<f32>)> {
    let (width, height, values) = match projection {
        ProjectionFile::Equirectangular => (width, height, values),
        ProjectionFile::EqualArea if width == height => (2 * width, height, equirectangular(width, &values, channels)),
        ProjectionFile::EqualArea => {
            return Err(Error::input(format!("the image has {width} × {height} pixels"))
                .expected("a square image, because its projection is \"equal_area\""));
        }
    };
    let is_rotated = to_world != DAffine3::IDENTITY;
    let values = if is_rotated { rotated((width, height), &values, channels, to_world) } else { values };
    Ok((width, height, values))
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
fn equirectangular(size: usize, values: &[f32], channels: usize) -> Vec<f32> {
    const SAMPLES: usize = 4;
    let (columns, rows) = (SAMPLES * 2 * size, SAMPLES * size);
    let lookup = |x: usize, y: usize| {
        let place = [(x as f64 + 0.5) / columns as f64, (y as f64 + 0.5) / rows as f64];
        let [u, v] = equal_area_point(EnvironmentMap::direction(place));
        let cell = |t: f64| ((t * size as f64) as usize).min(size - 1);
        &values[channels * (cell(v) * size + cell(u))..][..channels]
    };
    let mut means = vec![0.0; 2 * size * size * channels];
    for (index, mean) in means.chunks_exact_mut(channels).enumerate() {
        let (column, row) = (SAMPLES * (index % (2 * size)), SAMPLES * (index / (2 * size)));
        for (x, y) in (0..SAMPLES * SAMPLES).map(|i| (column + i % SAMPLES, row + i / SAMPLES)) {
            mean.iter_mut().zip(lookup(x, y)).for_each(|(sum, value)| *sum += value);
        }
        mean.iter_mut().for_each(|sum| *sum /= (SAMPLES * SAMPLES) as f32);
    }
    means
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
fn rotated((width, height): (usize, usize), values: &[f32], channels: usize, to_world: DAffine3) -> Vec<f32> {
    let back = to_world.matrix3.inverse();
    (0..width * height)
        .flat_map(|index| {
            let centre = [(index % width) as f64 + 0.5, (index / width) as f64 + 0.5];
            let direction = EnvironmentMap::direction([centre[0] / width as f64, centre[1] / height as f64]);
            let [u, v] = EnvironmentMap::point((back * direction).normalize());
            let column = ((u * width as f64) as usize).min(width - 1);
            let row = ((v * height as f64) as usize).min(height - 1);
            &values[channels * (row * width + column)..][..channels]
        })
        .copied()
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

    /// Writes an OpenEXR file of 4 × 2 pixels, in which `value` gives the values of each channel.
    fn write_exr(path: &Path, channels: &[&str], unit: Option<&str>, value: impl Fn(&str, usize) -> f32) {
        use exr::prelude::*;
        let channel =
            |name: &&str| AnyChannel::new(*name, FlatSamples::F32((0..8).map(|pixel| value(name, pixel)).collect()));
        let channels = AnyChannels::sort(channels.iter().map(channel).collect());
        let mut layer = Layer::new((4, 2), LayerAttributes::default(), Encoding::UNCOMPRESSED, channels);
        if let Some(unit) = unit {
            layer.attributes.other.insert("emissiveUnits".into(), attribute::AttributeValue::Text(unit.into()));
        }
        Image::from_layer(layer).write().to_file(path).unwrap();
    }

    const CHANNELS: [&str; 7] = ["R", "G", "B", "S0.450,000000nm", "S0.550nm", "S0.600nm", "S1.550nm"];

    /// The radiance of a spectral channel at a pixel in W/m²/sr/nm; other channels have 7.
    fn radiance(name: &str, pixel: usize) -> f32 {
        let band = ["S0.450,000000nm", "S0.550nm", "S0.600nm"].iter().position(|channel| *channel == name);
        band.map_or(7.0, |band| ((pixel * 5 + band * 3) % 4) as f32 * 0.25)
    }

    /// Resolves the environment `sky.exr` of a folder with further keys of the light.
    fn environment(folder: &Path, keys: &str) -> Result<abbe_scene::light::Light> {
        let text = format!(
            r#"{{"camera": {{"from": [0, 0, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
            "film": {{"width": 8, "height": 8}}, "materials": {{"white": {{"diffuse": {{"reflectance": 0.8}}}}}},
            "objects": [{{"shape": {{"sphere": {{"radius": 1}}}}, "material": "white"}}],
            "lights": [{{"environment": {{"image": "sky.exr"{keys}}}}}]}}"#
        );
        let (scene, source) = crate::parse(text, &folder.join("scene.json"), &[])?;
        crate::resolve::resolve(&scene, &source).map(|mut scene| scene.lights.remove(0))
    }

    /// The spectral radiance of a light in a direction, in W/m²/sr/nm.
    fn spectral_radiance(light: &abbe_scene::light::Light, direction: DVec3, nm: f64) -> f64 {
        let (radiance, spd) = light.le(direction).unwrap();
        if radiance > 0.0 { radiance * light.spd_at(spd, nm) } else { 0.0 }
    }

    /// The bands are 400–500, 500–575 and 575–625 nm.
    const INSIDE: [(f64, &str); 5] = [
        (401.0, "S0.450,000000nm"),
        (499.0, "S0.450,000000nm"),
        (501.0, "S0.550nm"),
        (574.0, "S0.550nm"),
        (624.0, "S0.600nm"),
    ];

    #[test]
    fn spectral_channels_are_the_radiance_of_each_direction() {
        let folder = tempfile::tempdir().unwrap();
        write_exr(&folder.path().join("sky.exr"), &CHANNELS, Some("W.m^-2.sr^-1"), radiance);
        let upright = environment(folder.path(), "").unwrap();
        let turned =
            environment(folder.path(), r#", "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 90}}]"#).unwrap();
        let doubled = environment(folder.path(), r#", "luminance": 2"#).unwrap();
        for pixel in 0..8 {
            let place = [(pixel % 4) as f64 / 4.0 + 0.125, (pixel / 4) as f64 / 2.0 + 0.25];
            let direction = EnvironmentMap::direction(place);
            let turned_direction = glam::DQuat::from_rotation_y(PI / 2.0) * direction;
            for (nm, channel) in INSIDE {
                let expected = f64::from(radiance(channel, pixel));
                for (light, direction, factor) in
                    [(&upright, direction, 1.0), (&turned, turned_direction, 1.0), (&doubled, direction, 2.0)]
                {
                    let found = spectral_radiance(light, direction, nm);
                    assert!((found - factor * expected).abs() < 1e-6, "{pixel}, {nm} nm: {found}, not {expected}");
                }
            }
            assert_eq!(spectral_radiance(&upright, direction, 700.0), 0.0);
        }
    }

    /// π × the mean radiance, where the rows of a picture of 4 × 2 pixels have equal solid angles.
    #[test]
    fn an_irradiance_scales_the_mean_of_spectral_channels() {
        let folder = tempfile::tempdir().unwrap();
        write_exr(&folder.path().join("sky.exr"), &CHANNELS, Some("photons"), radiance);
        let light = environment(folder.path(), r#", "irradiance": 3"#).unwrap();
        let widths = [("S0.450,000000nm", 100.0), ("S0.550nm", 75.0), ("S0.600nm", 50.0)];
        let of =
            |pixel: usize| widths.iter().map(|(name, width)| f64::from(radiance(name, pixel)) * width).sum::<f64>();
        let mean = (0..8).map(of).sum::<f64>() / 8.0;
        let direction = EnvironmentMap::direction([0.125, 0.25]);
        let expected = f64::from(radiance("S0.550nm", 0)) / mean * 3.0 / PI;
        let found = spectral_radiance(&light, direction, 550.0);
        assert!(expected > 0.0 && (found / expected - 1.0).abs() < 1e-6, "{found} instead of {expected}");
        for keys in ["", r#", "luminance": 1"#] {
            let error = environment(folder.path(), keys).unwrap_err().to_string();
            assert!(error.contains("lights[0].environment.image") && error.contains("\"photons\""), "{error}");
        }
    }

    #[test]
    fn wrong_spectral_pictures_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        let message = |channels: &[&str], value: f32, keys: &str| {
            write_exr(&path, channels, None, |_, _| value);
            environment(folder.path(), keys).unwrap_err().to_string()
        };
        assert!(message(&["S0.550nm"], 1.0, "").contains("two or more"));
        assert!(message(&["S0.550nm", "S0.560nm"], -1.0, "").contains("radiance of -1"));
        assert!(message(&["S0.550nm", "S0.560nm"], 0.0, "").contains("black"));
        assert!(message(&["S0.1550nm", "S0.1560nm"], 1.0, "").contains("between 360 and 830"));
        // A picture of colours needs a quantity.
        let error = message(&["R", "G", "B"], 1.0, "");
        assert!(error.contains("lights[0].environment") && error.contains("luminance"), "{error}");
    }

    /// All pixels of an equal-area image have the same solid angle, so the mean is kept.
    #[test]
    fn an_equal_area_image_keeps_its_mean() {
        let size = 32;
        let rgb: Vec<[f32; 3]> = (0..size * size).map(|i| [1.0 + (i % size * (i / size)) as f32; 3]).collect();
        let mean = rgb.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / rgb.len() as f64;
        let converted = mean_luminance(2 * size, size, equirectangular(size, rgb.as_flattened(), 3).as_chunks().0);
        assert!((converted / mean - 1.0).abs() < 2e-3, "{converted} instead of {mean}");
    }
}
