//! The analysis of a lens of several elements.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use abbe_format::resolve;
use abbe_optics::glass::AgfCatalogue;
use abbe_optics::lens::field_curves::FieldCurves;
use abbe_optics::lens::image_quality::{FAN_PUPIL, ImageQuality, MtfPoint, RayFan};
use abbe_optics::lens::section::{DrawnRay, FocusDetail, LensSection, section};
use abbe_optics::lens::zemax::{EXTENSIONS, ZmxSystem};
use abbe_optics::lens::{
    AnalysisLine, FieldPoint, LINES, Lens, LensAnalysis, LensSurface, LineFocus, Pupil, catalogue,
};
use abbe_session::output::drawing::{FocusInset, LensDrawing, RayStroke};
use abbe_session::output::plot::ink_colour;
use abbe_spectra::error::Result;
use serde::Serialize;

/// The analysis of a lens, as [`LensAnalysis`] and [`abbe_optics::lens::Paraxial`] define it.
#[derive(Debug, Serialize)]
pub struct LensReport<'a> {
    pub name: &'a str,
    pub source: Option<&'a str>,
    pub surfaces: usize,
    /// The distance from the first to the last surface.
    pub length_mm: f64,
    pub efl_mm: f64,
    pub bfd_mm: f64,
    /// The back focus of the shortest wavelength minus that of the longest: of F and C by default.
    pub fc_shift_mm: f64,
    /// The distance from the paraxial focus of the reference wavelength to the sensor.
    pub focus_shift_mm: f64,
    /// The value of `focus_shift_mm` for which the spots of all fields are smallest.
    pub best_focus_shift_mm: f64,
    /// `None` if the entrance pupil lies at infinity.
    pub f_number: Option<f64>,
    /// `None` if the pupil lies at infinity.
    pub entrance_pupil: Option<Pupil>,
    /// `None` if the pupil lies at infinity.
    pub exit_pupil: Option<Pupil>,
    /// The foci of the wavelengths: F, d and C by default.
    pub lines: Vec<LineFocus>,
    /// The radius of the Petzval surface, negative if it curves towards the lens. `None` for a
    /// plane.
    pub petzval_radius_mm: Option<f64>,
    /// Half the field of view.
    pub half_field_deg: f64,
    /// Three fields from the axis to the edge.
    pub fields: Vec<FieldReport>,
}

/// The image of a distant point. [`FieldPoint`] and [`ImageQuality`] define the quantities.
#[derive(Debug, Serialize)]
pub struct FieldReport {
    pub angle_deg: f64,
    pub image_height_mm: f64,
    pub distortion: Option<f64>,
    pub lateral_colour_mm: f64,
    /// The distance from the sensor to the tangential focus of a thin bundle.
    pub tangential_focus_mm: f64,
    /// The distance from the sensor to the sagittal focus of a thin bundle.
    pub sagittal_focus_mm: f64,
    /// The illuminance relative to the axis, without the losses of surfaces and glass.
    pub relative_illumination: f64,
    pub spots: Vec<SpotReport>,
    pub mtf: Vec<MtfPoint>,
    pub ray_fans: Vec<FanReport>,
}

/// The ray fans of a wavelength at the heights `pupil`. [`RayFan`] defines the quantities.
#[derive(Debug, Serialize)]
pub struct FanReport {
    pub line: Cow<'static, str>,
    pub pupil: [f64; FAN_PUPIL.len()],
    pub tangential_mm: [Option<f64>; FAN_PUPIL.len()],
    pub sagittal_mm: [Option<f64>; FAN_PUPIL.len()],
}

#[derive(Debug, Serialize)]
pub struct SpotReport {
    /// `F`, `d` or `C`, or the wavelength in nm.
    pub line: Cow<'static, str>,
    /// The root mean square distance of the rays from their centre.
    pub rms_mm: f64,
}

#[derive(Debug, Serialize)]
pub struct LensList<'a> {
    /// The entries, in the order of the catalogue.
    pub lenses: Vec<LensListing<'a>>,
}

/// An entry of the list. [`LensReport`] defines the quantities.
#[derive(Debug, Serialize)]
pub struct LensListing<'a> {
    pub name: &'a str,
    pub efl_mm: f64,
    pub f_number: Option<f64>,
    pub half_field_deg: f64,
    pub surfaces: usize,
}

impl LensList<'static> {
    /// Lists the built-in lenses. An error would be a bug of the catalogue.
    pub fn built_in() -> Result<Self> {
        let listed = |lens: &'static Lens| {
            let paraxial = lens.at(LINES[1].1).paraxial()?;
            Ok(LensListing {
                name: lens.name(),
                efl_mm: paraxial.efl_mm,
                f_number: paraxial.f_number,
                half_field_deg: lens.half_field_deg().unwrap_or_default(),
                surfaces: lens.surfaces().len(),
            })
        };
        Ok(Self { lenses: catalogue::all().iter().map(listed).collect::<Result<_>>()? })
    }
}

