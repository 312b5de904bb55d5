//! Light from photons in media: the beam radiance estimate for points, and the beam-beam estimate.

use super::segment::segment_seed;
use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::SpectralMode;
use crate::gather::camera::visible_point::CameraSegment;
use crate::gather::camera_pass::{AllPhotons, CameraPass, EventFilter, EventRange, PathContext, TruncatedMaps};
use crate::gather::density::photon_light::{PhotonLight, add_photon, biased_by};
use crate::gather::luminescence::Luminescence;
use crate::gather::polarised::{PolarisedPhoton, add_polarised_photon};
use crate::map::kernel::{KernelDomain, KernelValues};
use crate::map::{BeamPath, KernelWidth, PhotonNearRay, QueryCone, SetMaps, VolumeMap};
use crate::plan::LightOrigin;
use crate::plan::partition::{PhotonClass, PhotonSet};
use crate::walk::{
    MediumSegment, NumberedMedium, SegmentTransmittance, Sink, bias_of_excess, excess_optical_depth, transmittance,
};
use abbe_optics::phase::Deflection;
use abbe_polarisation::ScatteringEvent;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::medium::{Density, Medium};
use abbe_spectra::math::elementary::exp;
use abbe_spectra::math::random::unit_interval;
use abbe_spectra::spectrum::{LANES, REFERENCE_NM};
use glam::DVec3;

/// The least path length that determines a kernel radius is at most this number of mean free paths.
const NEAR_FREE_PATHS: f64 = 0.5;

/// The least path length that determines a kernel radius, as a fraction of the segment's length.
const NEAR_FRACTION: f64 = 0.1;

/// The probability of gathering a photon point, divided by the transmittance to it. Most points
/// near a ray through a dense medium lie so deep that they hardly add light. For light that is even
/// along the ray, 2 leaves 1.7 of the points per mean free path and raises their variance by a
/// quarter.
const POINTS_PER_TRANSMITTANCE: f64 = 2.0;

/// The photons that a segment gathers, and their effects.
#[derive(Clone, Copy)]
struct VolumeGather<'l, 'a> {
    set: PhotonSet,
    /// True if the medium scatters these photons into the path.
    scatters: bool,
    luminescence: Option<&'l Luminescence<'a>>,
}

impl<'a> CameraPass<'a> {
    /// Gathers the photons near a segment, `behind_m` (m) along the path.
    pub(super) fn gather_volume_photons<S: Sink>(
        &self,
        path: &CameraPath,
        segment: &MediumSegment<'a>,
        (filling, luminescence): (NumberedMedium<'a>, Option<&Luminescence<'a>>),
        behind_m: f64,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let set = path.spectral_mode.photon_set();
        let behind_m = behind_m.max(near_m(segment, filling.medium));
        if context.buffers.records {
            context.buffers.camera_segments.push(CameraSegment {
                ray: segment.ray,
                length_m: segment.length_m,
                behind_m,
                medium: filling.number,
                shared: matches!(path.spectral_mode, SpectralMode::Shared { .. }),
                is_fluorescent: luminescence.is_some(),
            });
        }
        // Only free photons excite a dye.
        let (own, other) = match set {
            PhotonSet::Free => (luminescence, None),
            PhotonSet::Shared => (None, luminescence),
        };
        let gathered = [
            VolumeGather { set, scatters: filling.medium.scattering_max > 0.0, luminescence: own },
            VolumeGather { set: PhotonSet::Free, scatters: false, luminescence: other },
        ];
        for gathered in gathered.into_iter().filter(|gathered| gathered.scatters || gathered.luminescence.is_some()) {
            let (maps, along) = (self.maps[gathered.set], (segment, filling, behind_m));
            match self.truncated {
                None => self.gather_volume_set(maps, (gathered, AllPhotons), path, along, context),
                Some(truncated) => self.gather_volume_to_limit(truncated, gathered, path, along, context),
            }
        }
    }

