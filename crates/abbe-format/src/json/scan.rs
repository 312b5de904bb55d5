//! A scanner of strict JSON (RFC 8259) that records positions and explains syntax errors.
//!
//! It accepts the same texts as `serde_json`, except that it refuses duplicate keys, and accepts
//! [`MAX_NESTING`] levels of nesting, one more than `serde_json`. The limit bounds its recursion.

use super::path::{push_key, quoted};
use super::positions::{JsonNode, Positions, SpannedValue, decode};
use super::{describe::shorten, text::line_column};
use abbe_spectra::error::Error;

/// The deepest allowed nesting of arrays and objects.
pub(super) const MAX_NESTING: usize = 128;

#[derive(Debug)]
pub(super) struct SyntaxError {
    /// Byte offset of the error in the text.
    pub(super) offset: usize,
    /// The error. It contains the JSON path of the innermost unfinished value.
    pub(super) error: Error,
}

type ScanResult<T> = Result<T, SyntaxError>;

pub(super) fn scan(text: &str) -> ScanResult<Positions> {
    let mut scanner = Scanner { text, at: 0, nodes: Vec::new(), open: Vec::new() };
    scanner.skip_blanks()?;
    if scanner.at == text.len() {
        return Err(scanner.malformed(0, "found nothing", "a JSON object"));
    }
    scanner.value()?;
    scanner.skip_blanks()?;
    if scanner.at < text.len() {
        let found = format!("found {} after the end", scanner.glimpse(scanner.at));
        return Err(scanner.malformed(scanner.at, found, "nothing more"));
    }
    Ok(Positions::new(scanner.nodes))
}

struct Scanner<'t> {
    text: &'t str,
    /// Byte offset of the next byte to read.
    at: usize,
    /// The nodes so far. In an unfinished node, `end` and `next` are `u32::MAX`.
    nodes: Vec<JsonNode>,
    /// The position inside each unfinished container, outermost first.
    open: Vec<OpenContainer>,
}

/// The position inside an unfinished container.
enum OpenContainer {
    /// In an object: the number of the current key's node, if the key was read.
    Object(Option<u32>),
    /// In an array: the index of the current element, and whether the scanner is inside it.
    Array(usize, bool),
}

