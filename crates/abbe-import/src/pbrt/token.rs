//! Splits the text of a pbrt file into tokens.

use abbe_spectra::error::{Error, Result};
use std::path::PathBuf;
use std::rc::Rc;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub(super) file: Rc<PathBuf>,
    /// The number of the line. The first line has the number 1.
    pub(super) line: usize,
}

impl Place {
    pub(super) fn error(&self, what: impl Into<String>) -> Error {
        Error::input(format!("line {}: {}", self.line, what.into())).in_file(&self.file)
    }

    /// Returns the name of the file and the line, for remarks.
    pub(super) fn text(&self) -> String {
        format!("{}:{}", self.file.file_name().unwrap_or_default().to_string_lossy(), self.line)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    /// A string in quotes, without the quotes.
    Quoted(String),
    Number(f64),
    /// The start of a list.
    Open,
    /// The end of a list.
    Close,
    /// A directive, or `true` or `false`.
    Word(String),
}

#[derive(Debug)]
pub(super) struct Tokens {
    text: String,
    /// The byte at which the next token starts, after blanks and comments.
    next: usize,
    place: Place,
}

impl Tokens {
    pub(super) fn new(text: String, file: PathBuf) -> Self {
        Self { text, next: 0, place: Place { file: Rc::new(file), line: 1 } }
    }

    /// Returns the line of the last token that was read.
    pub(super) fn place(&self) -> Place {
        self.place.clone()
    }

    /// Returns the next token without reading it, or `None` at the end of the file.
    pub(super) fn peek(&mut self) -> Result<Option<Token>> {
        let (next, place) = (self.next, self.place.clone());
        let token = self.read();
        (self.next, self.place) = (next, place);
        token
    }

    /// Reads the next token. Returns `None` at the end of the file.
    pub(super) fn read(&mut self) -> Result<Option<Token>> {
        self.skip_blanks();
        let rest = &self.text[self.next..];
        let Some(first) = rest.chars().next() else { return Ok(None) };
        let (token, length) = match first {
            '[' => (Token::Open, 1),
            ']' => (Token::Close, 1),
            '"' => {
                let (text, length) = quoted(rest).ok_or_else(|| self.place.error("a string is not closed"))?;
                (Token::Quoted(text), length)
            }
            _ => {
                let ends = |c: char| c.is_whitespace() || matches!(c, '[' | ']' | '"' | '#');
                let word = &rest[..rest.find(ends).unwrap_or(rest.len())];
                let number = word.parse().ok().filter(|number: &f64| number.is_finite());
                (number.map_or_else(|| Token::Word(word.to_string()), Token::Number), word.len())
            }
        };
        self.next += length;
        Ok(Some(token))
    }

    fn skip_blanks(&mut self) {
        let mut in_comment = false;
        for (offset, c) in self.text[self.next..].char_indices() {
            match c {
                '\n' => (self.place.line, in_comment) = (self.place.line + 1, false),
                '#' => in_comment = true,
                _ if in_comment || c.is_whitespace() => {}
                _ => {
                    self.next += offset;
                    return;
                }
            }
        }
        self.next = self.text.len();
    }

    pub(super) fn string(&mut self, directive: &str) -> Result<String> {
        match self.read()? {
            Some(Token::Quoted(string)) => Ok(string),
            _ => Err(self.place().error(format!("{directive} needs a string in quotes"))),
        }
    }

    /// Reads the numbers that follow a directive, with or without brackets.
    pub(super) fn numbers<const N: usize>(&mut self, directive: &str) -> Result<[f64; N]> {
        let in_brackets = self.peek()? == Some(Token::Open);
        if in_brackets {
            self.read()?;
        }
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let Some(Token::Number(found)) = self.read()? else {
                return Err(self.place().error(format!("{directive} needs {N} numbers")));
            };
            *number = found;
        }
        if in_brackets && self.read()? != Some(Token::Close) {
            return Err(self.place().error(format!("{directive} needs {N} numbers")));
        }
        Ok(numbers)
    }
}

/// Returns the string in quotes at the start of a text, and its length in bytes with the quotes.
/// Returns `None` if the string does not end on its line.
fn quoted(text: &str) -> Option<(String, usize)> {
    let mut string = String::new();
    let mut chars = text.char_indices().skip(1);
    while let Some((offset, c)) = chars.next() {
        match c {
            '"' => return Some((string, offset + 1)),
            '\n' => return None,
            '\\' => string.push(match chars.next()?.1 {
                'n' => '\n',
                't' => '\t',
                other => other,
            }),
            _ => string.push(c),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_have_lines_and_comments_are_skipped() {
        let text = "Shape \"sphere\" # \"a comment\" [\n \"float radius\"[.5 -1e-3]true";
        let mut tokens = Tokens::new(text.into(), "a.pbrt".into());
        let mut found = Vec::new();
        while let Some(token) = tokens.read().unwrap() {
            found.push((token, tokens.place().line));
        }
        let quoted = |text: &str| Token::Quoted(text.into());
        let expected = [
            (Token::Word("Shape".into()), 1),
            (quoted("sphere"), 1),
            (quoted("float radius"), 2),
            (Token::Open, 2),
            (Token::Number(0.5), 2),
            (Token::Number(-1e-3), 2),
            (Token::Close, 2),
            (Token::Word("true".into()), 2),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn an_open_string_is_an_error_with_its_line() {
        let mut tokens = Tokens::new("\n\n\"abc\n\"".into(), "a.pbrt".into());
        let error = tokens.read().unwrap_err().to_string();
        assert!(error.contains("line 3") && error.contains("not closed"), "{error}");
    }
}
