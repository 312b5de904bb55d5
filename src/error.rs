//! The one error of the program: what was found, where, and what was expected.
//!
//! An [`Error`] is made where the fault is seen and gains its place on the way up: a spectrum knows that a
//! value is negative, the scene file knows at which line, column and JSON path it stands.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of anything that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Whose fault it is; it decides the exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The input or the command is wrong (exit status 2).
    Input,
    /// The machine failed us: disk full, unwritable folder, out of memory (exit status 1).
    Machine,
}

/// Where the fault stands; every part may be unknown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: Option<PathBuf>,
    /// Line and column, both counted from 1.
    pub line_column: Option<(usize, usize)>,
    /// The JSON path, such as `objects[3].shape.sphere.radius`.
    pub path: Option<String>,
}

/// What went wrong, where, and what would have been right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// Whose fault it is.
    pub fault: Fault,
    /// Where it stands.
    pub place: Place,
    /// What was found, as one clause.
    pub what: String,
    /// What is allowed there.
    pub expected: Option<String>,
    /// A near name ("did you mean …?").
    pub near: Option<String>,
}

impl Error {
    /// The input is wrong: `what` says how.
    pub fn input(what: impl Into<String>) -> Self {
        Self { fault: Fault::Input, place: Place::default(), what: what.into(), expected: None, near: None }
    }

    /// The machine failed: `what` says how.
    pub fn machine(what: impl Into<String>) -> Self {
        Self { fault: Fault::Machine, ..Self::input(what) }
    }

    /// A name that stands in no list; `known` gives the candidates for "did you mean".
    pub fn unknown_name<'a>(kind: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let near = nearest_name(name, known);
        Self { near, ..Self::input(format!("unknown {kind} \"{name}\"")) }
    }

    /// Adds what is allowed.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Names the file, unless it is known already.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        self.place.file.get_or_insert_with(|| file.to_path_buf());
        self
    }

    /// Names line and column (from 1), unless they are known already.
    #[must_use]
    pub fn at(mut self, line: usize, column: usize) -> Self {
        self.place.line_column.get_or_insert((line, column));
        self
    }

    /// Names the JSON path, unless it is known already.
    #[must_use]
    pub fn on_path(mut self, path: impl Into<String>) -> Self {
        self.place.path.get_or_insert_with(|| path.into());
        self
    }

    /// The exit status that this error calls for.
    pub fn exit_status(&self) -> u8 {
        match self.fault {
            Fault::Input => 2,
            Fault::Machine => 1,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.place.file {
            write!(f, "{}:", file.display())?;
            if let Some((line, column)) = self.place.line_column {
                write!(f, "{line}:{column}:")?;
            }
            write!(f, " ")?;
        } else if let Some((line, column)) = self.place.line_column {
            write!(f, "line {line}, column {column}: ")?;
        }
        if let Some(path) = self.place.path.as_deref().filter(|path| !path.is_empty()) {
            write!(f, "{path}: ")?;
        }
        write!(f, "{}", self.what)?;
        if let Some(expected) = &self.expected {
            write!(f, "; expected {expected}")?;
        }
        if let Some(near) = &self.near {
            write!(f, "; did you mean \"{near}\"?")?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}

/// The candidate nearest to `name` (without regard to case), if one is near enough to be a likely slip.
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
    fn an_error_reads_as_place_fault_expectation_and_hint() {
        let error = Error::unknown_name("glass", "N-BK8", ["N-SF10", "N-BK7"])
            .expected("a name of `abbe glass --list`")
            .on_path("materials.crown.dielectric.ior")
            .at(4, 17)
            .in_file(Path::new("scene.json"));
        assert_eq!(
            error.to_string(),
            "scene.json:4:17: materials.crown.dielectric.ior: unknown glass \"N-BK8\"; \
             expected a name of `abbe glass --list`; did you mean \"N-BK7\"?"
        );
        assert_eq!(error.exit_status(), 2);
    }
}
