//! Hints for a mistaken command line.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory};

use super::Cli;

/// Names that users of other programs expect, and the options that do the same here.
const SYNONYMS: [(&str, &str); 15] = [
    ("--ev", "--exposure"),
    ("--html", "--svg"),
    ("--svg", "--html"),
    ("--plot", "--svg"),
    ("--nm", "--at"),
    ("--wavelength", "--at"),
    ("--wavelengths", "--at"),
    ("--samples", "--passes"),
    ("--spp", "--passes"),
    ("--out", "--output"),
    ("--resolution", "--size"),
    ("--width", "--size"),
    ("--height", "--size"),
    ("--error", "--target-error"),
    ("--colorspace", "--output-space"),
];

/// Joins the words `--resume auto` to one, because `--resume` alone may stand before the scene.
pub(super) fn with_resume_value(arguments: &[OsString]) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::with_capacity(arguments.len());
    for argument in arguments {
        match joined.last_mut().filter(|last| *last == "--resume" && argument == "auto") {
            Some(last) => last.push("=auto"),
            None => joined.push(argument.clone()),
        }
    }
    joined
}

/// Names the option that does what an unknown one suggests, or the page that lists all. The tip of
/// the parser, to pass the option as a value, helps nobody.
pub(super) fn with_known_option(line: String, error: &clap::Error, arguments: &[OsString]) -> String {
    let has_better_tip = error.get(ContextKind::SuggestedArg).is_some();
    let (ErrorKind::UnknownArgument, false, Some(ContextValue::String(unknown))) =
        (error.kind(), has_better_tip, error.get(ContextKind::InvalidArg))
    else {
        return line;
    };
    let what = line.split("; tip:").next().unwrap_or(&line).trim_end();
    let root = Cli::command();
    let command = arguments.get(1).and_then(|name| root.find_subcommand(name));
    let is_option = |command: &Command, option: &str| {
        command.get_arguments().any(|argument| argument.get_long().is_some_and(|long| option == format!("--{long}")))
    };
    let option = unknown.split('=').next().unwrap_or(unknown);
    let known = command.and_then(|command| {
        let of_command = |(name, known): &&(&str, &str)| *name == option && is_option(command, known);
        SYNONYMS.iter().find(of_command).map(|(_, known)| *known)
    });
    match (known, command) {
        (Some(known), _) => format!("{what}; did you mean {known}?"),
        (None, Some(command)) => format!("{what}; `abbe {} --help` lists the options", command.get_name()),
        (None, None) => format!("{what}; `abbe --help` lists the commands"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn hint(words: &[&str]) -> String {
        let arguments: Vec<OsString> = words.iter().map(OsString::from).collect();
        let error = Cli::try_parse_from(&arguments).unwrap_err();
        with_known_option(super::super::one_line(&error.to_string()), &error, &arguments)
    }

    #[test]
    fn an_unknown_option_gets_the_known_one() {
        assert_eq!(
            hint(&["abbe", "glass", "N-BK7", "--html", "a.html"]),
            "unexpected argument '--html' found; did you mean --svg?"
        );
        assert!(hint(&["abbe", "render", "a.json", "--spp=4"]).ends_with("; did you mean --passes?"));
        assert!(hint(&["abbe", "render", "a.json", "--passs", "4"]).contains("'--passes'"));
        let other = hint(&["abbe", "probe", "a.exr", "1", "1", "--frobnicate"]);
        assert!(other.ends_with("; `abbe probe --help` lists the options") && !other.contains("--' "), "{other}");
        for words in [
            ["abbe", "develop", "a.exr", "-o", "b.png", "--ev", "1"].as_slice(),
            &["abbe", "glass", "N-BK7", "--nm", "500"],
        ] {
            assert!(Cli::try_parse_from(words).is_ok(), "{words:?}");
        }
    }

    #[test]
    fn resume_takes_a_value_only_if_this_is_auto() {
        let joined = |words: &[&str]| {
            let words: Vec<OsString> = words.iter().map(OsString::from).collect();
            with_resume_value(&words).into_iter().map(|word| word.into_string().unwrap()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(joined(&["abbe", "render", "a.json", "--resume", "auto"]), "abbe render a.json --resume=auto");
        assert_eq!(joined(&["abbe", "render", "--resume", "a.json"]), "abbe render --resume a.json");
    }
}
