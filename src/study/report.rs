//! The results of a study as JSON, CSV and plots.

use super::convergence::ConvergencePoint;
use super::curves::{ConvergenceCurve, error_to_fit};
use super::effects::{AblationResult, EffectStudy};
use super::film::StudyFilm;
use super::recommendation::Recommendation;
use super::reference::MeanEstimate;
use super::reference_choice::ReferenceProvenance;
use super::step_cache::json;
use super::study_scene::{Setting, integrator_title};
use super::sweep::SettingSweep;
use abbe_session::output::graph::{LogLogPlot, PlotSeries, SeriesStyle};
use abbe_spectra::math::elementary::powf;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub struct StudyReport {
    pub version: &'static str,
    /// The path of the scene file.
    pub scene: String,
    pub title: String,
    pub budget_seconds: f64,
    pub spent_seconds: f64,
    /// The machine used for the measurement of times.
    pub machine: MachineInfo,
    pub film: StudyFilm,
    pub reference: ReferenceProvenance,
    /// The definition of a smooth region.
    pub smooth_rule: &'static str,
    /// Error against time: first photon mapping, and then the path tracer.
    pub curves: [ConvergenceCurve; 2],
    pub sweep: SettingSweep,
    /// Quantities fixed in the program, with reasons. No option changes them.
    pub fixed_by_design: [&'static str; 3],
    pub effects: EffectStudy,
    /// Recommended settings for given errors, with predicted times.
    #[serde(rename = "wanted")]
    pub recommendations: Vec<Recommendation>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachineInfo {
    pub threads: usize,
    pub cores: usize,
    /// The clock frequency in GHz, if the system reports it.
    pub clock_ghz: Option<f64>,
}

/// Quantities fixed in the program, with reasons. No option changes them.
pub(super) const FIXED_BY_DESIGN: [&str; 3] = [
    "wavelengths per photon: 4, so that one vector instruction handles all of them",
    "shared wavelengths per pass: 4, one from each quarter of the lights' visible power, shifted from pass to pass",
    "stratification of lens, time and wavelength: low-discrepancy sequences over the passes",
];

impl MachineInfo {
    /// The machine that runs this program.
    pub(super) fn here(curve: &ConvergenceCurve) -> Self {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("cpu MHz"));
        let mhz: Option<f64> = line.and_then(|rest| rest.split_once(':')).and_then(|(_, mhz)| mhz.trim().parse().ok());
        Self {
            threads: curve.stats.threads,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            clock_ghz: mhz.map(|mhz| (mhz / 100.0).round() / 10.0),
        }
    }

    pub fn words(&self) -> String {
        let clock = self.clock_ghz.map_or_else(String::new, |ghz| format!(" at {ghz} GHz"));
        let counted = |count: usize, what| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        format!("{} on {}{clock}", counted(self.threads, "thread"), counted(self.cores, "core"))
    }
}

impl StudyReport {
    /// The names of all files except the page.
    pub const FILES: [&str; 7] =
        ["study.json", "curves.csv", "sweep.csv", "effects.csv", "settings.csv", "curves.svg", "sweep.svg"];

    /// The contents of [`Self::FILES`].
    pub(super) fn contents(&self) -> [String; 7] {
        [
            json(self) + "\n",
            self.curves_csv(),
            self.sweep_csv(),
            self.effects_csv(),
            self.settings_csv(),
            self.curves_graph().svg(),
            self.sweep_graph().svg(),
        ]
    }

    fn curves_csv(&self) -> String {
        let rows = self.curves.iter().flat_map(|curve| {
            curve.points.iter().map(|point| [vec![curve.integrator.to_string()], cells_of(point)].concat())
        });
        csv(&[&["integrator"][..], &POINT_COLUMNS].concat(), rows)
    }

    fn sweep_csv(&self) -> String {
        let rows = self.sweep.runs.iter().enumerate().flat_map(|(number, run)| {
            let words = run.settings().words();
            run.points.iter().map(move |point| {
                let on_front = self.sweep.front.iter().any(|place| place.run == number && place.point == *point);
                let is_default = run.change.is_none() && self.sweep.default == Some(*point);
                [vec![words.clone()], cells_of(point), vec![on_front.to_string(), is_default.to_string()]].concat()
            })
        });
        csv(&[&["settings"][..], &POINT_COLUMNS, &["on_front", "default"]].concat(), rows)
    }

    fn effects_csv(&self) -> String {
        let head = [
            "effect",
            "state",
            "events",
            "seconds_with",
            "seconds_without",
            "memory_bytes_with",
            "memory_bytes_without",
            "relative_mse",
            "delta_e_2000_mean",
            "delta_e_2000_p95",
            "error_with",
            "error_without",
            "remark",
        ];
        let effects = &self.effects;
        let on = effects.on.iter().map(|effect| {
            let first = [effect.name.to_string(), effect.state.to_string(), effect.events.to_string()];
            let rest = match &effect.left_out {
                AblationResult::Measured { cost, relative_mse, delta_e_2000, error } => {
                    let (with, without) = (effects.with, *cost);
                    let bytes = [with.memory_bytes, without.memory_bytes].map(|bytes| bytes.to_string());
                    let figures =
                        [*relative_mse, delta_e_2000.mean, delta_e_2000.p95, effects.error.value, error.value];
                    let seconds = [with.seconds, without.seconds].map(number);
                    [seconds.to_vec(), bytes.to_vec(), figures.map(number).to_vec(), vec![String::new()]].concat()
                }
                AblationResult::Refused(reason) => [vec![String::new(); 9], vec![reason.clone()]].concat(),
                AblationResult::NoTime => [vec![String::new(); 9], vec!["no time".to_string()]].concat(),
            };
            [first.to_vec(), rest].concat()
        });
        let off = effects.off.iter().map(|effect| {
            let first = [effect.name.to_string(), effect.state.to_string(), effect.events.to_string()];
            [first.to_vec(), vec![String::new(); 9], vec![effect.because.clone()]].concat()
        });
        csv(&head, on.chain(off))
    }

    fn settings_csv(&self) -> String {
        let head = [
            "relative_mse",
            "settings",
            "passes",
            "seconds",
            "seconds_own_film",
            "extrapolated",
            "command",
            "typical_error",
        ];
        let rows = self.recommendations.iter().map(|row| {
            vec![
                number(row.relative_mse),
                row.settings.clone(),
                row.passes.to_string(),
                number(row.seconds),
                number(row.seconds_own_film),
                row.extrapolated.to_string(),
                row.command.clone(),
                number(row.typical_error),
            ]
        });
        csv(&head, rows)
    }

    /// Plots error against time for both integrators.
    pub(super) fn curves_graph(&self) -> LogLogPlot {
        let mut series = Vec::new();
        for (curve, colour) in self.curves.iter().zip([2, 1]) {
            let significant = |of: fn(&ConvergencePoint) -> MeanEstimate| {
                let points = curve.points.iter().filter(move |point| of(point).is_significant());
                points.map(|point| (point.seconds, of(point).value)).collect::<Vec<(f64, f64)>>()
            };
            let has_smooth = curve.points.iter().any(|point| point.error.smooth.is_some());
            if has_smooth {
                series.push(PlotSeries {
                    name: String::new(),
                    style: SeriesStyle::Dots,
                    colour,
                    points: significant(|point| point.error.whole),
                });
            }
            let fitted = significant(error_to_fit);
            for (slope, (first, last)) in fitted
                .first()
                .zip(fitted.last())
                .into_iter()
                .flat_map(|ends| curve.slopes_in_theory().into_iter().map(move |slope| (slope, ends)))
            {
                let points = vec![*first, (last.0, first.1 * powf(last.0 / first.0, slope))];
                series.push(PlotSeries { name: String::new(), style: SeriesStyle::Dashed, colour, points });
            }
            let slope = curve
                .fit
                .map_or("no fit".to_string(), |fit| format!("{} ± {:.2}", signed(fit.slope), fit.standard_error));
            let name = format!("{}: slope {slope} (theory {})", integrator_title(curve.integrator), theory(curve));
            series.push(PlotSeries { name, style: SeriesStyle::Line, colour, points: fitted });
        }
        LogLogPlot {
            title: "Error against time".to_string(),
            across: "seconds".to_string(),
            up: "relative mean square error".to_string(),
            series,
        }
    }

    pub(super) fn sweep_graph(&self) -> LogLogPlot {
        let of_setting = |setting: Option<Setting>, colour: usize, name: &str| {
            let runs = self.sweep.runs.iter().filter(move |run| run.change.map(|change| change.setting) == setting);
            let named = std::iter::once(name.to_string()).chain(std::iter::repeat(String::new()));
            runs.zip(named).map(move |(run, name)| {
                let significant = run.points.iter().filter(|point| point.error.whole.is_significant());
                let points = significant.map(|point| (point.seconds, point.error.whole.value)).collect();
                PlotSeries { name, style: SeriesStyle::Line, colour, points }
            })
        };
        let settings = [
            (Setting::Photons, 2),
            (Setting::Nearest, 3),
            (Setting::Radius, 3),
            (Setting::MaxDepth, 4),
            (Setting::MarchSteps, 5),
        ];
        let changed = settings.iter().flat_map(|&(setting, colour)| of_setting(Some(setting), colour, setting.words()));
        let own = of_setting(None, 1, "the scene's settings");
        let front = self.sweep.front.iter().map(|place| (place.point.seconds, place.point.error.whole.value));
        let front = PlotSeries {
            name: "Pareto front".to_string(),
            style: SeriesStyle::Steps,
            colour: 0,
            points: front.collect(),
        };
        let default = self.sweep.default.iter().map(|point| (point.seconds, point.error.whole.value)).collect();
        let default = PlotSeries { name: String::new(), style: SeriesStyle::Rings, colour: 1, points: default };
        LogLogPlot {
            title: "Settings: error against time, whole picture".to_string(),
            across: "seconds".to_string(),
            up: "relative mean square error".to_string(),
            series: changed.chain(own).chain([front, default]).collect(),
        }
    }
}

/// The theoretical slope of a curve as text: one number, or a range.
pub fn theory(curve: &ConvergenceCurve) -> String {
    curve.slopes_in_theory().into_iter().rev().map(signed).collect::<Vec<String>>().join(" to ")
}

/// Writes a number with two decimals and a Unicode minus sign.
pub(super) fn signed(value: f64) -> String {
    format!("{value:.2}").replace('-', "−")
}

const POINT_COLUMNS: [&str; 6] = [
    "passes",
    "seconds",
    "relative_mse",
    "relative_mse_standard_error",
    "smooth_relative_mse",
    "smooth_relative_mse_standard_error",
];

fn cells_of(point: &ConvergencePoint) -> Vec<String> {
    let estimate = |estimate: MeanEstimate| [number(estimate.value), number(estimate.standard_error)];
    let none = || [String::new(), String::new()];
    let (whole, smooth) = (estimate(point.error.whole), point.error.smooth.map_or_else(none, estimate));
    [vec![point.passes.to_string(), number(point.seconds)], whole.to_vec(), smooth.to_vec()].concat()
}

/// Writes a number with six digits. The text is empty if the number is not finite.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:.5e}") } else { String::new() }
}

/// Writes rows under a header (RFC 4180, but with line feeds as line ends).
fn csv(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let quoted = |cell: &String| {
        if cell.contains([',', '"', '\n']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
    };
    let lines = rows.map(|row| row.iter().map(quoted).collect::<Vec<String>>().join(","));
    std::iter::once(head.join(",")).chain(lines).map(|line| line + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_commas_and_quotes_are_quoted() {
        let rows = [vec!["a,b".to_string(), "say \"c\"".to_string(), number(0.5), number(f64::NAN)]];
        assert_eq!(csv(&["x", "y", "z", "w"], rows.into_iter()), "x,y,z,w\n\"a,b\",\"say \"\"c\"\"\",5.00000e-1,\n");
        assert_eq!(signed(-0.666), "−0.67");
    }
}
