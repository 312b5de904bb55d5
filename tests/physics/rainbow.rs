//! The rainbows of the example scene's rain at single wavelengths: their angles are the peaks of
//! the drops' phase function, their order is right, the band between them is dark, and their
//! brightness equals the integral along the ray.

use crate::common::{example, render};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// Wavelengths of the sun's lines, each in the middle of one band of the film.
const LINES_NM: [f64; 3] = [455.0, 555.0, 655.0];
const BANDS: usize = 47;

/// A strip of sky above the antisolar point: its limits as angles from that point, in degrees.
const NEAR_DEG: f64 = 35.0;
const FAR_DEG: f64 = 57.0;
const ROWS: usize = 264;
const COLUMNS: usize = 4;

/// The angles in degrees from the antisolar point between which the bows' peaks are searched, and
/// the positions of Alexander's band and its neighbours.
const PRIMARY: [f64; 2] = [39.0, 43.5];
const SECONDARY: [f64; 2] = [49.5, 55.0];
const DARK: [f64; 2] = [44.5, 49.0];
const WITHIN: [f64; 2] = [37.0, 40.0];
const BEYOND: [f64; 2] = [54.0, 56.5];

/// The sun's irradiance in W/m² in each line.
const IRRADIANCE: f64 = 1.0;

/// The rain and the sun of the example scene.
struct Rain {
    /// The scene reduced to the rain, single scattering, and a sun of three lines, seen by a
    /// strip-shaped camera.
    scene: Value,
    /// The sun's elevation and diameter in degrees.
    sun_deg: f64,
    sun_width_deg: f64,
    /// The box of rain (y and z in m) and its extinction in 1/m.
    low: [f64; 2],
    high: [f64; 2],
    extinction: f64,
}

fn rain() -> Rain {
    let mut scene = example("rainbow");
    let number = |value: &Value| value.as_f64().expect("a number");
    let sun = &mut scene["lights"][0]["directional"];
    let toward: [f64; 3] = std::array::from_fn(|axis| number(&sun["toward"][axis]));
    assert_eq!(toward[0], 0.0, "the camera looks up in the sun's plane");
    let (sun_deg, sun_width_deg) = ((-toward[1]).atan2(-toward[2]).to_degrees(), number(&sun["angular_diameter"]));
    let lines: Vec<Value> = LINES_NM.iter().map(|nm| json!({ "nm": nm, "power": 1 })).collect();
    *sun = json!({ "toward": toward, "angular_diameter": sun_width_deg, "spectrum": { "lines": lines },
                   "irradiance": IRRADIANCE * LINES_NM.len() as f64 });
    let (sin, cos) = (0.5 * (NEAR_DEG + FAR_DEG) - sun_deg).to_radians().sin_cos();
    scene["camera"] =
        json!({ "from": [0, 2, 0], "at": [0, 2.0 + sin, -cos], "lens": { "pinhole": { "fov": FAR_DEG - NEAR_DEG } } });
    scene["film"] = json!({ "width": COLUMNS, "height": ROWS, "spectral_bands": BANDS });
    scene["objects"].as_array_mut().expect("objects").retain(|object| object["name"] == "rain");
    scene["render"] = json!({ "photons": 100, "forbid": ["photon-beams", "indirect"] });
    let grid = &scene["media"]["rain"]["grid"];
    let [low, high] = [0, 1].map(|end| [1, 2].map(|axis| number(&grid["bounds"][end][axis])));
    let extinction = number(&grid["scattering"]) + number(&grid["absorption"]);
    Rain { sun_deg, sun_width_deg, low, high, extinction, scene }
}

impl Rain {
    /// Returns ∫ σ e^(−σ(t + s)) dt along a camera ray, where s is the length of the light's path
    /// through the rain. Times the phase function, it is the share of sunlight scattered to the
    /// camera per steradian.
    fn scattered(&self, angle_deg: f64) -> f64 {
        const STEPS: usize = 1000;
        let (sin, cos) = (angle_deg - self.sun_deg).to_radians().sin_cos();
        let (from, to) = (-self.high[1] / cos, (-self.low[1] / cos).min((self.high[0] - 2.0) / sin));
        let step = (to - from) / STEPS as f64;
        let (sun_up, sun_back) = self.sun_deg.to_radians().sin_cos();
        let place = |i: usize| {
            let t = from + (i as f64 + 0.5) * step;
            let (y, z) = (2.0 + t * sin, -t * cos);
            let s = ((self.high[0] - y) / sun_up).min((self.high[1] - z) / sun_back);
            self.extinction * (-self.extinction * (t - from + s)).exp() * step
        };
        (0..STEPS).map(place).sum()
    }
}

/// Returns the angle from the antisolar point at the middle of a row.
fn angle_of(row: usize) -> f64 {
    let up = 1.0 - (2 * row + 1) as f64 / ROWS as f64;
    let half = (0.5 * (FAR_DEG - NEAR_DEG)).to_radians();
    0.5 * (NEAR_DEG + FAR_DEG) + (up * half.tan()).atan().to_degrees()
}

/// Values as a function of the angle from the antisolar point.
struct Profile(Vec<(f64, f64)>);

impl Profile {
    fn mean(&self, [from, to]: [f64; 2]) -> f64 {
        let inside: Vec<f64> = self.0.iter().filter(|(angle, _)| (from..to).contains(angle)).map(|row| row.1).collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    }

