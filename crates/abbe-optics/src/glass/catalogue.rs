//! The catalogue of transparent materials, parsed from `data/glass/glasses.json` on first use.

use std::sync::LazyLock;

use serde::Deserialize;

use super::dispersion::{Dispersion, PowerTerm, SellmeierTerm};
use super::extinction::Extinction;
use super::index::{ReferenceMedium, RefractiveIndex};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;
use glam::{DMat3, DVec3};

/// The kind of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GlassKind {
    /// An optical or technical glass.
    Glass,
    /// A glass ceramic.
    GlassCeramic,
    /// A crystal, with an entry for the ordinary (o) and extraordinary (e) index if birefringent.
    Crystal,
    /// A plastic.
    Polymer,
    /// A liquid.
    Liquid,
    /// A gas.
    Gas,
}

/// A least-squares fit of n = a + b/λ² + c/λ⁴, where λ is in µm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CauchyFit {
    /// Coefficient a, dimensionless.
    pub a: f64,
    /// Coefficient b in µm².
    pub b: f64,
    /// Coefficient c in µm⁴.
    pub c: f64,
    /// The largest absolute difference between the fit and the formula within the fitted range.
    pub max_error: f64,
    /// The fitted wavelength range in nm.
    pub range_nm: (f64, f64),
}

impl CauchyFit {
    /// Fits an index at whole nm of the band within its range, or fails with fewer than three.
    pub(super) fn fit(index: &RefractiveIndex) -> Result<Self> {
        let (from, to) = index.range_nm();
        let (from, to) = (from.max(BAND_NM.0), to.min(BAND_NM.1));
        let nm: Vec<f64> = (from.ceil() as u32..=to.floor() as u32).map(f64::from).collect();
        if nm.len() < 3 {
            return Err(Error::input(format!(
                "a range that contains {} whole nanometres of the band (360 to 830 nm)",
                nm.len()
            ))
            .expected("at least 3"));
        }
        // Centred on the mean of x = λ⁻², the normal equations are well conditioned.
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
    /// Name as published.
    pub name: String,
    /// Kind of the material.
    pub kind: GlassKind,
    /// Refractive index n(λ) with its range of validity.
    pub index: RefractiveIndex,
    /// The medium to which n is relative.
    pub relative_to: ReferenceMedium,
    /// At which n was measured in K, or `None` if the source does not state it.
    pub temperature_k: Option<f64>,
    /// `None` if the source does not contain it.
    pub extinction: Option<Extinction>,
    /// Cauchy fit of n.
    pub cauchy: CauchyFit,
    /// Source of the data.
    pub source: String,
}

impl Glass {
    /// Returns the Cauchy fit as an index, or an error if the fit is below 1 in the band.
    pub fn cauchy_index(&self) -> Result<RefractiveIndex> {
        let CauchyFit { a, b, c, range_nm, max_error: _ } = self.cauchy;
        let mut index = RefractiveIndex::new(Dispersion::Cauchy { a, b, c }, range_nm)?;
        index.set_warning(&format!("{} (Cauchy fit)", self.name), self.relative_to);
        Ok(index)
    }

    /// Returns the absorption coefficient in 1/m, if the source contains it.
    pub fn absorption_per_m(&self, wavelength_nm: f64) -> Option<f64> {
        self.extinction.as_ref().map(|extinction| extinction.absorption_per_m(wavelength_nm))
    }

    /// Returns the internal transmittance, without the reflection losses at the faces, of a piece
    /// of `length_m` metres, if the source contains the extinction coefficient.
    pub fn internal_transmittance(&self, wavelength_nm: f64, length_m: f64) -> Option<f64> {
        self.extinction.as_ref().map(|extinction| extinction.internal_transmittance(wavelength_nm, length_m))
    }
}

impl RefractiveIndex {
    /// Returns the Cauchy fit of a material of the catalogue, whose error is
    /// [`CauchyFit::max_error`]. Returns an error if the name is unknown.
    pub fn catalogue_cauchy(name: &str) -> Result<Self> {
        find(name)?.cauchy_index()
    }
}

/// The text after "expected" in the error for a name that is not in the catalogue.
pub const EXPECTED_NAME: &str = "a glass of the built-in catalogue";

/// Returns the names of all materials in the order of the file.
pub fn names() -> impl Iterator<Item = &'static str> {
    GLASSES.iter().map(|glass| glass.name.as_str())
}

/// Returns all materials in the order of the file.
pub fn all() -> &'static [Glass] {
    &GLASSES
}

/// Returns the material `name`, in any case; without a qualifier (`water 20C`), the first match.
/// The error for an unknown name suggests the most similar one.
pub fn find(name: &str) -> Result<&'static Glass> {
    let wanted = name.to_lowercase();
    let found = GLASSES.iter().find(|glass| glass.name.to_lowercase() == wanted);
    let found =
        found.or_else(|| GLASSES.iter().find(|glass| glass.name.to_lowercase().starts_with(&format!("{wanted} "))));
    found.ok_or_else(|| Error::unknown_name("glass", name, names()).expected(EXPECTED_NAME))
}

static GLASSES: LazyLock<Vec<Glass>> = LazyLock::new(|| {
    let text = include_str!("../../data/glass/glasses.json");
    let file: GlassesFile = serde_json::from_str(text).expect("a test parses the embedded catalogue");
    file.glasses.into_iter().map(Glass::from).collect()
});

#[derive(Deserialize)]
struct GlassesFile {
    glasses: Vec<GlassEntry>,
}

