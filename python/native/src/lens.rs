//! Analyses of lenses.

use std::path::PathBuf;

use pyo3::prelude::*;

use super::errors::OrException;
use super::json::json;
use abbe::reports::folded_lens::FoldedLensReport;
use abbe::reports::lens::{LensPrescription, LensReport, find};
use abbe::reports::lens_page;
use abbe::reports::lens_plots::{self, LensPlot};
use abbe_optics::lens::zemax::ZmxSystem;
use abbe_optics::lens::{AnalysisConditions, Lens, LensAnalysis, SensorFocus, catalogue};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;

/// A lens and its analysis.
#[pyclass(name = "Lens", module = "abbe._native", frozen)]
pub(super) struct NativeLens {
    /// The report of `abbe lens --json`.
    report: String,
    /// `None` for a system with mirrors, which is not drawn.
    drawn: Option<(Lens, LensAnalysis)>,
}

/// The conditions of an analysis.
#[derive(FromPyObject)]
struct LensConditions {
    /// Half the field of view in degrees.
    #[pyo3(item)]
    field: Option<f64>,
    /// In nm.
    #[pyo3(item)]
    wavelengths: Option<Vec<f64>>,
    /// In mm behind the paraxial focus.
    #[pyo3(item)]
    focus: Option<f64>,
    #[pyo3(item)]
    best_focus: bool,
}

impl LensConditions {
    fn checked(self) -> Result<AnalysisConditions> {
        if let Some(degrees) = self.field.filter(|degrees| !(*degrees > 0.0 && *degrees < 90.0)) {
            return Err(Error::input(format!("field: {degrees}")).expected("degrees above 0 and below 90"));
        }
        let mut conditions = AnalysisConditions::default().with_half_field(self.field);
        if let Some(nm) = &self.wavelengths {
            if let Some(outside) = nm.iter().find(|nm| !(BAND_NM.0..=BAND_NM.1).contains(*nm)) {
                let expected = format!("nm from {} to {}", BAND_NM.0, BAND_NM.1);
                return Err(Error::input(format!("wavelengths: {outside}")).expected(expected));
            }
            conditions = conditions.with_wavelengths(nm).map_err(|error| error.on_path("wavelengths"))?;
        }
        Ok(match self.focus {
            _ if self.best_focus => conditions.with_focus(SensorFocus::Best),
            Some(mm) if mm.is_finite() => conditions.with_focus(SensorFocus::Shift(mm)),
            Some(mm) => return Err(Error::input(format!("focus: {mm}")).expected("a distance in mm, or \"best\"")),
            None => conditions,
        })
    }

    /// Returns the field for a system with mirrors, for which nothing else can be chosen.
    fn field_only(self) -> Result<Option<f64>> {
        if self.wavelengths.is_none() && self.focus.is_none() && !self.best_focus {
            return Ok(self.field);
        }
        let what =
            "a system with mirrors or coordinate breaks is analysed in the F, d and C lines at the image of its file";
        Err(Error::input(what).expected("no wavelengths and no focus"))
    }
}

#[pymethods]
impl NativeLens {
    #[new]
    fn new(py: Python<'_>, name: &str, glasses: Vec<PathBuf>, conditions: LensConditions) -> PyResult<Self> {
        let analysed = || match find(name, &glasses)? {
            ZmxSystem::Lens(lens) => {
                let analysis = LensAnalysis::under(&lens, conditions.checked()?)?;
                let report = json(&LensReport::of(&lens, &analysis)?);
                Ok(Self { report, drawn: Some((lens, analysis)) })
            }
            ZmxSystem::Folded(system) => {
                let report = json(&FoldedLensReport::of(&system, conditions.field_only()?)?);
                Ok(Self { report, drawn: None })
            }
        };
        py.detach(analysed).or_exception(py)
    }

    /// The report of `abbe lens --json`.
    fn report_json(&self) -> &str {
        &self.report
    }

    /// Whether the lens has plots and a page.
    fn is_drawn(&self) -> bool {
        self.drawn.is_some()
    }

    /// A plot as SVG text, by its name of `abbe lens --plot`.
    fn plot(&self, py: Python<'_>, name: &str) -> PyResult<String> {
        let plot = || {
            let (lens, analysis) = self.drawn()?;
            lens_plots::svg(LensPlot::by_name(name)?, lens, analysis)
        };
        py.detach(plot).or_exception(py)
    }

    /// The page of `abbe lens --html`.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.drawn().and_then(|(lens, analysis)| lens_page::page(lens, analysis))).or_exception(py)
    }
}

impl NativeLens {
    fn drawn(&self) -> Result<&(Lens, LensAnalysis)> {
        let error = || Error::input("a system with mirrors or coordinate breaks cannot be drawn yet");
        self.drawn.as_ref().ok_or_else(error)
    }
}

/// The surfaces of a lens, with their indices of refraction at wavelengths in nm.
#[pyfunction]
pub(super) fn lens_prescription(py: Python<'_>, name: &str, nm: Vec<f64>, glasses: Vec<PathBuf>) -> PyResult<String> {
    let prescription = || match find(name, &glasses)? {
        ZmxSystem::Lens(lens) => Ok(json(&LensPrescription::of(&lens, &nm))),
        ZmxSystem::Folded(_) => {
            Err(Error::input("the system has mirrors or coordinate breaks").expected("a lens with one axis"))
        }
    };
    py.detach(prescription).or_exception(py)
}

/// The names of the built-in lenses.
#[pyfunction]
pub(super) fn lens_names() -> Vec<&'static str> {
    catalogue::all().iter().map(|lens| lens.name()).collect()
}

/// The names of the plots of a lens.
#[pyfunction]
pub(super) fn lens_plot_names() -> Vec<&'static str> {
    LensPlot::ALL.iter().map(|(name, _)| *name).collect()
}
