//! What a study found, for programs (JSON, CSV) and as plots.

use super::curves::{Curve, error_to_fit};
use super::effects::{Effects, LeftOut};
use super::film::StudyFilm;
use super::reference::Estimate;
use super::shelf::json;
use super::subject::{Setting, Subject};
use super::sweep::Sweep;
use super::truth::{Account, Truth};
use super::wanted::{self, Wanted};
use super::{Point, smooth};
use crate::output::graph::{Graph, Look, Series};
use crate::render::Job;
use serde::Serialize;

/// What a study found.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The program's version.
    pub version: &'static str,
    /// The scene's file.
    pub scene: String,
    /// What it shows.
    pub title: String,
    /// Seconds that the study was to take.
    pub budget_seconds: f64,
    /// Seconds that its renders took.
    pub spent_seconds: f64,
    /// Whose seconds these are.
    pub machine: Machine,
    /// The film.
    pub film: StudyFilm,
    /// What errors are measured against.
    pub reference: Account,
    /// What a smooth region is.
    pub smooth_rule: &'static str,
    /// Error against time, the photon integrator's first.
    pub curves: [Curve; 2],
    /// The sweep of settings.
    pub sweep: Sweep,
    /// What the sweep leaves out because it is fixed by design.
    pub fixed_by_design: [&'static str; 3],
    /// Effect by effect.
    pub effects: Effects,
    /// The error you want, and what it takes.
    pub wanted: Vec<Wanted>,
}

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    /// Threads that took part, of as many cores.
    pub threads: usize,
    /// Its cores.
    pub cores: usize,
    /// Their clock in GHz, where the system tells.
    pub clock_ghz: Option<f64>,
}

/// What no option changes, with the reason.
const FIXED_BY_DESIGN: [&str; 3] = [
    "wavelengths a photon: 4, so that all of them go through the same vector instructions",
    "the pass's shared wavelengths: 4, one from each quarter of the lights' visible power, shifted from pass to pass",
    "stratification of lens, time and wavelength: low-discrepancy sequences over the passes, always",
];

impl Machine {
    /// The one that this runs on.
    pub(super) fn here(curve: &Curve) -> Self {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("cpu MHz"));
        let mhz: Option<f64> = line.and_then(|rest| rest.split_once(':')).and_then(|(_, mhz)| mhz.trim().parse().ok());
        Self {
            threads: curve.stats.threads,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            clock_ghz: mhz.map(|mhz| (mhz / 100.0).round() / 10.0),
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        let clock = self.clock_ghz.map_or_else(String::new, |ghz| format!(" at {ghz} GHz"));
        let counted = |count: usize, what| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        format!("{} on {}{clock}", counted(self.threads, "thread"), counted(self.cores, "core"))
    }
}

