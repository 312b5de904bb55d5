//! Spectra: lines with continua, the ends of the band, black bodies at extreme temperatures, and
//! light that is not reflected or not visible.

use serde_json::{Value, json};

use abbe_format::{self as format, resolve};
use abbe_session::render::{Integrator, Job};
use abbe_spectra::spectrum::{Observer, Outside, SpectralLine, Spectrum, WavelengthDistribution, planck};

use super::common::{diffuse, glass, render};
use super::golden::golden;
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "Black bodies from 35 K to 10¹⁵ K",
        naive: "exp overflows at low temperatures; 1 − exp(−x) loses all digits at high ones",
        here: "the exponential is split into two factors, and expm1 is used",
        measured: "relative error against 50 digits",
        bound: Bound::AtMost(2e-13),
        pace: Pace::Fast,
        measure: black_bodies,
    },
    Case {
        name: "A spectral line 10¹² times as strong as its continuum",
        naive: "a table of the spectrum loses the line or the continuum",
        here: "lines are narrow intervals with their exact probability",
        measured: "relative difference between Φ/p and the power, over draws of both",
        bound: Bound::AtMost(1e-12),
        pace: Pace::Fast,
        measure: || {
            let line = Spectrum::lines(&[SpectralLine { nm: 589.3, power: 1e12, fwhm_nm: None }]).unwrap();
            drawn(&Spectrum::mix(&[(1.0, &line), (1.0 / 470.0, &Spectrum::constant(1.0))]))
        },
    },
    Case {
        name: "A continuum 10¹² times as strong as its spectral line",
        naive: "as above",
        here: "as above",
        measured: "relative difference between Φ/p and the power, over draws of both",
        bound: Bound::AtMost(1e-12),
        pace: Pace::Fast,
        measure: || {
            let line = Spectrum::lines(&[SpectralLine { nm: 589.3, power: 1e-12, fwhm_nm: None }]).unwrap();
            drawn(&Spectrum::mix(&[(1.0, &line), (1.0 / 470.0, &Spectrum::constant(1.0))]))
        },
    },
    Case {
        name: "Lines at 360 and 830 nm, and tables that end there",
        naive: "half a line is counted too much, or the last sample is lost",
        here: "the part outside the band is cut off with its power; the last sample belongs to the table",
        measured: "relative error of integrals and end values",
        bound: Bound::AtMost(1e-15),
        pace: Pace::Fast,
        measure: band_ends,
    },
    Case {
        name: "A light whose wavelengths no surface reflects",
        naive: "0/0 when path weights are normalised",
        here: "densities come from the light alone, so products with zero are zero",
        measured: "largest component of the picture",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let red = json!({ "table": { "nm": [599, 600, 700, 701], "values": [0, 0.9, 0.9, 0] } });
            let blue = json!({ "table": { "nm": [429, 430, 470, 471], "values": [0, 1, 1, 0] } });
            let worst = |integrator| {
                let picture = render(&lit(blue.clone(), red.clone()), integrator, 4).picture;
                picture.xyz.iter().flatten().map(|c| c.abs()).fold(0.0, f64::max)
            };
            f64::max(worst(Integrator::Photon), worst(Integrator::Path))
        },
    },
    Case {
        name: "Light outside 360–830 nm only",
        naive: "a black picture after an hour of rendering, or NaN",
        here: "an error before the first pass, because no light is visible",
        measured: "lights that are not refused, of 4",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let unseen = [
                json!({ "lines": [{ "nm": 253.65, "power": 1 }] }),
                json!({ "table": { "nm": [200, 300, 355], "values": [1, 2, 1] } }),
                json!({ "gaussian": { "peak_nm": 200, "fwhm_nm": 5 } }),
                json!({ "blackbody": { "temperature": 8 } }),
            ];
            unseen.into_iter().filter(|lamp| !is_refused(&lit(lamp.clone(), json!(0.5)))).count() as f64
        },
    },
    Case {
        name: "A light with a single spectral line, seen directly",
        naive: "samples at fixed wavelengths miss the line",
        here: "wavelengths are drawn from the light's spectrum, within the line's width",
        measured: "relative error of Y against 683 lm/W · L · ȳ(λ)",
        bound: Bound::AtMost(2e-5),
        pace: Pace::Fast,
        measure: || {
            let rendered = render(&one_line(json!([]), json!({ "pinhole": { "fov": 10 } })), Integrator::Photon, 8);
            let truth = 683.0 * Observer::cie1931().xyz_bar(589.3)[1];
            rendered.picture.xyz.iter().map(|xyz| (xyz[1] / truth - 1.0).abs()).fold(0.0, f64::max)
        },
    },
    Case {
        name: "The same light through a prism",
        naive: "shared wavelengths miss the line, and the picture is black or has another colour",
        here: "the shared wavelengths of a pass are drawn from the lights too",
        measured: "largest distance of a lit pixel from the line's chromaticity",
        bound: Bound::AtMost(2e-6),
        pace: Pace::Fast,
        measure: || {
            let prism = json!([{ "shape": { "prism": { "side": 1, "length": 1 } }, "material": "flint",
                "transform": [{ "rotate": { "axis": [0, 1, 0], "degrees": 20 } }] }]);
            chromaticity_error(&one_line(prism, json!({ "pinhole": { "fov": 20 } })))
        },
    },
    Case {
        name: "The same light through a camera lens of real glass",
        naive: "as above",
        here: "as above",
        measured: "largest distance of a lit pixel from the line's chromaticity",
        bound: Bound::AtMost(2e-6),
        pace: Pace::Fast,
        measure: || {
            let lens =
                json!({ "system": { "prescription": "double-gauss", "focus_distance": 4, "sensor_height_mm": 24 } });
            chromaticity_error(&one_line(json!([]), lens))
        },
    },
];

