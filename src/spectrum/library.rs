//! The built-in library: illuminants, lamps, reflectances, coefficients and metals by name.
//!
//! The catalogue is `data/library.csv`; it names for every entry the file and the column that hold it. Files are part
//! of the program and are read when an entry is asked for, only the one and only its column.

use std::sync::OnceLock;

use super::line::SpectralLine;
use super::value::{Outside, Spectrum};
use crate::error::{Error, Result};

/// What an entry of the library is, and so what its numbers mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Power per nm on a scale of the entry's own; 0 outside its table.
    Light,
    /// A reflectance from 0 to 1; the end value holds outside its table, as for all that follow.
    Reflectance,
    /// A transmittance from 0 to 1.
    Transmittance,
    /// An absorption coefficient in 1/m.
    Absorption,
    /// A scattering coefficient in 1/m.
    Scattering,
}

impl Kind {
    /// Every kind, in the order of the catalogue.
    pub const ALL: [Self; 5] =
        [Self::Light, Self::Reflectance, Self::Transmittance, Self::Absorption, Self::Scattering];

    /// The kind's name, as the catalogue writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Reflectance => "reflectance",
            Self::Transmittance => "transmittance",
            Self::Absorption => "absorption",
            Self::Scattering => "scattering",
        }
    }

    /// What a table of this kind means beyond its ends.
    pub fn outside(self) -> Outside {
        match self {
            Self::Light => Outside::Zero,
            Self::Reflectance | Self::Transmittance | Self::Absorption | Self::Scattering => Outside::Hold,
        }
    }
}

/// A line of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Listing {
    /// The name by which it is found, without regard to case.
    pub name: &'static str,
    /// What it is.
    pub kind: Kind,
    /// What it shows, in words.
    pub description: &'static str,
    /// Where its numbers come from.
    pub source: &'static str,
    file: &'static File,
    column: &'static str,
}

/// A spectrum from the library.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The name as the catalogue writes it.
    pub name: &'static str,
    /// What it is.
    pub kind: Kind,
    /// What it shows, in words.
    pub description: &'static str,
    /// Where its numbers come from.
    pub source: &'static str,
    /// The spectrum itself.
    pub spectrum: Spectrum,
}

/// A data file that is part of the program.
#[derive(Debug, PartialEq, Eq)]
struct File {
    path: &'static str,
    source: &'static str,
    text: &'static str,
}

/// The file of spectral lines; all others are tables with a column per entry.
const LINES: &str = "illuminants/lines.csv";

static CATALOGUE: &str = include_str!("../../data/library.csv");
static METALS: &str = include_str!("../../data/metals/metals.csv");
static METALS_NK: &str = include_str!("../../data/metals/metals_nk.csv");

static FILES: [File; 14] = [
    File {
        path: "illuminants/cie_standard_1nm.csv",
        source: "CIE 15; A by its formula, D beyond 780 nm from the CIE daylight components",
        text: include_str!("../../data/illuminants/cie_standard_1nm.csv"),
    },
    File { path: "illuminants/cie_C.csv", source: "CIE 15", text: include_str!("../../data/illuminants/cie_C.csv") },
    File {
        path: "illuminants/cie_fl.csv",
        source: "CIE 15, sets of 1986 and 2004",
        text: include_str!("../../data/illuminants/cie_fl.csv"),
    },
    File { path: "illuminants/cie_hp.csv", source: "CIE 15", text: include_str!("../../data/illuminants/cie_hp.csv") },
    File {
        path: "illuminants/cie_led.csv",
        source: "CIE 15:2018",
        text: include_str!("../../data/illuminants/cie_led.csv"),
    },
    File {
        path: "illuminants/lamps_measured_5nm.csv",
        source: "NIST Colour Quality Scale lamps (Davis and Ohno 2008)",
        text: include_str!("../../data/illuminants/lamps_measured_5nm.csv"),
    },
    File {
        path: "illuminants/led_models_1nm.csv",
        source: "model of Ohno 2005",
        text: include_str!("../../data/illuminants/led_models_1nm.csv"),
    },
    File {
        path: "illuminants/solar_astm_g173.csv",
        source: "ASTM G173-03 (SMARTS 2.9.2, NREL)",
        text: include_str!("../../data/illuminants/solar_astm_g173.csv"),
    },
    File {
        path: LINES,
        source: "NIST Atomic Spectra Database, wavelengths in air; makers' tables",
        text: include_str!("../../data/illuminants/lines.csv"),
    },
    File {
        path: "reflectance/colorchecker_ohta_5nm.csv",
        source: "N. Ohta, The Basis of Color Reproduction Engineering",
        text: include_str!("../../data/reflectance/colorchecker_ohta_5nm.csv"),
    },
    File {
        path: "reflectance/colorchecker_babelcolor_10nm.csv",
        source: "BabelColor (D. Pascale), mean of 30 charts",
        text: include_str!("../../data/reflectance/colorchecker_babelcolor_10nm.csv"),
    },
    File {
        path: "reflectance/cie_tcs_5nm.csv",
        source: "CIE 13.3-1995",
        text: include_str!("../../data/reflectance/cie_tcs_5nm.csv"),
    },
    File {
        path: "reflectance/leaf_prospectD.csv",
        source: "PROSPECT-D (Féret et al. 2017), computed",
        text: include_str!("../../data/reflectance/leaf_prospectD.csv"),
    },
    File {
        path: "reflectance/sky_zenith_single_scatter.csv",
        source: "ASTM G173 sunlight with single Rayleigh scattering, computed",
        text: include_str!("../../data/reflectance/sky_zenith_single_scatter.csv"),
    },
];

