//! The printed outputs and the pictures of the guides are those of the program.
//!
//! A comment before a block of a guide says what the block is:
//!
//! | comment | meaning |
//! | --- | --- |
//! | `<!-- guide: file NAME -->` | the next block is the content of this file |
//! | `<!-- guide: write NAME TEXT -->` | this text is the content of this file |
//! | `<!-- guide: run COMMAND -->` | this command runs without a block |
//! | `<!-- guide: prints COMMAND -->` | the next block is what this command prints |
//! | `<!-- guide: picture FILE -->` | the next picture is this file |
//!
//! Several commands are joined by `&&`. `slow` after `guide:` leaves the step to a test that
//! renders the pictures of a guide and takes minutes. In a block, a line `...` stands for any
//! number of lines, and `...` at the end of a line for the rest of this line. A line that begins
//! with `$ ` is a command, and not its output. `tests/bless` writes the blocks again, and
//! `tests/bless --all` also those that need renders, and the pictures.
//!
//! The picture of an example scene in `docs/pictures` has the name of the scene, and is what `abbe
//! render` writes.

#![cfg(unix)]

use crate::abbe_command::abbe;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const GUIDES: [&str; 15] = [
    "docs/guide/compare-two-lamps.md",
    "docs/guide/exposure-and-white-balance.md",
    "docs/guide/first-scene.md",
    "docs/guide/fluorescence.md",
    "docs/guide/fog-and-beams.md",
    "docs/guide/import.md",
    "docs/guide/install.md",
    "docs/guide/layers-and-light-groups.md",
    "docs/guide/lens-and-chromatic-aberration.md",
    "docs/guide/motion-and-sequences.md",
    "docs/guide/spectral-to-rgb-in-ci.md",
    "docs/guide/what-accuracy-costs.md",
    "docs/method/lenses.md",
    "docs/method/pilot.md",
    "docs/method/plan.md",
];

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

#[derive(Debug, PartialEq)]
struct Step {
    is_slow: bool,
    /// `file`, `write`, `run`, `prints` or `picture`.
    kind: String,
    argument: String,
    /// The lines of the block, by their numbers, or the line of the picture.
    block: std::ops::Range<usize>,
}

/// Returns the steps of a guide.
fn steps(lines: &[String]) -> Vec<Step> {
    let mut steps = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let Some(comment) = line.strip_prefix("<!-- guide: ").and_then(|rest| rest.strip_suffix(" -->")) else {
            continue;
        };
        let (is_slow, comment) = comment.strip_prefix("slow ").map_or((false, comment), |rest| (true, rest));
        let (kind, argument) = comment.split_once(' ').expect("a kind and an argument");
        let from =
            |start: &str| number + 1 + lines[number + 1..].iter().position(|line| line.starts_with(start)).unwrap();
        let mut block = match kind {
            "run" | "write" => number..number,
            "picture" => from("![")..from("![") + 1,
            _ => {
                let first = from("```") + 1;
                first..first + lines[first..].iter().position(|line| line == "```").unwrap()
            }
        };
        while lines.get(block.start).is_some_and(|line| kind == "prints" && line.starts_with("$ ")) {
            block.start += 1;
        }
        steps.push(Step { is_slow, kind: kind.to_owned(), argument: argument.to_owned(), block });
    }
    steps
}

