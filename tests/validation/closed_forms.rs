//! Cases with closed forms or published values: integrating spheres, slabs and half-spaces that
//! scatter, and the prism of Newton's letter of 1672. The length of Newton's image has no closed
//! form, so it is measured apart from the cases ([`newtons_length`]).

use super::{Case, ExpectedReading, measure_scene};
use abbe_session::render::{StopRules, Value};
use abbe_spectra::math::elementary::{asin, exp, ln, sin, sin_cos, tan};
use abbe_spectra::math::quadrature::gauss16;
use glam::DVec2;
use serde_json::{Value as Json, json};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;
use std::path::Path;

/// Returns all cases.
pub(crate) fn cases() -> Vec<Case> {
    vec![integrating_sphere(), slab(), half_space(), glass_half_space(), prism_width(), prism_deviation()]
}

/// The illuminance in lx, the luminance in cd/m² or the flux in lm of each light.
const LIGHT: f64 = 1000.0;

fn case(id: &str, title: &str, unit: &str, scenes: Vec<(String, Vec<ExpectedReading>)>) -> Case {
    let (id, title, unit) = (id.to_string(), title.to_string(), unit.to_string());
    Case { id, title, unit, scenes, relative: 0.01, absolute: 1e-3 }
}

/// Returns an expected value of a reading that is divided by [`LIGHT`].
fn expected(id: &str, value: f64, published: Option<f64>) -> ExpectedReading {
    ExpectedReading { id: id.to_string(), value, published, scale: 1.0 / LIGHT, offset: 0.0 }
}

/// A lamp in the middle of a diffuse sphere: the wall receives Φ/(4πR²)/(1 − ρ).
fn integrating_sphere() -> Case {
    let of_reflectance = |reflectance: f64| {
        let scene = json!({
            "materials": {"wall": {"diffuse": {"reflectance": reflectance}}},
            "objects": [{"name": "wall", "shape": {"sphere": {"radius": 0.5}}, "material": "wall"}],
            "lights": [{"point": {"at": [0, 0, 0], "spectrum": "E", "luminous_flux": LIGHT}}],
            "meters": [{"name": "wall", "surface": "wall", "side": "back"}]
        });
        let value = 1.0 / PI / (1.0 - reflectance);
        (scene.to_string(), vec![expected(&format!("reflectance {reflectance}"), value, None)])
    };
    let title = "The illuminance of the wall of a diffuse sphere of radius 0.5 m around a lamp";
    case("integrating-sphere", title, "lx/lm", [0.5, 0.8, 0.95].map(of_reflectance).to_vec())
}

/// Returns a box of a scattering medium with its upper face at y = 0.
fn medium_box([absorption, scattering]: [f64; 2], phase: &Json, material: &Json, [width, height]: [f64; 2]) -> Json {
    json!({
        "media": {"medium": {"homogeneous": {"absorption": absorption, "scattering": scattering, "phase": phase}}},
        "materials": {"medium": material},
        "objects": [{
            "shape": {"box": {"size": [width, height, width]}}, "material": "medium",
            "transform": [{"translate": [0, -0.5 * height, 0]}]
        }]
    })
}

/// Parallel light falls at right angles onto a slab of optical depth 2, with albedo 0.9 and the
/// phase function of Henyey and Greenstein with g = 0.75 (van de Hulst, Multiple Light Scattering,
/// 1980, table 35).
fn slab() -> Case {
    let phase = json!({"henyey_greenstein": {"g": 0.75}});
    let mut scene = medium_box([0.2, 1.8], &phase, &json!({"boundary": {"medium": "medium"}}), [400.0, 1.0]);
    scene["lights"] = json!([{"directional": {"toward": [0, -1, 0], "spectrum": "E", "illuminance": LIGHT}}]);
    scene["meters"] = json!([
        {"name": "reflected", "points": [[0, 1e-3, 0]], "normal": [0, -1, 0]},
        {"name": "transmitted", "points": [[0, -1.001, 0]], "normal": [0, 1, 0]}
    ]);
    let values =
        vec![expected("reflected", 0.097_39, Some(0.097_39)), expected("transmitted", 0.660_96, Some(0.660_96))];
    let title = "The reflectance and the transmittance of a slab: optical depth 2, albedo 0.9, g = 0.75 (van de Hulst)";
    case("slab", title, "1", vec![(scene.to_string(), values)])
}

