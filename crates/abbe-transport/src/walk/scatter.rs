//! Scattering of a path that carries several wavelengths. They share one direction until a
//! dispersive refraction, where the path keeps one of them.

use super::crystal::scatter_at_crystal;
use super::scatter_coated::scatter_at_coated_interface;
use super::scattered_ray::{ScatteredRay, single_lane, transmitted_scale};
use super::surface_interaction::SurfaceInteraction;
use abbe_optics::bsdf::{Bsdf, ScatterEvent, TransportMode};
use abbe_optics::fresnel;
use abbe_polarisation::Stokes;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{LANES, Wavelengths};
use glam::DVec3;

/// Scatters a path with these wavelengths. Returns `None` if the surface absorbs the path.
#[inline]
pub fn scatter(
    interaction: &SurfaceInteraction<'_>,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    if matches!(interaction.bsdf.model, Bsdf::Grating(_)) && wavelengths.count > 1 {
        return split_at_dispersive_facets(interaction, wavelengths, transport, stream);
    }
    if interaction.bsdf.model.crystal().is_some() {
        return scatter_at_crystal(interaction, wavelengths, transport, |_| Stokes::unpolarised(1.0), stream);
    }
    let disperses = || interaction.sides.is_dispersive();
    if let Bsdf::CoatedDielectric(coated) = interaction.bsdf.model {
        match (coated.is_rough(), wavelengths.count > 1 && disperses()) {
            (false, _) => {
                return scatter_at_coated_interface(interaction, coated, wavelengths, transport, stream);
            }
            (true, true) => return split_at_dispersive_facets(interaction, wavelengths, transport, stream),
            (true, false) => {}
        }
    }
    if let Bsdf::Dielectric(dielectric) = interaction.bsdf.model {
        match (wavelengths.count > 1 && disperses(), dielectric.is_rough()) {
            (true, false) => return split_at_dispersive_interface(interaction, wavelengths, transport, stream),
            (true, true) => return split_at_dispersive_facets(interaction, wavelengths, transport, stream),
            (false, false) if wavelengths.count == 1 => {
                return scatter_at_smooth_interface(interaction, wavelengths.hero(), transport, stream);
            }
            (false, _) => {}
        }
    }
    scatter_all_wavelengths(interaction, wavelengths, transport, stream)
}

/// Scatters all wavelengths of a path into one direction, which is sampled for the hero. Returns
/// `None` if the surface absorbs the path. The interaction must not be dispersive.
#[inline(always)]
pub fn scatter_all_wavelengths(
    interaction: &SurfaceInteraction<'_>,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    let u = stream.triple();
    let SurfaceInteraction { bsdf, wo, sides, frame, .. } = interaction;
    let sample = bsdf.sample(*wo, *sides, wavelengths.hero(), u)?;
    let (weight, absorbed) = bsdf.weights(*wo, &sample, *sides, transport, wavelengths.active());
    Some(ScatteredRay {
        direction: frame.to_world(sample.wi),
        weight,
        absorbed,
        kept: None,
        delta: sample.delta,
        pdf: if sample.delta { 0.0 } else { sample.probability },
        event: sample.event,
        wave: None,
    })
}

/// Scatters at a rough interface of dispersive media, or at a grating. Each wavelength has other
/// directions, so the path first selects one wavelength and then samples a direction.
#[inline(never)]
fn split_at_dispersive_facets(
    interaction: &SurfaceInteraction<'_>,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    let kept = ((stream.uniform() * wavelengths.count as f64) as usize).min(wavelengths.count - 1);
    let single = Wavelengths::single(wavelengths.nm[kept]);
    let one = scatter_all_wavelengths(interaction, &single, transport, stream)?;
    let in_kept_lane = |value: f64| single_lane(kept, value * wavelengths.count as f64);
    Some(ScatteredRay {
        weight: in_kept_lane(one.weight[0]),
        absorbed: in_kept_lane(one.absorbed[0]),
        kept: Some(kept),
        ..one
    })
}

