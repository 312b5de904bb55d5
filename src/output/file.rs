//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Writes a whole file: beside its final name first, then renamed, so that no reader ever sees a part of it and a
/// failure leaves what was there before. What is no ordinary file (a pipe, a device) is written directly; a link is
/// followed.
///
/// # Errors
/// The machine's: a folder that is missing or cannot be written to, a full disk; the error names `path`.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let target = followed(path);
    if is_special(&target) {
        return fs::write(&target, bytes).map_err(|error| unwritable(path, &error));
    }
    let beside = beside(&target);
    let written = File::create(&beside).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&beside, &target)).map_err(|error| {
        // The name is ours alone; if even this fails there is nothing left to try.
        let _ = fs::remove_file(&beside);
        unwritable(path, &error)
    })
}

/// Checks that [`write_whole`] can be expected to succeed, before hours are spent on what is to be written.
///
/// # Errors
/// As [`write_whole`]'s, as far as they can be known; and a file that is protected against writing.
pub fn check_writable(path: &Path) -> Result<()> {
    let target = followed(path);
    let refused = |what: &str| Err(Error::machine(format!("cannot be written: {what}")).in_file(path));
    if target.is_dir() {
        return refused("it is a folder");
    }
    if is_special(&target) {
        return fs::OpenOptions::new().write(true).open(&target).map(drop).map_err(|error| unwritable(path, &error));
    }
    if fs::metadata(&target).is_ok_and(|metadata| metadata.permissions().readonly()) {
        return refused("the file is there and protected against writing");
    }
    let beside = beside(&target);
    File::create(&beside).and_then(|_| fs::remove_file(&beside)).map_err(|error| unwritable(path, &error))
}

/// Removes a file that may not be there; a link is removed itself, not what it leads to.
///
/// # Errors
/// The machine's: a file that cannot be removed.
pub fn remove_if_present(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::machine(format!("cannot be removed: {error}")).in_file(path))
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// The file behind a link, or the path itself where there is none yet.
fn followed(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

/// Whether something other than a file or folder has this name.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// What stands in names of unfinished files between the final name and the number of the process.
const UNFINISHED: &str = ".unfinished-";

/// Removes what processes that were killed while they wrote this file left beside it, where the system tells which those are
/// (Linux).
pub fn clear_unfinished(path: &Path) {
    let target = followed(path);
    let name = target.file_name().unwrap_or_default().to_string_lossy().into_owned() + UNFINISHED;
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let processes = Path::new("/proc");
    if !processes.join("self").exists() {
        return;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let left = entry.file_name();
        let process = left.to_str().and_then(|left| left.strip_prefix(&name)?.parse::<u32>().ok());
        if process.is_some_and(|process| !processes.join(process.to_string()).exists()) {
            // A leftover that cannot be removed does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// A name beside the final one that no other process uses.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(format!("{UNFINISHED}{}", std::process::id()));
    path.with_file_name(name)
}

fn unwritable(path: &Path, error: &std::io::Error) -> Error {
    Error::machine(format!("cannot be written: {error}")).in_file(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"first").unwrap();
        check_writable(&path).unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names_in(folder.path()), ["a.txt"]);
    }

    #[test]
    fn what_cannot_be_written_is_the_machine_s_fault_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/folder/a.exr");
        for error in [check_writable(&missing).unwrap_err(), write_whole(&missing, b"").unwrap_err()] {
            assert_eq!(error.exit_status(), 1);
            assert!(error.to_string().contains("a.exr: cannot be written"), "{error}");
        }
        assert!(check_writable(folder.path()).unwrap_err().to_string().contains("folder"));
        assert!(names_in(folder.path()).is_empty());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_killed_processes_left_is_cleared_and_what_living_ones_write_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let own = format!("a.exr.unfinished-{}", std::process::id());
        for name in [&own, "a.exr.unfinished-4294967295", "a.exr.unfinished-mine", "b.exr.unfinished-4294967295"] {
            fs::write(folder.path().join(name), "half").unwrap();
        }
        clear_unfinished(&path);
        let mut names = names_in(folder.path());
        names.sort();
        let mut kept = [own, "a.exr.unfinished-mine".to_string(), "b.exr.unfinished-4294967295".to_string()];
        kept.sort();
        assert_eq!(names, kept);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_and_a_device_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());

        let full = folder.path().join("full");
        std::os::unix::fs::symlink("/dev/full", &full).unwrap();
        check_writable(&full).unwrap();
        let error = write_whole(&full, b"more than nothing").unwrap_err();
        assert_eq!(error.exit_status(), 1);
        assert!(is_special(Path::new("/dev/full")));
    }
}
