//! Measurements with the meters of a scene: their readings as a table and as CSV.

use std::fmt::Write as _;
use std::path::Path;

use abbe_session::render::{
    Integrator, Job, MeasurementReport, MeterReport, Monitor, PointReport, StopRules, Value, on_threads,
};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::log10;

/// Measures with the meters of a planned scene, on the threads that it sets, with `integrator` or
/// the one that suits the meters. Also returns true if the monitor stopped the measurement. Errors
/// name the scene file `path`: the integrator cannot measure the scene, or threads cannot be
/// started.
pub fn measure(
    job: &Job,
    path: &Path,
    integrator: Option<Integrator>,
    stop: StopRules,
    monitor: &mut (dyn Monitor + Send),
) -> Result<(MeasurementReport, bool)> {
    let measured = on_threads(job.scene.settings.threads, || job.measure(integrator, stop, monitor))?;
    measured.map_err(|error| error.in_file(path))
}

pub fn table(report: &MeasurementReport) -> String {
    let mut text = String::new();
    for meter in &report.meters {
        let _ = writeln!(text, "{}", title(meter));
        let _ = writeln!(
            text,
            "  {:>26}  {:>12}  {:>23}  {:>9}  {:>9}",
            "position", "value", "95 % interval", "noise", "bias"
        );
        for point in &meter.points {
            let _ = writeln!(text, "  {:>26}  {}", position(point), row(meter, point));
        }
        if let Some(summary) = summary(meter) {
            let _ = writeln!(text, "  {summary}");
        }
    }
    text
}

pub(super) fn title(meter: &MeterReport) -> String {
    format!("{}: {} ({})", meter.name, meter.quantity.replace('_', " "), meter.unit)
}

pub(super) fn position(point: &PointReport) -> String {
    let short = |value: f64| format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_string();
    point.position.map(short).join(", ")
}

/// Returns the mean and the uniformity of a meter with several readings.
pub(super) fn summary(meter: &MeterReport) -> Option<String> {
    let (mean, uniformity, least_to_largest) = (meter.mean?, meter.uniformity?, meter.least_to_largest?);
    let several = meter.points.len() > 1;
    several.then(|| {
        format!("mean {}, least/mean (U0) {uniformity:.3}, least/largest {least_to_largest:.3}", significant(mean))
    })
}

fn row(meter: &MeterReport, point: &PointReport) -> String {
    let Value::Number(value) = &point.value else { return spectrum_rows(meter, point) };
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

pub(super) fn significant(value: f64) -> String {
    rounded(value, 5.0)
}

/// Returns a number with this count of significant digits, without trailing zeros.
pub(super) fn rounded(value: f64, count: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (count - 1.0 - log10(value.abs()).floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Returns the readings as CSV, with one line for each reading and each wavelength.
pub fn csv(report: &MeasurementReport) -> String {
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

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
