//! Photons at fluorescent surfaces and in fluorescent media: reflection or scattering, emission at
//! other wavelengths, or absorption.
//!
//! A photon that a fluorophore absorbs excites an emission by the power × a(λ) × λ, summed over the
//! photon's wavelengths. The excitation fixes the emitted power at every wavelength, and the
//! emitted photon samples new wavelengths from the emission spectrum. A measured matrix has several
//! emissions, of which the photon selects one in proportion to its power.
//!
//! A photon on the shared wavelengths of a pass cannot excite a fluorophore: the absorbed and the
//! emitted light would have the same four wavelengths, and the estimate would be biased. In a scene
//! with fluorophores, a part of the shared photons are therefore *excitation photons*, which sample
//! wavelengths of their own and are not recorded. When a fluorophore absorbs one of them, the
//! emitted photon either gets the shared wavelengths and is recorded from then on, or it gets
//! wavelengths of its own and can excite the next fluorophore.

use super::photon_path::PhotonPath;
use super::source::{PhotonSource, WavelengthSampling};
use super::visitor::{MediumCollision, PhotonVisitor};
use crate::plan::partition::LightPath;
use crate::walk::ledger::Ledger;
use crate::walk::{
    MediumSegment, NumberedMedium, PhotonPolarisation, RayState, SurfaceInteraction, long_path_survival,
};
use abbe_optics::bsdf::Fluorescent;
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::phase::PhaseFunction;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{LANES, Wavelengths};

/// The probability with which an excitation photon is emitted at the shared wavelengths.
const SHARED_EMISSION: f64 = 0.5;

/// Scatters a photon at a fluorescent surface, as the surface event number `depth`. Returns whether
/// the photon survives. It is reflected or emitted in proportion to the power of the outcome, so
/// its power does not grow. The ledger gets the expected absorbed power.
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
    let (mut reflected, mut booked) = (0.0, 0.0);
    let mut excited = ExcitedEmissions::default();
    for (k, &nm) in path.photon.wavelengths.active().iter().enumerate() {
        let power_w = path.photon.power[k] * path.watts[k];
        reflected += power_w * surface.reflected_fraction(nm);
        excited.add(fluorophore, nm, path.photon.power[k], path.watts[k]);
        let absorbed = power_w * surface.absorbed_by_substrate(nm);
        let losses = fluorophore.losses(nm);
        ledger.absorbed[interaction.material] += absorbed;
        ledger.stokes_loss += power_w * losses.stokes;
        ledger.quantum_loss += power_w * losses.quantum;
        booked += absorbed + power_w * (losses.stokes + losses.quantum);
    }
    let emitted = if source.excites(&path.photon) { excited.power_w() } else { 0.0 };
    let either = reflected + emitted;
    let survival = if before > 0.0 { (either / before).min(1.0) * long_path_survival(depth) } else { 0.0 };
    let u = stream.uniform();
    let direction_u = stream.triple();
    let SurfaceInteraction { bsdf, wo, sides, .. } = interaction;
    let sample = bsdf.sample(*wo, *sides, path.photon.wavelengths.hero(), direction_u);
    let Some(sample) = sample.filter(|_| u < survival) else {
        path.photon.power = [0.0; LANES];
        ledger.sampling += booked - before;
        return false;
    };
    let direction = interaction.frame.to_world(sample.wi);
    let factor = either / survival * interaction.adjoint_correction(-interaction.incoming, direction);
    if u * either < reflected * survival {
        for (k, &nm) in path.photon.wavelengths.active().iter().enumerate() {
            path.photon.power[k] *= surface.reflected_fraction(nm) * factor / reflected;
        }
    } else {
        let (emission, excitation) = excited.sample(stream);
        emit_again(source, path, fluorophore, emission, excitation * factor, stream);
    }
    ledger.sampling += path.total_w() + booked - before;
    path.photon.polarisation = PhotonPolarisation::NATURAL;
    path.ray_state = interaction.spawn_ray(direction, interaction.here);
    path.photon.light_path = LightPath::Indirect;
    true
}

