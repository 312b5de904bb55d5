//! The sky of the example scene: clear air and a layer of ozone around a planet at true scale,
//! against integrals along rays that this test computes.

use crate::common::{example, render};
use abbe_session::render::{Integrator, Rendered};
use abbe_spectra::colour;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The radius of the planet, the scale height of its air, and the radii where the ozone begins and
/// the air ends, in m.
const GROUND: f64 = 6_371_000.0;
const SCALE_HEIGHT: f64 = 8000.0;
const OZONE: f64 = 6_389_000.0;
const END: f64 = 6_471_000.0;

/// The camera's height above the ground in m.
const CAMERA: f64 = 2.0;

/// The sun's angular diameter in degrees.
const SUN_DEG: f64 = 0.53;

/// Bands of the film, 47 nm wide.
const BANDS: usize = 10;

/// The example scene with a sun of this spectrum and 1 W/m² at `sun_deg` above the horizon. A
/// narrow camera looks up by `look_deg` towards it.
fn sky(spectrum: Value, [sun_deg, look_deg]: [f64; 2], side: usize) -> Value {
    let mut scene = example("blue_sky_red_sunset");
    for medium in ["air", "air with ozone"] {
        let exponential = &scene["media"][medium]["grid"]["density"]["exponential"];
        assert_eq!(exponential["scale_height"], SCALE_HEIGHT as u64);
        assert_eq!(exponential["planet"], json!({ "center": [0, 0, 0], "radius": GROUND as u64 }));
    }
    for (object, radius) in [GROUND, OZONE, END].into_iter().enumerate() {
        assert_eq!(scene["objects"][object]["shape"]["sphere"]["radius"], radius as u64);
    }
    let [sun, look] = [sun_deg, look_deg].map(|degrees: f64| degrees.to_radians().sin_cos());
    scene["lights"][0]["directional"] = json!({ "toward": [0, -sun.0, sun.1], "angular_diameter": SUN_DEG,
                                                "spectrum": spectrum, "irradiance": 1 });
    let at = [0.0, GROUND + CAMERA + 1000.0 * look.0, -1000.0 * look.1];
    scene["camera"] =
        json!({ "from": [0, GROUND + CAMERA, 0], "at": at, "up": [0, 1, 0.5], "lens": { "pinhole": { "fov": 0.05 } } });
    scene["film"] = json!({ "width": side, "height": side, "spectral_bands": BANDS });
    scene
}

/// Interpolates linearly between rows.
fn straight(rows: Vec<(f64, f64)>) -> impl Fn(f64) -> f64 {
    move |x| {
        let next = rows.partition_point(|row| row.0 <= x).clamp(1, rows.len() - 1);
        let ((a, low), (b, high)) = (rows[next - 1], rows[next]);
        low + (high - low) * (x.clamp(rows[0].0, rows[rows.len() - 1].0) - a) / (b - a)
    }
}

/// Reads a table of the data folder: one column as a function of the first.
fn data(path: &str, column: usize) -> impl Fn(f64) -> f64 {
    let text = std::fs::read_to_string(path).expect("a table");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().expect("a number");
        (number(0), number(column))
    };
    straight(text.lines().skip(1).map(row).collect())
}

/// The scattering of the air and the absorption of the ozone at a wavelength, in 1/m at ground
/// density.
struct Air<S, A> {
    scattering: S,
    absorption: A,
}

fn air() -> Air<impl Fn(f64) -> f64, impl Fn(f64) -> f64> {
    let scene = example("blue_sky_red_sunset");
    let table = &scene["media"]["air with ozone"]["grid"]["absorption"]["table"];
    let [nm, values] = ["nm", "values"].map(|key| {
        let list = table[key].as_array().expect("a list");
        list.iter().map(|value| value.as_f64().expect("a number")).collect::<Vec<f64>>()
    });
    Air {
        scattering: data("data/media/rayleigh_air.csv", 2),
        absorption: straight(nm.into_iter().zip(values).collect()),
    }
}

impl<S: Fn(f64) -> f64, A: Fn(f64) -> f64> Air<S, A> {
    /// Returns the transmittance of columns of air and of air with ozone.
    fn passes(&self, nm: f64, [air, ozone]: [f64; 2]) -> f64 {
        (-(self.scattering)(nm) * air - (self.absorption)(nm) * ozone).exp()
    }
}

/// Returns ∫ f along a ray that starts at `radius` with this sine of its elevation, up to the end
/// of the air. Midpoint rule with denser points near the start.
fn along<const N: usize>(radius: f64, sine: f64, steps: u32, f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let end = (END * END - radius * radius * (1.0 - sine * sine)).sqrt() - radius * sine;
    let mut sum = [0.0; N];
    for i in 0..steps {
        let s = (f64::from(i) + 0.5) / f64::from(steps);
        let width = 2.0 * end * s / f64::from(steps);
        sum.iter_mut().zip(f(end * s * s)).for_each(|(sum, value)| *sum += value * width);
    }
    sum
}

/// Returns the distance from the planet's centre after t metres along a ray.
fn radius_after(radius: f64, sine: f64, t: f64) -> f64 {
    (radius * radius + 2.0 * radius * t * sine + t * t).sqrt()
}

/// Returns the density of the air at a radius, relative to the ground.
fn density(radius: f64) -> f64 {
    (-(radius - GROUND) / SCALE_HEIGHT).exp()
}

