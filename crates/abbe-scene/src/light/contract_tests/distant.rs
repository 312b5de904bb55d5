//! Distant lights for the contract tests.

use super::*;

pub(super) fn distant_cases() -> Vec<LightCase> {
    let toward = DVec3::new(0.3, -0.9, 0.5).normalize();
    let receiver = ReceiverSquare::new(DVec3::new(0.2, -0.3, 0.1), -toward + DVec3::new(0.3, 0.0, 0.4), 1.0);
    let case = |name, emitter, spectrum| LightCase {
        name,
        light: light(emitter, spectrum),
        geometry: Geometry::build(Vec::new(), DVec3::ZERO).unwrap(),
        receiver,
    };
    let map = Arc::new(image());
    let mean = map.mean_spectrum();
    let bands = Arc::new(spectral_image());
    let mean_of_bands = bands.mean_spectrum();
    let environment = |pattern| Emitter::Environment(EnvironmentLight::new(2.0, pattern));
    let sky = StandardSky::new(12, SunDirection { elevation: 0.8, azimuth: 2.0 }, 0.3).unwrap();
    vec![
        case("directional", Emitter::Directional(DirectionalLight::new(toward, 0.0, 4.0)), flat_spectrum()),
        case("sun", Emitter::Directional(DirectionalLight::new(toward, 0.3, 4.0)), flat_spectrum()),
        case("uniform", environment(EnvironmentPattern::Uniform), flat_spectrum()),
        case("image", environment(EnvironmentPattern::Image(map)), mean),
        case("spectral image", environment(EnvironmentPattern::Image(bands)), mean_of_bands),
        case("sky", environment(EnvironmentPattern::Sky(Arc::new(sky))), flat_spectrum()),
    ]
}

/// A rotation turns an image from the zenith to the horizon. Sampled directions carry the radiance
/// and the density of the image there.
#[test]
fn a_rotated_image_is_sampled_where_it_shines() {
    let basis = [620.0, 540.0, 450.0].map(|nm| Spectrum::gaussian(nm, 60.0).unwrap());
    let bright = |i: u32| if i < 8 { [1.0; 3] } else { [1e-3; 3] };
    let pixels: Vec<[f32; 3]> = (0..48).map(bright).collect();
    let map = EnvironmentMap::new(8, 6, &pixels, [&basis[0], &basis[1], &basis[2]]).unwrap();
    let upright = EnvironmentLight::new(2.0, EnvironmentPattern::Image(Arc::new(map)));
    let lying = upright.rotated(DQuat::from_rotation_arc(DVec3::Y, DVec3::X));
    assert_eq!([upright.le(DVec3::Y).0, upright.le(DVec3::X).0], [lying.le(DVec3::X).0, lying.le(DVec3::NEG_Y).0]);
    let (mut stream, mut towards_x) = (stream(0), 0);
    for _ in 0..1000 {
        let sample = lying.sample_li(stream.triple()).unwrap();
        let (radiance, pdf) = (lying.le(sample.direction).0, lying.pdf_li(sample.direction));
        assert!((sample.irradiance / (radiance / pdf) - 1.0).abs() < 1e-9, "{}", sample.direction);
        towards_x += u32::from(sample.direction.x > 0.8);
    }
    assert!(towards_x > 900, "{towards_x} of 1000 samples");
}

/// An image with three bands of unequal widths in each pixel, and with black pixels.
fn spectral_image() -> EnvironmentMap {
    let values =
        (0..48_u32).flat_map(|i| [i % 5, (i * 7) % 3, i % 4].map(|value| if i % 6 == 2 { 0.0 } else { value as f32 }));
    let bands = EnvironmentBands::new(&[450.0, 550.0, 600.0], values.collect()).unwrap();
    EnvironmentMap::from_bands(8, 6, bands).unwrap().0
}

/// An image with unequal pixels, black pixels and a black row.
fn image() -> EnvironmentMap {
    let basis = [620.0, 540.0, 450.0].map(|nm| Spectrum::gaussian(nm, 60.0).unwrap());
    let pixel = |i: u32| [i % 5, (i * 7) % 3, i % 4].map(|c| if (16..24).contains(&i) { 0.0 } else { c as f32 });
    let pixels: Vec<[f32; 3]> = (0..48).map(pixel).collect();
    EnvironmentMap::new(8, 6, &pixels, [&basis[0], &basis[1], &basis[2]]).unwrap()
}
