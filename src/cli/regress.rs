//! `abbe regress`: tests code that converts spectra to colours.

use std::path::PathBuf;

use abbe_session::output::junit::{JunitCase, junit};
use abbe_session::output::{file, regress_page};
use abbe_spectra::colour::regress::{CaseGroup, RegressionReport, RegressionSet, RegressionTolerances, compare_groups};
use abbe_spectra::error::Result;

use super::{Outcome, print, values};
use crate::reports::regression::{SET_FILES, read_colours, write_set};

#[derive(Debug, clap::Args)]
#[command(override_usage = "abbe regress --export FOLDER\n       abbe regress COLOURS [OPTIONS]")]
pub(crate) struct RegressArgs {
    /// The colours that your code computed: a CSV or a JSON file in the form of expected.csv or of
    /// the cases in set.json
    #[arg(value_name = "COLOURS", required_unless_present = "export")]
    colours: Option<PathBuf>,
    /// Write the set: set.json with everything, and the same as spectra.csv, lines.csv, cases.csv,
    /// expected.csv and observer.csv
    #[arg(long, value_name = "FOLDER", conflicts_with = "colours")]
    export: Option<PathBuf>,
    /// The number of the set. The first contains lights and surfaces as XYZ, linear sRGB and sRGB.
    /// The second contains surfaces and fluorescent samples, also as Display P3, Rec. 2020, ACEScg,
    /// Lab, adapted XYZ, and XYZ of other observers
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=2), default_value_t = 1)]
    set: u32,
    /// Judge only this group (repeatable) [default: all groups]
    #[arg(long, value_name = "GROUP", value_enum)]
    group: Vec<GroupName>,
    /// The largest ΔE2000 of a case that passes [default: 0.1]
    #[arg(long, value_name = "LIMIT", value_parser = values::limit)]
    delta_e: Option<f64>,
    /// The largest difference of a component, relative to white or to the largest expected
    /// component, such as 0.1% [default: 0.05%]
    #[arg(long, value_name = "LIMIT", value_parser = values::limit)]
    component: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the results as JUnit XML
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,
    /// Write an HTML page that shows the worst cases
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum GroupName {
    /// Lamps with a continuous spectrum
    Lamps,
    /// Lamps that consist of spectral lines
    Lines,
    /// Single lines
    Monochromatic,
    /// The ColorChecker under lamps
    Surfaces,
    /// The ColorChecker under LEDs with the colour of a lamp
    Metamers,
    /// Fluorescent samples under lamps, in the second set
    Fluorescent,
}

impl GroupName {
    fn group(self) -> CaseGroup {
        match self {
            Self::Lamps => CaseGroup::Lamps,
            Self::Lines => CaseGroup::Lines,
            Self::Monochromatic => CaseGroup::Monochromatic,
            Self::Surfaces => CaseGroup::Surfaces,
            Self::Metamers => CaseGroup::Metamers,
            Self::Fluorescent => CaseGroup::Fluorescent,
        }
    }
}

pub(crate) fn run(arguments: &RegressArgs) -> Result<Outcome> {
    let set = RegressionSet::by_number(arguments.set)?;
    let files = arguments.export.iter().flat_map(|folder| SET_FILES.map(|name| folder.join(name)));
    let outputs: Vec<PathBuf> = files.chain(arguments.junit.clone()).chain(arguments.page.clone()).collect();
    file::check_keeps_inputs(outputs.iter().map(PathBuf::as_path), &arguments.colours)?;
    if let Some(folder) = &arguments.export {
        let cases = write_set(set, folder)?;
        print::remark(&format!("wrote {} to {}", print::counted(cases, "case"), folder.display()));
    }
    let Some(path) = &arguments.colours else { return Ok(Outcome::Done) };
    let defaults = RegressionTolerances::default();
    let tolerances = RegressionTolerances {
        delta_e_2000: arguments.delta_e.unwrap_or(defaults.delta_e_2000),
        component: arguments.component.unwrap_or(defaults.component),
    };
    let groups: Vec<CaseGroup> = arguments.group.iter().map(|group| group.group()).collect();
    let report = read_colours(set, path)
        .and_then(|colours| compare_groups(set, &colours, &groups, tolerances))
        .map_err(|error| error.in_file(path))?;
    if let Some(path) = &arguments.junit {
        file::write_whole(path, junit_of(&report).as_bytes())?;
    }
    if let Some(page) = &arguments.page {
        file::write_whole(page, regress_page::page(&report, &path.display().to_string()).as_bytes())?;
    }
    if arguments.json {
        print::json(&report)?;
    } else {
        print::result(&text(&report))?;
    }
    if report.failed == 0 {
        return Ok(Outcome::Done);
    }
    print::remark(&format!("failed: {}", report.verdict()));
    report.cause_in_words().iter().for_each(|cause| print::remark(&format!("note: {cause}")));
    Ok(Outcome::Exceeded)
}

/// The largest number of cases that the printed text lists.
const SHOWN: usize = 10;

fn text(report: &RegressionReport) -> String {
    let mut text = format!("{}: {}\n", report.set, report.verdict());
    if let Some(cause) = report.cause_in_words() {
        text += &format!("{cause}\n");
    }
    text += &format!("{:<14} {:>6} {:>6}  largest ΔE2000\n", "group", "cases", "failed");
    for group in &report.groups {
        let (name, compared, failed) = (group.group.name(), group.compared, group.failed);
        text += &format!("  {name:<12} {compared:6} {failed:6} {:10.5}\n", group.delta_e_2000);
    }
    text += "worst cases, ΔE2000 and largest difference of a component\n";
    for case in report.cases.iter().take(SHOWN) {
        let fault = case.fault.as_ref().map_or(String::new(), |fault| format!("  {fault}"));
        text += &format!("  {:<36} {:9.5} {:9.6}{fault}\n", case.id, case.delta_e_2000(), case.component());
    }
    text
}

fn junit_of(report: &RegressionReport) -> String {
    let cases: Vec<JunitCase<'_>> = report
        .cases
        .iter()
        .map(|case| JunitCase { group: case.group.name(), name: &case.id, failure: case.fault.as_deref() })
        .collect();
    let cause = report.cause_in_words();
    let properties: Vec<(&str, &str)> = cause.iter().map(|cause| ("cause", cause.as_str())).collect();
    junit(report.set, &properties, &cases)
}
