//! Lenses against golden values that were computed independently in Python from the same
//! prescriptions.

use crate::common::near::{assert_near, number};
use crate::golden::golden;
use abbe_optics::glass::{RefractiveIndex, lines};
use abbe_optics::lens::{
    ApertureCheck, ApertureSpec, Lens, LensAnalysis, LensRay, LensSurface, MonochromaticLens, Prescription,
    SurfaceProfile, TraceDirection, catalogue,
};
use glam::DVec3;
use serde_json::Value;

/// Checks a value to 1e-6 of the golden value.
#[track_caller]
fn same(what: &str, got: f64, golden: &Value) {
    let golden = number(golden);
    assert_near(what, got, golden, 1e-6 * golden.abs());
}

/// Traces a meridional ray through a height in the plane of the first vertex.
fn meridional(at: &MonochromaticLens<'_>, y_mm: f64, angle_deg: f64) -> LensRay {
    let angle = angle_deg.to_radians();
    let ray = LensRay { origin: DVec3::new(0.0, y_mm, 0.0), direction: DVec3::new(0.0, angle.sin(), angle.cos()) };
    at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Ignored).expect("the golden ray passes")
}

#[test]
fn first_order_lens_properties_match_the_prescriptions() {
    let file = golden("lenses.json");
    let lenses = file["lenses"].as_array().unwrap();
    assert_eq!(lenses.len(), catalogue::all().len());
    for entry in lenses {
        let (name, expected) = (entry["name"].as_str().unwrap(), &entry["expected"]);
        let lens = catalogue::find(name).unwrap();
        for (line, nm) in [("F", lines::F_NM), ("d", lines::D_NM), ("C", lines::C_NM)] {
            let paraxial = lens.at(nm).paraxial().unwrap();
            same(&format!("{name}: EFL at {line}"), paraxial.efl_mm, &expected[format!("efl_{line}")]);
            same(&format!("{name}: BFD at {line}"), paraxial.bfd_mm, &expected[format!("bfd_{line}")]);
        }
        let analysis = LensAnalysis::of(lens, None).unwrap_or_else(|error| panic!("{name}: {error}"));
        same(&format!("{name}: F-C shift"), analysis.fc_shift_mm(), &expected["longitudinal_chromatic_F_minus_C"]);
        same(&format!("{name}: f-number"), analysis.paraxial.f_number.unwrap(), &expected["f_number"]);
        assert_eq!(lens.at(lines::D_NM).image_distance_mm(f64::INFINITY).unwrap(), analysis.paraxial.bfd_mm, "{name}");
    }
}

#[test]
fn exact_rays_end_where_the_golden_ones_do() {
    let file = golden("lenses.json");
    let mut compared = 0;
    for entry in file["lenses"].as_array().unwrap() {
        let name = entry["name"].as_str().unwrap();
        let lens = catalogue::find(name).unwrap();
        let image_z_mm = lens.length_mm() + number(&entry["image_distance_given_mm"]);
        for row in entry["exact_meridional_rays"].as_array().unwrap() {
            let at = lens.at(number(&row["wavelength_nm"]));
            let out = meridional(&at, number(&row["y_first_vertex_plane"]), number(&row["angle_deg"]));
            assert_near(&format!("{name}: {row}"), out.at_z(image_z_mm).y, number(&row["y_image"]), 1e-6);
            assert_near(
                &format!("{name}: {row}"),
                out.direction.y / out.direction.z,
                number(&row["slope_dy_dz"]),
                1e-8,
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 9 * 18 + 12);
}

#[test]
fn chief_rays_match_the_golden_ones() {
    let file = golden("lenses.json");
    for entry in file["lenses"].as_array().unwrap() {
        let (name, row) = (entry["name"].as_str().unwrap(), &entry["chief_ray"]);
        let lens = catalogue::find(name).unwrap();
        let at = lens.at(lines::D_NM);
        let chief = at.chief_ray(number(&row["field_deg"])).unwrap();
        let start_mm = number(&row["y_at_first_vertex_plane"]);
        assert_near(&format!("{name}: start"), chief.at_z(0.0).y, start_mm, 1e-6 * (1.0 + start_mm.abs()));
        let mut heights = Vec::new();
        let out = at
            .trace_through(chief, TraceDirection::ToSensor, ApertureCheck::Ignored, |_, point| heights.push(point.y))
            .unwrap();
        for (i, golden) in row["heights"].as_array().unwrap().iter().enumerate() {
            assert_near(&format!("{name}: surface {i}"), heights[i], number(golden), 1e-6);
        }
        let image_z_mm = lens.length_mm() + number(&entry["image_distance_given_mm"]);
        assert_near(&format!("{name}: image"), out.at_z(image_z_mm).y, number(&row["image_height"]), 1e-6);
    }
}

/// Makes a lens in air from (radius, thickness behind, index behind); the first surface is the
/// stop.
fn lens(semi_aperture_mm: f64, surfaces: &[(f64, f64, RefractiveIndex)]) -> Lens {
    let surface = |(radius_mm, thickness_mm, index): &(f64, f64, RefractiveIndex)| LensSurface {
        profile: SurfaceProfile::sphere(*radius_mm),
        thickness_mm: *thickness_mm,
        index: index.clone(),
        semi_aperture_mm,
        obscuration_mm: 0.0,
        coating: None,
    };
    Lens::new(Prescription {
        name: "simple".to_string(),
        source: None,
        surfaces: surfaces.iter().map(surface).collect(),
        stop: Some(0),
        opening: ApertureSpec::Stop,
        half_field_deg: None,
        notes: Vec::new(),
    })
    .unwrap()
}

#[test]
fn focal_lengths_match_the_lensmakers_formula() {
    let file = golden("simple_lenses.json");
    let (r1, r2) = (number(&file["R1"]), number(&file["R2"]));
    let ball_mm = number(&file["ball_diameter"]);
    let air = || RefractiveIndex::constant(1.0).unwrap();
    let mut compared = 0;
    for (name, rows) in file["by_glass"].as_object().unwrap() {
        let glass = RefractiveIndex::catalogue(name).unwrap();
        let (from_nm, to_nm) = glass.range_nm();
        let thin = lens(1e-4, &[(r1, 1e-8, glass.clone()), (r2, 0.0, air())]);
        let thick = lens(1.0, &[(r1, number(&file["thickness"]), glass.clone()), (r2, 0.0, air())]);
        let ball = lens(1.0, &[(0.5 * ball_mm, ball_mm, glass), (-0.5 * ball_mm, 0.0, air())]);
        // The golden values extrapolate the dispersion formulas, while Abbe keeps the value at the
        // end of the range.
        let in_range = |row: &&Value| (from_nm..=to_nm).contains(&number(&row["wavelength_nm"]));
        for row in rows.as_array().unwrap().iter().filter(in_range) {
            let nm = number(&row["wavelength_nm"]);
            let what = format!("{name} at {nm} nm");
            let [thin, thick, ball] = [&thin, &thick, &ball].map(|lens| lens.at(nm).paraxial().unwrap());
            same(&what, thin.efl_mm, &row["thin_f"]);
            same(&what, thick.efl_mm, &row["thick_f"]);
            same(&what, thick.bfd_mm, &row["thick_bfd"]);
            same(&what, ball.efl_mm, &row["ball_efl"]);
            assert_near(&what, ball.bfd_mm, number(&row["ball_bfl"]), 1e-6);
            compared += 1;
        }
    }
    assert!(compared >= 36, "{compared} wavelengths compared");
}
