//! The operands of a Zemax file that the readers of other formats produce.

use super::reader::ZmxReader;
use crate::glass::{AgfCatalogue, catalogue, makers::makers};
use abbe_spectra::error::Result;

/// A Zemax operand with the line and the column of what it comes from.
pub(super) struct Operand {
    pub(super) place: (usize, usize),
    pub(super) name: &'static str,
    pub(super) arguments: Vec<String>,
}

impl Operand {
    pub(super) fn new(place: (usize, usize), name: &'static str, arguments: &[&str]) -> Self {
        Self { place, name, arguments: arguments.iter().map(|word| (*word).to_string()).collect() }
    }
}

/// Reads operands in their order. Returns an error with the place of the operand.
pub(super) fn read_all<'a>(operands: impl Iterator<Item = &'a Operand>, reader: &mut ZmxReader<'_>) -> Result<()> {
    for Operand { place: (line, column), name, arguments } in operands {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        reader.read(name, &arguments, *line).map_err(|error| error.at(*line, *column))?;
    }
    Ok(())
}

/// Returns the name of a glass in the given catalogues, the built-in one or those of the makers,
/// for a name in any case that may lack hyphens; or the same name if no catalogue has the glass.
pub(super) fn glass_name<'a>(name: &'a str, catalogues: &'a [AgfCatalogue]) -> &'a str {
    let same = |known: &&str| known.replace('-', "").eq_ignore_ascii_case(name) || known.eq_ignore_ascii_case(name);
    let own = catalogues.iter().find_map(|file| file.names().find(same));
    own.or_else(|| catalogue::names().find(same)).or_else(|| makers().names().find(same)).unwrap_or(name)
}
