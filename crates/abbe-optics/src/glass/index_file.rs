//! Files with measured indices of refraction: entries of the database refractiveindex.info (YAML),
//! and tables of n and k (CSV).
//!
//! The formulas are those of "RefractiveIndex.INFO database – Dispersion formulas" by M. Polyanskiy
//! (<https://refractiveindex.info/download/doc/Dispersion%20formulas.pdf>).

use std::path::Path;

use yaml_rust2::parser::{Event, Parser};
use yaml_rust2::{Yaml, YamlLoader};

use super::index::{ReferenceMedium, RefractiveIndex};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::powf;
use abbe_spectra::spectrum::read::{ColumnFormat, nm_per_unit};
use abbe_spectra::spectrum::{BAND_NM, Outside, Spectrum, ULTRAVIOLET_FROM_NM};
use abbe_spectra::text::without_byte_order_mark;

/// In nm, between the wavelengths at which a formula is evaluated.
const STEP_NM: f64 = 1.0;

type Points = Vec<(f64, f64)>;

#[derive(Debug, Default)]
struct Columns {
    n: Option<Points>,
    k: Option<Points>,
}

#[derive(Debug, Clone, PartialEq)]
struct IndexTable {
    /// In rising order.
    nm: Vec<f64>,
    values: Vec<f64>,
}

impl IndexTable {
    /// Creates a table from points in any order: those from 300 to 830 nm, and the nearest one on
    /// each side. Points of equal (rounded) wavelength become their mean.
    fn new(mut points: Points) -> Result<Self> {
        if points.iter().any(|(nm, value)| !(nm.is_finite() && value.is_finite())) {
            return Err(Error::input("a wavelength or a value is not finite"));
        }
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        let (Some(&(first, _)), Some(&(last, _))) = (points.first(), points.last()) else {
            return Err(Error::input("the table has no rows"));
        };
        check_range(first, last)?;
        let (nm, values): (Vec<f64>, Vec<f64>) = points
            .chunk_by(|one, other| one.0 == other.0)
            .map(|equal| (equal[0].0, equal.iter().map(|(_, value)| value).sum::<f64>() / equal.len() as f64))
            .unzip();
        let from = nm.partition_point(|&nm| nm <= ULTRAVIOLET_FROM_NM).saturating_sub(1);
        let to = (nm.partition_point(|&nm| nm < BAND_NM.1) + 1).min(nm.len());
        Ok(Self { nm: nm[from..to].to_vec(), values: values[from..to].to_vec() })
    }
}

/// Returns an error if no wavelength of the band lies between `first` and `last` (nm).
fn check_range(first: f64, last: f64) -> Result<()> {
    if first > BAND_NM.1 || last < BAND_NM.0 {
        let what = format!("the data ranges from {first} to {last} nm");
        return Err(Error::input(what).expected("wavelengths from 360 to 830 nm"));
    }
    Ok(())
}

/// The contents of a file with indices of refraction.
#[derive(Debug, Clone, PartialEq)]
pub struct IndexFileData {
    n: Option<IndexTable>,
    k: Option<IndexTable>,
}

impl IndexFileData {
    /// Reads a text by the extension of `path`: entries of refractiveindex.info (`.yml`, `.yaml`),
    /// or tables with a header row such as `nm,n,k` or `um,n`. Returns an error with the path if it
    /// is malformed, a formula is unknown, or no wavelength is from 360 to 830 nm.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|name| name.to_str()).unwrap_or_default();
        let is_yaml = ["yml", "yaml"].iter().any(|known| extension.eq_ignore_ascii_case(known));
        let columns = if is_yaml { of_yaml(text) } else { of_csv(text) };
        let data = columns.and_then(|Columns { n, k }| {
            Ok(Self { n: n.map(IndexTable::new).transpose()?, k: k.map(IndexTable::new).transpose()? })
        });
        data.map_err(|error| error.in_file(path))
    }

    /// Returns true if the file contains both n and k.
    pub fn is_complex(&self) -> bool {
        self.n.is_some() && self.k.is_some()
    }

    /// Returns the index of a transparent material, or an error if n is missing or below 1.
    pub fn index(&self) -> Result<RefractiveIndex> {
        let table = self.n.as_ref().ok_or_else(|| Error::input("the file contains no index of refraction"))?;
        let mut index = RefractiveIndex::table(&table.nm, &table.values)?;
        index.set_warning("the file", ReferenceMedium::Unspecified);
        Ok(index)
    }

    /// Returns n and k of a metal, held at both ends, or an error if one is missing.
    pub fn n_and_k(&self) -> Result<(Spectrum, Spectrum)> {
        let (Some(n), Some(k)) = (&self.n, &self.k) else {
            return Err(Error::input("the file does not contain both n and k").expected("the data of a metal"));
        };
        let spectrum = |table: &IndexTable| Spectrum::table(&table.nm, &table.values, Outside::Hold);
        Ok((spectrum(n)?, spectrum(k)?))
    }
}

