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
    vec![
        case("directional", Emitter::Directional(DirectionalLight::new(toward, 0.0, 4.0)), flat_spectrum()),
        case("sun", Emitter::Directional(DirectionalLight::new(toward, 0.3, 4.0)), flat_spectrum()),
        case("sky", Emitter::Environment(EnvironmentLight::new(2.0, None)), flat_spectrum()),
        case("image", Emitter::Environment(EnvironmentLight::new(2.0, Some(map))), mean),
    ]
}

/// An image with unequal pixels, black pixels and a black row.
fn image() -> EnvironmentMap {
    let basis = [620.0, 540.0, 450.0].map(|nm| Spectrum::gaussian(nm, 60.0).unwrap());
    let pixel = |i: u32| [i % 5, (i * 7) % 3, i % 4].map(|c| if (16..24).contains(&i) { 0.0 } else { c as f32 });
    let pixels: Vec<[f32; 3]> = (0..48).map(pixel).collect();
    EnvironmentMap::new(8, 6, &pixels, [&basis[0], &basis[1], &basis[2]]).unwrap()
}
