//! The built-in library of named spectra (illuminants, lamps, reflectances, transmittances and
//! coefficients) and of refractive indices of metals.
//!
//! The catalogue `data/library.csv` names the file and the column of every entry. The files are
//! part of the compiled crate, and only the column of a requested entry is parsed.

use std::sync::OnceLock;

use super::line::SpectralLine;
use super::table::Outside;
use super::value::Spectrum;
use crate::error::{Error, Result};
use serde::Serialize;

/// The physical quantity of a library spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpectrumKind {
    /// Power per nm, on a scale of each entry's own, and 0 outside the table.
    Light,
    /// A reflectance from 0 to 1. Outside the table, this and all further kinds keep the end
    /// values.
    Reflectance,
    /// A transmittance from 0 to 1.
    Transmittance,
    /// An absorption coefficient in 1/m.
    Absorption,
    /// A scattering coefficient in 1/m.
    Scattering,
}

impl SpectrumKind {
    /// All kinds of spectra, in the order of the catalogue.
    pub const ALL: [Self; 5] =
        [Self::Light, Self::Reflectance, Self::Transmittance, Self::Absorption, Self::Scattering];

    /// Returns the name of the kind as the catalogue writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Reflectance => "reflectance",
            Self::Transmittance => "transmittance",
            Self::Absorption => "absorption",
            Self::Scattering => "scattering",
        }
    }

    /// Returns the rule for values beyond the ends of a table of this kind.
    pub fn outside(self) -> Outside {
        match self {
            Self::Light => Outside::Zero,
            Self::Reflectance | Self::Transmittance | Self::Absorption | Self::Scattering => Outside::Hold,
        }
    }
}

/// A row of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LibraryListing {
    /// The name of the spectrum. Lookups ignore case.
    pub name: &'static str,
    /// The physical quantity.
    pub kind: SpectrumKind,
    /// A description in words.
    pub description: &'static str,
    /// The source of the data.
    pub source: &'static str,
    file: &'static LibraryFile,
    column: &'static str,
}

/// A spectrum from the library.
#[derive(Debug, Clone, PartialEq)]
pub struct LibrarySpectrum {
    /// The name as the catalogue writes it.
    pub name: &'static str,
    /// The physical quantity.
    pub kind: SpectrumKind,
    /// A description in words.
    pub description: &'static str,
    /// The source of the data.
    pub source: &'static str,
    /// The spectrum itself.
    pub spectrum: Spectrum,
}

#[derive(Debug, PartialEq, Eq)]
struct LibraryFile {
    path: &'static str,
    source: &'static str,
    text: &'static str,
}

impl LibraryFile {
    const fn new(path: &'static str, source: &'static str, text: &'static str) -> Self {
        Self { path, source, text }
    }
}

/// The file of spectral lines. All others are tables with one column per entry.
const LINES_FILE: &str = "illuminants/lines.csv";

static CATALOGUE: &str = include_str!("../../data/library.csv");
static METALS: &str = include_str!("../../data/metals/metals.csv");
static METALS_NK: &str = include_str!("../../data/metals/metals_nk.csv");