fn of_yaml(text: &str) -> Result<Columns> {
    let malformed = |error: yaml_rust2::ScanError| Error::input(format!("not a valid YAML file: {error}"));
    // Aliases could expand to a text of any size, and the database uses none.
    let mut parser = Parser::new_from_str(text);
    loop {
        let event = parser.next_token().map_err(malformed)?.0;
        if matches!(event, Event::Alias(_)) {
            return Err(Error::input("the YAML file uses aliases").expected("a file without them"));
        }
        if event == Event::StreamEnd {
            break;
        }
    }
    let documents = YamlLoader::load_from_str(text).map_err(malformed)?;
    let entries = documents.first().and_then(|document| document["DATA"].as_vec());
    let entries = entries.ok_or_else(|| {
        Error::input("the file has no list DATA").expected("an entry of the database refractiveindex.info")
    })?;
    let mut data = Columns::default();
    for entry in entries {
        let kind = entry["type"].as_str().unwrap_or_default();
        match kind.split_once(' ') {
            Some(("tabulated", columns)) => {
                let rows = rows(&text_of(&entry["data"]), columns.len() + 1)?;
                for (column, name) in columns.chars().enumerate() {
                    let points = rows.iter().map(|row| (1e3 * row[0], row[column + 1])).collect();
                    match name {
                        'n' => data.n = Some(points),
                        'k' => data.k = Some(points),
                        _ => return Err(Error::input(format!("unknown columns \"{columns}\"")).expected("n, k or nk")),
                    }
                }
            }
            Some(("formula", number)) => data.n = Some(of_formula(number, entry)?),
            _ => {
                return Err(Error::input(format!("unknown type \"{kind}\""))
                    .expected("tabulated n, tabulated k, tabulated nk, or formula 1 to 9"));
            }
        }
    }
    Ok(data)
}

fn text_of(yaml: &Yaml) -> String {
    if let Yaml::Real(text) | Yaml::String(text) = yaml {
        return text.clone();
    }
    yaml.as_i64().map_or_else(String::new, |number| number.to_string())
}

fn numbers(text: &str) -> Result<Vec<f64>> {
    let number = |word: &str| word.parse().map_err(|_| Error::input(format!("found \"{word}\"")).expected("a number"));
    text.split_whitespace().map(number).collect()
}

fn rows(text: &str, columns: usize) -> Result<Vec<Vec<f64>>> {
    let row = |line: &str| {
        let row = numbers(line)?;
        if row.len() == columns {
            Ok(row)
        } else {
            Err(Error::input(format!("a row has {} numbers", row.len())).expected(format!("{columns} numbers")))
        }
    };
    text.lines().filter(|line| !line.trim().is_empty()).map(row).collect()
}

/// Evaluates a formula from 300 to 830 nm where it is valid.
fn of_formula(number: &str, entry: &Yaml) -> Result<Points> {
    let range = [&entry["wavelength_range"], &entry["range"]].map(text_of).concat();
    let [from, to]: [f64; 2] = numbers(&range)?
        .try_into()
        .map_err(|_| Error::input("the formula has no wavelength range").expected("wavelength_range: MIN MAX"))?;
    check_range(1e3 * from, 1e3 * to)?;
    let c = numbers(&text_of(&entry["coefficients"]))?;
    let (from, to) = ((1e3 * from).max(ULTRAVIOLET_FROM_NM), (1e3 * to).min(BAND_NM.1));
    let steps = ((to - from) / STEP_NM).max(0.0).ceil() as usize;
    let at = |i: usize| (from + STEP_NM * i as f64).min(to);
    (0..=steps).map(at).map(|nm| Ok((nm, formula(number, &c, 1e-3 * nm)?))).collect()
}