/// Splits a command into words at spaces, except between single quotes.
fn words(command: &str) -> Vec<String> {
    let parts = command.split('\'').enumerate();
    let mut words = vec![String::new()];
    for (number, part) in parts {
        if number % 2 == 1 {
            words.last_mut().unwrap().push_str(part);
            continue;
        }
        for (nth, word) in part.split(' ').enumerate() {
            if nth > 0 {
                words.push(String::new());
            }
            words.last_mut().unwrap().push_str(word);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Returns what commands print, line by line, without the progress of a render.
fn printed(folder: &Path, commands: &str) -> Vec<String> {
    commands.split(" && ").flat_map(|command| printed_by(folder, command)).collect()
}

fn printed_by(folder: &Path, command: &str) -> Vec<String> {
    let words = words(command);
    assert_eq!(words[0], "abbe", "{command}");
    let said = abbe(folder, &words[1..].iter().map(String::as_str).collect::<Vec<_>>());
    let is_progress = |line: &&str| line.starts_with("pilot: ") || line.ends_with(" photons/s");
    let all = format!("{}{}", said.out, said.err);
    all.lines().filter(|line| !is_progress(line)).map(|line| line.trim_end().to_owned()).collect()
}

/// Returns the line without the time that a render took.
fn without_time(line: &str) -> String {
    match line.split_once(" passes in ") {
        Some((before, after)) if line.starts_with("wrote ") => {
            format!("{before}{}", after.split_once(',').map_or("", |(_, rest)| rest))
        }
        _ => line.to_owned(),
    }
}

fn is_gap(line: &str) -> bool {
    ["...", "…"].contains(&line.trim())
}

fn is_same(shown: &str, line: &str) -> bool {
    match shown.strip_suffix("...").or(shown.strip_suffix('…')) {
        Some(start) => without_time(line).starts_with(without_time(start).trim_end()),
        None => without_time(shown) == without_time(line),
    }
}

/// Returns true if the shown lines are the printed ones, apart from gaps.
fn shows(shown: &[String], printed: &[String]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((first, rest)) if is_gap(first) => (0..=printed.len()).any(|skipped| shows(rest, &printed[skipped..])),
        Some((first, rest)) => printed.first().is_some_and(|line| is_same(first, line)) && shows(rest, &printed[1..]),
    }
}

/// Returns the shown lines with the values of the printed ones: each line shows the next printed
/// line that begins with the same words, up to two spaces. Lines that are left out become a gap.
fn renewed(shown: &[String], printed: &[String]) -> Vec<String> {
    if !shown.iter().any(|line| is_gap(line) || line.ends_with("...") || line.ends_with('…')) {
        return printed.to_vec();
    }
    let label =
        |line: &str| line.trim_start().split("  ").next().unwrap_or_default().split(':').next().unwrap().to_owned();
    let (mut next, mut new) = (0, Vec::<String>::new());
    for line in shown {
        let found = printed[next..].iter().position(|now| is_same(line, now));
        let found = found.or_else(|| printed[next..].iter().position(|now| label(now) == label(line)));
        let Some(found) = found.filter(|_| !is_gap(line)) else {
            new.push(line.clone());
            continue;
        };
        if found > 0 && !new.last().is_some_and(|last| is_gap(last)) {
            new.push("...".to_owned());
        }
        let now = &printed[next + found];
        next += found + 1;
        new.push(match line.strip_suffix("...") {
            _ if is_same(line, now) => line.clone(),
            Some(start) => format!("{}...", now.chars().take(start.chars().count()).collect::<String>()),
            None => now.clone(),
        });
    }
    if next < printed.len() && !new.last().is_some_and(|last| is_gap(last)) {
        new.push("...".to_owned());
    }
    new
}

/// Runs a guide in a folder of its own, and compares or, with `ABBE_BLESS`, writes its blocks.
fn check(guide: &str, with_slow_steps: bool) {
    let text = std::fs::read_to_string(root(guide)).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let folder = TempDir::new().unwrap();
    std::os::unix::fs::symlink(root("scenes"), folder.path().join("scenes")).unwrap();
    let is_blessed = std::env::var_os("ABBE_BLESS").is_some();
    let mut faults = Vec::new();
    // From the end, so that the numbers of the lines before stay right.
    let mut changes: Vec<(std::ops::Range<usize>, Vec<String>)> = Vec::new();
    for Step { is_slow, kind, argument, block } in steps(&lines) {
        if is_slow && !with_slow_steps {
            continue;
        }
        match kind.as_str() {
            "file" => std::fs::write(folder.path().join(&argument), lines[block].join("\n")).unwrap(),
            "write" => {
                let (name, content) = argument.split_once(' ').expect("a name and a text");
                std::fs::write(folder.path().join(name), content).unwrap();
            }
            "run" => drop(printed(folder.path(), &argument)),
            "prints" => {
                let (shown, now) = (&lines[block.clone()], printed(folder.path(), &argument));
                if !shows(shown, &now) {
                    faults.push(format!("{guide}:{}: `{argument}` prints\n{}", block.start + 1, now.join("\n")));
                    changes.push((block, renewed(shown, &now)));
                }
            }
            "picture" => {
                let name = lines[block.start].split(['(', ')']).nth(1).unwrap();
                let (known, now) = (root(guide).parent().unwrap().join(name), folder.path().join(&argument));
                let now = std::fs::read(now).unwrap();
                if std::fs::read(&known).ok().as_deref() != Some(&now) {
                    faults.push(format!("{guide}:{}: {name} is another picture", block.start + 1));
                    if is_blessed {
                        std::fs::write(known, now).unwrap();
                    }
                }
            }
            other => panic!("{guide}: unknown step {other}"),
        }
    }
    if is_blessed {
        changes.into_iter().rev().for_each(|(block, new)| drop(lines.splice(block, new)));
        std::fs::write(root(guide), lines.join("\n") + "\n").unwrap();
    } else {
        assert!(faults.is_empty(), "run tests/bless, and read the difference:\n{}", faults.join("\n\n"));
    }
}

#[test]
fn the_guides_show_what_the_commands_print() {
    GUIDES.into_iter().for_each(|guide| check(guide, false));
}

#[test]
#[ignore = "slow: renders the pictures of the guides, which takes minutes"]
fn the_guides_show_what_renders_print_and_draw() {
    GUIDES.into_iter().for_each(|guide| check(guide, true));
}

/// With `ABBE_PICTURE=NAME`, only the picture of the scene NAME.
#[test]
#[ignore = "slow: renders all example scenes that have a picture, which takes an hour"]
fn the_guides_show_the_example_scenes() {
    let wanted = std::env::var("ABBE_PICTURE").ok();
    let is_blessed = std::env::var_os("ABBE_BLESS").is_some();
    let (mut known, mut stale) = (0, Vec::new());
    for folder in ["docs/pictures", "docs/pictures/guide"] {
        for entry in std::fs::read_dir(root(folder)).unwrap() {
            let picture = entry.unwrap().path();
            let name = picture.file_stem().unwrap().to_string_lossy().into_owned();
            let scene = root("scenes").join(&name).with_extension("json");
            let is_png = picture.extension().is_some_and(|extension| extension == "png");
            // The picture of `zoom` shows three focal lengths, and that of `glare_on_water` two
            // filters.
            let is_composed = name == "zoom" || name == "glare_on_water";
            if !is_png || !scene.exists() || is_composed || wanted.as_ref().is_some_and(|wanted| *wanted != name) {
                continue;
            }
            known += 1;
            let work = TempDir::new().unwrap();
            // The guide renders this scene by the path tracer.
            let integrator = if name == "calcite" { "path" } else { "photon" };
            let said = abbe(work.path(), &["render", scene.to_str().unwrap(), "--integrator", integrator, "--quiet"]);
            assert_eq!(said.status, 0, "{name}: {}", said.err);
            let now = std::fs::read(work.path().join(format!("{name}.png"))).unwrap();
            if std::fs::read(&picture).unwrap() != now {
                stale.push(name);
                if is_blessed {
                    std::fs::write(&picture, now).unwrap();
                }
            }
        }
    }
    assert!(known > 0, "no example scene has this picture");
    assert!(is_blessed || stale.is_empty(), "run tests/bless --all: other pictures of {stale:?}");
}

#[test]
fn a_block_shows_parts_of_a_report() {
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let report = lines("pixel        3, 4\nxy           0.13894  0.70261\nnoise of Y   17\nspectrum     nm");
    for shown in ["pixel        3, 4\n...\nspectrum     nm", "...", "pixel  ...\n…", "...\nnoise of Y   17\n..."] {
        let shown = shown.replace("pixel  ...", "pixel        ...");
        assert!(shows(&lines(&shown), &report), "{shown}");
    }
    let stale = lines("pixel        3, 5\n...\nnoise of Y   18\n...");
    assert!(!shows(&stale, &report));
    assert_eq!(renewed(&stale, &report), lines("pixel        3, 4\n...\nnoise of Y   17\n..."));
    assert!(is_same("wrote a.exr: 32 passes in 4.1 s, exposure EV 1", "wrote a.exr: 32 passes in 9 s, exposure EV 1"));
    assert_eq!(words("abbe a 'b c' d='e'"), ["abbe", "a", "b c", "d=e"]);
}
