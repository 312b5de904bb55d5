//! Output of the commands. Results go to standard output. All other output goes to standard error.

use std::borrow::Cow;
use std::io::{ErrorKind, Write};
use std::ops::RangeInclusive;
use std::path::Path;

use abbe_format::{FileAccess, PATCH_LABEL};
use abbe_optics::glass::{catalogue, is_negligible};
use abbe_session::render::ErrorStats;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::log2;
use abbe_spectra::spectrum::library;
use abbe_transport::sensor::Picture;
use serde::Serialize;

/// Prints a report. Names in it may come from files, so its control characters are shown as text.
pub(crate) fn result(text: &str) -> Result<()> {
    data(&visible(text))
}

/// Prints data for other programs, unchanged. A closed pipe, as in `abbe ... | head`, is not an
/// error.
pub(crate) fn data(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Error::machine(format!("standard output cannot be written: {error}"))),
    }
}

/// Prints a result as one JSON object. Numbers that are not finite become `null`.
pub(crate) fn json<T: Serialize>(value: &T) -> Result<()> {
    let text = serde_json::to_string_pretty(value).expect("reports have text keys and no fallible values");
    data(&(text + "\n"))
}

/// Prints a line on standard error, with control characters shown as text. A failure cannot be
/// reported, so it is ignored.
pub(crate) fn remark(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", visible(&with_command_line_hints(text)));
}

/// Shows control characters as text, such as `\x1b`, because they would command the terminal: they
/// move the cursor, change its title, or turn the direction of the text. Only line breaks and tabs
/// stay.
pub(crate) fn visible(text: &str) -> Cow<'_, str> {
    /// Characters that turn the direction of the text, so that a name looks like another one.
    const DIRECTIONS: [RangeInclusive<char>; 2] = ['\u{202a}'..='\u{202e}', '\u{2066}'..='\u{2069}'];
    let commands = |c: char| {
        let turns = DIRECTIONS.iter().any(|range| range.contains(&c));
        (c.is_control() || turns) && c != '\n' && c != '\t'
    };
    if !text.contains(commands) {
        return Cow::Borrowed(text);
    }
    let shown = |text: String, c: char| match c {
        c if !commands(c) => text + c.encode_utf8(&mut [0; 4]),
        c if c.is_ascii() => text + &format!("\\x{:02x}", u32::from(c)),
        c => text + &c.escape_unicode().to_string(),
    };
    Cow::Owned(text.chars().fold(String::new(), shown))
}

/// Prints notes, of which some are warnings. If `quiet` is true, only the warnings are printed.
pub(crate) fn notes(notes: &[String], warnings: &[String], quiet: bool) {
    for note in notes.iter().filter(|note| !is_negligible(note)) {
        let is_warning = warnings.contains(note);
        if is_warning || !quiet {
            remark(&format!("{}: {note}", note_kind(is_warning)));
        }
    }
}

/// Returns the word before a note.
pub(crate) fn note_kind(is_warning: bool) -> &'static str {
    if is_warning { "warning" } else { "note" }
}

/// Returns a number of passes as text, such as "3 passes".
pub(crate) fn passes(count: u64) -> String {
    if count == 1 { "1 pass".to_string() } else { format!("{count} passes") }
}

/// Returns a number of things as text, such as "1 part" or "3 parts".
pub(crate) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Returns an exposure as text, such as "EV -7.52". `factor` is in 1/(cd/m²).
pub(crate) fn exposure(factor: f64) -> String {
    format!("EV {:.2}", log2(factor))
}

/// Returns the error of a picture as text: that of a typical pixel, the 95th percentile, the root
/// mean square, and the worst region if it dominates this.
pub(crate) fn picture_error(error: &ErrorStats) -> String {
    /// A region is named if it contains at least this fraction of the mean square error.
    const DOMINANT: f64 = 0.25;
    let Some(((typical, p95), relative)) = error.typical.zip(error.p95).zip(error.relative) else {
        return "the error is not known yet".to_string();
    };
    let [typical, p95, relative] = [typical, p95, relative].map(percent);
    let worst = error.worst_region.zip(error.worst_fraction).filter(|(_, fraction)| *fraction >= DOMINANT);
    let worst = worst.map_or(String::new(), |([x0, y0, x1, y1], fraction)| {
        format!(", {:.0} % of it from the region {x0},{y0},{x1},{y1}", 100.0 * fraction)
    });
    format!("error of a typical pixel {typical}, of 95 % of the pixels below {p95}; RMSE {relative} of the mean{worst}")
}