    /// Returns the vertex of the best-fitting parabola around the largest value within these
    /// angles.
    fn peak(&self, [from, to]: [f64; 2]) -> f64 {
        const AROUND: f64 = 0.45;
        let inside = self.0.iter().filter(|(angle, _)| (from..to).contains(angle));
        let top = inside.max_by(|a, b| a.1.total_cmp(&b.1)).expect("some rows").0;
        assert!(top - AROUND > from && top + AROUND < to, "no peak within {from}–{to}°: {top}°");
        // About the middle of evenly spaced angles, the slope and the curvature of the fit are
        // independent.
        let around: Vec<_> = self.0.iter().filter(|row| (row.0 - top).abs() < AROUND).collect();
        let moment = |f: &dyn Fn(f64, f64) -> f64| around.iter().map(|row| f(row.0 - top, row.1)).sum::<f64>();
        let (count, square, fourth) = (moment(&|_, _| 1.0), moment(&|x, _| x * x), moment(&|x, _| x.powi(4)));
        let slope = moment(&|x, y| x * y) / square;
        let curvature =
            (count * moment(&|x, y| x * x * y) - square * moment(&|_, y| y)) / (count * fourth - square * square);
        top - 0.5 * slope / curvature
    }
}

/// Returns the phase function's table at a wavelength and at the strip's angles, convolved with the
/// sun's disk. It is interpolated linearly in angle and wavelength.
fn table(nm: f64, sun_width_deg: f64) -> Profile {
    let text = std::fs::read_to_string("data/media/rainbow.csv").expect("the table");
    let mut lines = text.lines();
    let titles: Vec<f64> =
        lines.next().expect("titles").split(',').skip(1).map(|title| title[2..5].parse().expect("nm")).collect();
    let after = titles.partition_point(|&known| known <= nm);
    let share = (nm - titles[after - 1]) / (titles[after] - titles[after - 1]);
    let rows: Vec<(f64, f64)> = lines
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            (180.0 - cells[0], (1.0 - share) * cells[after] + share * cells[after + 1])
        })
        .collect();
    let at = |angle: f64| {
        let next = rows.partition_point(|row| row.0 > angle).clamp(1, rows.len() - 1);
        let ((a, low), (b, high)) = (rows[next - 1], rows[next]);
        low + (high - low) * (angle - a) / (b - a)
    };
    // The disk is cut into strips parallel to the bow.
    const STRIPS: usize = 32;
    let strips = (0..STRIPS).map(|i| (2 * i + 1) as f64 / STRIPS as f64 - 1.0);
    let strips: Vec<(f64, f64)> = strips.map(|x| (0.5 * sun_width_deg * x, (1.0 - x * x).sqrt())).collect();
    let width: f64 = strips.iter().map(|strip| strip.1).sum();
    let blurred = |angle: f64| strips.iter().map(|(offset, weight)| weight * at(angle + offset)).sum::<f64>() / width;
    Profile((0..ROWS).map(angle_of).map(|angle| (angle, blurred(angle))).collect())
}

#[test]
fn rainbows_have_their_angles_and_the_band_between_is_dark() {
    let rain = rain();
    let picture = render(&rain.scene, Integrator::Photon, 96).picture;
    let bands = picture.bands.as_ref().expect("the film has bands");
    let width_nm = bands.centres_nm[1] - bands.centres_nm[0];
    let rendered = |nm: f64| {
        let band = bands.centres_nm.iter().position(|centre| (centre - nm).abs() < 1e-9).expect("a band of the line");
        let row = |row: usize| {
            let pixels = row * COLUMNS..(row + 1) * COLUMNS;
            pixels.map(|pixel| f64::from(bands.values[pixel * BANDS + band])).sum::<f64>() * width_nm / COLUMNS as f64
        };
        Profile((0..ROWS).map(|j| (angle_of(j), row(j))).collect())
    };
    let mut bows = Vec::new();
    for nm in LINES_NM {
        let (found, drops) = (rendered(nm), table(nm, rain.sun_width_deg));
        let [peaks, truth] = [&found, &drops].map(|profile| [PRIMARY, SECONDARY].map(|span| profile.peak(span)));
        let [inside, beyond] = [WITHIN, BEYOND].map(|side| found.mean(side) / found.mean(DARK));
        let off =
            found.0.iter().zip(&drops.0).map(|(row, drop)| row.1 / (IRRADIANCE * rain.scattered(row.0) * drop.1) - 1.0);
        let off: Vec<f64> = off.collect();
        let (mean, rms) =
            (off.iter().sum::<f64>() / ROWS as f64, (off.iter().map(|x| x * x).sum::<f64>() / ROWS as f64).sqrt());
        println!(
            "rainbow, {nm} nm: {:.3}° and {:.3}°, the drops' {:.3}° and {:.3}°; inside / between {inside:.2}, outside / between \
             {beyond:.2}; rows off by {mean:+.4}, rms {rms:.4}",
            peaks[0], peaks[1], truth[0], truth[1]
        );
        for (peak, truth) in peaks.into_iter().zip(truth) {
            assert!((peak - truth).abs() < 0.1, "{nm} nm: {peak}°, the drops' {truth}°");
        }
        assert!(inside > 10.0 && beyond > 2.0, "{nm} nm: the band between the bows is not dark");
        assert!(mean.abs() < 0.01 && rms < 0.04, "{nm} nm: the rows are off by {mean}, rms {rms}");
        bows.push(peaks);
    }
    assert!(
        bows.windows(2).all(|next| next[1][0] > next[0][0] + 0.3),
        "red is not outside in the primary bow: {bows:?}"
    );
    assert!(
        bows.windows(2).all(|next| next[1][1] < next[0][1] - 0.3),
        "red is not inside in the secondary bow: {bows:?}"
    );
}
