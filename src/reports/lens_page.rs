//! The HTML page of a lens.

use abbe_optics::lens::axial_colour::AxialColour;
use abbe_optics::lens::field_curves::FieldCurves;
use abbe_optics::lens::spot_diagram::SpotDiagram;
use abbe_optics::lens::{FieldPoint, Lens, LensAnalysis, LensSurface, Pupil, SensorFocus};
use abbe_session::output::drawing::LensDrawing;
use abbe_session::output::lens_page::{self, LensPage, PageSection, PageTable};
use abbe_session::output::plot_grid::PlotGrid;
use abbe_spectra::error::Result;

use super::lens::{drawing, line_name, outer_lines};
use super::lens_plots::{
    distortion, field_curvature, focal_shift, illumination, lateral_colour, longitudinal, mtf, number, ray_fans,
    short_name, signed, spots, through_focus,
};

/// Returns the page. Returns an error if no light passes at one of the fields.
pub fn page(lens: &Lens, analysis: &LensAnalysis) -> Result<String> {
    let curves = FieldCurves::of(lens, analysis)?;
    Ok(lens_page::page(&LensPage {
        title: lens.name().to_string(),
        conditions: conditions(analysis),
        source: lens.source().map(str::to_string),
        notes: lens.notes().to_vec(),
        figures: figures(lens, analysis, &curves),
        section: LensDrawing { title: "Cross-section".to_string(), ..drawing(lens, analysis)? }.svg(),
        prescription: prescription(lens, analysis),
        sections: sections(lens, analysis, &curves)?,
        fields: fields(lens, analysis)?,
    }))
}

fn conditions(analysis: &LensAnalysis) -> String {
    let LensAnalysis { conditions, half_field_deg, focus_shift_mm, .. } = analysis;
    let reference = conditions.reference();
    let name = |(i, line)| line_name(line) + if i == reference { " (reference)" } else { "" };
    let names: Vec<String> = conditions.lines().iter().enumerate().map(name).collect();
    let sensor = match conditions.focus {
        SensorFocus::Shift(0.0) => "in the paraxial focus".to_string(),
        SensorFocus::Shift(mm) => format!("{} mm from the paraxial focus", signed(mm, 4)),
        SensorFocus::Best => format!("in the best focus, {} mm from the paraxial focus", signed(*focus_shift_mm, 4)),
    };
    format!(
        "Distant object; fields up to {half_field_deg}° off the axis; wavelengths {}; sensor {sensor}.",
        names.join("; ")
    )
}

fn figures(lens: &Lens, analysis: &LensAnalysis, curves: &FieldCurves) -> Vec<(String, String)> {
    let LensAnalysis { paraxial, best_focus_shift_mm, fields, .. } = analysis;
    let [shortest, longest] = outer_lines(analysis);
    let pupil = |pupil: Option<Pupil>| match pupil {
        Some(Pupil { z_mm, diameter_mm }) => [diameter_mm, z_mm].map(|mm| format!("{} mm", number(mm, 3))),
        None => ["–", "at infinity"].map(str::to_string),
    };
    let [entrance, exit] = [paraxial.entrance_pupil, paraxial.exit_pupil].map(pupil);
    let f_number = paraxial.f_number.map_or("undefined".to_string(), |f_number| number(f_number, 3));
    let height_mm = fields.last().map_or(0.0, |field| field.image_height_mm);
    let petzval = curves.petzval_radius_mm;
    let petzval = if petzval.is_finite() { format!("{} mm", number(petzval, 2)) } else { "plane".to_string() };
    let mut rows = vec![
        ("focal length", format!("{} mm", number(paraxial.efl_mm, 4))),
        ("back focus", format!("{} mm", number(paraxial.bfd_mm, 4))),
        ("f-number", f_number),
        ("length, first to last surface", format!("{} mm", number(lens.length_mm(), 3))),
        ("image height at the edge", format!("{} mm", number(height_mm, 3))),
        ("diameter of the entrance pupil", entrance[0].clone()),
        ("entrance pupil from surface 1", entrance[1].clone()),
        ("diameter of the exit pupil", exit[0].clone()),
        ("exit pupil from surface 1", exit[1].clone()),
        ("best focus from the paraxial focus", format!("{} mm", signed(*best_focus_shift_mm, 4))),
        ("radius of the Petzval surface", petzval),
    ];
    let colour = format!("{} mm", signed(analysis.fc_shift_mm(), 4));
    let name = format!("{shortest}′ − {longest}′ (longitudinal colour)");
    if analysis.lines.len() > 1 {
        rows.push((name.as_str(), colour));
    }
    rows.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
}