/// The environment variable with files and folders of glass catalogues.
const GLASS_PATH: &str = "ABBE_GLASS_PATH";

/// Returns the built-in lens with this name, or the system in this file: a prescription in JSON, or
/// a file of Zemax, CODE V, OSLO or the Optical Bench (`.zmx`, `.seq`, `.len`, `.txt`). Its glasses
/// are searched in the catalogues `glasses` (files or folders) and then in those of
/// `ABBE_GLASS_PATH` first. Returns an error if the name is unknown, or if a file cannot be read or
/// is wrong.
pub fn find(name: &str, glasses: &[PathBuf]) -> Result<ZmxSystem> {
    let searched = std::env::var_os(GLASS_PATH).unwrap_or_default();
    let searched = std::env::split_paths(&searched).filter(|path| !path.as_os_str().is_empty());
    let mut catalogues: Vec<AgfCatalogue> = Vec::new();
    for path in glasses.iter().cloned().chain(searched) {
        catalogues.extend(resolve::glass_files(&path)?);
    }
    let unknown = match catalogue::find(name) {
        Ok(lens) => return Ok(ZmxSystem::Lens(lens.clone())),
        Err(unknown) => unknown,
    };
    let path = Path::new(name);
    // Names of lenses contain blanks and slashes ("Tessar f/4.5"). A text is a path only if the
    // file exists or has the extension of a lens file.
    let is_lens_file =
        |ending: &std::ffi::OsStr| EXTENSIONS.iter().chain(&["json"]).any(|known| ending.eq_ignore_ascii_case(known));
    if path.exists() || path.extension().is_some_and(is_lens_file) {
        return resolve::lens_system_file(path, &catalogues);
    }
    Err(unknown.expected("a name of `abbe lens --list`, or a file"))
}

impl<'a> LensReport<'a> {
    /// Reports an analysis with image quality. Returns an error if no light passes at a field.
    pub fn of(lens: &'a Lens, analysis: &LensAnalysis) -> Result<Self> {
        let quality = ImageQuality::of(lens, analysis)?;
        let angles = analysis.fields.iter().map(|field| field.angle_deg);
        let curves = FieldCurves::at_angles(lens, analysis, angles)?;
        let reference = analysis.conditions.reference();
        let LensAnalysis { paraxial, lines, half_field_deg, fields, .. } = analysis;
        let names = analysis.conditions.lines();
        let fan = |RayFan { line, tangential_mm, sagittal_mm }: &RayFan| FanReport {
            line: line.clone(),
            pupil: FAN_PUPIL,
            tangential_mm: *tangential_mm,
            sagittal_mm: *sagittal_mm,
        };
        let field = |(i, (field, quality)): (usize, (&FieldPoint, &ImageQuality))| FieldReport {
            angle_deg: field.angle_deg,
            image_height_mm: field.image_height_mm,
            distortion: field.distortion,
            lateral_colour_mm: field.lateral_colour_mm,
            tangential_focus_mm: curves.tangential_mm[reference][i],
            sagittal_focus_mm: curves.sagittal_mm[reference][i],
            relative_illumination: curves.relative_illumination[i],
            spots: names.iter().zip(&field.spots).map(|(line, spot)| spot_report(line, spot.rms_mm)).collect(),
            mtf: quality.mtf.to_vec(),
            ray_fans: quality.fans.iter().map(fan).collect(),
        };
        Ok(Self {
            name: lens.name(),
            source: lens.source(),
            surfaces: lens.surfaces().len(),
            length_mm: lens.length_mm(),
            efl_mm: paraxial.efl_mm,
            bfd_mm: paraxial.bfd_mm,
            fc_shift_mm: analysis.fc_shift_mm(),
            focus_shift_mm: analysis.focus_shift_mm,
            best_focus_shift_mm: analysis.best_focus_shift_mm,
            f_number: paraxial.f_number,
            entrance_pupil: paraxial.entrance_pupil,
            exit_pupil: paraxial.exit_pupil,
            lines: lines.clone(),
            petzval_radius_mm: Some(curves.petzval_radius_mm).filter(|radius| radius.is_finite()),
            half_field_deg: *half_field_deg,
            fields: fields.iter().zip(&quality).enumerate().map(field).collect(),
        })
    }
}

pub(super) fn spot_report(line: &AnalysisLine, rms_mm: f64) -> SpotReport {
    SpotReport { line: line.name.clone(), rms_mm }
}