/// A half-space that scatters isotropically with albedo a. In diffuse light of luminance L, the
/// luminance at right angles is L (1 − H(1) √(1 − a)), where H is Chandrasekhar's function
/// (Chandrasekhar, Radiative Transfer, 1960, section 38).
fn half_space() -> Case {
    const ALBEDO: f64 = 0.9;
    let material = json!({"boundary": {"medium": "medium"}});
    let value = 1.0 - h_function(ALBEDO, 1.0) * (1.0 - ALBEDO).sqrt();
    let title = "The reflectance of a half-space that scatters isotropically, albedo 0.9 (Chandrasekhar)";
    case("half-space", title, "1", vec![(from_above(&material), vec![expected("at right angles", value, None)])])
}

/// The same half-space with the index of refraction 1.5 (Giovanelli 1955, as quoted by Wang,
/// Jacques and Zheng 1995, MCML). By reciprocity, the reflectance of parallel light at right angles
/// equals the luminance at right angles in diffuse light.
fn glass_half_space() -> Case {
    let material = json!({"dielectric": {"ior": 1.5, "medium": "medium"}});
    let title = "The reflectance of a half-space of index 1.5 that scatters isotropically, albedo 0.9 (Giovanelli)";
    let values = vec![expected("at right angles", 0.26, Some(0.26))];
    case("glass-half-space", title, "1", vec![(from_above(&material), values)])
}

/// Returns a deep box of a medium with albedo 0.9 in diffuse light, and a luminance meter above it.
fn from_above(material: &Json) -> String {
    let mut scene = medium_box([1.0, 9.0], &json!("isotropic"), material, [80.0, 4.0]);
    scene["lights"] = json!([{"environment": {"spectrum": "E", "luminance": LIGHT}}]);
    scene["meters"] = json!([{"name": "above", "spot": {"from": [0, 0.5, 0], "to": [0, 0, 0], "angle": 0.5}}]);
    scene.to_string()
}

/// Returns Chandrasekhar's function H(μ) for isotropic scattering, from its integral equation
/// 1/H(μ) = √(1 − a) + a/2 ∫ μ′ H(μ′)/(μ + μ′) dμ′.
fn h_function(albedo: f64, mu: f64) -> f64 {
    /// The number of values between which H is interpolated linearly.
    const STEPS: usize = 256;
    const ROUNDS: u32 = 60;
    let grid = |i: usize| i as f64 / STEPS as f64;
    let mut values = vec![1.0; STEPS + 1];
    let next = |values: &[f64], mu: f64| {
        let panel = |i: usize| {
            let of = |at: f64| {
                let t = at * STEPS as f64 - i as f64;
                at * ((1.0 - t) * values[i] + t * values[i + 1]) / (mu + at)
            };
            gauss16((grid(i), grid(i + 1)), of)
        };
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * (0..STEPS).map(panel).sum::<f64>())
    };
    for _ in 0..ROUNDS {
        values = (0..=STEPS).map(|i| next(&values, grid(i))).collect();
    }
    next(&values, mu)
}

/// The prism of Newton's letter (Philosophical Transactions 80, 1672), in the plane of refraction.
/// The middle ray leaves it along −y at x = 0, and the wall is the plane y = 0.
struct NewtonsPrism {
    /// The corners of the prism: the refracting edge first.
    corners: [DVec2; 3],
    /// The middle of the hole, and a point on its axis in the direction of the light.
    hole: [DVec2; 2],
    /// The share of the light that both faces transmit.
    transmitted: f64,
    /// The distance from the hole to the wall, in which the path in the glass counts 1/n, in m.
    length_m: f64,
}

/// The refracting angle of the prism: 63° 12′.
const REFRACTING_ANGLE_DEG: f64 = 63.2;

/// The index of refraction that Newton computed from the mean deviation.
const INDEX: f64 = 1.5453;

const INCH_M: f64 = 0.0254;

/// The diameter of the hole: a quarter of an inch.
const HOLE_M: f64 = 0.25 * INCH_M;

/// The distance of the wall: 22 feet.
const DISTANCE_M: f64 = 22.0 * 12.0 * INCH_M;

/// The angular radius of the sun in Newton's letter: 15.5′.
const SUN_RADIUS_DEG: f64 = 15.5 / 60.0;

/// The width of the image in Newton's letter: 2⅝ inches.
const WIDTH_M: f64 = 2.625 * INCH_M;