/// Returns the error of a denoised picture as text, and whether the PNG shows this picture.
pub(crate) fn denoised(picture: &Picture, is_shown: bool) -> String {
    let typical = picture.error_distribution().map_or("unknown".to_string(), |errors| percent(errors.typical));
    let shown = if is_shown { "the PNG shows the denoised picture" } else { "the PNG shows the picture as rendered" };
    format!("{shown}; denoised, the error of a typical pixel is {typical}")
}

/// Hints for error messages of the library, each after the fragment of a message.
const HINTS: [(&str, &str); 3] = [
    (FileAccess::EXPECTED_WITHIN_FOLDER, ", or the option --allow-outside"),
    (library::EXPECTED_NAME, " (`abbe spectrum --list` prints all)"),
    (catalogue::EXPECTED_NAME, " (`abbe glass --list` prints all)"),
];

/// The label of a scene patch in the errors of the library, and on the command line.
const PATCH_LABELS: (&str, &str) = (PATCH_LABEL, "--set ");

/// Adds hints to a message of the library: options and commands that help with the problem.
fn with_command_line_hints(text: &str) -> String {
    let mut text = text.to_string();
    for (part, hint) in HINTS {
        if text.contains(part) && !text.contains(hint) {
            text = text.replace(part, &format!("{part}{hint}"));
        }
    }
    text
}

/// Prints each fault of an error on one line, with the label `--set` for a scene patch.
pub(crate) fn error(error: &Error) {
    for mut fault in error.clone().into_faults() {
        let label =
            fault.location.file.as_deref().and_then(Path::to_str).and_then(|file| file.strip_prefix(PATCH_LABELS.0));
        if let Some(path) = label {
            fault.location.file = Some(format!("{}{path}", PATCH_LABELS.1).into());
        }
        error_line(&fault.to_string());
    }
}

pub(crate) fn error_line(text: &str) {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    remark(&format!("error: {}", lines.join(" ")));
}

/// Writes a ratio in percent.
pub(crate) fn percent(fraction: f64) -> String {
    match 100.0 * fraction {
        percent if percent > 0.0 && percent < 0.01 => format!("{percent:.1e} %"),
        percent if percent < 10.0 => format!("{percent:.2} %"),
        percent => format!("{percent:.0} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_told_by_its_pixels_and_its_worst_region() {
        let error = |worst_fraction: f64| ErrorStats {
            noise: 1.0,
            bias: 0.0,
            relative: Some(0.4),
            typical: Some(0.015),
            median: Some(0.011),
            p95: Some(0.05),
            worst_region: Some([8, 0, 16, 8]),
            worst_fraction: Some(worst_fraction),
            unknown_pixels: 0,
            edge_pixels: 0,
        };
        let text = "error of a typical pixel 1.50 %, of 95 % of the pixels below 5.00 %; RMSE 40 % of the mean";
        assert_eq!(picture_error(&error(0.1)), text);
        assert_eq!(picture_error(&error(0.9)), format!("{text}, 90 % of it from the region 8,0,16,8"));
        assert_eq!(picture_error(&ErrorStats { relative: None, ..error(0.1) }), "the error is not known yet");
    }

    #[test]
    fn control_characters_are_shown_as_text() {
        let title = "a\u{1b}]0;title\u{7}\u{1b}[31m\r\0\u{7f}\u{9b}2J\u{202e}\tλ\n";
        let shown = "a\\x1b]0;title\\x07\\x1b[31m\\x0d\\x00\\x7f\\u{9b}2J\\u{202e}\tλ\n";
        assert_eq!(visible(title), shown);
        assert_eq!(visible(shown), shown);
    }

    #[test]
    fn messages_gain_the_options_that_help() {
        let text = "a/b.json: found ../x.obj; expected a path within the folder of the file that names it";
        let hinted = with_command_line_hints(text);
        assert!(hinted.ends_with("names it, or the option --allow-outside"), "{hinted}");
        assert_eq!(with_command_line_hints(&hinted), hinted);
        assert_eq!(with_command_line_hints("no light"), "no light");
    }
}
