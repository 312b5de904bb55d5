//! The tables of a CGATS file: keywords, names of columns, and rows of cells.

use crate::error::{Error, Result};

/// The word that begins the names of the columns.
pub(super) const BEGIN_FORMAT: &str = "BEGIN_DATA_FORMAT";

/// The largest number of cells in a file.
const MAX_CELLS: usize = 1 << 23;

/// A word or a quoted text of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell<'a> {
    /// The text without quotes.
    pub(super) text: &'a str,
    line: usize,
    column: usize,
}

impl Cell<'_> {
    /// Returns the line and the column, both from 1.
    pub(super) fn place(self) -> (usize, usize) {
        (self.line, self.column)
    }

    /// Parses a number, which may have a decimal comma.
    pub(super) fn number(self) -> Result<f64> {
        let parsed = self.text.parse().or_else(|_| self.text.replacen(',', ".", 1).parse());
        let shown: String = self.text.chars().take(40).collect();
        parsed.map_err(|_| Error::input(format!("\"{shown}\"")).expected("a number").at(self.line, self.column))
    }
}

/// One table of a file.
#[derive(Debug)]
pub(super) struct CgatsTable<'a> {
    /// The words of the lines before the columns: a keyword and its values.
    keywords: Vec<Vec<Cell<'a>>>,
    /// The names of the columns.
    pub(super) fields: Vec<Cell<'a>>,
    /// The samples. Each row has one cell per column.
    pub(super) rows: Vec<Vec<Cell<'a>>>,
    /// The line and the column of `BEGIN_DATA`.
    pub(super) data_place: (usize, usize),
}

impl<'a> CgatsTable<'a> {
    /// Returns the index of a column by its name in capitals without underscores.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        let plain = |text: &str| text.replace('_', "").to_ascii_uppercase();
        self.fields.iter().position(|field| plain(field.text) == name)
    }

    /// Returns the value of a keyword.
    pub(super) fn value(&self, keyword: &str) -> Option<Cell<'a>> {
        let line = self.keywords.iter().find(|line| line[0].text.eq_ignore_ascii_case(keyword));
        line.and_then(|line| line.get(1).copied())
    }

    /// Returns whether a line before the columns is a single word, such as the kind of the file.
    pub(super) fn has_word(&self, word: &str) -> bool {
        self.keywords.iter().any(|line| line.len() == 1 && line[0].text.eq_ignore_ascii_case(word))
    }
}

/// The part of a table to which a line belongs.
enum Section {
    Keywords,
    Fields,
    /// After the names of the columns, where keywords such as `NUMBER_OF_SETS` follow.
    Between,
    Data,
}

/// Splits a text into its tables. Returns an error with the line and the column if a table is not
/// complete, or if the cells of its rows do not fit its columns.
pub(super) fn tables(text: &str) -> Result<Vec<CgatsTable<'_>>> {
    let mut tables = Vec::new();
    let (mut keywords, mut fields, mut rows, mut data_place) = (Vec::new(), Vec::new(), Vec::new(), (1, 1));
    let mut part: Vec<Cell<'_>> = Vec::new();
    let (mut section, mut cells) = (Section::Keywords, 0);
    for (index, line) in text.lines().enumerate() {
        let words = words(line, index + 1)?;
        let Some(first) = words.first() else { continue };
        cells += words.len();
        if cells > MAX_CELLS {
            let error = Error::input("a file with too many values").expected(format!("at most {MAX_CELLS}"));
            return Err(error.at(first.line, first.column));
        }
        match (first.text, &section) {
            (BEGIN_FORMAT, Section::Keywords) => {
                section = Section::Fields;
                fields = words[1..].to_vec();
            }
            ("END_DATA_FORMAT", Section::Fields) => {
                check_count(&fields, *first)?;
                section = Section::Between;
            }
            ("BEGIN_DATA", Section::Between) => {
                section = Section::Data;
                data_place = first.place();
            }
            ("END_DATA", Section::Data) => {
                if let Some(begun) = part.first() {
                    return Err(wrong_row(*begun, part.len(), fields.len()));
                }
                tables.push(CgatsTable {
                    keywords: std::mem::take(&mut keywords),
                    fields: std::mem::take(&mut fields),
                    rows: std::mem::take(&mut rows),
                    data_place,
                });
                section = Section::Keywords;
            }
            (_, Section::Keywords | Section::Between) => keywords.push(words),
            (_, Section::Fields) => fields.extend(words),
            (_, Section::Data) => {
                let row =
                    if words.len() == fields.len() { words } else { by_tabs(line, words, index + 1, fields.len()) };
                if let Some(begun) = part.first().filter(|_| part.len() + row.len() > fields.len()) {
                    return Err(wrong_row(*begun, part.len(), fields.len()));
                }
                if row.len() > fields.len() {
                    return Err(wrong_row(row[0], row.len(), fields.len()));
                }
                part.extend(row);
                if part.len() == fields.len() {
                    rows.push(std::mem::take(&mut part));
                }
            }
        }
    }
    let last = text.lines().count().max(1);
    let missing = match section {
        Section::Keywords if tables.is_empty() => BEGIN_FORMAT,
        Section::Keywords => return Ok(tables),
        Section::Fields => "END_DATA_FORMAT",
        Section::Between => "BEGIN_DATA",
        Section::Data => "END_DATA",
    };
    Err(Error::input("the file ends too early").expected(missing).at(last, 1))
}

fn check_count(fields: &[Cell<'_>], end: Cell<'_>) -> Result<()> {
    if !fields.is_empty() {
        return Ok(());
    }
    Err(Error::input("a table without columns").expected("names such as SAMPLE_ID").at(end.line, end.column))
}

fn wrong_row(begun: Cell<'_>, cells: usize, fields: usize) -> Error {
    let what = format!("a row of {cells} values");
    Error::input(what).expected(format!("{fields}, one for each column")).at(begun.line, begun.column)
}

/// Returns the words of a line: texts between blanks, or between quotes. A word that begins with
/// `#` begins a comment.
fn words(line: &str, number: usize) -> Result<Vec<Cell<'_>>> {
    let mut words = Vec::new();
    let (mut at, mut column) = (0, 1);
    while let Some(start) = line[at..].find(|c: char| !c.is_whitespace()).map(|skip| at + skip) {
        let rest = &line[start..];
        column += line[at..start].chars().count();
        if rest.starts_with('#') {
            break;
        }
        let (text, end) = if let Some(quoted) = rest.strip_prefix('"') {
            let Some(length) = quoted.find('"') else {
                let error = Error::input("a text without its second quotation mark");
                return Err(error.expected("a text between quotation marks").at(number, column));
            };
            (&quoted[..length], start + length + 2)
        } else {
            let length = rest.find(char::is_whitespace).unwrap_or(rest.len());
            (&rest[..length], start + length)
        };
        words.push(Cell { text, line: number, column });
        column += line[start..end].chars().count();
        at = end;
    }
    Ok(words)
}

/// Returns the cells between tabs if they fit the columns, because some programs write names with
/// blanks and without quotes; otherwise the words.
fn by_tabs<'a>(line: &'a str, words: Vec<Cell<'a>>, number: usize, fields: usize) -> Vec<Cell<'a>> {
    let line = line.trim_end_matches(['\t', '\r', ' ']);
    if line.split('\t').count() != fields {
        return words;
    }
    let mut column = 1;
    let cell = |text: &'a str| {
        let start = column;
        column += text.chars().count() + 1;
        Cell { text: text.trim().trim_matches('"'), line: number, column: start }
    };
    line.split('\t').map(cell).collect()
}