impl NewtonsPrism {
    /// Places the prism so that the middle ray is refracted equally at both faces. This is the
    /// least deviation.
    fn new() -> Self {
        /// The lengths of the faces, the distance of the middle ray from the refracting edge, and
        /// the distance of the hole from the prism, in m.
        const FACE_M: f64 = 0.04;
        const RAY_M: f64 = 0.02;
        const HOLE_DISTANCE_M: f64 = 0.01;
        let half_angle = 0.5 * REFRACTING_ANGLE_DEG.to_radians();
        let half_deviation = 0.5 * least_deviation();
        let (sine, cosine) = sin_cos(half_angle);
        let (left, right) = (DVec2::new(-sine, -cosine), DVec2::new(sine, -cosine));
        // In the frame of the prism, the middle ray leaves at the angle −δ/2. This rotation turns
        // the ray to −y.
        let turn = unit(half_deviation - FRAC_PI_2);
        let exit = DVec2::new(0.0, DISTANCE_M);
        let place = |point: DVec2| exit + turn.rotate(point - RAY_M * right);
        let axis = turn.rotate(unit(half_deviation));
        let entry = place(RAY_M * left);
        // Fresnel's equations for light without polarisation, the same at both faces.
        let (outside, inside) = (half_deviation + half_angle, half_angle);
        let s = sin(outside - inside) / sin(outside + inside);
        let p = tan(outside - inside) / tan(outside + inside);
        let face = 1.0 - 0.5 * (s * s + p * p);
        Self {
            corners: [DVec2::ZERO, FACE_M * left, FACE_M * right].map(place),
            hole: [entry - HOLE_DISTANCE_M * axis, entry],
            transmitted: face * face,
            length_m: DISTANCE_M + HOLE_DISTANCE_M + 2.0 * RAY_M * sine / INDEX,
        }
    }

    /// Returns the scene with strips on the wall. `glass` is the index of the prism or the name of
    /// its glass, and `spectrum` is the spectrum of the sun. A strip is its name, its middle and
    /// its size, both along x and z.
    fn scene(&self, [glass, spectrum]: [&Json; 2], strips: &[(String, DVec2, DVec2)]) -> String {
        const HALF_WIDTH_M: f64 = 0.03;
        let corner = |z: f64| self.corners.map(|corner| [corner.x, corner.y, z]);
        let positions = [corner(-HALF_WIDTH_M), corner(HALF_WIDTH_M)].concat();
        // Counter-clockwise from outside.
        let indices = [[0, 2, 1], [3, 4, 5], [0, 4, 3], [0, 1, 4], [1, 5, 4], [1, 2, 5], [2, 3, 5], [2, 0, 3]];
        let mut objects = vec![json!({
            "name": "prism", "shape": {"triangles": {"positions": positions, "indices": indices}}, "material": "glass"
        })];
        objects.extend(strips.iter().map(|(name, middle, size)| {
            json!({
                "name": name, "shape": {"rectangle": {"width": size.x, "height": size.y}}, "material": "wall",
                "transform": [{"translate": [middle.x, 0, middle.y]}]
            })
        }));
        let meters: Vec<Json> = strips
            .iter()
            .map(|(name, ..)| json!({"name": name, "surface": name, "side": "front", "quantity": "luminous_flux"}))
            .collect();
        let [from, to] = self.hole.map(|point| [point.x, point.y, 0.0]);
        json!({
            "materials": {"glass": {"dielectric": {"ior": glass}}, "wall": {"diffuse": {"reflectance": 0}}},
            "objects": objects,
            "lights": [{"beam": {
                "from": from, "to": to, "radius": 0.5 * HOLE_M, "divergence": SUN_RADIUS_DEG, "spectrum": spectrum,
                "luminous_flux": LIGHT
            }}],
            "meters": meters
        })
        .to_string()
    }

    /// Returns the share of the light on one side of the middle of the image within a distance.
    fn fraction_within(&self, distance_m: f64) -> f64 {
        /// The number of intervals of the quadrature.
        const PANELS: u32 = 64;
        let sun_m = self.length_m * tan(SUN_RADIUS_DEG.to_radians());
        // The distribution of the distance is that of a uniform disk (the sun) folded with that of
        // another (the hole).
        let below = |x: f64| {
            let x = x.clamp(-1.0, 1.0);
            0.5 + (x * (1.0 - x * x).sqrt() + asin(x)) / PI
        };
        let of_hole = |angle: f64| {
            let (sine, cosine) = sin_cos(angle);
            below((distance_m - 0.5 * HOLE_M * sine) / sun_m) * 2.0 / PI * cosine * cosine
        };
        let edge = |i: u32| PI * (f64::from(i) / f64::from(PANELS) - 0.5);
        (0..PANELS).map(|i| gauss16((edge(i), edge(i + 1)), of_hole)).sum::<f64>() - 0.5
    }
}

