//! Interfaces, metals, films and plates.

use super::{Pair, cos_deg, elements, golden, number, numbers, pairs, stokes};
use crate::sheet::Sheet;
use crate::surface::{
    EllipsometricAngles, SurfaceMatrices, argument_deg, largest_total_reflection_delta_deg, total_reflection_angles_deg,
};
use crate::{Mueller, Rotation, Stokes};
use abbe_optics::RefractiveIndex;
use abbe_optics::glass::{catalogue, lines};
use abbe_optics::thin_film::{StackResponse, response};
use abbe_spectra::math::complex::Complex;
use serde_json::Value;

/// The response of an interface to an index with k ≥ 0.
fn bare(degrees: f64, n_i: f64, n: f64, k: f64) -> StackResponse {
    response(cos_deg(degrees), n_i, std::iter::empty(), Complex::new(n, k), 550.0)
}

/// The file uses exp(+iωt).
fn conjugate(z: Complex) -> [f64; 2] {
    [z.re, -z.im]
}

#[test]
fn interfaces_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    file.check("fresnel", |case| {
        let (n_i, n2) = (number(&case["n1"]), numbers(&case["n2"]));
        let mut compared = Vec::new();
        for (i, angle) in numbers(&case["angle_deg"]).into_iter().enumerate() {
            let StackResponse { s, p } = bare(angle, n_i, n2[0], n2[1]);
            let mut add = |found: &[f64], key: &str| compared.extend(pairs(found, &case[key][i], tolerance));
            add(&conjugate(s.reflected), "rs");
            add(&conjugate(p.reflected), "rp");
            add(&conjugate(s.transmitted), "ts");
            add(&conjugate(p.transmitted), "tp");
            let matrices = SurfaceMatrices::of_films(&StackResponse { s, p });
            let forms = if n2[1] == 0.0 {
                [matrices, SurfaceMatrices::dielectric(cos_deg(angle), n_i, n2[0])]
            } else {
                [matrices, SurfaceMatrices::conductor(cos_deg(angle), n2[0], n2[1], n_i)]
            };
            for SurfaceMatrices { reflected, transmitted } in forms {
                add(&[reflected.s], "Rs");
                add(&[reflected.p], "Rp");
                add(&[transmitted.s], "Ts");
                add(&[transmitted.p], "Tp");
                add(&elements(reflected), "mueller_reflection");
                if case.get("mueller_transmission").is_some() {
                    add(&elements(transmitted), "mueller_transmission");
                }
            }
            let delta = EllipsometricAngles::of(&s, &p).delta_deg;
            let phases = [-argument_deg(s.reflected), -argument_deg(p.reflected), delta];
            for (found, key) in phases.into_iter().zip(["phase_s_deg", "phase_p_deg", "delta_deg"]) {
                compared.push(angle_pair(found, &case[key][i], degrees));
            }
        }
        compared
    });
}

/// Compares angles modulo 360°.
fn angle_pair(found: f64, known: &Value, tolerance: f64) -> Pair {
    let known = number(known);
    Pair { found: known + (found - known + 180.0).rem_euclid(360.0) - 180.0, known, tolerance }
}

#[test]
fn films_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    file.check("films", |case| {
        let index: Vec<Complex> = case["index"]
            .as_array()
            .unwrap()
            .iter()
            .map(|pair| {
                let pair = numbers(pair);
                Complex::new(pair[0], pair[1])
            })
            .collect();
        let thickness = case["layers"].as_array().unwrap().iter().map(|layer| number(&layer["thickness_nm"]));
        let layers: Vec<(Complex, f64)> = index[1..].iter().copied().zip(thickness).collect();
        let cos = cos_deg(number(&case["angle_deg"]));
        let nm = number(&case["wavelength_nm"]);
        let found = response(cos, index[0].re, layers.into_iter(), index[index.len() - 1], nm);
        let matrices = SurfaceMatrices::of_films(&found);
        let (matrix, [s, p]) = match case["of"].as_str().unwrap() {
            "reflection" => (matrices.reflected, [found.s.reflected, found.p.reflected]),
            _ => (matrices.transmitted, [found.s.transmitted, found.p.transmitted]),
        };
        let mut compared = pairs(&conjugate(s), &case["amplitude_s"], tolerance);
        compared.extend(pairs(&conjugate(p), &case["amplitude_p"], tolerance));
        compared.extend(pairs(&elements(matrix), &case["mueller"], tolerance));
        compared.push(angle_pair(argument_deg(matrix.cross), &case["delta_deg"], degrees));
        compared
    });
}

