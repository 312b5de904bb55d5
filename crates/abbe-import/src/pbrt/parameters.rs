//! The parameters of a pbrt directive.

use super::token::{Place, Token, Tokens};
use abbe_format::FileAccess;
use abbe_spectra::error::Result;
use std::cell::Cell;
use std::path::Path;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Strings(Vec<String>),
    Flags(Vec<bool>),
}

/// One parameter, such as `"float radius" [1]`.
#[derive(Debug, Clone)]
pub(super) struct Parameter {
    /// The type, such as "float" or "rgb".
    pub(super) kind: String,
    pub(super) name: String,
    pub(super) values: Values,
    pub(super) place: Place,
    /// True if a reader has asked for the parameter.
    used: Cell<bool>,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Parameters {
    list: Vec<Parameter>,
}

impl Parameter {
    /// Returns the numbers, or an error if the values are of another type.
    pub(super) fn numbers(&self) -> Result<&[f64]> {
        if let Values::Numbers(numbers) = &self.values { Ok(numbers) } else { Err(self.fault("numbers")) }
    }

    /// Returns the one string, or an error if there is not exactly one.
    pub(super) fn string(&self) -> Result<&str> {
        match &self.values {
            Values::Strings(strings) if strings.len() == 1 => Ok(&strings[0]),
            Values::Strings(_) | Values::Numbers(_) | Values::Flags(_) => Err(self.fault("one string")),
        }
    }

    /// Returns an error that says what the parameter must be.
    pub(super) fn fault(&self, expected: &str) -> abbe_spectra::error::Error {
        self.place.error(format!("wrong value of \"{} {}\"", self.kind, self.name)).expected(expected)
    }
}

impl Parameters {
    pub(super) fn read(tokens: &mut Tokens) -> Result<Self> {
        let mut list = Vec::new();
        while let Some(Token::Quoted(declaration)) = tokens.peek()? {
            tokens.read()?;
            let place = tokens.place();
            let mut words = declaration.split_whitespace();
            let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
                let error = place.error(format!("found \"{declaration}\""));
                return Err(error.expected("the type and the name of a parameter"));
            };
            let (kind, name) = (kind.to_string(), name.to_string());
            let values = read_values(tokens, &declaration)?;
            list.push(Parameter { kind, name, values, place, used: Cell::new(false) });
        }
        Ok(Self { list })
    }

    /// Appends parameters that hold if this list does not contain them.
    pub(super) fn add_defaults(&mut self, defaults: &Self) {
        for default in &defaults.list {
            if !self.list.iter().any(|own| own.name == default.name) {
                // An attribute need not concern every directive.
                let used = Cell::new(true);
                self.list.push(Parameter { used, ..default.clone() });
            }
        }
    }

    /// Returns a parameter, and marks it as used.
    pub(super) fn get(&self, name: &str) -> Option<&Parameter> {
        let found = self.list.iter().find(|parameter| parameter.name == name)?;
        found.used.set(true);
        Some(found)
    }

    /// Marks parameters as used that have no meaning for the converted scene.
    pub(super) fn ignore(&self, names: &[&str]) {
        self.list.iter().filter(|known| names.contains(&known.name.as_str())).for_each(|known| known.used.set(true));
    }

    /// Marks all parameters as used, because the whole directive is left out.
    pub(super) fn ignore_all(&self) {
        self.list.iter().for_each(|known| known.used.set(true));
    }

    pub(super) fn number(&self, name: &str) -> Result<Option<f64>> {
        let Some(parameter) = self.get(name) else { return Ok(None) };
        match parameter.numbers()? {
            [number] if number.is_finite() => Ok(Some(*number)),
            _ => Err(parameter.fault("one number")),
        }
    }

    /// Returns a number, or `default` if the parameter is absent.
    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64> {
        Ok(self.number(name)?.unwrap_or(default))
    }

    pub(super) fn tuple<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>> {
        let Some(parameter) = self.get(name) else { return Ok(None) };
        let tuple = parameter.numbers()?.try_into().map_err(|_| parameter.fault(&format!("{N} numbers")))?;
        Ok(Some(tuple))
    }

