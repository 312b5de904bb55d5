//! The plots of lenses against rays that optiland 0.6.3 traced through the same prescriptions
//! (`tests/golden/make_lens_curves.py`).

use crate::common::near::{assert_near, number};
use crate::golden::golden;
use abbe_optics::lens::axial_colour::AxialColour;
use abbe_optics::lens::field_curves::FieldCurves;
use abbe_optics::lens::image_quality::{FAN_PUPIL, ImageQuality};
use abbe_optics::lens::{LINES, Lens, LensAnalysis, catalogue};
use serde_json::Value;

/// Calls a function with each lens of the file, its analysis and its golden values.
fn each_lens(check: impl Fn(&Lens, &LensAnalysis, &Value)) {
    let file = golden("lens_curves.json");
    let lenses = file["lenses"].as_array().unwrap();
    assert_eq!(lenses.len(), 3);
    for entry in lenses {
        let lens = catalogue::find(entry["name"].as_str().unwrap()).unwrap();
        check(lens, &LensAnalysis::of(lens, None).unwrap(), entry);
    }
}

#[test]
fn foci_and_heights_over_the_field_are_the_golden_ones() {
    each_lens(|lens, analysis, entry| {
        let curves = FieldCurves::of(lens, analysis).unwrap();
        for row in entry["fields"].as_array().unwrap() {
            let (name, fraction) = (lens.name(), number(&row["fraction"]));
            let i = (fraction * 40.0).round() as usize;
            assert_near(&format!("{name}: height"), curves.heights_mm[i], number(&row["image_height"]), 1e-6);
            for (line, (letter, _)) in LINES.iter().enumerate() {
                let what = format!("{name} at {fraction} in {letter}");
                let foci = &row["foci"][letter];
                assert_near(&what, curves.tangential_mm[line][i], number(&foci[0]), 1e-5);
                assert_near(&what, curves.sagittal_mm[line][i], number(&foci[1]), 1e-5);
                let colour_mm = number(&row["chief"][letter]) - number(&row["chief"]["d"]);
                assert_near(&what, curves.lateral_colour_mm[line][i], colour_mm, 1e-6);
            }
        }
    });
}

#[test]
fn longitudinal_aberrations_are_the_golden_ones() {
    each_lens(|lens, analysis, entry| {
        let axial = AxialColour::of(lens, analysis).unwrap();
        for (line, (letter, _)) in LINES.iter().enumerate() {
            let rows = &entry["longitudinal_at_0.5_and_0.9_of_the_pupil"][letter];
            for (i, golden) in [(20, &rows[0]), (36, &rows[1])] {
                let found = axial.longitudinal_mm[line][i].unwrap();
                assert_near(&format!("{}: {letter} {i}", lens.name()), found, number(golden), 1e-5);
            }
        }
    });
}

#[test]
fn ray_fans_are_the_golden_ones() {
    let file = golden("lens_curves.json");
    let pupil: Vec<f64> = file["fan_pupil"].as_array().unwrap().iter().map(number).collect();
    each_lens(|lens, analysis, entry| {
        let quality = ImageQuality::of(lens, analysis).unwrap();
        for (quality, row) in quality.iter().zip(entry["fields"].as_array().unwrap()) {
            for fan in &quality.fans {
                let golden = &row["fans"][fan.line.as_ref()];
                for (i, p) in pupil.iter().enumerate() {
                    let at = FAN_PUPIL.iter().position(|known| known == p).unwrap();
                    let what = format!("{} at {}°, {} {p}", lens.name(), quality.angle_deg, fan.line);
                    assert_near(&what, fan.tangential_mm[at].unwrap(), number(&golden["y"][i]), 1e-6);
                    assert_near(&what, fan.sagittal_mm[at].unwrap(), number(&golden["x"][i]), 1e-6);
                }
            }
        }
    });
}

/// The golden bundles have 80 times as many rays. The radius of the achromat's spot in F comes from
/// the rays at the rim of the pupil, which the coarser grid of the analysis samples to 2 %.
#[test]
fn spots_and_contrasts_are_the_golden_ones() {
    each_lens(|lens, analysis, entry| {
        let quality = ImageQuality::of(lens, analysis).unwrap();
        let rows = entry["fields"].as_array().unwrap();
        for ((quality, field), row) in quality.iter().zip(&analysis.fields).zip(rows) {
            let what = format!("{} at {}°", lens.name(), field.angle_deg);
            for (spot, (letter, _)) in field.spots.iter().zip(LINES) {
                let golden = number(&row["rms"][letter]);
                assert_near(&format!("{what}, RMS in {letter}"), spot.rms_mm, golden, 0.02 * golden);
            }
            for golden in row["mtf"].as_array().unwrap() {
                let point = quality.mtf.iter().find(|point| point.per_mm == number(&golden["per_mm"])).unwrap();
                for (name, found) in [("tangential", point.tangential), ("sagittal", point.sagittal)] {
                    let geometric = found / point.diffraction_limit;
                    assert_near(&format!("{what}, {name} {}", point.per_mm), geometric, number(&golden[name]), 0.01);
                }
            }
        }
    });
}
