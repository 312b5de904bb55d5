//! Shows the progress of a render: a bar on a terminal, and otherwise a line every few seconds, as
//! on a terminal that cannot move its cursor.

use std::io::IsTerminal;
use std::sync::Arc;
use std::time::Duration;

use abbe_session::render::{ErrorMilestone, Monitor, Progress, StopRules};
use abbe_spectra::math::elementary::log10;
use abbe_transport::walk::StopFlag;
use indicatif::{ProgressBar, ProgressStyle};

use super::interrupt;
use super::print::{self, percent};

/// Shows progress on standard error, and stops the render if the user interrupts it.
#[derive(Debug)]
pub(crate) struct ProgressDisplay {
    output: ProgressOutput,
    /// The name of the render, if there are several renders.
    label: Option<String>,
    trend: ErrorTrend,
}

#[derive(Debug, Default)]
struct ErrorTrend {
    last: Option<f64>,
    rises: bool,
}

impl ErrorTrend {
    /// Notes a measured error. Returns true if it is noticeably larger than before.
    fn rises(&mut self, error: Option<f64>) -> bool {
        /// Smaller changes of the error are not noticeable.
        const NOTICEABLE: f64 = 1.05;
        if let Some(error) = error.filter(|error| self.last != Some(*error)) {
            self.rises = self.last.is_some_and(|last| error > NOTICEABLE * last);
            self.last = Some(error);
        }
        self.rises
    }
}

/// The form of the progress display.
#[derive(Debug)]
enum ProgressOutput {
    Bar(ProgressBar),
    /// A line every few seconds. The value is the time at which the last line was printed.
    Lines(Option<Duration>),
    /// Nothing.
    Quiet,
}

const STEPS: u64 = 1000;

/// The time between two lines if standard error is not a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// The progress before the first pass.
const PILOT: &str = "pilot: estimating photon counts and radii";

impl ProgressDisplay {
    /// A display for standard error.
    pub(crate) fn new(quiet: bool, label: Option<String>) -> Self {
        // A terminal that cannot move its cursor, such as `TERM=dumb`, hides a bar.
        let bar = std::io::stderr().is_terminal().then(Self::bar).filter(|bar| !bar.is_hidden());
        let output = match (quiet, bar) {
            (true, _) => ProgressOutput::Quiet,
            (false, None) => ProgressOutput::Lines(None),
            (false, Some(bar)) => ProgressOutput::Bar(bar),
        };
        Self { output, label, trend: ErrorTrend::default() }
    }

    fn bar() -> ProgressBar {
        let bar = ProgressBar::new(STEPS);
        let style =
            ProgressStyle::with_template("{spinner} [{bar:20}] {wide_msg}").expect("the template is well-formed");
        bar.set_style(style.progress_chars("=> "));
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }

    fn line(label: Option<&str>, progress: &Progress, error_rises: bool) -> String {
        let line = line(progress, error_rises);
        label.map_or_else(|| line.clone(), |label| format!("{label}: {line}"))
    }

    pub(crate) fn finish(&self) {
        match &self.output {
            ProgressOutput::Bar(bar) => bar.finish_and_clear(),
            ProgressOutput::Lines(_) | ProgressOutput::Quiet => {}
        }
    }
}

impl Monitor for ProgressDisplay {
    fn stop_flag(&self) -> Arc<StopFlag> {
        interrupt::stop_flag()
    }

    fn before_pilot(&mut self) {
        let line = self.label.as_deref().map_or_else(|| PILOT.to_owned(), |label| format!("{label}: {PILOT}"));
        match &self.output {
            ProgressOutput::Bar(bar) => bar.set_message(print::visible(&line).into_owned()),
            ProgressOutput::Lines(_) => print::remark(&line),
            ProgressOutput::Quiet => {}
        }
    }

