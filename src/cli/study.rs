//! `abbe study`: measures error against time.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crate::reports::study::{StudyFiles, study};
use crate::study::report::{StudyReport, theory};
use crate::study::study_scene::integrator_title;
use crate::study::{PAGE, StudyMonitor, StudyOutcome};
use abbe_session::render::{Monitor, Progress};
use abbe_spectra::error::Result;
use abbe_transport::walk::StopFlag;

use super::print::percent;
use super::progress::{ProgressDisplay, time};
use super::scene_file::SceneFileArgs;
use super::{Outcome, interrupt, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct StudyArgs {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// The folder for the page, the tables and the plots. Results of finished steps are cached in
    /// it, and the same command continues from them
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The approximate time that the study may take
    #[arg(long, value_name = "TIME", value_parser = values::duration, default_value = "5m")]
    budget: Duration,
    /// Measure errors against this picture, instead of rendering a reference first
    #[arg(long, value_name = "FILE.exr")]
    reference: Option<PathBuf>,
    /// The number of worker threads [default: the scene's setting, or the number of logical
    /// processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    #[command(flatten)]
    scene_file: SceneFileArgs,
    /// Print only warnings and errors
    #[arg(long)]
    quiet: bool,
}

/// Shows the progress of the study, one step after the other.
struct StudyDisplay {
    display: ProgressDisplay,
    quiet: bool,
}

impl Monitor for StudyDisplay {
    fn stop_flag(&self) -> Arc<StopFlag> {
        self.display.stop_flag()
    }

    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.display.after_pass(progress)
    }
}

impl StudyMonitor for StudyDisplay {
    fn begin(&mut self, step: &str, cached: bool) {
        self.display.finish();
        if cached && !self.quiet {
            print::remark(&format!("{step}: cached"));
        } else {
            self.display = ProgressDisplay::new(self.quiet, Some(step.to_string()));
        }
    }
}

pub(crate) fn run(arguments: &StudyArgs) -> Result<Outcome> {
    interrupt::watch()?;
    let (scene, source) = arguments.scene_file.read(&arguments.scene, &[], arguments.quiet)?;
    let quiet = arguments.quiet;
    let mut steps = StudyDisplay { display: ProgressDisplay::new(true, None), quiet };
    let StudyArgs { scene: path, output, budget, reference, threads, .. } = arguments;
    let files = StudyFiles { scene: path, output, reference: reference.as_deref() };
    let ending = study(&scene, &source, &files, *budget, *threads, &mut steps);
    steps.display.finish();
    let folder = arguments.output.display();
    match ending? {
        StudyOutcome::Finished(report) => {
            print::result(&text(&report))?;
            if !quiet {
                print::remark(&format!(
                    "wrote {}; tables, plots and cached steps are in the same folder",
                    arguments.output.join(PAGE).display()
                ));
            }
            Ok(Outcome::Done)
        }
        StudyOutcome::Interrupted => {
            print::remark(&format!(
                "interrupted; finished steps are cached in {folder}, and the same command continues from them"
            ));
            Ok(Outcome::Interrupted)
        }
    }
}

fn text(report: &StudyReport) -> String {
    let mut text = format!("{:<20} {:>16} {:>16}\n", "slope of the error", "fitted", "theory");
    for curve in &report.curves {
        let fitted = curve.fit.map_or("too few points".to_string(), |fit| fit.words());
        text += &format!("  {:<18} {fitted:>16} {:>16}\n", integrator_title(curve.integrator), theory(curve));
    }
    text += "\nerror of a typical pixel, and predicted time on this machine\n";
    for row in &report.recommendations {
        let seconds = Duration::try_from_secs_f64(row.seconds_own_film.max(0.1)).unwrap_or_default();
        let guess = if row.extrapolated { " (extrapolated)" } else { "" };
        let typical = percent(row.typical_error);
        text += &format!("  {typical:>7}  {:>12}  {}{guess}\n", time(seconds), row.command);
    }
    text
}
