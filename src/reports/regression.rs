//! The regression set for code that converts spectra to colours, and the colours of a converter.

use std::fmt::Write as _;
use std::path::Path;

use abbe_session::output::file;
use abbe_spectra::colour::regress::{
    CaseColour, CaseGroup, ConvertedColour, REGRESSION_SET, RegressionSet, RegressionSpectrum, RegressionTolerances,
};
use abbe_spectra::error::{Error, Result, nearest_name};
use abbe_spectra::spectrum::{BAND_NM, Observer};
use abbe_spectra::text::without_byte_order_mark;
use serde::Serialize;
use serde_json::Value;

const COLUMNS: [&str; 10] = ["id", "X", "Y", "Z", "linear_r", "linear_g", "linear_b", "srgb_r", "srgb_g", "srgb_b"];

/// The keys of a colour in JSON.
const FORMS: [&str; 3] = ["xyz", "linear_srgb", "srgb"];

const CASE_KEYS: [&str; 3] = ["group", "light", "reflectance"];

const CONVENTIONS: [&str; 6] = [
    "XYZ is the sum over 360, 361, ... 830 nm of value times observer, plus the power of each line times the observer, interpolated linearly at the line",
    "a case with a reflectance uses the product of the light and the reflectance; at a line, the reflectance is interpolated linearly",
    "a light has Y = 100; under a light, the perfect diffuser has Y = 100",
    "linear_srgb is XYZ / 100 times the inverse of the matrix of the sRGB primaries and the white x = 0.3127, y = 0.3290 (IEC 61966-2-1), without adaptation and not clipped",
    "srgb is linear_srgb clipped to 0-1 and encoded with the curve of IEC 61966-2-1",
    "delta_e_2000 is computed with D65 as white",
];

/// The set with its conventions and all values, for converters in other languages.
#[derive(Debug, Serialize)]
pub struct ExportedSet {
    /// The name of the set, with its version.
    pub set: &'static str,
    /// Sentences that define the expected values.
    pub conventions: [&'static str; 6],
    pub tolerances: RegressionTolerances,
    /// The wavelengths of the samples in nm.
    pub nm: Vec<f64>,
    /// x̄, ȳ and z̄ of the CIE 1931 observer at these wavelengths.
    pub observer: Vec<[f64; 3]>,
    /// The lights and the reflectances that the cases name.
    pub spectra: Vec<ExportedSpectrum>,
    /// The cases with their expected colours.
    pub cases: Vec<ExportedCase>,
}

#[derive(Debug, Serialize)]
pub struct ExportedSpectrum {
    /// The name that the cases use.
    pub name: &'static str,
    /// `light` or `reflectance`.
    pub kind: &'static str,
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
    #[serde(flatten)]
    pub expected: CaseColour,
}

/// Returns the set, with samples at each whole nm.
pub fn exported_set() -> ExportedSet {
    let set = RegressionSet::get();
    let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let spectrum = |entry: &'static RegressionSpectrum| ExportedSpectrum {
        name: &entry.name,
        kind: if entry.is_reflectance { "reflectance" } else { "light" },
        values: nm.iter().map(|&nm| entry.spectrum.continuum_at(nm)).collect(),
        lines: lines(entry).collect(),
    };
    ExportedSet {
        set: REGRESSION_SET,
        conventions: CONVENTIONS,
        tolerances: RegressionTolerances::default(),
        observer: nm.iter().map(|&nm| Observer::cie1931().xyz_bar(nm)).collect(),
        spectra: set.spectra.iter().map(spectrum).collect(),
        cases: set
            .cases
            .iter()
            .map(|case| ExportedCase {
                id: &case.id,
                group: case.group,
                light: &case.light,
                reflectance: case.reflectance.as_deref(),
                expected: case.expected,
            })
            .collect(),
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

/// Writes the set to a folder, as JSON and CSV files. Returns the number of cases, or an error if
/// the folder or a file cannot be written.
pub fn write_set(folder: &Path) -> Result<usize> {
    std::fs::create_dir_all(folder)
        .map_err(|error| Error::machine(format!("cannot be created: {error}")).in_file(folder))?;
    let set = exported_set();
    let row = |cells: Vec<String>| cells.join(",") + "\n";
    let names = set.spectra.iter().map(|spectrum| spectrum.name.to_string());
    let mut spectra = row(std::iter::once("nm".to_string()).chain(names).collect());
    let mut observer = "nm,x_bar,y_bar,z_bar\n".to_string();
    for (i, nm) in set.nm.iter().enumerate() {
        let values = set.spectra.iter().map(|spectrum| spectrum.values[i]);
        spectra += &row(std::iter::once(*nm).chain(values).map(|value| value.to_string()).collect());
        observer += &row(std::iter::once(*nm).chain(set.observer[i]).map(|value| value.to_string()).collect());
    }
    let mut lines = "spectrum,nm,power\n".to_string();
    for spectrum in &set.spectra {
        for ExportedLine { nm, power } in &spectrum.lines {
            let _ = writeln!(lines, "{},{nm},{power}", spectrum.name);
        }
    }
    let mut cases = "id,group,light,reflectance\n".to_string();
    let mut expected = COLUMNS.join(",") + "\n";
    for case in &set.cases {
        let _ = writeln!(
            cases,
            "{},{},{},{}",
            case.id,
            case.group.name(),
            case.light,
            case.reflectance.unwrap_or_default()
        );
        let CaseColour { xyz, linear_srgb, srgb } = case.expected;
        let numbers = [xyz, linear_srgb, srgb].concat();
        expected += &row(std::iter::once(case.id.to_string()).chain(numbers.iter().map(f64::to_string)).collect());
    }
    let json = serde_json::to_string(&set).expect("the set has text keys") + "\n";
    for (name, text) in SET_FILES.into_iter().zip([json, spectra, lines, observer, cases, expected]) {
        file::write_whole(&folder.join(name), text.as_bytes())?;
    }
    Ok(set.cases.len())
}

/// Reads the named colours of a converter, as JSON if the file's name ends in `.json`, and as CSV
/// otherwise. Returns an error if the file cannot be read, or has another form.
pub fn read_colours(path: &Path) -> Result<Vec<(String, ConvertedColour)>> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::input(format!("cannot be read: {error}")))?;
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        colours_of_json(&text)
    } else {
        colours_of_csv(&text)
    }
}