    /// Gathers the photons within a limit, and those beyond for the estimated bias.
    #[inline(never)]
    fn gather_volume_to_limit<S: Sink>(
        &self,
        truncated: TruncatedMaps<'a>,
        gathered: VolumeGather<'_, 'a>,
        path: &CameraPath,
        along: (&MediumSegment<'a>, NumberedMedium<'a>, f64),
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let within = self.maps[gathered.set];
        match truncated {
            TruncatedMaps::Cap { factor } => {
                self.gather_volume_set(within, (gathered, AllPhotons), path, along, context);
                context.with_truncated_light(factor, |bias| {
                    self.gather_volume_set(within, (gathered, AllPhotons), path, along, bias);
                });
            }
            TruncatedMaps::Explicit { beyond } if context.is_truncated() => {
                for maps in [within, beyond[gathered.set]] {
                    self.gather_volume_set(maps, (gathered, EventRange::ANY), path, along, context);
                }
            }
            TruncatedMaps::Explicit { beyond } => {
                let most = context.events - path.depth;
                self.gather_volume_set(within, (gathered, EventRange::up_to(most)), path, along, context);
                context.with_truncated_light(1.0, |bias| {
                    self.gather_volume_set(within, (gathered, EventRange::beyond(most)), path, along, bias);
                    self.gather_volume_set(beyond[gathered.set], (gathered, EventRange::ANY), path, along, bias);
                });
            }
        }
    }

    /// Gathers the photons of one set near a segment, `behind_m` (m) along the path.
    fn gather_volume_set<S: Sink>(
        &self,
        maps: &SetMaps,
        (gathered, filter): (VolumeGather<'_, 'a>, impl EventFilter),
        path: &CameraPath,
        (segment, filling, behind_m): (&MediumSegment<'a>, NumberedMedium<'a>, f64),
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let set = gathered.set;
        for class in PhotonClass::ALL {
            let maps = &maps[class].volume;
            let slope = f64::from(context.radii.volume[set][class]);
            // A wide kernel of a thin medium would visit and reject many points of a dense medium,
            // so a segment searches only the photons that its medium stores.
            let (volume, dense) = (self.plan.volume, filling.medium.dense);
            let of_points = (&maps.points, self.scales.points[class], volume.keeps_points(dense));
            let of_beams = (&maps.beams, self.scales.beams[class], volume.keeps_beams(dense));
            for (map, scale, stored) in [of_points, of_beams] {
                if map.is_empty() || !stored {
                    continue;
                }
                let width = match self.explicit_radius_m {
                    Some(radius) => KernelWidth::Constant(radius * scale),
                    None => KernelWidth::PerDistance(slope * scale),
                };
                let cone = QueryCone::of_camera(segment.ray, segment.length_m, behind_m, width);
                self.gather_volume_map((map, &cone), (gathered, filter), path, (segment, filling), context);
            }
        }
    }