impl Report {
    pub(super) fn new(
        (subject, job, machine): (&Subject, &Job, Machine),
        (budget_seconds, spent_seconds): (f64, f64),
        (film, truth): (StudyFilm, &Truth),
        (curves, sweep, effects): (&[Curve; 2], Sweep, &Effects),
    ) -> Self {
        let wanted = wanted::table(subject, (&film, &truth.account), curves, &sweep);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: subject.path.display().to_string(),
            title: job.scene.title.clone(),
            budget_seconds,
            spent_seconds,
            machine,
            film,
            reference: truth.account.clone(),
            smooth_rule: smooth::RULE,
            curves: curves.clone(),
            sweep,
            fixed_by_design: FIXED_BY_DESIGN,
            effects: effects.clone(),
            wanted,
        }
    }

    /// All files but the page, by their names.
    pub(super) fn files(&self) -> [(&'static str, String); 7] {
        [
            ("study.json", json(self) + "\n"),
            ("curves.csv", self.curves_csv()),
            ("sweep.csv", self.sweep_csv()),
            ("effects.csv", self.effects_csv()),
            ("settings.csv", self.settings_csv()),
            ("curves.svg", self.curves_graph().svg()),
            ("sweep.svg", self.sweep_graph().svg()),
        ]
    }

    fn curves_csv(&self) -> String {
        let rows = self.curves.iter().flat_map(|curve| {
            curve.points.iter().map(|point| [vec![curve.integrator.to_string()], cells_of(point)].concat())
        });
        csv(&[&["integrator"][..], &POINT].concat(), rows)
    }

    fn sweep_csv(&self) -> String {
        let rows = self.sweep.runs.iter().enumerate().flat_map(|(number, run)| {
            let words = run.recipe().words();
            run.points.iter().map(move |point| {
                let on_front = self.sweep.front.iter().any(|place| place.run == number && place.point == *point);
                let is_default = run.change.is_none() && self.sweep.default == Some(*point);
                [vec![words.clone()], cells_of(point), vec![on_front.to_string(), is_default.to_string()]].concat()
            })
        });
        csv(&[&["settings"][..], &POINT, &["on_front", "default"]].concat(), rows)
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
                LeftOut::Measured { cost, relative_mse, delta_e_2000, wrong } => {
                    let (with, without) = (effects.with, *cost);
                    let bytes = [with.memory_bytes, without.memory_bytes].map(|bytes| bytes.to_string());
                    let figures =
                        [*relative_mse, delta_e_2000.mean, delta_e_2000.p95, effects.wrong.value, wrong.value];
                    let seconds = [with.seconds, without.seconds].map(number);
                    [seconds.to_vec(), bytes.to_vec(), figures.map(number).to_vec(), vec![String::new()]].concat()
                }
                LeftOut::Refused(reason) => [vec![String::new(); 9], vec![reason.clone()]].concat(),
                LeftOut::NoTime => [vec![String::new(); 9], vec!["no time".to_string()]].concat(),
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
        let head = ["relative_mse", "settings", "passes", "seconds", "seconds_own_film", "extrapolated", "command"];
        let rows = self.wanted.iter().map(|row| {
            vec![
                number(row.relative_mse),
                row.settings.clone(),
                row.passes.to_string(),
                number(row.seconds),
                number(row.seconds_own_film),
                row.extrapolated.to_string(),
                row.command.clone(),
            ]
        });
        csv(&head, rows)
    }

    /// Error against time of both integrators.
    pub(super) fn curves_graph(&self) -> Graph {
        let mut series = Vec::new();
        for (curve, colour) in self.curves.iter().zip([2, 1]) {
            let certain = |of: fn(&Point) -> Estimate| {
                let points = curve.points.iter().filter(move |point| of(point).is_certain());
                points.map(|point| (point.seconds, of(point).value)).collect::<Vec<(f64, f64)>>()
            };
            let has_smooth = curve.points.iter().any(|point| point.wrong.smooth.is_some());
            if has_smooth {
                series.push(Series {
                    name: String::new(),
                    look: Look::Dots,
                    colour,
                    points: certain(|point| point.wrong.whole),
                });
            }
            let fitted = certain(error_to_fit);
            for (slope, (first, last)) in fitted
                .first()
                .zip(fitted.last())
                .into_iter()
                .flat_map(|ends| curve.slopes_in_theory().into_iter().map(move |slope| (slope, ends)))
            {
                let points = vec![*first, (last.0, first.1 * (last.0 / first.0).powf(slope))];
                series.push(Series { name: String::new(), look: Look::Dashed, colour, points });
            }
            let slope = curve
                .fit
                .map_or("no fit".to_string(), |fit| format!("{} ± {:.2}", signed(fit.slope), fit.standard_error));
            let name = format!("{}: slope {slope} (theory {})", title_of(curve.integrator), theory(curve));
            series.push(Series { name, look: Look::Line, colour, points: fitted });
        }
        Graph {
            title: "Error against time".to_string(),
            across: "seconds".to_string(),
            up: "relative mean square error".to_string(),
            series,
        }
    }

    /// All that the sweep tried.
    pub(super) fn sweep_graph(&self) -> Graph {
        let of_setting = |setting: Option<Setting>, colour: usize, name: &str| {
            let runs = self.sweep.runs.iter().filter(move |run| run.change.map(|change| change.setting) == setting);
            let named = std::iter::once(name.to_string()).chain(std::iter::repeat(String::new()));
            runs.zip(named).map(move |(run, name)| {
                let certain = run.points.iter().filter(|point| point.wrong.whole.is_certain());
                let points = certain.map(|point| (point.seconds, point.wrong.whole.value)).collect();
                Series { name, look: Look::Line, colour, points }
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
        let front = self.sweep.front.iter().map(|place| (place.point.seconds, place.point.wrong.whole.value));
        let front = Series { name: "Pareto front".to_string(), look: Look::Steps, colour: 0, points: front.collect() };
        let default = self.sweep.default.iter().map(|point| (point.seconds, point.wrong.whole.value)).collect();
        let default = Series { name: String::new(), look: Look::Rings, colour: 1, points: default };
        Graph {
            title: "Settings: error against time, whole picture".to_string(),
            across: "seconds".to_string(),
            up: "relative mean square error".to_string(),
            series: changed.chain(own).chain([front, default]).collect(),
        }
    }
}

/// An integrator's name in words.
pub fn title_of(integrator: &str) -> &'static str {
    if integrator == "path" { "path tracer" } else { "photons" }
}

/// What theory says of a curve's slope: one number, or from where to where.
pub fn theory(curve: &Curve) -> String {
    curve.slopes_in_theory().into_iter().rev().map(signed).collect::<Vec<String>>().join(" to ")
}

/// Two decimals, with a true minus.
pub(super) fn signed(value: f64) -> String {
    format!("{value:.2}").replace('-', "−")
}

/// The columns of a point.
const POINT: [&str; 6] = [
    "passes",
    "seconds",
    "relative_mse",
    "relative_mse_standard_error",
    "smooth_relative_mse",
    "smooth_relative_mse_standard_error",
];

fn cells_of(point: &Point) -> Vec<String> {
    let estimate = |estimate: Estimate| [number(estimate.value), number(estimate.standard_error)];
    let none = || [String::new(), String::new()];
    let (whole, smooth) = (estimate(point.wrong.whole), point.wrong.smooth.map_or_else(none, estimate));
    [vec![point.passes.to_string(), number(point.seconds)], whole.to_vec(), smooth.to_vec()].concat()
}

/// A number with six digits; nothing where it is not finite.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:.5e}") } else { String::new() }
}

/// Rows under a header (RFC 4180, but lines end in a line feed).
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
