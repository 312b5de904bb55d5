//! The table of hard cases: the failure of the obvious formula, Abbe's method, the measure and its
//! bound.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The bound of a measured value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bound {
    /// At most this.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
}

/// When a case is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// In every run of the tests.
    Fast,
    /// With the slow tests.
    Slow,
}

/// One hard case.
#[derive(Debug)]
pub(crate) struct Case {
    /// The input or situation that is hard.
    pub(crate) name: &'static str,
    /// The failure of the obvious formula.
    pub(crate) naive: &'static str,
    /// Abbe's method.
    pub(crate) here: &'static str,
    /// The measured quantity and the exact value to which it is compared.
    pub(crate) measured: &'static str,
    pub(crate) bound: Bound,
    pub(crate) pace: Pace,
    /// Returns the worst value found; it is the same in every run.
    pub(crate) measure: fn() -> f64,
}

/// All families in the order of the document.
pub(crate) struct Family {
    pub(crate) title: &'static str,
    pub(crate) cases: &'static [Case],
}

impl Bound {
    fn holds(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
        }
    }

    fn words(self) -> String {
        match self {
            Self::AtMost(limit) => format!("≤ {}", figure(limit)),
            Self::AtLeast(limit) => format!("≥ {}", figure(limit)),
        }
    }
}

/// Formats a number with two digits; counts stay whole.
fn figure(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1000.0 { format!("{value}") } else { format!("{value:.1e}") }
}

/// Measures the cases of a family at one pace. Each case must keep its bound and must be in the
/// document in its present form. With `ABBE_BLESS` the document is written instead.
pub(crate) fn check(families: &[Family], title: &str, pace: Pace) {
    let family = families.iter().find(|family| family.title == title).expect("the family is in the table");
    let mut faults = Vec::new();
    for case in family.cases.iter().filter(|case| case.pace == pace) {
        let start = std::time::Instant::now();
        let value = (case.measure)();
        println!("{title}: {}: {} (bound {}), {:.2?}", case.name, figure(value), case.bound.words(), start.elapsed());
        if !case.bound.holds(value) {
            faults.push(format!("{}: {} is {value:e}, bound {}", case.name, case.measured, case.bound.words()));
        } else if std::env::var_os("ABBE_BLESS").is_some() {
            bless(families, case, value);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let document = read();
    for case in family.cases {
        assert!(
            document.contains(&start_of_row(case)),
            "docs/validation/hard-cases.md lacks \"{}\" as it is: bless it",
            case.name
        );
    }
}

/// Checks that every row of the document's tables is a case, and that all have been measured.
pub(crate) fn check_document(families: &[Family]) {
    let document = read();
    let known: Vec<String> = families.iter().flat_map(|family| family.cases).map(start_of_row).collect();
    let generated = &document[place(&document, BEGIN).1..place(&document, END).0];
    let rows: Vec<&str> = generated
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with(HEADING) && !line.starts_with("| ---"))
        .collect();
    for row in &rows {
        assert!(known.iter().any(|start| row.starts_with(start)), "no test measures the row {row}");
        assert!(!row.ends_with(&format!("| {UNMEASURED} |")), "not measured yet: {row}");
    }
    assert_eq!(rows.len(), known.len());
}

const BEGIN: &str = "<!-- measured: from here on the tests write -->\n";
const END: &str = "<!-- measured: up to here -->\n";
const HEADING: &str = "| Case |";
const UNMEASURED: &str = "?";

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation/hard-cases.md")
}

fn read() -> String {
    std::fs::read_to_string(path()).expect("docs/validation/hard-cases.md can be read")
}

/// Returns the start and the end of a mark in the document.
fn place(document: &str, mark: &str) -> (usize, usize) {
    let start = document.find(mark).expect("docs/validation/hard-cases.md has its marks");
    (start, start + mark.len())
}

/// Returns a row up to the measured value.
fn start_of_row(case: &Case) -> String {
    let Case { name, naive, here, measured, bound, .. } = case;
    format!("| {name} | {naive} | {here} | {measured} | {} | ", bound.words())
}

/// Writes the document with this case's value; other cases keep their values.
fn bless(families: &[Family], case: &Case, value: f64) {
    static WRITING: Mutex<()> = Mutex::new(());
    let _alone = WRITING.lock().expect("no other writer failed");
    let document = read();
    let ((_, begin), (end, _)) = (place(&document, BEGIN), place(&document, END));
    let old = |other: &Case| {
        let name = format!("| {} | ", other.name);
        let row = document[begin..end].lines().find(|line| line.starts_with(&name))?;
        row.trim_end_matches(" |").rsplit("| ").next().map(str::to_string)
    };
    let mut text = String::new();
    for family in families {
        text += &format!("\n### {}\n\n", family.title);
        text += &format!(
            "{HEADING} Naive approach | Abbe | Measured | Bound | Worst |\n| --- | --- | --- | --- | --- | --- |\n"
        );
        for other in family.cases {
            let same = std::ptr::eq(other, case);
            let worst = if same { figure(value) } else { old(other).unwrap_or_else(|| UNMEASURED.to_string()) };
            text += &format!("{}{worst} |\n", start_of_row(other));
        }
    }
    let whole = [&document[..begin], &text, "\n", &document[end..]].concat();
    std::fs::write(path(), whole).expect("docs/validation/hard-cases.md can be written");
}
