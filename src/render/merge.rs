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
        let picture = sum.ok_or_else(|| Error::input("no parts to merge"))?.develop();
        let stats: Vec<&Stats> = self.parts.iter().map(|(_, saved)| &saved.stats).collect();
        let stats = Stats::together(&stats, &picture);
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

/// Refuses a pass in two parts; tells which passes are in none.
fn gaps(parts: &[(PathBuf, Saved)]) -> Result<Option<String>> {
    let mut passes: Vec<(u64, usize)> = Vec::new();
    for (number, (_, saved)) in parts.iter().enumerate() {
        passes.extend((0..saved.done).map(|nth| (saved.part.pass(nth), number)));
    }
    passes.sort_unstable();
    if let Some(pair) = passes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let (one, two) = (&parts[pair[0].1].0, &parts[pair[1].1].0);
        let what = format!("holds pass {}, which {} holds too", pair[1].0, one.display());
        return Err(Error::input(what).expected("every pass in one part only").in_file(two));
    }
    let wanted = parts.iter().filter_map(|(_, saved)| saved.wanted).max().unwrap_or(0);
    let total = passes.last().map_or(0, |(last, _)| last + 1).max(wanted);
    let missing = total - passes.len() as u64;
    if missing == 0 {
        return Ok(None);
    }
    /// How many are named.
    const NAMED: usize = 3;
    let mut held = passes.iter().map(|(pass, _)| *pass).peekable();
    let absent = (0..total).filter(|pass| held.next_if_eq(pass).is_none()).take(NAMED);
    let mut named = absent.map(|pass| pass.to_string()).collect::<Vec<_>>().join(", ");
    if missing > NAMED as u64 {
        named.push_str(", …");
    }
    Ok(Some(format!("{missing} of {total} passes ({named})")))
}
