//! The catalogue of transparent materials: `data/glass/glasses.json`, read once, at the first look-up.

use std::sync::LazyLock;

use serde::Deserialize;

use super::dispersion::{Dispersion, Pole, Power};
use super::extinction::Extinction;
use super::index::Index;
use crate::error::{Error, Result};
use crate::spectrum::BAND_NM;
use glam::{DMat3, DVec3};

/// What a material is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// An optical or technical glass.
    Glass,
    /// A glass ceramic.
    GlassCeramic,
    /// A crystal; of a birefringent one the ordinary (o) or extraordinary (e) index.
    Crystal,
    /// A plastic.
    Polymer,
    /// A liquid.
    Liquid,
    /// A gas.
    Gas,
}

/// The medium in which light is as fast as n = 1 says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RelativeTo {
    /// Air at 20–22 °C and 101 325 Pa, as catalogues quote it.
    Air,
    /// Vacuum.
    Vacuum,
    /// The source does not say; the difference is 3e-4.
    Unstated,
}

/// A least-squares fit of n = a + b/λ² + c/λ⁴, λ in µm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CauchyFit {
    /// Without unit.
    pub a: f64,
    /// In µm².
    pub b: f64,
    /// In µm⁴.
    pub c: f64,
    /// The wavelengths in nm that were fitted.
    pub range_nm: (f64, f64),
    /// The largest |difference| from the material's own formula within them.
    pub max_error: f64,
}

impl CauchyFit {
    /// The fit to an index, at every nm of the band that lies within its range.
    ///
    /// # Errors
    /// The input's: a range that leaves fewer than three wavelengths.
    pub(super) fn to(index: &Index) -> Result<Self> {
        let (from, to) = index.range_nm();
        let (from, to) = (from.max(BAND_NM.0), to.min(BAND_NM.1));
        let nm: Vec<f64> = (from.ceil() as u32..=to.floor() as u32).map(f64::from).collect();
        if nm.len() < 3 {
            return Err(Error::input(format!("a range that leaves {} whole nm of 360 to 830", nm.len()))
                .expected("an index that is known where light is seen"));
        }
        // The normal equations in x = λ⁻², about its middle for the digits' sake.
        let x = |nm: f64| 1e6 / (nm * nm);
        let middle = nm.iter().map(|&nm| x(nm)).sum::<f64>() / nm.len() as f64;
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for &nm in &nm {
            let d = x(nm) - middle;
            let row = DVec3::new(1.0, d, d * d);
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            right += row * index.n(nm);
        }
        let DVec3 { x: p, y: q, z: r } = matrix.inverse() * right;
        let (a, b, c) = (p - middle * (q - middle * r), q - 2.0 * middle * r, r);
        let fit = Dispersion::Cauchy { a, b, c };
        let max_error = nm.iter().map(|&nm| (index.n(nm) - fit.n(nm)).abs()).fold(0.0, f64::max);
        Ok(Self { a, b, c, range_nm: (from, to), max_error })
    }
}

/// A material of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct Glass {
    /// The name, as published.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// n(λ) and the range in which it holds.
    pub index: Index,
    /// What n is relative to.
    pub relative_to: RelativeTo,
    /// The temperature in K at which it was measured, if the source says so.
    pub temperature_k: Option<f64>,
    /// The extinction coefficient, if the source gives it.
    pub extinction: Option<Extinction>,
    /// The Cauchy fit.
    pub cauchy: CauchyFit,
    /// Where the numbers come from.
    pub source: String,
}

impl Glass {
    /// The Cauchy fit as an index. Fails where that falls below 1 in the band.
    pub fn cauchy_index(&self) -> Result<Index> {
        let CauchyFit { a, b, c, range_nm, max_error: _ } = self.cauchy;
        let mut index = Index::new(Dispersion::Cauchy { a, b, c }, range_nm)?;
        index.explain(&format!("{} (Cauchy fit)", self.name), self.relative_to);
        Ok(index)
    }

    /// The absorption coefficient in 1/m at a wavelength in nm, if the source gives it.
    pub fn absorption_per_m(&self, wavelength_nm: f64) -> Option<f64> {
        self.extinction.as_ref().map(|extinction| extinction.absorption_per_m(wavelength_nm))
    }

    /// The fraction of light at a wavelength in nm that `length_m` metres let through, reflections at the faces left out.
    pub fn internal_transmittance(&self, wavelength_nm: f64, length_m: f64) -> Option<f64> {
        self.extinction.as_ref().map(|extinction| extinction.internal_transmittance(wavelength_nm, length_m))
    }
}

/// The names of all materials, in the file's order.
pub fn names() -> impl Iterator<Item = &'static str> {
    GLASSES.iter().map(|glass| glass.name.as_str())
}

/// All materials, in the file's order.
pub fn all() -> &'static [Glass] {
    &GLASSES
}

/// The material of this name, without regard to case; without its qualifier ("water" for "water 20C") the first of that name. Fails on
/// an unknown name, with the nearest known one.
pub fn find(name: &str) -> Result<&'static Glass> {
    let wanted = name.to_lowercase();
    let found = GLASSES.iter().find(|glass| glass.name.to_lowercase() == wanted);
    let found =
        found.or_else(|| GLASSES.iter().find(|glass| glass.name.to_lowercase().starts_with(&format!("{wanted} "))));
    found.ok_or_else(|| Error::unknown_name("glass", name, names()).expected("a name of `abbe glass --list`"))
}

