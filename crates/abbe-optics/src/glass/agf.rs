//! Zemax glass catalogues (`.agf`): lists of operands, one per line, where those of a glass follow
//! its `NM` line.
//!
//! The reader uses `NM` (name and formula number), `CD` (coefficients for λ in µm) and `LD`
//! (wavelength range in µm). The indices are relative to air. All other operands are ignored,
//! because they do not affect n(λ) at the reference temperature of the catalogue.

use std::path::{Path, PathBuf};

use super::catalogue::{CauchyFit, Glass, GlassKind};
use super::dispersion::{Dispersion, PowerTerm, SellmeierTerm};
use super::index::{ReferenceMedium, RefractiveIndex};
use crate::zemax_text::decoded;
use abbe_spectra::error::{Error, Result};

/// A parsed catalogue, in which [`AgfCatalogue::find`] checks the formula of a glass.
#[derive(Debug, Clone)]
pub struct AgfCatalogue {
    path: PathBuf,
    last_resort: bool,
    glasses: Vec<AgfRow>,
}

#[derive(Debug, Clone)]
struct AgfRow {
    line: usize,
    name: String,
    formula: u32,
    coefficients: Vec<f64>,
    range_um: Option<(f64, f64)>,
}

impl AgfCatalogue {
    /// Parses a catalogue from the bytes of a file. Returns an error with `path` and the line
    /// number if the file is not an AGF catalogue or a number is malformed.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self> {
        let expected = "a Zemax glass catalogue: lines NM, CD and LD for each glass";
        let fault = |what: &str| Error::input(what).expected(expected).in_file(path);
        let text = decoded(bytes).ok_or_else(|| fault("the file is not text"))?;
        let mut glasses: Vec<AgfRow> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let mut words = line.split_whitespace();
            let operand = words.next().unwrap_or_default();
            let words: Vec<&str> = words.collect();
            let read = match (operand, glasses.last_mut()) {
                ("NM", _) => row(i + 1, &words).map(|row| glasses.push(row)),
                ("CD", Some(glass)) => numbers(&words).map(|numbers| glass.coefficients = numbers),
                ("LD", Some(glass)) => numbers(&words).map(|numbers| {
                    glass.range_um = numbers.first().copied().zip(numbers.get(1).copied());
                }),
                (_, _) => Ok(()),
            };
            read.map_err(|error| error.at(i + 1, 1).in_file(path))?;
        }
        if glasses.is_empty() {
            return Err(fault("found no glass"));
        }
        Ok(Self { path: path.to_path_buf(), last_resort: false, glasses })
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes a lens file use this catalogue only for names that the built-in catalogues lack.
    #[must_use]
    pub fn as_last_resort(self) -> Self {
        Self { last_resort: true, ..self }
    }

    /// Makes a lens file use this catalogue before the built-in ones, as if it were parsed anew.
    #[must_use]
    pub fn as_first_choice(self) -> Self {
        Self { last_resort: false, ..self }
    }

    /// Returns true after [`AgfCatalogue::as_last_resort`].
    pub fn is_last_resort(&self) -> bool {
        self.last_resort
    }

    /// Returns the names of the glasses in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.glasses.iter().map(|glass| glass.name.as_str())
    }

    /// Returns true if the catalogue contains a glass of this name; case is ignored.
    pub fn has(&self, name: &str) -> bool {
        self.names().any(|own| own.eq_ignore_ascii_case(name))
    }

    /// Returns the glass of this name; case is ignored. Returns an error if the name is unknown,
    /// the formula is not supported, or the coefficients give no valid index.
    pub fn find(&self, name: &str) -> Result<Glass> {
        let row = self.glasses.iter().find(|glass| glass.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
            Error::unknown_name("glass", name, self.names()).expected(format!("a glass of {}", self.path.display()))
        })?;
        let placed = |error: Error| error.at(row.line, 1).in_file(&self.path);
        let missing = || Error::input(format!("{} has no wavelength range", row.name)).expected("an LD line");
        let (from_um, to_um) = row.range_um.ok_or_else(missing).map_err(placed)?;
        let range_nm = (1e3 * from_um, 1e3 * to_um);
        let dispersion = dispersion(row).map_err(placed)?;
        let mut index = RefractiveIndex::new(dispersion, range_nm).map_err(placed)?;
        index.set_warning(&row.name, ReferenceMedium::Air);
        let cauchy = CauchyFit::fit(&index).map_err(placed)?;
        Ok(Glass {
            name: row.name.clone(),
            kind: GlassKind::Glass,
            index,
            relative_to: ReferenceMedium::Air,
            temperature_k: None,
            extinction: None,
            cauchy,
            source: self.path.display().to_string(),
        })
    }
}

