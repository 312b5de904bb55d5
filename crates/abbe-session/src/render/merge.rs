//! Merges the parts of a picture to that of a single run with all their passes.

use super::denoise::picture_and_errors;
use super::display::DisplaySettings;
use super::identity::RenderIdentity;
use super::part::PassPart;
use super::saved_run::SavedRun;
use super::stats::Stats;
use crate::output::metadata::{Metadata, names};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Observer;
use abbe_transport::sensor::{Film, Picture};
use std::path::{Path, PathBuf};

/// Parts of one picture that can be merged. Only their records are in memory.
#[derive(Debug)]
pub struct PartSet {
    parts: Vec<(PathBuf, SavedRun)>,
    header: Metadata,
    /// The missing passes, in words.
    gaps: Option<String>,
}

#[derive(Debug)]
pub struct MergedPicture {
    pub picture: Picture,
    /// The statistics of all parts together.
    pub stats: Stats,
    /// The conversion of the picture's colours for a PNG file.
    pub display: DisplaySettings,
    pub metadata: Metadata,
}

impl PartSet {
    /// Reads the records of the parts. Returns an input error that names the file and the
    /// difference if a file has no exact sums, if the parts belong to different renders, or if two
    /// contain the same pass.
    pub fn new(paths: &[PathBuf]) -> Result<Self> {
        let mut parts: Vec<(PathBuf, SavedRun)> = Vec::with_capacity(paths.len());
        let mut header = Metadata::new();
        for path in paths {
            if let Some((same, _)) = parts.iter().find(|(other, _)| is_same(other, path)) {
                return Err(Error::input(format!("is given twice (as {})", same.display())).in_file(path));
            }
            let (saved, metadata) = SavedRun::read(path)?;
            match parts.first() {
                None => header = metadata,
                Some((first, other)) => check(&saved.identity, &other.identity, first).map_err(|e| e.in_file(path))?,
            }
            parts.push((path.clone(), saved));
        }
        let gaps = gaps(&parts)?;
        Ok(Self { parts, header, gaps })
    }

    /// Returns the files to merge while the parts grow: for each part, that with the most passes.
    /// Files without exact sums, such as previews, are left out.
    pub fn newest(paths: &[PathBuf]) -> Vec<PathBuf> {
        let mut newest: Vec<(&PathBuf, PassPart, u64)> = Vec::new();
        for path in paths {
            let Ok((saved, _)) = SavedRun::read(path) else { continue };
            match newest.iter_mut().find(|(_, part, _)| *part == saved.part) {
                Some(known) if known.2 < saved.done => *known = (path, saved.part, saved.done),
                Some(_) => {}
                None => newest.push((path, saved.part, saved.done)),
            }
        }
        newest.into_iter().map(|(path, ..)| path.clone()).collect()
    }

    /// Returns the missing passes in words, or `None` if the parts are complete.
    pub fn gaps(&self) -> Option<&str> {
        self.gaps.as_deref()
    }

    /// Returns the parts. Each entry contains the file, the part and its number of passes.
    pub fn parts(&self) -> impl Iterator<Item = (&Path, PassPart, u64)> {
        self.parts.iter().map(|(path, saved)| (path.as_path(), saved.part, saved.done))
    }

    /// Adds the sums of all parts, of which only a few rows are in memory. A file that a job has
    /// replaced by one with more passes of the same part is merged. Returns an input error if a
    /// file is damaged, or was replaced by another part.
    pub fn merge(mut self) -> Result<MergedPicture> {
        // The sums contain the observer's response, so developing them ignores the observer.
        let observer = Observer::cie1931();
        let mut sum: Option<Film> = None;
        for (path, saved) in &mut self.parts {
            let (now, _) = SavedRun::read(path)?;
            if now.part != saved.part || now.identity.check(&saved.identity).is_err() {
                return Err(Error::input("was replaced by another part in the meantime").in_file(path));
            }
            *saved = now;
            let film = match sum.take() {
                None => saved.blank_film(path, observer)?,
                Some(film) => film,
            };
            saved.add_to(path, sum.insert(film))?;
        }
        self.gaps = gaps(&self.parts)?;
        let film = sum.ok_or_else(|| Error::input("no parts to merge"))?;
        let (picture, errors) = picture_and_errors(&film);
        let stats: Vec<&Stats> = self.parts.iter().map(|(_, saved)| &saved.stats).collect();
        let stats = Stats::merged(&stats, &picture, errors);
        let display = self.parts[0].1.display;
        let metadata = self.metadata(&stats);
        Ok(MergedPicture { picture, stats, display, metadata })
    }