    fn after_pass(&mut self, progress: &Progress) -> bool {
        let rises = self.trend.rises(progress.typical_error);
        let line = || Self::line(self.label.as_deref(), progress, rises);
        match &mut self.output {
            ProgressOutput::Bar(bar) => {
                let done = fraction_done(progress).unwrap_or(0.0);
                bar.set_position((done * STEPS as f64) as u64);
                bar.set_message(print::visible(&line()).into_owned());
            }
            ProgressOutput::Lines(last) => {
                if last.is_none_or(|last| progress.elapsed >= last + LINE_INTERVAL) {
                    print::remark(&line());
                    *last = Some(progress.elapsed);
                }
            }
            ProgressOutput::Quiet => {}
        }
        !interrupt::is_requested()
    }
}

/// The predicted time until a stop rule ends the render, or `None` if no prediction is possible.
fn time_left(progress: &Progress) -> Option<Duration> {
    let elapsed = progress.elapsed.as_secs_f64();
    let by_passes = progress.passes_wanted.map(|wanted| elapsed * (wanted as f64 / progress.passes as f64 - 1.0));
    let by_time = progress.time_wanted.map(|wanted| wanted.as_secs_f64() - elapsed);
    let by_error =
        progress.error_wanted.zip(progress.forecast).and_then(|(wanted, forecast)| forecast.milestone(wanted));
    let by_error = by_error.filter(|milestone| milestone.seconds_interval.is_some());
    let by_error = by_error.map(|milestone| (milestone.seconds - elapsed).max(time_to_decision(progress)));
    let left = [by_passes, by_time, by_error].into_iter().flatten().reduce(f64::min)?;
    Duration::try_from_secs_f64(left.max(0.0)).ok()
}

/// The time until the passes after which the target error may next end the render.
fn time_to_decision(progress: &Progress) -> f64 {
    let next = StopRules::next_decision(progress.passes);
    progress.elapsed.as_secs_f64() / progress.passes.max(1) as f64 * (next - progress.passes) as f64
}

fn fraction_done(progress: &Progress) -> Option<f64> {
    let (elapsed, left) = (progress.elapsed.as_secs_f64(), time_left(progress)?.as_secs_f64());
    Some(if left > 0.0 { elapsed / (elapsed + left) } else { 1.0 })
}

/// Predicts the time of the target error, or of the next two round values (2 %, 1 %).
fn predicted_milestones(progress: &Progress) -> Vec<String> {
    let Some(forecast) = progress.forecast else { return Vec::new() };
    let milestones: Vec<ErrorMilestone> = match progress.error_wanted {
        Some(wanted) => forecast.milestone(wanted).into_iter().collect(),
        None => forecast.milestones().collect(),
    };
    let elapsed = progress.elapsed.as_secs_f64();
    let least = if progress.error_wanted.is_some() { time_to_decision(progress) } else { 0.0 };
    // Since the last measurement, the error may have fallen to a round value without a target.
    let ahead = milestones.iter().filter(|at| progress.error_wanted.is_some() || at.seconds > elapsed);
    let text = |at: &ErrorMilestone| format!("{} % {}", round(100.0 * at.error), when(at, elapsed, least));
    ahead.map(text).collect()
}

/// Writes when an error is reached: the interval of the time left, or one time if it is narrow.
/// `least` is the shortest possible time in s.
fn when(at: &ErrorMilestone, elapsed: f64, least: f64) -> String {
    /// A wider interval says nothing.
    const WIDEST: f64 = 30.0;
    /// The ends of a narrower interval would be the same number.
    const NARROW: f64 = 1.5;
    let left = |seconds: f64| (seconds - elapsed).max(least);
    match at.seconds_interval.map(|interval| interval.map(left)) {
        Some([low, high]) if high <= NARROW * low => format!("in about {}", about(left(at.seconds))),
        Some([low, high]) if high <= WIDEST * low.max(1.0) => format!("in {} to {}", about(low), about(high)),
        Some(_) | None => "at a time that cannot be foretold yet".to_owned(),
    }
}