    pub(super) fn tuples<const N: usize>(&self, name: &str) -> Result<Option<Vec<[f64; N]>>> {
        let Some(parameter) = self.get(name) else { return Ok(None) };
        let (groups, rest) = parameter.numbers()?.as_chunks::<N>();
        let fault = || parameter.fault(&format!("groups of {N} numbers"));
        if rest.is_empty() { Ok(Some(groups.to_vec())) } else { Err(fault()) }
    }

    pub(super) fn indices(&self, name: &str) -> Result<Option<Vec<u32>>> {
        let Some(parameter) = self.get(name) else { return Ok(None) };
        let index = |&x: &f64| {
            let whole = x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
            if whole { Ok(x as u32) } else { Err(parameter.fault("whole numbers of at least 0")) }
        };
        parameter.numbers()?.iter().map(index).collect::<Result<Vec<u32>>>().map(Some)
    }

    pub(super) fn string(&self, name: &str) -> Result<Option<&str>> {
        self.get(name).map(Parameter::string).transpose()
    }

    /// Returns the name of an existing file, of which the scene file will contain the path.
    pub(super) fn file(&self, name: &str, base: &Path, file_access: FileAccess) -> Result<Option<&str>> {
        let Some(parameter) = self.get(name) else { return Ok(None) };
        let file = parameter.string()?;
        match file_access.file(base, Path::new(file)) {
            Ok(path) if path.is_file() => Ok(Some(file)),
            Ok(_) => Err(parameter.place.error(format!("the file \"{file}\" does not exist"))),
            Err(error) => Err(parameter.place.error(error.what)),
        }
    }

    pub(super) fn strings(&self, name: &str) -> Result<Option<&[String]>> {
        let Some(parameter) = self.get(name) else { return Ok(None) };
        if let Values::Strings(strings) = &parameter.values {
            Ok(Some(strings))
        } else {
            Err(parameter.fault("strings"))
        }
    }

    /// Returns a truth value, or `default` if the parameter is absent.
    pub(super) fn flag_or(&self, name: &str, default: bool) -> Result<bool> {
        let Some(parameter) = self.get(name) else { return Ok(default) };
        match &parameter.values {
            Values::Flags(flags) if flags.len() == 1 => Ok(flags[0]),
            // Older files quote truth values.
            Values::Strings(strings) if *strings == ["true"] => Ok(true),
            Values::Strings(strings) if *strings == ["false"] => Ok(false),
            Values::Strings(_) | Values::Numbers(_) | Values::Flags(_) => Err(parameter.fault("true or false")),
        }
    }

    /// Returns the parameters that no reader has asked for.
    pub(super) fn unused(&self) -> impl Iterator<Item = &Parameter> {
        self.list.iter().filter(|parameter| !parameter.used.get())
    }
}

/// Reads one value, or a list of values of one type.
fn read_values(tokens: &mut Tokens, declaration: &str) -> Result<Values> {
    let (mut numbers, mut strings, mut flags) = (Vec::new(), Vec::new(), Vec::new());
    let is_list = tokens.peek()? == Some(Token::Open);
    if is_list {
        tokens.read()?;
    }
    loop {
        match tokens.read()? {
            Some(Token::Number(number)) => numbers.push(number),
            Some(Token::Quoted(string)) => strings.push(string),
            Some(Token::Word(word)) if word == "true" || word == "false" => flags.push(word == "true"),
            Some(Token::Close) if is_list => break,
            _ => {
                return Err(tokens.place().error(format!("\"{declaration}\" has no value, or its list is not closed")));
            }
        }
        if !is_list {
            break;
        }
    }
    let values = match (numbers.is_empty(), strings.is_empty(), flags.is_empty()) {
        (true, false, true) => Values::Strings(strings),
        (true, true, false) => Values::Flags(flags),
        (_, true, true) => Values::Numbers(numbers),
        _ => return Err(tokens.place().error(format!("\"{declaration}\" mixes values of different types"))),
    };
    Ok(values)
}