/// Scatters a photon at `distance` (m) on a segment in a medium with a dye, or lets the dye emit it
/// again. Returns whether the photon survives. The outcomes have probabilities in proportion to
/// their power.
#[inline(never)]
pub(super) fn scatter_in_fluorescent_medium<V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    segment: &MediumSegment<'_>,
    distance: f64,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> bool {
    let Some(numbered @ NumberedMedium { medium, .. }) = segment.medium else { return false };
    let Some(dye) = medium.fluorophore.as_deref() else { return false };
    let before = path.total_w();
    let (mut scattered, mut booked) = (0.0, 0.0);
    let mut excited = ExcitedEmissions::default();
    let (mut scattered_power, mut stored) = ([0.0; LANES], path.photon);
    for (k, &nm) in path.photon.wavelengths.active().iter().enumerate() {
        let sigma_t = medium.extinction.at(nm);
        let per_sigma = if sigma_t > 0.0 { path.photon.power[k] / sigma_t } else { 0.0 };
        let watts = per_sigma * path.watts[k];
        scattered_power[k] = per_sigma * medium.scattering.at(nm);
        scattered += scattered_power[k] * path.watts[k];
        stored.power[k] = per_sigma * medium.stored_coefficient(nm);
        excited.add(dye, nm, per_sigma, path.watts[k]);
        let absorbed = watts * (medium.absorption.at(nm) - dye.absorptance(nm));
        let losses = dye.losses(nm);
        ledger.absorbed_inside += absorbed;
        ledger.stokes_loss += watts * losses.stokes;
        ledger.quantum_loss += watts * losses.quantum;
        booked += absorbed + watts * (losses.stokes + losses.quantum);
    }
    let (position, incoming) = (segment.ray.at(distance), segment.ray.direction);
    if !path.photon.excitation {
        visitor.on_medium_collision(&MediumCollision { position, incoming, medium: numbered, photon: &stored }, stream);
    }
    let emitted = if source.excites(&path.photon) { excited.power_w() } else { 0.0 };
    let either = scattered + emitted;
    let survival = if before > 0.0 { (either / before).min(1.0) } else { 0.0 };
    let u = stream.uniform();
    if u >= survival {
        path.photon.power = [0.0; LANES];
        ledger.sampling += booked - before;
        return false;
    }
    let direction = if u * either < scattered * survival {
        path.photon.power = scattered_power.map(|power| power * either / (survival * scattered));
        path.sample_phase_function(medium, incoming, stream)
    } else {
        let (emission, excitation) = excited.sample(stream);
        emit_again(source, path, dye, emission, excitation * either / survival, stream);
        PhaseFunction::Isotropic.sample(incoming, path.photon.wavelengths.hero(), stream.pair())
    };
    ledger.sampling += path.total_w() + booked - before;
    let ray = Ray { origin: position, direction };
    path.ray_state = RayState { ray, from: None, medium_stack: segment.medium_stack };
    path.photon.light_path = LightPath::Indirect;
    true
}

#[derive(Debug, Default)]
struct ExcitedEmissions {
    list: [ExcitedEmission; 2 * LANES],
    count: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct ExcitedEmission {
    index: usize,
    /// The excitation in W·nm.
    excitation: f64,
    power_w: f64,
}

impl ExcitedEmissions {
    /// Adds the excitation by one wavelength of a photon. `watts` converts `power` to W.
    #[inline]
    fn add(&mut self, fluorophore: &Fluorophore, nm: f64, power: f64, watts: f64) {
        for index in fluorophore.excited_by(nm) {
            let emission = &fluorophore.emissions()[index];
            let excitation = power * emission.excitation(nm);
            let known = self.list[..self.count].iter().position(|known| known.index == index);
            let position = known.unwrap_or_else(|| {
                self.count += 1;
                self.list[self.count - 1].index = index;
                self.count - 1
            });
            self.list[position].excitation += excitation;
            self.list[position].power_w += excitation * watts * emission.emitted_power();
        }
    }

    fn power_w(&self) -> f64 {
        self.list.iter().map(|emission| emission.power_w).sum()
    }

    /// Selects an emission by its power. Returns its index, and its excitation for an emission of 1
    /// W.
    fn sample(&self, stream: &mut Stream) -> (usize, f64) {
        let emission = if self.count == 1 {
            self.list[0]
        } else {
            let mut left = stream.uniform() * self.power_w();
            let excited = || self.list.iter().filter(|emission| emission.power_w > 0.0);
            let chosen = excited().find(|emission| {
                left -= emission.power_w;
                left < 0.0
            });
            chosen.or_else(|| excited().next_back()).copied().unwrap_or_default()
        };
        (emission.index, emission.excitation / emission.power_w)
    }
}

/// Replaces the wavelengths of an absorbed photon by those of the emission `index` of the
/// fluorophore with this excitation in W·nm.
fn emit_again(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    fluorophore: &Fluorophore,
    index: usize,
    mut excitation: f64,
    stream: &mut Stream,
) {
    let PhotonPath { photon, watts, .. } = path;
    let emission = &fluorophore.emissions()[index];
    photon.lane = None;
    photon.polarisation = PhotonPolarisation::NATURAL;
    if let (true, WavelengthSampling::Shared { nm, .. }) = (photon.excitation, source.wavelengths) {
        let shared = stream.uniform() < SHARED_EMISSION;
        excitation /= if shared { SHARED_EMISSION } else { 1.0 - SHARED_EMISSION };
        if shared {
            photon.excitation = false;
            photon.wavelengths = Wavelengths::new(nm);
            photon.power = nm.map(|nm| excitation * emission.emitted(nm));
            *watts = source.watts(false);
            return;
        }
    }
    let u = stream.uniform();
    photon.wavelength_code =
        source.spectra.code_of_emission(fluorophore.first_emission + index, photon.wavelength_code, u);
    photon.wavelengths = Wavelengths::new([0.0; LANES]);
    for k in 0..LANES {
        let (nm, pdf) = emission.wavelengths().sample((u + k as f64) / LANES as f64);
        photon.wavelengths.nm[k] = nm;
        photon.power[k] = excitation * emission.emitted(nm) / (pdf * LANES as f64);
    }
    *watts = source.watts(photon.excitation);
}
