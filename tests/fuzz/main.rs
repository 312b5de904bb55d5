//! Robustness against bad input: valid files with random, repeatable changes, and meshes and
//! materials with systematic changes of their structure. Every reader returns a result or an error,
//! without a panic, within a second, and within 1 GiB of memory.
//!
//! The default run makes 8,000 random changes and changes each part of the structure once; `cargo
//! test --release --test fuzz -- --ignored` makes 200,000. Failing inputs are kept in `target/tmp`.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod mutate;
mod rich_gltf;
mod structure;
mod targets;

use std::alloc::System;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use cap::Cap;
use cpu_time::ProcessTime;
use mutate::Mutator;
use targets::{Target, all, structured};

/// Counts the allocated memory. A request above the limit ends the process; the input is on disk by
/// then.
#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, 16 << 30);

/// The largest amount of memory that a case may allocate, in bytes.
const LARGEST: usize = 1 << 30;

/// The longest CPU time of a case.
const LONGEST: Duration = Duration::from_secs(1);

/// After this time a case counts as hanging, and the run ends.
const HANGS: Duration = Duration::from_secs(20);

#[test]
fn some_changed_files_do_no_harm() {
    fuzz(all(), 8_000, 1);
}

#[test]
#[ignore = "slow: 200,000 changed files"]
fn changed_files_do_no_harm() {
    fuzz(all(), 200_000, 2);
}

/// Each key, value, line and word is missing, empty, doubled or of another type.
#[test]
fn changes_of_the_structure_do_no_harm() {
    let _alone = ALONE.lock();
    let scratch = scratch_folder();
    let mut faults = Vec::new();
    for (target, step) in structured() {
        let path = prepare(&target, scratch.path());
        let start = Instant::now();
        let variants: Vec<Vec<u8>> = target.good.iter().flat_map(|good| structure::variants(good)).collect();
        let mut accepted = 0;
        let chosen = variants.iter().enumerate().step_by(step);
        let count = chosen.len();
        for (case, bytes) in chosen {
            match run(&target, &path, case as u64, bytes) {
                Ok(was_good) => accepted += u64::from(was_good),
                Err(fault) => faults.push(fault),
            }
        }
        println!(
            "{}: {count} of {}, {accepted} of them still good, {:.2?}",
            target.name,
            variants.len(),
            start.elapsed()
        );
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults[..faults.len().min(20)].join("\n"));
}

/// Returns a folder on a RAM disk if there is one: writing to disk takes longer than reading a
/// changed file.
fn scratch_folder() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    tempfile::tempdir_in(if memory.is_dir() { memory } else { Path::new(env!("CARGO_TARGET_TMPDIR")) }).unwrap()
}

/// Writes the other files of a target, and checks that the unchanged input is accepted. Returns the
/// path of the input.
fn prepare(target: &Target, folder: &Path) -> PathBuf {
    for (name, bytes) in &target.beside {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    let path = folder.join(format!("{}.{}", target.name, target.extension));
    // A scene may name files that are not here.
    let is_good = |bytes: &Vec<u8>| {
        std::fs::write(&path, bytes).unwrap();
        (target.read)(&path)
    };
    assert!(target.good.iter().any(is_good), "all unchanged inputs of {} are refused", target.name);
    path
}

/// Changes the valid inputs of the targets `count` times in total, by their shares.
fn fuzz(targets: Vec<Target>, count: u64, seed: u64) {
    let _alone = ALONE.lock();
    let scratch = scratch_folder();
    let shares: u64 = targets.iter().map(|target| target.share).sum();
    let mut faults = Vec::new();
    let mut done = 0;
    for target in &targets {
        let path = prepare(target, scratch.path());
        let start = Instant::now();
        let cases = count * target.share / shares;
        let mut accepted = 0;
        for case in 0..cases {
            let bytes = Mutator::new(seed, target.name, case).change(&target.good);
            match run(target, &path, case, &bytes) {
                Ok(was_good) => accepted += u64::from(was_good),
                Err(fault) => faults.push(fault),
            }
        }
        done += cases;
        println!("{}: {cases} changed, {accepted} of them still good, {:.2?}", target.name, start.elapsed());
    }
    println!("{done} in all, at most {} MiB allocated", MEMORY.max_allocated() >> 20);
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults[..faults.len().min(20)].join("\n"));
}

/// The two runs share the memory counter, which never falls.
static ALONE: Mutex<()> = Mutex::new(());

/// Runs one changed input. Returns whether it was still valid, or the failure.
fn run(target: &Target, path: &Path, case: u64, bytes: &[u8]) -> Result<bool, String> {
    std::fs::write(path, bytes).unwrap();
    let (before, peak_before) = (MEMORY.allocated(), MEMORY.max_allocated());
    let watch = Watch::over(path.to_owned());
    let start = ProcessTime::now();
    let answer = catch_unwind(AssertUnwindSafe(|| (target.read)(path)));
    let elapsed = start.elapsed();
    drop(watch);
    let peak = MEMORY.max_allocated();
    let kept = || {
        let kept =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{}-{case}.{}", target.name, target.extension));
        std::fs::copy(path, &kept).unwrap();
        kept.display().to_string()
    };
    let Ok(was_good) = answer else { return Err(format!("{}: panics", kept())) };
    if peak > peak_before && peak - before > LARGEST {
        return Err(format!("{}: {} MiB for {} bytes", kept(), (peak - before) >> 20, bytes.len()));
    }
    if elapsed > LONGEST {
        return Err(format!("{}: takes {elapsed:.2?} of CPU time", kept()));
    }
    Ok(was_good)
}

/// Ends the process if a case hangs, and names the case.
struct Watch(Arc<AtomicBool>);

impl Watch {
    fn over(path: PathBuf) -> Self {
        let mut watched = WATCHED.lock().unwrap();
        if watched.is_none() {
            std::thread::spawn(watch_for_ever);
        }
        let over = Arc::new(AtomicBool::new(false));
        *watched = Some((over.clone(), Instant::now(), path));
        Self(over)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The running case: whether it has finished, its start time, and its input.
static WATCHED: Mutex<Option<(Arc<AtomicBool>, Instant, PathBuf)>> = Mutex::new(None);

fn watch_for_ever() {
    loop {
        std::thread::sleep(Duration::from_secs(1));
        if let Some((over, since, path)) = WATCHED.lock().unwrap().as_ref()
            && !over.load(Ordering::Relaxed)
            && since.elapsed() > HANGS
        {
            eprintln!("{}: hangs", path.display());
            std::process::exit(1);
        }
    }
}
