//! Gratings against golden values from other formulas: the cone formula for directions, Fourier
//! coefficients for efficiencies, sums of phasors for line profiles.

use crate::common::near::{assert_near, assert_near_relative, number};
use crate::golden::golden;
use abbe_optics::bsdf::ScatterEvent;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::grating::{DiffractedOrder, Grating, GratingProfile};
use abbe_spectra::spectrum::{Observer, library};
use glam::DVec3;
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

/// Returns the direction in which light arrives.
fn incident(incidence_deg: f64, azimuth_deg: f64) -> DVec3 {
    let ((sin, cos), (sin_a, cos_a)) = (incidence_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    DVec3::new(sin * cos_a, sin * sin_a, -cos)
}

fn event(case: &Value) -> ScatterEvent {
    if case["mode"] == "reflection" { ScatterEvent::Reflection } else { ScatterEvent::Transmission }
}

fn blazed(order: i32, blaze_nm: f64) -> GratingProfile {
    GratingProfile::Blazed { order, blaze_nm }
}

fn order(orders: &[DiffractedOrder], number: i32) -> &DiffractedOrder {
    orders.iter().find(|it| it.order == number).expect("the order propagates")
}

#[test]
fn orders_leave_in_the_golden_directions() {
    let file = golden("grating.json");
    let cases = file["order_directions"].as_array().unwrap();
    assert_eq!(cases.len(), 74);
    for case in cases {
        let grating = Grating::new(1e6 / number(&case["period_nm"]), blazed(1, 500.0)).unwrap();
        let arriving = incident(number(&case["incidence_deg"]), number(&case["azimuth_deg"]));
        let indices = [number(&case["n_in"]), number(&case["n_out"])];
        let orders = grating.orders(arriving, event(case), indices, number(&case["wavelength_nm"]));
        let numbers: Vec<f64> = orders.iter().map(|it| f64::from(it.order)).collect();
        assert_near("orders", &numbers, &case["orders"], 0.0);
        for (i, it) in orders.iter().enumerate() {
            assert_near("direction", it.direction.to_array(), &case["direction"][i], 1e-9);
            assert_near("polar angle", it.polar_deg(), number(&case["diffracted_polar_deg"][i]), 1e-7);
            if let Some(angles) = case.get("diffracted_deg") {
                assert_near("angle", it.signed_deg(), number(&angles[i]), 1e-7);
            }
        }
    }
}

fn profile(case: &Value) -> GratingProfile {
    let parameter = |key: &str| {
        let value = &case["parameters"][key];
        value.as_str().map_or_else(|| number(value), |text| text.parse().unwrap())
    };
    match case["profile"].as_str().unwrap() {
        "blazed" => blazed(parameter("order") as i32, parameter("blaze_nm")),
        "blazed, dispersive" => GratingProfile::BlazedGlass {
            index: RefractiveIndex::catalogue(case["parameters"]["glass"].as_str().unwrap()).unwrap(),
            depth_nm: parameter("depth_nm"),
        },
        "sinusoidal phase" => {
            GratingProfile::Sinusoidal { amplitude_rad: parameter("amplitude_rad"), at_nm: parameter("at_nm") }
        }
        "binary phase" => GratingProfile::BinaryPhase {
            phase_rad: parameter("phase_rad"),
            at_nm: parameter("at_nm"),
            duty: parameter("duty"),
        },
        "binary amplitude" => GratingProfile::BinaryAmplitude { duty: parameter("duty") },
        other => panic!("unknown profile {other}"),
    }
}

#[test]
fn orders_have_the_golden_efficiencies() {
    let file = golden("grating.json");
    let cases = file["efficiencies"].as_array().unwrap();
    assert_eq!(cases.len(), 40);
    for case in cases {
        let grating = Grating::new(number(&case["lines_per_mm"]), profile(case)).unwrap();
        let arriving = incident(number(&case["incidence_deg"]), number(&case["azimuth_deg"]));
        let orders = grating.orders(arriving, event(case), [1.0; 2], number(&case["wavelength_nm"]));
        let what = format!("{} {} at {} nm", case["profile"], case["parameters"], case["wavelength_nm"]);
        let numbers: Vec<f64> = orders.iter().map(|it| f64::from(it.order)).collect();
        assert_near(&what, &numbers, &case["orders"], 0.0);
        let scalar: Vec<f64> = orders.iter().map(|it| it.scalar_efficiency).collect();
        assert_near(&what, &scalar, &case["efficiency_scalar"], 1e-9);
        assert_near(&what, scalar.iter().sum::<f64>(), number(&case["sum_scalar"]), 1e-9);
        let efficiencies: Vec<f64> = orders.iter().map(|it| it.efficiency).collect();
        assert_near(&what, &efficiencies, &case["efficiency"], 1e-9);
    }
}

#[test]
fn renormalised_efficiencies_are_those_of_the_light_s_direction() {
    for case in golden("grating.json")["reciprocity"].as_array().unwrap() {
        let parameters = &case["parameters"];
        let profile = blazed(number(&parameters["order"]) as i32, number(&parameters["blaze_nm"]));
        let grating = Grating::new(number(&case["lines_per_mm"]), profile).unwrap();
        let (nm, number_of_order) = (number(&case["wavelength_nm"]), number(&case["order"]) as i32);
        let arriving = incident(number(&case["incidence_deg"]), 0.0);
        let forward = grating.orders(arriving, ScatterEvent::Reflection, [1.0; 2], nm);
        let forward = order(&forward, number_of_order);
        let reverse = grating.orders(-forward.direction, ScatterEvent::Reflection, [1.0; 2], nm);
        let reverse = order(&reverse, number_of_order);
        assert_near("angle", forward.signed_deg(), number(&case["diffracted_deg"]), 1e-7);
        assert!((reverse.direction + arriving).length() < 1e-9, "the order leads back");
        for (key, it) in [("forward", forward), ("reverse", reverse)] {
            assert_near(key, it.scalar_efficiency, number(&case[key]["scalar"]), 1e-9);
            assert_near(key, it.efficiency, number(&case[key]["renormalised"]), 1e-9);
        }
    }
}

#[test]
fn the_sodium_doublet_is_split_by_the_golden_angles() {
    for case in golden("grating.json")["sodium_doublet"].as_array().unwrap() {
        let grating = Grating::new(number(&case["lines_per_mm"]), blazed(1, 500.0)).unwrap();
        let (arriving, number_of_order) = (incident(number(&case["incidence_deg"]), 0.0), number(&case["order"]));
        let angle = |nm: f64| {
            let orders = grating.orders(arriving, ScatterEvent::Reflection, [1.0; 2], nm);
            order(&orders, number_of_order as i32).signed_deg()
        };
        let (d2, d1) = (588.995, 589.5924);
        assert_near("D2", angle(d2), number(&case["angle_D2_deg"]), 1e-7);
        assert_near("D1", angle(d1), number(&case["angle_D1_deg"]), 1e-7);
        let apart = (angle(d1) - angle(d2)) * 3600.0;
        assert_near("separation", apart, number(&case["separation_arcsec"]), 4e-4);
        // The lines are resolved by N grooves, each line falls to 0 at an angle of λ/(N d cos θ).
        let mean = 0.5 * (d1 + d2);
        let grooves = (mean / (number_of_order * (d1 - d2))).ceil();
        assert_eq!(grooves, number(&case["lines_to_resolve"]));
        let cos = angle(mean).to_radians().cos();
        let width = (mean / (grooves * grating.period_nm() * cos)).to_degrees() * 3600.0;
        assert_near_relative("half width", width, number(&case["angular_half_width_arcsec"]), 1e-3);
    }
}

#[test]
fn optical_discs_show_the_golden_wavelengths() {
    for disc in golden("grating.json")["optical_discs"].as_array().unwrap() {
        let grating = Grating::new(1e6 / number(&disc["period_nm"]), blazed(1, 500.0)).unwrap();
        let arriving = incident(number(&disc["incidence_deg"]), 0.0);
        for case in disc["directions"].as_array().unwrap() {
            let angle = number(&case["diffracted_deg"]);
            for (number_of_order, nm) in numbers(&case["orders"]).into_iter().zip(numbers(&case["wavelength_nm"])) {
                let orders = grating.orders(arriving, ScatterEvent::Reflection, [1.0; 2], nm);
                assert_near("disc", order(&orders, number_of_order as i32).signed_deg(), angle, 1e-7);
            }
        }
    }
}

#[test]
fn littrow_s_order_returns_along_the_beam() {
    for case in golden("grating.json")["littrow"].as_array().unwrap() {
        let grating = Grating::new(number(&case["lines_per_mm"]), blazed(1, 500.0)).unwrap();
        // Light that arrives at −θ leaves in the order m at θ.
        let arriving = incident(-number(&case["littrow_deg"]), 0.0);
        let orders = grating.orders(arriving, ScatterEvent::Reflection, [1.0; 2], number(&case["wavelength_nm"]));
        let found = order(&orders, number(&case["order"]) as i32).direction;
        assert!((found + arriving).length() < 1e-9, "{found} for {}", -arriving);
    }
}

#[test]
fn a_white_beam_is_spread_over_a_screen_as_the_golden_file_says() {
    let light = library::find("D65").unwrap().spectrum;
    let observer = Observer::cie1931();
    let white: f64 = (360..=830).map(f64::from).map(|nm| light.at(nm) * observer.xyz_bar(nm)[1]).sum();
    for case in golden("grating.json")["projected_spectrum"].as_array().unwrap() {
        let profile = blazed(number(&case["blaze_order"]) as i32, number(&case["blaze_nm"]));
        let grating = Grating::new(number(&case["lines_per_mm"]), profile).unwrap();
        let screen_mm = number(&case["screen_mm"]);
        for (i, x) in numbers(&case["x_mm"]).into_iter().enumerate() {
            let distance = x.hypot(screen_mm);
            let (sin, cos) = (x / distance, screen_mm / distance);
            let mut found = [0.0; 3];
            for number_of_order in 1..=4 {
                let nm = grating.period_nm() * sin / f64::from(number_of_order);
                if !(360.0..=830.0).contains(&nm) {
                    continue;
                }
                let orders = grating.orders(-DVec3::Z, ScatterEvent::Transmission, [1.0; 2], nm);
                let per_mm = grating.period_nm() * cos.powi(3) / (f64::from(number_of_order) * screen_mm);
                let power = order(&orders, number_of_order).efficiency * light.at(nm) * per_mm / white;
                let bars = observer.xyz_bar(nm);
                (0..3).for_each(|c| found[c] += power * bars[c]);
            }
            assert_near_relative("XYZ per mm", found, &case["XYZ_per_mm"][i], 1e-6);
        }
    }
}
