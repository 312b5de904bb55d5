//! `abbe study`: what accuracy costs in time.

use std::path::PathBuf;
use std::time::Duration;

use abbe::error::Result;
use abbe::output::exr::read;
use abbe::output::metadata::names;
use abbe::render::{Integrator, Job, Monitor, Progress, on_threads};
use abbe::scene::resolve::resolve;
use abbe::study::report::{Report, theory, title_of};
use abbe::study::{self, Audience, Ending, Options, PAGE, Subject};

use super::progress::{Display, percent, time};
use super::{Outcome, interrupt, memory, opening, origin, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// The folder for the page, tables and plots; finished steps are kept in it, and the same command goes on from them
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// How long the study may take, about
    #[arg(long, value_name = "TIME", value_parser = values::duration, default_value = "5m")]
    budget: Duration,
    /// Measure errors against this picture instead of a reference that is rendered first
    #[arg(long, value_name = "FILE.exr")]
    reference: Option<PathBuf>,
    #[command(flatten)]
    opening: opening::Arguments,
    /// Say nothing unless something goes wrong
    #[arg(long)]
    quiet: bool,
}

/// Shows one step after the other.
struct Steps {
    display: Display,
    quiet: bool,
}

impl Monitor for Steps {
    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.display.after_pass(progress)
    }
}

impl Audience for Steps {
    fn begin(&mut self, step: &str, kept: bool) {
        self.display.finish();
        if kept && !self.quiet {
            print::remark(&format!("{step}: kept from before"));
        } else {
            self.display = Display::new(self.quiet, Some(step.to_string()));
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    interrupt::watch()?;
    let (scene, source) = arguments.opening.read(&arguments.scene, &[])?;
    let reference = match &arguments.reference {
        Some(path) => Some((path.display().to_string(), read(path)?.picture)),
        None => None,
    };
    let job = Job::new(resolve(&scene, &source)?).map_err(|error| error.in_file(&arguments.scene))?;
    memory::check(&job.budget)?;
    let of_scene = origin::of_scene(&source, &job, Integrator::Photon);
    let subject = Subject {
        path: arguments.scene.clone(),
        text: source.text.clone(),
        reach: source.reach(),
        hash: of_scene.get(names::SCENE_HASH).unwrap_or_default().to_string(),
    };
    let options = Options { folder: arguments.output.clone(), budget: arguments.budget, reference };
    let quiet = arguments.quiet;
    let mut steps = Steps { display: Display::new(true, None), quiet };
    let ending = on_threads(job.scene.settings.threads, || study::run(&subject, &options, &mut steps))?;
    steps.display.finish();
    let folder = arguments.output.display();
    match ending? {
        Ending::Finished(report) => {
            print::result(&text(&report))?;
            if !quiet {
                print::remark(&format!(
                    "{}: the page; tables, plots and steps beside it",
                    arguments.output.join(PAGE).display()
                ));
            }
            Ok(Outcome::Done)
        }
        Ending::Interrupted => {
            print::remark(&format!(
                "interrupted; finished steps are kept in {folder}, and the same command goes on from them"
            ));
            Ok(Outcome::Interrupted)
        }
    }
}

/// What was found, in short.
fn text(report: &Report) -> String {
    let mut text = format!("{:<20} {:>16} {:>16}\n", "slope of the error", "fitted", "theory");
    for curve in &report.curves {
        let fitted = curve.fit.map_or("too few points".to_string(), |fit| fit.words());
        text += &format!("  {:<18} {fitted:>16} {:>16}\n", title_of(curve.integrator), theory(curve));
    }
    text += "\nerror wanted (relative MSE) → time on this machine\n";
    for row in &report.wanted {
        let seconds = Duration::try_from_secs_f64(row.seconds_own_film.max(0.1)).unwrap_or_default();
        let guess = if row.extrapolated { " (extrapolated)" } else { "" };
        let typical = percent(row.relative_mse.sqrt());
        text += &format!("  {:<7} {typical:>7}  {:>12}  {}{guess}\n", row.relative_mse, time(seconds), row.command);
    }
    text
}