/// Evaluates a formula with the coefficients C1, … at `um` in µm.
fn formula(number: &str, c: &[f64], um: f64) -> Result<f64> {
    let at = |index: usize| c.get(index - 1).copied().unwrap_or(0.0);
    // The sum of a function of the pairs of coefficients from C2 on.
    let pairs = |from: usize, term: &dyn Fn(f64, f64) -> f64| -> f64 {
        (from..=c.len()).step_by(2).map(|i| term(at(i), at(i + 1))).sum()
    };
    let squared = um * um;
    let n = match number {
        "1" => (1.0 + at(1) + pairs(2, &|b, c| b * squared / (squared - c * c))).sqrt(),
        "2" => (1.0 + at(1) + pairs(2, &|b, c| b * squared / (squared - c))).sqrt(),
        "3" => (at(1) + pairs(2, &|b, exponent| b * powf(um, exponent))).sqrt(),
        "4" => {
            let resonance = |i: usize| {
                if at(i) == 0.0 { 0.0 } else { at(i) * powf(um, at(i + 1)) / (squared - powf(at(i + 2), at(i + 3))) }
            };
            (at(1) + resonance(2) + resonance(6) + pairs(10, &|b, exponent| b * powf(um, exponent))).sqrt()
        }
        "5" => at(1) + pairs(2, &|b, exponent| b * powf(um, exponent)),
        "6" => 1.0 + at(1) + pairs(2, &|b, c| b / (c - 1.0 / squared)),
        "7" => {
            let l = 1.0 / (squared - 0.028);
            at(1) + at(2) * l + at(3) * l * l + squared * (at(4) + squared * (at(5) + squared * at(6)))
        }
        "8" => {
            let ratio = at(1) + at(2) * squared / (squared - at(3)) + at(4) * squared;
            ((1.0 + 2.0 * ratio) / (1.0 - ratio)).sqrt()
        }
        "9" => {
            let shifted = um - at(5);
            (at(1) + at(2) / (squared - at(3)) + at(4) * shifted / (shifted * shifted + at(6))).sqrt()
        }
        _ => return Err(Error::input(format!("unknown formula \"{number}\"")).expected("formula 1 to formula 9")),
    };
    Ok(n)
}

/// Reads a table whose columns are named by a header row. Another header row starts another table,
/// as in the CSV files of refractiveindex.info. Separators and decimal signs are those of spectra.
fn of_csv(text: &str) -> Result<Columns> {
    let mut data = Columns::default();
    // The header row, and its columns once a row of numbers shows what separates them.
    let mut header = "";
    let mut columns: Option<IndexColumns> = None;
    for (number, line) in (1..).zip(without_byte_order_mark(text).lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fault = |what: String| Error::input(format!("line {number}: {what}"));
        let first = line.split([',', ';', '\t', '|']).next().unwrap_or_default();
        let first = first.split_whitespace().next().unwrap_or_default().trim_matches('"');
        if first.parse::<f64>().is_err() {
            (header, columns) = (line, None);
            continue;
        }
        let columns = match &columns {
            Some(known) => known,
            None => columns.insert(IndexColumns::of(header, line).map_err(|error| fault(error.what).expected(HEADER))?),
        };
        let expected = "a number";
        let row = columns.format.numbers(line).map_err(|cell| fault(format!("found \"{cell}\"")).expected(expected))?;
        if row.len() != columns.names.len() {
            let count = columns.names.len();
            return Err(fault(format!("found {} columns", row.len())).expected(format!("{count} columns")));
        }
        for (name, value) in columns.names.iter().zip(&row).skip(1) {
            let points = if *name == IndexColumn::N { &mut data.n } else { &mut data.k };
            points.get_or_insert_default().push((columns.nm_per_unit * row[0], *value));
        }
    }
    Ok(data)
}

/// What a header row may look like.
const HEADER: &str = "a header row such as nm,n,k or um,n,k or Wavelength (nm),n";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum IndexColumn {
    Wavelength,
    N,
    K,
}

/// The columns of a table of indices.
struct IndexColumns {
    format: ColumnFormat,
    nm_per_unit: f64,
    names: Vec<IndexColumn>,
}

