//! Air, spheres, the sky and rainbows.

use super::{cos_deg, elements, golden, number, numbers, pairs};
use crate::rainbow::descartes_ray;
use crate::scattering::{rayleigh, spheres};
use crate::sky::{SkyLight, single_scattering};
use crate::{DiattenuatingRetarder, Stokes};
use abbe_optics::RefractiveIndex;
use abbe_optics::phase::mie::MieSpheres;
use glam::DVec3;
use serde_json::Value;

#[test]
fn rayleigh_scattering_is_golden() {
    let file = golden("polarisation.json");
    let (tolerance, dop) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("dop_absolute"));
    file.check("rayleigh", |row| {
        let depolarisation = number(&row["depolarisation"]);
        let mut compared = Vec::new();
        for (i, angle) in numbers(&row["angle_deg"]).into_iter().enumerate() {
            let matrix = rayleigh(cos_deg(angle), depolarisation);
            compared.extend(pairs(&elements(matrix), &row["phase_matrix_per_sr"][i], tolerance));
            let light = matrix * Stokes::unpolarised(1.0);
            compared.extend(pairs(&[light.degree_of_polarisation()], &row["dop"][i], dop));
        }
        // Simpson's rule is exact for a polynomial of cos θ of the second degree.
        let [back, side, ahead] = [-1.0, 0.0, 1.0].map(|cos| rayleigh(cos, depolarisation).0[0][0]);
        let integral = 2.0 * std::f64::consts::PI * (back + 4.0 * side + ahead) / 3.0;
        compared.extend(pairs(&[integral], &row["integral_over_sphere"], tolerance));
        compared
    });
}

/// Returns the skylight in a direction, with the sun at the azimuth 0.
pub(super) fn sky(sun_zenith_deg: f64, zenith_deg: f64, azimuth_deg: f64, depolarisation: f64) -> SkyLight {
    let direction = |zenith: f64, azimuth: f64| {
        let ((sin, cos), (y, x)) = (zenith.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
        DVec3::new(sin * x, sin * y, cos)
    };
    single_scattering(direction(zenith_deg, azimuth_deg), direction(sun_zenith_deg, 0.0), depolarisation)
}

#[test]
fn the_sky_is_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    let dop = file.tolerance("dop_absolute");
    file.check("rayleigh_sky", |case| {
        let mut compared = Vec::new();
        for row in case["rows"].as_array().unwrap() {
            let at = |value: &Value, key: &str| number(&value[key]);
            let sun = at(case, "sun_zenith_deg");
            let found = sky(sun, at(row, "zenith_deg"), at(row, "azimuth_from_sun_deg"), at(case, "depolarisation"));
            compared.extend(pairs(&found.stokes.0, &row["stokes"], tolerance));
            compared.extend(pairs(&[found.stokes.degree_of_polarisation()], &row["dop"], dop));
            let known = at(row, "angle_of_polarisation_deg");
            let angle = found.stokes.angle_of_polarisation_deg();
            let angle = known + (angle - known + 90.0).rem_euclid(180.0) - 90.0;
            compared.extend(pairs(&[angle], &row["angle_of_polarisation_deg"], degrees));
        }
        compared
    });
}

#[test]
fn rainbows_are_golden() {
    let file = golden("polarisation.json");
    let (tolerance, degrees) = (file.tolerance("amplitudes_and_matrices_absolute"), file.tolerance("angles_deg"));
    let dop = file.tolerance("dop_absolute");
    file.check("rainbows", |row| {
        let n = number(&row["n"]);
        let ray = descartes_ray(n, row["internal_reflections"].as_u64().unwrap() as u8).unwrap();
        let inside = ray.refraction.to_degrees() - (1.0 / n).atan().to_degrees();
        let light = ray.matrix * Stokes::unpolarised(1.0);
        let mut compared = Vec::new();
        let mut add = |found: f64, key: &str, tolerance| compared.extend(pairs(&[found], &row[key], tolerance));
        add(ray.incidence.to_degrees(), "incidence_deg", degrees);
        add(ray.bow_radius.to_degrees(), "bow_radius_deg", degrees);
        add(inside, "internal_angle_minus_internal_brewster_deg", degrees);
        add(ray.matrix.s, "I_s", tolerance);
        add(ray.matrix.p, "I_p", tolerance);
        add(light.degree_of_polarisation(), "dop", dop);
        compared
    });
    assert_eq!(descartes_ray(2.5, 1), None);
}

