//! `abbe validate`: measures public test cases with known results.

use std::path::PathBuf;

use crate::validate::{Case, CaseResult, cie171, closed_forms, markdown, run as measure};
use abbe_session::output::file as files;
use abbe_session::render::{StopRules, on_threads};
use abbe_spectra::error::Result;

use super::progress::ProgressDisplay;
use super::{Outcome, interrupt, print, values};

#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ValidateArgs {
    /// The test cases
    #[arg(value_enum)]
    suite: Suite,
    /// Measure only the quick subset
    #[arg(long)]
    quick: bool,
    /// Measure only the cases whose names start with this text, such as 5.9
    #[arg(long, value_name = "TEXT")]
    case: Option<String>,
    /// Measure until every reading of a case has this relative error
    #[arg(long, value_name = "RATIO", value_parser = values::share)]
    target_error: Option<f64>,
    /// Write all values to a page in Markdown
    #[arg(short, long, value_name = "FILE.md")]
    output: Option<PathBuf>,
    /// Print the results as JSON
    #[arg(long)]
    json: bool,
    /// The number of worker threads [default: the number of logical processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Suite {
    /// The analytical cases 5.2 to 5.14 of CIE 171:2006
    Cie171,
    /// Integrating spheres, slabs and half-spaces that scatter, and Newton's prism
    ClosedForms,
}

impl Suite {
    /// Returns the title and the introduction of the page.
    fn page(self) -> (&'static str, &'static str) {
        match self {
            Self::Cie171 => ("CIE 171:2006, cases 5.2–5.14", CIE_171),
            Self::ClosedForms => ("Closed forms", CLOSED_FORMS),
        }
    }

    fn cases(self) -> Result<Vec<Case>> {
        match self {
            Self::Cie171 => cie171::cases(),
            Self::ClosedForms => Ok(closed_forms::cases()),
        }
    }
}

/// The introduction of the page on CIE 171.
const CIE_171: &str = "\
This page compares readings of `abbe measure` with the analytical test cases 5.2–5.14 of CIE
171:2006. The expected values were computed from first principles, and the printed values of the
report stand beside them. A value passes if its deviation and half its 95 % interval are at most 1 %
of the expected value, or 0.1 % of the largest value of the case. `abbe validate cie171 -o
docs/validation/cie171.md` wrote the page.";

/// The introduction of the page on closed forms.
const CLOSED_FORMS: &str = "\
This page compares readings of `abbe measure` with closed forms and with published values:
integrating spheres, slabs and half-spaces that scatter, and the prism of Newton's letter of 1672
(refracting angle 63° 12′, index 1.5453, a hole of ¼ inch, and a wall at 22 feet). A value passes if
its deviation and half its 95 % interval are at most 1 % of the expected value, or 0.001. `abbe
validate closed-forms -o docs/validation/closed-forms.md` wrote the page.";

pub(crate) fn run(arguments: &ValidateArgs) -> Result<Outcome> {
    interrupt::watch()?;
    if let Some(path) = &arguments.output {
        files::check_writable(path)?;
    }
    let folder = std::env::temp_dir().join(format!("abbe-validate-{}", std::process::id()));
    let machine = |error: std::io::Error| abbe_spectra::error::Error::machine(format!("{}: {error}", folder.display()));
    std::fs::create_dir_all(&folder).map_err(machine)?;
    let results = write_lamps(&folder).and_then(|()| measure_cases(arguments, &folder));
    let appendix = results.as_ref().map_or(Ok(String::new()), |_| measure_appendix(arguments, &folder));
    std::fs::remove_dir_all(&folder).map_err(machine)?;
    let (results, interrupted) = results?;
    if let Some(path) = &arguments.output {
        let (title, introduction) = arguments.suite.page();
        let page = markdown(title, introduction, &results) + &appendix?;
        files::write_whole(path, page.as_bytes())?;
    }
    if arguments.json {
        print::json(&results)?;
    }
    let values: usize = results.iter().map(|result| result.values.len()).sum();
    let failures: usize = results.iter().map(CaseResult::failures).sum();
    let covered: usize = results.iter().map(CaseResult::covered).sum();
    let seconds: f64 = results.iter().map(|result| result.seconds).sum();
    print::remark(&format!(
        "{} of {values} values pass, {covered} are inside their 95 % intervals, {seconds:.0} s",
        values - failures
    ));
    Ok(match (interrupted, failures) {
        (true, _) => Outcome::Interrupted,
        (false, 0) => Outcome::Done,
        (false, _) => Outcome::Exceeded,
    })
}

fn write_lamps(folder: &std::path::Path) -> Result<()> {
    cie171::LAMPS.iter().try_for_each(|(name, text)| files::write_whole(&folder.join(name), text.as_bytes()))
}

/// Measures what the page reports apart from the cases.
fn measure_appendix(arguments: &ValidateArgs, folder: &std::path::Path) -> Result<String> {
    if !matches!(arguments.suite, Suite::ClosedForms) || arguments.output.is_none() {
        return Ok(String::new());
    }
    on_threads(arguments.threads, || closed_forms::newtons_length(folder, &mut ProgressDisplay::new(true, None)))?
}

/// Measures the selected cases. Also returns true if the user interrupted the command.
fn measure_cases(arguments: &ValidateArgs, folder: &std::path::Path) -> Result<(Vec<CaseResult>, bool)> {
    let selected = |id: &str| arguments.case.as_deref().is_none_or(|start| id.starts_with(start));
    let stop = StopRules {
        target_error: arguments.target_error,
        passes: arguments.target_error.map(|_| 1 << 14),
        ..StopRules::default()
    };
    let mut results = Vec::new();
    for case in arguments.suite.cases()?.iter().filter(|case| selected(&case.id) && (case.quick || !arguments.quick)) {
        let mut monitor = ProgressDisplay::new(true, None);
        let result = on_threads(arguments.threads, || measure(case, folder, stop, &mut monitor))??;
        if interrupt::is_requested() {
            return Ok((results, true));
        }
        if !arguments.json {
            let (count, failures) = (result.values.len(), result.failures());
            let verdict = if failures == 0 { "passes".to_string() } else { format!("{failures} of {count} fail") };
            print::result(&format!(
                "{:<40} {count:>4} values  largest deviation/tolerance {:.2}  {:>5.1} s  {verdict}\n",
                result.id,
                result.largest_deviation(),
                result.seconds
            ))?;
        }
        results.push(result);
    }
    Ok((results, false))
}
