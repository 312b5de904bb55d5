//! The film as written → how it is exposed, and how the picture is shown.

use super::Resolver;
use super::spectra::Role;
use crate::colour::gamut::GamutMapping;
use crate::colour::{RgbSpace, Transform, Xyz};
use crate::error::{Error, Result};
use crate::scene::file::{
    CameraFile, ExposureFile, FilmFile, GamutFile, JsonPath, LensFile, ObserverFile, OutputSpaceFile, SpectrumFile,
    WhiteBalanceFile,
};
use crate::scene::{Exposure, FilmSpec, Scene};
use crate::spectrum::Observer;

impl Resolver<'_> {
    /// Resolves the film; its white is found by [`white`](Self::white) when the lights are known.
    pub(super) fn film(&self, at: &JsonPath<'_>, film: &FilmFile) -> Result<FilmSpec> {
        let FilmFile { width, height, observer, spectral_bands, gamut, white_balance: _, output_space, exposure } =
            film;
        let exposure = match exposure {
            ExposureFile::Auto => Exposure::Auto,
            ExposureFile::None => Exposure::None,
            ExposureFile::Ev(ev) => Exposure::Ev(*ev),
            ExposureFile::Iso(iso) => Exposure::White(self.white_luminance(&at.key("exposure").key("iso"), *iso)?),
        };
        let observer = match observer {
            ObserverFile::Cie1931 => Observer::cie1931(),
            ObserverFile::Cie1964 => Observer::cie1964(),
            ObserverFile::Cie2015Two => Observer::cie2015_2(),
            ObserverFile::Cie2015Ten => Observer::cie2015_10(),
        };
        let gamut = match gamut {
            GamutFile::Desaturate => GamutMapping::Desaturate,
            GamutFile::Clip => GamutMapping::Clip,
            GamutFile::Oklab => GamutMapping::Oklab,
        };
        let space = match output_space {
            OutputSpaceFile::Srgb => RgbSpace::Srgb,
            OutputSpaceFile::DisplayP3 => RgbSpace::DisplayP3,
            OutputSpaceFile::Rec2020 => RgbSpace::Rec2020,
            OutputSpaceFile::Acescg => RgbSpace::AcesCg,
        };
        let (width, height, spectral_bands) = (*width, *height, *spectral_bands);
        Ok(FilmSpec { width, height, observer, spectral_bands, space, white: None, gamut, exposure })
    }

    /// The luminance in cd/m² that a film of this speed shows white. The middle of the film gets q·L·t/N² lx·s, where q = 0.65 stands for the
    /// lens's losses, and is white at 78/S lx·s: saturation-based speed (ISO 12232).
    fn white_luminance(&self, at: &JsonPath<'_>, iso: f64) -> Result<f64> {
        let CameraFile { lens, .. } = &self.scene.camera;
        let f_number = match lens {
            LensFile::Pinhole { fov: _ } => None,
            LensFile::Thin(lens) => lens.f_number,
            LensFile::System(lens) => lens.f_number,
        };
        let exposure_s = Some(self.shutter.exposure_s()).filter(|&seconds| seconds > 0.0);
        let Some((f_number, exposure_s)) = f_number.zip(exposure_s) else {
            let error = Error::input("found a film's speed, and a camera without an f-number or a shutter time");
            return self
                .at(at, Err(error.expected("a lens with `f_number` and a `shutter` that is open for some time")));
        };
        Ok(78.0 / (0.65 * iso) * f_number * f_number / exposure_s)
    }

    /// The light that the film's white balance makes white, as XYZ of the film's observer.
    pub(super) fn white(&self, scene: &Scene) -> Result<Option<Xyz>> {
        let root = JsonPath::Root;
        let film = root.key("film");
        let at = film.key("white_balance");
        let (white, what) = match &self.scene.film.white_balance {
            WhiteBalanceFile::None => return Ok(None),
            WhiteBalanceFile::Scene => (lamps(scene), "the scene's light".to_string()),
            WhiteBalanceFile::Illuminant(name) => {
                let light = self.spectrum(&at, &SpectrumFile::Name(name.clone()), Role::Light)?;
                (scene.film.observer.xyz(&light), format!("\"{name}\""))
            }
        };
        if !Transform::Bradford.can_adapt_from(white) {
            let what = format!("{what} has a colour too pure to be balanced to white");
            return self.at(&at, Err(Error::input(what).expected("light with some red, green and blue in it")));
        }
        Ok(Some(white))
    }
}

/// XYZ of all lights together, each with the power that it sends into the scene.
fn lamps(scene: &Scene) -> Xyz {
    let mut sum = [0.0; 3];
    for light in &scene.lights {
        let power_w = light.power_w(scene.world());
        let xyz = scene.film.observer.xyz(&light.spectrum);
        sum.iter_mut().zip(xyz).for_each(|(sum, value)| *sum += power_w * value);
    }
    sum
}