impl IndexColumns {
    /// Reads a header row. `row` is the first row of numbers after it.
    fn of(header: &str, row: &str) -> Result<Self> {
        if header.is_empty() {
            return Err(Error::input("found no header row"));
        }
        let Some(format) = ColumnFormat::of(row) else {
            return Err(Error::input(format!("found \"{row}\" instead of a row of numbers")));
        };
        let titles = format.titles(header);
        let first = titles.first().map(String::as_str).unwrap_or_default();
        // refractiveindex.info writes "wl" for wavelengths in µm.
        let unit = if first.eq_ignore_ascii_case("wl") { Some(1e3) } else { nm_per_unit(first) };
        let unit = unit.ok_or_else(|| Error::input(format!("found the title \"{first}\" without a unit")))?;
        let name = |title: &String| {
            let title = title.to_lowercase();
            let mut words = title.split(|c: char| !c.is_alphabetic());
            words.find_map(|word| match word {
                "n" | "index" => Some(IndexColumn::N),
                "k" | "extinction" => Some(IndexColumn::K),
                _ => None,
            })
        };
        let unknown = |title: &String| Error::input(format!("found the column \"{title}\", which is not n or k"));
        let others = titles.iter().skip(1).map(|title| name(title).ok_or_else(|| unknown(title)));
        let names: Result<Vec<IndexColumn>> = std::iter::once(Ok(IndexColumn::Wavelength)).chain(others).collect();
        Ok(Self { format, nm_per_unit: unit, names: names? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, name: &str) -> Result<IndexFileData> {
        IndexFileData::parse(text, Path::new(name))
    }

    const BK7: &str = "# a comment\nREFERENCES: |\n    Schott Zemax catalog\nDATA:\n  - type: formula 2 \n\
        \x20   wavelength_range: 0.3 2.5\n    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 \
        1.01046945 103.560653\n  - type: tabulated k\n    data: |\n        0.300 2.8607E-06\n        2.5 8.1E-06\n";

    #[test]
    fn a_glass_has_the_index_of_its_data_sheet() {
        let data = parse(BK7, "BK7.yml").unwrap();
        let index = data.index().unwrap();
        for (nm, n) in [(587.5618, 1.516800), (486.1327, 1.522376), (656.2725, 1.514322)] {
            assert!((index.n(nm) - n).abs() < 2e-6, "{nm}: {}", index.n(nm));
        }
        assert_eq!(data.k.unwrap().nm, [300.0, 2500.0]);
    }

    /// Each formula, evaluated by hand at 0.5 µm.
    #[test]
    fn every_formula_has_its_value() {
        let c = |text: &str| numbers(text).unwrap();
        for (number, coefficients, expected) in [
            ("1", "0.1 1 0.1", (1.1_f64 + 0.25 / 0.24).sqrt()),
            ("2", "0.1 1 0.1", (1.1_f64 + 0.25 / 0.15).sqrt()),
            ("3", "2 0.1 2 0.01 -2", (2.0_f64 + 0.025 + 0.04).sqrt()),
            ("4", "2 1 2 0.1 2 0 0 0 1 0.01 -2", (2.0_f64 + 0.25 / 0.24 + 0.04).sqrt()),
            ("5", "1.5 0.004 -2", 1.516),
            ("6", "0 0.05 200 0.001 60", 1.0 + 0.05 / 196.0 + 0.001 / 56.0),
            ("7", "1.5 0.01 0.001 0.1 0 0", 1.5 + 0.01 / 0.222 + 0.001 / (0.222 * 0.222) + 0.025),
            ("8", "0.2 0.1 0.05 0.01", {
                let ratio: f64 = 0.2 + 0.1 * 0.25 / 0.2 + 0.0025;
                ((1.0 + 2.0 * ratio) / (1.0 - ratio)).sqrt()
            }),
            ("9", "2 0.01 0.05 0.1 0.3 0.2", (2.0_f64 + 0.01 / 0.2 + 0.1 * 0.2 / (0.04 + 0.2)).sqrt()),
        ] {
            let found = formula(number, &c(coefficients), 0.5).unwrap();
            assert!((found - expected).abs() < 1e-12, "formula {number}: {found} instead of {expected}");
        }
    }

    #[test]
    fn tables_of_n_and_k_have_three_forms() {
        let yaml = "DATA:\n  - type: tabulated nk\n    data: |\n        0.4 1.5 2\n        0.8 0.2 4\n";
        for (text, name) in [
            (yaml, "Au.yml"),
            ("nm,n,k\n400,1.5,2\n800,0.2,4\n", "Au.csv"),
            ("wl,n\n0.4,1.5\n0.8,0.2\n\nwl,k\n0.4,2\n0.8,4\n", "Au.csv"),
            ("nm;n;k\n400;1,5;2\n800;0,2;4,0\n", "Au.csv"),
            ("Wavelength (nm),n,k\n400,1.5,2\n800,0.2,4\n", "Au.csv"),
            ("\u{feff}\"Wavelength / µm\";\"Refractive index n\";\"k\"\n0,4;1,5;2\n0,8;0,2;4\n", "Au.csv"),
            ("wavelength_um\tn\tk\n0.4\t1.5\t2\n0.8\t0.2\t4\n", "Au.csv"),
            ("nm n k\n400 1,5 2\n800 0,2 4\n", "Au.csv"),
        ] {
            let (n, k) = parse(text, name).unwrap().n_and_k().unwrap();
            assert!((n.at(600.0) - 0.85).abs() < 1e-12 && (k.at(600.0) - 3.0).abs() < 1e-12, "{text}");
        }
    }

    /// Rows may have any order, and rounded wavelengths may be equal. Rows far outside the band
    /// have no effect, even with values that no transparent material has.
    #[test]
    fn tables_keep_the_rows_of_the_band_in_rising_order() {
        let rows = "nm,n\n9000,0.9\n900,1.4\n600,1.5\n600,1.52\n400,1.6\n250,1.7\n200,0.8\n";
        let data = parse(rows, "a.csv").unwrap();
        assert_eq!(data.n.as_ref().unwrap().nm, [250.0, 400.0, 600.0, 900.0]);
        let index = data.index().unwrap();
        for (nm, n) in [(600.0, 1.51), (500.0, 1.555), (750.0, 1.455), (325.0, 1.65)] {
            assert!((index.n(nm) - n).abs() < 1e-12, "{nm}: {}", index.n(nm));
        }
    }

    #[test]
    fn formulas_reach_into_the_ultraviolet() {
        let n = |range: &str, nm: f64| {
            let text =
                format!("DATA:\n  - type: formula 5\n    wavelength_range: {range}\n    coefficients: 1.5 0.004 -2\n");
            parse(&text, "a.yml").unwrap().index().unwrap().n(nm)
        };
        assert!((n("0.2 2", 310.0) - (1.5 + 0.004 / 0.0961)).abs() < 1e-12);
        assert!((n("0.4 2", 310.0) - 1.525).abs() < 1e-12);
    }

    #[test]
    fn malformed_files_give_errors_that_name_the_file() {
        for (text, name, expected) in [
            ("DATA: [", "a.yml", "not a valid YAML"),
            ("x: &a 1\ny: *a\n", "a.yml", "aliases"),
            ("x: 1", "a.yml", "no list DATA"),
            (
                "DATA:\n  - type: formula 12\n    wavelength_range: 0.3 2\n    coefficients: 1",
                "a.yml",
                "unknown formula",
            ),
            ("DATA:\n  - type: formula 2\n    coefficients: 1", "a.yml", "no wavelength range"),
            ("DATA:\n  - type: tabulated nk\n    data: |\n        0.4 1.5\n", "a.yml", "2 numbers"),
            ("DATA:\n  - type: tabulated n\n    data: |\n        4 1.5\n        8 1.4\n", "a.yml", "360 to 830"),
            (
                "DATA:\n  - type: formula 5\n    wavelength_range: 2 5\n    coefficients: 1.5",
                "a.yml",
                "from 2000 to 5000 nm",
            ),
            ("400,1.5\n", "a.csv", "no header"),
            ("nm,n\n400,x\n", "a.csv", "line 2"),
            ("nm,n\n400,1.5\n500,x\n", "a.csv", "line 3: found \"x\""),
            ("nm;n\n400;1,5;2\n", "a.csv", "line 2: found 3 columns"),
            ("wavelength,n\n400,1.5\n", "a.csv", "the title \"wavelength\" without a unit"),
            ("nm,reflectance\n400,1.5\n", "a.csv", "the column \"reflectance\", which is not n or k"),
        ] {
            let error = parse(text, name).unwrap_err().to_string();
            assert!(error.contains(expected) && error.contains(name), "{error}");
        }
        assert!(parse("nm,n\n400,1.5\n800,1.4", "a.csv").unwrap().n_and_k().is_err());
    }
}
