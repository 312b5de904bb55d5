//! Density estimation: from the photons around a point to the radiance that leaves it.

use super::camera_path::CameraPath;
use super::throughput::{Colour, Factor, product};
use crate::map::kernel::{Disk, Kernels, Shares};
use crate::map::{Load, Nearby, PhotonIndex, VolumeMaps};
use crate::math::frame::Frame;
use crate::optics::surface::{Sides, Surface, Transport};
use crate::walk::{Encounter, Sink, bias_of_excess};
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

/// A place that asks for the photons around it: all that is the same for each of them.
///
/// The angle at which a photon came in is taken from the surface where it arrived: by the tangent plane here, flat light on a curved surface would
/// partly seem to come from below. With interpolated normals the flux came through the true surface and the reflectance is for the shaded one:
/// |ω·n_s| / |ω·n_g|.
pub(super) struct Receiver<'e> {
    surface: &'e Surface,
    sides: Sides<'e>,
    frame: Frame,
    wo: DVec3,
    place: DVec3,
    normal: DVec3,
    /// The normal on the side that was seen.
    facing: DVec3,
    /// How far off the tangent plane photons may lie, in m.
    height: f64,
    disk: Disk,
    colour: Colour,
    factors: &'e [Factor<'e>],
    /// The relative bias of what the path carries.
    bias: f64,
    /// Whether photons on the other side count too.
    through: bool,
    /// Whether the normal is interpolated.
    interpolated: bool,
}

impl<'e> Receiver<'e> {
    /// What asks at the end of a path for photons within `radius` (m); of the kernels these `shares` lie on the surface.
    #[inline(always)]
    pub(super) fn new(
        encounter: &Encounter<'e>,
        (radius, shares): (f64, Shares),
        path: &CameraPath,
        factors: &'e [Factor<'e>],
    ) -> Self {
        let normal = encounter.hit.normal;
        Self {
            surface: encounter.surface,
            sides: encounter.sides,
            frame: encounter.frame,
            wo: encounter.wo,
            place: encounter.hit.position,
            normal,
            facing: if encounter.leads_back(normal) { normal } else { -normal },
            height: PLANE_TOLERANCE * radius,
            disk: Disk::new(radius * radius).over(shares),
            colour: path.colour,
            factors,
            bias: bias_of_excess(path.excess_depth),
            through: encounter.surface.lets_through(),
            interpolated: encounter.frame.normal() != normal,
        }
    }

    /// Adds the radiance that a photon nearby sends back along the path.
    #[inline(always)]
    pub(super) fn add<const BODIES: bool, S: Sink>(&self, found: &Nearby, sink: &mut S) {
        let photon = &found.photon;
        let photon_normal = photon.normal();
        let alignment = photon_normal.dot(self.facing);
        let side = if self.through { alignment.signum() } else { 1.0 };
        let offset = DVec3::from(found.position.map(f64::from)) - self.place;
        if alignment * side < NORMAL_TOLERANCE || offset.dot(self.normal).abs() > self.height {
            return;
        }
        let to_light = photon.to_light();
        let kernels = self.disk.at(f64::from(found.distance2));
        // Photons bring flux through their own piece of surface; on a curved one that is tilted against the place in question.
        let own_cosine = to_light.dot(photon_normal) * side;
        let (wi, kernels) = if self.interpolated {
            let shaded = to_light.dot(self.frame.normal());
            (to_light, kernels.times(if own_cosine == 0.0 { 0.0 } else { (shaded / own_cosine).abs() }))
        } else {
            ((to_light + (own_cosine - to_light.dot(self.facing)) * self.facing).normalize(), kernels)
        };
        let wi = self.frame.to_local(wi);
        let bsdf = |nm: f64| self.surface.eval(self.wo, wi, self.sides, Transport::Radiance, nm);
        add_photon::<BODIES, S>(&photon.load, (kernels, self.bias), (self.colour, self.factors), sink, bsdf);
    }
}

/// Adds what a photon sends back along a camera path; `scattered` is the share of its power at a wavelength that goes that way,
/// per sr, and `bias` its relative bias but for the kernel's. Without `BODIES` photons keep all their wavelengths.
#[inline(always)]
pub(super) fn add_photon<const BODIES: bool, S: Sink>(
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
            if !BODIES && factors.is_empty() {
                load.all_lanes().for_each(|(nm, power)| add(nm, scattered(nm) * power));
            } else if factors.is_empty() {
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
