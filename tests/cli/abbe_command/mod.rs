//! Runs the built `abbe` and captures its output.

pub(crate) mod folder;
#[cfg(unix)]
pub(crate) mod signal;

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// The result of a run of `abbe`.
pub(crate) struct Said {
    /// Exit status.
    pub(crate) status: i32,
    /// Standard output.
    pub(crate) out: String,
    /// Standard error.
    pub(crate) err: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("abbe speaks UTF-8");
        Self {
            status: output.status.code().expect("abbe is not killed"),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }
}

impl Said {
    /// Returns its standard output as JSON; the run must have succeeded.
    pub(crate) fn json(&self) -> serde_json::Value {
        assert_eq!(self.status, 0, "{}", self.err);
        serde_json::from_str(&self.out).expect("--json prints JSON")
    }

    /// Checks that the run printed one line of error with these words, nothing on standard output,
    /// and did not panic.
    #[track_caller]
    pub(crate) fn is_error(&self, status: i32, words: &[&str]) {
        let err = &self.err;
        assert_eq!(self.status, status, "{err}");
        assert!(err.starts_with("error: ") && err.trim_end().lines().count() == 1, "{err}");
        assert!(words.iter().all(|word| err.contains(word)), "{err}");
        assert!(self.out.is_empty() && !err.contains("panicked"), "{}{err}", self.out);
    }
}

/// Prepares the command to run in a folder.
pub(crate) fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.current_dir(folder).stdin(Stdio::null());
    command
}

/// Runs `abbe` in a folder.
pub(crate) fn abbe(folder: &Path, arguments: &[&str]) -> Said {
    command(folder).args(arguments).output().expect("abbe can be started").into()
}
