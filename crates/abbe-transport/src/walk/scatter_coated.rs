//! Scattering of a path at a polished interface, selected by the powers at all its wavelengths.

use super::scattered_ray::{ScatteredRay, single_lane, transmitted_scale};
use super::surface_interaction::SurfaceInteraction;
use abbe_optics::bsdf::{Bsdf, CoatedDielectric, PowerFractions, ScatterEvent, TransportMode};
use abbe_optics::fresnel;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{LANES, Lanes, Wavelengths};
use glam::DVec3;

/// Scatters a path at an interface under thin films.
///
/// The probability of reflection is ΣR / Σ(R + T) over the wavelengths, so no weight exceeds the
/// number of wavelengths, even if the films reflect only some of them. If a medium disperses,
/// refraction keeps one wavelength, selected in proportion to its transmittance. The films absorb
/// the fraction 1 − R − T of each wavelength; `None` if they absorb all power.
#[inline(never)]
pub(super) fn scatter_at_coated_interface(
    interaction: &SurfaceInteraction<'_>,
    coated: &CoatedDielectric,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    let (sides, thickness_nm) = (interaction.sides, interaction.bsdf.texels.thickness_nm);
    scatter_by_powers(interaction, wavelengths, transport, stream, |_, nm| {
        let powers = coated.powers(interaction.wo, sides, thickness_nm, nm);
        [powers; 2]
    })
}

/// Scatters a path at a smooth surface. `powers_of` returns, for a lane and its wavelength, the
/// fractions of the power that the weights contain, and those by which the event is selected.
#[inline]
pub(super) fn scatter_by_powers(
    interaction: &SurfaceInteraction<'_>,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    stream: &mut Stream,
    powers_of: impl Fn(usize, f64) -> [PowerFractions; 2],
) -> Option<ScatteredRay> {
    let u = stream.uniform();
    let sides = interaction.sides;
    let straight = matches!(interaction.bsdf.model, Bsdf::ThinDielectric(_) | Bsdf::ThinFilm(_));
    let disperses = !straight && wavelengths.count > 1 && sides.is_dispersive();
    let wo = interaction.wo;
    let (mut weights, mut selected, mut absorbed) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2], [0.0; LANES]);
    for (k, &nm) in wavelengths.active().iter().enumerate() {
        let [of_weight, of_selection] = powers_of(k, nm);
        absorbed[k] = of_weight.absorbed();
        for (lanes, powers) in [(&mut weights, of_weight), (&mut selected, of_selection)] {
            (lanes[0][k], lanes[1][k]) = (powers.reflected, powers.transmitted);
        }
    }
    let [reflected_sum, transmitted_sum] = selected.map(|lanes| lanes.iter().sum::<f64>());
    let both = reflected_sum + transmitted_sum;
    if both <= 0.0 {
        return None;
    }
    let [reflected, transmitted] = weights;
    let probability = reflected_sum / both;
    let direction = interaction.frame.to_world(DVec3::new(-wo.x, -wo.y, wo.z));
    let weight = reflected.map(|fraction| fraction / probability);
    let base = ScatteredRay { absorbed, ..ScatteredRay::specular(direction, weight, ScatterEvent::Reflection) };
    if u < probability {
        return Some(base);
    }
    let lane = if disperses { sample_lane(&selected[1], u * both - reflected_sum)? } else { 0 };
    let indices = |k: usize| (sides.here.n(wavelengths.nm[k]), sides.there.n(wavelengths.nm[k]));
    let (n_here, n_there) = indices(lane);
    let refracted = if straight { -wo } else { fresnel::refract(wo, DVec3::Z, n_here, n_there)? };
    let weight = if disperses {
        let chosen = both * (transmitted[lane] / selected[1][lane]);
        single_lane(lane, chosen * transmitted_scale(transport, n_here, n_there))
    } else {
        let scale = transmitted_scale(transport, n_here, n_there) / (1.0 - probability);
        transmitted.map(|fraction| fraction * scale)
    };
    Some(ScatteredRay {
        direction: interaction.frame.to_world(refracted),
        weight,
        kept: disperses.then_some(lane),
        event: ScatterEvent::Transmission,
        ..base
    })
}

/// Selects a lane in proportion to its weight. `rest` is uniform below the sum.
fn sample_lane(weights: &Lanes, mut rest: f64) -> Option<usize> {
    let lane = weights.iter().position(|weight| {
        rest -= weight;
        rest < 0.0
    });
    lane.or_else(|| weights.iter().rposition(|&weight| weight > 0.0))
}
