//! Translates the textures of the scene file.

use super::{context::Resolver, spectra::Role};
use crate::{
    BandImageFile, ChannelFile, ColourImageFile, EncodingFile, FilterFile, GradientFile, GreenFile, JsonPath,
    NoisePatternFile, NormalMapFile, PatternFile, PictureFile, ReflectanceFile, ScalarFile, ScalarImageFile, UvFile,
    WrapFile, picture_file::BandPicture,
};
use abbe_optics::texture::{
    Filter, GradientPattern, ImagePattern, ImageSize, NoisePattern, NormalMap, Pattern, ScalarTexture, SpectralTexture,
    SurfaceScalar, SurfaceSpectrum, UvTransform, Wrap,
};
use abbe_spectra::error::{Error, Result, both};
use glam::Vec3;

/// The amount by which a reflectance may exceed 1 because of rounding. It is then reduced to 1.
const ROUNDING: f32 = 1e-3;

impl Resolver<'_> {
    /// Resolves a reflectance or a transmittance.
    pub(super) fn reflectance(&self, at: &JsonPath, file: &ReflectanceFile) -> Result<SurfaceSpectrum> {
        let parts = |at: &JsonPath, a: &ReflectanceFile, b: &ReflectanceFile| {
            both(self.reflectance(&at.key("a"), a), self.reflectance(&at.key("b"), b))
        };
        let texture = match file {
            ReflectanceFile::Spectrum(spectrum) => {
                return self.spectrum(at, spectrum, Role::Reflectance).map(SurfaceSpectrum::Uniform);
            }
            ReflectanceFile::Image(file) => self.at(&at.key("image"), self.colour_image(file))?,
            ReflectanceFile::Bands(file) => self.at(&at.key("bands"), self.band_image(file))?,
            ReflectanceFile::Checker(file) => {
                let (a, b) = parts(&at.key("checker"), &file.a, &file.b)?;
                SpectralTexture::from_parts(Pattern::Checker(uv_of(file)), [a, b])
            }
            ReflectanceFile::Stripes(file) => {
                let (a, b) = parts(&at.key("stripes"), &file.a, &file.b)?;
                SpectralTexture::from_parts(Pattern::Stripes(uv_of(file)), [a, b])
            }
            ReflectanceFile::Noise(file) => {
                let (a, b) = parts(&at.key("noise"), &file.a, &file.b)?;
                SpectralTexture::from_parts(noise_pattern(file), [a, b])
            }
        };
        Ok(texture.into())
    }

    /// Resolves a number that may vary over a surface.
    pub(super) fn scalar(&self, at: &JsonPath, file: &ScalarFile) -> Result<SurfaceScalar> {
        let texture = match file {
            ScalarFile::Number(number) => return Ok(SurfaceScalar::Uniform(*number)),
            ScalarFile::Image(file) => self.at(&at.key("image"), self.scalar_image(file))?,
            ScalarFile::Checker(file) => ScalarTexture::from_pair(Pattern::Checker(uv_of(file)), [file.a, file.b]),
            ScalarFile::Stripes(file) => ScalarTexture::from_pair(Pattern::Stripes(uv_of(file)), [file.a, file.b]),
            ScalarFile::Noise(file) => ScalarTexture::from_pair(noise_pattern(file), [file.a, file.b]),
            ScalarFile::Gradient(GradientFile { a, b, power, radial, uv }) => {
                let gradient = GradientPattern { radial: *radial, power: *power };
                ScalarTexture::from_pair(Pattern::Gradient(gradient, transform(uv)), [*a, *b])
            }
        };
        Ok(SurfaceScalar::Textured(texture))
    }

    fn colour_image(&self, file: &ColourImageFile) -> Result<SpectralTexture> {
        let ColourImageFile { path, encoding, factor, wrap, filter, uv } = file;
        if let Some((_, texture)) = self.textures.borrow().iter().find(|(known, _)| known == file) {
            return Ok(texture.clone());
        }
        let path = self.source.file(path)?;
        let picture = PictureFile::read(&path)?;
        let pattern = image_pattern(picture.size, *wrap, *filter, uv).map_err(|error| error.in_file(&path))?;
        let mut colours = picture.linear_rgb(*encoding);
        for colour in &mut colours {
            for (component, factor) in colour.iter_mut().zip(factor) {
                *component *= *factor as f32;
            }
        }
        fractions(colours.as_flattened_mut(), 3, picture.size).map_err(|error| error.in_file(&path))?;
        let texture = SpectralTexture::from_colours(pattern, colours);
        self.textures.borrow_mut().push((file.clone(), texture.clone()));
        Ok(texture)
    }

    fn band_image(&self, file: &BandImageFile) -> Result<SpectralTexture> {
        let BandImageFile { path, factor, wrap, filter, uv } = file;
        let path = self.source.file(path)?;
        let BandPicture { size, nm, mut values, .. } = BandPicture::read(&path)?;
        let pattern = image_pattern(size, *wrap, *filter, uv).map_err(|error| error.in_file(&path))?;
        values.iter_mut().for_each(|value| *value *= *factor as f32);
        fractions(&mut values, nm.len(), size).map_err(|error| error.in_file(&path))?;
        Ok(SpectralTexture::from_bands(pattern, nm, values))
    }

    pub(super) fn normal_map(&self, file: &NormalMapFile) -> Result<NormalMap> {
        let NormalMapFile { material: _, path, strength, green, wrap, filter, uv } = file;
        let path = self.source.file(path)?;
        let picture = PictureFile::read(&path)?;
        let pattern = image_pattern(picture.size, *wrap, *filter, uv).map_err(|error| error.in_file(&path))?;
        let x = *strength as f32;
        let y = if *green == GreenFile::Up { x } else { -x };
        let encoded = picture.components(Some(EncodingFile::Linear));
        Ok(NormalMap::from_picture(pattern, &encoded, Vec3::new(x, y, 1.0)))
    }

    fn scalar_image(&self, file: &ScalarImageFile) -> Result<ScalarTexture> {
        let ScalarImageFile { path, channel, encoding, range, wrap, filter, uv } = file;
        let path = self.source.file(path)?;
        let picture = PictureFile::read(&path)?;
        let pattern = image_pattern(picture.size, *wrap, *filter, uv).map_err(|error| error.in_file(&path))?;
        let number = match channel {
            ChannelFile::Red => 0,
            ChannelFile::Green => 1,
            ChannelFile::Blue => 2,
            ChannelFile::Alpha => 3,
        };
        let mut values = picture.linear_channel(number, *encoding);
        if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
            return Err(Error::input(format!("found a pixel with the value {bad}")).in_file(&path));
        }
        let [from, to] = range.map(|x| x as f32);
        values.iter_mut().for_each(|value| *value = from + (to - from) * *value);
        Ok(ScalarTexture::from_values(pattern, values))
    }
}