static MEDIA: [File; 2] = [
    File {
        path: "media/water.csv",
        source: "Pope and Fry 1997, Hale and Querry 1973; Morel 1974, Smith and Baker 1981",
        text: include_str!("../../data/media/water.csv"),
    },
    File {
        path: "media/rayleigh_air.csv",
        source: "Bodhaine et al. 1999, computed",
        text: include_str!("../../data/media/rayleigh_air.csv"),
    },
];

/// The whole catalogue, in its order.
pub fn list() -> &'static [Listing] {
    static LIST: OnceLock<Vec<Listing>> = OnceLock::new();
    LIST.get_or_init(|| CATALOGUE.lines().skip(1).map(listing).collect())
}

/// Every name, in the catalogue's order.
pub fn names() -> impl Iterator<Item = &'static str> {
    list().iter().map(|listing| listing.name)
}

/// A spectrum by its name, without regard to case.
///
/// # Errors
/// A name that is not in the catalogue; the error names a near one.
pub fn find(name: &str) -> Result<Entry> {
    let listing = list()
        .iter()
        .find(|listing| listing.name.eq_ignore_ascii_case(name))
        .ok_or_else(|| Error::unknown_name("spectrum", name, names()).expected("a name of `abbe spectrum --list`"))?;
    let Listing { name, kind, description, source, file, column } = *listing;
    let spectrum = if file.path == LINES { lines(file.text, column) } else { table(file.text, column, kind.outside()) };
    Ok(Entry { name, kind, description, source, spectrum })
}

/// The symbols of the metals.
pub fn metal_names() -> impl Iterator<Item = &'static str> {
    metals().map(|[symbol, ..]| symbol)
}

/// The complex index n + ik of a metal, as n and k, by its symbol or its English name, without regard to case.
///
/// # Errors
/// A name that is not known; the error names a near one.
pub fn metal(name: &str) -> Result<(Spectrum, Spectrum)> {
    let known = |[symbol, full, also, _]: &[&'static str; 4]| {
        [symbol, full, also].iter().any(|known| !known.is_empty() && known.eq_ignore_ascii_case(name))
    };
    let Some([symbol, ..]) = metals().find(known) else {
        let candidates = metals().flat_map(|[symbol, full, ..]| [symbol, full]);
        let symbols: Vec<&str> = metal_names().collect();
        return Err(Error::unknown_name("metal", name, candidates).expected(symbols.join(", ")));
    };
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for row in METALS_NK.lines().filter(|row| row.split(',').next() == Some(symbol)) {
        columns.iter_mut().zip(row.split(',').skip(1)).for_each(|(column, cell)| column.push(number(cell)));
    }
    let [nm, n, k] = columns;
    let spectrum = |values: &[f64]| {
        Spectrum::table(&nm, values, Outside::Hold).expect("a built-in table of a metal is a good table")
    };
    Ok((spectrum(&n), spectrum(&k)))
}

/// Symbol, name, another spelling (or nothing) and reference of every metal.
fn metals() -> impl Iterator<Item = [&'static str; 4]> {
    METALS.lines().skip(1).map(cells)
}

fn cells<const N: usize>(row: &'static str) -> [&'static str; N] {
    let mut rest = row.splitn(N, ',');
    std::array::from_fn(|_| rest.next().expect("a row of a built-in catalogue has all its columns"))
}

fn listing(row: &'static str) -> Listing {
    let [name, kind, path, column, description] = cells(row);
    let kind = Kind::ALL.into_iter().find(|known| known.name() == kind).expect("the catalogue names known kinds");
    let file = FILES.iter().chain(&MEDIA).find(|file| file.path == path).expect("the catalogue names built-in files");
    Listing { name, kind, description, source: file.source, file, column }
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a built-in table holds numbers")
}

/// The first columns of a table with a header line.
pub(crate) fn columns<const N: usize>(text: &str) -> [Vec<f64>; N] {
    let mut columns = std::array::from_fn(|_| Vec::new());
    for row in text.lines().skip(1) {
        columns.iter_mut().zip(row.split(',')).for_each(|(column, cell)| column.push(number(cell)));
    }
    columns
}

/// A column of a table with wavelengths in its first column.
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
    Spectrum::table(&nm, &values, outside).expect("a built-in table is a good table")
}

/// The lines of one lamp, from rows of lamp, nm and power.
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
    Spectrum::lines(&lines).expect("the built-in lines are good lines")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_can_be_had_and_has_power_in_the_band() {
        assert!(list().len() >= 190);
        for listing in list() {
            let entry = find(&listing.name.to_uppercase()).unwrap();
            assert_eq!(entry.name, listing.name);
            assert!(entry.spectrum.integral() > 0.0 && entry.spectrum.min() >= 0.0, "{}", entry.name);
            if matches!(entry.kind, Kind::Reflectance | Kind::Transmittance) {
                assert!(entry.spectrum.max() <= 1.0, "{}", entry.name);
            }
        }
    }

    #[test]
    fn every_file_is_in_the_catalogue() {
        for file in FILES.iter().chain(&MEDIA) {
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
    fn a_slip_is_answered_with_the_near_name() {
        let error = find("sodium-low-presure").unwrap_err();
        assert_eq!(error.near.as_deref(), Some("sodium-low-pressure"));
        assert_eq!(metal("sliver").unwrap_err().near.as_deref(), Some("silver"));
    }

    #[test]
    fn metals_answer_to_symbol_and_name() {
        assert_eq!(metal("gold").unwrap(), metal("Au").unwrap());
        assert_eq!(metal("Aluminum").unwrap(), metal("aluminium").unwrap());
        assert_eq!(metal_names().count(), 11);
        let (n, k) = metal("Ag").unwrap();
        assert!((n.at(400.0) - 0.05).abs() < 0.01 && (k.at(400.0) - 2.103_522_013).abs() < 1e-8);
    }
}
