//! Tests of crystals that prefer an orientation: the places of their features, and the pdf.

use super::*;
use abbe_spectra::math::random::{Purpose, Seed, Stream};

/// Tables that are computed in a fraction of a second.
const QUICK: [Effort; 2] = [
    Effort { nm: &NM, rows: 180, columns: 180, rays: 1_000, smoothing: 200.0 },
    Effort { nm: &FINE_NM, rows: 720, columns: 1440, rays: 40_000, smoothing: 200.0 },
];

/// The heights of the sun in degrees at which sundogs are compared with Bravais' law.
const HEIGHTS_DEG: [f64; 5] = [0.0, 10.0, 20.0, 30.0, 45.0];

fn plates(tilt_deg: f64) -> IcePopulation {
    let shape = PrismShape { length_to_width: 0.3, tilt: tilt_deg.to_radians() };
    IcePopulation { orientation: IceOrientation::Plates(shape), weight: 1.0 }
}

fn columns_of(tilt_deg: f64) -> IcePopulation {
    let shape = PrismShape { length_to_width: 2.0, tilt: tilt_deg.to_radians() };
    IcePopulation { orientation: IceOrientation::Columns(shape), weight: 1.0 }
}

fn random() -> IcePopulation {
    IcePopulation { orientation: IceOrientation::Random, weight: 1.0 }
}

fn sine(degrees: f64) -> f64 {
    degrees.to_radians().sin()
}

fn ice_index(nm: f64) -> f64 {
    RefractiveIndex::catalogue("ice -7C").unwrap().n(nm)
}

/// Returns the azimuth of a sundog from the sun in degrees, by the effective index of skew rays
/// (Bravais 1847; Können 1983).
fn bravais_deg(n: f64, height_deg: f64) -> f64 {
    let (sin, cos) = height_deg.to_radians().sin_cos();
    let effective = (n * n - sin * sin).sqrt() / cos;
    2.0 * (0.5 * effective).asin().to_degrees() - 60.0
}

/// Returns the unit vector of light that travels at an elevation and an azimuth in degrees.
fn travelling(elevation_deg: f64, azimuth_deg: f64) -> DVec3 {
    let (up, level) = elevation_deg.to_radians().sin_cos();
    let (z, x) = azimuth_deg.to_radians().sin_cos();
    DVec3::new(level * x, up, level * z)
}

#[test]
fn rays_through_level_plates_have_bravais_azimuths() {
    for height in HEIGHTS_DEG {
        // Through thin plates and a high sun, no light passes two sides without a reflection.
        let shape = PrismShape { length_to_width: 3.0, tilt: 0.0 };
        let orientation = IceOrientation::Plates(shape);
        let crystal = orientation.crystal();
        let mut least = f64::INFINITY;
        rays(orientation, sine(height), 40_000, |rotation, travel, u, _| {
            let (point, face, _) = crystal.point(travel, u);
            crystal.trace(1.31, travel, (point, face), |direction, _, faces| {
                let Some([entered, left]) = faces else { return };
                if crystal.normals[entered].dot(crystal.normals[left]) < -0.4 && entered < 6 && left < 6 {
                    let out = rotation * direction;
                    let azimuth = out.y.atan2(out.x).abs().to_degrees();
                    // Opposite faces do not deviate light.
                    least = if azimuth > 1.0 { least.min(azimuth) } else { least };
                }
            });
        });
        let known = bravais_deg(1.31, height);
        assert!((0.0..0.05).contains(&(least - known)), "{height}°: {least}° for {known}°");
    }
    assert!((bravais_deg(1.31, 0.0) - 21.84).abs() < 0.005, "the halo's radius");
}

/// The inner edge of a sundog, at half of its maximum, is at Bravais' azimuth: red inside.
#[test]
fn tabulated_sundogs_begin_at_bravais_azimuths() {
    let heights = HEIGHTS_DEG.map(sine);
    let ice = IceTables::new(&[plates(0.02)], &heights, QUICK);
    for height in HEIGHTS_DEG {
        let edges = [NM[0], NM[2], NM[4]].map(|nm| {
            let known = bravais_deg(ice_index(nm), height);
            let arriving = travelling(-height, 0.0);
            let at = |azimuth: f64| ice.eval(Deflection::between(arriving, travelling(-height, azimuth)), nm);
            let azimuths = || (-100..200).map(|i| known + 0.01 * f64::from(i));
            let brightest = azimuths().map(at).fold(0.0, f64::max);
            let edge = azimuths().find(|azimuth| at(*azimuth) > 0.5 * brightest).unwrap();
            // Half a step in azimuth, and half of the range of wavelengths of a table.
            let of_next = bravais_deg(ice_index(nm + 20.0), height);
            let resolution = 0.0625 + 0.5 * (known - of_next);
            println!("{height}°, {nm} nm: {:+.3}° of {resolution:.3}°", edge - known);
            assert!((edge - known).abs() < resolution, "{height}°, {nm} nm: {edge}° for {known}°");
            edge
        });
        assert!(edges[2] < edges[1] && edges[1] < edges[0], "{height}°: {edges:?}");
    }
}

