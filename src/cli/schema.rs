//! `abbe schema`: the JSON Schema of the scene file, and the scene reference.

use super::{Outcome, print};
use abbe_format as format;
use abbe_spectra::error::Result;

#[derive(Debug, clap::Args)]
pub(crate) struct SchemaArgs {
    /// Print the scene reference in Markdown instead: every key with its type, unit, default and
    /// range
    #[arg(long)]
    markdown: bool,
}

pub(crate) fn run(arguments: &SchemaArgs) -> Result<Outcome> {
    if arguments.markdown {
        print::data(&format::scene_reference())?;
    } else {
        print::json(&format::schema())?;
    }
    Ok(Outcome::Done)
}
