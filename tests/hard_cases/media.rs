//! Media: extremely thin and extremely dense ones, very narrow phase functions, spikes of density,
//! and rays along the faces of grids.

use std::sync::Arc;

use abbe_optics::phase::{Deflection, PhaseFunction};
use abbe_scene::geometry::Ray;
use abbe_scene::medium::field::{FieldGrid, FieldShape, ScalarField};
use abbe_scene::medium::{Density, Medium, TransmittanceEstimator};
use abbe_session::render::Integrator;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::spectrum::Spectrum;
use abbe_transport::walk::SegmentTransmittance;
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::common::{mean_y, render};
use super::golden::golden;
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "Optical depths of 1e-12 to 1e6, in homogeneous fog and in a grid",
        naive: "1 − σΔx per step becomes negative; τ is the sum of thousands of steps",
        here: "the column density has a closed form per cell, followed by one exponential",
        measured: "relative error of the depth computed from the transmittance, beyond the rounding of 1 − τ",
        bound: Bound::AtMost(1e-13),
        pace: Pace::Fast,
        measure: || {
            let depths = (-12..=2).map(|power| 10.0_f64.powi(power));
            depths
                .flat_map(|depth| [fog(depth), even_grid(depth)].map(|medium| depth_error(&medium, depth)))
                .fold(0.0, f64::max)
        },
    },
    Case {
        name: "Fog of optical depth 1e6",
        naive: "a negative transmittance, or a loop over a million steps",
        here: "the result is 0, because exp(−10⁶) is below the smallest number",
        measured: "transmittance",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            [fog(1e6), even_grid(1e6)].map(|medium| through(&medium, &LINE, 1.0)).into_iter().fold(0.0, f64::max)
        },
    },
    Case {
        name: "Henyey–Greenstein's function for g = 0, ±1e-6, 0.5, −0.9, ±0.9999, 0.999999",
        naive: "1 + g² − 2g cos θ loses all digits in the peak",
        here: "(1 − g)² + 2g(1 − cos θ) is a sum of positive terms",
        measured: "relative error of the density against 50 digits",
        bound: Bound::AtMost(2e-15),
        pace: Pace::Fast,
        measure: || {
            phase_rows("phase_densities")
                .map(|(g, cos, density)| {
                    (henyey_greenstein(g).eval(Deflection::horizontal(cos), 550.0) / density - 1.0).abs()
                })
                .fold(0.0, f64::max)
        },
    },
    Case {
        name: "Directions sampled from this function",
        naive: "the textbook inverse divides by 2g and subtracts two numbers close to 1",
        here: "1 − cos θ is computed without cancellation, and the direction is built from it",
        measured: "error of 1 − cos θ against 50 digits, in 8 roundings of it, of the direction or of u",
        bound: Bound::AtMost(1.0),
        pace: Pace::Fast,
        measure: || phase_rows("phase_draws").map(|(g, u, truth)| draw_error(g, u, truth)).fold(0.0, f64::max),
    },
    Case {
        name: "Free-flight distances for u = 0 and 1 − ulp, in grids with empty cells",
        naive: "ln(1 − u) at u = 1; a point beyond the end, or in an empty cell",
        here: "Newton's method within the cell that contains the point; no point if the depth is not reached",
        measured: "points outside the medium, or with a wrong column density",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: misplaced,
    },
    Case {
        name: "Ratio tracking through a voxel 10⁶ times as dense as its neighbours",
        naive: "one majorant for the whole grid gives a million null collisions per metre; a majorant below the spike gives negative weights",
        here: "each block of cells has a majorant that bounds its contents",
        measured: "difference between the mean of 20,000 tracked transmittances and the exact one, in standard errors",
        bound: Bound::AtMost(4.0),
        pace: Pace::Fast,
        measure: spike,
    },
    Case {
        name: "Rays in the faces of a grid and between its cells",
        naive: "the cell is floor(x) on one side and floor(x) − 1 on the other, so the ray is in neither or in both",
        here: "the density is continuous, and cells are traversed by the ray's parameter",
        measured: "relative difference between the column density on the plane and 1e-12 beside it",
        bound: Bound::AtMost(1e-9),
        pace: Pace::Fast,
        measure: grazing,
    },
    Case {
        name: "Extinction that varies 10⁶ : 1 over the band",
        naive: "one wavelength samples the path, and ratios as large weight the others: coloured fireflies",
        here: "spectral multiple importance sampling: no weight exceeds the number of wavelengths",
        measured: "largest pixel of white fog in front of a uniform sky, relative to the sky (1 is exact, 4 the limit of the weights)",
        bound: Bound::AtMost(4.0),
        pace: Pace::Fast,
        measure: largest_before_sky,
    },
    Case {
        name: "Non-absorbing fog, 30 mean free paths across",
        naive: "an albedo above 1 by rounding grows from event to event",
        here: "absorption and scattering are separate inputs, and the albedo is computed from them",
        measured: "absolute balance of the ledger",
        bound: Bound::AtMost(1e-12),
        pace: Pace::Fast,
        measure: || {
            let ledger = render(&white_ball(json!(15.0)), Integrator::Photon, 1).ledger;
            if ledger.emitted > 0.0 { ledger.balance().abs() } else { f64::INFINITY }
        },
    },
    Case {
        name: "An emitting gas whose absorption approaches 0 (optical depth 1e-12)",
        naive: "(1 − exp(−τ))·B is 0 or a multiple of 1e-16·B",
        here: "emission is integrated along the ray, without a difference",
        measured: "10⁶ times the radiance, relative to a thin gas 10⁶ times as dense, minus 1",
        bound: Bound::AtMost(1e-5),
        pace: Pace::Fast,
        measure: || {
            let thin = |absorption: f64| render(&glowing(absorption), Integrator::Photon, 4).picture.mean_y();
            (1e6 * thin(1e-12) / thin(1e-6) - 1.0).abs()
        },
    },
];

