//! Volume lights for the contract tests.

use super::*;
use crate::medium::field::{self, BallField, ScalarField};
use crate::medium::{Density, Medium, MediumEmission};
use abbe_optics::phase::PhaseFunction;
use abbe_spectra::spectrum::planck;

/// A rotated tube with uniform emission, and a box with matter that is hot in the middle and cold
/// outside.
pub(super) fn cases() -> Vec<LightCase> {
    let tube = place_turned(Shape::Cylinder { radius: 0.2, height: 0.6 });
    let from_unit = tube.to_world
        * DAffine3::from_translation(DVec3::new(-0.2, -0.3, -0.2))
        * DAffine3::from_scale(DVec3::new(0.4, 0.6, 0.4));
    let (volume, body) = (tube.volume_m3(), Arc::new(Geometry::build(vec![tube], DVec3::ZERO).unwrap()));
    let coefficients = || (Spectrum::power_law(550.0, 2.0, -1.0).unwrap(), Spectrum::constant(0.0));
    let matter = |density| Medium::new(String::new(), coefficients(), PhaseFunction::Isotropic, density);
    let neon =
        Medium { emission: Some(MediumEmission::uniform(flat_spectrum().scaled(3.0))), ..matter(Density::Uniform) };
    let (low, high) = (DVec3::new(-0.4, -0.3, -0.5), DVec3::new(0.4, 0.5, 0.3));
    let ball = |value, falloff| BallField { value, center: DVec3::new(0.05, 0.1, -0.1), radius: 0.35, falloff };
    let field = |value, falloff| {
        Arc::new(ScalarField::new(
            field::FieldShape::Ball(ball(value, falloff)),
            (low, high),
            DAffine3::from_rotation_y(0.4),
        ))
    };
    let soot = MediumEmission::thermal(coefficients().0, field(2200.0, 1.0));
    let flame = Medium { emission: Some(soot), ..matter(Density::Field(field(1.5, 0.6))) };
    let case = |name, volume: Option<VolumeLight>| {
        let volume = volume.unwrap();
        let spectrum = volume.spectrum().clone();
        LightCase {
            name,
            light: light(Emitter::Volume(Box::new(volume)), spectrum),
            geometry: Geometry::build(Vec::new(), DVec3::ZERO).unwrap(),
            receiver: ReceiverSquare::new(DVec3::new(0.9, 1.1, -0.4), DVec3::new(-0.9, -1.0, 0.5), 0.8),
        }
    };
    let flame_box = field(1.0, 0.0).from_unit();
    vec![
        case("tube", VolumeLight::new(&neon, from_unit, Some((body, volume)))),
        case("flame", VolumeLight::new(&flame, flame_box, None)),
    ]
}

#[test]
fn a_volume_light_has_the_power_and_spectrum_of_its_matter() {
    let [tube, flame] = cases().try_into().unwrap_or_else(|_| panic!("two cases"));
    // 4π · 3 W/m³/sr · π r² h.
    let expected = 4.0 * PI * 3.0 * PI * 0.04 * 0.6;
    assert!((tube.light.power_w(tube.extent()) / expected - 1.0).abs() < 1e-9);
    // 4π ∫∫ σ_a ρ B(T) dλ dV over shells of the ball, by the midpoint rule.
    let fade = |r: f64, inner: f64| {
        let u = ((1.0 - r * r) / (1.0 - inner * inner)).clamp(0.0, 1.0);
        u * u * (3.0 - 2.0 * u)
    };
    let absorption = |nm: f64| 2.0 * 550.0 / nm;
    let spectral = |nm: f64| -> f64 {
        let shell = |i: u32| {
            let r = (f64::from(i) + 0.5) / 2000.0;
            let (density, kelvin) = (1.5 * fade(r, 0.4), 2200.0 * fade(r, 0.0));
            4.0 * PI * r * r / 2000.0 * 0.35_f64.powi(3) * density * planck(nm, kelvin.max(1.0)) * 1e-9
        };
        4.0 * PI * absorption(nm) * (0..2000).map(shell).sum::<f64>()
    };
    let expected: f64 = (0..470).map(|i| spectral(360.5 + f64::from(i))).sum();
    let power = flame.light.power_w(flame.extent());
    println!("flame: {power} W, expected {expected} W, off by {:.1e}", power / expected - 1.0);
    assert!((power / expected - 1.0).abs() < 1e-3, "{power}, expected {expected}");
    for nm in [450.0, 550.0, 650.0, 800.0] {
        let (got, expected) = (power * flame.light.spectrum.at(nm), spectral(nm));
        assert!((got / expected - 1.0).abs() < 2e-3, "{nm} nm: {got}, expected {expected}");
        let mut stream = stream(13);
        let mean = SampleMean::of(100_000, || {
            let emission = flame.emit(&mut stream);
            emission.flux_w * flame.light.spd_at(emission.spd, nm)
        });
        mean.agrees(exactly(expected), 0.006, &format!("{nm} nm"));
    }
}

/// A point inside a glowing body gets the irradiance of the closed form, and no sample exceeds a
/// bound: points of the body near the sampled point do not make the variance infinite.
#[test]
fn samples_inside_a_volume_light_are_bounded() {
    let [tube, _] = cases().try_into().unwrap_or_else(|_| panic!("two cases"));
    let Emitter::Volume(volume) = &tube.light.emitter else { panic!("a volume light") };
    let centre = volume.box_map().transform_point3(DVec3::splat(0.5));
    let (radius, half) = (0.2_f64, 0.3_f64);
    // The integral of 1/d² over the cylinder around its centre.
    let closed = 2.0 * PI * (half * (1.0 + (radius / half).powi(2)).ln() + 2.0 * radius * (half / radius).atan());
    let longest_chord = (radius * radius + half * half + radius * radius).sqrt();
    let (mut stream, mut largest) = (stream(21), 0.0_f64);
    let mean = SampleMean::of(200_000, || {
        let incident = tube.light.sample_li(tube.extent(), centre, stream.triple());
        let irradiance = incident.map_or(0.0, |incident| incident.irradiance);
        largest = largest.max(irradiance);
        irradiance
    });
    mean.agrees(exactly(3.0 * closed), 0.01, "inside the tube");
    assert!(largest <= 2.0 * 3.0 * 4.0 * PI * longest_chord, "{largest}");
}
