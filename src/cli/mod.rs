//! The command line: what is asked, and how it is answered.
//!
//! Results go to standard output, everything else to standard error. Exit status: 0 done, 1 the machine failed,
//! 2 the input or the command is wrong, 3 `compare --fail-above` was exceeded, 130 interrupted.

mod check;
mod checkpoint;
mod colour;
mod compare;
mod explain;
mod frames;
mod glass;
mod interrupt;
mod lamps;
mod lens;
mod memory;
mod merge;
mod named;
mod opening;
mod origin;
mod outputs;
mod print;
mod probe;
mod progress;
mod render;
mod schema;
mod spectrum;
mod study;
mod values;

use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;
use std::sync::Mutex;

use abbe::error::{Error, Result};
use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

/// Abbe renders what light does: prisms, lenses, caustics and real lamps, wavelength by wavelength.
#[derive(Debug, Parser)]
#[command(name = "abbe", version, about, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to an EXR with error bars, and a PNG beside it
    Render(render::Arguments),
    /// Merge parts of a picture, rendered anywhere, into the picture of a single run
    Merge(merge::Arguments),
    /// Say which effects a scene calls for, and why
    Explain(explain::Arguments),
    /// Check scenes without rendering them
    Check(check::Arguments),
    /// Print the JSON Schema of the scene file
    Schema(schema::Arguments),
    /// The colour of a spectrum: XYZ, sRGB, dominant wavelength, colour temperature, colour rendering
    Spectrum(spectrum::Arguments),
    /// A glass: its index at any wavelength, its Abbe number, its formulas
    Glass(glass::Arguments),
    /// A lens of several elements: focal length, pupils, colour errors, spots, cross-section
    Lens(lens::Arguments),
    /// Compare two lamps, or a lamp with its match from primaries: their colours, and what they make of surfaces
    Lamps(lamps::Arguments),
    /// Compare a picture with a reference
    Compare(compare::Arguments),
    /// The spectrum, the colour and the error bars of a pixel
    Probe(probe::Arguments),
    /// What accuracy costs in time: tables, plots and a page
    Study(study::Arguments),
}

/// How a command ended that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// As asked.
    Done,
    /// The pictures differ by more than `--fail-above`.
    Exceeded,
    /// By Ctrl-C, with what was finished saved.
    Interrupted,
    /// With errors that have been printed; the exit status that they call for.
    Reported(u8),
}

impl Outcome {
    fn exit_status(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Exceeded => 3,
            Self::Interrupted => 130,
            Self::Reported(status) => status,
        }
    }
}

/// The whole program.
pub(crate) fn main() -> ExitCode {
    let last_words = silence_panics();
    match panic::catch_unwind(AssertUnwindSafe(answer)) {
        Ok(status) => ExitCode::from(status),
        Err(_) => {
            let words = last_words.lock().map(|words| words.clone()).unwrap_or_default();
            print::error_line(&format!("internal error: {words}; this is a bug in abbe, please report it"));
            ExitCode::from(1)
        }
    }
}

/// Keeps panics from printing; what they would have said is collected.
fn silence_panics() -> &'static Mutex<String> {
    static LAST_WORDS: Mutex<String> = Mutex::new(String::new());
    panic::set_hook(Box::new(|info| {
        if let Ok(mut words) = LAST_WORDS.lock()
            && words.is_empty()
        {
            *words = info.to_string();
        }
    }));
    &LAST_WORDS
}

/// Parses the command line and carries it out; returns the exit status.
fn answer() -> u8 {
    let outcome = match Cli::try_parse() {
        Ok(cli) => run(&cli.command),
        Err(error) => refuse(&error),
    };
    match outcome {
        Ok(outcome) => outcome.exit_status(),
        Err(error) => {
            print::error(&error);
            error.exit_status()
        }
    }
}

fn run(command: &Command) -> Result<Outcome> {
    match command {
        Command::Render(arguments) => render::run(arguments),
        Command::Merge(arguments) => merge::run(arguments),
        Command::Explain(arguments) => explain::run(arguments),
        Command::Check(arguments) => Ok(check::run(arguments)),
        Command::Schema(schema::Arguments {}) => schema::run(),
        Command::Spectrum(arguments) => spectrum::run(arguments),
        Command::Glass(arguments) => glass::run(arguments),
        Command::Lens(arguments) => lens::run(arguments),
        Command::Lamps(arguments) => lamps::run(arguments),
        Command::Compare(arguments) => compare::run(arguments),
        Command::Probe(arguments) => probe::run(arguments),
        Command::Study(arguments) => study::run(arguments),
    }
}

/// What clap has to say: help and version are results, everything else an error of one line.
fn refuse(error: &clap::Error) -> Result<Outcome> {
    let text = error.to_string();
    let kind = error.kind();
    if matches!(kind, ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return print::result(&text).map(|()| Outcome::Done);
    }
    if kind == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        print::remark(text.trim_end());
        return Ok(Outcome::Reported(2));
    }
    Err(Error::input(one_line(&text)))
}

/// Clap's message up to its usage, on one line.
fn one_line(text: &str) -> String {
    let said = text.split("\nUsage:").next().unwrap_or(text);
    let said = said.split("\nFor more information").next().unwrap_or(said);
    let lines: Vec<&str> = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines.join(" ").replace(" tip: ", "; tip: ").trim_start_matches("error: ").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_wrong_command_is_one_line_with_its_hint() {
        let error = Cli::try_parse_from(["abbe", "render", "a.json", "--passs", "3"]).unwrap_err();
        let line = one_line(&error.to_string());
        assert!(line.contains("--passs") && line.contains("'--passes'") && !line.contains('\n'), "{line}");
        assert!(!line.starts_with("error") && !line.contains("Usage"), "{line}");
    }
}
