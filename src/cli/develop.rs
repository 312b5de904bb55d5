//! `abbe develop`: converts a finished or running picture to a PNG file, without rendering.

use std::path::{Path, PathBuf};

use abbe_scene::Exposure;
use abbe_session::output::Metadata;
use abbe_session::output::exr::read;
use abbe_session::output::file;
use abbe_session::output::metadata::names;
use abbe_session::output::png::write as write_png;
use abbe_session::render::{DisplaySettings, PartSet, SavedRun, on_threads};
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{AdaptationTransform, Xyz, output_space_by_name};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Observer;
use abbe_transport::sensor::DenoisedPicture;
use serde_json::Value;

use super::spectrum::light;
use super::values::BloomChoice;
use super::{Outcome, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct DevelopArgs {
    /// The picture: an EXR file of abbe or of another program. A checkpoint, or the preview of a
    /// running render, is a picture too
    #[arg(value_name = "FILE.exr")]
    picture: PathBuf,
    /// The PNG file
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    #[command(flatten)]
    display: DisplayArgs,
    #[command(flatten)]
    denoise: DenoiseArgs,
    /// Print only warnings and errors
    #[arg(long)]
    quiet: bool,
}

/// The options that choose between a picture and its denoised picture.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct DenoiseArgs {
    /// Show the denoised picture in the PNG [default: the setting of the scene, else if it is safe
    /// by its own error bars]
    #[arg(long, overrides_with = "no_denoise")]
    denoise: bool,
    /// Show the picture as it was rendered. A render then does not denoise at all
    #[arg(long)]
    no_denoise: bool,
}

impl DenoiseArgs {
    /// Returns the choice, or `None` without an option.
    pub(crate) fn choice(self) -> Option<bool> {
        (self.denoise || self.no_denoise).then_some(self.denoise)
    }
}

/// The conversion of a picture to a PNG file.
#[derive(Debug, clap::Args)]
pub(crate) struct DisplayArgs {
    /// The exposure: auto, none, or a number of stops such as -7.5 [default: the setting of the
    /// picture's scene, else auto]
    #[arg(long, visible_alias = "ev", value_name = "auto|none|EV", value_parser = values::exposure, allow_negative_numbers = true)]
    exposure: Option<Exposure>,
    /// The light that is shown as white: none, scene (all lights together), or a spectrum: a name
    /// of the scene or of the library, a file, or JSON [default: the setting of the scene, else
    /// none]
    #[arg(long, value_name = "NAME")]
    white_balance: Option<String>,
    /// The gamut mapping: compress, desaturate, oklab or clip [default: the setting of the scene,
    /// else compress]
    #[arg(long, value_name = "NAME")]
    gamut: Option<String>,
    /// The tone curve: roll_off, clip, pbr_neutral or agx [default: the setting of the scene, else
    /// roll_off]
    #[arg(long, value_name = "NAME")]
    tone: Option<String>,
    /// The colour space: srgb, display-p3, rec2020, rec2100-pq (for HDR displays) or acescg
    /// [default: the setting of the scene, else srgb]
    #[arg(long, value_name = "NAME")]
    output_space: Option<String>,
    /// The bloom: none, or the horizontal angle in degrees that the picture fills for the viewer,
    /// such as 40 [default: the setting of the scene, else none]
    #[arg(long, value_name = "none|DEGREES", value_parser = values::bloom)]
    bloom: Option<BloomChoice>,
}

pub(crate) fn run(arguments: &DevelopArgs) -> Result<Outcome> {
    let output = &arguments.output;
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        let what = format!("the output {} is not a PNG file", output.display());
        return Err(Error::input(what).expected("a name that ends in .png"));
    }
    file::check_keeps_inputs([output.as_path()], [&arguments.picture])?;
    let mut file = read(&arguments.picture)?;
    let mut settings = arguments.display.settings(&file.metadata)?;
    settings.denoise = arguments.denoise.choice().or(settings.denoise);
    if settings.denoise != Some(false) && file.picture.denoised.is_none() {
        file.picture.denoised = denoised_checkpoint(&arguments.picture)?;
    }
    if settings.denoise == Some(true) && file.picture.denoised.is_none() {
        let expected = "a picture with at least four passes of a render without --no-denoise, or its checkpoint";
        return Err(Error::input("contains no denoised picture").expected(expected).in_file(&arguments.picture));
    }
    let exposure = on_threads(None, || {
        let (screen, exposure) = settings.screen_and_factor(&file.picture);
        write_png(output, &screen).map(|()| exposure)
    })??;
    if !arguments.quiet {
        print::remark(&format!("wrote {}: exposure {}", output.display(), print::exposure(exposure)));
    }
    Ok(Outcome::Done)
}

/// Returns the denoised picture of a checkpoint, from its exact sums. `None` if the file is another
/// picture, or if the sums do not allow it.
fn denoised_checkpoint(path: &Path) -> Result<Option<DenoisedPicture>> {
    if SavedRun::read(path).is_err() {
        return Ok(None);
    }
    let merged = on_threads(None, || PartSet::new(&[path.to_path_buf()])?.merge())??;
    Ok(merged.picture.denoised)
}

impl DisplayArgs {
    /// The settings in the header of the picture, with the changes from the options.
    pub(crate) fn settings(&self, header: &Metadata) -> Result<DisplaySettings> {
        let mut settings = DisplaySettings::of_header(header).unwrap_or(DisplaySettings::automatic());
        settings.exposure = self.exposure.unwrap_or(settings.exposure);
        let development = &mut settings.development;
        if let Some(name) = &self.gamut {
            development.gamut = GamutMapping::by_name(name)?;
        }
        if let Some(name) = &self.tone {
            development.tone = ToneCurve::by_name(name)?;
        }
        if let Some(name) = &self.output_space {
            (development.space, development.transfer) = output_space_by_name(name)?;
        }
        if let Some(BloomChoice(bloom)) = self.bloom {
            development.bloom = bloom;
        }
        if let Some(name) = &self.white_balance {
            development.white = white(name, header, settings.lights)?;
        }
        Ok(settings)
    }
}

/// Returns the white with this name. `lights` is the colour of all lights of the scene, if known.
fn white(name: &str, header: &Metadata, lights: Option<Xyz>) -> Result<Option<Xyz>> {
    let scene: Value = header.get(names::SCENE).and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    let xyz = match name {
        "none" => return Ok(None),
        "scene" => lights.ok_or_else(|| {
            Error::input("the header of the picture does not contain the colour of the scene's lights")
                .expected("a picture of this version of abbe, or the name of a spectrum")
        })?,
        _ => {
            let own = scene.pointer("/spectra").and_then(|spectra| spectra.get(name)).map(Value::to_string);
            let observer = scene.pointer("/film/observer").and_then(Value::as_str).map(Observer::by_name);
            let observer = observer.transpose()?.unwrap_or_else(Observer::cie1931);
            observer.xyz(&light(own.as_deref().unwrap_or(name))?.spectrum)
        }
    };
    if !AdaptationTransform::Bradford.can_adapt_from(xyz) {
        let error = Error::input(format!("\"{name}\" has a colour that is too saturated for white balance"));
        return Err(error.expected("light with red, green and blue components"));
    }
    Ok(Some(xyz))
}
