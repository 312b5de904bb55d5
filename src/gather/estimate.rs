//! Density estimation: from the photons around a point to the radiance that leaves it.

use super::photon_gather::Gatherer;
use super::throughput::{Colour, Factor, product};
use crate::map::kernel::{Disk, Kernels, Shares};
use crate::map::{Load, PhotonIndex, VolumeMaps};
use crate::optics::surface::Transport;
use crate::walk::{Encounter, Sink};
use glam::DVec3;

/// The photon maps of one set of photons: caustics are sharp and want small kernels, indirect light is smooth and wants large ones.
#[derive(Debug, Default)]
pub struct Maps {
    /// Photons in media that came by mirrors and glass only.
    pub volume_caustic: VolumeMaps,
    /// Photons in media that were scattered before.
    pub volume_indirect: VolumeMaps,
    /// Photons that came by mirrors and glass only.
    pub caustic: PhotonIndex,
    /// Photons that were scattered before.
    pub indirect: PhotonIndex,
}

/// Which radius of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RadiusKind {
    /// For free caustic photons.
    FreeCaustic,
    /// For free indirect photons.
    FreeIndirect,
    /// For shared caustic photons.
    SharedCaustic,
    /// For shared indirect photons.
    SharedIndirect,
    /// For free caustic photons in media.
    FreeVolumeCaustic,
    /// For free indirect photons in media.
    FreeVolumeIndirect,
    /// For shared caustic photons in media.
    SharedVolumeCaustic,
    /// For shared indirect photons in media.
    SharedVolumeIndirect,
}

/// How many kinds there are.
pub const RADIUS_KINDS: usize = 8;

/// A pixel's first radii by [`RadiusKind`]: in m on surfaces, per distance from the camera in media.
pub type Radii = [f32; RADIUS_KINDS];

/// Photons whose surface faces another way by more than acos of this do not count.
const NORMAL_TOLERANCE: f64 = 0.7;

/// Photons off the tangent plane by more than this share of the radius do not count.
const PLANE_TOLERANCE: f64 = 0.3;

impl Gatherer<'_> {
    /// Adds the radiance that the photons of one map within `radius` (m) around the encounter send back along the path; of the kernels these
    /// `shares` lie on the surface. The angle at which a photon came in is
    /// taken from the surface where it arrived: by the tangent plane here, flat light on a curved surface would partly seem to come
    /// from below. With interpolated normals the flux came through the true surface and the reflectance is for the shaded one:
    /// |ω·n_s| / |ω·n_g|.
    #[inline(always)]
    pub(super) fn estimate<S: Sink>(
        &self,
        encounter: &Encounter<'_>,
        (map, radius, shares): (&PhotonIndex, f64, Shares),
        (colour, bias): (Colour, f64),
        factors: &[Factor<'_>],
        sink: &mut S,
    ) {
        let disk = Disk::new(radius * radius).over(shares);
        let Encounter { surface, wo, sides, frame, .. } = *encounter;
        let (place, normal) = (encounter.hit.position, encounter.hit.normal);
        let facing = if encounter.leads_back(normal) { normal } else { -normal };
        let through = surface.lets_through();
        let shading = frame.normal();
        let interpolated = shading != normal;
        map.within(place.as_vec3().to_array(), radius as f32, |found| {
            let photon = &found.photon;
            let photon_normal = photon.normal();
            let alignment = photon_normal.dot(facing);
            let side = if through { alignment.signum() } else { 1.0 };
            let offset = DVec3::from(found.position.map(f64::from)) - place;
            if alignment * side < NORMAL_TOLERANCE || offset.dot(normal).abs() > PLANE_TOLERANCE * radius {
                return;
            }
            let to_light = photon.to_light();
            let kernels = disk.at(f64::from(found.distance2));
            // Photons bring flux through their own piece of surface; on a curved one that is tilted against the place in question.
            let own_cosine = to_light.dot(photon_normal) * side;
            let (wi, kernels) = if interpolated {
                let correction = if own_cosine == 0.0 { 0.0 } else { (to_light.dot(shading) / own_cosine).abs() };
                (to_light, kernels.times(correction))
            } else {
                ((to_light + (own_cosine - to_light.dot(facing)) * facing).normalize(), kernels)
            };
            let wi = frame.to_local(wi);
            let bsdf = |nm: f64| surface.eval(wo, wi, sides, Transport::Radiance, nm);
            add_photon(&photon.load, (kernels, bias), (colour, factors), sink, bsdf);
        });
    }
}

/// Adds what a photon sends back along a camera path; `scattered` is the share of its power at a wavelength that goes that way,
/// per sr, and `bias` its relative bias but for the kernel's.
#[inline]
pub(super) fn add_photon<S: Sink>(
    load: &Load,
    (kernels, bias): (Kernels, f64),
    (colour, factors): (Colour, &[Factor<'_>]),
    sink: &mut S,
    scattered: impl Fn(f64) -> f64,
) {
    let (estimate, bias) = (kernels.estimate, kernels.bias() + kernels.estimate * bias);
    let mut add = |nm: f64, radiance: f64| sink.biased(nm, radiance * estimate, radiance * bias);
    match colour {
        Colour::Free => {
            if factors.is_empty() {
                load.lanes().for_each(|(nm, power)| add(nm, scattered(nm) * power));
            } else {
                load.lanes().for_each(|(nm, power)| add(nm, scattered(nm) * product(factors, nm) * power));
            }
        }
        Colour::Shared { lane, nm, throughput } => {
            if let Some(power) = load.at_lane(lane) {
                add(nm, scattered(nm) * throughput * power);
            }
        }
    }
}