fn prescription(lens: &Lens, analysis: &LensAnalysis) -> PageTable {
    let header = ["surface", "radius", "thickness", "n_d", "V_d", "semi-aperture", "remarks"];
    let row = |(i, surface): (usize, &LensSurface)| {
        let LensSurface { profile, thickness_mm, index, semi_aperture_mm, obscuration_mm, coating } = surface;
        let is_last = i + 1 == lens.surfaces().len();
        let is_air = index.nd() == 1.0;
        let mut remarks = Vec::new();
        if i == lens.stop() {
            remarks.push("stop".to_string());
        }
        if profile.conic != 0.0 {
            remarks.push(format!("conic {}", number(profile.conic, 4)));
        }
        let terms = profile.even_terms.iter().enumerate().filter(|(_, term)| **term != 0.0);
        remarks.extend(terms.map(|(i, term)| format!("h^{}: {term:e}", 2 * (i + 1)).replace('-', "−")));
        if *obscuration_mm > 0.0 {
            remarks.push(format!("obscuration {}", number(*obscuration_mm, 3)));
        }
        if coating.is_some() {
            remarks.push("coated".to_string());
        }
        let sensor_mm = analysis.sensor_z_mm - lens.length_mm();
        vec![
            (i + 1).to_string(),
            if profile.curvature_per_mm == 0.0 {
                "plane".to_string()
            } else {
                number(1.0 / profile.curvature_per_mm, 4)
            },
            number(if is_last { sensor_mm } else { *thickness_mm }, 4),
            if is_air { "air".to_string() } else { number(index.nd(), 5) },
            index.vd().filter(|_| !is_air).map_or(String::new(), |vd| number(vd, 2)),
            number(*semi_aperture_mm, 3),
            remarks.join("; "),
        ]
    };
    let mut rows: Vec<Vec<String>> = lens.surfaces().iter().enumerate().map(row).collect();
    rows.push(["sensor", "plane", "", "", "", "", ""].map(str::to_string).to_vec());
    PageTable { header: header.map(str::to_string).to_vec(), rows }
}

fn fields(lens: &Lens, analysis: &LensAnalysis) -> Result<PageTable> {
    let lines = analysis.conditions.lines();
    let (reference, [shortest, longest]) = (analysis.conditions.reference(), outer_lines(analysis));
    let mut header: Vec<String> = ["field", "image\nheight\nmm", "distortion\n%"].map(str::to_string).to_vec();
    let has_colours = lines.len() > 1;
    header.extend(has_colours.then(|| format!("lateral\n{shortest} − {longest}\nµm")));
    header.extend(lines.iter().map(|line| format!("RMS\n{}\nµm", short_name(line))));
    header.extend(has_colours.then(|| "RMS\nall\nµm".to_string()));
    header.extend(["T focus\nmm", "S focus\nmm", "relative\nillumination\n%"].map(str::to_string));
    let angles = analysis.fields.iter().map(|field| field.angle_deg);
    let curves = FieldCurves::at_angles(lens, analysis, angles)?;
    let row = |(i, (field, spot)): (usize, (&FieldPoint, &SpotDiagram))| {
        let mut row = vec![
            format!("{:.2}°", field.angle_deg),
            number(field.image_height_mm, 3),
            field.distortion.map_or("–".to_string(), |fraction| signed(100.0 * fraction, 3)),
        ];
        row.extend(has_colours.then(|| signed(1e3 * field.lateral_colour_mm, 2)));
        row.extend(field.spots.iter().map(|spot| number(1e3 * spot.rms_mm, 2)));
        row.extend(has_colours.then(|| number(1e3 * spot.rms_mm, 2)));
        row.push(signed(curves.tangential_mm[reference][i], 4));
        row.push(signed(curves.sagittal_mm[reference][i], 4));
        row.push(number(100.0 * curves.relative_illumination[i], 1));
        row
    };
    let rows = analysis.fields.iter().zip(&SpotDiagram::of(lens, analysis)?).enumerate().map(row).collect();
    Ok(PageTable { header, rows })
}

