//! `abbe lamps FILE.ies` (or `.ldt`, `.tm33`, `.xml`): the figures and the polar diagram of a
//! luminaire.

use std::path::Path;

use abbe_format::FileAccess;
use abbe_format::luminaire::{self, LuminaireSummary};
use abbe_session::output::{file, luminaire_page};
use abbe_spectra::error::Result;

use super::{Outcome, print};
use crate::reports::luminaire::{LuminaireReport, diagram, rows};

/// Prints the figures of a luminaire file, and writes the page if `html` is a path.
pub(crate) fn run(path: &Path, html: Option<&Path>, json: bool) -> Result<Outcome> {
    let photometry = luminaire::read(path, FileAccess::WithinFolder)?;
    let summary = LuminaireSummary::of(&photometry).map_err(|error| error.in_file(path))?;
    photometry.notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
    let name = if photometry.name.is_empty() { path.display().to_string() } else { photometry.name.clone() };
    let rows = rows(&photometry, &summary);
    if let Some(page) = html {
        file::write_whole(page, luminaire_page::page(&name, &rows, &diagram(&summary)).as_bytes())?;
    }
    if json {
        print::json(&LuminaireReport::new(&name, &photometry, &summary))?;
    } else {
        let table: String = rows.iter().map(|(name, value)| format!("{name:<15} {value}\n")).collect();
        print::result(&format!("{name}\n\n{table}"))?;
    }
    Ok(Outcome::Done)
}
