//! The command line: argument parsing and output of the `abbe` program.
//!
//! Results go to standard output. All other output goes to standard error. The exit status is 0 if
//! the command is done, and 1 if the machine failed. The exit status is 2 if the input or the
//! command line is wrong, and 3 if the limit of `compare --fail-above` was exceeded. The exit
//! status is 130 if the user interrupted the command.

mod check;
mod checkpoint;
mod compare;
mod completions;
mod crystal;
mod develop;
mod display_server;
mod expectation;
mod explain;
mod film;
mod folded_lens;
mod frames;
mod glass;
mod grating;
mod hints;
#[cfg(feature = "meshes")]
mod import;
mod interrupt;
mod lamps;
mod lens;
mod luminaire;
mod man;
mod measure;
mod merge;
mod metal;
mod outputs;
mod preview;
mod print;
mod probe;
mod progress;
mod regress;
mod relight;
mod render;
mod scene_file;
mod schema;
mod slurm;
mod spectrum;
mod study;
mod values;
#[cfg(feature = "view")]
mod view;

use std::ffi::OsString;
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;
use std::sync::Mutex;

use abbe_spectra::error::{Error, Result};
use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

/// A spectral photon-mapping renderer for prisms, lenses, caustics and real lamps.
#[derive(Debug, Parser)]
#[command(name = "abbe", version, about, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to an EXR file with error bars, and to a PNG file beside it
    Render(Box<render::RenderArgs>),
    /// Merge the parts of a picture that several machines rendered
    Merge(merge::MergeArgs),
    /// Write the scripts of Slurm jobs that render a picture in parts on many machines
    Slurm(slurm::SlurmArgs),
    /// Convert a picture to a PNG file with another exposure, white balance, tone curve, gamut
    /// mapping or colour space, without rendering
    Develop(develop::DevelopArgs),
    /// Mix the light groups of a picture with other gains and colours, without rendering
    Relight(relight::RelightArgs),
    /// Print which effects a scene needs, and why
    Explain(explain::ExplainArgs),
    /// Check scenes without rendering them
    Check(check::CheckArgs),
    /// Convert a glTF file, a Mitsuba scene or a pbrt scene to a scene file
    #[cfg(feature = "meshes")]
    Import(import::ImportArgs),
    /// Print the JSON Schema of the scene file
    Schema(schema::SchemaArgs),
    /// Print the colour of a spectrum: XYZ, sRGB, dominant wavelength, colour temperature, colour
    /// rendering index
    Spectrum(spectrum::SpectrumArgs),
    /// Print the refractive index, the Abbe number and the dispersion formula of a glass
    Glass(glass::GlassArgs),
    /// Print the complex refractive index of a metal
    Metal(metal::MetalArgs),
    /// Print the indices, the walk-off and the interference colours of a uniaxial crystal
    Crystal(crystal::CrystalArgs),
    /// Print the reflectance, the transmittance, the amplitudes and the colours of a stack of thin
    /// films
    Film(film::FilmArgs),
    /// Print the orders of a diffraction grating: their angles and efficiencies
    Grating(grating::GratingArgs),
    /// Analyse a lens of several elements: focal length, pupils, aberrations, spots, cross-section
    Lens(lens::LensArgs),
    /// Compare two lamps, or a lamp and its best match from primaries: their colours and the
    /// colours of surfaces under them
    Lamps(lamps::LampsArgs),
    /// Test code that converts spectra to colours: export spectra with known colours, and judge the
    /// results of the code
    Regress(regress::RegressArgs),
    /// Measure the light at the meters of a scene: illuminance, spectra, flux, and other quantities
    Measure(measure::MeasureArgs),
    /// Compare a picture with a reference
    Compare(compare::CompareArgs),
    /// Print the colour, the error bars and the spectrum of a pixel
    Probe(probe::ProbeArgs),
    /// Render a scene and show it on a page in the browser, with the spectrum under the cursor. Or
    /// compare two pictures
    #[cfg(feature = "view")]
    View(view::ViewArgs),
    /// Measure the error against time for a scene: tables, plots and an HTML page
    Study(study::StudyArgs),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArgs),
    /// Print a manual page, or write all of them
    Man(man::ManArgs),
}