/// Checks that all values lie in [0, 1]. Values that exceed 1 only by rounding become 1.
/// `per_pixel` is the number of values of a pixel.
fn fractions(values: &mut [f32], per_pixel: usize, size: ImageSize) -> Result<()> {
    for (i, value) in values.iter_mut().enumerate() {
        if !(-ROUNDING..=1.0 + ROUNDING).contains(value) {
            let (pixel, width) = (i / per_pixel, size.width);
            let what = format!("found the value {value} at the pixel ({}, {})", pixel % width, pixel / width);
            return Err(Error::input(what).expected("reflectances from 0 to 1; `factor` scales them"));
        }
        *value = value.clamp(0.0, 1.0);
    }
    Ok(())
}

fn image_pattern(size: ImageSize, wrap: WrapFile, filter: FilterFile, uv: &UvFile) -> Result<ImagePattern> {
    let wrap = match wrap {
        WrapFile::Repeat => Wrap::Repeat,
        WrapFile::Mirror => Wrap::Mirror,
        WrapFile::Clamp => Wrap::Clamp,
    };
    let filter = match filter {
        FilterFile::Bilinear => Filter::Bilinear,
        FilterFile::Nearest => Filter::Nearest,
    };
    ImagePattern::new(size, [wrap; 2], filter, transform(uv))
}

fn transform(uv: &UvFile) -> UvTransform {
    let UvFile { scale, rotate, offset } = *uv;
    UvTransform::new(scale, rotate.to_radians(), offset)
}

fn uv_of<T>(file: &PatternFile<T>) -> UvTransform {
    transform(&file.uv).scaled(file.scale)
}

fn noise_pattern<T>(file: &NoisePatternFile<T>) -> Pattern {
    let noise = NoisePattern { octaves: file.octaves, seed: file.seed };
    Pattern::Noise(noise, transform(&file.uv).scaled(file.scale))
}