/// The light of the circumzenithal arc enters at the upper base and leaves at a side face. It falls
/// more steeply than the light of the sun, and its elevation does not depend on the azimuth (Tape
/// 1994).
#[test]
fn circumzenithal_arc_has_its_elevation() {
    let height = 20.0_f64;
    let elevation = |n: f64| (n * n - height.to_radians().cos().powi(2)).sqrt().asin().to_degrees();
    let population = plates(0.0);
    let crystal = population.orientation.crystal();
    let mut found = 0;
    rays(population.orientation, sine(height), 5_000, |rotation, travel, u, _| {
        let (point, face, _) = crystal.point(travel, u);
        crystal.trace(1.31, travel, (point, face), |direction, _, faces| {
            let Some([6 | 7, 0..=5]) = faces else { return };
            let degrees = (rotation * direction).z.asin().to_degrees();
            assert!((degrees - elevation(1.31)).abs() < 1e-9, "{degrees}");
            found += 1;
        });
    });
    assert!(found > 100, "{found}");
    let ice = IceTables::new(&[plates(0.3)], &[sine(height)], QUICK);
    let nm = NM[2];
    let at = |elevation: f64| ice.eval(Deflection::between(travelling(-height, 0.0), travelling(elevation, 10.0)), nm);
    let elevations = || (300..800).map(|i| 0.1 * f64::from(i));
    let brightest = elevations().max_by(|a, b| at(-a).total_cmp(&at(-b))).unwrap();
    let known = elevation(ice_index(nm));
    assert!((brightest - known).abs() < 0.5, "{brightest}° for {known}°");
    assert!(at(-brightest) > 5.0 * at(brightest), "{} and {}", at(-brightest), at(brightest));
}

/// Level bases reflect the sun into the subsun, below the horizon, and the lamp below into its
/// image above.
#[test]
fn level_plates_are_mirrors() {
    let ice = IceTables::new(&[plates(1.0)], &[sine(25.0)], QUICK);
    for height in [-25.0, -31.0, 31.0] {
        let at =
            |elevation: f64| ice.eval(Deflection::between(travelling(height, 0.0), travelling(elevation, 0.0)), 550.0);
        let image = at(-height);
        for other in [-height + 12.0, -height - 12.0] {
            assert!(image > 20.0 * at(other), "{height}°: {image}, {}", at(other));
        }
    }
}

#[test]
fn crystals_in_all_orientations_are_the_built_in_table() {
    assert_eq!(ice_crystals(&[random()], &[0.3]), PhaseFunction::Table(ice()));
}

fn cases() -> Vec<IceTables> {
    let with_random = [plates(1.5), columns_of(0.5), random()];
    let parry = PrismShape { length_to_width: 1.5, tilt: 0.01 };
    let parry = IcePopulation { orientation: IceOrientation::Parry(parry), weight: 2.0 };
    let quick = [QUICK[0], Effort { nm: &NM, rows: 360, columns: 360, rays: 5_000, smoothing: 200.0 }];
    vec![IceTables::new(&with_random, &[sine(17.3)], quick), IceTables::new(&[parry], &[], quick)]
}

/// Directions of light: of a table, between two, level, steep and vertical.
fn directions() -> [DVec3; 6] {
    let mut directions =
        [-17.3, -10.4, 46.1, 0.0, 88.3, -90.0].map(|elevation| travelling(elevation, 40.0 + elevation));
    directions[5] = DVec3::NEG_Y;
    directions
}

/// Paths are sampled with a pdf that is nowhere much smaller than that of the reversed light, and
/// the ratios have the mean 1.
#[test]
fn the_reversed_pdf_is_nowhere_much_smaller() {
    let mut stream = Stream::new(Seed::new(5), Purpose::SurveyPhoton, 1, 0);
    for ice in cases() {
        for arriving in directions() {
            for nm in [390.0, 548.0, 700.0] {
                let n = 20_000;
                let (mut sum, mut squares) = (0.0, 0.0);
                for _ in 0..n {
                    let leaving = ice.sample_reversed(arriving, nm, stream.pair());
                    assert!((leaving.length() - 1.0).abs() < 1e-12);
                    let deflection = Deflection::between(arriving, leaving);
                    let ratio = ice.eval(deflection, nm) / ice.reversed_pdf(deflection, nm);
                    assert!((0.0..1.3).contains(&ratio), "{ratio}");
                    sum += ratio;
                    squares += ratio * ratio;
                }
                let (count, mean) = (f64::from(n), sum / f64::from(n));
                let error = ((squares / count - mean * mean) / count).sqrt();
                assert!((mean - 1.0).abs() < 4.5 * error + 1e-4, "{arriving}, {nm} nm: {mean} ± {error}");
            }
        }
    }
}