/// Writes a number with three significant digits, or as an integer from 100.
fn round(number: f64) -> String {
    let digits = (2.0 - log10(number).floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{number:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Writes a predicted time with one or two significant digits.
fn about(seconds: f64) -> String {
    const UNITS: [(f64, f64, &str); 4] =
        [(1.0, 100.0, "s"), (60.0, 100.0, "min"), (3600.0, 48.0, "h"), (86_400.0, f64::INFINITY, "days")];
    let (unit, _, name) = UNITS.into_iter().find(|(unit, most, _)| seconds / unit < *most).unwrap_or(UNITS[3]);
    format!("{:.0} {name}", (seconds / unit).round().max(1.0))
}

/// Writes one progress line: passes, time left, error, predictions of the error, and photons per
/// second. A narrow terminal shows only the beginning.
fn line(progress: &Progress, error_rises: bool) -> String {
    let mut parts = vec![match progress.passes_wanted {
        Some(wanted) => format!("{}/{}", progress.passes, print::passes(wanted)),
        None => print::passes(progress.passes),
    }];
    if let Some(left) = time_left(progress) {
        parts.push(format!("{} left", time(left)));
    }
    if let Some(error) = progress.typical_error {
        let reason = if error_rises { " (rising: the latest passes found rare bright light)" } else { "" };
        parts.push(format!("error {}{reason}", percent(error)));
    }
    parts.extend(predicted_milestones(progress));
    if progress.photons_per_second > 0.0 {
        parts.push(format!("{} photons/s", count(progress.photons_per_second)));
    }
    parts.join(", ")
}

/// Writes a large number with a unit prefix.
pub(crate) fn count(number: f64) -> String {
    if number >= 1e6 {
        format!("{:.1} M", number * 1e-6)
    } else if number >= 1e4 {
        format!("{:.0} k", number * 1e-3)
    } else {
        format!("{number:.0}")
    }
}

/// Writes a time in its two largest units.
pub(crate) fn time(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    if seconds < 9.95 {
        return format!("{seconds:.1} s");
    }
    let seconds = seconds.round() as u64;
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        3600.. => format!("{} h {:02} min", seconds / 3600, seconds / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_session::render::Forecast;
    use abbe_transport::sensor::ErrorSquares;
    use std::io;
    use std::sync::{Arc, Mutex};

    fn after(passes: u64, seconds: f64) -> Progress {
        Progress {
            passes,
            passes_wanted: None,
            elapsed: Duration::from_secs_f64(seconds),
            time_wanted: None,
            photons_per_second: 2.5e6,
            relative_error: None,
            typical_error: None,
            error_wanted: None,
            forecast: None,
        }
    }

    /// Returns a forecast after 16 passes in 12 s, from an error of 4 %.
    fn forecast(bias: f64, sampling: f64) -> Forecast {
        let squares = ErrorSquares { bias, kernel_noise: 0.0, sampling };
        let times = abbe_session::render::RunTimes { passes: 16, total_s: 12.0, before_first_pass_s: 0.0 };
        Forecast::without_history(squares, times).unwrap()
    }

    #[test]
    fn the_time_left_follows_the_first_stop_rule() {
        let left = |progress: &Progress| time_left(progress).map(|left| left.as_secs_f64());
        let mut progress = after(16, 10.0);
        assert_eq!(left(&progress), None);
        progress.passes_wanted = Some(64);
        assert_eq!(left(&progress), Some(30.0));
        progress.error_wanted = Some(0.02);
        progress.forecast = Some(forecast(0.0, 0.0016));
        let at = progress.forecast.unwrap().milestone(0.02).unwrap().seconds;
        assert!((left(&progress).unwrap() - (at - 10.0)).abs() < 1e-6, "{at}");
        // Bias alone falls too slowly for a promise, so the error does not tell when the render
        // ends.
        progress.forecast = Some(forecast(0.0016, 0.0));
        assert_eq!(left(&progress), Some(30.0));
        progress.time_wanted = Some(Duration::from_secs(15));
        assert_eq!(left(&progress), Some(5.0));
        assert!((fraction_done(&progress).unwrap() - 10.0 / 15.0).abs() < 1e-9);
    }

    /// A target error ends a render only after whole rounds of the replicates. Until then, some
    /// time is left even if the error is below the target.
    #[test]
    fn near_the_target_the_time_left_is_that_of_the_next_round() {
        let mut progress = after(18, 13.5);
        progress.forecast = Some(forecast(0.0, 0.0016));
        progress.error_wanted = Some(0.039);
        assert_eq!(time_left(&progress), Some(Duration::from_millis(4500)));
        progress.typical_error = Some(0.0385);
        assert!(line(&progress, false).starts_with("18 passes, 4.5 s left, error 3.85 %, 3.9 % in "));
    }

    #[test]
    fn a_line_says_what_is_known() {
        let mut progress = after(16, 10.0);
        let line = |progress: &Progress| line(progress, false);
        assert_eq!(line(&progress), "16 passes, 2.5 M photons/s");
        progress.passes_wanted = Some(64);
        progress.typical_error = Some(0.0312);
        assert_eq!(line(&progress), "16/64 passes, 30 s left, error 3.12 %, 2.5 M photons/s");
        progress.forecast = Some(forecast(0.0016, 0.0));
        let milestones = "2 % at a time that cannot be foretold yet, 1 % at a time that cannot be foretold yet";
        assert_eq!(line(&progress), format!("16/64 passes, 30 s left, error 3.12 %, {milestones}, 2.5 M photons/s"));
    }

    #[test]
    fn a_milestone_has_an_interval() {
        let at = |interval: Option<[f64; 2]>| {
            let milestone = ErrorMilestone { error: 0.02, passes: 40.0, seconds: 130.0, seconds_interval: interval };
            when(&milestone, 10.0, 0.0)
        };
        assert_eq!(at(Some([110.0, 150.0])), "in about 2 min");
        assert_eq!(at(Some([60.0, 310.0])), "in 50 s to 5 min");
        assert_eq!(at(Some([20.0, 3610.0])), "at a time that cannot be foretold yet");
        assert_eq!(at(None), "at a time that cannot be foretold yet");
    }

    #[test]
    fn a_rising_error_is_explained() {
        let mut trend = ErrorTrend::default();
        let measured = [Some(0.04), Some(0.03), None, Some(0.06), Some(0.06), Some(0.05)];
        let rises: Vec<bool> = measured.into_iter().map(|error| trend.rises(error)).collect();
        assert_eq!(rises, [false, false, false, true, true, false]);
        let mut progress = after(16, 10.0);
        progress.typical_error = Some(0.06);
        let text = "16 passes, error 6.00 % (rising: the latest passes found rare bright light), 2.5 M photons/s";
        assert_eq!(line(&progress, true), text);
    }

    /// A terminal of 60 columns that records what is written.
    #[derive(Debug, Clone, Default)]
    struct NarrowTerminal(Arc<Mutex<String>>);

    impl indicatif::TermLike for NarrowTerminal {
        fn width(&self) -> u16 {
            60
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            self.0.lock().unwrap().clear();
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_narrow_terminal_shows_one_line() {
        let terminal = NarrowTerminal::default();
        let bar = ProgressDisplay::bar();
        bar.set_draw_target(indicatif::ProgressDrawTarget::term_like(Box::new(terminal.clone())));
        bar.set_message("16/64 passes, 30 s left, ".to_string() + &"x".repeat(200));
        bar.tick();
        let shown = terminal.0.lock().unwrap().clone();
        let columns = shown.trim_end().chars().count();
        assert!(columns <= 60 && shown.contains("16/64 passes, 30 s left"), "{columns}: {shown}");
    }

    #[test]
    fn times_and_counts_are_short() {
        let times = [(0.5, "0.5 s"), (59.6, "1 min 00 s"), (125.0, "2 min 05 s"), (3725.0, "1 h 02 min")];
        for (seconds, text) in times {
            assert_eq!(time(Duration::from_secs_f64(seconds)), text);
        }
        let rough = [0.2, 59.0, 125.0, 7000.0, 200_000.0].map(about);
        assert_eq!(rough, ["1 s", "59 s", "2 min", "2 h", "2 days"]);
        assert_eq!([2.0, 0.5, 10.0, 0.02, 1000.0].map(round), ["2", "0.5", "10", "0.02", "1000"]);
        assert_eq!([1.23e6, 45_600.0, 999.0].map(count), ["1.2 M", "46 k", "999"]);
    }
}
