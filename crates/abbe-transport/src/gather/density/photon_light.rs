//! The light of a photon that a camera path gathers.

use crate::gather::camera::throughput::{PathFactors, SpectralMode, product};
use crate::map::kernel::KernelValues;
use crate::map::{PhotonPower, PhotonSpectra};
use crate::plan::{LightOrigin, PathClass};
use crate::walk::Sink;

/// The wavelengths and powers of a photon, with the spectra that the wavelengths refer to.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct PhotonLight<'p> {
    pub(in crate::gather) power: &'p PhotonPower,
    pub(in crate::gather) spectra: &'p PhotonSpectra,
    pub(in crate::gather) class: PathClass,
}

/// Returns the bias per unit of power. `path_bias` is that of all factors except the kernel.
#[inline(always)]
pub(in crate::gather) fn biased_by(kernels: KernelValues, path_bias: f64) -> f64 {
    kernels.bias() + kernels.estimate * path_bias
}

/// Adds a photon to the radiance of a camera path. `response` returns the fraction of the power at
/// a wavelength (nm) that is scattered into the path, per steradian. `path_bias` is the relative
/// bias of all factors except the kernel.
#[inline(always)]
pub(in crate::gather) fn add_photon<S: Sink>(
    PhotonLight { power, spectra, class }: PhotonLight<'_>,
    kernels: KernelValues,
    path_bias: f64,
    (spectral_mode, factors): (SpectralMode, &PathFactors<'_>),
    sink: &mut S,
    response: impl Fn(f64) -> f64,
) {
    let (estimate, bias) = (kernels.estimate, biased_by(kernels, path_bias));
    let origin = LightOrigin { class, light: spectra.light_of(power.wavelength_code()) };
    let mut add = |nm: f64, radiance: f64| sink.biased(origin, nm, radiance * estimate, radiance * bias);
    match spectral_mode {
        SpectralMode::Free => {
            power.lanes(spectra).for_each(|(nm, power)| add(nm, response(nm) * product(&factors.natural, nm) * power));
        }
        SpectralMode::Shared { lane, nm, throughput } => {
            if let Some(power) = power.at_lane(lane) {
                add(nm, response(nm) * throughput * power);
            }
        }
    }
}
