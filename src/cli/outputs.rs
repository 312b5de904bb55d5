//! The output files of a render: EXR, PNG and statistics.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::output::file as files;
use crate::output::png::write as write_png;
use crate::render::{DisplaySettings, Stats};
use crate::sensor::Picture;

/// The output files of a render.
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

    /// The path of the checkpoint.
    pub(crate) fn checkpoint(&self) -> PathBuf {
        self.exr.with_extension("checkpoint.exr")
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [&self.exr, &self.png].into_iter().chain(&self.stats).map(PathBuf::as_path)
    }

    /// Checks that all files can be written, and removes the unfinished files that killed runs left
    /// behind. Call this function before a long render.
    pub(crate) fn check(&self) -> Result<()> {
        self.all().for_each(files::remove_temporary_files);
        self.all().try_for_each(files::check_writable)
    }

    /// The names of the pictures as text.
    pub(crate) fn named(&self) -> String {
        format!("{} and {}", self.exr.display(), self.png.display())
    }

    /// Saves a picture and its statistics. `write_exr` writes the EXR file.
    pub(crate) fn save(
        &self,
        write_exr: impl FnOnce(&Path) -> Result<()>,
        picture: &Picture,
        showing: &DisplaySettings,
        stats: &Stats,
    ) -> Result<()> {
        write_exr(&self.exr)?;
        write_png(&self.png, &showing.screen(picture))?;
        if let Some(path) = &self.stats {
            let json = serde_json::to_string_pretty(stats).expect("statistics have text keys");
            files::write_whole(path, (json + "\n").as_bytes())?;
        }
        Ok(())
    }
}