#[derive(Deserialize)]
struct GlassEntry {
    name: String,
    kind: GlassKind,
    dispersion: DispersionEntry,
    range_nm: (f64, f64),
    relative_to: ReferenceMedium,
    cauchy: CauchyFitEntry,
    temperature_k: Option<f64>,
    extinction: Option<ExtinctionEntry>,
    source: String,
    original: String,
}

#[derive(Deserialize)]
struct CauchyFitEntry {
    a: f64,
    b_um2: f64,
    c_um4: f64,
    range_nm: (f64, f64),
    max_error: f64,
}

#[derive(Deserialize)]
struct ExtinctionEntry {
    nm: Vec<f64>,
    k: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum DispersionEntry {
    Sellmeier { c0: f64, b: Vec<f64>, c_um2: Vec<f64> },
    PowerSeriesN2 { c0: f64, c: Vec<f64>, p: Vec<i32> },
    PowerSeriesN { c0: f64, c: Vec<f64>, p: Vec<i32> },
    RiiFormula4([f64; 9]),
    Gas { c0: f64, b: Vec<f64>, c_per_um2: Vec<f64> },
    Table { nm: Vec<f64>, n: Vec<f64> },
}

impl From<DispersionEntry> for Dispersion {
    fn from(formula: DispersionEntry) -> Self {
        let poles = |b: Vec<f64>, c: Vec<f64>| b.into_iter().zip(c).map(|(b, c)| SellmeierTerm { b, c }).collect();
        let powers = |c: Vec<f64>, p: Vec<i32>| c.into_iter().zip(p).map(|(c, p)| PowerTerm { c, p }).collect();
        match formula {
            DispersionEntry::Sellmeier { c0, b, c_um2 } => Self::Sellmeier { c0, poles: poles(b, c_um2) },
            DispersionEntry::PowerSeriesN2 { c0, c, p } => Self::SquaredPowers { c0, powers: powers(c, p) },
            DispersionEntry::PowerSeriesN { c0, c, p } => Self::Powers { c0, powers: powers(c, p) },
            DispersionEntry::RiiFormula4(c) => Self::Rational(Box::new(c)),
            DispersionEntry::Gas { c0, b, c_per_um2 } => Self::Gas { c0, poles: poles(b, c_per_um2) },
            DispersionEntry::Table { nm, n } => Self::Table { nm: nm.into(), n: n.into() },
        }
    }
}

impl From<GlassEntry> for Glass {
    fn from(entry: GlassEntry) -> Self {
        let mut index = RefractiveIndex::new(entry.dispersion.into(), entry.range_nm)
            .expect("a test parses the embedded catalogue");
        index.set_warning(&entry.name, entry.relative_to);
        let CauchyFitEntry { a, b_um2, c_um4, range_nm, max_error } = entry.cauchy;
        Self {
            index,
            name: entry.name,
            kind: entry.kind,
            relative_to: entry.relative_to,
            temperature_k: entry.temperature_k,
            extinction: entry.extinction.map(|ExtinctionEntry { nm, k }| Extinction { nm, k }),
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
        assert_eq!(all().len(), 117);
        for glass in all() {
            let table = if let Dispersion::Table { nm, n } = glass.index.dispersion() {
                Some((nm.to_vec(), n.len()))
            } else {
                None
            };
            let extinction = glass.extinction.as_ref().map(|extinction| (extinction.nm.clone(), extinction.k.len()));
            for (nm, values) in table.into_iter().chain(extinction) {
                assert_eq!(nm.len(), values, "{}", glass.name);
                assert!(nm.windows(2).all(|pair| pair[0] < pair[1]), "{}", glass.name);
            }
            assert!(glass.cauchy.max_error < 5e-3, "{}", glass.name);
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

    #[test]
    fn outside_its_range_an_index_holds_the_value_at_the_end() {
        let index = RefractiveIndex::catalogue("N-SF10").unwrap();
        assert_eq!(index.range_nm(), (380.0, 2500.0));
        assert_eq!(index.n(360.0), index.n(380.0));
        assert!(index.n(380.0) > index.n(381.0));
        let warning = index.warning().unwrap();
        assert!(warning.contains("380 to 2500 nm") && crate::glass::is_negligible(warning), "{warning}");
        let water = RefractiveIndex::table(&[420.0, 700.0], &[1.34, 1.33]).map(|mut index| {
            index.set_warning("water", ReferenceMedium::Air);
            index
        });
        assert!(!crate::glass::is_negligible(water.unwrap().warning().unwrap()));
        assert_eq!(RefractiveIndex::catalogue("N-BK7").unwrap().warning(), None);
        assert!(RefractiveIndex::catalogue("air (Ciddor)").unwrap().warning().unwrap().contains("relative to vacuum"));
    }

    #[test]
    fn the_catalogue_s_cauchy_fit_stays_within_its_stated_error() {
        for name in ["N-BK7", "N-SF10", "diamond", "water 20C"] {
            let (exact, fit) =
                (RefractiveIndex::catalogue(name).unwrap(), RefractiveIndex::catalogue_cauchy(name).unwrap());
            let bound = find(name).unwrap().cauchy.max_error;
            let (from, to) = fit.range_nm();
            let mut worst: f64 = 0.0;
            for step in 0..=((to - from) / 5.0) as usize {
                let nm = from + 5.0 * step as f64;
                worst = worst.max((exact.n(nm) - fit.n(nm)).abs());
            }
            // The coefficients of the fits are stored with 11 digits.
            assert!(worst <= bound + 1e-10, "{name}: {worst} > {bound}");
            assert!(worst >= bound * 0.99, "{name}: the stated error {bound} is not reached ({worst})");
        }
    }
}
