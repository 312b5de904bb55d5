//! The results of commands for the Python package: the same figures as those of `--json`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::colour::ColourReport;
use crate::error::{Error, Result};
use crate::format::resolve::{self, Role};
use crate::format::{self, FileAccess};
use crate::optics::glass::Glass;
use crate::optics::lens::LensAnalysis;
use crate::optics::lens::image_quality::ImageQuality;
use crate::optics::lens::section::section;
use crate::optics::lens::zemax::ZmxSystem;
use crate::output::file;
use crate::spectrum::{Observer, Spectrum};
use crate::study::{StudyMonitor, StudyOutcome};
use serde::Serialize;

use super::colour::ColourJson;
use super::lamps::LampsArgs;
use super::study::{StudyFiles, study_of};
use super::{folded_lens, glass, lamps, lens, named};

fn json<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).expect("reports have text keys and no fallible values")
}

/// Returns the report of a glass.
pub(crate) fn glass_json(glass: &Glass) -> String {
    json(&glass::report(glass, &[]))
}

/// Returns a spectrum with its name and its origin.
pub(crate) fn named_spectrum(text: &str, role: Role) -> Result<(String, String, Spectrum)> {
    let named::NamedSpectrum { name, origin, spectrum } = named::spectrum(text, role)?;
    Ok((name, origin, spectrum))
}

/// Returns the colour of a light, or of a reflectance under a light.
pub(crate) fn colour_json(
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
pub(crate) fn lens_json(name: &str, field: Option<f64>, glasses: &[PathBuf], svg: Option<&Path>) -> Result<String> {
    let catalogues = glasses.iter().map(|path| resolve::glass_file(path)).collect::<Result<Vec<_>>>()?;
    match lens::named(name, &catalogues)? {
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
pub(crate) struct ComparedLamps {
    pub(crate) a: String,
    pub(crate) b: Option<String>,
    pub(crate) c: Option<String>,
    pub(crate) primaries: Vec<String>,
    pub(crate) observer: String,
}

/// Compares lamps, and writes the HTML page of the comparison to the file `html`.
pub(crate) fn lamps_json(lamps: ComparedLamps, html: Option<&Path>) -> Result<String> {
    let ComparedLamps { a, b, c, primaries, observer } = lamps;
    let arguments = LampsArgs { a, b, c, primaries, observer, html: None, json: true };
    let compared = lamps::compared(&arguments)?;
    let warning = compared.warning();
    if let Some(path) = html {
        file::write_whole(path, lamps::html(&compared, warning.as_deref())?.as_bytes())?;
    }
    Ok(json(&lamps::json(&compared, warning)))
}

/// The scene and the options of a study.
#[derive(Debug)]
pub(crate) struct StudyRequest {
    /// The text of the scene, or `None` if `path` names a scene file.
    pub(crate) text: Option<String>,
    pub(crate) path: PathBuf,
    pub(crate) changes: Vec<String>,
    pub(crate) access: FileAccess,
    pub(crate) folder: PathBuf,
    pub(crate) budget: Duration,
    /// The EXR file of the reference, if it is given.
    pub(crate) reference: Option<PathBuf>,
    pub(crate) threads: Option<u32>,
}

/// Runs a study. Returns `None` if the monitor stopped it.
pub(crate) fn study_json(request: StudyRequest, monitor: &mut (dyn StudyMonitor + Send)) -> Result<Option<String>> {
    let StudyRequest { text, path, changes, access, folder, budget, reference, threads } = request;
    let text = match text {
        Some(text) => text,
        None => format::read_scene_text(&path, access, None)?.text,
    };
    let (scene, source) = format::parse_with_access(&text, &path, &changes, access)?;
    let files = StudyFiles { scene: &path, output: &folder, reference: reference.as_deref() };
    match study_of(&scene, &source, &files, budget, threads, monitor)? {
        StudyOutcome::Finished(report) => Ok(Some(json(&report))),
        StudyOutcome::Interrupted => Ok(None),
    }
}