impl Scanner<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Returns the JSON path of the innermost unfinished value.
    fn path(&self) -> String {
        let mut path = String::new();
        for level in &self.open {
            match level {
                OpenContainer::Object(None) => {}
                OpenContainer::Object(Some(id)) => {
                    let node = self.nodes[*id as usize];
                    let key = decode(&self.text[node.start as usize..node.end as usize]);
                    push_key(&mut path, &key);
                }
                OpenContainer::Array(index, true) => path += &format!("[{index}]"),
                OpenContainer::Array(_, false) => {}
            }
        }
        path
    }

    fn malformed(&self, offset: usize, found: impl AsRef<str>, expected: impl Into<String>) -> SyntaxError {
        let what = format!("malformed JSON: {}", found.as_ref());
        SyntaxError { offset, error: Error::input(what).expected(expected).on_path(self.path()) }
    }

    fn glimpse(&self, offset: usize) -> String {
        let rest = &self.text[offset..];
        let word: String = rest.chars().take_while(|c| is_word(*c)).take(40).collect();
        match rest.chars().next() {
            None => "the end of the file".into(),
            Some(_) if !word.is_empty() => word,
            Some('"') => self.glimpse_string(rest),
            Some(c) if c.is_ascii_graphic() => format!("`{c}`"),
            Some(c) => format!("the character U+{:04X}", u32::from(c)),
        }
    }

    /// Returns the first 40 characters of a string in quotes.
    fn glimpse_string(&self, rest: &str) -> String {
        let short: String = rest.chars().skip(1).take_while(|c| *c != '"' && !c.is_control()).take(40).collect();
        format!("\"{short}\"")
    }

    /// Skips white space. A comment is an error.
    fn skip_blanks(&mut self) -> ScanResult<()> {
        while let Some(b' ' | b'\t' | b'\n' | b'\r') = self.peek() {
            self.at += 1;
        }
        let rest = &self.text.as_bytes()[self.at..];
        if rest.starts_with(b"//") || rest.starts_with(b"/*") || rest.starts_with(b"#") {
            return Err(self.malformed(self.at, "found a comment", "strict JSON, which has none"));
        }
        Ok(())
    }

    /// Begins a node at the current offset and returns its number.
    fn begin(&mut self) -> usize {
        self.nodes.push(JsonNode { start: self.at as u32, end: u32::MAX, next: u32::MAX });
        self.nodes.len() - 1
    }

    /// Ends node number `id` at the current offset.
    fn finish(&mut self, id: usize) {
        let next = self.nodes.len() as u32;
        let node = &mut self.nodes[id];
        node.end = self.at as u32;
        node.next = next;
    }

    fn value(&mut self) -> ScanResult<()> {
        match self.peek() {
            Some(b'{') => self.container(OpenContainer::Object(None)),
            Some(b'[') => self.container(OpenContainer::Array(0, false)),
            Some(b'"') => self.string(),
            Some(_) | None => self.word(),
        }
    }

    fn container(&mut self, level: OpenContainer) -> ScanResult<()> {
        if self.open.len() >= MAX_NESTING {
            // The error has no path, because such a long path would be useless.
            let what = format!("found arrays and objects nested more than {MAX_NESTING} deep");
            let error = Error::input(what).expected(format!("at most {MAX_NESTING} levels"));
            return Err(SyntaxError { offset: self.at, error });
        }
        let id = self.begin();
        let is_object = matches!(level, OpenContainer::Object(_));
        let close = if is_object { b'}' } else { b']' };
        self.open.push(level);
        self.at += 1;
        self.skip_blanks()?;
        if self.peek() != Some(close) {
            self.contents(id, close, is_object)?;
        }
        self.at += 1;
        self.open.pop();
        self.finish(id);
        if is_object { self.refuse_duplicates(id) } else { Ok(()) }
    }

    /// Reads the contents of a container up to its closing bracket.
    fn contents(&mut self, id: usize, close: u8, is_object: bool) -> ScanResult<()> {
        loop {
            if is_object {
                self.key(id)?;
            } else if self.peek().is_none() {
                return Err(self.unfinished(id, close));
            }
            if let Some(OpenContainer::Array(_, inside)) = self.open.last_mut() {
                *inside = true;
            }
            self.value()?;
            self.leave_value();
            self.skip_blanks()?;
            match self.peek() {
                Some(byte) if byte == close => return Ok(()),
                Some(b',') => self.comma(close)?,
                None => return Err(self.unfinished(id, close)),
                Some(_) => {
                    let found = format!("found {} where a comma is missing", self.glimpse(self.at));
                    return Err(self.malformed(self.at, found, format!("`,` or `{}`", char::from(close))));
                }
            }
        }
    }

    /// Records that the current value of the innermost container is complete.
    fn leave_value(&mut self) {
        match self.open.last_mut() {
            Some(OpenContainer::Object(key)) => *key = None,
            Some(OpenContainer::Array(index, inside)) => (*index, *inside) = (*index + 1, false),
            None => {}
        }
    }

    /// Skips a comma. A closing bracket after the comma is an error.
    fn comma(&mut self, close: u8) -> ScanResult<()> {
        let comma = self.at;
        self.at += 1;
        self.skip_blanks()?;
        if self.peek() == Some(close) {
            let expected = format!("no comma before `{}`", char::from(close));
            return Err(self.malformed(comma, "found a trailing comma", expected));
        }
        Ok(())
    }

    /// Reads a key and its colon. `id` is the number of the object's node.
    fn key(&mut self, id: usize) -> ScanResult<()> {
        match self.peek() {
            Some(b'"') => {}
            None => return Err(self.unfinished(id, b'}')),
            Some(_) => {
                let found = format!("found {}", self.glimpse(self.at));
                return Err(self.malformed(self.at, found, "a key in double quotes"));
            }
        }
        let key = self.nodes.len() as u32;
        self.string()?;
        if let Some(level) = self.open.last_mut() {
            *level = OpenContainer::Object(Some(key));
        }
        self.skip_blanks()?;
        match self.peek() {
            Some(b':') => self.at += 1,
            None => return Err(self.unfinished(id, b'}')),
            Some(_) => {
                let found = format!("found {} after a key", self.glimpse(self.at));
                return Err(self.malformed(self.at, found, "`:`"));
            }
        }
        self.skip_blanks()?;
        if self.peek().is_none() { Err(self.unfinished(id, b'}')) } else { Ok(()) }
    }

    fn unfinished(&self, id: usize, close: u8) -> SyntaxError {
        let kind = if close == b'}' { "object" } else { "array" };
        let (line, column) = line_column(self.text, self.nodes[id].start as usize);
        let found = format!("the file ends inside the {kind} that opens at {line}:{column}");
        self.malformed(self.text.len(), found, format!("`{}`", char::from(close)))
    }

    fn refuse_duplicates(&mut self, id: usize) -> ScanResult<()> {
        let object = SpannedValue::in_list(self.text, &self.nodes, id as u32);
        let mut keys: Vec<_> = object.entries().map(|(key, _)| (key.content(), key.start())).collect();
        keys.sort_unstable();
        let twice = keys.windows(2).filter(|pair| pair[0].0 == pair[1].0).min_by_key(|pair| pair[1].1);
        let Some([(key, first), (_, second)]) = twice else { return Ok(()) };
        let (line, column) = line_column(self.text, *first);
        let what = format!("found the key {} a second time (first at {line}:{column})", quoted(key));
        let error = Error::input(what).expected("each key once");
        let mut path = self.path();
        push_key(&mut path, key);
        Err(SyntaxError { offset: *second, error: error.on_path(path) })
    }

    fn string(&mut self) -> ScanResult<()> {
        let id = self.begin();
        let opening = self.at;
        self.at += 1;
        loop {
            match self.peek() {
                Some(b'"') => break,
                Some(b'\\') => self.escape()?,
                Some(b'\n' | b'\r') => {
                    return Err(self.malformed(opening, "found a string that does not end on its line", "`\"`"));
                }
                Some(byte) if byte < 0x20 => {
                    let found = format!("found the control character U+{byte:04X} in a string");
                    return Err(self.malformed(self.at, found, format!("\\u{byte:04x}")));
                }
                Some(_) => self.at += 1,
                None => return Err(self.malformed(opening, "found a string that does not end", "`\"`")),
            }
        }
        self.at += 1;
        self.finish(id);
        Ok(())
    }

    fn escape(&mut self) -> ScanResult<()> {
        let start = self.at;
        let length = match self.text.as_bytes().get(self.at + 1) {
            Some(b'"' | b'\\' | b'/' | b'b' | b'f' | b'n' | b'r' | b't') => Some(2),
            Some(b'u') => match self.hex_escape(start) {
                Some(0xD800..=0xDBFF) if matches!(self.hex_escape(start + 6), Some(0xDC00..=0xDFFF)) => Some(12),
                Some(0xD800..=0xDFFF) => {
                    return Err(self.malformed(start, "found half of a surrogate pair in a string", "both halves"));
                }
                code => code.map(|_| 6),
            },
            Some(_) | None => None,
        };
        if let Some(length) = length {
            self.at += length;
            return Ok(());
        }
        let written: String = self.text[start..].chars().take(2).collect();
        let expected = "one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\u and four hexadecimal digits";
        Err(self.malformed(start, format!("found the escape `{written}` in a string"), expected))
    }

    /// Returns the UTF-16 code unit of the escape `\u` and four hexadecimal digits at an offset.
    fn hex_escape(&self, offset: usize) -> Option<u32> {
        let digits = self.text.get(offset..offset + 6)?.strip_prefix("\\u")?;
        let all_hex = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        if all_hex { u32::from_str_radix(digits, 16).ok() } else { None }
    }

    /// Reads a number, `true`, `false` or `null`. Any other word is an error.
    fn word(&mut self) -> ScanResult<()> {
        let start = self.at;
        let word = self.text[start..].split(|c| !is_word(c)).next().unwrap_or_default();
        if !(is_number(word) || matches!(word, "true" | "false" | "null")) {
            return Err(self.bad_word(start, word));
        }
        if word.parse::<f64>().is_ok_and(f64::is_infinite) {
            let what = format!("found {}, which is beyond the largest number", shorten(word));
            let error = Error::input(what).expected("a number of at most 1.8e308").on_path(self.path());
            return Err(SyntaxError { offset: start, error });
        }
        let id = self.begin();
        self.at += word.len();
        self.finish(id);
        Ok(())
    }

    fn bad_word(&self, start: usize, word: &str) -> SyntaxError {
        let short = shorten(word);
        let bare = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
        if matches!(bare.as_str(), "nan" | "inf" | "infinity") {
            return self.malformed(start, format!("found {short}"), "a finite number");
        }
        if matches!(bare.as_str(), "true" | "false" | "null" | "none") && bare == word.to_ascii_lowercase() {
            let right = if bare == "none" { "null" } else { &bare };
            return self.malformed(start, format!("found {short}"), right);
        }
        match word.chars().next() {
            Some('0'..='9' | '+' | '-' | '.') => {
                self.malformed(start, format!("found {short}"), "a number such as 12, -0.5 or 1e-3")
            }
            Some(_) => {
                let expected = format!("a JSON value (a string needs double quotes: \"{short}\")");
                self.malformed(start, format!("found {short}"), expected)
            }
            None if self.text[start..].starts_with('\'') => {
                self.malformed(start, "found a single quote", "strings in double quotes")
            }
            None => self.malformed(start, format!("found {}", self.glimpse(start)), "a JSON value"),
        }
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '+' | '-' | '.')
}