static FILES: [LibraryFile; 16] = [
    LibraryFile::new(
        "illuminants/cie_standard_1nm.csv",
        "CIE 15; A by its formula, D beyond 780 nm from the CIE daylight components",
        include_str!("../../data/illuminants/cie_standard_1nm.csv"),
    ),
    LibraryFile::new("illuminants/cie_C.csv", "CIE 15", include_str!("../../data/illuminants/cie_C.csv")),
    LibraryFile::new(
        "illuminants/cie_fl.csv",
        "CIE 15, sets of 1986 and 2004",
        include_str!("../../data/illuminants/cie_fl.csv"),
    ),
    LibraryFile::new("illuminants/cie_hp.csv", "CIE 15", include_str!("../../data/illuminants/cie_hp.csv")),
    LibraryFile::new("illuminants/cie_led.csv", "CIE 15:2018", include_str!("../../data/illuminants/cie_led.csv")),
    LibraryFile::new(
        "illuminants/lamps_measured_5nm.csv",
        "NIST Colour Quality Scale lamps (Davis and Ohno 2008)",
        include_str!("../../data/illuminants/lamps_measured_5nm.csv"),
    ),
    LibraryFile::new(
        "illuminants/led_models_1nm.csv",
        "model of Ohno 2005",
        include_str!("../../data/illuminants/led_models_1nm.csv"),
    ),
    LibraryFile::new(
        "illuminants/solar_astm_g173.csv",
        "ASTM G173-03 (SMARTS 2.9.2, NREL)",
        include_str!("../../data/illuminants/solar_astm_g173.csv"),
    ),
    LibraryFile::new(
        LINES_FILE,
        "NIST Atomic Spectra Database, wavelengths in air; makers' tables",
        include_str!("../../data/illuminants/lines.csv"),
    ),
    LibraryFile::new(
        "reflectance/colorchecker_ohta_5nm.csv",
        "N. Ohta, The Basis of Color Reproduction Engineering",
        include_str!("../../data/reflectance/colorchecker_ohta_5nm.csv"),
    ),
    LibraryFile::new(
        "reflectance/colorchecker_babelcolor_10nm.csv",
        "BabelColor (D. Pascale), mean of 30 charts",
        include_str!("../../data/reflectance/colorchecker_babelcolor_10nm.csv"),
    ),
    LibraryFile::new(
        "reflectance/cie_tcs_5nm.csv",
        "CIE 13.3-1995",
        include_str!("../../data/reflectance/cie_tcs_5nm.csv"),
    ),
    LibraryFile::new(
        "reflectance/leaf_prospectD.csv",
        "PROSPECT-D (Féret et al. 2017), computed",
        include_str!("../../data/reflectance/leaf_prospectD.csv"),
    ),
    LibraryFile::new(
        "reflectance/sky_zenith_single_scatter.csv",
        "ASTM G173 sunlight with single Rayleigh scattering, computed",
        include_str!("../../data/reflectance/sky_zenith_single_scatter.csv"),
    ),
    LibraryFile::new(
        "media/water.csv",
        "Pope and Fry 1997, Hale and Querry 1973; Morel 1974, Smith and Baker 1981",
        include_str!("../../data/media/water.csv"),
    ),
    LibraryFile::new(
        "media/rayleigh_air.csv",
        "Bodhaine et al. 1999, computed",
        include_str!("../../data/media/rayleigh_air.csv"),
    ),
];

/// Returns the whole catalogue in its order.
pub fn list() -> &'static [LibraryListing] {
    static LIST: OnceLock<Vec<LibraryListing>> = OnceLock::new();
    LIST.get_or_init(|| CATALOGUE.lines().skip(1).map(listing).collect())
}

/// Returns every name in the order of the catalogue.
pub fn names() -> impl Iterator<Item = &'static str> {
    list().iter().map(|listing| listing.name)
}

/// The expected input in the error for an unknown spectrum name.
pub const EXPECTED_NAME: &str = "the name of a built-in spectrum";

/// Returns the spectrum with this name in any case, or an error with a suggestion.
pub fn find(name: &str) -> Result<LibrarySpectrum> {
    let listing = list()
        .iter()
        .find(|listing| listing.name.eq_ignore_ascii_case(name))
        .ok_or_else(|| Error::unknown_name("spectrum", name, names()).expected(EXPECTED_NAME))?;
    let LibraryListing { name, kind, description, source, file, column } = *listing;
    let text = file.text;
    let spectrum = if file.path == LINES_FILE { lines(text, column) } else { table(text, column, kind.outside()) };
    Ok(LibrarySpectrum { name, kind, description, source, spectrum })
}

/// A metal of the library.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LibraryMetal {
    /// The chemical symbol, or a short name of an alloy.
    pub symbol: &'static str,
    /// The English name.
    pub name: &'static str,
    /// Another accepted spelling of the name, or an empty string.
    pub also: &'static str,
    /// The source of the measured data.
    pub source: &'static str,
}

impl LibraryMetal {
    /// Returns n and k, where n + ik is the complex refractive index.
    pub fn index(&self) -> (Spectrum, Spectrum) {
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for row in METALS_NK.lines().filter(|row| row.split(',').next() == Some(self.symbol)) {
            columns.iter_mut().zip(row.split(',').skip(1)).for_each(|(column, cell)| column.push(number(cell)));
        }
        let [nm, n, k] = columns;
        let spectrum =
            |values: &[f64]| Spectrum::table(&nm, values, Outside::Hold).expect("a built-in table of a metal is valid");
        (spectrum(&n), spectrum(&k))
    }

    fn is_called(&self, name: &str) -> bool {
        let known = [self.symbol, self.name, self.also];
        known.iter().any(|known| !known.is_empty() && known.eq_ignore_ascii_case(name))
    }
}

/// Returns the metal of this symbol or name in any case, or an error with a suggestion.
pub fn metal(name: &str) -> Result<LibraryMetal> {
    metals().find(|metal| metal.is_called(name)).ok_or_else(|| {
        let candidates = metals().flat_map(|metal| [metal.symbol, metal.name]);
        let named: Vec<String> = metals().map(|metal| format!("{} ({})", metal.name, metal.symbol)).collect();
        Error::unknown_name("metal", name, candidates).expected(named.join(", "))
    })
}

