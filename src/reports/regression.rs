//! The regression set for code that converts spectra to colours, and the colours of a converter.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use abbe_session::output::file;
use abbe_spectra::colour::regress::{
    CaseGroup, ColourForm, FormColours, RegressionCase, RegressionSet, RegressionSpectrum, RegressionTolerances,
    SpectrumRole,
};
use abbe_spectra::error::{Error, Result, nearest_name};
use abbe_spectra::spectrum::{BAND_NM, OBSERVER_NAMES, Observer};
use abbe_spectra::text::without_byte_order_mark;
use serde::Serialize;
use serde_json::Value;

/// The keys of a case in JSON besides its colours.
const CASE_KEYS: [&str; 5] = ["group", "light", "reflectance", "excitation", "emission"];

const CONVENTIONS: [&str; 6] = [
    "XYZ is the sum over 360, 361, ... 830 nm of value times observer, plus the power of each line times the observer, interpolated linearly at the line",
    "a case with a reflectance uses the product of the light and the reflectance; at a line, the reflectance is interpolated linearly",
    "a light has Y = 100; under a light, the perfect diffuser has Y = 100",
    "linear_srgb is XYZ / 100 times the inverse of the matrix of the sRGB primaries and the white x = 0.3127, y = 0.3290 (IEC 61966-2-1), without adaptation and not clipped",
    "srgb is linear_srgb clipped to 0-1 and encoded with the curve of IEC 61966-2-1",
    "delta_e_2000 is computed with D65 as white",
];

/// The conventions of the second set besides [`CONVENTIONS`].
const MORE_CONVENTIONS: [&str; 8] = [
    "observers contains the colour-matching functions of the other observers; xyz_cie1964, xyz_cie2015_2 and xyz_cie2015_10 are scaled to Y = 100 for the same observer",
    "a case with an excitation adds fluorescence: the power of the light times the excitation, summed over the samples and the lines, is multiplied by the emission and added to the reflected light",
    "linear_display_p3 and linear_rec2020 are XYZ / 100 times the inverse of the matrix of the primaries of SMPTE RP 431-2 and of ITU-R BT.2020 and the white x = 0.3127, y = 0.3290",
    "display_p3 has the curve of IEC 61966-2-1, and rec2020 has the curve of ITU-R BT.2020 with alpha = 1.0992968; both are clipped to 0-1",
    "acescg is linear with the primaries AP1 and the white x = 0.32168, y = 0.33767, to which colours are adapted from D65 by Bradford's transform",
    "lab is CIE 1976 L*, a*, b* with XYZ of the light as the white, and delta_e_2000 uses it as it is",
    "xyz_bradford and xyz_cat16 are XYZ of the CIE 1931 observer, adapted from the light to D65 by Bradford's transform and by CAT16 with complete adaptation",
    "D65 is the chromaticity x = 0.3127, y = 0.3290",
];

/// The set with its conventions and all values, for converters in other languages.
#[derive(Debug, Serialize)]
pub struct ExportedSet {
    /// The name of the set, with its version.
    pub set: &'static str,
    /// Sentences that define the expected values.
    pub conventions: Vec<&'static str>,
    pub tolerances: RegressionTolerances,
    /// The wavelengths of the samples in nm.
    pub nm: Vec<f64>,
    /// x̄, ȳ and z̄ of the CIE 1931 observer at these wavelengths.
    pub observer: Vec<[f64; 3]>,
    /// The same of the other observers, if the set contains their colours.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub observers: BTreeMap<&'static str, Vec<[f64; 3]>>,
    /// The spectra that the cases name.
    pub spectra: Vec<ExportedSpectrum>,
    /// The cases with their expected colours.
    pub cases: Vec<ExportedCase>,
}

#[derive(Debug, Serialize)]
pub struct ExportedSpectrum {
    /// The name that the cases use.
    pub name: &'static str,
    pub kind: SpectrumRole,
    /// The values at the wavelengths of the set, without the lines.
    pub values: Vec<f64>,
    pub lines: Vec<ExportedLine>,
}