/// Scatters one wavelength (nm) at a smooth interface, which reflects or refracts with the
/// probabilities of Fresnel's equations, so the weight of power is 1.
fn scatter_at_smooth_interface(
    interaction: &SurfaceInteraction<'_>,
    nm: f64,
    transport: TransportMode,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    let [_, _, u] = stream.triple();
    let (n_here, n_there) = (interaction.sides.here.n(nm), interaction.sides.there.n(nm));
    let wo = interaction.wo;
    let reflects = u < fresnel::dielectric(wo.z, n_here, n_there);
    let (wi, event, scale) = if reflects {
        (DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, 1.0)
    } else {
        let refracted = fresnel::refract(wo, DVec3::Z, n_here, n_there)?;
        (refracted, ScatterEvent::Transmission, transmitted_scale(transport, n_here, n_there))
    };
    Some(ScatteredRay::specular(interaction.frame.to_world(wi), single_lane(0, scale), event))
}

/// Scatters at a smooth interface of dispersive media.
///
/// Reflection keeps all wavelengths. Its probability is the mean reflectance F̄, so the weights
/// F/F̄ are at most the number of wavelengths, even if only some of them are totally reflected.
/// Refraction keeps one wavelength, selected in proportion to its transmittance, so its weight is
/// exactly the number of wavelengths. If the path transports radiance, refraction also multiplies
/// the weight by (n_here/n_there)².
fn split_at_dispersive_interface(
    interaction: &SurfaceInteraction<'_>,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    let u = stream.uniform();
    let sides = interaction.sides;
    let (n_here, n_there) = (wavelengths.each(|nm| sides.here.n(nm)), wavelengths.each(|nm| sides.there.n(nm)));
    let wo = interaction.wo;
    let count = wavelengths.count as f64;
    let mut reflectance = [0.0; LANES];
    for k in 0..wavelengths.count {
        reflectance[k] = fresnel::dielectric(wo.z.abs(), n_here[k], n_there[k]);
    }
    let mean = reflectance.iter().sum::<f64>() / count;
    let reflected = interaction.frame.to_world(DVec3::new(-wo.x, -wo.y, wo.z));
    let base = ScatteredRay::specular(reflected, reflectance.map(|f| f / mean), ScatterEvent::Reflection);
    if u < mean {
        return Some(base);
    }
    let kept = sample_transmitted_lane(&reflectance[..wavelengths.count], (u - mean) * count)?;
    let (n_here, n_there) = (n_here[kept], n_there[kept]);
    let refracted = fresnel::refract(wo, DVec3::Z, n_here, n_there)?;
    let scale = transmitted_scale(transport, n_here, n_there);
    Some(ScatteredRay {
        direction: interaction.frame.to_world(refracted),
        weight: single_lane(kept, count * scale),
        kept: Some(kept),
        event: ScatterEvent::Transmission,
        ..base
    })
}

