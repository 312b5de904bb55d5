//! Parts of one picture, rendered anywhere, to the picture that a single run of all their passes would have given.

use super::saved::{Identity, Saved, Showing};
use super::{Part, Stats};
use crate::error::{Error, Result};
use crate::output::metadata::{Metadata, names};
use crate::sensor::{Film, Picture};
use crate::spectrum::Observer;
use std::path::{Path, PathBuf};

/// Parts that fit together, before their sums are read.
#[derive(Debug)]
pub struct Merging {
    parts: Vec<(PathBuf, Saved)>,
    /// The first part's header.
    header: Metadata,
    gaps: Option<String>,
}

/// A merged picture.
#[derive(Debug)]
pub struct Merged {
    /// The picture with its error layers.
    pub picture: Picture,
    /// What the parts measured, together.
    pub stats: Stats,
    /// How its colours become those of a PNG.
    pub showing: Showing,
    /// What its file's header says.
    pub metadata: Metadata,
}

impl Merging {
    /// Reads the parts' records.
    ///
    /// # Errors
    /// The input's: a file without exact sums, parts of different renders, a pass in two parts; the error names the file and
    /// the difference.
    pub fn new(paths: &[PathBuf]) -> Result<Self> {
        let mut parts: Vec<(PathBuf, Saved)> = Vec::with_capacity(paths.len());
        let mut header = Metadata::new();
        for path in paths {
            if let Some((same, _)) = parts.iter().find(|(other, _)| is_same(other, path)) {
                return Err(Error::input(format!("is given twice (as {})", same.display())).in_file(path));
            }
            let (saved, metadata) = Saved::read(path)?;
            match parts.first() {
                None => header = metadata,
                Some((first, other)) => check(&saved.identity, &other.identity, first).map_err(|e| e.in_file(path))?,
            }
            parts.push((path.clone(), saved));
        }
        let gaps = gaps(&parts)?;
        Ok(Self { parts, header, gaps })
    }

    /// Which passes are in none of the parts, in words, if any are missing.
    pub fn gaps(&self) -> Option<&str> {
        self.gaps.as_deref()
    }

    /// The passes that each part holds: its file, the part and how many.
    pub fn parts(&self) -> impl Iterator<Item = (&Path, Part, u64)> {
        self.parts.iter().map(|(path, saved)| (path.as_path(), saved.part, saved.done))
    }

    /// Adds up all sums.
    ///
    /// # Errors
    /// The input's: a file that is damaged.
    pub fn merge(self) -> Result<Merged> {
        // Developing asks no observer: what he sees is in the sums already.
        let observer = Observer::cie1931();
        let mut sum: Option<Film> = None;
        for (path, saved) in &self.parts {
            let film = saved.film(path, observer)?;
            match &mut sum {
                None => sum = Some(film),
                Some(sum) => sum.add(&film),
            }
        }
        let (picture, squares) = sum.ok_or_else(|| Error::input("no parts to merge"))?.develop_and_judge();
        let stats: Vec<&Stats> = self.parts.iter().map(|(_, saved)| &saved.stats).collect();
        let stats = Stats::together(&stats, (&picture, squares));
        let showing = self.parts[0].1.showing;
        let metadata = self.metadata(&stats);
        Ok(Merged { picture, stats, showing, metadata })
    }

    /// The first part's header with what the parts measured together.
    fn metadata(&self, stats: &Stats) -> Metadata {
        let mut notes: Vec<String> =
            self.header.get(names::NOTES).and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
        notes.extend(self.gaps.iter().map(|gaps| format!("merged without {gaps}")));
        let of_the_scene = [
            names::VERSION,
            names::SCENE_HASH,
            names::SCENE,
            names::PLAN,
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

fn is_same(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        (Ok(_) | Err(_), Ok(_) | Err(_)) => a == b,
    }
}

fn check(identity: &Identity, first: &Identity, path: &Path) -> Result<()> {
    identity.check(first).map_err(|error| {
        let expected = error.expected.clone().unwrap_or_default();
        error.expected(format!("{expected}, as {} has", path.display()))
    })
}

/// Refuses a pass in two parts; tells which passes are in none. What the records say is not known to be true yet: nothing here grows with
/// the number of passes.
fn gaps(parts: &[(PathBuf, Saved)]) -> Result<Option<String>> {
    for (number, (path, saved)) in parts.iter().enumerate() {
        for (other_path, other) in &parts[..number] {
            if let Some(pass) =
                saved.part.shared_with(other.part).filter(|&pass| saved.holds(pass) && other.holds(pass))
            {
                let what = format!("holds pass {pass}, which {} holds too", other_path.display());
                return Err(Error::input(what).expected("every pass in one part only").in_file(path));
            }
        }
    }
    let of_part = |saved: &Saved| saved.done.checked_sub(1).map_or(0, |last| saved.part.pass(last).saturating_add(1));
    let total = parts.iter().map(|(_, saved)| of_part(saved).max(saved.wanted.unwrap_or(0))).max().unwrap_or(0);
    let missing = parts.iter().fold(total, |missing, (_, saved)| missing.saturating_sub(saved.done));
    if missing == 0 {
        return Ok(None);
    }
    /// How many are named, of the first so many passes.
    const NAMED: usize = 3;
    const LOOKED_THROUGH: u64 = 1_000_000;
    let is_absent = |pass: &u64| !parts.iter().any(|(_, saved)| saved.holds(*pass));
    let absent: Vec<String> =
        (0..total.min(LOOKED_THROUGH)).filter(is_absent).take(NAMED).map(|pass| pass.to_string()).collect();
    let more = (missing > absent.len() as u64).then(|| "…".to_owned());
    let named = absent.into_iter().chain(more).collect::<Vec<_>>().join(", ");
    Ok(Some(format!("{missing} of {total} passes ({named})")))
}