#[derive(Debug, Serialize)]
pub struct ExportedLine {
    /// The wavelength in nm.
    pub nm: f64,
    /// The power, in the unit of the samples times nm.
    pub power: f64,
}

#[derive(Debug, Serialize)]
pub struct ExportedCase {
    pub id: &'static str,
    pub group: CaseGroup,
    pub light: &'static str,
    /// The name of the reflectance. `None` for the colour of the light itself.
    pub reflectance: Option<&'static str>,
    /// The names of the excitation and of the emission of a fluorescent sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<&'static str>,
    #[serde(flatten)]
    pub expected: &'static FormColours,
}

/// Returns a set, with samples at each whole nm.
pub fn exported_set(set: &'static RegressionSet) -> ExportedSet {
    let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let spectrum = |entry: &'static RegressionSpectrum| ExportedSpectrum {
        name: &entry.name,
        kind: entry.role,
        values: nm.iter().map(|&nm| entry.spectrum.continuum_at(nm)).collect(),
        lines: lines(entry).collect(),
    };
    let case = |case: &'static RegressionCase| {
        let part = |i: usize| case.fluorescence.as_ref().map(|names| names[i].as_str());
        ExportedCase {
            id: &case.id,
            group: case.group,
            light: &case.light,
            reflectance: case.reflectance.as_deref(),
            excitation: part(0),
            emission: part(1),
            expected: &case.expected,
        }
    };
    let bars = |observer: &Observer| nm.iter().map(|&nm| observer.xyz_bar(nm)).collect();
    let named = |name: &&'static str| (*name, bars(Observer::by_name(name).expect("the names are known")));
    let is_first = set.name == RegressionSet::first().name;
    let more: (&[&str], &[&str]) = if is_first { (&[], &[]) } else { (&MORE_CONVENTIONS, &OBSERVER_NAMES[1..]) };
    ExportedSet {
        set: set.name,
        conventions: CONVENTIONS.iter().chain(more.0).copied().collect(),
        tolerances: RegressionTolerances::default(),
        observer: bars(Observer::cie1931()),
        observers: more.1.iter().map(named).collect(),
        spectra: set.spectra.iter().map(spectrum).collect(),
        cases: set.cases.iter().map(case).collect(),
        nm,
    }
}

/// Returns the lines of a spectrum. The wavelength of a line has no rounding errors.
fn lines(entry: &RegressionSpectrum) -> impl Iterator<Item = ExportedLine> {
    let rounded = |nm: f64| (nm * 1e6).round() / 1e6;
    entry
        .spectrum
        .line_segments()
        .iter()
        .map(move |line| ExportedLine { nm: rounded(line.centre()), power: line.power })
}

/// The names of the files of a set.
pub const SET_FILES: [&str; 6] = ["set.json", "spectra.csv", "lines.csv", "observer.csv", "cases.csv", "expected.csv"];