fn drops(radius_um: f64) -> MieSpheres {
    MieSpheres::new(radius_um, None, RefractiveIndex::constant(1.333).unwrap()).unwrap()
}

#[test]
fn small_spheres_scatter_as_air_without_depolarisation() {
    let angles = [0.0, 30.0, 90.0, 120.0, 180.0];
    for (angle, matrix) in angles.iter().zip(drops(0.001).phase_matrix(550.0, &angles)) {
        let (found, known) = (elements(spheres(matrix)), elements(rayleigh(cos_deg(*angle), 0.0)));
        assert!((0..16).all(|i| (found[i] - known[i]).abs() < 2e-5), "{angle}: {found:?} {known:?}");
    }
}

/// Spheres of one size do not depolarise, and the first element is the existing density.
#[test]
fn one_sphere_gives_a_pure_matrix() {
    let angles = [0.0, 1.0, 45.0, 90.0, 138.0, 180.0];
    let found = drops(2.0).phase_matrix(550.0, &angles);
    let density = drops(2.0).scattering(550.0, &angles).pdf_per_sr;
    for (i, matrix) in found.into_iter().enumerate() {
        let DiattenuatingRetarder { s, p, cross } = spheres(matrix);
        assert!((cross.norm_squared() / (s * p) - 1.0).abs() < 1e-9, "{}", angles[i]);
        assert!((0.5 * (s + p) / density[i] - 1.0).abs() < 1e-12);
    }
}

#[test]
fn spheres_of_many_sizes_depolarise() {
    let fog = MieSpheres::new(2.0, Some(1.35), RefractiveIndex::constant(1.333).unwrap()).unwrap();
    for matrix in fog.phase_matrix(550.0, &[60.0, 90.0, 138.0]) {
        let DiattenuatingRetarder { s, p, cross } = spheres(matrix);
        assert!(cross.norm_squared() < 0.99 * s * p, "{matrix:?}");
    }
}

/// Elements for m = 1.333 and x = 5 from the amplitudes S1 and S2 of miepython 3.3.0, whose fields
/// vary as exp(+iωt).
#[test]
fn spheres_match_an_independent_mie_program() {
    let nm = 2.0 * std::f64::consts::PI * 1000.0 / 5.0;
    let spheres = MieSpheres { radii_um: vec![(1.0, 1.0)], index: RefractiveIndex::constant(1.333).unwrap() };
    for (angle, known) in MIEPYTHON {
        let found = spheres.phase_matrix(nm, &[angle])[0];
        let found = [found.s11, found.s12, found.s33, found.s34];
        assert!((0..4).all(|i| (found[i] - known[i]).abs() < 1e-9), "{angle}: {found:?} {known:?}");
    }
}

const MIEPYTHON: [(f64, [f64; 4]); 6] = [
    (0.0, [2.075636994745, 0.000000000000, 2.075636994745, 0.000000000000]),
    (20.0, [0.890632380825, 0.004466544304, 0.888703040190, 0.058420836284]),
    (60.0, [0.036690710426, -0.006097108255, 0.036153137069, -0.001408610168]),
    (90.0, [0.006854384310, -0.001005753852, 0.003792038079, -0.005620630807]),
    (120.0, [0.002143094783, 0.001653095199, 0.001152673171, -0.000729024056]),
    (150.0, [0.007472501790, -0.001589352286, 0.001603544339, -0.007123263849]),
];
