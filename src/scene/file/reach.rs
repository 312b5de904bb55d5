//! Which files a scene may name.

use std::path::{Component, Path, PathBuf};

use crate::error::{Error, Result};

/// Which files a scene, or a file that it names, may name in its turn. A scene from a stranger reads nothing of its reader's.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Reach {
    /// Those in its own folder and below.
    #[default]
    Folder,
    /// Any (`--allow-outside`).
    Anywhere,
}

impl Reach {
    /// The file that is named relative to `folder`. Links in the folder are followed wherever they lead: who put them there could have put
    /// the file itself there.
    ///
    /// # Errors
    /// A path that climbs above the folder or begins at a root, unless any file may be named.
    pub fn file(self, folder: &Path, path: &Path) -> Result<PathBuf> {
        if self == Self::Folder && leaves(path) {
            return Err(Error::input(format!("the path \"{}\" leads out of the folder", path.display()))
                .expected("a path within the folder of the file that names it, or the option --allow-outside"));
        }
        Ok(folder.join(path))
    }
}

/// Whether a path leads out of the folder that it starts in.
fn leaves(path: &Path) -> bool {
    let mut depth = 0_usize;
    path.components().any(|component| match component {
        Component::CurDir => false,
        Component::Normal(_) => {
            depth += 1;
            false
        }
        Component::ParentDir if depth > 0 => {
            depth -= 1;
            false
        }
        Component::ParentDir | Component::RootDir | Component::Prefix(_) => true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_may_go_down_and_back_but_not_up() {
        let within = |path: &str| Reach::Folder.file(Path::new("scenes"), Path::new(path));
        for inside in ["lamp.csv", "./lamp.csv", "lamps/hg.csv", "lamps/../lamp.csv", "a/b/../../c", "..lamp.csv", ""] {
            assert_eq!(within(inside).unwrap(), Path::new("scenes").join(inside));
        }
        for outside in ["..", "../lamp.csv", "a/../../lamp.csv", "./../x", "/etc/passwd", "a/../.."] {
            assert!(within(outside).unwrap_err().to_string().contains("--allow-outside"), "{outside}");
            assert!(Reach::Anywhere.file(Path::new("scenes"), Path::new(outside)).is_ok());
        }
    }
}