/// Returns the unit vector at an angle from the x axis, in radians.
fn unit(angle: f64) -> DVec2 {
    let (sine, cosine) = sin_cos(angle);
    DVec2::new(cosine, sine)
}

/// Returns the least deviation of the prism in radians. It is the mean deviation of the letter, 44°
/// 56′, except for rounding.
fn least_deviation() -> f64 {
    let angle = REFRACTING_ANGLE_DEG.to_radians();
    2.0 * asin(INDEX * sin(0.5 * angle)) - angle
}

/// The width of the image: the flux on strips along the length of the image. Beyond the edges of an
/// image of 2⅝ inches, the wall is dark.
fn prism_width() -> Case {
    const LENGTH_M: f64 = 0.2;
    let prism = NewtonsPrism::new();
    let half = 0.5 * WIDTH_M;
    let edges = [0.0, 0.25 * half, 0.5 * half, 0.75 * half, half, 2.0 * half];
    let names = ["1st quarter", "2nd quarter", "3rd quarter", "4th quarter", "outside of 2⅝ inches"];
    let (mut strips, mut values) = (Vec::new(), Vec::new());
    for (ends, name) in edges.windows(2).zip(names) {
        let (middle, size) = (DVec2::new(0.0, 0.5 * (ends[0] + ends[1])), DVec2::new(LENGTH_M, ends[1] - ends[0]));
        strips.push((name.to_string(), middle, size));
        let fraction = prism.fraction_within(ends[1]) - prism.fraction_within(ends[0]);
        values.push(expected(name, prism.transmitted * fraction, None));
    }
    let title =
        "Newton's letter of 1672: the flux on strips from the middle of the image to its edge at half of 2⅝ inches";
    case("newton-width", title, "lm/lm", vec![(prism.scene([&json!(INDEX), &json!("E")], &strips), values)])
}

/// The mean deviation: one half of the light falls on each side of the point at 44° 56′. One minute
/// of arc more changes these shares by 4 %.
fn prism_deviation() -> Case {
    const SIZE_M: DVec2 = DVec2::new(0.1, 0.1);
    let prism = NewtonsPrism::new();
    let sides = [("less than 44° 56′", 0.5 * SIZE_M.x), ("more than 44° 56′", -0.5 * SIZE_M.x)];
    let strips: Vec<_> = sides.iter().map(|&(name, x)| (name.to_string(), DVec2::new(x, 0.0), SIZE_M)).collect();
    let values = sides.iter().map(|(name, _)| expected(name, 0.5 * prism.transmitted, None)).collect();
    let title = "Newton's letter of 1672: the flux on both sides of the mean deviation of 44° 56′";
    case("newton-deviation", title, "lm/lm", vec![(prism.scene([&json!(INDEX), &json!("E")], &strips), values)])
}

/// Measures the illuminance along the image of the sun, with sunlight as a black body of 5500 K and
/// prisms of two glasses of about Newton's index. Returns a section for the page: the share of the
/// largest illuminance at the ends of an image of 13¼ inches, for each glass. The folder `files`
/// holds the scene.
pub(crate) fn newtons_length(files: &Path) -> String {
    /// The number of strips along the image.
    const STRIPS: usize = 96;
    /// The number of passes with photons.
    const PASSES: u64 = 24;
    /// The length and the width of a strip.
    const STRIP_M: DVec2 = DVec2::new(0.25 * INCH_M, 1.0 * INCH_M);
    const LENGTH_M: f64 = 13.25 * INCH_M;
    let prism = NewtonsPrism::new();
    let middle = |i: usize| (i as f64 - 0.5 * (STRIPS - 1) as f64) * STRIP_M.x;
    let strips: Vec<_> = (0..STRIPS).map(|i| (format!("strip {i}"), DVec2::new(middle(i), 0.0), STRIP_M)).collect();
    let sun = json!({"blackbody": {"temperature": 5500}});
    let stop = StopRules { passes: Some(PASSES), ..StopRules::default() };
    let mut text = "
## newton-length

The length of Newton's image, 13¼ inches, depends on the dispersion of the glass and on the least
illuminance that the eye sees. The letter states neither, so the length is no test case. Abbe
measures the illuminance of sunlight (a black body at 5500 K) on strips of ¼ inch along the middle
of the image. The threshold is the illuminance at both ends of an image of this length, divided by
the largest illuminance.

| Glass | n_d | V_d | Threshold |
| --- | ---: | ---: | ---: |
"
    .to_string();
    for (glass, index, number) in [("LLF1", "1.548", "45.8"), ("N-BALF5", "1.547", "53.6")] {
        let scene = prism.scene([&json!(glass), &sun], &strips);
        let report = measure_scene(&scene, files, stop);
        let lumens = report.meters.iter().map(|meter| match meter.points[0].value {
            Value::Number(lumens) => lumens,
            Value::Spectrum(_) => 0.0,
        });
        let threshold = threshold_of_length(&lumens.collect::<Vec<_>>(), LENGTH_M / STRIP_M.x);
        let percent = threshold.map_or("–".to_string(), |fraction| format!("{:.3} %", 100.0 * fraction));
        let _ = writeln!(text, "| {glass} | {index} | {number} | {percent} |");
    }
    text
}

