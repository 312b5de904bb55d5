//! Thin films against golden values that transfer matrices of another program confirmed.

use crate::common::near::{assert_near, number};
use crate::golden::golden;
use abbe_optics::glass::{Dispersion, RefractiveIndex};
use abbe_optics::texture::SurfaceScalar;
use abbe_optics::thin_film::{
    CoatedPlate, FilmLayer, FilmStack, OpticalIndex, PolarisedResponse, StackResponse, response,
};
use abbe_spectra::math::complex::Complex;
use abbe_spectra::spectrum::{BAND_NM, Observer, library};
use serde_json::Value;

/// The stated tolerance of R, T and A.
const POWER: f64 = 1e-9;

/// Returns the index of a material of the golden file. The file names models and constants.
fn material(name: &str) -> OpticalIndex {
    let cauchy = |a, b| Dispersion::Cauchy { a, b, c: 0.0 };
    let index = match name {
        "air" => RefractiveIndex::constant(1.0),
        "light oil (model)" => RefractiveIndex::new(cauchy(1.46, 0.005), BAND_NM),
        "TiO2 film (model)" => RefractiveIndex::new(cauchy(2.21, 0.045), BAND_NM),
        _ if name.starts_with("n ") => RefractiveIndex::constant(name[2..].parse().unwrap()),
        _ => match library::metal(name) {
            Ok(metal) => {
                let (n, k) = metal.index();
                return OpticalIndex::absorbing(n, k).unwrap();
            }
            Err(_) => RefractiveIndex::catalogue(name),
        },
    };
    OpticalIndex::Transparent(index.unwrap())
}

fn layers(value: &Value) -> Vec<FilmLayer> {
    let of_list = |list: &Value| -> Vec<FilmLayer> {
        let layer = |layer: &Value| FilmLayer {
            index: material(layer["material"].as_str().unwrap()),
            thickness_nm: SurfaceScalar::Uniform(number(&layer["thickness_nm"])),
        };
        list.as_array().unwrap().iter().map(layer).collect()
    };
    match value.get("repeat") {
        Some(repeat) => {
            let pair = of_list(&value["pair"]);
            (0..repeat.as_u64().unwrap()).flat_map(|_| pair.clone()).collect()
        }
        None => of_list(value),
    }
}

/// A stack of the golden file between its two half-spaces.
struct GoldenStack {
    incident: OpticalIndex,
    films: FilmStack,
    substrate: OpticalIndex,
}

impl GoldenStack {
    fn of(case: &Value) -> Self {
        Self {
            incident: material(case["incident"].as_str().unwrap()),
            films: FilmStack::new(layers(&case["layers"])).unwrap(),
            substrate: material(case["substrate"].as_str().unwrap()),
        }
    }