static GLASSES: LazyLock<Vec<Glass>> = LazyLock::new(|| {
    let text = include_str!("../../../data/glass/glasses.json");
    let file: File = serde_json::from_str(text).expect("a test reads the whole of the embedded catalogue");
    file.glasses.into_iter().map(Glass::from).collect()
});

/// The file as written.
#[derive(Deserialize)]
struct File {
    glasses: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    kind: Kind,
    dispersion: Formula,
    range_nm: (f64, f64),
    relative_to: RelativeTo,
    cauchy: Fit,
    temperature_k: Option<f64>,
    extinction: Option<Measured>,
    source: String,
    original: String,
}

#[derive(Deserialize)]
struct Fit {
    a: f64,
    b_um2: f64,
    c_um4: f64,
    range_nm: (f64, f64),
    max_error: f64,
}

#[derive(Deserialize)]
struct Measured {
    nm: Vec<f64>,
    k: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Formula {
    Sellmeier { c0: f64, b: Vec<f64>, c_um2: Vec<f64> },
    PowerSeriesN2 { c0: f64, c: Vec<f64>, p: Vec<i32> },
    PowerSeriesN { c0: f64, c: Vec<f64>, p: Vec<i32> },
    RiiFormula4([f64; 9]),
    Gas { c0: f64, b: Vec<f64>, c_per_um2: Vec<f64> },
    Table { nm: Vec<f64>, n: Vec<f64> },
}

impl From<Formula> for Dispersion {
    fn from(formula: Formula) -> Self {
        let poles = |b: Vec<f64>, c: Vec<f64>| b.into_iter().zip(c).map(|(b, c)| Pole { b, c }).collect();
        let powers = |c: Vec<f64>, p: Vec<i32>| c.into_iter().zip(p).map(|(c, p)| Power { c, p }).collect();
        match formula {
            Formula::Sellmeier { c0, b, c_um2 } => Self::Sellmeier { c0, poles: poles(b, c_um2) },
            Formula::PowerSeriesN2 { c0, c, p } => Self::SquaredPowers { c0, powers: powers(c, p) },
            Formula::PowerSeriesN { c0, c, p } => Self::Powers { c0, powers: powers(c, p) },
            Formula::RiiFormula4(c) => Self::Rational(Box::new(c)),
            Formula::Gas { c0, b, c_per_um2 } => Self::Gas { c0, poles: poles(b, c_per_um2) },
            Formula::Table { nm, n } => Self::Table { nm: nm.into(), n: n.into() },
        }
    }
}

impl From<Entry> for Glass {
    fn from(entry: Entry) -> Self {
        let mut index = Index::new(entry.dispersion.into(), entry.range_nm)
            .expect("a test reads the whole of the embedded catalogue");
        index.explain(&entry.name, entry.relative_to);
        let Fit { a, b_um2, c_um4, range_nm, max_error } = entry.cauchy;
        Self {
            index,
            name: entry.name,
            kind: entry.kind,
            relative_to: entry.relative_to,
            temperature_k: entry.temperature_k,
            extinction: entry.extinction.map(|Measured { nm, k }| Extinction { nm, k }),
            cauchy: CauchyFit { a, b: b_um2, c: c_um4, range_nm, max_error },
            source: format!("refractiveindex.info, {}: {}", entry.source, entry.original),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_catalogue_is_well_formed() {
        assert_eq!(all().len(), 115);
        for glass in all() {
            let tables = match glass.index.dispersion() {
                Dispersion::Table { nm, n } => Some((nm.to_vec(), n.len())),
                Dispersion::Constant(_)
                | Dispersion::Cauchy { .. }
                | Dispersion::Sellmeier { .. }
                | Dispersion::SquaredPowers { .. }
                | Dispersion::Powers { .. }
                | Dispersion::Rational(_)
                | Dispersion::Gas { .. }
                | Dispersion::Conrady { .. }
                | Dispersion::Herzberger(_) => None,
            };
            let extinction = glass.extinction.as_ref().map(|extinction| (extinction.nm.clone(), extinction.k.len()));
            for (nm, values) in tables.into_iter().chain(extinction) {
                assert_eq!(nm.len(), values, "{}", glass.name);
                assert!(nm.windows(2).all(|pair| pair[0] < pair[1]), "{}", glass.name);
            }
            assert!(glass.cauchy.max_error < 4e-3, "{}", glass.name);
            assert!(glass.index.is_dispersive(), "{}", glass.name);
        }
    }

    #[test]
    fn names_are_unique_and_found_without_regard_to_case() {
        for name in names() {
            assert_eq!(find(&name.to_uppercase()).unwrap().name, name);
            assert_eq!(find(&name.to_lowercase()).unwrap().name, name);
        }
    }

    #[test]
    fn an_unknown_name_brings_the_nearest_one() {
        let message = find("N-BK8").unwrap_err().to_string();
        assert!(message.contains("unknown glass \"N-BK8\"") && message.contains("did you mean"), "{message}");
    }
}
