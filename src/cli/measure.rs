//! `abbe measure`: measures the light at the meters of a scene.

use std::path::PathBuf;
use std::time::Duration;

use abbe_format::RequirementFile;
use abbe_format::resolve::resolve_meters;
use abbe_session::output::file as files;
use abbe_session::render::{Job, StopRules};
use abbe_spectra::error::{Error, Result};

use super::progress::{ProgressDisplay, time};
use super::render::IntegratorName;
use super::scene_file::SceneFileArgs;
use super::{Outcome, interrupt, print, values};
use crate::api::memory;
use crate::api::provenance::SceneFiles;
use crate::reports::measurement::{csv, measure, table};
use crate::reports::measurement_page::page;
use crate::reports::requirements::{self, JudgedMeasurement};

#[derive(Debug, Clone, clap::Args)]
pub(crate) struct MeasureArgs {
    /// The scene file, with `meters`
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Print the readings as JSON
    #[arg(long)]
    json: bool,
    /// Write the readings as a CSV file, with one line for each reading
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Write an HTML page with all readings, and with a plan of every grid in false colours with
    /// isolines
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Measure only with these meters [default: all meters]
    #[arg(long, value_name = "NAME")]
    meter: Vec<String>,
    /// Stop after this many passes [default: 2048, or 128 with photons, unless another
    /// limit is given]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    passes: Option<u64>,
    /// Stop after this time, such as 90s, 5m or 1h30m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    time: Option<Duration>,
    /// Stop when the relative error of every reading falls to this value, such as 1%, or the
    /// relative error of every reading of one meter, such as desk=1%. Readings below a tenth of the
    /// largest reading of their meter are judged relative to that tenth [default: 0.3%, unless
    /// another limit is given]
    #[arg(long, value_name = "[METER=]RATIO", value_parser = target_error)]
    target_error: Option<TargetError>,
    /// The number of photon paths in a pass
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    photons: Option<u64>,
    /// The seed of all random streams
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// The number of worker threads [default: the number of logical processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// The integrator [default: the path tracer, or photon mapping if light of the sun or of a lamp
    /// without extent meets mirrors or glass other than thin panes]
    #[arg(long, value_enum)]
    integrator: Option<IntegratorName>,
    /// Leave out an effect even if the scene needs it (repeatable)
    #[arg(long, value_name = "EFFECT")]
    forbid: Vec<String>,
    #[arg(
        long,
        value_name = "PATH=JSON",
        help = "Change a value of the scene, such as 'meters[0].quantity=\"ppfd\"' (repeatable)"
    )]
    set: Vec<String>,
    #[command(flatten)]
    scene_file: SceneFileArgs,
    /// Print only the readings, warnings and errors
    #[arg(long)]
    quiet: bool,
}

/// The relative error at which a measurement stops.
#[derive(Debug, Clone, PartialEq)]
struct TargetError {
    /// The name of the meter, or `None` for all meters.
    meter: Option<String>,
    ratio: f64,
}

/// Parses a target error such as `1%` or `desk=1%`. The name of a meter may contain `=`.
fn target_error(text: &str) -> std::result::Result<TargetError, String> {
    let (meter, ratio) = text.rsplit_once('=').map_or((None, text), |(meter, ratio)| (Some(meter), ratio));
    values::fraction(ratio).map(|ratio| TargetError { meter: meter.map(str::to_string), ratio })
}

pub(crate) fn run(arguments: &MeasureArgs) -> Result<Outcome> {
    interrupt::watch()?;
    let Measured { job, requirements, title } = plan(arguments)?;
    for path in [&arguments.csv, &arguments.html].into_iter().flatten() {
        files::check_writable(path)?;
    }
    let target_error = arguments.target_error.as_ref().map(|target| target.ratio);
    let stop = StopRules { passes: arguments.passes, time: arguments.time, target_error };
    let integrator = arguments.integrator.map(IntegratorName::integrator);
    let mut display = ProgressDisplay::new(arguments.quiet, None);
    let measured = measure(&job, &arguments.scene, integrator, stop, &mut display);
    display.finish();
    let (report, interrupted) = measured?;
    if report.passes == 0 {
        print::remark("interrupted before the first pass was done, so there is no reading");
        return Ok(Outcome::Interrupted);
    }
    let judgements = requirements::judgements(&requirements, &report);
    if let Some(path) = &arguments.csv {
        files::write_whole(path, csv(&report).as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        let page = page(&report, &judgements, &job, (&arguments.scene, title.as_deref()));
        files::write_whole(path, page.as_bytes())?;
    }
    if arguments.json {
        print::json(&JudgedMeasurement { report: &report, requirements: &judgements })?;
    } else {
        print::result(&(table(&report) + &requirements::table(&judgements)))?;
    }
    print::notes(&report.notes, &report.warnings, arguments.quiet);
    if !arguments.quiet {
        let spent = time(Duration::try_from_secs_f64(report.seconds).unwrap_or_default());
        let passes = print::passes(report.passes);
        print::remark(&format!("{passes} by the {} integrator in {spent}", report.integrator));
    }
    Ok(if interrupted { Outcome::Interrupted } else { Outcome::Done })
}

/// A scene to be measured.
struct Measured {
    job: Job,
    requirements: Vec<RequirementFile>,
    title: Option<String>,
}

fn plan(arguments: &MeasureArgs) -> Result<Measured> {
    let path = &arguments.scene;
    let mut patches = arguments.set.clone();
    let mut add = |path: &str, value: Option<String>| patches.extend(value.map(|value| format!("{path}={value}")));
    add("render.photons", arguments.photons.map(|photons| photons.to_string()));
    add("render.seed", arguments.seed.map(|seed| seed.to_string()));
    add("render.threads", arguments.threads.map(|threads| threads.to_string()));
    let (mut scene, source) = arguments.scene_file.read(path, &patches, arguments.quiet)?;
    let outputs = [&arguments.csv, &arguments.html].into_iter().flatten().map(PathBuf::as_path);
    files::check_keeps_inputs(outputs, arguments.scene_file.inputs(&SceneFiles::of(&source), path))?;
    scene.render.forbid.extend(arguments.forbid.iter().cloned());
    scene.select_meters(&arguments.meter).map_err(|error| error.in_file(path))?;
    let mut resolved = resolve_meters(&scene, &source)?;
    if let Some(name) = arguments.target_error.as_ref().and_then(|target| target.meter.as_ref()) {
        if !resolved.meters.iter().any(|meter| meter.name == *name) {
            let known = resolved.meters.iter().map(|meter| meter.name.as_str());
            let expected = format!("one of {}", known.clone().collect::<Vec<_>>().join(", "));
            return Err(Error::unknown_name("meter", name, known).expected(expected).on_path("--target-error"));
        }
        resolved.meters.iter_mut().for_each(|meter| meter.decides_stop = meter.name == *name);
    }
    Ok(Measured { job: memory::plan(resolved, path)?, requirements: scene.requirements, title: scene.title })
}
