//! The gather point: a point of a camera path on a surface, and the photons around this point.

use super::photon_light::{PhotonLight, add_photon, biased_by};
use super::responses::SurfaceResponses;
use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::{PathFactors, SpectralMode};
use crate::gather::luminescence::Luminescence;
use crate::gather::polarised::{PolarisedPhoton, add_polarised_photon};
use crate::map::kernel::{BoundaryCorrection, DiskKernel, KernelValues};
use crate::map::{NearbyPhoton, PhotonSpectra, StoredPolarisation};
use crate::plan::{LightOrigin, PathClass};
use crate::walk::{CausticWeights, SensorResponse, Sink, SurfaceInteraction, bias_of_excess};
use abbe_optics::bsdf::{BsdfClass, InterfaceIors, LocalBsdf, TransportMode};
use abbe_scene::geometry::ShadingFrame;
use abbe_spectra::spectrum::LANES;
use glam::{DVec3, Vec3};

/// The least cosine between the normals at the gather point and at a photon. Below it, the photon
/// is on another surface and is ignored.
pub const NORMAL_TOLERANCE: f64 = 0.7;

/// Photons farther from the tangent plane, as a fraction of the kernel radius, are ignored.
pub const PLANE_TOLERANCE: f64 = 0.3;

/// A gather point without its photons.
///
/// The cosine of the incident direction is computed with the surface normal at the photon: on a
/// curved surface, the normal at the gather point would give a wrong cosine, and some light at
/// grazing angles would seem to come from below. If the shading normal n_s is interpolated, it
/// differs from the geometric normal n_g. The flux of the photon arrived through the geometric
/// surface, but the BSDF is defined for the shading normal, so the power is multiplied by |ω·n_s| /
/// |ω·n_g| for the incident direction ω (Veach 1997, section 5.3).
pub(in crate::gather) struct GatherPoint<'e> {
    bsdf: LocalBsdf<'e>,
    sides: InterfaceIors<'e>,
    frame: ShadingFrame,
    wo: DVec3,
    position: DVec3,
    normal: DVec3,
    facing: DVec3,
    /// Photons count only up to this distance (m) from the tangent plane.
    height_m: f64,
    kernel: DiskKernel,
    spectral_mode: SpectralMode,
    factors: &'e PathFactors<'e>,
    /// The weights of caustic photons, if they compete with camera paths.
    weights: Option<CausticWeights>,
    reference_nm: f64,
    /// The relative bias of the path's throughput.
    bias: f64,
    /// True if photons on the other side of the surface contribute too.
    transmits: bool,
}

impl<'e> GatherPoint<'e> {
    /// Creates the gather point at the end of a path. `radius` is the kernel radius in m.
    #[inline(always)]
    pub(in crate::gather) fn new(
        interaction: &SurfaceInteraction<'e>,
        radius: f64,
        correction: BoundaryCorrection,
        path: &CameraPath,
        factors: &'e PathFactors<'e>,
    ) -> Self {
        let normal = interaction.hit.normal;
        Self {
            bsdf: interaction.bsdf,
            sides: interaction.sides,
            frame: interaction.frame,
            wo: interaction.wo,
            position: interaction.hit.position,
            normal,
            facing: if interaction.leads_back(normal) { normal } else { -normal },
            height_m: PLANE_TOLERANCE * radius,
            kernel: DiskKernel::new(radius * radius).corrected(correction),
            spectral_mode: path.spectral_mode,
            factors,
            weights: None,
            reference_nm: path.reference_nm(),
            bias: bias_of_excess(path.excess_depth),
            transmits: interaction.bsdf.is_transmissive(),
        }
    }

    #[inline(always)]
    pub(in crate::gather) fn competing_by(self, weights: Option<CausticWeights>) -> Self {
        Self { weights, ..self }
    }

    /// Returns the side to which a photon contributes, 1 for the visible side and −1 for the other,
    /// or `None` if it belongs to another surface. The photon's `normal` may have any length.
    #[inline(always)]
    fn side_of(&self, normal: DVec3, position: [f32; 3]) -> Option<f64> {
        let alignment = normal.dot(self.facing);
        let side = if self.transmits { alignment.signum() } else { 1.0 };
        let offset = Vec3::from(position).as_dvec3() - self.position;
        let aligned = alignment * side > 0.0
            && alignment * alignment >= NORMAL_TOLERANCE * NORMAL_TOLERANCE * normal.length_squared();
        (aligned && offset.dot(self.normal).abs() <= self.height_m).then_some(side)
    }

    #[inline(always)]
    pub(in crate::gather) fn add<S: Sink>(
        &self,
        nearby: &NearbyPhoton<'_>,
        spectra: &PhotonSpectra,
        class: PathClass,
        sink: &mut S,
    ) {
        let Some((wi, kernels)) = self.locate(nearby) else { return };
        let light = PhotonLight { power: &nearby.photon.power, spectra, class };
        let response = |nm: f64| self.bsdf.eval(self.wo, wi, self.sides, TransportMode::Radiance, nm);
        add_photon(light, kernels, self.bias, (self.spectral_mode, self.factors), sink, response);
    }

