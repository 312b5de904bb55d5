//! The conversion of a picture to an image for a display.

use super::job::Job;
use crate::output::metadata::{Metadata, names};
use abbe_scene::Exposure;
use abbe_spectra::colour::{RgbSpace, Transfer, Xyz};
use abbe_spectra::math::elementary::exp2;
use abbe_transport::sensor::{Development, DisplayImage, Picture, develop, exposure};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisplaySettings {
    pub development: Development,
    pub exposure: Exposure,
    /// The XYZ of all lights of the scene together, for white balance. `None` without a scene.
    pub lights: Option<Xyz>,
    /// Whether the denoised picture is shown. `None` shows it if it is safe by its own error bars.
    #[serde(default)]
    pub denoise: Option<bool>,
}

impl DisplaySettings {
    /// The settings of a picture without a scene: automatic exposure and sRGB.
    pub fn automatic() -> Self {
        Self { development: Development::default(), exposure: Exposure::Auto, lights: None, denoise: None }
    }

    pub fn of(job: &Job) -> Self {
        let film = &job.scene.film;
        let development = Development {
            space: film.space,
            transfer: film.transfer,
            white: film.white,
            gamut: film.gamut,
            tone: film.tone,
            bloom: film.bloom,
        };
        let lights = Some(job.scene.xyz_of_lights());
        Self { development, exposure: film.exposure, lights, denoise: film.denoise }
    }

    /// Returns the settings in the header of a picture, if this version can read them.
    pub fn of_header(header: &Metadata) -> Option<Self> {
        serde_json::from_str(header.get(names::DISPLAY)?).ok()
    }

    #[must_use]
    pub fn in_space(self, space: RgbSpace) -> Self {
        let development = Development { space, transfer: Transfer::OfSpace, ..self.development };
        Self { development, ..self }
    }

    /// Returns true if the denoised picture is shown.
    pub fn shows_denoised(&self, picture: &Picture) -> bool {
        picture.denoised.is_some() && self.denoise.unwrap_or_else(|| picture.is_safe_to_denoise())
    }

    /// Returns the picture that is shown: the denoised one or the picture itself.
    pub fn shown<'p>(&self, picture: &'p Picture) -> Cow<'p, Picture> {
        let denoised = if self.shows_denoised(picture) { picture.denoised() } else { None };
        denoised.map_or(Cow::Borrowed(picture), Cow::Owned)
    }

    /// Returns the factor that multiplies the luminances of a picture, in 1/(cd/m²).
    pub fn factor(&self, picture: &Picture) -> f64 {
        self.factor_of(|| self.shown(picture))
    }

    fn factor_of<'p>(&self, shown: impl FnOnce() -> Cow<'p, Picture>) -> f64 {
        match self.exposure {
            Exposure::Auto => exposure::automatic(&shown()),
            Exposure::Ev(ev) => exp2(ev),
            Exposure::White(luminance) => luminance.recip(),
            Exposure::None => 1.0,
        }
    }

    /// Converts a picture for a display. Also returns its exposure in 1/(cd/m²).
    pub fn screen_and_factor(&self, picture: &Picture) -> (DisplayImage, f64) {
        let shown = self.shown(picture);
        let factor = self.factor_of(|| Cow::Borrowed(&shown));
        (develop(&shown, factor, &self.development), factor)
    }

    pub fn screen(&self, picture: &Picture) -> DisplayImage {
        self.screen_and_factor(picture).0
    }

    /// Converts a picture for a display with a given exposure in 1/(cd/m²).
    pub fn screen_at(&self, picture: &Picture, factor: f64) -> DisplayImage {
        develop(&self.shown(picture), factor, &self.development)
    }
}