/// Light of the same path in the opposite direction is scattered alike, on average over a few
/// degrees: uniform light stays uniform.
#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn the_pdf_is_also_one_of_the_arriving_light() {
    let mut stream = Stream::new(Seed::new(7), Purpose::SurveyPhoton, 1, 0);
    for ice in [IceTables::new(&[plates(1.5)], &[], EFFORTS), IceTables::new(&[columns_of(1.0)], &[], EFFORTS)] {
        for leaving in [-12.0, 4.0, 33.5, 46.1, 70.0].map(|elevation| travelling(elevation, 10.0)) {
            let n = 40_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let onwards = ice.sample_reversed(-leaving, 550.0, stream.pair());
                let deflection = Deflection::between(-leaving, onwards);
                let ratio = ice.eval(deflection.reversed(), 550.0) / ice.reversed_pdf(deflection, 550.0);
                sum += ratio;
                squares += ratio * ratio;
            }
            let (count, mean) = (f64::from(n), sum / f64::from(n));
            let error = ((squares / count - mean * mean) / count).sqrt();
            println!("{:.1}°: {mean:.4} ± {error:.4}", leaving.y.asin().to_degrees());
            assert!((mean - 1.0).abs() < 0.02 + 4.0 * error, "{leaving}: {mean} ± {error}");
        }
    }
}

/// Integrates the pdf over the directions whose angle to the old one has at least this cosine.
fn in_cone(ice: &IceTables, arriving: DVec3, nm: f64, cosine: f64) -> f64 {
    const RINGS: usize = 2000;
    const TURNS: usize = 48;
    let frame = Frame::new(arriving);
    let mut sum = 0.0;
    for ring in 0..RINGS {
        // Narrow rings in the middle of the forward peak.
        let versine = |ring: usize| (1.0 - cosine) * (ring as f64 / RINGS as f64).powi(2);
        let (from, to) = (versine(ring), versine(ring + 1));
        for turn in 0..TURNS {
            let leaving = warp::spherical_direction(0.5 * (from + to), (turn as f64 + 0.5) / TURNS as f64);
            let deflection = Deflection::between(arriving, frame.to_world(leaving));
            sum += ice.eval(deflection, nm) * TAU * (to - from) / TURNS as f64;
        }
    }
    sum
}

/// Compares counts of samples with integrals of the pdf, in cells of 15° by 30° and in the cone of
/// 3° around the old direction.
#[test]
fn samples_follow_the_pdf() {
    const CELLS: usize = 12;
    const STEPS: usize = 60;
    let mut stream = Stream::new(Seed::new(6), Purpose::SurveyPhoton, 1, 0);
    for ice in cases() {
        for arriving in directions() {
            let nm = 560.0;
            let forward = f64::to_radians(3.0).cos();
            let mut expected = [0.0; CELLS * CELLS + 1];
            let cell_of = |direction: DVec3| {
                let turn = direction.z.atan2(direction.x) / TAU + 0.5;
                let cell = |t: f64| ((t * CELLS as f64) as usize).min(CELLS - 1);
                cell(0.5 + direction.y.asin() / PI) * CELLS + cell(turn)
            };
            let fine = CELLS * STEPS;
            for i in 0..fine * fine {
                let [u, v] = [i / fine, i % fine].map(|k| (k as f64 + 0.5) / fine as f64);
                let (y, radius) = (PI * (u - 0.5)).sin_cos();
                let (z, x) = (TAU * (v - 0.5)).sin_cos();
                let leaving = DVec3::new(radius * x, y, radius * z);
                let solid_angle = radius * PI * TAU / (fine * fine) as f64;
                let deflection = Deflection::between(arriving, leaving);
                if deflection.cos_theta < forward {
                    expected[cell_of(leaving)] += ice.eval(deflection, nm) * solid_angle;
                }
            }
            expected[CELLS * CELLS] = in_cone(&ice, arriving, nm, forward);
            let whole: f64 = expected.iter().sum();
            assert!((whole - 1.0).abs() < 5e-3, "{arriving}: the integral is {whole}");
            let mut counts = [0.0; CELLS * CELLS + 1];
            let n = 40_000;
            for _ in 0..n {
                let leaving = ice.sample(arriving, nm, stream.pair());
                let inside = leaving.dot(arriving) >= forward;
                counts[if inside { CELLS * CELLS } else { cell_of(leaving) }] += 1.0;
            }
            let (mut chi_square, mut cells) = (0.0, -1.0);
            for (count, expected) in counts.iter().zip(expected) {
                let expected = expected * f64::from(n);
                if expected > 5.0 {
                    chi_square += (count - expected).powi(2) / expected;
                    cells += 1.0;
                }
            }
            let deviations = (chi_square - cells) / f64::sqrt(2.0 * cells);
            assert!(deviations < 5.0, "{arriving}: χ² is {chi_square} for {cells}");
        }
    }
}