    /// Like [`Self::add`], adds a photon with its polarisation.
    pub(in crate::gather) fn add_polarised<S: Sink>(
        &self,
        nearby: &NearbyPhoton<'_>,
        polarisation: &StoredPolarisation,
        interaction: &SurfaceInteraction<'_>,
        (spectra, class): (&PhotonSpectra, PathClass),
        sink: &mut S,
    ) {
        let Some((wi, kernels)) = self.locate(nearby) else { return };
        let light = PhotonLight { power: &nearby.photon.power, spectra, class };
        let event = interaction.event_of_camera(nearby.photon.to_light(), false);
        let photon = PolarisedPhoton { polarisation, event };
        let response = |nm: f64| self.bsdf.eval(self.wo, wi, self.sides, TransportMode::Radiance, nm);
        add_polarised_photon(light, &photon, kernels, self.bias, (self.spectral_mode, self.factors), sink, response);
    }

    /// Returns the local direction of a photon's light and its kernels, or `None` if the photon
    /// belongs to another surface.
    #[inline(always)]
    fn locate(&self, nearby: &NearbyPhoton<'_>) -> Option<(DVec3, KernelValues)> {
        let photon = nearby.photon;
        let photon_normal = photon.normal();
        let side = self.side_of(photon_normal, nearby.position)?;
        let to_light = photon.to_light();
        let kernels = self.kernel.at(f64::from(nearby.distance2));
        // On a curved surface, the normal at the photon differs from that at the gather point.
        let own_cosine = to_light.dot(photon_normal) * side;
        let (wi, kernels) = if self.frame.is_folded() {
            self.with_kernels_of_interpolated(kernels, to_light, own_cosine)
        } else {
            (self.frame.to_local(self.turned(to_light, own_cosine)), kernels)
        };
        let kernels = match self.weights {
            None => kernels,
            Some(weights) => {
                let pdf = self.bsdf.pdf(self.wo, wi, self.sides, self.reference_nm);
                kernels.times(weights.of_photon(photon.ray_density(), pdf))
            }
        };
        Some((wi, kernels))
    }

    /// Returns true if the light that the path gathers depends on the polarisation of photons.
    #[inline(always)]
    pub(in crate::gather) fn depends_on_polarisation(&self) -> bool {
        self.factors.depends_on_polarisation() || self.bsdf.class() == BsdfClass::Glossy
    }

    /// Turns a direction so that its cosine with the own normal is that at the photon's surface.
    #[inline(always)]
    fn turned(&self, to_light: DVec3, own_cosine: f64) -> DVec3 {
        (to_light + (own_cosine - to_light.dot(self.facing)) * self.facing).normalize()
    }

    /// Returns the direction to the light in the shading frame, and the kernels corrected for a
    /// shading normal that differs from the geometric normal.
    #[inline(always)]
    fn with_kernels_of_interpolated(
        &self,
        kernels: KernelValues,
        to_light: DVec3,
        own_cosine: f64,
    ) -> (DVec3, KernelValues) {
        let is_own_side = to_light.dot(self.facing) * own_cosine > 0.0;
        let wi = self.frame.to_local(if is_own_side { to_light } else { self.turned(to_light, own_cosine) });
        (wi, kernels.times(if own_cosine == 0.0 { 0.0 } else { (wi.z / own_cosine).abs() }))
    }

    /// Adds the emission that a nearby photon excites. The photon must be a free photon.
    #[inline(always)]
    pub(in crate::gather) fn add_excitation<S: Sink>(
        &self,
        nearby: &NearbyPhoton<'_>,
        spectra: &PhotonSpectra,
        class: PathClass,
        luminescence: &Luminescence<'_>,
        sink: &mut S,
    ) {
        let photon = nearby.photon;
        let normal = photon.normal();
        let Some(side) = self.side_of(normal, nearby.position) else { return };
        let mut kernels = self.kernel.at(f64::from(nearby.distance2));
        if self.frame.is_folded() {
            let to_light = photon.to_light();
            (_, kernels) = self.with_kernels_of_interpolated(kernels, to_light, side * to_light.dot(normal));
        }
        let mut radiance = [0.0; LANES];
        photon.power.lanes(spectra).for_each(|(nm, power)| luminescence.excite(nm, power, &mut radiance));
        let origin = LightOrigin { class, light: spectra.light_of(photon.power.wavelength_code()) };
        luminescence.add(origin, &radiance, (kernels.estimate, biased_by(kernels, self.bias)), sink);
    }

    /// Returns true if the responses of the sensor are independent of the camera path and of the
    /// directions of the photons, on a diffuse surface whose normal is not interpolated.
    #[inline(always)]
    pub(in crate::gather) fn is_plain(&self) -> bool {
        self.spectral_mode == SpectralMode::Free && self.factors.natural.is_empty() && self.factors.events.is_empty()
    }

    /// Like [`Self::add`], adds a photon to the responses of the sensor, and returns that to its
    /// radiance. At a diffuse surface, photons arrive on the side of their normal, so their
    /// directions have no influence.
    #[inline(always)]
    pub(in crate::gather) fn add_response(
        &self,
        nearby: &NearbyPhoton<'_>,
        surface: SurfaceResponses<'_>,
        sums: &mut ResponseSums,
    ) -> Option<SensorResponse> {
        self.side_of(nearby.photon.normal_direction(), nearby.position)?;
        let response = surface.of_photon(&nearby.photon.power);
        let kernels = self.kernel.at(f64::from(nearby.distance2));
        sums.estimate.add_scaled(response, kernels.estimate);
        sums.bias.add_scaled(response, biased_by(kernels, self.bias));
        Some(SensorResponse(response).scaled(kernels.estimate))
    }
}

/// The sums of the responses to all photons around a gather point.
#[derive(Debug, Default)]
pub(in crate::gather) struct ResponseSums {
    pub(in crate::gather) estimate: SensorResponse,
    pub(in crate::gather) bias: SensorResponse,
}
