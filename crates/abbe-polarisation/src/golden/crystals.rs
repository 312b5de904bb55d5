//! Indices, rays, plates, prisms and colours of crystals.

use super::{Pair, golden, number, numbers, pairs};
use crate::crystal::{
    Crystal, CrystalMode, CrystalPlate, CrystalSurface, CrystalWave, conoscopic_phase, glan_foucault_angles_deg,
    rochon_exits_deg, wollaston_exits_deg,
};
use crate::filter::{IDEAL_POLARISER, retarder};
use crate::interference::interference_colours;
use crate::{Mueller, Rotation, Stokes};
use abbe_spectra::colour::xyz_to_linear_srgb;
use abbe_spectra::spectrum::Spectrum;
use abbe_spectra::spectrum::library;
use glam::DVec3;
use serde_json::Value;

fn crystal(row: &Value) -> Crystal {
    Crystal::find(row["crystal"].as_str().unwrap()).unwrap()
}

pub(super) fn axis(row: &Value) -> DVec3 {
    direction(number(&row["axis_from_normal_deg"]), number(&row["axis_azimuth_deg"]))
}

pub(super) fn surface(row: &Value, axis: DVec3) -> CrystalSurface {
    CrystalSurface { indices: crystal(row).at(number(&row["wavelength_nm"])), axis, outside: 1.0 }
}

