//! Output of the commands. Results go to standard output. All other output goes to standard error.

use std::io::{ErrorKind, Write};
use std::path::Path;

use crate::error::{Error, Result};
use crate::format::{FileAccess, PATCH_LABEL};
use crate::optics::glass::catalogue;
use crate::spectrum::library;
use serde::Serialize;

/// Prints a result. A closed pipe, as in `abbe ... | head`, is not an error.
pub(crate) fn result(text: &str) -> Result<()> {
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
    result(&(text + "\n"))
}

/// Prints a line on standard error. If printing fails, the failure is ignored, because the program
/// has no other way to report it.
pub(crate) fn remark(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", with_command_line_hints(text));
}

/// Returns a number of passes as text, such as "3 passes".
pub(crate) fn passes(count: u64) -> String {
    if count == 1 { "1 pass".to_string() } else { format!("{count} passes") }
}

/// Hints that are added to error messages of the library. Each pair contains a fragment of a
/// message, and the hint that is added after this fragment.
const HINTS: [(&str, &str); 3] = [
    (FileAccess::EXPECTED_WITHIN_FOLDER, ", or the option --allow-outside"),
    (library::EXPECTED_NAME, " (`abbe spectrum --list` prints all)"),
    (catalogue::EXPECTED_NAME, " (`abbe glass --list` prints all)"),
];

/// Two labels of a scene patch: the label in the errors of the library, and the label on the
/// command line.
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

/// Prints each fault of an error on one line. If a fault is in a scene patch, its line shows the
/// label `--set` instead of the library's label.
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

/// Prints the text of an error on one line.
pub(crate) fn error_line(text: &str) {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    remark(&format!("error: {}", lines.join(" ")));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_gain_the_options_that_help() {
        let text = "a/b.json: found ../x.obj; expected a path within the folder of the file that names it";
        let hinted = with_command_line_hints(text);
        assert!(hinted.ends_with("names it, or the option --allow-outside"), "{hinted}");
        assert_eq!(with_command_line_hints(&hinted), hinted);
        assert_eq!(with_command_line_hints("no light"), "no light");
    }
}