fn colours_of_csv(text: &str) -> Result<Vec<(String, ConvertedColour)>> {
    let cells = |line: &str| line.split(',').map(|cell| cell.trim().trim_matches('"').to_string()).collect::<Vec<_>>();
    let mut lines = without_byte_order_mark(text).lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let expected = || format!("the columns id, and X,Y,Z or {} or {}", COLUMNS[4..7].join(","), COLUMNS[7..].join(","));
    let (_, header) = lines.next().ok_or_else(|| Error::input("is empty").expected(expected()))?;
    let titles = cells(header);
    let mut places = [None; COLUMNS.len()];
    for (place, title) in titles.iter().enumerate() {
        let known = COLUMNS.iter().position(|column| column.eq_ignore_ascii_case(title)).ok_or_else(|| {
            Error { suggestion: nearest_name(title, COLUMNS), ..Error::input(format!("unknown column \"{title}\"")) }
                .expected(expected())
                .at(1, 1)
        })?;
        if places[known].replace(place).is_some() {
            return Err(Error::input(format!("the column {title} occurs twice")).at(1, 1));
        }
    }
    let id_place = places[0].ok_or_else(|| Error::input("lacks the column id").expected(expected()).at(1, 1))?;
    let groups = [&places[1..4], &places[4..7], &places[7..]];
    for (group, form) in groups.iter().zip(FORMS) {
        let present = group.iter().flatten().count();
        if present % 3 != 0 {
            return Err(Error::input(format!("has only {present} of the 3 columns of {form}"))
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
        let triple = |group: &[Option<usize>]| -> Result<Option<[f64; 3]>> {
            let &[Some(a), Some(b), Some(c)] = group else { return Ok(None) };
            let value = |place: usize| {
                let what = format!("the {} of {} is \"{}\"", titles[place], row[id_place], row[place]);
                row[place].parse::<f64>().map_err(|_| Error::input(what).expected("a number").at(number, 1))
            };
            Ok(Some([value(a)?, value(b)?, value(c)?]))
        };
        let [xyz, linear_srgb, srgb] = groups.map(triple);
        let colour = ConvertedColour { xyz: xyz?, linear_srgb: linear_srgb?, srgb: srgb? };
        colours.push((row[id_place].clone(), colour));
    }
    Ok(colours)
}

fn columns(count: usize) -> String {
    if count == 1 { "1 column".to_string() } else { format!("{count} columns") }
}

/// Reads the colours of a converter from a JSON list of cases, or an object with it. Returns an
/// error if the text has another form or belongs to another set.
pub fn colours_of_json(text: &str) -> Result<Vec<(String, ConvertedColour)>> {
    let document: Value = serde_json::from_str(text).map_err(|error| {
        let what = format!("is not JSON: {error}");
        Error::input(what).expected("JSON, in which null stands for a value that is not a number")
    })?;
    if let Some(set) = document.get("set").filter(|set| *set != REGRESSION_SET) {
        return Err(Error::input(format!("belongs to the set {set}")).expected(format!("\"{REGRESSION_SET}\"")));
    }
    let list = document.get("cases").unwrap_or(&document);
    let expected = "a list of objects such as {\"id\": \"D65\", \"xyz\": [95.04, 100, 108.88]}";
    let list = list.as_array().ok_or_else(|| Error::input("contains no list of cases").expected(expected))?;
    list.iter()
        .enumerate()
        .map(|(i, entry)| case_of_json(entry).map_err(|error| error.on_path(format!("cases[{i}]"))))
        .collect()
}

fn case_of_json(entry: &Value) -> Result<(String, ConvertedColour)> {
    let object = entry.as_object().ok_or_else(|| Error::input("is not an object"))?;
    let known = || ["id"].into_iter().chain(FORMS).chain(CASE_KEYS);
    if let Some(key) = object.keys().find(|key| !known().any(|known| known == key.as_str())) {
        return Err(Error::unknown_name("key", key, known()).expected("id, xyz, linear_srgb or srgb"));
    }
    let id = object.get("id").and_then(Value::as_str).ok_or_else(|| Error::input("has no id"))?;
    let triple = |form: &str| -> Result<Option<[f64; 3]>> {
        let Some(value) = object.get(form) else { return Ok(None) };
        let wrong = || Error::input(format!("the {form} of {id} is {value}")).expected("a list of three numbers");
        // `null` stands for NaN.
        let number = |value: &Value| if value.is_null() { Some(f64::NAN) } else { value.as_f64() };
        let numbers: Option<Vec<f64>> = value.as_array().ok_or_else(wrong)?.iter().map(number).collect();
        numbers.and_then(|numbers| numbers.try_into().ok()).map(Some).ok_or_else(wrong)
    };
    let [xyz, linear_srgb, srgb] = FORMS.map(triple);
    Ok((id.to_string(), ConvertedColour { xyz: xyz?, linear_srgb: linear_srgb?, srgb: srgb? }))
}