/// Returns the column densities in m that a ray crosses on its way out: of all air, and of air with
/// ozone.
fn column(radius: f64, sine: f64, steps: u32) -> [f64; 2] {
    along(radius, sine, steps, |t| {
        let here = radius_after(radius, sine, t);
        [density(here), if here > OZONE { density(here) } else { 0.0 }]
    })
}

/// Returns the light per steradian that the air above scatters once down to the camera, at two
/// wavelengths, for a sun of irradiance 1 centred at this elevation.
fn zenith(sun_deg: f64, nm: [f64; 2]) -> [f64; 2] {
    // The disk is cut into horizontal strips.
    const STRIPS: i32 = 9;
    let mut sum = [0.0; 3];
    for i in 0..STRIPS {
        let x = f64::from(2 * i + 1 - STRIPS) / f64::from(STRIPS);
        let weight = (1.0 - x * x).sqrt();
        let [a, b] = zenith_by_point(sun_deg + 0.5 * SUN_DEG * x, nm);
        sum.iter_mut().zip([a, b, 1.0]).for_each(|(sum, value)| *sum += weight * value);
    }
    [sum[0] / sum[2], sum[1] / sum[2]]
}

fn zenith_by_point(sun_deg: f64, nm: [f64; 2]) -> [f64; 2] {
    let air = air();
    let radius = GROUND + CAMERA;
    let sine = sun_deg.to_radians().sin();
    let phase = 3.0 / (16.0 * PI) * (1.0 + sine * sine);
    along(radius, 1.0, 300, |t| {
        let here = radius + t;
        let from_sun = column(here, sine, 400);
        let above = |from: f64| SCALE_HEIGHT * (density(from) - density(here)).max(0.0);
        let way = [from_sun[0] + above(radius), from_sun[1] + above(OZONE)];
        nm.map(|nm| (air.scattering)(nm) * phase * density(here) * air.passes(nm, way))
    })
}

fn band(rendered: &Rendered, nm: f64) -> f64 {
    let bands = rendered.picture.bands.as_ref().expect("the film has bands");
    let width = 470.0 / BANDS as f64;
    let band = ((nm - 360.0) / width) as usize;
    let pixels = bands.values.len() / BANDS;
    (0..pixels).map(|pixel| f64::from(bands.values[pixel * BANDS + band])).sum::<f64>() * width / pixels as f64
}

fn chromaticity(rendered: &Rendered) -> [f64; 2] {
    colour::xy(std::array::from_fn(|c| rendered.picture.xyz.iter().map(|xyz| xyz[c]).sum()))
}

#[test]
fn the_zenith_matches_the_single_scattering_integral() {
    let sun = json!({ "lines": [{ "nm": 450, "power": 1 }, { "nm": 650, "power": 1 }] });
    for sun_deg in [60.0, 5.0, 1.0] {
        let rendered = render(&sky(sun.clone(), [sun_deg, 90.0], 16), Integrator::Photon, 8);
        let nm = [450.0, 650.0];
        let truth = zenith(sun_deg, nm);
        let [blue, red] = [0, 1].map(|i| (band(&rendered, nm[i]), 0.5 * truth[i]));
        let ratio = (blue.0 / red.0) / (blue.1 / red.1);
        println!(
            "zenith, the sun at {sun_deg}°: 450 nm {:.4} and 650 nm {:.4} of the integrals, 450 : 650 nm {:.3}, {ratio:.4} of theirs",
            blue.0 / blue.1,
            red.0 / red.1,
            blue.0 / red.0
        );
        for (found, truth) in [blue, red] {
            assert!((found / truth - 1.0).abs() < 0.02, "the sun at {sun_deg}°: {found} for {truth}");
        }
        assert!((ratio - 1.0).abs() < 0.03, "the sun at {sun_deg}°: {ratio}");
    }
}

#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn sky_and_low_sun_have_the_colours_of_the_air_mass() {
    let sun = json!({ "blackbody": { "temperature": 5778 } });
    let air = air();
    let matching: [_; 3] = std::array::from_fn(|c| data("data/cie/cie1931_2deg_1nm.csv", c + 1));
    let planck = |nm: f64| nm.powi(-5) / (1.438_776_877e7 / (nm * 5778.0)).exp_m1();
    let through = |column: [f64; 2]| {
        let nm = (360..=830).map(f64::from);
        let light: Vec<(f64, f64)> = nm.map(|nm| (nm, planck(nm) * air.passes(nm, column))).collect();
        colour::xy(std::array::from_fn(|c| light.iter().map(|(nm, light)| matching[c](*nm) * light).sum()))
    };
    let above = through([0.0; 2]);
    for sun_deg in [0.3, 1.0, 5.0, 30.0] {
        let found = chromaticity(&render(&sky(sun.clone(), [sun_deg; 2], 4), Integrator::Photon, 32));
        let truth = through(column(GROUND + CAMERA, sun_deg.to_radians().sin(), 20_000));
        println!("the sun at {sun_deg}°: {found:.4?}, integrated {truth:.4?}; above the air {above:.4?}");
        assert!((found[0] - truth[0]).hypot(found[1] - truth[1]) < 0.01, "{found:?} for {truth:?}");
    }
    let zenith = chromaticity(&render(&sky(sun, [30.0, 90.0], 4), Integrator::Photon, 64));
    println!("the zenith, the sun at 30°: {zenith:.4?}");
    assert!(zenith[0] < above[0] - 0.05 && zenith[1] < above[1] - 0.05, "{zenith:?} is not bluer than {above:?}");
}
