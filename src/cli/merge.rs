//! `abbe merge`: parts of a picture, rendered anywhere, become the picture of a single run.

use std::path::PathBuf;

use abbe::error::{Error, Result};
use abbe::output::exr::write;
use abbe::render::{Merging, on_threads};

use super::outputs::Outputs;
use super::progress::percent;
use super::{Outcome, print};

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The parts, from `abbe render --part`; checkpoints are parts too
    #[arg(value_name = "PART.exr", required = true)]
    parts: Vec<PathBuf>,
    /// The picture's file; a PNG is written beside it
    #[arg(short, long, value_name = "OUT.exr")]
    output: PathBuf,
    /// Merge though passes are missing, and say which
    #[arg(long)]
    allow_gaps: bool,
    /// Write what the parts measured together, as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Say nothing unless something goes wrong
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let outputs = Outputs::new(arguments.output.clone(), arguments.stats.clone())?;
    let same =
        |part: &&PathBuf| part.canonicalize().is_ok_and(|part| outputs.exr.canonicalize().is_ok_and(|out| out == part));
    if let Some(part) = arguments.parts.iter().find(same) {
        return Err(Error::input("is both a part and the output").expected("another output").in_file(part));
    }
    let merging = Merging::new(&arguments.parts)?;
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
    outputs.check()?;
    let merged = on_threads(None, || merging.merge())??;
    let write_exr = |path: &std::path::Path| write(path, &merged.picture, &merged.metadata);
    on_threads(None, || outputs.save(write_exr, &merged.picture, &merged.showing, &merged.stats))??;
    if !arguments.quiet {
        let error = merged.stats.error.relative.map_or(String::new(), |error| format!(", error {}", percent(error)));
        let (parts, passes) = (arguments.parts.len(), merged.stats.passes);
        print::remark(&format!("{}: {passes} passes of {parts} parts{error}", outputs.named()));
    }
    Ok(Outcome::Done)
}