    fn response(&self, angle_deg: f64, nm: f64) -> StackResponse {
        let cos = angle_deg.to_radians().cos();
        self.films.response(cos, self.incident.at(nm).re, self.substrate.at(nm), nm, 0.0)
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

/// The sections with rows of R, T and A over wavelength, and the number of their cases.
const SECTIONS: [(&str, usize); 6] = [
    ("soap_film_in_air", 14),
    ("oil_on_water", 6),
    ("antireflection", 4),
    ("multilayers", 4),
    ("oxide_on_metal", 11),
    ("metal_film_on_glass", 3),
];

#[test]
fn stacks_reflect_and_transmit_as_transfer_matrices() {
    let file = golden("thin_film.json");
    let mut compared = 0;
    for (section, count) in SECTIONS {
        let cases = file[section].as_array().unwrap();
        assert_eq!(cases.len(), count, "{section}");
        for case in cases {
            let (stack, name) = (GoldenStack::of(case), case["case"].as_str().unwrap());
            let wavelengths = numbers(&case["wavelength_nm"]);
            for row in case["rows"].as_array().unwrap() {
                let angle = number(&row["angle_deg"]);
                for (i, &nm) in wavelengths.iter().enumerate() {
                    let found = stack.response(angle, nm);
                    let (s, p) = (found.s, found.p);
                    for (key, value) in [
                        ("Rs", s.reflectance),
                        ("Rp", p.reflectance),
                        ("R", found.reflectance()),
                        ("Ts", s.transmittance),
                        ("Tp", p.transmittance),
                        ("T", found.transmittance()),
                        ("As", s.absorptance()),
                        ("Ap", p.absorptance()),
                        ("A", found.absorptance()),
                    ] {
                        let Some(known) = row.get(key) else { continue };
                        assert_near(&format!("{key} of {name}, {angle}°, {nm} nm"), value, number(&known[i]), POWER);
                        compared += 1;
                    }
                    if row.get("T").is_none() {
                        assert_near(&format!("T of {name}, {angle}°"), found.absorptance(), 0.0, POWER);
                    }
                }
            }
            if let Some(known) = case.get("R_at_design_closed_form") {
                let found = stack.response(0.0, number(&case["design_nm"])).reflectance();
                assert_near(&format!("closed form of {name}"), found, number(known), POWER);
            }
        }
    }
    assert!(compared > 3000, "{compared} values compared");
}

/// Returns XYZ by sums over whole nm, with Y = 1 for a perfect mirror.
fn xyz(light: &str, power: impl Fn(f64) -> f64) -> [f64; 3] {
    let light = library::find(light).unwrap().spectrum;
    let observer = Observer::cie1931();
    let (mut sum, mut white) = ([0.0; 3], 0.0);
    for nm in 360..=830 {
        let nm = f64::from(nm);
        let (bars, watts) = (observer.xyz_bar(nm), light.at(nm));
        (0..3).for_each(|i| sum[i] += power(nm) * watts * bars[i]);
        white += watts * bars[1];
    }
    sum.map(|value| value / white)
}

#[test]
fn colours_of_films_match_the_golden_sums() {
    let file = golden("thin_film.json");
    let mut compared = 0;
    for (section, _) in SECTIONS {
        for case in file[section].as_array().unwrap() {
            let stack = GoldenStack::of(case);
            for colour in case["colour"].as_array().unwrap() {
                let (light, angle) = (colour["light"].as_str().unwrap(), number(&colour["angle_deg"]));
                let power = |of: fn(&StackResponse) -> f64| xyz(light, |nm| of(&stack.response(angle, nm)));
                let mut check = |known: &Value, found: [f64; 3]| {
                    let what = format!("{section}, {}, {light}, {angle}°", case["case"]);
                    let largest = found.into_iter().fold(0.0, f64::max);
                    assert_near(&what, found, &known["XYZ"], 1e-6 * largest);
                    let total: f64 = found.iter().sum();
                    assert_near(&what, [found[0] / total, found[1] / total], &known["xy"], 1e-6);
                    compared += 1;
                };
                check(&colour["reflected"], power(StackResponse::reflectance));
                if let Some(known) = colour.get("transmitted") {
                    check(known, power(StackResponse::transmittance));
                }
                for (key, of) in [
                    ("reflected_s_only_XYZ", (|it| it.s.reflectance) as fn(&StackResponse) -> f64),
                    ("reflected_p_only_XYZ", |it| it.p.reflectance),
                ] {
                    if let Some(known) = colour.get(key) {
                        let found = power(of);
                        assert_near(key, found, known, 1e-6 * found.into_iter().fold(0.0, f64::max));
                    }
                }
            }
        }
    }
    assert!(compared > 80, "{compared} colours compared");
}

#[test]
fn light_tunnels_through_a_gap_beyond_the_critical_angle() {
    for case in golden("thin_film.json")["frustrated_total_internal_reflection"].as_array().unwrap() {
        let (n, cos) = (number(&case["n"]), number(&case["angle_deg"]).to_radians().cos());
        for (i, gap) in numbers(&case["gap_nm"]).into_iter().enumerate() {
            let layer = [(Complex::from(1.0), gap)];
            let found = response(cos, n, layer.into_iter(), n.into(), number(&case["wavelength_nm"]));
            assert_near("Ts", found.s.transmittance, number(&case["Ts"][i]), POWER);
            assert_near("Tp", found.p.transmittance, number(&case["Tp"][i]), POWER);
            assert_near("As", found.s.absorptance(), 0.0, POWER);
        }
    }
}

#[test]
fn the_surface_plasmon_lies_where_the_golden_file_has_it() {
    let case = &golden("thin_film.json")["surface_plasmon"][0];
    let (n, nm) = (number(&case["n_glass"]), number(&case["wavelength_nm"]));
    let metal = numbers(&case["n_metal"]);
    let at = |degrees: f64| {
        let layer = [(Complex::new(metal[0], metal[1]), 50.0)];
        response(degrees.to_radians().cos(), n, layer.into_iter(), 1.0.into(), nm)
    };
    for (i, angle) in numbers(&case["angle_deg"]).into_iter().enumerate() {
        assert_near("Rp", at(angle).p.reflectance, number(&case["Rp"][i]), POWER);
        assert_near("Rs", at(angle).s.reflectance, number(&case["Rs"][i]), POWER);
    }
    // The minimum, by a search with the golden section.
    let (mut low, mut high) = (42.0_f64, 44.0_f64);
    while high - low > 1e-9 {
        let (a, b) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        if at(a).p.reflectance < at(b).p.reflectance { high = b } else { low = a }
    }
    assert_near("angle of the minimum", low, number(&case["angle_of_minimum_deg"]), 1e-5);
    assert_near("minimum", at(low).p.reflectance, number(&case["Rp_minimum"]), POWER);
}

#[test]
fn coated_plates_add_the_powers_between_their_faces() {
    for case in golden("thin_film.json")["coated_plates"].as_array().unwrap() {
        let (nm, glass) = (number(&case["wavelength_nm"]), material(case["glass"].as_str().unwrap()));
        let [front, back] = ["front", "back"].map(|face| FilmStack::new(layers(&case[face])).unwrap());
        let cos = number(&case["angle_deg"]).to_radians().cos();
        let n = glass.at(nm).re;
        let inside = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
        let plate = CoatedPlate {
            front: front.response(cos, 1.0, n.into(), nm, 0.0),
            front_inside: front.response_reversed(inside, n, 1.0.into(), nm, 0.0),
            // The coating of the back face is listed from the outside.
            back_inside: back.response_reversed(inside, n, 1.0.into(), nm, 0.0),
            passage: 1.0,
        };
        let found = plate.response();
        for (key, value) in [
            ("Rs", found.s[0]),
            ("Rp", found.p[0]),
            ("R", found.mean()[0]),
            ("Ts", found.s[1]),
            ("Tp", found.p[1]),
            ("T", found.mean()[1]),
        ] {
            assert_near(key, value, number(&case[key]), POWER);
        }
    }
}

/// The gap of Newton's rings has the thickness r²/(2R).
#[test]
fn newton_s_rings_follow_the_gap() {
    let file = golden("thin_film.json");
    let rings = file["newton_rings"].as_array().unwrap();
    assert_eq!(rings.len(), 2);
    for case in rings {
        let radius_m = number(&case["lens_radius_m"]);
        let [lens, gap, plate] = ["lens", "gap_medium", "plate"].map(|key| material(case[key].as_str().unwrap()));
        let at = |nm: f64, thickness_nm: f64| {
            let layer = [(gap.at(nm), thickness_nm)];
            response(1.0, lens.at(nm).re, layer.into_iter(), plate.at(nm), nm).reflectance()
        };
        for line in case["lines"].as_array().unwrap() {
            let nm = number(&line["wavelength_nm"]);
            let thickness = |radius_mm: f64| radius_mm * radius_mm * 1e-6 / (2.0 * radius_m) * 1e9;
            let profile = numbers(&line["profile"]["radius_mm"]);
            for (i, &radius) in profile.iter().enumerate() {
                let known = number(&line["profile"]["reflectance"][i]);
                assert_near("profile", at(nm, thickness(radius)), known, POWER);
            }
            // Dark and bright rings are extrema of the reflectance.
            for (key, sign) in [("dark_radius_mm", 1.0), ("bright_radius_mm", -1.0)] {
                for radius in numbers(&line[key]) {
                    let beside = [-1e-3, 1e-3].map(|step| at(nm, thickness(radius + step)));
                    let middle = at(nm, thickness(radius));
                    assert!(beside.iter().all(|&it| sign * (it - middle) > 0.0), "{key} {radius}: {middle} {beside:?}");
                }
            }
        }
        if let Some(white) = case.get("white") {
            for (i, gap_nm) in numbers(&white["gap_nm"]).into_iter().enumerate() {
                let found = xyz("D65", |nm| at(nm, gap_nm));
                assert_near("white", found, &white["XYZ"][i], 1e-6 * found.into_iter().fold(1e-9, f64::max));
            }
        }
        if let Some(sodium) = case.get("sodium_doublet") {
            let lines = numbers(&sodium["lines_nm"]);
            for (key, weights) in [("visibility_weights_2_1", [2.0, 1.0]), ("visibility_weights_1_1", [1.0, 1.0])] {
                for (i, gap_um) in numbers(&sodium["gap_um"]).into_iter().enumerate() {
                    let turn = |line: usize| Complex::unit(4e3 * std::f64::consts::PI * gap_um / lines[line]);
                    let sum = turn(0) * weights[0] + turn(1) * weights[1];
                    let found = sum.norm_squared().sqrt() / (weights[0] + weights[1]);
                    assert_near(key, found, number(&sodium[key][i]), 1e-9);
                }
            }
        }
    }
}

/// The amplitudes with their phases. The golden file uses exp(+iωt), so its amplitudes are the
/// complex conjugates.
#[test]
fn amplitudes_of_films_have_the_golden_phases() {
    let file = golden("polarisation.json");
    let films = file["films"].as_array().unwrap();
    assert!(films.len() > 5);
    for case in films {
        let indices: Vec<Complex> = case["index"]
            .as_array()
            .unwrap()
            .iter()
            .map(|pair| Complex::new(number(&pair[0]), number(&pair[1])))
            .collect();
        let thicknesses = case["layers"].as_array().unwrap().iter().map(|layer| number(&layer["thickness_nm"]));
        let layers: Vec<(Complex, f64)> =
            indices[1..].iter().map(|n| Complex::new(n.re, n.im.abs())).zip(thicknesses).collect();
        let substrate = indices[indices.len() - 1];
        let substrate = Complex::new(substrate.re, substrate.im.abs());
        let cos = number(&case["angle_deg"]).to_radians().cos();
        let found = response(cos, indices[0].re, layers.into_iter(), substrate, number(&case["wavelength_nm"]));
        for (key, part) in [("amplitude_s", found.s), ("amplitude_p", found.p)] {
            let PolarisedResponse { reflected, transmitted, .. } = part;
            let amplitude = if case["of"] == "reflection" { reflected } else { transmitted };
            let what = format!("{key} of {} at {} nm", case["of"], case["wavelength_nm"]);
            assert_near(&what, [amplitude.re, -amplitude.im], &case[key], POWER);
        }
    }
}