/// The ray along which the media below have their stated depth within 1 m.
const LINE: Ray = Ray { origin: DVec3::new(0.31, 0.47, 0.0), direction: DVec3::Z };

fn medium(extinction: f64, density: Density) -> Medium {
    let coefficients = (Spectrum::constant(extinction), Spectrum::constant(0.0));
    Medium::new("it".into(), coefficients, PhaseFunction::Isotropic, density)
}

fn fog(extinction: f64) -> Medium {
    medium(extinction, Density::Uniform)
}

/// Densities of cells in the unit cube.
fn cells(resolution: [usize; 3], values: impl ExactSizeIterator<Item = f64>) -> Density {
    let grid = FieldGrid::new(resolution, values).unwrap();
    Density::Field(Arc::new(ScalarField::new(FieldShape::Grid(grid), (DVec3::ZERO, DVec3::ONE), DAffine3::IDENTITY)))
}

fn even_grid(extinction: f64) -> Medium {
    medium(extinction, cells([7, 5, 11], vec![1.0; 7 * 5 * 11].into_iter()))
}

fn through(medium: &Medium, ray: &Ray, length_m: f64) -> f64 {
    SegmentTransmittance::new(medium, *ray, length_m, Seed::new(0)).at(550.0)
}

/// Returns the relative error of the depth −ln T. T is rounded to half an ulp, which exceeds the
/// depth of a very thin medium.
fn depth_error(medium: &Medium, depth: f64) -> f64 {
    let found = -through(medium, &LINE, 1.0).ln();
    ((found - depth).abs() - f64::EPSILON).max(0.0) / depth
}

fn henyey_greenstein(g: f64) -> PhaseFunction {
    PhaseFunction::HenyeyGreenstein { g: Spectrum::constant(g) }
}

/// Rows of two inputs and the exact value.
fn phase_rows(name: &str) -> impl Iterator<Item = (f64, f64, f64)> {
    let rows = golden("hard_cases.json")[name].as_array().unwrap().clone();
    rows.into_iter()
        .map(|row| (row[0].as_f64().unwrap(), row[1].as_f64().unwrap(), row[2].as_str().unwrap().parse().unwrap()))
}

/// Returns the error of the sampled 1 − cos θ, relative to the error that rounding explains: of the
/// value itself, of the direction's three components (|δ(1 − cos θ)| ≤ sin θ · ulp), and of u. Far
/// from the peak one ulp of u is a large angle, but little light goes there.
fn draw_error(g: f64, u: f64, truth: f64) -> f64 {
    let drawn = henyey_greenstein(g).sample(DVec3::Z, 550.0, [u, 0.3]);
    let axis = DVec3::Z * 1.0_f64.copysign(g);
    let one_minus_cos = 0.5 * (drawn - axis).length_squared();
    let by_u =
        u / (std::f64::consts::TAU * henyey_greenstein(g.abs()).eval(Deflection::horizontal(1.0 - truth), 550.0));
    let by_direction = (truth * (2.0 - truth)).max(0.0).sqrt();
    (one_minus_cos - truth).abs() / (8.0 * f64::EPSILON * (truth + by_direction + by_u) + f64::EPSILON * f64::EPSILON)
}

