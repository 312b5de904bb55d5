//! `abbe schema`: the JSON Schema of the scene file.

use super::{Outcome, print};
use abbe::error::Result;
use abbe::scene::file;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {}

pub(crate) fn run() -> Result<Outcome> {
    print::json(&file::schema())?;
    Ok(Outcome::Done)
}
