//! The error type of the library.
//!
//! An [`Error`] is created where the fault is detected. Callers add the location of the fault. For
//! example, a spectrum detects a negative value, and the reader of the scene file adds the line,
//! the column and the JSON path.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of a function that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// The cause of an error. It determines the exit status of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The input or the command line is wrong (exit status 2).
    Input,
    /// The machine failed, for example because the disk is full or a folder is not writable (exit
    /// status 1).
    Machine,
}

/// The location of a fault. Every part may be unknown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ErrorLocation {
    /// The file.
    pub file: Option<PathBuf>,
    /// The line and the column, both counted from 1.
    pub line_column: Option<(usize, usize)>,
    /// The JSON path, for example `objects[3].shape.sphere.radius`.
    pub path: Option<String>,
}

/// An error: the fault, its location, and the values that are allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// The cause.
    pub kind: ErrorKind,
    /// The location.
    pub location: ErrorLocation,
    /// A description of the fault, as one clause.
    pub what: String,
    /// The allowed values.
    pub expected: Option<String>,
    /// A similar name that exists ("did you mean …?").
    pub suggestion: Option<String>,
}

impl Error {
    /// Creates an error in the input. `what` describes the fault.
    pub fn input(what: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Input,
            location: ErrorLocation::default(),
            what: what.into(),
            expected: None,
            suggestion: None,
        }
    }

    /// Creates an error of the machine. `what` describes the fault.
    pub fn machine(what: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Machine, ..Self::input(what) }
    }

    /// Creates an error for an unknown name. `kind` says what the name stands for, such as "glass".
    /// `known` contains the existing names. If one of these names is similar to `name`, the error
    /// suggests it.
    pub fn unknown_name<'a>(kind: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let suggestion = nearest_name(name, known);
        Self { suggestion, ..Self::input(format!("unknown {kind} \"{name}\"")) }
    }

    /// Adds a description of the allowed values.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Adds the file, unless one is set already.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        self.location.file.get_or_insert_with(|| file.to_path_buf());
        self
    }

    /// Adds the line and the column (from 1), unless they are set already.
    #[must_use]
    pub fn at(mut self, line: usize, column: usize) -> Self {
        self.location.line_column.get_or_insert((line, column));
        self
    }

    /// Adds the JSON path, unless one is set already.
    #[must_use]
    pub fn on_path(mut self, path: impl Into<String>) -> Self {
        self.location.path.get_or_insert_with(|| path.into());
        self
    }

    /// Returns the exit status of the program for this error.
    pub fn exit_status(&self) -> u8 {
        match self.kind {
            ErrorKind::Input => 2,
            ErrorKind::Machine => 1,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.location.file {
            write!(f, "{}:", file.display())?;
            if let Some((line, column)) = self.location.line_column {
                write!(f, "{line}:{column}:")?;
            }
            write!(f, " ")?;
        } else if let Some((line, column)) = self.location.line_column {
            write!(f, "line {line}, column {column}: ")?;
        }
        if let Some(path) = self.location.path.as_deref().filter(|path| !path.is_empty()) {
            write!(f, "{path}: ")?;
        }
        write!(f, "{}", self.what)?;
        if let Some(expected) = &self.expected {
            write!(f, "; expected {expected}")?;
        }
        if let Some(suggestion) = &self.suggestion {
            write!(f, "; did you mean \"{suggestion}\"?")?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}

/// Returns the candidate most similar to `name`. Letter case does not matter. Returns `None` if
/// `name` is probably not a misspelling of any candidate.
pub fn nearest_name<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let wanted = name.to_lowercase();
    let score = |candidate: &str| strsim::jaro_winkler(&wanted, &candidate.to_lowercase());
    candidates
        .into_iter()
        .map(|candidate| (score(candidate), candidate))
        .filter(|(score, _)| *score > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_printed_with_location_and_suggestion() {
        let error = Error::unknown_name("glass", "N-BK8", ["N-SF10", "N-BK7"])
            .expected("the name of a built-in glass")
            .on_path("materials.crown.dielectric.ior")
            .at(4, 17)
            .in_file(Path::new("scene.json"));
        assert_eq!(
            error.to_string(),
            "scene.json:4:17: materials.crown.dielectric.ior: unknown glass \"N-BK8\"; \
             expected the name of a built-in glass; did you mean \"N-BK7\"?"
        );
        assert_eq!(error.exit_status(), 2);
    }
}