fn row(line: usize, words: &[&str]) -> Result<AgfRow> {
    let number = |word: &&str| word.parse::<f64>().ok().filter(|number| number.fract() == 0.0 && *number >= 1.0);
    match words {
        [name, formula, ..] if number(formula).is_some() => {
            let formula = number(formula).unwrap_or_default() as u32;
            Ok(AgfRow { line, name: (*name).to_string(), formula, coefficients: Vec::new(), range_um: None })
        }
        _ => Err(Error::input("found a glass without a name or formula").expected("NM, a name and a formula number")),
    }
}

fn numbers(words: &[&str]) -> Result<Vec<f64>> {
    let number = |word: &&str| {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| Error::input(format!("found \"{word}\"")).expected("a number"))
    };
    words.iter().map(number).collect()
}

/// Converts coefficients, 0 where missing, to a formula by its number in the manual.
fn dispersion(row: &AgfRow) -> Result<Dispersion> {
    let c: [f64; 10] = std::array::from_fn(|i| row.coefficients.get(i).copied().unwrap_or(0.0));
    let poles = |count: usize| (0..count).map(|i| SellmeierTerm { b: c[2 * i], c: c[2 * i + 1] }).collect();
    let squared = |powers: &[i32]| {
        let power = |(i, &p): (usize, &i32)| PowerTerm { c: c[i + 1], p };
        Dispersion::SquaredPowers { c0: c[0], powers: powers.iter().enumerate().map(power).collect() }
    };
    // The terms are c₁ to c₉ of n² = c₁ + c₂ λ^c₃/(λ² − c₄^c₅) + c₆ λ^c₇/(λ² − c₈^c₉).
    let rational = |terms: [f64; 9]| Dispersion::Rational(Box::new(terms));
    Ok(match row.formula {
        // Schott.
        1 => squared(&[2, -2, -4, -6, -8]),
        // Sellmeier 1, 3 and 5: pairs of strength and squared resonance wavelength.
        2 => Dispersion::Sellmeier { c0: 0.0, poles: poles(3) },
        6 => Dispersion::Sellmeier { c0: 0.0, poles: poles(4) },
        11 => Dispersion::Sellmeier { c0: 0.0, poles: poles(5) },
        3 => Dispersion::Herzberger(Box::new([c[0], c[1], c[2], c[3], c[4], c[5]])),
        // Sellmeier 2: resonance wavelengths are not squared, and the second numerator has no λ².
        4 => rational([1.0 + c[0], c[1], 2.0, c[2], 2.0, c[3], 0.0, c[4], 2.0]),
        5 => Dispersion::Conrady { a: c[0], b: c[1], c: c[2] },
        // Handbook of Optics 1 and 2.
        7 => rational([c[0], c[1], 0.0, c[2], 1.0, -c[3], 4.0, 0.0, 1.0]),
        8 => rational([c[0], c[1], 2.0, c[2], 1.0, -c[3], 4.0, 0.0, 1.0]),
        // Sellmeier 4.
        9 => Dispersion::Sellmeier {
            c0: c[0] - 1.0,
            poles: [SellmeierTerm { b: c[1], c: c[2] }, SellmeierTerm { b: c[3], c: c[4] }].into(),
        },
        // Extended 1 and 2.
        10 => squared(&[2, -2, -4, -6, -8, -10, -12]),
        12 => squared(&[2, -2, -4, -6, -8, 4, 6]),
        // Extended 3.
        13 => squared(&[2, 4, -2, -4, -6, -8, -10, -12]),
        other => {
            let what = format!("formula {other} of {} is not supported", row.name);
            return Err(Error::input(what).expected("a formula from 1 to 13"));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glass::catalogue;

    /// N-BK7 has Schott's coefficients in the new form, and BK7 in the old form. The glasses for
    /// the other formulas are synthetic.
    const FILE: &str = "CC a few glasses\r\n\
        NM N-BK7 2 517642.251 1.5168 64.17 0 1 -1\r\nGC \r\nED 7.1 8.3 2.51 -0.0009 0\r\n\
        CD 1.03961212E+0 6.00069867E-3 2.31792344E-1 2.00179144E-2 1.01046945E+0 1.03560653E+2 0 0 0 0\r\n\
        TD 1.86E-6 1.31E-8\r\nLD 3.1E-1 2.325E+0\r\nIT 3.1E-1 0.3 2.5E+1\r\n\
        NM BK7 1 517642 1.5168 64.17 1 1\nCD 2.2718929E+0 -1.0108077E-2 1.0592509E-2 2.0816965E-4 -7.6472538E-6 4.9240991E-7\nLD 0.33 2.325\n\
        NM FOUR 4 0 0 0\nCD 0.3 1.0 0.1 0.01 0.2\nLD 0.36 1\nNM FIVE 5 0 0 0\nCD 1.5 0.01 0.002\nLD 0.36 1\n\
        NM THREE 3 0 0 0\nCD 1.5 0.004 0.0001 -0.002 0.0001 0\nLD 0.36 1\nNM EIGHT 8 0 0 0\nCD 2.2 0.05 0.03 0.01\nLD 0.36 1\n\
        NM SEVEN 7 0 0 0\nCD 2.2 0.02 0.03 0.01\nLD 0.36 1\n\
        NM LATE 14 0 0 0\nCD 1\nLD 0.36 1\nNM BARE 2 0 0 0\nCD 1 0.01\n\
        NM THIRTEEN 13 0 0 0\nCD 2.2 -0.01 -2E-4 0.02 1E-4 2E-5 3E-6 -4E-7 5E-8\nLD 0.36 1\n";

    fn file() -> AgfCatalogue {
        AgfCatalogue::parse(FILE.as_bytes(), "a.agf".as_ref()).unwrap()
    }

    #[test]
    fn a_known_glass_has_its_known_index_by_either_formula() {
        let file = file();
        assert_eq!(file.names().count(), 10);
        let known = &catalogue::find("N-BK7").unwrap().index;
        for nm in [365.0, 486.1327, 587.5618, 656.2725, 800.0] {
            assert!((file.find("n-bk7").unwrap().index.n(nm) - known.n(nm)).abs() < 1e-12);
            assert!((file.find("BK7").unwrap().index.n(nm) - known.n(nm)).abs() < 5e-6, "{nm}");
        }
        assert_eq!(file.find("N-BK7").unwrap().index.range_nm(), (310.0, 2325.0));
        let fit = file.find("N-BK7").unwrap().cauchy;
        assert!(fit.max_error > 1e-6 && fit.max_error < 3e-4, "{fit:?}");
    }

    #[test]
    fn the_other_formulas_are_those_of_the_manual() {
        let (file, um) = (file(), 0.5_f64);
        let n = |name: &str| file.find(name).unwrap().index.n(1e3 * um);
        let l = 1.0 / (um * um - 0.028);
        let near = |found: f64, known: f64| assert!((found - known).abs() < 1e-14, "{found} {known}");
        near(n("THREE"), 1.5 + 0.004 * l + 0.0001 * l * l - 0.002 * um * um + 0.0001 * um.powi(4));
        near(n("FOUR").powi(2), 1.3 + um * um / (um * um - 0.01) + 0.01 / (um * um - 0.04));
        near(n("FIVE"), 1.5 + 0.01 / um + 0.002 / um.powf(3.5));
        near(n("SEVEN").powi(2), 2.2 + 0.02 / (um * um - 0.03) - 0.01 * um * um);
        let powers =
            [(-0.01, 2), (-2e-4, 4), (0.02, -2), (1e-4, -4), (2e-5, -6), (3e-6, -8), (-4e-7, -10), (5e-8, -12)];
        near(n("THIRTEEN").powi(2), 2.2 + powers.iter().map(|(c, p)| c * um.powi(*p)).sum::<f64>());
        near(n("EIGHT").powi(2), 2.2 + 0.05 * um * um / (um * um - 0.03) - 0.01 * um * um);
    }

    #[test]
    fn unusable_glasses_are_reported_with_their_line() {
        let file = file();
        let told = |result: Result<Glass>, words: &[&str]| {
            let text = result.unwrap_err().to_string();
            assert!(words.iter().all(|word| text.contains(word)), "{text}");
        };
        told(file.find("LATE"), &["a.agf:27:1", "formula 14 of LATE", "1 to 13"]);
        told(file.find("BARE"), &["a.agf:30:1", "no wavelength range", "LD"]);
        told(file.find("N-BK8"), &["unknown glass \"N-BK8\"", "N-BK7", "a glass of a.agf"]);
        let parse = |text: &str| AgfCatalogue::parse(text.as_bytes(), "a.agf".as_ref()).unwrap_err().to_string();
        assert!(parse("hello\n").contains("found no glass"));
        assert!(parse("NM A two\n").contains("a.agf:1:1"));
        assert!(parse("NM A 2\nCD 1 x\n").contains("a.agf:2:1: found \"x\""));
    }
}