fn sections(lens: &Lens, analysis: &LensAnalysis, curves: &FieldCurves) -> Result<Vec<PageSection>> {
    let section = |heading: &str, figures: Vec<String>, caption: &str| PageSection {
        heading: heading.to_string(),
        figures,
        caption: caption.to_string(),
    };
    let axial = AxialColour::of(lens, analysis)?;
    let illumination = illumination(curves).svg();
    let lateral = if analysis.lines.len() > 1 {
        let figures = vec![lateral_colour(analysis, curves).svg(), illumination];
        section("Lateral colour and relative illumination", figures, &[LATERAL, ILLUMINATION].concat())
    } else {
        section("Relative illumination", vec![illumination], ILLUMINATION)
    };
    let both = |grids: [PlotGrid; 2]| grids.iter().map(PlotGrid::svg).collect::<Vec<_>>();
    Ok(vec![
        section("Spot diagrams", vec![spots(lens, analysis)?.svg()], SPOTS),
        section("Ray fans", vec![ray_fans(lens, analysis)?.svg()], FANS),
        section("Modulation transfer function", both([mtf(lens, analysis)?, through_focus(lens, analysis)?]), MTF),
        section("Field curvature and distortion", both([field_curvature(analysis, curves), distortion(curves)]), FIELD),
        lateral,
        section(
            "Aberrations on the axis",
            both([longitudinal(analysis, &axial), focal_shift(analysis, &axial)]),
            AXIAL,
        ),
    ])
}

const SPOTS: &str = "Rays of a distant point that form a hexagonal lattice in front of the lens, where they reach the \
    sensor. Each square is centred on the centroid of the rays of all wavelengths; y points up, away from the axis for a \
    positive field. The RMS radius of one wavelength refers to its own centroid, that of all to the common one.";
const FANS: &str = "Transverse ray aberration against the height of the ray in the entrance pupil, divided by the radius \
    of the pupil. The reference is the chief ray of the reference wavelength, which passes through the middle of the \
    stop. Vignetted rays are left out. All plots have the same scale.";
const MTF: &str = "Geometric MTF: the contrast of the ray spots of all wavelengths with equal weights, multiplied by the \
    MTF of a perfect lens with the same f-number (the diffraction limit, at the reference wavelength). The diffraction of \
    the aberrated wave is not computed, so where aberrations and diffraction are of equal size, the values are \
    approximate. Tangential curves are for lines perpendicular to the meridional plane. Positive distances are away from \
    the lens.";
const FIELD: &str = "Foci of thin bundles around the chief ray of each wavelength, measured along the axis from the \
    sensor. Distortion is the height of the chief ray of the reference wavelength relative to that of a paraxial lens, \
    which is f·tan(field angle) in the paraxial focus.";
const LATERAL: &str = "Lateral colour is the height of the chief ray of each wavelength minus that of the reference \
    wavelength. ";
const ILLUMINATION: &str = "Relative illumination is the illuminance of the image of a uniform distant surface at the \
    reference wavelength: by vignetting, obliquity and the aberrations of the pupil, without the losses of surfaces and \
    glass.";
const AXIAL: &str = "Longitudinal aberration is the distance from the sensor at which a ray that enters parallel to the \
    axis crosses it, against the height of this ray in the entrance pupil, divided by the radius of the pupil. The \
    chromatic focal shift is the paraxial focus of a wavelength minus that of the reference wavelength.";