/// Selects a lane by its transmittance 1 − F. `rest` is uniform below their sum.
fn sample_transmitted_lane(reflectance: &[f64], mut rest: f64) -> Option<usize> {
    let lane = reflectance.iter().position(|f| {
        rest -= 1.0 - f;
        rest < 0.0
    });
    lane.or_else(|| reflectance.iter().rposition(|&f| f < 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::next_interaction::next_interaction;
    use crate::walk::ray_state::RayState;
    use crate::walk::surface_interaction::SurfaceLookup;
    use abbe_format::{self as format, resolve::resolve};
    use abbe_scene::Scene;
    use abbe_scene::geometry::Ray;
    use abbe_scene::medium_stack::MediumStack;
    use abbe_spectra::math::random::{Purpose, Seed};

    /// Returns the reflectance from the amplitudes of Fresnel's equations in their usual form.
    fn textbook_reflectance(cos_i: f64, n_i: f64, n_t: f64) -> f64 {
        let sin_t = (1.0 - cos_i * cos_i).sqrt() * n_i / n_t;
        if sin_t >= 1.0 {
            return 1.0;
        }
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        let s = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t);
        let p = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t);
        0.5 * (s * s + p * p)
    }

    fn flint_box() -> Scene {
        let text = r#"{
  "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "materials": {"flint": {"dielectric": {"ior": "SF10"}}},
  "objects": [{"shape": {"box": {"size": [2, 2, 2]}}, "material": "flint"}],
  "lights": [{"point": {"at": [3, 3, 3], "spectrum": "E", "power": 1}}]
}"#;
        let (written, source) = format::parse(text, "flint.json".as_ref(), &[]).unwrap();
        resolve(&written, &source).unwrap()
    }

    /// Returns the interaction of a ray that arrives from inside the box at an angle in degrees.
    fn at_top_of_box(scene: &Scene, angle: f64) -> SurfaceInteraction<'_> {
        let (sin, cos) = angle.to_radians().sin_cos();
        let ray = Ray::new(DVec3::new(0.1, 0.2, 0.0) - scene.centre, DVec3::new(sin, 0.0, cos));
        let ray_state = RayState { ray, from: None, medium_stack: MediumStack::AIR.entered(0) };
        next_interaction(scene, ray_state, SurfaceLookup::of_line(0.0)).unwrap()
    }

    /// At a smooth interface, a path of one wavelength scatters as the BSDF says.
    #[test]
    fn one_wavelength_scatters_at_glass_as_the_bsdf_says() {
        let scene = flint_box();
        let one = Wavelengths::single(480.0);
        let mut events = [0; 2];
        for (angle, transport) in [
            (0.0, TransportMode::Radiance),
            (20.0, TransportMode::Importance),
            (34.0, TransportMode::Radiance),
            (50.0, TransportMode::Radiance),
        ] {
            let interaction = at_top_of_box(&scene, angle);
            let mut streams = [0, 1].map(|_| Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0));
            for _ in 0..200 {
                let found = scatter(&interaction, &one, transport, &mut streams[0]).unwrap();
                let known = scatter_all_wavelengths(&interaction, &one, transport, &mut streams[1]).unwrap();
                assert!((found.direction - known.direction).length() < 1e-15, "{angle}°");
                assert!((found.weight[0] / known.weight[0] - 1.0).abs() < 1e-12, "{angle}°");
                assert_eq!((found.event, found.delta, found.kept), (known.event, known.delta, known.kept));
                events[usize::from(found.event == ScatterEvent::Transmission)] += 1;
            }
        }
        assert!(events.iter().all(|&count| count > 200), "{events:?}");
    }

    /// Inside flint glass near the critical angle, some wavelengths are totally reflected. In the
    /// mean, each wavelength is reflected and transmitted as Fresnel's equations say.
    #[test]
    fn dispersive_glass_splits_each_wavelength_as_fresnel_says() {
        let scene = flint_box();
        let wavelengths = Wavelengths::new([420.0, 480.0, 560.0, 680.0]);
        for angle in [30.0_f64, 34.6, 35.2] {
            let cos = angle.to_radians().cos();
            let interaction = at_top_of_box(&scene, angle);
            let (glass, air) = (interaction.sides.here, interaction.sides.there);
            let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
            let (mut reflected, mut transmitted, count) = ([0.0; LANES], [0.0; LANES], 100_000);
            for _ in 0..count {
                let scattered = scatter(&interaction, &wavelengths, TransportMode::Radiance, &mut stream);
                let Some(scattered) = scattered else { continue };
                let sums = if scattered.kept.is_some() { &mut transmitted } else { &mut reflected };
                (0..LANES).for_each(|k| sums[k] += scattered.weight[k] / f64::from(count));
            }
            for (k, &nm) in wavelengths.nm.iter().enumerate() {
                let (n_i, n_t) = (glass.n(nm), air.n(nm));
                let known = textbook_reflectance(cos, n_i, n_t);
                assert!((reflected[k] - known).abs() < 0.02, "{angle}°, {nm} nm: {} for {known}", reflected[k]);
                let passed = transmitted[k] * (n_t / n_i).powi(2);
                assert!((passed - (1.0 - known)).abs() < 0.02, "{angle}°, {nm} nm: {passed} for {}", 1.0 - known);
            }
        }
    }
}