#[test]
fn brewster_angles_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    let rows = file.0["brewster"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 114);
    for row in rows {
        let n = catalogue::find(row[0].as_str().unwrap()).unwrap().index.n(lines::D_NM);
        let near = |found: f64, known: &Value, tolerance: f64| {
            assert!((found - number(known)).abs() <= tolerance, "{found}: {row}");
        };
        near(n, &row[1], tolerance);
        let angle = abbe_optics::fresnel::brewster_angle_deg(1.0, n);
        near(angle, &row[2], degrees);
        near(abbe_optics::fresnel::brewster_angle_deg(n, 1.0), &row[3], degrees);
        let reflected = SurfaceMatrices::dielectric(cos_deg(angle), 1.0, n).reflected;
        near(reflected.s, &row[4], tolerance);
        assert!(reflected.p < 1e-20 && reflected.cross.norm_squared() < 1e-20);
    }
}

/// Finds a root of an increasing function by bisection.
fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn principal_angles_of_metals_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    file.check("principal_angles", |row| {
        let (n, k) = (number(&row["n"]), number(&row["k"]));
        let at = |angle: f64| SurfaceMatrices::conductor(cos_deg(angle), n, k, 1.0).reflected;
        let principal = root(30.0, 89.9, |angle| at(angle).cross.re);
        let step = 1e-4;
        let pseudo = root(30.0, 89.9, |angle| at(angle + step).p - at(angle - step).p);
        let reflected = at(principal);
        let mut compared = pairs(&[principal], &row["principal_angle_deg"], degrees);
        compared.extend(pairs(&[reflected.p / reflected.s], &row["Rp_over_Rs"], tolerance));
        compared.extend(pairs(&[at(pseudo).p], &row["Rp_minimum"], tolerance));
        compared.extend(pairs(&[pseudo], &row["pseudo_brewster_deg"], degrees));
        compared
    });
}

#[test]
fn fresnel_rhombs_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    let reflected = |n: f64, angle: f64| SurfaceMatrices::dielectric(cos_deg(angle), n, 1.0).reflected;
    file.check("fresnel_rhomb", |row| {
        let n = number(&row["n"]);
        let (largest, angle) = largest_total_reflection_delta_deg(n, 1.0).unwrap();
        let mut compared = pairs(&[largest], &row["maximum_delta_deg"], degrees);
        compared.extend(pairs(&[angle], &row["angle_of_maximum_delta_deg"], degrees));
        assert!((argument_deg(reflected(n, angle).cross) - largest).abs() < degrees);
        let angles = total_reflection_angles_deg(n, 1.0, 45.0);
        compared.extend(pairs(
            angles.as_ref().map_or(&[], |found| &found[..]),
            &row["angles_for_delta_45_deg"],
            degrees,
        ));
        if let Some([_, larger]) = angles {
            let once = reflected(n, larger);
            let found = once * once * Stokes([1.0, 0.0, 1.0, 0.0]);
            compared.extend(pairs(&found.0, &row["stokes_after_two_reflections"], tolerance));
        }
        compared
    });
    file.check("fresnel_rhomb_by_wavelength", |row| {
        let glass = RefractiveIndex::catalogue(row["glass"].as_str().unwrap()).unwrap();
        let angle = number(&row["internal_angle_deg"]);
        let n: Vec<f64> = numbers(&row["wavelength_nm"]).into_iter().map(|nm| glass.n(nm)).collect();
        let retardance: Vec<f64> = n.iter().map(|&n| 2.0 * argument_deg(reflected(n, angle).cross)).collect();
        let mut compared = pairs(&n, &row["n"], tolerance);
        compared.extend(pairs(&retardance, &row["retardance_two_reflections_deg"], degrees));
        compared
    });
}

