//! `abbe merge`: merges parts of a picture. The result equals the picture of a single run.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use abbe_session::output::exr::write;
use abbe_session::render::{PartSet, Stats, on_threads};
use abbe_spectra::error::{Error, Result};

use super::outputs::OutputFiles;
use super::{Outcome, interrupt, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// The parts, written by `abbe render --part`; checkpoints are parts too
    #[arg(value_name = "PART.exr", required_unless_present = "watch", conflicts_with = "watch")]
    parts: Vec<PathBuf>,
    /// Merge the parts and checkpoints in this folder again and again while they grow, until all
    /// parts are complete
    #[arg(long, value_name = "FOLDER")]
    watch: Option<PathBuf>,
    /// The file of the picture; a PNG file is written beside it
    #[arg(short, long, value_name = "OUT.exr")]
    output: PathBuf,
    /// Merge even if passes are missing, and print which ones
    #[arg(long, conflicts_with = "watch")]
    allow_gaps: bool,
    /// Exit with status 3 if the error of a typical pixel is above this value, such as 2%.
    /// With --watch: continue until the error is at or below this value
    #[arg(long, value_name = "RATIO", value_parser = values::fraction)]
    target_error: Option<f64>,
    /// Write the statistics of all parts together as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Print only warnings and errors
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &MergeArgs) -> Result<Outcome> {
    let outputs = OutputFiles::new(arguments.output.clone(), arguments.stats.clone())?;
    match &arguments.watch {
        Some(folder) => watch(arguments, folder, &outputs),
        None => once(arguments, &outputs),
    }
}

fn once(arguments: &MergeArgs, outputs: &OutputFiles) -> Result<Outcome> {
    outputs.check_keeps(&arguments.parts)?;
    let merging = PartSet::new(&arguments.parts)?;
    if let Some(gaps) = merging.gaps() {
        if !arguments.allow_gaps {
            let held: Vec<String> = merging
                .parts()
                .map(|(path, part, done)| format!("{}: {done} of part {part}", path.display()))
                .collect();
            let what = format!("the parts lack {gaps}; they hold {}", held.join(", "));
            return Err(Error::input(what).expected("every pass in one part, or --allow-gaps"));
        }
        print::remark(&format!("note: merged without {gaps}"));
    }
    outputs.check(&[])?;
    let (stats, exposure) = save(merging, outputs)?;
    if !arguments.quiet {
        let error = print::picture_error(&stats.error);
        let (parts, passes) = (print::counted(arguments.parts.len(), "part"), print::passes(stats.passes));
        let exposure = print::exposure(exposure);
        print::remark(&format!("wrote {}: {passes} from {parts}, exposure {exposure}\n{error}", outputs.named()));
    }
    let Some(target) = arguments.target_error.filter(|target| !is_reached(&stats, *target)) else {
        return Ok(Outcome::Done);
    };
    let found = stats.error.typical.map_or("unknown".to_string(), print::percent);
    let target = print::percent(target);
    print::remark(&format!("failed: the error of a typical pixel is {found}, which is above the target {target}"));
    Ok(Outcome::Exceeded)
}

/// Merges the parts, and saves the picture. Returns the statistics and the exposure.
fn save(parts: PartSet, outputs: &OutputFiles) -> Result<(Stats, f64)> {
    let merged = on_threads(None, || parts.merge())??;
    let write_exr = |path: &Path| write(path, &merged.picture, &merged.metadata);
    let exposure = on_threads(None, || outputs.save(write_exr, &merged.picture, &merged.display, &merged.stats))??;
    Ok((merged.stats, exposure))
}

fn is_reached(stats: &Stats, target: f64) -> bool {
    stats.error.typical.is_some_and(|error| error <= target)
}

/// The shortest time between two merges of `--watch`. The time is longer if merging takes long.
const SHORTEST_PAUSE: Duration = Duration::from_millis(500);

/// The pause is at least the time of the last merge multiplied by this number.
const PAUSE_RATIO: u32 = 4;

/// The watch ends after more consecutive failures than this number.
const FAILURES: u32 = 10;

/// Merges the files in a folder whenever they have changed, until all parts are complete.
fn watch(arguments: &MergeArgs, folder: &Path, outputs: &OutputFiles) -> Result<Outcome> {
    if !folder.is_dir() {
        return Err(Error::input("is not a folder").expected("the folder of the parts").in_file(folder));
    }
    interrupt::watch()?;
    outputs.check(&[])?;
    let (mut merged, mut next, mut failures) = (Vec::new(), Instant::now(), 0);
    loop {
        if interrupt::is_requested() {
            return Ok(Outcome::Interrupted);
        }
        if Instant::now() < next {
            std::thread::sleep(Duration::from_millis(50));
            continue;
        }
        let start = Instant::now();
        let is_part = |path: &PathBuf| outputs.check_keeps(std::slice::from_ref(path)).is_ok();
        let files: Vec<PathBuf> = exr_files(folder)?.into_iter().filter(is_part).collect();
        let newest = PartSet::newest(&files);
        if !newest.is_empty() {
            match refresh(arguments, &newest, &mut merged, outputs) {
                Ok(true) => return Ok(Outcome::Done),
                Ok(false) => failures = 0,
                // A job may have renamed or replaced a file in the meantime.
                Err(_) if failures < FAILURES => failures += 1,
                Err(error) => return Err(error),
            }
        }
        next = Instant::now() + SHORTEST_PAUSE.max(start.elapsed() * PAUSE_RATIO);
    }
}

/// Merges the parts unless they are those in `merged`. Returns true if nothing is left to wait for.
fn refresh(
    arguments: &MergeArgs,
    files: &[PathBuf],
    merged: &mut Vec<(PathBuf, u64)>,
    outputs: &OutputFiles,
) -> Result<bool> {
    let parts = PartSet::new(files)?;
    let found: Vec<(PathBuf, u64)> = parts.parts().map(|(path, _, done)| (path.to_path_buf(), done)).collect();
    if found == *merged {
        return Ok(false);
    }
    let gaps = parts.gaps().map(str::to_string);
    let (stats, _) = save(parts, outputs)?;
    if !arguments.quiet {
        let (passes, count) = (print::passes(stats.passes), print::counted(found.len(), "part"));
        let missing = gaps.as_ref().map_or(String::new(), |gaps| format!(", without {gaps}"));
        print::remark(&format!("{passes} from {count}{missing}; {}", print::picture_error(&stats.error)));
    }
    *merged = found;
    Ok(gaps.is_none() && arguments.target_error.is_none_or(|target| is_reached(&stats, target)))
}

/// Returns the EXR files in a folder in the order of their names.
fn exr_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let unreadable = |error: std::io::Error| Error::machine(format!("cannot be read: {error}")).in_file(folder);
    let entries = std::fs::read_dir(folder).map_err(unreadable)?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")));
    paths.sort();
    Ok(paths)
}
