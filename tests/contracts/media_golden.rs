//! Media against golden values that were computed independently in Python from the same published
//! data.

use crate::common::near::{assert_near, number};
use crate::golden::golden;
use abbe_optics::phase::{Deflection, PhaseFunction, rainbow};
use abbe_spectra::spectrum::{Observer, Spectrum, library};

#[test]
fn henyey_and_greenstein_s_function_has_its_values() {
    for check in golden("media.json")["hg_checks"].as_array().unwrap() {
        let g = number(&check["g"]);
        let phase = PhaseFunction::HenyeyGreenstein { g: Spectrum::constant(g) };
        for (degrees, expected) in check["P_at_deg"].as_object().unwrap() {
            let cos = degrees.parse::<f64>().unwrap().to_radians().cos();
            let (got, expected) = (phase.eval(Deflection::horizontal(cos), 550.0), number(expected));
            assert_near(&format!("g = {g} at {degrees}°"), got, expected, 1e-8 * expected);
        }
    }
}

/// Returns D65 after `path_m` metres of this extinction as XYZ with white Y = 1, by plain sums over
/// whole nanometres.
fn transmitted(extinction: &Spectrum, path_m: f64) -> [f64; 3] {
    let (light, observer) = (library::find("D65").expect("an illuminant of the library").spectrum, Observer::cie1931());
    let mut sums = [0.0; 4];
    for nm in (360..=830).map(f64::from) {
        let passed = light.at(nm) * (-extinction.at(nm) * path_m).exp();
        let [x, y, z] = observer.xyz_bar(nm);
        [passed * x, passed * y, passed * z, light.at(nm) * y]
            .iter()
            .zip(&mut sums)
            .for_each(|(part, sum)| *sum += part);
    }
    [0, 1, 2].map(|i| sums[i] / sums[3])
}

#[test]
fn water_and_air_colour_daylight_by_beer_s_law() {
    let golden = golden("media.json");
    let spectrum = |name: &str| library::find(name).unwrap().spectrum;
    let beams = [("water_beam", "path_m", 1.0, "water/absorption"), ("air_beam", "path_km", 1000.0, "air/scattering")];
    for (beam, key, metres, name) in beams {
        for row in golden[beam].as_array().unwrap() {
            let path_m = number(&row[key]) * metres;
            let found = transmitted(&spectrum(name), path_m);
            for (i, found) in found.into_iter().enumerate() {
                let expected = number(&row["XYZ"][i]);
                assert_near(&format!("{name} after {path_m} m"), found, expected, 0.005 * expected);
                println!("{name} {path_m} m: off by {:.1e}", found / expected - 1.0);
            }
        }
    }
    for (nm, expected) in golden["rayleigh_per_m"].as_object().unwrap() {
        let (found, expected) = (spectrum("air/scattering").at(nm.parse().unwrap()), number(expected));
        assert_near(&format!("air at {nm} nm"), found, expected, 0.005 * expected);
    }
}

/// Returns the angle in degrees of the largest density within a range.
fn brightest(phase: &PhaseFunction, nm: f64, (from, to): (f64, f64)) -> f64 {
    let steps = 2000;
    let angle = |i: u32| from + (to - from) * f64::from(i) / f64::from(steps);
    let density = |i: u32| phase.eval(Deflection::horizontal(angle(i).to_radians().cos()), nm);
    angle((0..=steps).max_by(|&a, &b| density(a).total_cmp(&density(b))).expect("some steps"))
}

#[test]
fn rainbow_angles_match_the_mie_series_for_half_a_millimetre() {
    let rain = PhaseFunction::Table(rainbow());
    let rows = golden("rainbow.json")["rows"].as_array().unwrap().clone();
    // Scattering angles of the brightest primary and secondary bow in `mie_rain_r0.5mm.csv`.
    let peaks = [
        (440.0, 139.25, 126.75),
        (490.0, 138.85, 127.5),
        (546.1, 138.5, 128.15),
        (589.3, 138.3, 128.45),
        (632.8, 138.15, 128.75),
        (680.0, 138.0, 129.0),
    ];
    for (nm, primary, secondary) in peaks {
        let found = (brightest(&rain, nm, (135.0, 142.0)), brightest(&rain, nm, (122.0, 132.0)));
        println!("{nm} nm: primary {:.2}° ({primary}), secondary {:.2}° ({secondary})", found.0, found.1);
        assert_near(&format!("primary bow at {nm} nm"), found.0, primary, 0.3);
        assert_near(&format!("secondary bow at {nm} nm"), found.1, secondary, 0.3);
        // The peak is inside the geometric bow, by less than half a degree.
        let row = rows.iter().min_by(|a, b| {
            let off = |row: &serde_json::Value| (number(&row["wavelength_nm"]) - nm).abs();
            off(a).total_cmp(&off(b))
        });
        let geometric = 180.0 - number(&row.unwrap()["primary_deg"]);
        assert!((0.0..0.6).contains(&(found.0 - geometric)), "{nm} nm: {} behind {geometric}", found.0);
        // It is dark between the bows (Alexander's band).
        let at = |degrees: f64| rain.eval(Deflection::horizontal(degrees.to_radians().cos()), nm);
        assert!(at(134.0) < 0.25 * at(found.0), "{nm} nm");
    }
    for (nm, mean_cosine) in [(440.0, 0.881_38), (546.1, 0.883_2), (680.0, 0.884_43)] {
        assert_near(
            &format!("mean cosine at {nm} nm"),
            rain.mean_cosine(nm).expect("drops are round"),
            mean_cosine,
            0.005,
        );
    }
}