/// Writes a set to a folder, as JSON and CSV files. Returns the number of cases, or an error if the
/// folder or a file cannot be written.
pub fn write_set(set: &'static RegressionSet, folder: &Path) -> Result<usize> {
    std::fs::create_dir_all(folder)
        .map_err(|error| Error::machine(format!("cannot be created: {error}")).in_file(folder))?;
    let forms = set.forms;
    let set = exported_set(set);
    let row = |cells: Vec<String>| cells.join(",") + "\n";
    let names = set.spectra.iter().map(|spectrum| spectrum.name.to_string());
    let mut spectra = row(std::iter::once("nm".to_string()).chain(names).collect());
    let mut observer = "nm,x_bar,y_bar,z_bar".to_string();
    set.observers.keys().for_each(|name| observer += &format!(",x_{name},y_{name},z_{name}"));
    observer.push('\n');
    for (i, nm) in set.nm.iter().enumerate() {
        let values = set.spectra.iter().map(|spectrum| spectrum.values[i]);
        spectra += &row(std::iter::once(*nm).chain(values).map(|value| value.to_string()).collect());
        let bars = std::iter::once(&set.observer).chain(set.observers.values()).flat_map(|bars| bars[i]);
        observer += &row(std::iter::once(*nm).chain(bars).map(|value| value.to_string()).collect());
    }
    let mut lines = "spectrum,nm,power\n".to_string();
    for spectrum in &set.spectra {
        for ExportedLine { nm, power } in &spectrum.lines {
            let _ = writeln!(lines, "{},{nm},{power}", spectrum.name);
        }
    }
    let fluoresces = set.cases.iter().any(|case| case.excitation.is_some());
    let mut cases = format!("id,group,light,reflectance{}\n", if fluoresces { ",excitation,emission" } else { "" });
    let mut expected = column_names(forms).join(",") + "\n";
    for case in &set.cases {
        let mut names = vec![case.id, case.group.name(), case.light, case.reflectance.unwrap_or_default()];
        if fluoresces {
            names.extend([case.excitation, case.emission].map(Option::unwrap_or_default));
        }
        cases += &row(names.into_iter().map(str::to_string).collect());
        let numbers = case.expected.iter().flat_map(|(_, colour)| colour.map(|value| value.to_string()));
        expected += &row(std::iter::once(case.id.to_string()).chain(numbers).collect());
    }
    let json = serde_json::to_string(&set).expect("the set has text keys") + "\n";
    for (name, text) in SET_FILES.into_iter().zip([json, spectra, lines, observer, cases, expected]) {
        file::write_whole(&folder.join(name), text.as_bytes())?;
    }
    Ok(set.cases.len())
}

/// Returns the column of the ids and those of some forms.
fn column_names(forms: &[ColourForm]) -> Vec<String> {
    std::iter::once("id".to_string()).chain(forms.iter().flat_map(|form| form.columns())).collect()
}

/// Reads the named colours of a converter for a set, as JSON if the file's name ends in `.json`,
/// and as CSV otherwise. Returns an error if the file cannot be read, or has another form.
pub fn read_colours(set: &RegressionSet, path: &Path) -> Result<Vec<(String, FormColours)>> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::input(format!("cannot be read: {error}")))?;
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        colours_of_json(set, &text)
    } else {
        colours_of_csv(set, &text)
    }
}

fn colours_of_csv(set: &RegressionSet, text: &str) -> Result<Vec<(String, FormColours)>> {
    let known_columns = column_names(set.forms);
    let cells = |line: &str| line.split(',').map(|cell| cell.trim().trim_matches('"').to_string()).collect::<Vec<_>>();
    let mut lines = without_byte_order_mark(text).lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let expected = || {
        let choices: Vec<String> = set.forms.iter().map(|form| form.columns().join(",")).collect();
        format!("the columns id, and {}", choices.join(" or "))
    };
    let (_, header) = lines.next().ok_or_else(|| Error::input("is empty").expected(expected()))?;
    let titles = cells(header);
    let mut places = vec![None; known_columns.len()];
    for (place, title) in titles.iter().enumerate() {
        let known = known_columns.iter().position(|column| column.eq_ignore_ascii_case(title)).ok_or_else(|| {
            let suggestion = nearest_name(title, known_columns.iter().map(String::as_str));
            Error { suggestion, ..Error::input(format!("unknown column \"{title}\"")) }.expected(expected()).at(1, 1)
        })?;
        if places[known].replace(place).is_some() {
            return Err(Error::input(format!("the column {title} occurs twice")).at(1, 1));
        }
    }
    let id_place = places[0].ok_or_else(|| Error::input("lacks the column id").expected(expected()).at(1, 1))?;
    let groups: Vec<(ColourForm, &[Option<usize>])> =
        set.forms.iter().copied().zip(places[1..].chunks_exact(3)).collect();
    for (form, group) in &groups {
        let present = group.iter().flatten().count();
        if present % 3 != 0 {
            return Err(Error::input(format!("has only {present} of the 3 columns of {}", form.name()))
                .expected(expected())
                .at(1, 1));
        }
    }
    let mut colours = Vec::new();
    for (index, line) in lines {
        let (row, number) = (cells(line), index + 1);
        if row.len() != titles.len() {
            let what = format!("has {}, but the header has {}", columns(row.len()), columns(titles.len()));
            return Err(Error::input(what).at(number, 1));
        }
        let triple = |&(form, group): &(ColourForm, &[Option<usize>])| -> Option<Result<(ColourForm, [f64; 3])>> {
            let &[Some(a), Some(b), Some(c)] = group else { return None };
            let value = |place: usize| {
                let what = format!("the {} of {} is \"{}\"", titles[place], row[id_place], row[place]);
                row[place].parse::<f64>().map_err(|_| Error::input(what).expected("a number").at(number, 1))
            };
            Some(value(a).and_then(|a| Ok((form, [a, value(b)?, value(c)?]))))
        };
        let colour = groups.iter().filter_map(triple).collect::<Result<FormColours>>()?;
        colours.push((row[id_place].clone(), colour));
    }
    Ok(colours)
}

