//! `docs/reference/cli.md` holds the help text of every command. `tests/bless` writes it.

use crate::abbe_command::command;
use crate::common::generated::is_up_to_date;
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "\
# Command line

This page holds the help text of every command. `tests/bless` generates it.

- Results go to standard output. Errors, notes and progress go to standard error.
- The exit status is explained in [files](files.md#exit-status).
- Files are written under a temporary name and renamed when they are complete.
- A scene may name files only in its own folder and below. `--allow-outside` lifts this limit.
";

/// Returns a help text, 100 columns wide.
fn help(arguments: &[&str]) -> String {
    let done = command(Path::new(".")).args(arguments).arg("--help").env("COLUMNS", "100").output().unwrap();
    assert!(done.status.success(), "{arguments:?}");
    let text = String::from_utf8(done.stdout).unwrap();
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[test]
fn the_reference_of_the_command_line_is_up_to_date() {
    let overview = help(&[]);
    let list = overview.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // The description of a command starts in a fixed column and may continue there.
    let names = list.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    let mut page = format!("{HEAD}\n## abbe\n\n```text\n{overview}```\n");
    for name in names.filter(|name| *name != "help") {
        write!(page, "\n## abbe {name}\n\n```text\n{}```\n", help(&[name])).unwrap();
    }
    assert!(page.contains("\n## abbe render\n"), "{page}");
    is_up_to_date("docs/reference/cli.md", &page);
}