fn direction(from_z_deg: f64, azimuth_deg: f64) -> DVec3 {
    let ((sin, cos), (y, x)) = (from_z_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    DVec3::new(sin * x, sin * y, cos)
}

/// Returns the direction of travel of light from above.
fn travel(row: &Value) -> DVec3 {
    let up = direction(number(&row["incidence_deg"]), number(&row["azimuth_deg"]));
    DVec3::new(up.x, up.y, -up.z)
}

#[test]
fn indices_of_crystals_are_golden() {
    let file = golden("birefringence.json");
    let tolerance = file.tolerance("amplitudes_absolute");
    file.check("indices", |row| {
        let crystal = crystal(row);
        let at: Vec<_> = numbers(&row["wavelength_nm"]).into_iter().map(|nm| crystal.at(nm)).collect();
        let all = |of: &dyn Fn(usize) -> f64| (0..at.len()).map(of).collect::<Vec<f64>>();
        let mut compared = pairs(&all(&|i| at[i].ordinary), &row["n_o"], tolerance);
        compared.extend(pairs(&all(&|i| at[i].extraordinary), &row["n_e"], tolerance));
        compared.extend(pairs(&all(&|i| at[i].birefringence()), &row["n_e_minus_n_o"], tolerance));
        compared
    });
}

/// The angle between the axis and the normal of a cleavage face follows from the unit cell.
#[test]
fn the_cleavage_of_calcite_is_golden() {
    let file = golden("birefringence.json");
    let cell = &file.0["calcite_cleavage"];
    let (a, c) = (number(&cell["cell_a_angstrom"]), number(&cell["cell_c_angstrom"]));
    // The plane (10-14) has the reciprocal vector 2/(√3a) across and 4/c along the axis.
    let angle = (2.0 * c / (4.0 * 3.0_f64.sqrt() * a)).atan().to_degrees();
    assert!((angle - number(&cell["axis_from_face_normal_deg"])).abs() < file.tolerance("angles_deg"), "{angle}");
}

/// Pairs all numbers of a wave.
fn wave_pairs(found: CrystalWave, known: &Value, [absolute, degrees]: [f64; 2]) -> Vec<Pair> {
    let from_normal = |v: DVec3| v.truncate().length().atan2(v.z.abs()).to_degrees();
    let mut compared = pairs(&[found.index()], &known["n"], absolute);
    compared.extend(pairs(&found.k.normalize().to_array(), &known["k_direction"], absolute));
    compared.extend(pairs(&found.ray.to_array(), &known["ray"], absolute));
    // Along the optic axis, any field is possible.
    if known["E"].is_array() {
        let sign = 1.0_f64.copysign(found.electric.dot(DVec3::from_slice(&numbers(&known["E"]))));
        compared.extend(pairs(&(found.electric * sign).to_array(), &known["E"], absolute));
    }
    compared.extend(pairs(&[from_normal(found.k)], &known["k_angle_deg"], degrees));
    compared.extend(pairs(&[from_normal(found.ray)], &known["ray_angle_deg"], degrees));
    compared.extend(pairs(&[found.walk_off().to_degrees()], &known["walk_off_deg"], degrees));
    compared
}

#[test]
fn refraction_into_crystals_is_golden() {
    let file = golden("birefringence.json");
    let tolerances = ["directions_absolute", "angles_deg"].map(|name| file.tolerance(name));
    file.check("refraction", |row| {
        let [o, e] = surface(row, axis(row)).refracted(travel(row)).map(Option::unwrap);
        let mut compared = wave_pairs(o, &row["o"], tolerances);
        compared.extend(wave_pairs(e, &row["e"], tolerances));
        // The angle between the axis and k gives the same walk-off.
        let indices = surface(row, axis(row)).indices;
        let angle = axis(row).dot(e.k.normalize()).acos();
        assert!((indices.walk_off(angle).abs() - e.walk_off()).abs() < 1e-7);
        assert!((indices.extraordinary_at(angle) - e.index()).abs() < 1e-9);
        compared
    });
}

#[test]
fn internal_reflection_in_crystals_is_golden() {
    let file = golden("birefringence.json");
    let tolerances = ["directions_absolute", "angles_deg"].map(|name| file.tolerance(name));
    file.check("internal_reflection", |row| {
        let axis = DVec3::from_slice(&numbers(&row["optic_axis"]));
        let (surface, tangential) = (surface(row, axis), DVec3::X * number(&row["tangential_k"]));
        let mode = if row["incident_wave"] == "o" { CrystalMode::Ordinary } else { CrystalMode::Extraordinary };
        let wave = |mode, upward| surface.wave(mode, tangential, upward).unwrap();
        let mut compared = wave_pairs(wave(mode, true), &row["incident"], tolerances);
        compared.extend(wave_pairs(wave(CrystalMode::Ordinary, false), &row["reflected_o"], tolerances));
        compared.extend(wave_pairs(wave(CrystalMode::Extraordinary, false), &row["reflected_e"], tolerances));
        let leaving = surface.from_inside(tangential).outside_power[mode as usize];
        assert_eq!(leaving == [0.0; 2], row["total"].as_bool().unwrap());
        compared
    });
}

#[test]
fn double_images_are_golden() {
    let file = golden("birefringence.json");
    let relative = file.tolerance("lengths_relative");
    file.check("double_image", |row| {
        let thickness = number(&row["thickness_mm"]);
        let plate = CrystalPlate { front: surface(row, axis(row)), thickness };
        let [o, e] = plate.exits(travel(row)).map(Option::unwrap);
        let tolerance = relative * number(&row["displacement_length_mm"]);
        let mut compared = pairs(&o.to_array(), &row["o_exit_mm"], tolerance);
        compared.extend(pairs(&e.to_array(), &row["e_exit_mm"], tolerance));
        compared.extend(pairs(&(e - o).to_array(), &row["displacement_mm"], tolerance));
        compared.extend(pairs(&[(e - o).length()], &row["displacement_length_mm"], tolerance));
        compared
    });
}

#[test]
fn polarising_prisms_are_golden() {
    let file = golden("birefringence.json");
    let degrees = file.tolerance("angles_deg");
    file.check("wollaston_and_rochon", |row| {
        let indices = crystal(row).at(number(&row["wavelength_nm"]));
        let wedge = number(&row["wedge_deg"]);
        let mut compared = Vec::new();
        for (found, name) in
            [(wollaston_exits_deg(indices, wedge), "wollaston"), (rochon_exits_deg(indices, wedge), "rochon")]
        {
            let found = found.map(Option::unwrap);
            compared.extend(pairs(&found, &row[format!("{name}_exit_deg")], degrees));
            compared.extend(pairs(&[(found[0] - found[1]).abs()], &row[format!("{name}_separation_deg")], degrees));
        }
        let small = (2.0 * indices.birefringence().abs() * wedge.to_radians().tan()).to_degrees();
        compared.extend(pairs(&[small], &row["small_angle_approximation_deg"], degrees));
        compared
    });
    file.check("glan_foucault", |row| {
        let found = glan_foucault_angles_deg(crystal(row).at(number(&row["wavelength_nm"])));
        let mut compared = pairs(&found[..1], &row["critical_angle_o_deg"], degrees);
        compared.extend(pairs(&found[1..], &row["critical_angle_e_deg"], degrees));
        compared
    });
}

/// Pairs nested lists with a tolerance relative to the largest value of each list.
fn relative_pairs(found: &[f64], known: &Value, relative: f64) -> Vec<Pair> {
    let scale = numbers(known).iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    pairs(found, known, relative * scale.max(1e-9))
}

#[test]
fn interference_colours_are_golden() {
    let file = golden("birefringence.json");
    let (relative, lengths) = (file.tolerance("XYZ_relative"), file.tolerance("lengths_relative"));
    file.check("michel_levy", |case| {
        let (crystal, light) = (crystal(case), library::find(case["light"].as_str().unwrap()).unwrap().spectrum);
        let mut compared = Vec::new();
        for (i, thickness) in numbers(&case["thickness_um"]).into_iter().enumerate() {
            let difference = |nm: f64| crystal.path_difference_nm(1000.0 * thickness, nm);
            let known = &case["retardance_nm_at_D"][i];
            compared.extend(pairs(&[difference(589.2938)], known, lengths * number(known).max(1.0)));
            let colours = interference_colours(&light, difference);
            for (xyz, name) in [(colours.crossed, "crossed"), (colours.parallel, "parallel")] {
                for (value, known) in xyz.iter().zip(case[name]["XYZ"][i].as_array().unwrap()) {
                    compared.extend(relative_pairs(&[*value], known, relative));
                }
                if case[name]["xy"][i].is_array() {
                    let xy = abbe_spectra::colour::xy(xyz);
                    compared.extend(relative_pairs(&xy, &case[name]["xy"][i], relative));
                }
                let srgb = xyz_to_linear_srgb(xyz);
                compared.extend(relative_pairs(&srgb, &case[name]["linear_srgb"][i], relative));
            }
        }
        compared
    });
}

/// Colours of a plate without dispersion in light of equal energy, which are published for the
/// optical path differences 550, 1000 and 1128 nm.
#[test]
fn plates_without_dispersion_have_known_colours() {
    let light = Spectrum::constant(1.0);
    for (difference, known) in [(550.0, [0.2352, 0.0908]), (1000.0, [0.4397, 0.2840]), (1128.0, [0.2243, 0.1356])] {
        let xy = abbe_spectra::colour::xy(interference_colours(&light, |_| difference).crossed);
        assert!((0..2).all(|i| (xy[i] - known[i]).abs() < 6e-5), "{difference}: {xy:?}");
    }
}

#[test]
fn plates_between_polarisers_are_golden() {
    let file = golden("birefringence.json");
    let (absolute, degrees) = (file.tolerance("amplitudes_absolute"), file.tolerance("angles_deg"));
    file.check("retarder_between_polarisers", |row| {
        let nm = number(&row["wavelength_nm"]);
        let phase = crystal(row).at(nm).retardance(1000.0 * number(&row["thickness_um"]), nm);
        let optic_axis = number(&row["optic_axis_deg"]);
        let fast = if phase > 0.0 { optic_axis + 90.0 } else { optic_axis };
        let turned = |element, angle| Mueller::from(element).turned(Rotation::degrees(angle));
        let light = turned(retarder(phase.abs()), fast) * (IDEAL_POLARISER * Stokes::unpolarised(1.0));
        let same = turned(retarder(-phase), optic_axis) * (IDEAL_POLARISER * Stokes::unpolarised(1.0));
        assert!((0..4).all(|i| (same.0[i] - light.0[i]).abs() < 1e-12));
        let analyser = turned(IDEAL_POLARISER, number(&row["analyser_deg"]));
        let mut compared = pairs(&[phase.abs().to_degrees()], &row["retardance_deg"], degrees);
        compared.extend(pairs(&[fast.rem_euclid(180.0)], &row["fast_axis_deg"], degrees));
        compared.extend(pairs(&light.0, &row["stokes_after_plate"], absolute));
        compared.extend(pairs(&[(analyser * light).power()], &row["transmitted"], absolute));
        compared
    });
    file.check("wave_plates", |row| {
        let (crystal, waves, design) = (crystal(row), number(&row["waves"]), number(&row["design_nm"]));
        let thickness = waves * design / crystal.at(design).birefringence().abs();
        let phase = |nm: f64| crystal.at(nm).retardance(thickness, nm).abs().to_degrees();
        let found: Vec<f64> = numbers(&row["wavelength_nm"]).into_iter().map(phase).collect();
        let known = number(&row["thickness_um"]);
        let mut compared =
            pairs(&[thickness / 1000.0], &row["thickness_um"], file.tolerance("lengths_relative") * known);
        compared.extend(pairs(&found, &row["retardance_deg"], degrees));
        compared
    });
    file.check("conoscopic", |row| {
        let nm = number(&row["wavelength_nm"]);
        let (indices, thickness) = (crystal(row).at(nm), 1000.0 * number(&row["thickness_um"]));
        let found = |angle: f64| conoscopic_phase(indices, thickness, nm, angle.to_radians()).to_degrees();
        let front = CrystalSurface { indices, axis: DVec3::Z, outside: 1.0 };
        let plate = CrystalPlate { front, thickness };
        let angles = numbers(&row["incidence_deg"]);
        let general = |angle: f64| {
            let travel = DVec3::new(angle.to_radians().sin(), 0.0, -angle.to_radians().cos());
            plate.phase_difference(travel, nm).unwrap().to_degrees()
        };
        let mut compared =
            pairs(&angles.iter().map(|&angle| found(angle)).collect::<Vec<_>>(), &row["phase_o_minus_e_deg"], degrees);
        compared.extend(pairs(
            &angles.iter().map(|&angle| general(angle)).collect::<Vec<_>>(),
            &row["phase_o_minus_e_deg"],
            degrees,
        ));
        compared
    });
}
