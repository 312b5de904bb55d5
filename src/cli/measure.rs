//! `abbe measure`: measures the light at the meters of a scene.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use crate::error::Result;
use crate::format::resolve::resolve_meters;
use crate::math::elementary::log10;
use crate::output::file as files;
use crate::render::{Job, MeasurementReport, MeterReport, PointReport, StopRules, Value, on_threads};

use super::progress::{ProgressDisplay, time};
use super::render::IntegratorName;
use super::scene_file::SceneFileArgs;
use super::{Outcome, interrupt, memory, print, values};

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
    /// Stop when the relative error of every reading falls to this value, such as 1%. Readings
    /// below a tenth of the largest reading of their meter are judged relative to that tenth
    /// [default: 0.3%, unless another limit is given]
    #[arg(long, value_name = "RATIO", value_parser = values::share)]
    target_error: Option<f64>,
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

pub(crate) fn run(arguments: &MeasureArgs) -> Result<Outcome> {
    interrupt::watch()?;
    let job = plan(arguments)?;
    memory::check(&job.budget)?;
    if let Some(path) = &arguments.csv {
        files::check_writable(path)?;
    }
    let stop = StopRules { passes: arguments.passes, time: arguments.time, target_error: arguments.target_error };
    let integrator = arguments.integrator.map(IntegratorName::integrator);
    let mut display = ProgressDisplay::new(arguments.quiet, None);
    let measured = on_threads(job.scene.settings.threads, || job.measure(integrator, stop, &mut display))?;
    display.finish();
    let (report, interrupted) = measured.map_err(|error| error.in_file(&arguments.scene))?;
    if let Some(path) = &arguments.csv {
        files::write_whole(path, csv(&report).as_bytes())?;
    }
    if arguments.json {
        print::json(&report)?;
    } else {
        print::result(&table(&report))?;
    }
    if !arguments.quiet {
        report.notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
        let spent = time(Duration::try_from_secs_f64(report.seconds).unwrap_or_default());
        let passes = print::passes(report.passes);
        print::remark(&format!("{passes} by the {} integrator in {spent}", report.integrator));
    }
    Ok(if interrupted { Outcome::Interrupted } else { Outcome::Done })
}

/// Reads the scene, applies the options, and plans the measurement.
fn plan(arguments: &MeasureArgs) -> Result<Job> {
    let path = &arguments.scene;
    let mut patches = arguments.set.clone();
    let mut add = |path: &str, value: Option<String>| patches.extend(value.map(|value| format!("{path}={value}")));
    add("render.photons", arguments.photons.map(|photons| photons.to_string()));
    add("render.seed", arguments.seed.map(|seed| seed.to_string()));
    add("render.threads", arguments.threads.map(|threads| threads.to_string()));
    let (mut scene, source) = arguments.scene_file.read(path, &patches)?;
    scene.render.forbid.extend(arguments.forbid.iter().cloned());
    scene.select_meters(&arguments.meter).map_err(|error| error.in_file(path))?;
    let resolved = resolve_meters(&scene, &source)?;
    Job::new(resolved).map_err(|error| error.in_file(path))
}

/// Returns the readings as a table.
fn table(report: &MeasurementReport) -> String {
    let mut text = String::new();
    for meter in &report.meters {
        let _ = writeln!(text, "{}: {} ({})", meter.name, meter.quantity.replace('_', " "), meter.unit);
        let _ = writeln!(
            text,
            "  {:>26}  {:>12}  {:>23}  {:>9}  {:>9}",
            "position", "value", "95 % interval", "noise", "bias"
        );
        for point in &meter.points {
            let position = point
                .position
                .map(|value| format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_string());
            let _ = writeln!(text, "  {:>26}  {}", position.join(", "), row(meter, point));
        }
        if let (Some(mean), Some(uniformity), true) = (meter.mean, meter.uniformity, meter.points.len() > 1) {
            let _ = writeln!(text, "  mean {}, least/mean {uniformity:.3}", significant(mean));
        }
    }
    text
}

/// Returns the columns of a reading.
fn row(meter: &MeterReport, point: &PointReport) -> String {
    let Value::Number(value) = &point.value else {
        return spectrum_rows(meter, point);
    };
    let number = |value: &Option<Value>| match value {
        Some(Value::Number(value)) => significant(*value),
        Some(Value::Spectrum(_)) | None => "-".to_string(),
    };
    let interval = match &point.interval_95 {
        Some([Value::Number(low), Value::Number(high)]) => format!("{} to {}", significant(*low), significant(*high)),
        _ => "-".to_string(),
    };
    let flux = point.flux.map_or(String::new(), |flux| {
        format!("  flux {} over {} m²", significant(flux), significant(point.area_m2.unwrap_or(0.0)))
    });
    format!(
        "{:>12}  {interval:>23}  {:>9}  {:>9}{flux}",
        significant(*value),
        number(&point.noise),
        number(&point.bias)
    )
}

/// Returns the spectrum of a reading, one band on each line.
fn spectrum_rows(meter: &MeterReport, point: &PointReport) -> String {
    let (Value::Spectrum(values), Some(nm)) = (&point.value, &meter.wavelength_nm) else { return String::new() };
    let lines = nm.iter().zip(values).map(|(nm, value)| format!("\n  {nm:>26} nm  {:>9}", significant(*value)));
    lines.collect()
}

/// Returns a number with five significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (4.0 - log10(value.abs()).floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Returns the readings as CSV.
fn csv(report: &MeasurementReport) -> String {
    let mut text = "meter,quantity,unit,x,y,z,wavelength_nm,value,noise,bias,low_95,high_95\n".to_string();
    for meter in &report.meters {
        for point in &meter.points {
            let bands = match &point.value {
                Value::Number(_) => 1,
                Value::Spectrum(values) => values.len(),
            };
            for band in 0..bands {
                let cell = |value: Option<&Value>| match value {
                    Some(Value::Number(value)) => value.to_string(),
                    Some(Value::Spectrum(values)) => values[band].to_string(),
                    None => String::new(),
                };
                let nm = meter.wavelength_nm.as_ref().map_or(String::new(), |nm| nm[band].to_string());
                let [x, y, z] = point.position;
                let (low, high) =
                    (point.interval_95.as_ref().map(|ends| &ends[0]), point.interval_95.as_ref().map(|ends| &ends[1]));
                let (value, noise, bias) =
                    (cell(Some(&point.value)), cell(point.noise.as_ref()), cell(point.bias.as_ref()));
                let _ = writeln!(
                    text,
                    "{},{},{},{x},{y},{z},{nm},{value},{noise},{bias},{},{}",
                    quoted(&meter.name),
                    meter.quantity,
                    meter.unit,
                    cell(low),
                    cell(high)
                );
            }
        }
    }
    text
}

/// Returns a text as a CSV cell.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