    /// Returns the header of the first part, with the statistics of all parts.
    fn metadata(&self, stats: &Stats) -> Metadata {
        let mut notes: Vec<String> =
            self.header.get(names::NOTES).and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
        notes.extend(self.gaps.iter().map(|gaps| format!("merged without {gaps}")));
        let of_the_scene = [
            names::VERSION,
            names::SCENE_HASH,
            names::SCENE,
            names::PLAN,
            names::DISPLAY,
            names::INTEGRATOR,
            names::SEED,
            names::PHOTONS,
        ];
        let kept = of_the_scene.iter().filter_map(|name| Some((*name, self.header.get(name)?)));
        kept.fold(Metadata::new(), |metadata, (name, value)| metadata.with(name, value))
            .with(names::PASSES, &stats.passes.to_string())
            .with_json(names::LEDGER, &stats.ledger_w)
            .with(names::SECONDS, &format!("{:.3}", stats.seconds.total))
            .with_json(names::NOTES, &notes)
    }
}

/// Returns true if two paths name the same file.
fn is_same(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        (Ok(_) | Err(_), Ok(_) | Err(_)) => a == b,
    }
}

/// Compares the identity of a part with that of the first, in the file `path`.
fn check(identity: &RenderIdentity, first: &RenderIdentity, path: &Path) -> Result<()> {
    identity.check(first).map_err(|error| {
        let expected = error.expected.clone().unwrap_or_default();
        error.expected(format!("{expected}, as {} has", path.display()))
    })
}

/// Returns the missing passes in words, or an input error if two parts contain the same pass.
///
/// The records are not checked yet, and may contain any number of passes, so the time and the
/// memory of this function do not grow with it.
fn gaps(parts: &[(PathBuf, SavedRun)]) -> Result<Option<String>> {
    for (number, (path, saved)) in parts.iter().enumerate() {
        for (other_path, other) in &parts[..number] {
            if let Some(pass) =
                saved.part.shared_with(other.part).filter(|&pass| saved.holds(pass) && other.holds(pass))
            {
                let what = format!("contains pass {pass}, which {} also contains", other_path.display());
                return Err(Error::input(what).expected("each pass in one part only").in_file(path));
            }
        }
    }
    let of_part =
        |saved: &SavedRun| saved.done.checked_sub(1).map_or(0, |last| saved.part.pass(last).saturating_add(1));
    let total = parts.iter().map(|(_, saved)| of_part(saved).max(saved.wanted.unwrap_or(0))).max().unwrap_or(0);
    let missing = parts.iter().fold(total, |missing, (_, saved)| missing.saturating_sub(saved.done));
    if missing == 0 {
        return Ok(None);
    }
    /// The largest number of missing passes in the text.
    const NAMED: usize = 3;
    /// The search for missing passes ends after this many passes.
    const SEARCHED: u64 = 1_000_000;
    let is_absent = |pass: &u64| !parts.iter().any(|(_, saved)| saved.holds(*pass));
    let absent: Vec<String> =
        (0..total.min(SEARCHED)).filter(is_absent).take(NAMED).map(|pass| pass.to_string()).collect();
    let more = (missing > absent.len() as u64).then(|| "…".to_owned());
    let named = absent.into_iter().chain(more).collect::<Vec<_>>().join(", ");
    Ok(Some(format!("{missing} of {total} passes ({named})")))
}
