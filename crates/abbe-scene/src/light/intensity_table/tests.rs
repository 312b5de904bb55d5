use super::*;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;

fn radians(degrees: &[f64]) -> Vec<f64> {
    degrees.iter().map(|degrees| degrees.to_radians()).collect()
}

fn table(kind: PhotometricType, polar: &[f64], azimuth: &[f64], values: &[f64]) -> IntensityTable {
    IntensityTable::new(kind, &radians(polar), &radians(azimuth), values).unwrap()
}

/// An uneven table of each coordinate system.
fn uneven() -> [IntensityTable; 3] {
    let value = |i: usize| [3.0, 0.0, 5.0, 1.0, 0.5, 2.0, 0.0, 4.0][i * i % 8];
    let values = |count: usize| (0..count).map(value).collect::<Vec<_>>();
    let polar = [20.0, 30.0, 60.0, 90.0, 140.0];
    [
        table(PhotometricType::C, &[0.0, 10.0, 45.0, 90.0, 180.0], &[0.0, 30.0, 170.0, 360.0], &values(20)),
        table(PhotometricType::B, &polar, &[-80.0, -10.0, 0.0, 45.0], &values(20)),
        table(PhotometricType::A, &polar, &[-80.0, -10.0, 0.0, 45.0], &values(20)),
    ]
}

#[test]
fn a_constant_intensity_has_the_flux_of_the_sphere() {
    for kind in [PhotometricType::A, PhotometricType::B, PhotometricType::C] {
        let sphere = table(kind, &[0.0, 180.0], &[0.0, 360.0], &[7.0; 4]);
        assert!((sphere.flux() / (4.0 * PI * 7.0) - 1.0).abs() < 1e-13);
        assert!((sphere.at(DVec3::new(0.6, 0.0, -0.8)) - 7.0).abs() < 1e-14);
    }
    let half = table(PhotometricType::C, &[0.0, 90.0], &[0.0, 360.0], &[7.0; 4]);
    assert!((half.flux() / (2.0 * PI * 7.0) - 1.0).abs() < 1e-13);
    assert_eq!(half.at(DVec3::new(0.6, 0.0, -0.8)), 0.0);
}

/// The integral of θ sin θ from 0 to π is π, so the intensity θ has the flux 2π².
#[test]
fn a_linear_intensity_has_its_closed_form_flux() {
    let cone = table(PhotometricType::C, &[0.0, 180.0], &[0.0, 360.0], &[0.0, PI, 0.0, PI]);
    assert!((cone.flux() / (2.0 * PI * PI) - 1.0).abs() < 1e-13, "{}", cone.flux());
}

/// The planes of the table and the axes follow CIE 121: cos γ = cos B cos β and tan C = sin B / tan
/// β, and cos γ = cos A cos α and tan C = tan α / sin A.
#[test]
fn tables_of_types_a_and_b_follow_the_conversion_formulas() {
    let (horizontal, vertical) = (0.5_f64, 0.3_f64);
    let peak = |kind, polar: f64, azimuth: f64| {
        let (polar, azimuth) = ([polar - 0.01, polar, polar + 0.01], [azimuth - 0.01, azimuth, azimuth + 0.01]);
        let values = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        IntensityTable::new(kind, &polar, &azimuth, &values).unwrap().brightest()
    };
    let b = peak(PhotometricType::B, PI / 2.0 - horizontal, vertical);
    assert!((b.z - vertical.cos() * horizontal.cos()).abs() < 1e-12);
    assert!((b.y / b.x - vertical.sin() / horizontal.tan()).abs() < 1e-12);
    let a = peak(PhotometricType::A, PI / 2.0 - vertical, horizontal);
    assert!((a.z - vertical.cos() * horizontal.cos()).abs() < 1e-12);
    assert!((a.y / a.x - vertical.tan() / horizontal.sin()).abs() < 1e-12);
}

#[test]
fn the_pdf_integrates_to_one() {
    for table in uneven() {
        let mut stream = Stream::new(Seed::new(3), Purpose::SurveyPhoton, 0, 0);
        let n = 400_000;
        let mean: f64 = (0..n).map(|_| 4.0 * PI * table.pdf(warp::sphere(stream.pair())) / f64::from(n)).sum();
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }
}

/// The fractions in octants and rings equal the integrals of the pdf within four errors.
#[test]
fn samples_follow_their_pdf() {
    let cell = |d: DVec3| {
        let octant = usize::from(d.x > 0.0) + 2 * usize::from(d.y > 0.0) + 4 * usize::from(d.x.abs() > d.y.abs());
        octant * 12 + ((d.z + 1.0) * 6.0).min(11.0) as usize
    };
    for table in uneven() {
        let mut stream = Stream::new(Seed::new(4), Purpose::SurveyPhoton, 0, 0);
        let n = 1_000_000;
        let (mut sampled, mut expected, mut squares) = ([0.0; 96], [0.0; 96], [0.0; 96]);
        for _ in 0..n {
            let direction = table.sample(stream.pair());
            assert!((direction.length() - 1.0).abs() < 1e-12 && table.at(direction) > 0.0);
            sampled[cell(direction)] += 1.0 / f64::from(n);
            let direction = warp::sphere(stream.pair());
            let relative_pdf = 4.0 * PI * table.pdf(direction);
            expected[cell(direction)] += relative_pdf / f64::from(n);
            squares[cell(direction)] += relative_pdf * relative_pdf / f64::from(n);
        }
        for i in 0..96 {
            let variance = sampled[i] + squares[i];
            let error = (variance / f64::from(n)).sqrt();
            assert!((sampled[i] - expected[i]).abs() <= 4.5 * error, "{i}: {} against {}", sampled[i], expected[i]);
        }
    }
}

#[test]
fn light_stays_within_the_bounding_cosines() {
    for table in uneven() {
        let mut stream = Stream::new(Seed::new(5), Purpose::SurveyPhoton, 0, 0);
        let [least, most] = table.cosines();
        let (mut low, mut high) = (1.0_f64, -1.0_f64);
        for _ in 0..20_000 {
            let z = table.sample(stream.pair()).z;
            (low, high) = (low.min(z), high.max(z));
        }
        assert!(low >= least - 1e-12 && high <= most + 1e-12, "{low} to {high} in {least} to {most}");
        assert!(low < least + 0.1 && high > most - 0.1, "{low} to {high} in {least} to {most}");
    }
}

#[test]
fn damaged_tables_are_refused() {
    let new = |polar: &[f64], azimuth: &[f64], values: &[f64]| {
        IntensityTable::new(PhotometricType::C, polar, azimuth, values).is_err()
    };
    assert!(new(&[0.0], &[0.0, 1.0], &[1.0; 2]));
    assert!(new(&[0.0, 1.0], &[1.0, 0.0], &[1.0; 4]));
    assert!(new(&[0.0, 1.0], &[0.0, 7.0], &[1.0; 4]));
    assert!(new(&[0.0, 4.0], &[0.0, 1.0], &[1.0; 4]));
    assert!(new(&[0.0, f64::NAN], &[0.0, 1.0], &[1.0; 4]));
    assert!(new(&[0.0, 1.0], &[0.0, 1.0], &[1.0; 3]));
    assert!(new(&[0.0, 1.0], &[0.0, 1.0], &[1.0, -1.0, 1.0, 1.0]));
    assert!(new(&[0.0, 1.0], &[0.0, 1.0], &[0.0; 4]));
}