/// The result of a command that returned no error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// The command did all its work.
    Done,
    /// A figure is beyond the limit of `--fail-above`, `--fail-below` or `--expect`.
    Exceeded,
    /// The user interrupted the command, and the finished work was saved.
    Interrupted,
    /// The command has printed its errors. The value is the exit status.
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

/// Runs the `abbe` program with the arguments of this process, and returns its exit status. It
/// replaces the panic hook of the process, and the handlers for Ctrl-C and for termination.
pub fn main() -> ExitCode {
    ExitCode::from(run_from(std::env::args_os()))
}

/// Runs the `abbe` program with the given arguments, the name of the program and the words of the
/// command line, and returns its exit status. Use it instead of [`main`] if another program, such
/// as a Python interpreter, owns the process.
pub fn run_from(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let panic_message = capture_panic_message();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    match panic::catch_unwind(AssertUnwindSafe(|| execute(&arguments))) {
        Ok(status) => status,
        Err(_) => {
            let message = panic_message.lock().map(|message| message.clone()).unwrap_or_default();
            print::error_line(&format!("internal error: {message}; this is a bug in abbe, please report it"));
            1
        }
    }
}

/// Installs a panic hook that stores the message of the first panic instead of printing it.
fn capture_panic_message() -> &'static Mutex<String> {
    static MESSAGE: Mutex<String> = Mutex::new(String::new());
    panic::set_hook(Box::new(|info| {
        if let Ok(mut message) = MESSAGE.lock()
            && message.is_empty()
        {
            *message = info.to_string();
        }
    }));
    &MESSAGE
}

/// Parses the command line and runs the command. Returns the exit status.
fn execute(arguments: &[OsString]) -> u8 {
    let outcome = match Cli::try_parse_from(hints::with_resume_value(arguments)) {
        Ok(cli) => run(&cli.command),
        Err(error) => report_usage(&error, arguments),
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
        Command::Slurm(arguments) => slurm::run(arguments),
        Command::Develop(arguments) => develop::run(arguments),
        Command::Relight(arguments) => relight::run(arguments),
        Command::Explain(arguments) => explain::run(arguments),
        Command::Check(arguments) => Ok(check::run(arguments)),
        #[cfg(feature = "meshes")]
        Command::Import(arguments) => import::run(arguments),
        Command::Schema(arguments) => schema::run(arguments),
        Command::Spectrum(arguments) => spectrum::run(arguments),
        Command::Glass(arguments) => glass::run(arguments),
        Command::Metal(arguments) => metal::run(arguments),
        Command::Crystal(arguments) => crystal::run(arguments),
        Command::Film(arguments) => film::run(arguments),
        Command::Grating(arguments) => grating::run(arguments),
        Command::Lens(arguments) => lens::run(arguments),
        Command::Lamps(arguments) => lamps::run(arguments),
        Command::Regress(arguments) => regress::run(arguments),
        Command::Measure(arguments) => measure::run(arguments),
        Command::Compare(arguments) => compare::run(arguments),
        Command::Probe(arguments) => probe::run(arguments),
        #[cfg(feature = "view")]
        Command::View(arguments) => view::run(arguments),
        Command::Study(arguments) => study::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
        Command::Man(arguments) => man::run(arguments),
    }
}

/// Prints clap's message: the help and the version to standard output, but help because of a
/// missing argument to standard error. Any other message becomes a one-line error.
fn report_usage(error: &clap::Error, arguments: &[OsString]) -> Result<Outcome> {
    let text = error.to_string();
    let kind = error.kind();
    if matches!(kind, ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return print::result(&text).map(|()| Outcome::Done);
    }
    if kind == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        print::remark(text.trim_end());
        return Ok(Outcome::Reported(2));
    }
    Err(Error::input(hints::with_known_option(one_line(&text), error, arguments)))
}

/// Joins the lines of clap's message into one line, up to the usage section.
fn one_line(text: &str) -> String {
    let message = text.split("\nUsage:").next().unwrap_or(text);
    let message = message.split("\nFor more information").next().unwrap_or(message);
    let lines: Vec<&str> = message.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
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
