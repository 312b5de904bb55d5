//! Photons at fluorescent surfaces: reflection, emission at other wavelengths, or absorption.
//!
//! A photon that a fluorophore absorbs excites it by the power × a(λ) × λ, summed over the photon's
//! wavelengths. The excitation fixes the emitted power at every wavelength. An emitted photon
//! samples new wavelengths from the emission spectrum.
//!
//! A photon on the shared wavelengths of a pass cannot excite a fluorophore: the same four
//! wavelengths would be the wavelengths of the absorbed and of the emitted light, and the estimate
//! would be biased. In a scene with fluorophores, a part of the photons of the shared set are
//! therefore *excitation photons*. They sample wavelengths of their own and are not recorded. When
//! a fluorophore absorbs one of them, the emitted photon either gets the shared wavelengths and is
//! recorded from then on, or it gets wavelengths of its own and can excite the next fluorophore.

use super::photon_path::PhotonPath;
use super::source::{PhotonSource, WavelengthSampling};
use crate::math::random::Stream;
use crate::optics::bsdf::Fluorescent;
use crate::plan::partition::LightPath;
use crate::spectrum::{LANES, Wavelengths};
use crate::walk::ledger::Ledger;
use crate::walk::{SurfaceInteraction, long_path_survival, sample_consistently};

/// The share of the photons of the shared set that are excitation photons.
pub(super) const EXCITATION_SHARE: f64 = 0.5;

/// The probability with which the emitted photon of an excitation photon gets the shared
/// wavelengths.
const SHARED_EMISSION: f64 = 0.5;

/// Scatters a photon at a fluorescent surface. `depth` is the number of the surface event. Returns
/// whether the photon survives.
///
/// The photon is reflected or emitted with probabilities in proportion to the power of the outcome,
/// so the power of a surviving photon does not grow. The ledger gets the expected absorbed power.
#[inline(never)]
pub(super) fn scatter_at_fluorescent_surface(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    interaction: &SurfaceInteraction<'_>,
    surface: &Fluorescent,
    depth: u32,
    ledger: &mut Ledger,
    stream: &mut Stream,
) -> bool {
    let before = path.total_w();
    let fluorophore = &surface.fluorophore;
    let (mut reflected, mut emitted, mut excitation, mut booked) = (0.0, 0.0, 0.0, 0.0);
    for (k, &nm) in path.photon.wavelengths.active().iter().enumerate() {
        let power_w = path.photon.power[k] * path.watts[k];
        reflected += power_w * surface.reflected_fraction(nm);
        emitted += power_w * fluorophore.emitted_fraction(nm);
        excitation += path.photon.power[k] * fluorophore.excitation(nm);
        let absorbed = power_w * surface.absorbed_by_substrate(nm);
        let losses = fluorophore.losses(nm);
        ledger.absorbed[interaction.material] += absorbed;
        ledger.stokes_loss += power_w * losses.stokes;
        ledger.quantum_loss += power_w * losses.quantum;
        booked += absorbed + power_w * (losses.stokes + losses.quantum);
    }
    let excites = path.photon.excitation || matches!(source.wavelengths, WavelengthSampling::Free);
    let emitted = if excites { emitted } else { 0.0 };
    let either = reflected + emitted;
    let survival = if before > 0.0 { (either / before).min(1.0) * long_path_survival(depth) } else { 0.0 };
    let u = stream.uniform();
    let direction_u = stream.triple();
    let sample = sample_consistently(interaction, |wo| {
        interaction.bsdf.sample(wo, interaction.sides, path.photon.wavelengths.hero(), direction_u)
    });
    let Some(sample) = sample.filter(|_| u < survival) else {
        path.photon.power = [0.0; LANES];
        ledger.sampling += booked - before;
        return false;
    };
    let direction = sample.frame.to_world(sample.sample.wi);
    let factor = either / survival * interaction.adjoint_correction(-interaction.incoming, direction);
    if u * either < reflected * survival {
        for (k, &nm) in path.photon.wavelengths.active().iter().enumerate() {
            path.photon.power[k] *= surface.reflected_fraction(nm) * factor / reflected;
        }
    } else {
        emit_again(source, path, surface, excitation * factor / emitted, stream);
    }
    ledger.sampling += path.total_w() + booked - before;
    path.ray_state = interaction.spawn_ray(direction, interaction.here);
    path.photon.light_path = LightPath::Indirect;
    true
}

/// Replaces the wavelengths of an absorbed photon by wavelengths of the emission. `excitation` is
/// the excitation of the fluorophore in W·nm.
fn emit_again(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    surface: &Fluorescent,
    excitation: f64,
    stream: &mut Stream,
) {
    let PhotonPath { photon, watts, .. } = path;
    photon.lane = None;
    let mut excitation = excitation;
    if let (true, WavelengthSampling::Shared { nm, .. }) = (photon.excitation, source.wavelengths) {
        let shared = stream.uniform() < SHARED_EMISSION;
        excitation /= if shared { SHARED_EMISSION } else { 1.0 - SHARED_EMISSION };
        if shared {
            photon.excitation = false;
            photon.wavelengths = Wavelengths::new(nm);
            photon.power = nm.map(|nm| excitation * surface.fluorophore.emitted(nm));
            *watts = source.watts(false);
            return;
        }
    }
    let u = stream.uniform();
    photon.wavelength_code = source.spectra.code_of_emission(surface.number, photon.wavelength_code, u);
    photon.wavelengths = Wavelengths::new([0.0; LANES]);
    for k in 0..LANES {
        let (nm, pdf) = surface.fluorophore.wavelengths().sample((u + k as f64) / LANES as f64);
        photon.wavelengths.nm[k] = nm;
        photon.power[k] = excitation * surface.fluorophore.emitted(nm) / (pdf * LANES as f64);
    }
    *watts = source.watts(photon.excitation);
}
