//! Analyses of lenses.

use std::path::PathBuf;

use pyo3::prelude::*;

use super::errors::OrException;
use super::json::json;
use abbe::reports::folded_lens::FoldedLensReport;
use abbe::reports::folded_plots;
use abbe::reports::lens::{LensPrescription, LensReport, find};
use abbe::reports::lens_page;
use abbe::reports::lens_plots::{self, LensPlot};
use abbe_optics::lens::folded::{FoldedAnalysis, FoldedSystem};
use abbe_optics::lens::zemax::ZmxSystem;
use abbe_optics::lens::{AnalysisConditions, Lens, LensAnalysis, SensorFocus, catalogue};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;

/// A lens and its analysis.
#[pyclass(name = "Lens", module = "abbe._native", frozen)]
pub(super) struct NativeLens {
    /// The report of `abbe lens --json`.
    report: String,
    drawn: Drawn,
}

/// What the plots show.
enum Drawn {
    Lens(Box<(Lens, LensAnalysis)>),
    Folded(Box<(FoldedSystem, FoldedAnalysis)>),
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
}

#[pymethods]
impl NativeLens {
    #[new]
    fn new(py: Python<'_>, name: &str, glasses: Vec<PathBuf>, conditions: LensConditions) -> PyResult<Self> {
        let analysed = || match find(name, &glasses)? {
            ZmxSystem::Lens(lens) => {
                let analysis = LensAnalysis::under(&lens, conditions.checked()?)?;
                let report = json(&LensReport::of(&lens, &analysis)?);
                Ok(Self { report, drawn: Drawn::Lens(Box::new((lens, analysis))) })
            }
            ZmxSystem::Folded(system) => {
                if conditions.focus.is_some() || conditions.best_focus {
                    let what = "a system with mirrors or tilts is analysed at the image plane of its file";
                    return Err(Error::input(what).expected("no focus"));
                }
                let analysis = system.analysis(conditions.checked()?)?;
                let report = json(&FoldedLensReport::of(&system, &analysis));
                Ok(Self { report, drawn: Drawn::Folded(Box::new((system, analysis))) })
            }
        };
        py.detach(analysed).or_exception(py)
    }

    /// The report of `abbe lens --json`.
    fn report_json(&self) -> &str {
        &self.report
    }

    /// A plot as SVG text, by its name of `abbe lens --plot`.
    fn plot(&self, py: Python<'_>, name: &str) -> PyResult<String> {
        let plot = || match &self.drawn {
            Drawn::Lens(drawn) => lens_plots::svg(LensPlot::by_name(name)?, &drawn.0, &drawn.1),
            Drawn::Folded(drawn) => folded_plots::svg(LensPlot::by_name(name)?, &drawn.0, &drawn.1),
        };
        py.detach(plot).or_exception(py)
    }

    /// The page of `abbe lens --html`.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let page = || match &self.drawn {
            Drawn::Lens(drawn) => lens_page::page(&drawn.0, &drawn.1),
            Drawn::Folded(drawn) => folded_plots::page(&drawn.0, &drawn.1),
        };
        py.detach(page).or_exception(py)
    }
}

/// The surfaces of a lens, with their indices of refraction at wavelengths in nm.
#[pyfunction]
pub(super) fn lens_prescription(py: Python<'_>, name: &str, nm: Vec<f64>, glasses: Vec<PathBuf>) -> PyResult<String> {
    let prescription = || match find(name, &glasses)? {
        ZmxSystem::Lens(lens) => Ok(json(&LensPrescription::of(&lens, &nm))),
        ZmxSystem::Folded(_) => Err(Error::input("the system is no camera lens").expected("a lens with one axis")),
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