fn misplaced() -> f64 {
    // Every second pair of layers is empty.
    let medium = medium(3.0, cells([1, 1, 8], (0..8).map(|z| f64::from(z % 4 / 2)).collect::<Vec<_>>().into_iter()));
    let column_m = medium.column_m(&LINE, f64::INFINITY);
    let wrong =
        [0.0, f64::MIN_POSITIVE, 1e-300, 1e-9, 0.3, 0.5, 0.999, 1.0 - 0.5 * f64::EPSILON].into_iter().filter(|u| {
            let wanted_m = u * column_m;
            let Some(t) = medium.distance_at(&LINE, f64::INFINITY, wanted_m) else { return true };
            !(0.0..=1.0).contains(&t) || (medium.column_m(&LINE, t) - wanted_m).abs() > 4.0 * f64::EPSILON * column_m
        });
    // A column density larger than that of the whole medium is never reached.
    let beyond =
        [1.0 + 1e-9, 1e300, f64::INFINITY].map(|share| medium.distance_at(&LINE, f64::INFINITY, share * column_m));
    wrong.count() as f64 + beyond.iter().flatten().count() as f64
}

fn spike() -> f64 {
    const SEEDS: u64 = 20_000;
    let mut values = vec![1e-3; 9 * 9 * 9];
    values[4 + 9 * (4 + 9 * 4)] = 1e3;
    let exact = medium(0.01, cells([9; 3], values.into_iter()));
    let tracked = Medium { transmittance: TransmittanceEstimator::Ratio, ..exact.clone() };
    let ray = Ray::new(DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.4, 0.3, 0.5).normalize());
    let truth = through(&exact, &ray, 2.0);
    let mut stream = Stream::new(Seed::new(5), Purpose::Camera, 0, 0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..SEEDS {
        let seed = (stream.uniform() * 2.0_f64.powi(53)) as u64;
        let found = SegmentTransmittance::new(&tracked, ray, 2.0, Seed::new(seed)).at(550.0);
        sum += found;
        squares += found * found;
    }
    let mean = sum / SEEDS as f64;
    let error = ((squares / SEEDS as f64 - mean * mean) / SEEDS as f64).sqrt();
    // The standard error is only meaningful if some light passes and some is lost.
    if truth > 0.05 && truth < 0.95 && error > 0.0 { (mean - truth).abs() / error } else { f64::INFINITY }
}

fn grazing() -> f64 {
    let mut stream = Stream::new(Seed::new(6), Purpose::Camera, 0, 0);
    let values: Vec<f64> = (0..8 * 8 * 8).map(|_| stream.uniform()).collect();
    let medium = medium(1.0, cells([8; 3], values.into_iter()));
    let mut worst = 0.0_f64;
    for plane in 0..=16 {
        let x = f64::from(plane) / 16.0;
        for direction in [DVec3::Z, DVec3::new(0.0, 0.6, 0.8), DVec3::new(0.0, 1e-9, 1.0).normalize()] {
            // At an outer face, the neighbouring point is inside.
            let beside = if plane == 0 { x + 1e-12 } else { x - 1e-12 };
            let column = |x: f64| medium.column_m(&Ray { origin: DVec3::new(x, 0.0, 0.0), direction }, f64::INFINITY);
            let (on, near) = (column(x), column(beside));
            worst = worst.max(if near > 0.0 { (on / near - 1.0).abs() } else { f64::INFINITY });
        }
    }
    worst
}

/// A ball of non-absorbing fog in front of a uniform sky of radiance 1.
fn white_ball(scattering: Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 16 } } },
        "film": { "width": 8, "height": 8 },
        "media": { "white": { "homogeneous": { "absorption": 0, "scattering": scattering, "phase": "isotropic" } } },
        "materials": { "white": { "boundary": { "medium": "white" } } },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "white" }],
        "lights": [{ "environment": { "spectrum": "E", "illuminance": std::f64::consts::PI } }],
        "render": { "photons": 2000, "max_depth": 4096 }
    })
}

fn largest_before_sky() -> f64 {
    let scattering = json!({ "table": { "nm": [360, 550, 600, 830], "values": [8e-6, 8e-3, 8e-2, 8] } });
    let sky = mean_y(&render(&white_ball(json!(0.0)), Integrator::Path, 4))[0];
    let picture = render(&white_ball(scattering), Integrator::Path, 16).picture;
    picture.xyz.iter().map(|xyz| xyz[1] / sky).fold(0.0, f64::max)
}

/// A box of hot gas, 1 m deep, that fills the picture.
fn glowing(absorption: f64) -> Value {
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 0.1 } } },
        "film": { "width": 8, "height": 8 },
        "media": { "gas": { "homogeneous": { "absorption": absorption, "scattering": 0, "phase": "isotropic",
                                             "emission": { "blackbody": { "temperature": 3000 } } } } },
        "materials": { "gas": { "boundary": { "medium": "gas" } } },
        "objects": [{ "shape": { "box": { "size": [4, 4, 1] } }, "material": "gas", "transform": [{ "translate": [0, 0, -1.5] }] }],
        "render": { "photons": 100 }
    })
}
