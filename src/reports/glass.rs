//! The refractive index of a glass.

use abbe_optics::glass::catalogue::{Glass, GlassKind};
use abbe_optics::glass::{CauchyFit, Dispersion, SellmeierTerm};
use abbe_session::output::plot::{SpectralCurve, SpectralPlot};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;
use serde::Serialize;

/// The optical data of a glass.
#[derive(Debug, Serialize)]
pub struct GlassReport<'a> {
    pub name: &'a str,
    /// The kind of material, such as `glass` or `crystal`.
    pub kind: &'static str,
    /// The index at the d line.
    pub nd: f64,
    /// The Abbe number. `None` if `range_nm` does not contain the wavelengths of the F and C lines.
    pub vd: Option<f64>,
    /// The wavelengths in nm at which the data is valid.
    pub range_nm: [f64; 2],
    /// `None` if the data of the material does not use the Sellmeier formula.
    pub sellmeier: Option<SellmeierCoefficients>,
    pub cauchy: CauchyFit,
    /// The index at the requested wavelengths. JSON leaves an empty list out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub n: Vec<IndexSample>,
    pub source: &'a str,
    /// A restriction of the data.
    pub warning: Option<&'a str>,
}

/// The Sellmeier formula n² = 1 + c0 + Σ b λ²/(λ² − c), with λ in µm.
#[derive(Debug, Serialize)]
pub struct SellmeierCoefficients {
    /// The constant term beyond 1.
    pub c0: f64,
    /// The strengths of the poles.
    pub b: Vec<f64>,
    /// The squared wavelengths of the poles in µm².
    pub c: Vec<f64>,
}

#[derive(Debug, Serialize)]
pub struct IndexSample {
    /// The wavelength in nm.
    pub nm: f64,
    pub n: f64,
}

#[derive(Debug, Serialize)]
pub struct GlassList<'a> {
    /// The entries, in the order of the catalogue.
    pub glasses: Vec<GlassListing<'a>>,
}

/// An entry of the list. [`GlassReport`] defines the quantities.
#[derive(Debug, Serialize)]
pub struct GlassListing<'a> {
    pub name: &'a str,
    pub kind: &'static str,
    pub nd: f64,
    pub vd: Option<f64>,
}

impl<'a> GlassList<'a> {
    pub fn of(glasses: &'a [Glass]) -> Self {
        let listed = |glass: &'a Glass| {
            let Glass { name, kind, index, .. } = glass;
            GlassListing { name, kind: kind_word(*kind), nd: index.nd(), vd: index.vd() }
        };
        Self { glasses: glasses.iter().map(listed).collect() }
    }
}

/// Returns the indices of a glass at wavelengths in nm, or an error if one outside the visible band
/// is also outside the valid range of the data.
pub fn indices(glass: &Glass, nm: &[f64]) -> Result<Vec<f64>> {
    let (from, to) = glass.index.range_nm();
    let is_valid = |nm: f64| (BAND_NM.0..=BAND_NM.1).contains(&nm) || (from..=to).contains(&nm);
    if let Some(bad) = nm.iter().find(|&&nm| !is_valid(nm)) {
        let what = format!("the index of {} at {bad} nm", glass.name);
        return Err(Error::input(what).expected(format!("wavelengths from {from} to {to} nm")));
    }
    Ok(nm.iter().map(|&nm| glass.index.n(nm)).collect())
}

impl<'a> GlassReport<'a> {
    /// Describes a glass, with its index at wavelengths in nm.
    pub fn of(glass: &'a Glass, nm: &[f64]) -> Result<Self> {
        let index = &glass.index;
        let (from, to) = index.range_nm();
        Ok(Self {
            name: &glass.name,
            kind: kind_word(glass.kind),
            nd: index.nd(),
            vd: index.vd(),
            range_nm: [from, to],
            sellmeier: sellmeier(index.dispersion()),
            cauchy: glass.cauchy,
            n: nm.iter().zip(indices(glass, nm)?).map(|(&nm, n)| IndexSample { nm, n }).collect(),
            source: &glass.source,
            warning: index.warning(),
        })
    }
}

fn sellmeier(dispersion: &Dispersion) -> Option<SellmeierCoefficients> {
    match dispersion {
        Dispersion::Sellmeier { c0, poles } => {
            let (b, c) = poles.iter().map(|&SellmeierTerm { b, c }| (b, c)).unzip();
            Some(SellmeierCoefficients { c0: *c0, b, c })
        }
        Dispersion::Constant(_)
        | Dispersion::Cauchy { .. }
        | Dispersion::SquaredPowers { .. }
        | Dispersion::Powers { .. }
        | Dispersion::Rational(_)
        | Dispersion::Gas { .. }
        | Dispersion::Conrady { .. }
        | Dispersion::Herzberger(_)
        | Dispersion::Table { .. } => None,
    }
}

fn kind_word(kind: GlassKind) -> &'static str {
    match kind {
        GlassKind::Glass => "glass",
        GlassKind::GlassCeramic => "glass ceramic",
        GlassKind::Crystal => "crystal",
        GlassKind::Polymer => "polymer",
        GlassKind::Liquid => "liquid",
        GlassKind::Gas => "gas",
    }
}

/// Plots the refractive index over its range of wavelengths, together with the Cauchy fit.
pub fn plot(glass: &Glass) -> SpectralPlot {
    let (from, to) = glass.index.range_nm();
    let CauchyFit { a, b, c, range_nm, .. } = glass.cauchy;
    let fit = Dispersion::Cauchy { a, b, c };
    let curve = |name: &str, (from, to): (f64, f64), n: &dyn Fn(f64) -> f64| {
        let (from, to) = (from.max(BAND_NM.0), to.min(BAND_NM.1));
        let points = (0..=235).map(|i| from + (to - from) * f64::from(i) / 235.0).map(|nm| (nm, n(nm))).collect();
        SpectralCurve { name: name.to_string(), points }
    };
    let own = curve(&glass.name, (from, to), &|nm| glass.index.n(nm));
    let cauchy = curve("Cauchy fit", range_nm, &|nm| fit.n(nm));
    SpectralPlot {
        title: format!("{}: index of refraction", glass.name),
        values: "n".to_string(),
        curves: vec![own, cauchy],
        lines: Vec::new(),
        from_zero: false,
    }
}
