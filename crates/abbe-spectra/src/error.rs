//! The error type of the library. An [`Error`] is created where the fault is detected, and callers
//! add its location, such as the line, the column and the JSON path in a scene file.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of a function that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// The cause of an error, which determines the exit status of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The input or the command line is wrong (exit status 2).
    Input,
    /// The machine failed, for example a full disk or a read-only folder (exit status 1).
    Machine,
}

/// The location of a fault, of which every part may be unknown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ErrorLocation {
    /// The file.
    pub file: Option<PathBuf>,
    /// The line and the column, from 1.
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
    /// Further faults of the same input.
    pub others: Vec<Error>,
}

/// The largest number of faults that one error reports.
pub const MAX_FAULTS: usize = 20;

impl Error {
    /// Creates an error in the input, whose fault `what` describes.
    pub fn input(what: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Input,
            location: ErrorLocation::default(),
            what: what.into(),
            expected: None,
            suggestion: None,
            others: Vec::new(),
        }
    }

    /// Creates an error of the machine, whose fault `what` describes.
    pub fn machine(what: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Machine, ..Self::input(what) }
    }

    /// Creates an error for an unknown name of a `kind` ("glass"), and suggests one of `known`.
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
        self.others = self.others.into_iter().map(|fault| fault.in_file(file)).collect();
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

    /// Combines the faults of one input to one error, or returns `None` if there are none. A fault
    /// that occurs several times is reported once, and at most [`MAX_FAULTS`] are reported, those
    /// of a file in the order of their positions.
    pub fn all(faults: impl IntoIterator<Item = Self>) -> Option<Self> {
        let mut single: Vec<Self> = faults.into_iter().flat_map(Self::into_faults).collect();
        single.sort_by_key(|fault| fault.location.line_column);
        let mut found: Vec<Self> = Vec::new();
        for fault in single {
            if found.len() < MAX_FAULTS && !found.contains(&fault) {
                found.push(fault);
            }
        }
        let mut found = found.into_iter();
        let first = found.next()?;
        Some(Self { others: found.collect(), ..first })
    }

    /// Returns the faults of this error, each as an error of its own.
    pub fn into_faults(mut self) -> Vec<Self> {
        let others = std::mem::take(&mut self.others);
        std::iter::once(self).chain(others.into_iter().flat_map(Self::into_faults)).collect()
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
        self.others.iter().try_for_each(|fault| write!(f, "\n{fault}"))
    }
}

impl std::error::Error for Error {}

/// Returns both values, or an error with the faults of both.
pub fn both<A, B>(a: Result<A>, b: Result<B>) -> Result<(A, B)> {
    match (a, b) {
        (Ok(a), Ok(b)) => Ok((a, b)),
        (Err(a), Err(b)) => Err(Error::all([a.clone(), b]).unwrap_or(a)),
        (Err(error), Ok(_)) | (Ok(_), Err(error)) => Err(error),
    }
}

/// Returns all values, or an error with the faults of all results.
pub fn every<T>(results: impl IntoIterator<Item = Result<T>>) -> Result<Vec<T>> {
    let (mut values, mut faults) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(fault) => faults.push(fault),
        }
    }
    Error::all(faults).map_or(Ok(values), Err)
}

/// The words of Abbe, each with words of other programs that have the same meaning.
const SYNONYMS: [(&str, &[&str]); 19] = [
    ("dielectric", &["glass", "transparent", "refractive", "roughdielectric"]),
    ("thin_dielectric", &["thindielectric"]),
    ("conductor", &["metal", "roughconductor"]),
    ("diffuse", &["matte", "lambertian", "lambert"]),
    ("glossy", &["plastic", "coateddiffuse"]),
    ("mirror", &["specular"]),
    ("absorber", &["black"]),
    ("boundary", &["null", "interface"]),
    ("reflectance", &["albedo", "color", "colour"]),
    ("ior", &["index", "n"]),
    ("directional", &["sun", "distant"]),
    ("environment", &["infinite", "sky"]),
    ("beam", &["laser"]),
    ("box", &["cube", "cuboid"]),
    ("rectangle", &["plane", "quad"]),
    ("sphere", &["ball"]),
    ("pinhole", &["perspective"]),
    ("thin", &["thinlens"]),
    ("at", &["lookat"]),
];

/// Returns the candidate most similar to `name` in any letter case, or `None` if none is probably
/// meant. A candidate that differs only by a prefix comes first, such as N-BK7 for BK7, and then a
/// word with the same meaning in another program.
pub fn nearest_name<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let letters = |name: &str| name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let wanted: String = name.to_lowercase();
    let plain: String = letters(name);
    let synonym = SYNONYMS.iter().find(|(_, words)| words.contains(&plain.as_str())).map(|(synonym, _)| *synonym);
    let score = |candidate: &str| {
        let candidate_letters: String = letters(candidate);
        if plain == candidate_letters {
            3.0
        } else if plain.len() > 1 && candidate_letters.ends_with(&plain) {
            2.0
        } else if synonym == Some(candidate) {
            1.5
        } else {
            strsim::jaro_winkler(&wanted, &candidate.to_lowercase())
        }
    };
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

    #[test]
    fn names_without_a_prefix_and_synonyms_are_suggested() {
        let glasses = ["BAK7", "K7", "N-BK7", "N-BK10", "SF10", "N-SF10"];
        for (name, nearest) in [("BK7", "N-BK7"), ("bk 7", "N-BK7"), ("nbk7", "N-BK7"), ("sf10", "SF10")] {
            assert_eq!(nearest_name(name, glasses).as_deref(), Some(nearest), "{name}");
        }
        let materials = ["diffuse", "dielectric", "glossy", "conductor"];
        for (name, nearest) in [("glass", "dielectric"), ("Plastic", "glossy"), ("metal", "conductor")] {
            assert_eq!(nearest_name(name, materials).as_deref(), Some(nearest), "{name}");
        }
        // A name that exists is nearer than a synonym.
        assert_eq!(nearest_name("glas", ["glass", "dielectric"]).as_deref(), Some("glass"));
        assert_eq!(nearest_name("xyzzy", materials), None);
    }

    #[test]
    fn faults_are_combined_once_each_and_at_most_twenty() {
        let fault = |line: usize| Error::input(format!("fault {line}")).in_file(Path::new("a")).at(line, 1);
        let all = Error::all((0..30).rev().chain(0..30).map(fault)).unwrap();
        let texts: Vec<String> = all.to_string().lines().map(str::to_string).collect();
        assert_eq!(texts, (0..MAX_FAULTS).map(|line| format!("a:{line}:1: fault {line}")).collect::<Vec<_>>());
        assert_eq!(all.into_faults().len(), MAX_FAULTS);
        assert_eq!(Error::all([]), None);
        assert_eq!(both(Ok(1), Ok("x")), Ok((1, "x")));
        assert_eq!(both::<u8, u8>(Err(fault(2)), Err(fault(1))).unwrap_err().into_faults(), [fault(1), fault(2)]);
        assert_eq!(every([Ok(1), Ok(2)]), Ok(vec![1, 2]));
    }
}
