//! The results of commands for the Python package: the same figures as those of `--json`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::study::{StudyMonitor, StudyOutcome};
use abbe_format::resolve::{self, Role};
use abbe_format::{self as format, FileAccess, JsonSource, SceneFile};
use abbe_optics::glass::Glass;
use abbe_optics::lens::image_quality::ImageQuality;
use abbe_optics::lens::section::section;
use abbe_optics::lens::zemax::ZmxSystem;
use abbe_optics::lens::{LensAnalysis, LensSurface};
use abbe_session::output::{file, regress_page};
use abbe_session::render::{Integrator, Job, Monitor, StopRules, on_threads};
use abbe_spectra::colour::ColourReport;
use abbe_spectra::colour::regress::{RegressionTolerances, judge_given};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Spectrum};
use serde::Serialize;

use super::colour::ColourJson;
use super::lamps::LampsArgs;
use super::regress_files::{colours_of_json, set_json};
use super::study::{StudyFiles, study_of};
use super::{folded_lens, glass, lamps, lens, memory, named};

fn json<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).expect("reports have text keys and no fallible values")
}

/// Returns the report of a glass.
pub fn glass_json(glass: &Glass) -> String {
    json(&glass::report(glass, &[]))
}

/// Returns a spectrum with its name and its origin.
pub fn named_spectrum(text: &str, role: Role) -> Result<(String, String, Spectrum)> {
    let named::NamedSpectrum { name, origin, spectrum } = named::spectrum(text, role)?;
    Ok((name, origin, spectrum))
}

/// Returns the colour of a light, or of a reflectance under a light.
pub fn colour_json(
    name: &str,
    spectrum: &Spectrum,
    observer: &str,
    under: Option<(&str, &Spectrum)>,
) -> Result<String> {
    let observer = Observer::by_name(observer)?;
    let report = match under {
        Some((_, light)) => ColourReport::of_reflectance(spectrum, light, observer),
        None => ColourReport::of_light(spectrum, observer),
    };
    let report = report.map_err(|error| Error { what: format!("{name}: {}", error.what), ..error })?;
    Ok(json(&ColourJson::new(name, &report, observer, under.map(|(name, _)| name))))
}

/// Analyses a lens, and draws its cross-section to the file `svg`. `field` is half the field of
/// view in degrees.
pub fn lens_json(name: &str, field: Option<f64>, glasses: &[PathBuf], svg: Option<&Path>) -> Result<String> {
    match lens::named(name, glasses)? {
        ZmxSystem::Lens(lens) => {
            let analysis = LensAnalysis::of(&lens, field)?;
            if let Some(path) = svg {
                let drawing = lens::drawing(&lens, &analysis, section(&lens, &analysis)?);
                file::write_whole(path, drawing.svg().as_bytes())?;
            }
            Ok(json(&lens::report(&lens, &analysis, &ImageQuality::of(&lens, &analysis)?)))
        }
        ZmxSystem::Folded(_) if svg.is_some() => {
            Err(Error::input("a system with mirrors or coordinate breaks cannot be drawn yet"))
        }
        ZmxSystem::Folded(system) => folded_lens::json(&system, field),
    }
}

/// The lamps of a comparison, as the command line names them.
#[derive(Debug)]
pub struct ComparedLamps {
    pub a: String,
    pub b: Option<String>,
    pub c: Option<String>,
    pub primaries: Vec<String>,
    pub observer: String,
}

/// The surfaces of a lens, for other programs. The scene file describes the quantities.
#[derive(Debug, Serialize)]
struct SurfaceJson<'a> {
    radius_mm: Option<f64>,
    conic: f64,
    /// Coefficients of h², h⁴, …
    even_terms: &'a [f64],
    thickness_mm: f64,
    semi_aperture_mm: f64,
    obscuration_mm: f64,
    stop: bool,
    /// The indices of refraction behind the surface at the given wavelengths.
    n: Vec<f64>,
}

impl<'a> SurfaceJson<'a> {
    fn new(surface: &'a LensSurface, stop: bool, nm: &[f64]) -> Self {
        let LensSurface { profile, thickness_mm, index, semi_aperture_mm, obscuration_mm, coating: _ } = surface;
        Self {
            radius_mm: (profile.curvature_per_mm != 0.0).then(|| 1.0 / profile.curvature_per_mm),
            conic: profile.conic,
            even_terms: &profile.even_terms,
            thickness_mm: *thickness_mm,
            semi_aperture_mm: *semi_aperture_mm,
            obscuration_mm: *obscuration_mm,
            stop,
            n: nm.iter().map(|nm| index.n(*nm)).collect(),
        }
    }
}

#[derive(Debug, Serialize)]
struct PrescriptionJson<'a> {
    name: &'a str,
    half_field_deg: Option<f64>,
    surfaces: Vec<SurfaceJson<'a>>,
}

