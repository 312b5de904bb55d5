//! Polarisers and retarders.

use super::{cos_deg, elements, golden, number, numbers, pairs};
use crate::filter::{self, Handedness};
use crate::surface::SurfaceMatrices;
use crate::{Mueller, Rotation, Stokes};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

fn polariser(degrees: f64) -> Mueller {
    Mueller::from(filter::IDEAL_POLARISER).turned(Rotation::degrees(degrees))
}

fn retarder(degrees: f64, fast_axis_deg: f64) -> Mueller {
    Mueller::from(filter::retarder(degrees.to_radians())).turned(Rotation::degrees(fast_axis_deg))
}

#[test]
fn polarisers_are_golden() {
    let file = golden("polarisation.json");
    let tolerance = file.tolerance("amplitudes_and_matrices_absolute");
    file.check("malus", |row| {
        let angles = numbers(&row["polariser_angles_deg"]);
        let light = angles.into_iter().fold(Stokes::unpolarised(1.0), |light, angle| polariser(angle) * light);
        pairs(&light.0, &row["stokes"], tolerance)
    });
}

#[test]
fn retarders_are_golden() {
    let file = golden("polarisation.json");
    let tolerance = file.tolerance("amplitudes_and_matrices_absolute");
    file.check("retarders", |row| {
        let degrees = |key: &str| number(&row[key]);
        let plate = retarder(degrees("retardance_deg"), degrees("fast_axis_deg"));
        let light = plate * (polariser(degrees("polariser_deg")) * Stokes::unpolarised(1.0));
        let mut compared = pairs(&elements(plate), &row["mueller"], tolerance);
        compared.extend(pairs(&light.0, &row["stokes_after_retarder"], tolerance));
        if let Some(analyser) = row.get("analyser_deg").and_then(Value::as_f64) {
            compared.extend(pairs(&[(polariser(analyser) * light).power()], &row["transmitted"], tolerance));
        }
        compared
    });
}

#[test]
fn a_circular_polariser_stops_what_a_mirror_returns() {
    let file = golden("polarisation.json");
    let tolerance = file.tolerance("amplitudes_and_matrices_absolute");
    file.check("circular_polariser_isolator", |row| {
        let (n, k, cos) = (number(&row["n"]), number(&row["k"]), cos_deg(number(&row["angle_deg"])));
        let mirror = Mueller::from(SurfaceMatrices::conductor(cos, n, k, 1.0).reflected);
        let axis = number(&row["quarter_wave_fast_axis_deg"]);
        let chain = polariser(0.0) * retarder(90.0, -axis) * mirror * retarder(90.0, axis) * polariser(0.0);
        let without = polariser(0.0) * mirror * polariser(0.0);
        let light = Stokes::unpolarised(1.0);
        let mut compared = pairs(&[(chain * light).power()], &row["returned"], tolerance);
        compared.extend(pairs(&[(without * light).power()], &row["returned_without_retarder"], tolerance));
        compared
    });
}

#[test]
fn circular_polarisers_have_their_handedness() {
    for (handedness, s3) in [(Handedness::Right, 0.5), (Handedness::Left, -0.5)] {
        let light = filter::circular_polariser(handedness, FRAC_PI_2) * Stokes::unpolarised(1.0);
        assert!((light.0[3] - s3).abs() < 1e-15 && (light.power() - 0.5).abs() < 1e-15, "{light:?}");
    }
}

/// The extinction ratio of crossed polarisers, and that of parallel ones.
#[test]
fn principal_transmittances_give_parallel_and_crossed_pairs() {
    let (k1, k2) = (0.8, 1e-3);
    let sheet = Mueller::from(filter::linear_polariser(k1, k2));
    let light = Stokes::unpolarised(1.0);
    assert!(((sheet * sheet * light).power() - 0.5 * (k1 * k1 + k2 * k2)).abs() < 1e-15);
    let crossed = sheet.turned(Rotation::degrees(90.0)) * sheet;
    assert!(((crossed * light).power() - k1 * k2).abs() < 1e-15);
    // A pair of principal transmittances does not depolarise light at 45°.
    assert!(((sheet * Stokes([1.0, 0.0, 1.0, 0.0])).degree_of_polarisation() - 1.0).abs() < 1e-12);
}