fn black_bodies() -> f64 {
    let error = |row: &Value| {
        let truth: f64 = row[2].as_str().unwrap().parse().unwrap();
        (planck(row[0].as_f64().unwrap(), row[1].as_f64().unwrap()) / truth - 1.0).abs()
    };
    golden("hard_cases.json")["planck"].as_array().unwrap().iter().map(error).fold(0.0, f64::max)
}

/// Samples wavelengths, densely at the ends of the band and within the line, where the density is
/// proportional to the spectrum: Φ/p is then the power.
fn drawn(spectrum: &Spectrum) -> f64 {
    let distribution = WavelengthDistribution::new(spectrum).unwrap();
    let power = spectrum.integral();
    let at = |u: f64| {
        let (nm, density) = distribution.sample(u);
        (spectrum.at(nm) / density / power - 1.0).abs()
    };
    let even = (0..10_000).map(|i| (f64::from(i) + 0.5) / 10_000.0);
    let ends = (1..60).flat_map(|i| [2.0_f64.powi(-i), 1.0 - 2.0_f64.powi(-i.min(53))]);
    even.chain(ends).map(at).fold(0.0, f64::max)
}

fn band_ends() -> f64 {
    let line = |nm: f64| Spectrum::lines(&[SpectralLine { nm, power: 2.0, fwhm_nm: Some(0.5) }]).unwrap();
    let table = Spectrum::table(&[360.0, 595.0, 830.0], &[3.0, 1.0, 5.0], Outside::Zero).unwrap();
    let errors = [
        line(360.0).integral() - 1.0,
        line(830.0).integral() - 1.0,
        line(360.0).at(360.0) / 4.0 - 1.0,
        table.integral() / (235.0 * 2.0 + 235.0 * 3.0) - 1.0,
        table.at(360.0) / 3.0 - 1.0,
        table.at(830.0) / 5.0 - 1.0,
        table.at(359.999_999) + table.at(830.000_001),
    ];
    errors.into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// Two surfaces that illuminate each other, under one light.
fn lit(lamp: Value, reflectance: Value) -> Value {
    json!({
        "camera": { "from": [0, 2, 5], "at": [0, 0.5, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 8, "height": 6 }, "spectra": { "lamp": lamp, "paint": reflectance },
        "materials": { "paint": diffuse("paint"), "coat": { "glossy": { "reflectance": "paint", "ior": 1.5, "roughness": 0.3 } }, "glass": glass("N-BK7") },
        "objects": [
            { "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "paint" },
            { "shape": { "sphere": { "center": [0, 0.5, 0], "radius": 0.4 } }, "material": "paint" }
        ],
        "lights": [{ "point": { "at": [1, 4, 2], "spectrum": "lamp", "power": 10 } }],
        "render": { "photons": 500 }
    })
}

fn is_refused(scene: &Value) -> bool {
    let planned = format::parse(scene.to_string(), "dark.json".as_ref(), &[])
        .and_then(|(scene, source)| resolve::resolve(&scene, &source))
        .and_then(Job::new);
    planned.is_err_and(|error| error.exit_status() == 2)
}

/// A wall that emits 1 W/m²/sr in a line at 589.3 nm, behind other objects.
fn one_line(things: Value, lens: Value) -> Value {
    let mut scene = json!({
        "camera": { "from": [0, 0, 4], "at": [0, 0, 0], "lens": lens },
        "film": { "width": 12, "height": 9 },
        "materials": { "black": "absorber", "flint": glass("N-SF10") },
        "objects": [{ "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "black",
            "emission": { "spectrum": { "lines": [{ "nm": 589.3, "power": 1 }] }, "radiance": 1 },
            "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -3] }] }],
        "render": { "photons": 100 }
    });
    let list = scene["objects"].as_array_mut().unwrap();
    list.extend(things.as_array().unwrap().iter().cloned());
    scene
}

fn chromaticity_error(scene: &Value) -> f64 {
    let xy = |[x, y, z]: [f64; 3]| [x / (x + y + z), y / (x + y + z)];
    let truth = xy(Observer::cie1931().xyz_bar(589.3));
    let picture = render(scene, Integrator::Photon, 8).picture;
    let lit: Vec<[f64; 3]> = picture.xyz.iter().copied().filter(|xyz| xyz[1] > 0.0).collect();
    let off = |xyz: &[f64; 3]| xy(*xyz).iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if lit.len() < 20 { f64::INFINITY } else { lit.iter().map(off).fold(0.0, f64::max) }
}