/// Lists all metals.
pub fn metals() -> impl Iterator<Item = LibraryMetal> {
    METALS.lines().skip(1).map(|row| {
        let [symbol, name, also, source] = cells(row);
        LibraryMetal { symbol, name, also, source }
    })
}

fn cells<const N: usize>(row: &'static str) -> [&'static str; N] {
    let mut rest = row.splitn(N, ',');
    std::array::from_fn(|_| rest.next().expect("a row of a built-in catalogue has all its columns"))
}

fn listing(row: &'static str) -> LibraryListing {
    let [name, kind, path, column, description] = cells(row);
    let kind =
        SpectrumKind::ALL.into_iter().find(|known| known.name() == kind).expect("the catalogue names known kinds");
    let file = FILES.iter().find(|file| file.path == path).expect("the catalogue names built-in files");
    LibraryListing { name, kind, description, source: file.source, file, column }
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a built-in table holds numbers")
}

/// Parses the first `N` columns of a table with a header line.
pub(crate) fn columns<const N: usize>(text: &str) -> [Vec<f64>; N] {
    let mut columns = std::array::from_fn(|_| Vec::new());
    for row in text.lines().skip(1) {
        columns.iter_mut().zip(row.split(',')).for_each(|(column, cell)| column.push(number(cell)));
    }
    columns
}

fn table(text: &str, column: &str, outside: Outside) -> Spectrum {
    let header = text.lines().next().expect("a built-in table has a header");
    let place = header.split(',').position(|title| title == column).expect("the catalogue names an existing column");
    let (nm, values): (Vec<f64>, Vec<f64>) = text
        .lines()
        .skip(1)
        .map(|row| {
            let mut cells = row.split(',');
            let nm = number(cells.next().expect("a row has a first cell"));
            (nm, number(cells.nth(place - 1).expect("a row of a built-in table has all its columns")))
        })
        .unzip();
    Spectrum::table(&nm, &values, outside).expect("a built-in table is valid")
}

/// Parses the spectral lines of one lamp from rows of a lamp name, a wavelength in nm and a power.
fn lines(text: &str, lamp: &str) -> Spectrum {
    let lines: Vec<SpectralLine> = text
        .lines()
        .filter_map(|row| {
            let mut cells = row.split(',');
            (cells.next() == Some(lamp)).then(|| {
                let mut next = || number(cells.next().expect("a row of lines has three columns"));
                SpectralLine { nm: next(), power: next(), fwhm_nm: None }
            })
        })
        .collect();
    Spectrum::lines(&lines).expect("the built-in lines are valid")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_is_readable_and_has_power_in_the_band() {
        assert!(list().len() >= 190);
        for listing in list() {
            let entry = find(&listing.name.to_uppercase()).unwrap();
            assert_eq!(entry.name, listing.name);
            assert!(entry.spectrum.integral() > 0.0 && entry.spectrum.min() >= 0.0, "{}", entry.name);
            if matches!(entry.kind, SpectrumKind::Reflectance | SpectrumKind::Transmittance) {
                assert!(entry.spectrum.max() <= 1.0, "{}", entry.name);
            }
        }
    }

    #[test]
    fn every_file_is_in_the_catalogue() {
        for file in &FILES {
            assert!(list().iter().any(|listing| listing.file == file), "{}", file.path);
        }
    }

    #[test]
    fn names_are_kebab_case_or_a_published_code() {
        for name in names() {
            assert!(name.bytes().all(|c| c.is_ascii_alphanumeric() || b"-./".contains(&c)), "{name}");
        }
    }

    #[test]
    fn a_misspelling_gets_a_suggestion() {
        let error = find("sodium-low-presure").unwrap_err();
        assert_eq!(error.suggestion.as_deref(), Some("sodium-low-pressure"));
        assert_eq!(metal("sliver").unwrap_err().suggestion.as_deref(), Some("silver"));
    }

    #[test]
    fn metals_are_found_by_symbol_and_name() {
        assert_eq!(metal("gold").unwrap().symbol, metal("Au").unwrap().symbol);
        assert_eq!(metal("Aluminum").unwrap().symbol, metal("aluminium").unwrap().symbol);
        assert_eq!(metals().count(), 11);
        let (n, k) = metal("Ag").unwrap().index();
        assert!((n.at(400.0) - 0.05).abs() < 0.01 && (k.at(400.0) - 2.103_522_013).abs() < 1e-8);
    }
}