/// Returns the colour of a wavelength in plots, in SVG notation.
pub(super) fn line_colour(line: &AnalysisLine) -> String {
    match line.name.as_ref() {
        "F" => "#1f5fbf".to_string(),
        "d" => "#d09a00".to_string(),
        "C" => "#c0302a".to_string(),
        _ => ink_colour(line.nm),
    }
}

/// Returns the name and the value of a wavelength, such as `F, 486.1 nm`, or only the value.
pub(super) fn line_name(AnalysisLine { name, nm }: &AnalysisLine) -> String {
    if name.parse::<f64>().is_ok() { format!("{nm} nm") } else { format!("{name}, {nm:.1} nm") }
}

/// Returns the names of the shortest and the longest wavelength, as of their foci or heights.
pub(super) fn outer_lines(analysis: &LensAnalysis) -> [&str; 2] {
    let lines = analysis.conditions.lines();
    [lines[0].name.as_ref(), lines[lines.len() - 1].name.as_ref()]
}

/// Draws the cross-section with rays of all wavelengths of the analysis. Returns an error if no
/// light passes.
pub fn drawing(lens: &Lens, analysis: &LensAnalysis) -> Result<LensDrawing> {
    let LensSection { elements, stop, sensor, rays, foci } = section(lens, analysis)?;
    let stroke = |ray: DrawnRay| RayStroke { colour: ray.line, window: ray.field, points: ray.points };
    let window = |focus: &FocusDetail| FocusInset {
        title: if focus.angle_deg == 0.0 {
            "focus on the axis".to_string()
        } else {
            format!("focus at {}°, along the bundle", focus.angle_deg)
        },
        centre: focus.centre,
        half_size: focus.half_size,
        slope: focus.slope,
    };
    let lines = analysis.conditions.lines();
    let [shortest, longest] = outer_lines(analysis);
    let colour = format!(", {shortest}′ − {longest}′ {:+.4} mm", analysis.fc_shift_mm());
    let colour = if lines.len() > 1 { colour } else { String::new() };
    let f_number = analysis.paraxial.f_number.map_or(String::new(), |f_number| format!(", f/{f_number:.2}"));
    Ok(LensDrawing {
        title: lens.name().to_string(),
        caption: format!(
            "f = {:.2} mm{f_number}, back focus {:.2} mm{colour}",
            analysis.paraxial.efl_mm, analysis.paraxial.bfd_mm
        )
        .replace('-', "−"),
        glass: elements,
        sheets: Vec::new(),
        stop,
        sensor,
        strokes: rays.into_iter().map(stroke).collect(),
        colours: lines.iter().map(|line| (line_name(line), line_colour(line))).collect(),
        windows: foci.iter().map(window).collect(),
    })
}

/// The surfaces of a lens, for other programs.
#[derive(Debug, Serialize)]
pub struct LensPrescription<'a> {
    pub name: &'a str,
    /// Half the field of view of the design.
    pub half_field_deg: Option<f64>,
    /// The surfaces, from the scene to the sensor.
    pub surfaces: Vec<SurfaceReport<'a>>,
}

#[derive(Debug, Serialize)]
pub struct SurfaceReport<'a> {
    /// The radius of curvature. `None` for a plane.
    pub radius_mm: Option<f64>,
    /// The conic constant.
    pub conic: f64,
    /// Coefficients of h², h⁴, … in powers of mm.
    pub even_terms: &'a [f64],
    /// The distance to the next surface.
    pub thickness_mm: f64,
    pub semi_aperture_mm: f64,
    /// The radius of the opaque disc in the middle.
    pub obscuration_mm: f64,
    pub stop: bool,
    /// The indices of refraction behind the surface at the requested wavelengths.
    pub n: Vec<f64>,
}

impl<'a> LensPrescription<'a> {
    /// Returns the surfaces of a lens with their indices of refraction at wavelengths in nm.
    pub fn of(lens: &'a Lens, nm: &[f64]) -> Self {
        let surface = |(i, surface): (usize, &'a LensSurface)| {
            let LensSurface { profile, thickness_mm, index, semi_aperture_mm, obscuration_mm, coating: _ } = surface;
            SurfaceReport {
                radius_mm: (profile.curvature_per_mm != 0.0).then(|| 1.0 / profile.curvature_per_mm),
                conic: profile.conic,
                even_terms: &profile.even_terms,
                thickness_mm: *thickness_mm,
                semi_aperture_mm: *semi_aperture_mm,
                obscuration_mm: *obscuration_mm,
                stop: i == lens.stop(),
                n: nm.iter().map(|nm| index.n(*nm)).collect(),
            }
        };
        let surfaces = lens.surfaces().iter().enumerate().map(surface).collect();
        Self { name: lens.name(), half_field_deg: lens.half_field_deg(), surfaces }
    }
}
