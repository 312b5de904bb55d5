//! The report of a validation as a Markdown page.

use super::CaseResult;
use std::fmt::Write as _;

/// Returns a Markdown page: a summary with one line for each case, and then all values.
pub(crate) fn markdown(title: &str, introduction: &str, results: &[CaseResult]) -> String {
    let count = |of: fn(&CaseResult) -> usize| results.iter().map(of).sum::<usize>();
    let (values, failures, covered) =
        (count(|result| result.values.len()), count(CaseResult::failures), count(CaseResult::covered));
    let seconds: f64 = results.iter().map(|result| result.seconds).sum();
    let mut text = format!("# {title}\n\n{introduction}\n\n");
    let _ = writeln!(
        text,
        "{} of {values} values pass. {:.1} % of the expected values are inside their 95 % intervals. The measurements \
         took {seconds:.0} s.\n",
        values - failures,
        100.0 * covered as f64 / values.max(1) as f64
    );
    text.push_str("| Case | Values | Failures | Largest deviation / tolerance | Inside the interval | Time |\n");
    text.push_str("| --- | ---: | ---: | ---: | ---: | ---: |\n");
    for result in results {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.2} | {} | {:.1} s |",
            result.id,
            result.values.len(),
            result.failures(),
            result.largest_deviation(),
            result.covered(),
            result.seconds
        );
    }
    for result in results {
        let _ = write!(text, "\n## {}\n\n{} (unit: {})\n\n", result.id, result.title, result.unit);
        text.push_str("| Point | Expected | Printed | Measured | 95 % interval | Result |\n");
        text.push_str("| --- | ---: | ---: | ---: | ---: | --- |\n");
        for value in &result.values {
            let published = value.published.map_or("–".to_string(), number);
            let interval = value
                .interval_95
                .map_or("unknown".to_string(), |[low, high]| format!("{} to {}", number(low), number(high)));
            let _ = writeln!(
                text,
                "| {} | {} | {published} | {} | {interval} | {} |",
                value.id,
                number(value.expected),
                number(value.measured),
                if value.passes { "passes" } else { "**fails**" }
            );
        }
    }
    text
}

/// Returns a number with about five significant digits.
fn number(value: f64) -> String {
    let decimals = match value.abs() {
        size if size >= 1000.0 => 1,
        size if size >= 100.0 => 2,
        size if size >= 10.0 => 3,
        size if size >= 1.0 => 4,
        _ => 5,
    };
    format!("{value:.decimals$}")
}
