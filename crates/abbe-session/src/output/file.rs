//! Atomic writing of files: a file is written completely or not at all.

use std::fs::{self, File};
use std::io::{self, Cursor, Read, Seek, Write};
use std::path::{Path, PathBuf};

use abbe_spectra::error::{Error, Result};

/// A file while it is written.
pub trait WritableFile: Read + Write + Seek {}

impl<T: Read + Write + Seek> WritableFile for T {}

/// Writes a file atomically: to a temporary file in the same folder, which is then renamed, so that
/// readers never see a partial file, and a failure leaves the previous file in place. The file
/// keeps the permissions of the previous one. Pipes and devices are written directly. Symbolic
/// links are followed. Returns a machine error that names `path` if the folder is missing or not
/// writable, or the disk is full.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole_with(path, |file| file.write_all(bytes))
}

/// Writes a file like [`write_whole`]. `fill` writes the data into the empty file, so that the
/// memory need not hold all of it, except that of pipes and devices.
pub fn write_whole_with(path: &Path, fill: impl FnOnce(&mut dyn WritableFile) -> io::Result<()>) -> Result<()> {
    let target = followed(path);
    if is_special(&target) {
        let mut bytes = Cursor::new(Vec::new());
        let written = fill(&mut bytes).and_then(|()| fs::write(&target, bytes.get_ref()));
        return written.map_err(|error| unwritable(path, &error));
    }
    let temporary_path = temporary_path(&target);
    let created = File::options().read(true).write(true).create(true).truncate(true).open(&temporary_path);
    let written = created.and_then(|mut file| {
        if let Ok(previous) = fs::metadata(&target) {
            file.set_permissions(previous.permissions())?;
        }
        fill(&mut file)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&temporary_path, &target)).map_err(|error| {
        // The temporary name belongs to this process. The write error is already reported.
        let _ = fs::remove_file(&temporary_path);
        unwritable(path, &error)
    })
}

/// Checks that [`write_whole`] will probably succeed: the file is not write-protected, and so on.
pub fn check_writable(path: &Path) -> Result<()> {
    let target = followed(path);
    let refused = |what: &str| Err(Error::machine(format!("cannot be written: {what}")).in_file(path));
    if target.is_dir() {
        return refused("it is a folder");
    }
    if let Some(folder) = target.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists()) {
        return refused(&format!("there is no folder {}", folder.display()));
    }
    if is_special(&target) {
        return fs::OpenOptions::new().write(true).open(&target).map(drop).map_err(|error| unwritable(path, &error));
    }
    if fs::metadata(&target).is_ok_and(|metadata| metadata.permissions().readonly()) {
        return refused("the file is write-protected");
    }
    let temporary_path = temporary_path(&target);
    File::create(&temporary_path)
        .and_then(|_| fs::remove_file(&temporary_path))
        .map_err(|error| unwritable(path, &error))
}

/// Returns an input error if one of the `outputs` of a command is one of the `inputs` that it
/// reads, under whatever name: writing would destroy the input.
pub fn check_keeps_inputs<'p>(
    outputs: impl IntoIterator<Item = &'p Path>,
    inputs: impl IntoIterator<Item = impl AsRef<Path>> + Clone,
) -> Result<()> {
    for output in outputs {
        let is_output = |input: &Path| same_file::is_same_file(input, output).unwrap_or(false);
        if let Some(input) = inputs.clone().into_iter().find(|input| is_output(input.as_ref())) {
            let what = format!("the output would replace {}, which this command reads", input.as_ref().display());
            return Err(Error::input(what).expected("another name for the output").in_file(output));
        }
    }
    Ok(())
}

/// Removes a file or a symbolic link if it exists, or returns a machine error.
pub fn remove_if_present(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::machine(format!("cannot be removed: {error}")).in_file(path))
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Follows all symbolic links. The last one may name a file that does not exist yet.
fn followed(path: &Path) -> PathBuf {
    /// As many links as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(named) => path = path.parent().unwrap_or(Path::new("")).join(named),
            Err(_) => break,
        }
    }
    path
}

/// Returns true for a path that is neither a regular file nor a folder, such as a pipe or a device.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// The name of a temporary file consists of the final name, this text and the process id.
const TEMPORARY_MARK: &str = ".unfinished-";

/// Removes the temporary files for `path` of killed processes, by the list in `/proc` (Linux).
pub fn remove_temporary_files(path: &Path) {
    let target = followed(path);
    let name = target.file_name().unwrap_or_default().to_string_lossy().into_owned() + TEMPORARY_MARK;
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let processes = Path::new("/proc");
    if !processes.join("self").exists() {
        return;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let left = entry.file_name();
        let process = left.to_str().and_then(|left| left.strip_prefix(&name)?.parse::<u32>().ok());
        if process.is_some_and(|process| !processes.join(process.to_string()).exists()) {
            // A leftover file that cannot be removed is harmless.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Returns a path in the folder of `path` that no other process uses: it contains the process id.
fn temporary_path(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(format!("{TEMPORARY_MARK}{}", std::process::id()));
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
    fn a_file_is_replaced_without_leftovers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"first").unwrap();
        check_writable(&path).unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names_in(folder.path()), ["a.txt"]);
    }

    #[test]
    fn unwritable_files_are_machine_errors() {
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
    fn only_temporary_files_of_dead_processes_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let own = format!("a.exr.unfinished-{}", std::process::id());
        for name in [&own, "a.exr.unfinished-4294967295", "a.exr.unfinished-mine", "b.exr.unfinished-4294967295"] {
            fs::write(folder.path().join(name), "half").unwrap();
        }
        remove_temporary_files(&path);
        let mut names = names_in(folder.path());
        names.sort();
        let mut kept = [own, "a.exr.unfinished-mine".to_string(), "b.exr.unfinished-4294967295".to_string()];
        kept.sort();
        assert_eq!(names, kept);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("secret");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
        write_whole(&path, b"new").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    }

    #[test]
    fn an_output_is_no_input_under_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let [input, other] = ["input", "other"].map(|name| folder.path().join(name));
        fs::write(&input, "").unwrap();
        let again = folder.path().join("./input");
        check_keeps_inputs([other.as_path()], [&input]).unwrap();
        check_keeps_inputs([again.as_path()], [&other]).unwrap();
        let error = check_keeps_inputs([other.as_path(), again.as_path()], [&other, &input]).unwrap_err();
        assert_eq!(error.exit_status(), 2);
        assert!(error.to_string().contains("would replace"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        // The target of a link need not exist.
        for _ in 0..2 {
            write_whole(&link, b"new").unwrap();
            assert_eq!(fs::read(&file).unwrap(), b"new");
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            fs::remove_file(&file).unwrap();
        }

        let full = folder.path().join("full");
        std::os::unix::fs::symlink("/dev/full", &full).unwrap();
        check_writable(&full).unwrap();
        let error = write_whole(&full, b"more than nothing").unwrap_err();
        assert_eq!(error.exit_status(), 1);
        assert!(is_special(Path::new("/dev/full")));
    }
}