    /// Adds the radiance that the photons of one map scatter into the ray.
    fn gather_volume_map<S: Sink>(
        &self,
        (map, cone): (&VolumeMap, &QueryCone),
        (VolumeGather { scatters, luminescence, .. }, filter): (VolumeGather<'_, 'a>, impl EventFilter),
        path: &CameraPath,
        (segment, NumberedMedium { number, medium }): (&MediumSegment<'a>, NumberedMedium<'a>),
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let seed = segment_seed(context, segment.ray.origin);
        let (factors, sink) = (&context.buffers.factors, &mut *context.sink);
        let class = path.events.class_in_medium();
        // The least extinction bounds the transmittance at all wavelengths.
        let extinction = if medium.density == Density::Uniform { medium.extinction_range.0 } else { 0.0 };
        let mut gathered = 0;
        map.along(cone, |photon: PhotonNearRay<'_>| {
            if photon.medium != number || !filter.admits(|| photon.events) {
                return;
            }
            let probability = match photon.beam {
                None if extinction > 0.0 => (POINTS_PER_TRANSMITTANCE * exp(-extinction * photon.t)).min(1.0),
                None | Some(_) => 1.0,
            };
            if probability < 1.0 && unit_interval(seed.part(photon.t.to_bits()).number()) >= probability {
                return;
            }
            gathered += 1;
            let Some(kernels) = kernels_between_faces(self.scene, &segment.ray, &photon) else { return };
            let kernels = kernels.times(probability.recip());
            let to_photon = segment.path_transmittance(photon.t, seed);
            let directions = [photon.incoming, -segment.ray.direction];
            let deflection = Deflection::between(directions[0], directions[1]);
            // A beam stores the power at its start, so its response includes the attenuation up to
            // the camera ray and the scattering coefficient there, which the power of a point
            // already includes. No face is between beam and ray, so both are in the same bodies.
            let along_beam = photon.beam.map(|BeamPath { start, distance_m }| {
                let ray = Ray { origin: start, direction: photon.incoming };
                let beam = MediumSegment { ray, ..*segment };
                let along = beam.path_transmittance(distance_m, seed.part(distance_m.to_bits()));
                (along, medium.density_at(ray.at(distance_m)))
            });
            let excess = |along: &[SegmentTransmittance<'_>]| excess_optical_depth(along, path.reference_nm());
            let of_beam = along_beam.as_ref().map_or(0.0, |(along, _)| excess(along));
            let bias = bias_of_excess(path.excess_depth + excess(&to_photon) + of_beam);
            // The power of a point in a fluorescent medium includes what excites the dye.
            let per_coefficient = |nm| match &along_beam {
                Some((along, density)) => transmittance(along, nm) * density,
                // Rounding of the stored wavelength may lead to a wavelength without events.
                None => Some(medium.stored_coefficient(nm)).filter(|sigma| *sigma > 0.0).map_or(0.0, f64::recip),
            };
            let response = |nm| {
                let scattered = if along_beam.is_none() && medium.fluorophore.is_none() {
                    1.0
                } else {
                    per_coefficient(nm) * medium.scattering.at(nm)
                };
                scattered * medium.phase.eval(deflection, nm) * transmittance(&to_photon, nm)
            };
            if scatters {
                let light = PhotonLight { power: photon.power, spectra: self.spectra, class };
                let mode = (path.spectral_mode, factors);
                if let Some(polarisation) = photon.polarisation {
                    let event = ScatteringEvent::in_medium(&medium.phase, directions[0], directions[1]);
                    let photon = PolarisedPhoton { polarisation, event };
                    add_polarised_photon(light, &photon, kernels, bias, mode, sink, response);
                } else {
                    add_photon(light, kernels, bias, mode, sink, response);
                }
            }
            if let Some(luminescence) = luminescence {
                let mut radiance = [0.0; LANES];
                let lanes = photon.power.lanes(self.spectra);
                lanes.for_each(|(nm, power)| luminescence.excite(nm, power * per_coefficient(nm), &mut radiance));
                luminescence.attenuate(&to_photon, &mut radiance);
                let origin = LightOrigin { class, light: self.spectra.light_of(photon.power.wavelength_code()) };
                luminescence.add(origin, &radiance, (kernels.estimate, biased_by(kernels, bias)), sink);
            }
        });
        context.tally.volume_gathered += gathered;
    }
}

/// Returns the least path length (m) to the start of a segment that kernel radii assume.
///
/// Radii are proportional to the distance from the camera. In the medium, the kernel of a photon
/// point at the distance t would be proportional to 1/t² with infinite variance: the picture would
/// be too dark, apart from rare bright pixels that no error bar foresees.
fn near_m(segment: &MediumSegment<'_>, medium: &Medium) -> f64 {
    let depth_per_m = medium.optical_depth(REFERENCE_NM, 1.0);
    let free_path_m = if depth_per_m > 0.0 { 1.0 / depth_per_m } else { f64::INFINITY };
    (NEAR_FREE_PATHS * free_path_m).min(NEAR_FRACTION * segment.length_m)
}

/// Corrects the kernels of a photon beside faces, unless a face is between it and the ray.
///
/// Camera segments and photon beams end at all faces of surfaces and media, so kernels must too.
/// Otherwise, fog would lose light beside its faces, and light would leak through walls inside the
/// fog.
fn kernels_between_faces(scene: &Scene, ray: &Ray, photon: &PhotonNearRay<'_>) -> Option<KernelValues> {
    let PhotonNearRay { t, offset, radius_m, kernels, beam, .. } = *photon;
    let (centre, distance_m) = (ray.at(t), offset.length());
    let towards = if distance_m > 0.0 { offset / distance_m } else { ray.direction.any_orthonormal_vector() };
    let extent_m = |direction: DVec3| {
        let line = Ray::new(centre, direction);
        [&scene.geometry, &scene.boundaries].into_iter().fold(radius_m, |extent_m, faces| {
            if faces.is_empty() {
                return extent_m;
            }
            faces.intersect(&line, None, extent_m).map_or(extent_m, |hit| hit.t)
        })
    };
    let ahead_m = extent_m(towards);
    if ahead_m < distance_m {
        return None;
    }
    let domain = if beam.is_some() { KernelDomain::Line } else { KernelDomain::Disk };
    Some(kernels.between_faces(domain, [ahead_m, extent_m(-towards)].map(|extent_m| extent_m / radius_m)))
}
