//! Decides which files a JSON text may name.

use abbe_spectra::error::{Error, Result};
use std::ops::Deref;
#[cfg(feature = "files")]
use std::path::Component;
use std::path::{Path, PathBuf};

/// The files that a JSON text may name, directly or through other files that it names. The default
/// keeps a file of an unknown author from making the program read other files of the user.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FileAccess {
    /// Files in the folder of the text and in folders below it.
    #[default]
    WithinFolder,
    /// All files.
    Anywhere,
    /// No files, for a text that is not a file.
    Nowhere,
}

/// The path of a file that a text may name.
#[cfg(feature = "files")]
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedFile(PathBuf);

/// Without the feature `files`, a text may name no file. This type has no value, so the compiler
/// leaves out the readers of files.
#[cfg(not(feature = "files"))]
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NamedFile {}

impl Deref for NamedFile {
    type Target = Path;

    fn deref(&self) -> &Path {
        #[cfg(feature = "files")]
        return &self.0;
        #[cfg(not(feature = "files"))]
        match *self {}
    }
}

impl AsRef<Path> for NamedFile {
    fn as_ref(&self) -> &Path {
        self
    }
}

impl From<NamedFile> for PathBuf {
    fn from(file: NamedFile) -> Self {
        file.to_path_buf()
    }
}

impl FileAccess {
    /// The field `expected` of the errors of [`Self::file`], by which a program with an option that
    /// allows all files can recognise the error and add the name of the option.
    pub const EXPECTED_WITHIN_FOLDER: &str = "a path within the folder of the file that names it";

    /// Returns the path of a file that is relative to `folder`. Symbolic links are followed, even
    /// out of the folder, because whoever created the link could have copied the file into the
    /// folder.
    ///
    /// # Errors
    /// Returns an error if the access is [`Self::WithinFolder`] and the path is absolute or leads
    /// above the folder, or if the access is [`Self::Nowhere`].
    #[cfg(feature = "files")]
    pub fn file(self, folder: &Path, path: &Path) -> Result<NamedFile> {
        if self == Self::Nowhere {
            let what = format!("the path \"{}\" in a scene that is not a file", path.display());
            return Err(Error::input(what).expected("no files; save the scene in a file to use others"));
        }
        if self == Self::WithinFolder && leaves_folder(path) {
            return Err(Error::input(format!("the path \"{}\" leads out of the folder", path.display()))
                .expected(Self::EXPECTED_WITHIN_FOLDER));
        }
        Ok(NamedFile(folder.join(path)))
    }

    /// Returns an error, because this program was built without the feature `files`.
    ///
    /// # Errors
    /// Always returns an error.
    #[cfg(not(feature = "files"))]
    pub fn file(self, _: &Path, path: &Path) -> Result<NamedFile> {
        let what = format!("the path \"{}\" in a scene for the browser", path.display());
        Err(Error::input(what).expected("no files; `abbe render` and `abbe view` read them"))
    }
}

/// Returns whether a relative path leads out of its folder.
#[cfg(feature = "files")]
fn leaves_folder(path: &Path) -> bool {
    let mut depth = 0_usize;
    path.components().any(|component| {
        match component {
            Component::CurDir => {}
            Component::Normal(_) => depth += 1,
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return true,
        }
        false
    })
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;

    #[test]
    fn a_path_may_go_down_and_back_but_not_up() {
        let within = |path: &str| FileAccess::WithinFolder.file(Path::new("scenes"), Path::new(path));
        for inside in ["lamp.csv", "./lamp.csv", "lamps/hg.csv", "lamps/../lamp.csv", "a/b/../../c", "..lamp.csv", ""] {
            assert_eq!(*within(inside).unwrap(), *Path::new("scenes").join(inside));
        }
        for outside in ["..", "../lamp.csv", "a/../../lamp.csv", "./../x", "/etc/passwd", "a/../.."] {
            let error = within(outside).unwrap_err();
            assert_eq!(error.expected.as_deref(), Some(FileAccess::EXPECTED_WITHIN_FOLDER), "{outside}");
            assert!(FileAccess::Nowhere.file(Path::new("scenes"), Path::new(outside)).is_err());
            assert!(FileAccess::Anywhere.file(Path::new("scenes"), Path::new(outside)).is_ok());
        }
    }
}
