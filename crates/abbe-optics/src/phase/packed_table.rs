//! Reads the phase functions that `build.rs` has packed.

use super::table::{self, PhaseTable};
use abbe_spectra::error::Result;

/// The number of values of five digits in a decade.
const DECADE: i64 = 90_000;

/// Parses the text of a packed table into the same table as that of its file in `data/media`.
///
/// # Errors
/// Returns the errors of [`table::parse`].
pub(super) fn parse(packed: &str) -> Result<PhaseTable> {
    table::parse(&unpacked(packed))
}

/// Returns the text of a table in which each value has its digits and its exponent.
fn unpacked(packed: &str) -> String {
    let (header, rows) = packed.split_once('\n').unwrap_or((packed, ""));
    let mut text = format!("{header}\n");
    let mut above: Vec<i64> = Vec::new();
    for row in rows.lines() {
        let (angle, steps) = row.split_once(',').unwrap_or((row, ""));
        text += angle;
        let mut left = 0;
        above.resize(steps.split(',').count(), 0);
        for (above, step) in above.iter_mut().zip(steps.split(',')) {
            // A step that is no number leaves a text that is none either.
            let Ok(step) = step.parse::<i64>() else {
                text += &format!(",{step}");
                continue;
            };
            left += step;
            *above += left;
            let exponent = (*above - 10_000).div_euclid(DECADE);
            text += &format!(",{}e{exponent}", *above - DECADE * exponent);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_tables_are_those_of_the_files() {
        let files = [include_str!("../../data/media/ice.csv"), include_str!("../../data/media/rainbow.csv")];
        let packed = [super::super::ice::PACKED, super::super::rainbow::PACKED];
        for (packed, file) in packed.into_iter().zip(files) {
            assert_eq!(parse(packed).unwrap(), table::parse(file).unwrap());
            assert!(packed.len() < file.len());
        }
    }
}
