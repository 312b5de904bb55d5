//! Random changes of files: bits, lengths and numbers of any file; words, lines and numbers of a
//! text; values, keys and branches of JSON.

use abbe_spectra::math::random::{Purpose, Seed, Stream};
use serde_json::{Map, Number, Value};

/// Numbers at the limits of common types, in text form.
const NUMBERS: [&str; 22] = [
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "255",
    "65536",
    "2147483648",
    "-2147483649",
    "4294967295",
    "4294967296",
    "1e9",
    "18446744073709551615",
    "99999999999999999999",
    "1e38",
    "1e308",
    "-1e308",
    "1e-320",
    "0.1",
    "nan",
    "inf",
    "0x7f",
];

/// Numbers at the limits of common types in binary, for fields of 1, 2, 4 and 8 bytes.
const WORDS: [u64; 12] = [
    0,
    1,
    2,
    0x7f,
    0xff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7ff0_0000_0000_0000,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// Inputs are cut to this many bytes.
const LONGEST: usize = 1 << 15;

/// A repeatable source of changes.
pub(crate) struct Mutator(Stream);

impl Mutator {
    pub(crate) fn new(seed: u64, target: &str, case: u64) -> Self {
        let name = target.bytes().fold(seed, |hash, byte| hash.wrapping_mul(257).wrapping_add(u64::from(byte)));
        Self(Stream::new(Seed::new(name), Purpose::SurveyPhoton, case, seed))
    }

    /// Returns a number below `count`.
    fn below(&mut self, count: usize) -> usize {
        (self.0.uniform() * count as f64) as usize
    }

    fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }

    /// Returns one of the valid inputs with one to four changes.
    pub(crate) fn change(&mut self, good: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = self.pick(good).clone();
        for _ in 0..1 + self.below(4) {
            let json = serde_json::from_slice::<Value>(&bytes).ok();
            bytes = match (json, std::str::from_utf8(&bytes)) {
                (Some(value), _) if self.below(4) > 0 => self.json(value, good),
                (_, Ok(text)) if self.below(4) > 0 => self.text(text),
                (Some(_) | None, Ok(_) | Err(_)) => self.binary(bytes, good),
            };
            bytes.truncate(LONGEST);
        }
        bytes
    }

    fn binary(&mut self, mut bytes: Vec<u8>, good: &[Vec<u8>]) -> Vec<u8> {
        // Headers matter most, so half of all changes fall into the first 512 bytes.
        let reach = if self.below(2) == 0 { bytes.len().min(512) } else { bytes.len() };
        let at = self.below(reach.max(1)).min(bytes.len());
        let end = (at + 1 + self.below(64)).min(bytes.len());
        match self.below(8) {
            0 | 1 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            2 if at < bytes.len() => bytes[at] = self.below(256) as u8,
            3 | 4 => {
                let word = self.pick(&WORDS).to_le_bytes();
                let size = *self.pick(&[1, 2, 4, 8]);
                // Numbers in headers are aligned.
                let from = at / size * size;
                bytes.iter_mut().skip(from).take(size).zip(word).for_each(|(byte, new)| *byte = new);
            }
            5 => drop(bytes.drain(at..end)),
            6 => {
                let copy = bytes[at..end].to_vec();
                let to = self.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            _ if self.below(2) == 0 => bytes.truncate(at),
            _ => {
                let other = self.pick(good);
                let from = self.below(other.len() + 1);
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
        }
        bytes
    }

    fn text(&mut self, text: &str) -> Vec<u8> {
        let mut lines: Vec<String> = text.split_inclusive('\n').map(str::to_string).collect();
        if lines.is_empty() {
            return self.pick(&NUMBERS).as_bytes().to_vec();
        }
        let at = self.below(lines.len());
        match self.below(6) {
            0 => drop(lines.remove(at)),
            1 => lines.insert(at, lines[at].clone()),
            2 => {
                let other = self.below(lines.len());
                lines.swap(at, other);
            }
            3 => lines[at] = lines[at].repeat(1 + self.below(1000.min(LONGEST / lines[at].len()))),
            _ => lines[at] = self.word(&lines[at]),
        }
        lines.concat().into_bytes()
    }

    /// Returns a line with one word removed, doubled or replaced by a number.
    fn word(&mut self, line: &str) -> String {
        let mut words: Vec<&str> = line.split_inclusive([' ', '\t', '/', ',', ':', '"', '<', '>', '=']).collect();
        if words.is_empty() {
            return line.to_string();
        }
        let at = self.below(words.len());
        let number = format!("{} ", self.pick(&NUMBERS));
        match self.below(4) {
            0 => drop(words.remove(at)),
            1 => words.insert(at, words[at]),
            _ => words[at] = &number,
        }
        words.concat()
    }

    fn json(&mut self, mut value: Value, good: &[Vec<u8>]) -> Vec<u8> {
        let branch = serde_json::from_slice::<Value>(self.pick(good).as_slice())
            .map_or(Value::Null, |mut other| self.inside(&mut other).take());
        let new = self.value(branch);
        let place = self.inside(&mut value);
        match (place, self.below(4)) {
            (Value::Object(entries), 0) => self.entries(entries, new),
            (Value::Array(items), 0 | 1) => {
                let at = self.below(items.len() + 1);
                items.insert(at, new);
            }
            (Value::Array(items), 2) => {
                let at = self.below(items.len().max(1));
                items.truncate(at);
            }
            (place, _) => *place = new,
        }
        value.to_string().into_bytes()
    }

    /// Returns a value inside another one; deeper values are more likely.
    fn inside<'v>(&mut self, value: &'v mut Value) -> &'v mut Value {
        let count = match &*value {
            Value::Object(entries) => entries.len(),
            Value::Array(items) => items.len(),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => 0,
        };
        if count == 0 || self.below(6) == 0 {
            return value;
        }
        let at = self.below(count);
        let next = match value {
            Value::Object(entries) => entries.values_mut().nth(at),
            Value::Array(items) => items.get_mut(at),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => None,
        };
        self.inside(next.expect("there are so many"))
    }

    fn entries(&mut self, entries: &mut Map<String, Value>, new: Value) {
        let keys: Vec<String> = entries.keys().cloned().collect();
        let Some(key) = (!keys.is_empty()).then(|| self.pick(&keys).clone()) else { return };
        match self.below(3) {
            0 => drop(entries.remove(&key)),
            1 => drop(entries.insert(format!("{key}x"), new)),
            _ => drop(entries.insert(key, new)),
        }
    }

    /// Returns a value of any kind; `branch` is taken from another place.
    fn value(&mut self, branch: Value) -> Value {
        let number = |text: &str| text.parse::<Number>().map_or(Value::String(text.to_string()), Value::Number);
        match self.below(10) {
            0 => Value::Null,
            1 => Value::Bool(true),
            2 => Value::String(String::new()),
            3 => Value::Array(Vec::new()),
            4 => (0..1 + self.below(400)).fold(Value::Null, |inner, _| Value::Array(vec![inner])),
            5 => Value::String("µ\u{0}\"\\../".repeat(1 + self.below(50))),
            6 | 7 => number(self.pick::<&str>(&NUMBERS)),
            _ => branch,
        }
    }
}
