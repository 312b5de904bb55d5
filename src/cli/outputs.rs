//! The output files of a render: EXR, PNG and statistics.

use std::path::{Path, PathBuf};

use abbe_session::output::Metadata;
use abbe_session::output::exr::{ExrFile, read, read_metadata, write as write_exr};
use abbe_session::output::file as files;
use abbe_session::output::metadata::names;
use abbe_session::output::png::write as write_png;
use abbe_session::render::{DisplaySettings, Stats};
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::Picture;

#[derive(Debug)]
pub(crate) struct OutputFiles {
    pub(crate) exr: PathBuf,
    png: PathBuf,
    stats: Option<PathBuf>,
}

impl OutputFiles {
    /// The EXR file, the PNG file beside it, and optionally a file with statistics.
    pub(crate) fn new(exr: PathBuf, stats: Option<PathBuf>) -> Result<Self> {
        if !exr.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            let what = format!("the output {} is not an EXR file", exr.display());
            return Err(Error::input(what).expected("a name that ends in .exr; the PNG file is written beside it"));
        }
        Ok(Self { png: exr.with_extension("png"), exr, stats })
    }

    /// Returns the PNG file.
    pub(crate) fn png(&self) -> &Path {
        &self.png
    }

    pub(crate) fn checkpoint(&self) -> PathBuf {
        self.exr.with_extension("checkpoint.exr")
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [&self.exr, &self.png].into_iter().chain(&self.stats).map(PathBuf::as_path)
    }

    /// Checks that all files, and the checkpoint, are none of the `inputs`, and that the files can
    /// be written. Removes the unfinished files of killed runs.
    pub(crate) fn check(&self, inputs: &[PathBuf]) -> Result<()> {
        files::check_keeps_inputs(self.all().chain([self.checkpoint().as_path()]), inputs)?;
        self.all().for_each(files::remove_temporary_files);
        self.all().try_for_each(files::check_writable)
    }

    pub(crate) fn check_keeps(&self, inputs: &[PathBuf]) -> Result<()> {
        files::check_keeps_inputs(self.all(), inputs)
    }

    /// Writes the PNG of a finished picture with other settings, which the header of the EXR file
    /// then states with the scene that contains them.
    pub(crate) fn develop_again(&self, of_scene: &Metadata, display: &DisplaySettings) -> Result<()> {
        let ExrFile { picture, metadata } = read(&self.exr)?;
        let explicit = [names::SCENE, names::DISPLAY].into_iter().filter_map(|name| Some((name, of_scene.get(name)?)));
        // Attributes without the prefix belong to the format. They are written anew.
        let own = metadata.iter().filter(|(name, _)| name.starts_with("abbe."));
        let metadata = own.chain(explicit).fold(Metadata::new(), |metadata, (name, value)| metadata.with(name, value));
        if display.denoise == Some(true) && picture.denoised.is_none() {
            let error = Error::input("contains no denoised picture").in_file(&self.exr);
            return Err(error.expected("a file of a render without --no-denoise, or no file"));
        }
        write_exr(&self.exr, &picture, &metadata)?;
        write_png(&self.png, &display.screen(&picture))
    }

    pub(crate) fn name(&self) -> String {
        self.exr.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    pub(crate) fn named(&self) -> String {
        format!("{} and {}", self.exr.display(), self.png.display())
    }

    /// Returns true if a render was killed before its end and left the preview of its picture.
    pub(crate) fn holds_preview(&self) -> bool {
        read_metadata(&self.exr).is_ok_and(|found| found.get(names::PREVIEW).is_some())
    }

    /// Returns false for pipes and devices, which receive only the finished picture.
    pub(crate) fn can_be_refreshed(&self) -> bool {
        [&self.exr, &self.png].into_iter().all(|path| !std::fs::metadata(path).is_ok_and(|found| !found.is_file()))
    }

    /// Saves the EXR file by `write_picture`, and the PNG file. Returns its exposure in 1/(cd/m²).
    pub(crate) fn save_pictures(
        &self,
        write_picture: impl FnOnce(&Path) -> Result<()>,
        picture: &Picture,
        display: &DisplaySettings,
    ) -> Result<f64> {
        write_picture(&self.exr)?;
        let (screen, exposure) = display.screen_and_factor(picture);
        write_png(&self.png, &screen)?;
        Ok(exposure)
    }

    /// Saves a picture and its statistics. Returns the exposure of the PNG in 1/(cd/m²).
    pub(crate) fn save(
        &self,
        write_picture: impl FnOnce(&Path) -> Result<()>,
        picture: &Picture,
        display: &DisplaySettings,
        stats: &Stats,
    ) -> Result<f64> {
        let exposure = self.save_pictures(write_picture, picture, display)?;
        if let Some(path) = &self.stats {
            let json = serde_json::to_string_pretty(stats).expect("statistics have text keys");
            files::write_whole(path, (json + "\n").as_bytes())?;
        }
        Ok(exposure)
    }
}