/// Returns the surfaces of a lens with their indices of refraction at wavelengths in nm. The
/// arguments are those of [`lens_json`].
pub fn prescription_json(name: &str, nm: &[f64], glasses: &[PathBuf]) -> Result<String> {
    let ZmxSystem::Lens(lens) = lens::named(name, glasses)? else {
        return Err(Error::input("the system has mirrors or coordinate breaks").expected("a lens with one axis"));
    };
    let surfaces = lens.surfaces().iter().enumerate();
    let surfaces = surfaces.map(|(i, surface)| SurfaceJson::new(surface, i == lens.stop(), nm)).collect();
    Ok(json(&PrescriptionJson { name: lens.name(), half_field_deg: lens.half_field_deg(), surfaces }))
}

/// Compares lamps, and writes the HTML page of the comparison to the file `html`.
pub fn lamps_json(lamps: ComparedLamps, html: Option<&Path>) -> Result<String> {
    let ComparedLamps { a, b, c, primaries, observer } = lamps;
    let arguments = LampsArgs { a, b, c, primaries, observer, html: None, json: true };
    let compared = lamps::compared(&arguments)?;
    let warning = compared.warning();
    if let Some(path) = html {
        file::write_whole(path, lamps::html(&compared, warning.as_deref())?.as_bytes())?;
    }
    Ok(json(&lamps::json(&compared, warning)))
}

/// The text or the file of a scene.
#[derive(Debug)]
pub struct SceneRequest {
    /// The text of the scene, or `None` if `path` names a scene file.
    pub text: Option<String>,
    pub path: PathBuf,
    pub changes: Vec<String>,
    pub access: FileAccess,
}

impl SceneRequest {
    /// Reads the scene, and applies the changes.
    fn read(&self) -> Result<(SceneFile, JsonSource)> {
        let text = match &self.text {
            Some(text) => text.clone(),
            None => crate::api::read_scene_text(&self.path, self.access, None)?.text,
        };
        format::parse_with_access(text, &self.path, &self.changes, self.access)
    }
}

/// The scene and the options of a study.
#[derive(Debug)]
pub struct StudyRequest {
    pub scene: SceneRequest,
    pub folder: PathBuf,
    pub budget: Duration,
    /// The EXR file of the reference, if it is given.
    pub reference: Option<PathBuf>,
    pub threads: Option<u32>,
}

/// Runs a study. Returns `None` if the monitor stopped it.
pub fn study_json(request: StudyRequest, monitor: &mut (dyn StudyMonitor + Send)) -> Result<Option<String>> {
    let StudyRequest { scene: request, folder, budget, reference, threads } = request;
    let (scene, source) = request.read()?;
    let files = StudyFiles { scene: &request.path, output: &folder, reference: reference.as_deref() };
    match study_of(&scene, &source, &files, budget, threads, monitor)? {
        StudyOutcome::Finished(report) => Ok(Some(json(&report))),
        StudyOutcome::Interrupted => Ok(None),
    }
}

/// The scene and the options of a measurement.
#[derive(Debug)]
pub struct MeasureRequest {
    pub scene: SceneRequest,
    /// The names of the meters. An empty list means all meters.
    pub meters: Vec<String>,
    pub integrator: Option<Integrator>,
    pub stop: StopRules,
}

/// Measures with the meters of a scene. Returns `None` if the monitor stopped the measurement.
pub fn measure_json(request: MeasureRequest, monitor: &mut (dyn Monitor + Send)) -> Result<Option<String>> {
    let MeasureRequest { scene: request, meters, integrator, stop } = request;
    let path = &request.path;
    let (mut scene, source) = request.read()?;
    scene.select_meters(&meters).map_err(|error| error.in_file(path))?;
    let job = Job::new(resolve::resolve_meters(&scene, &source)?).map_err(|error| error.in_file(path))?;
    memory::check(&job.budget)?;
    let measured = on_threads(job.scene.settings.threads, || job.measure(integrator, stop, monitor))?;
    let (report, interrupted) = measured.map_err(|error| error.in_file(path))?;
    Ok((!interrupted).then(|| json(&report)))
}

/// Returns the regression set.
pub fn regression_set_json() -> String {
    json(&set_json())
}

/// Judges the colours of a converter, and writes the HTML page of the judgement to the file `page`.
/// `None` stands for the default tolerance.
pub fn regression_json(
    colours: &str,
    delta_e_2000: Option<f64>,
    component: Option<f64>,
    page: Option<&Path>,
) -> Result<String> {
    let defaults = RegressionTolerances::default();
    let tolerances = RegressionTolerances {
        delta_e_2000: delta_e_2000.unwrap_or(defaults.delta_e_2000),
        component: component.unwrap_or(defaults.component),
    };
    let report = judge_given(&colours_of_json(colours)?, tolerances)?;
    if let Some(path) = page {
        file::write_whole(path, regress_page::page(&report, "converter").as_bytes())?;
    }
    Ok(json(&report))
}
