//! The files that a picture becomes: EXR, PNG and statistics.

use std::path::{Path, PathBuf};

use abbe::error::{Error, Result};
use abbe::output::file as files;
use abbe::output::png::write as write_png;
use abbe::render::{Showing, Stats};
use abbe::sensor::Picture;

/// The files to be written.
#[derive(Debug)]
pub(crate) struct Outputs {
    pub(crate) exr: PathBuf,
    png: PathBuf,
    stats: Option<PathBuf>,
}

impl Outputs {
    /// The EXR, the PNG beside it, and statistics if asked for.
    pub(crate) fn new(exr: PathBuf, stats: Option<PathBuf>) -> Result<Self> {
        if !exr.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            let what = format!("the output {}", exr.display());
            return Err(Error::input(what).expected("a name that ends in .exr (a PNG is written beside it)"));
        }
        Ok(Self { png: exr.with_extension("png"), exr, stats })
    }

    /// Where a render of this picture keeps its checkpoint.
    pub(crate) fn checkpoint(&self) -> PathBuf {
        self.exr.with_extension("checkpoint.exr")
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [&self.exr, &self.png].into_iter().chain(&self.stats).map(PathBuf::as_path)
    }

    /// Checks that all can be expected to be written, before hours are spent on them; clears away what killed runs left half-written.
    pub(crate) fn check(&self) -> Result<()> {
        self.all().for_each(files::clear_unfinished);
        self.all().try_for_each(files::check_writable)
    }

    /// The pictures' names.
    pub(crate) fn named(&self) -> String {
        format!("{} and {}", self.exr.display(), self.png.display())
    }

    /// Saves a picture; `write_exr` writes the EXR.
    pub(crate) fn save(
        &self,
        write_exr: impl FnOnce(&Path) -> Result<()>,
        picture: &Picture,
        showing: &Showing,
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
