//! Lenses against golden values that were computed independently, in Python, from the same prescriptions.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "golden/close.rs"]
mod close;
mod golden;

use abbe::optics::glass::{Index, lines};
use abbe::optics::lens::{
    Analysis, Lens, Limits, Monochromatic, Opening, Prescription, Profile, Ray, Surface, Travel, catalogue,
};
use close::{close, number};
use glam::DVec3;
use golden::golden;
use serde_json::Value;

/// To 1e-6 of the golden value.
#[track_caller]
fn same(what: &str, got: f64, golden: &Value) {
    let golden = number(golden);
    close(what, got, golden, 1e-6 * golden.abs());
}

/// A ray of the meridional plane through a height in the plane of the first vertex, and where it ends.
fn meridional(at: &Monochromatic<'_>, y_mm: f64, angle_deg: f64) -> Ray {
    let angle = angle_deg.to_radians();
    let ray = Ray { origin: DVec3::new(0.0, y_mm, 0.0), direction: DVec3::new(0.0, angle.sin(), angle.cos()) };
    at.trace(ray, Travel::ToSensor, Limits::None).expect("the golden ray passes")
}

#[test]
fn focal_lengths_back_foci_colour_shifts_and_f_numbers_equal_the_stated_ones() {
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
        let analysis = Analysis::of(lens, None).unwrap_or_else(|error| panic!("{name}: {error}"));
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
            close(&format!("{name}: {row}"), out.at_z(image_z_mm).y, number(&row["y_image"]), 1e-6);
            close(&format!("{name}: {row}"), out.direction.y / out.direction.z, number(&row["slope_dy_dz"]), 1e-8);
            compared += 1;
        }
    }
    assert_eq!(compared, 9 * 18 + 12);
}

#[test]
fn chief_rays_go_through_the_middle_of_the_stop_as_the_golden_ones_do() {
    let file = golden("lenses.json");
    for entry in file["lenses"].as_array().unwrap() {
        let (name, row) = (entry["name"].as_str().unwrap(), &entry["chief_ray"]);
        let lens = catalogue::find(name).unwrap();
        let at = lens.at(lines::D_NM);
        let chief = at.chief_ray(number(&row["field_deg"])).unwrap();
        let start_mm = number(&row["y_at_first_vertex_plane"]);
        close(&format!("{name}: start"), chief.at_z(0.0).y, start_mm, 1e-6 * (1.0 + start_mm.abs()));
        let mut heights = Vec::new();
        let out = at.trace_through(chief, Travel::ToSensor, Limits::None, |_, point| heights.push(point.y)).unwrap();
        for (i, golden) in row["heights"].as_array().unwrap().iter().enumerate() {
            close(&format!("{name}: surface {i}"), heights[i], number(golden), 1e-6);
        }
        let image_z_mm = lens.length_mm() + number(&entry["image_distance_given_mm"]);
        close(&format!("{name}: image"), out.at_z(image_z_mm).y, number(&row["image_height"]), 1e-6);
    }
}

/// A lens in air from (radius, thickness behind, index behind); the first surface is the stop.
fn lens(semi_aperture_mm: f64, surfaces: &[(f64, f64, Index)]) -> Lens {
    let surface = |(radius_mm, thickness_mm, index): &(f64, f64, Index)| Surface {
        profile: Profile::sphere(*radius_mm),
        thickness_mm: *thickness_mm,
        index: index.clone(),
        semi_aperture_mm,
    };
    Lens::new(Prescription {
        name: "simple".to_string(),
        source: None,
        surfaces: surfaces.iter().map(surface).collect(),
        stop: Some(0),
        opening: Opening::Stop,
        half_field_deg: None,
    })
    .unwrap()
}

#[test]
fn thin_thick_and_ball_lenses_have_the_focal_lengths_of_the_lensmaker_s_formula() {
    let file = golden("simple_lenses.json");
    let (r1, r2) = (number(&file["R1"]), number(&file["R2"]));
    let ball_mm = number(&file["ball_diameter"]);
    let air = || Index::constant(1.0).unwrap();
    let mut compared = 0;
    for (name, rows) in file["by_glass"].as_object().unwrap() {
        let glass = Index::catalogue(name).unwrap();
        let (from_nm, to_nm) = glass.range_nm();
        let thin = lens(1e-4, &[(r1, 1e-8, glass.clone()), (r2, 0.0, air())]);
        let thick = lens(1.0, &[(r1, number(&file["thickness"]), glass.clone()), (r2, 0.0, air())]);
        let ball = lens(1.0, &[(0.5 * ball_mm, ball_mm, glass), (-0.5 * ball_mm, 0.0, air())]);
        // The golden values extrapolate the formulas, Abbe holds the value at the range's end.
        let in_range = |row: &&Value| (from_nm..=to_nm).contains(&number(&row["wavelength_nm"]));
        for row in rows.as_array().unwrap().iter().filter(in_range) {
            let nm = number(&row["wavelength_nm"]);
            let what = format!("{name} at {nm} nm");
            let [thin, thick, ball] = [&thin, &thick, &ball].map(|lens| lens.at(nm).paraxial().unwrap());
            same(&what, thin.efl_mm, &row["thin_f"]);
            same(&what, thick.efl_mm, &row["thick_f"]);
            same(&what, thick.bfd_mm, &row["thick_bfd"]);
            same(&what, ball.efl_mm, &row["ball_efl"]);
            close(&what, ball.bfd_mm, number(&row["ball_bfl"]), 1e-6);
            compared += 1;
        }
    }
    assert!(compared >= 36, "{compared} wavelengths compared");
}