#[test]
fn piles_of_plates_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, dop) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("dop_absolute"));
    file.check("pile_of_plates", |row| {
        let (n, cos) = (number(&row["n"]), cos_deg(number(&row["angle_deg"])));
        let plates = row["plates"].as_u64().unwrap() as u32;
        let pile = Sheet::plate(cos, 1.0, n, 1.0).pile(plates);
        let single = SurfaceMatrices::dielectric(cos, 1.0, n).transmitted;
        let single_pass = (0..2 * plates).fold(Stokes::unpolarised(1.0), |light, _| single * light);
        let mut compared = Vec::new();
        let mut add = |found: f64, key: &str, tolerance| compared.extend(pairs(&[found], &row[key], tolerance));
        for (sheet, letter, name) in [(pile.transmitted, "T", "transmitted"), (pile.front, "R", "reflected")] {
            add(sheet.s, &format!("{letter}s"), tolerance);
            add(sheet.p, &format!("{letter}p"), tolerance);
            add(sheet.mean(), letter, tolerance);
            let light = sheet * Stokes::unpolarised(1.0);
            add(light.degree_of_polarisation(), &format!("dop_{name}"), dop);
        }
        add(single_pass.degree_of_polarisation(), "dop_transmitted_single_pass", dop);
        compared
    });
}

#[test]
fn crossed_mirrors_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, dop) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("dop_absolute"));
    file.check("crossed_mirrors", |row| {
        let mirror = SurfaceMatrices::dielectric(cos_deg(number(&row["angle_deg"])), 1.0, number(&row["n"])).reflected;
        let turn = Rotation::degrees(number(&row["angle_between_planes_deg"]));
        let light = mirror * (turn * (mirror * Stokes::unpolarised(1.0)));
        // The file states the second reflection in the frame of the second mirror.
        let mut compared = pairs(&light.0, &row["stokes"], tolerance);
        compared.extend(pairs(&[mirror.mean() * mirror.mean()], &row["unpolarised_approximation"], tolerance));
        if row["dop"].is_number() {
            compared.extend(pairs(&[light.degree_of_polarisation()], &row["dop"], dop));
        }
        let matrix = Mueller::from(mirror) * turn * Mueller::from(mirror);
        compared.extend(pairs(&(matrix * Stokes::unpolarised(1.0)).0, &row["stokes"], tolerance));
        compared
    });
}

#[test]
fn skylight_on_water_is_golden() {
    let file = golden("polarisation.json");
    let (tolerance, dop) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("dop_absolute"));
    file.check("skylight_reflected_by_water", |row| {
        let incidence = number(&row["incidence_deg"]);
        let sky = super::particles::sky(
            number(&row["sun_zenith_deg"]),
            incidence,
            number(&row["azimuth_from_sun_deg"]),
            number(&row["depolarisation"]),
        );
        let water = SurfaceMatrices::dielectric(cos_deg(incidence), 1.0, number(&row["n"])).reflected;
        let reflected = water * sky.stokes;
        let through = |degrees: f64| {
            let polariser = Mueller::from(crate::filter::IDEAL_POLARISER).turned(Rotation::degrees(degrees));
            (polariser * reflected).power()
        };
        assert_eq!(stokes(&row["stokes_incident"]).0[0], 1.0);
        let mut compared = pairs(&sky.stokes.0, &row["stokes_incident"], tolerance);
        compared.extend(pairs(&[sky.stokes.degree_of_polarisation()], &row["dop_incident"], dop));
        compared.extend(pairs(&reflected.0, &row["stokes_reflected"], tolerance));
        compared.extend(pairs(&[reflected.degree_of_polarisation()], &row["dop_reflected"], dop));
        compared.extend(pairs(&[through(0.0)], &row["transmitted_horizontal_polariser"], tolerance));
        compared.extend(pairs(&[through(90.0)], &row["transmitted_vertical_polariser"], tolerance));
        compared.extend(pairs(&[water.mean()], &row["unpolarised_reflectance"], tolerance));
        compared
    });
}