/// Returns the share of the largest value at which a peak has this length, in steps between values.
/// The logarithms of the values are interpolated linearly. Returns `None` if the peak is shorter at
/// all positive values.
fn threshold_of_length(values: &[f64], length: f64) -> Option<f64> {
    /// Halvings of the interval of the logarithm.
    const HALVINGS: u32 = 50;
    let logarithms: Vec<f64> = values.iter().map(|value| ln(value.max(f64::MIN_POSITIVE))).collect();
    let largest = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]))?;
    let top = logarithms[largest];
    // The distance from the peak to the first place below a threshold.
    let length_to = |threshold: f64, outwards: &mut dyn Iterator<Item = usize>| {
        let (mut before, mut steps) = (top, 0.0);
        for i in outwards {
            if logarithms[i] < threshold {
                return steps + (before - threshold) / (before - logarithms[i]);
            }
            (before, steps) = (logarithms[i], steps + 1.0);
        }
        steps
    };
    let length_at = |threshold: f64| {
        length_to(threshold, &mut (0..largest).rev()) + length_to(threshold, &mut (largest + 1..values.len()))
    };
    let dark =
        logarithms.iter().copied().fold(top, |least, value| if value > -700.0 { least.min(value) } else { least });
    let (mut low, mut high) = (dark, top);
    if length_at(low) < length {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if length_at(middle) < length { high = middle } else { low = middle }
    }
    Some(exp(low - top))
}

/// The values were computed in numpy with 200 Gauss points.
#[test]
fn the_h_function_agrees_with_another_quadrature() {
    for (albedo, mu, expected) in [(0.9, 1.0, 1.850_098_52), (0.5, 1.0, 1.251_259_56), (0.9, 0.5, 1.556_033_80)] {
        let found = h_function(albedo, mu);
        assert!((found - expected).abs() < 2e-5, "{albedo} {mu}: {found} for {expected}");
    }
}

/// An exponential peak with different slopes on both sides.
#[test]
fn thresholds_give_the_length_of_a_peak() {
    let values: Vec<f64> =
        (0..40).map(|i| if i < 10 { exp(f64::from(i - 10)) } else { exp(f64::from(10 - i) / 2.0) }).collect();
    let fraction = threshold_of_length(&values, 9.0).unwrap();
    assert!((fraction - exp(-3.0)).abs() < 1e-9, "{fraction}");
    assert_eq!(threshold_of_length(&values, 60.0), None);
}

/// The numbers of Newton's letter belong together: the index gives the mean deviation, and the
/// hole, the sun and the distance give the width.
#[test]
fn the_numbers_of_newtons_letter_agree() {
    let deviation_deg = least_deviation().to_degrees();
    assert!((deviation_deg - (44.0 + 56.0 / 60.0)).abs() < 0.5 / 60.0, "{deviation_deg}");
    let prism = NewtonsPrism::new();
    let width_m = HOLE_M + 2.0 * prism.length_m * tan(SUN_RADIUS_DEG.to_radians());
    assert!((width_m / WIDTH_M - 1.0).abs() < 0.01, "{width_m}");
    assert!((prism.fraction_within(width_m) - 0.5).abs() < 1e-12 && prism.fraction_within(0.0).abs() < 1e-12);
}