/// Returns whether a word is a number in the grammar of JSON:
/// `-? (0 | [1-9][0-9]*) (. [0-9]+)? ([eE] [+-]? [0-9]+)?`.
fn is_number(word: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let unsigned = word.strip_prefix('-').unwrap_or(word);
    let (mantissa, exponent) = match unsigned.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent.strip_prefix(['+', '-']).unwrap_or(exponent))),
        None => (unsigned, None),
    };
    let parts = mantissa.split_once('.');
    let (whole, fraction) = parts.map_or((mantissa, None), |(whole, fraction)| (whole, Some(fraction)));
    digits(whole)
        && (whole == "0" || !whole.starts_with('0'))
        && fraction.is_none_or(digits)
        && exponent.is_none_or(digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the offset and the message of the syntax error in a text.
    fn message(text: &str) -> String {
        let SyntaxError { offset, error } = scan(text).unwrap_err();
        format!("{offset}: {error}")
    }

    #[test]
    fn numbers_follow_the_grammar_of_json() {
        for good in ["0", "-0", "12", "0.5", "-1.25e-3", "1E5", "1e+5", "10.0", "1e308", "1e-999"] {
            assert!(is_number(good) && scan(good).is_ok(), "{good}");
        }
        for bad in ["", "-", "01", "00", "1.", ".5", "+1", "1e", "1e+", "0x10", "1_000", "1e5.0", "--1", "1.2.3", "١"]
        {
            assert!(!is_number(bad) && scan(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn deep_nesting_is_an_error_and_not_a_stack_overflow() {
        let nested = |depth: usize| "[".repeat(depth) + &"]".repeat(depth);
        assert!(scan(&nested(MAX_NESTING)).is_ok());
        let deep = "128: found arrays and objects nested more than 128 deep; expected at most 128 levels";
        assert_eq!(message(&nested(MAX_NESTING + 1)), deep);
        assert_eq!(message(&"[".repeat(10_000_000)), deep);
        assert_eq!(message(&"{\"a\":".repeat(1000)).split(": ").nth(1), deep.split(": ").nth(1));
    }

    #[test]
    fn escapes_are_checked() {
        for good in [r#""\"\\\/\b\f\n\r\t""#, r#""\u00e9\uD83c\uDF08""#] {
            assert!(scan(good).is_ok(), "{good}");
        }
        for bad in [r#""\x""#, r#""\u12""#, r#""\u12é4""#, r#""\ud83c""#, r#""\udf08\ud83c""#, r#""\ud83c\n""#, r#""\"#]
        {
            assert!(scan(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn positions_are_spans_in_the_order_of_the_text() {
        let text = r#" {"a": [1, {"b": "x"}], "c": null} "#;
        let positions = scan(text).unwrap();
        let root = positions.root(text);
        assert_eq!(root.written(), text.trim());
        let entries: Vec<_> = root.entries().map(|(key, value)| (key.content(), value.written())).collect();
        assert_eq!(entries, [("a".into(), r#"[1, {"b": "x"}]"#), ("c".into(), "null")]);
        let paths: Vec<_> = positions.ids().map(|id| root.path_to(id)).collect();
        assert_eq!(paths, ["", "a", "a", "a[0]", "a[1]", "a[1].b", "a[1].b", "c", "c"]);
        let keys: Vec<_> = positions.ids().filter(|id| root.is_key(*id)).collect();
        assert_eq!(keys, [1, 5, 7]);
    }
}