fn columns(count: usize) -> String {
    if count == 1 { "1 column".to_string() } else { format!("{count} columns") }
}

/// Reads the colours of a converter for a set from a JSON list of cases, or an object with it.
/// Returns an error if the text has another form or belongs to another set.
pub fn colours_of_json(set: &RegressionSet, text: &str) -> Result<Vec<(String, FormColours)>> {
    let document: Value = serde_json::from_str(text).map_err(|error| {
        let what = format!("is not JSON: {error}");
        Error::input(what).expected("JSON, in which null stands for a value that is not a number")
    })?;
    if let Some(other) = document.get("set").filter(|other| *other != set.name) {
        return Err(Error::input(format!("belongs to the set {other}")).expected(format!("\"{}\"", set.name)));
    }
    let list = document.get("cases").unwrap_or(&document);
    let expected = "a list of objects such as {\"id\": \"D65\", \"xyz\": [95.04, 100, 108.88]}";
    let list = list.as_array().ok_or_else(|| Error::input("contains no list of cases").expected(expected))?;
    list.iter()
        .enumerate()
        .map(|(i, entry)| case_of_json(set, entry).map_err(|error| error.on_path(format!("cases[{i}]"))))
        .collect()
}

fn case_of_json(set: &RegressionSet, entry: &Value) -> Result<(String, FormColours)> {
    let object = entry.as_object().ok_or_else(|| Error::input("is not an object"))?;
    let forms: Vec<&str> = set.forms.iter().map(|form| form.name()).collect();
    let known = || ["id"].into_iter().chain(forms.iter().copied()).chain(CASE_KEYS);
    if let Some(key) = object.keys().find(|key| !known().any(|known| known == key.as_str())) {
        return Err(Error::unknown_name("key", key, known()).expected(format!("id, {}", forms.join(", "))));
    }
    let id = object.get("id").and_then(Value::as_str).ok_or_else(|| Error::input("has no id"))?;
    let triple = |form: &ColourForm| -> Option<Result<(ColourForm, [f64; 3])>> {
        let (name, value) = (form.name(), object.get(form.name())?);
        let wrong = || Error::input(format!("the {name} of {id} is {value}")).expected("a list of three numbers");
        // `null` stands for NaN.
        let number = |value: &Value| if value.is_null() { Some(f64::NAN) } else { value.as_f64() };
        let numbers = value.as_array().and_then(|list| list.iter().map(number).collect::<Option<Vec<f64>>>());
        let triple = numbers.and_then(|numbers| numbers.try_into().ok());
        Some(triple.map(|colour| (*form, colour)).ok_or_else(wrong))
    };
    let colours = set.forms.iter().filter_map(triple).collect::<Result<FormColours>>()?;
    Ok((id.to_string(), colours))
}
