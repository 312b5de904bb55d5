//! Translates the film of the scene file, with its exposure and white balance.

use super::{context::Resolver, spectra::Role};
use crate::{
    BloomFile, CameraFile, ExposureFile, FilmFile, GamutFile, JsonPath, LayerFile, LensFile, ObserverFile,
    OutputSpaceFile, SpectrumFile, ToneFile, WhiteBalanceFile,
};
use abbe_scene::builder::WhiteBalance;
use abbe_scene::{Bloom, Exposure, FilmSpec, Layer};
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{RgbSpace, Transfer};
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::Observer;

impl Resolver<'_> {
    /// Resolves the film, without the white that the scene builder finds from the white balance.
    pub(super) fn film(&self, at: &JsonPath, film: &FilmFile, camera: &CameraFile) -> Result<FilmSpec> {
        let FilmFile {
            width,
            height,
            observer,
            spectral_bands,
            layers,
            gamut,
            tone,
            output_space,
            exposure,
            bloom,
            stokes,
            denoise,
            ..
        } = film;
        let exposure = match exposure {
            ExposureFile::Auto => Exposure::Auto,
            ExposureFile::None => Exposure::None,
            ExposureFile::Ev(ev) => Exposure::Ev(*ev),
            ExposureFile::Iso(iso) => {
                Exposure::White(self.white_luminance(&at.key("exposure").key("iso"), *iso, &camera.lens)?)
            }
        };
        let observer = match observer {
            ObserverFile::Cie1931 => Observer::cie1931(),
            ObserverFile::Cie1964 => Observer::cie1964(),
            ObserverFile::Cie2015Two => Observer::cie2015_2(),
            ObserverFile::Cie2015Ten => Observer::cie2015_10(),
        };
        let gamut = match gamut {
            GamutFile::Compress => GamutMapping::Compress,
            GamutFile::Desaturate => GamutMapping::Desaturate,
            GamutFile::Clip => GamutMapping::Clip,
            GamutFile::Oklab => GamutMapping::Oklab,
        };
        let tone = match tone {
            ToneFile::RollOff => ToneCurve::RollOff,
            ToneFile::Clip => ToneCurve::Clip,
            ToneFile::PbrNeutral => ToneCurve::PbrNeutral,
            ToneFile::Agx => ToneCurve::Agx,
        };
        let (space, transfer) = match output_space {
            OutputSpaceFile::Srgb => (RgbSpace::Srgb, Transfer::OfSpace),
            OutputSpaceFile::DisplayP3 => (RgbSpace::DisplayP3, Transfer::OfSpace),
            OutputSpaceFile::Rec2020 => (RgbSpace::Rec2020, Transfer::OfSpace),
            OutputSpaceFile::Rec2100Pq => (RgbSpace::Rec2020, Transfer::Pq),
            OutputSpaceFile::Acescg => (RgbSpace::AcesCg, Transfer::OfSpace),
        };
        let bloom = bloom.map(|BloomFile { fov, age }| Bloom { fov_degrees: fov, age });
        let (width, height, spectral_bands) = (*width, *height, *spectral_bands);
        let layers = layers.iter().map(|layer| match layer {
            LayerFile::Albedo => Layer::Albedo,
            LayerFile::Normal => Layer::Normal,
            LayerFile::Depth => Layer::Depth,
            LayerFile::Object => Layer::Object,
            LayerFile::Material => Layer::Material,
            LayerFile::Uv => Layer::Uv,
            LayerFile::Samples => Layer::Samples,
            LayerFile::Paths => Layer::Paths,
            LayerFile::Lights => Layer::Lights,
            LayerFile::Stokes => Layer::Stokes,
        });
        let mut layers: Vec<Layer> = layers.collect();
        if *stokes && !layers.contains(&Layer::Stokes) {
            layers.push(Layer::Stokes);
        }
        Ok(FilmSpec {
            width,
            height,
            observer,
            spectral_bands,
            space,
            transfer,
            white: None,
            gamut,
            tone,
            exposure,
            bloom,
            layers,
            denoise: *denoise,
        })
    }

    /// Returns the luminance L, in cd/m², that appears white on a film with the saturation-based
    /// ISO speed S (ISO 12232): q·L·t/N² = 78/S lx·s, with the shutter time t in s, the f-number N,
    /// and q = 0.65 for the losses of the lens.
    fn white_luminance(&self, at: &JsonPath, iso: f64, lens: &LensFile) -> Result<f64> {
        let f_number = match lens {
            LensFile::Pinhole { fov: _ } | LensFile::Orthographic { height: _ } => None,
            LensFile::Thin(lens) => lens.f_number,
            LensFile::System(lens) => lens.f_number,
        };
        let exposure_s = Some(self.shutter.exposure_s()).filter(|&seconds| seconds > 0.0);
        let Some((f_number, exposure_s)) = f_number.zip(exposure_s) else {
            let what = "found a film speed, but the camera has no f-number or no exposure time";
            let expected = "a lens with `f_number`, and a `shutter` that closes after it opens";
            return Err(self.source.fault(at, what, expected));
        };
        Ok(78.0 / (0.65 * iso) * f_number * f_number / exposure_s)
    }

    pub(super) fn white_balance(&self, at: &JsonPath, file: &WhiteBalanceFile) -> Result<WhiteBalance> {
        Ok(match file {
            WhiteBalanceFile::None => WhiteBalance::None,
            WhiteBalanceFile::Scene => WhiteBalance::SceneLights,
            WhiteBalanceFile::Illuminant(name) => {
                let light = self.spectrum(at, &SpectrumFile::Name(name.clone()), Role::Light)?;
                WhiteBalance::Illuminant(name.clone(), light)
            }
        })
    }
}
