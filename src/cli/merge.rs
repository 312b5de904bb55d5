//! `abbe merge`: merges parts of a picture. The result equals the picture of a single run.

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::output::exr::write;
use crate::render::{PartSet, on_threads};

use super::outputs::OutputFiles;
use super::{Outcome, print};

#[derive(Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// The parts, written by `abbe render --part`; checkpoints are parts too
    #[arg(value_name = "PART.exr", required = true)]
    parts: Vec<PathBuf>,
    /// The file of the picture; a PNG file is written beside it
    #[arg(short, long, value_name = "OUT.exr")]
    output: PathBuf,
    /// Merge even if passes are missing, and print which ones
    #[arg(long)]
    allow_gaps: bool,
    /// Write the statistics of all parts together as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Print only warnings and errors
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &MergeArgs) -> Result<Outcome> {
    let outputs = OutputFiles::new(arguments.output.clone(), arguments.stats.clone())?;
    let same =
        |part: &&PathBuf| part.canonicalize().is_ok_and(|part| outputs.exr.canonicalize().is_ok_and(|out| out == part));
    if let Some(part) = arguments.parts.iter().find(same) {
        return Err(Error::input("the file is both a part and the output")
            .expected("a different output file")
            .in_file(part));
    }
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
    outputs.check()?;
    let merged = on_threads(None, || merging.merge())??;
    let write_exr = |path: &std::path::Path| write(path, &merged.picture, &merged.metadata);
    let exposure = on_threads(None, || outputs.save(write_exr, &merged.picture, &merged.display, &merged.stats))??;
    if !arguments.quiet {
        let error = print::picture_error(&merged.stats.error);
        let (parts, passes) = (print::counted(arguments.parts.len(), "part"), print::passes(merged.stats.passes));
        let exposure = print::exposure(exposure);
        print::remark(&format!("wrote {}: {passes} from {parts}, exposure {exposure}\n{error}", outputs.named()));
    }
    Ok(Outcome::Done)
}
