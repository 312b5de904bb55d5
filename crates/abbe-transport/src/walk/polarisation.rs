//! The polarisation that photons and camera paths carry, if the plan contains it.
//!
//! Paths sample directions by the response of surfaces and media to natural light. Each event then
//! multiplies its weight by the factor by which the power of polarised light differs, and changes
//! the polarisation. Photons carry the Stokes vector of their light, and camera paths the Mueller
//! matrix of everything between a point and the camera (Mojzík, Skřivan, Wilkie & Křivánek 2016,
//! "Bi-directional Polarised Light Transport"). Frames are canonical: they follow from the direction
//! of the light, so no path stores one.

use super::crystal::{event_at_crystal, scatter_at_crystal};
use super::scatter_coated::scatter_by_powers;
use super::scattered_ray::ScatteredRay;
use super::surface_interaction::SurfaceInteraction;
use super::transmittance::SegmentTransmittance;
use abbe_optics::bsdf::{Bsdf, BsdfClass, LocalRetardance, PowerFractions, ScatterEvent, TransportMode};
use abbe_polarisation::{
    DiattenuatingRetarder, Mueller, Rotation, ScatteringEvent, Stokes, StokesFrame, SurfaceDirections, smooth_elements,
};
use abbe_scene::camera::Camera;
use abbe_spectra::math::elementary::sin_cos;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{LANES, Lanes, Wavelengths};
use glam::DVec3;

/// The polarisation of a photon: for each wavelength, S1, S2 and S3, divided by the power S0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotonPolarisation(pub [[f32; 3]; LANES]);

impl PhotonPolarisation {
    /// Unpolarised light.
    pub const NATURAL: Self = Self([[0.0; 3]; LANES]);

    /// Returns the Stokes vector of a lane for a power of 1.
    #[inline]
    pub fn stokes(&self, lane: usize) -> Stokes {
        let [q, u, v] = self.0[lane].map(f64::from);
        Stokes([1.0, q, u, v])
    }

    /// Scatters a photon at a smooth surface, selected by the powers of its polarised light. Returns
    /// `None` at all other surfaces.
    pub(crate) fn scatter_at_smooth_surface(
        &self,
        interaction: &SurfaceInteraction<'_>,
        wavelengths: &Wavelengths,
        stream: &mut Stream,
    ) -> Option<Option<ScatteredRay>> {
        let of_lane = |lane: usize| self.stokes(lane);
        let travel = interaction.incoming;
        interaction.scatter_polarised(travel, of_lane, wavelengths, TransportMode::Importance, stream)
    }

    /// Applies an event, and returns the factors of the power at each wavelength.
    pub(crate) fn scatter(&mut self, event: &ScatteringEvent<'_>, wavelengths: &Wavelengths) -> Lanes {
        let mut factors = [0.0; LANES];
        for (k, &nm) in wavelengths.active().iter().enumerate() {
            let Stokes([power, q, u, v]) = event.matrix(nm) * self.stokes(k);
            factors[k] = power.max(0.0);
            self.0[k] = if power > 0.0 { [q, u, v].map(|part| (part / power) as f32) } else { [0.0; 3] };
        }
        factors
    }

    /// Keeps the wavelength of one lane, which becomes the first.
    pub(crate) fn keep_lane(&mut self, lane: usize) {
        self.0[0] = self.0[lane];
    }
}

/// The light of a camera path at each wavelength: the matrix of everything between the end of the
/// path and the camera, divided by its first element.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathMatrices([Mueller; LANES]);

impl PathMatrices {
    pub(crate) const IDENTITY: Self = Self([Mueller::IDENTITY; LANES]);

    /// Scatters a path at a smooth surface, selected by the powers of the light that the camera
    /// would receive. Returns `None` at all other surfaces.
    pub(crate) fn scatter_at_smooth_surface(
        &self,
        interaction: &SurfaceInteraction<'_>,
        wavelengths: &Wavelengths,
        stream: &mut Stream,
    ) -> Option<Option<ScatteredRay>> {
        let of_lane = |lane: usize| Stokes(self.0[lane].0[0]);
        let travel = -interaction.incoming;
        interaction.scatter_polarised(travel, of_lane, wavelengths, TransportMode::Radiance, stream)
    }

    /// Adds an event behind the end of the path, and multiplies the weights by its factors.
    pub(crate) fn precede(&mut self, event: &ScatteringEvent<'_>, wavelengths: &Wavelengths, weights: &mut Lanes) {
        for (k, &nm) in wavelengths.active().iter().enumerate() {
            let matrix = self.0[k] * event.matrix(nm);
            let factor = matrix.0[0][0].max(0.0);
            weights[k] *= factor;
            self.0[k] = if factor > 0.0 { matrix * factor.recip() } else { Mueller::IDENTITY };
        }
    }

    /// Returns what the camera receives of natural light that crosses the panes of a shadow ray and
    /// is scattered into a lane of the path, for a power of 1 without polarisation.
    pub(crate) fn received(
        &self,
        lane: usize,
        event: &ScatteringEvent<'_>,
        along: &[SegmentTransmittance<'_>],
        nm: f64,
    ) -> Stokes {
        let light = pane_matrix(along, nm) * Stokes::unpolarised(1.0);
        self.0[lane] * (event.matrix(nm) * light)
    }

    /// Returns what the camera receives of natural light at the end of the path.
    pub(crate) fn of_natural_light(&self, lane: usize) -> Stokes {
        self.0[lane] * Stokes::unpolarised(1.0)
    }

    /// Keeps the wavelength of one lane, which becomes the first.
    pub(crate) fn keep_lane(&mut self, lane: usize) {
        self.0[0] = self.0[lane];
    }
}

/// Returns the relative matrix of the panes on a straight line, listed from the receiver on.
#[inline(never)]
pub(crate) fn pane_matrix(along: &[SegmentTransmittance<'_>], nm: f64) -> Mueller {
    along.iter().fold(Mueller::IDENTITY, |matrix, segment| match segment {
        SegmentTransmittance::Pane { pane, outside, polarising: Some(polarising), .. } => {
            matrix * polarising.event(pane, outside).matrix(nm)
        }
        SegmentTransmittance::Pane { polarising: None, .. }
        | SegmentTransmittance::Clear { .. }
        | SegmentTransmittance::Column { .. }
        | SegmentTransmittance::Tracked { .. } => matrix,
    })
}

/// Returns the rotation from the canonical frame of light that arrives along `travel` to the frame of
/// the picture, whose x axis is the right side.
pub(crate) fn rotation_to_picture(camera: &Camera, travel: DVec3) -> Rotation {
    let right = camera.right();
    let x = (right - right.dot(travel) * travel).normalize_or(right);
    StokesFrame::canonical(travel).rotation_to(x)
}

/// Returns the event at the filter of the camera for light that arrives along `travel`, or `None`
/// without a filter.
pub(crate) fn event_at_camera_filter(camera: &Camera, travel: DVec3) -> Option<ScatteringEvent<'_>> {
    let filter = camera.filter.as_deref()?;
    // Angles appear in the picture as in the file, and the first layer faces the scene.
    Some(ScatteringEvent::at_filter(
        (filter, LocalRetardance::WHOLE),
        travel,
        [-camera.forward(), camera.right()],
        true,
    ))
}

impl<'a> SurfaceInteraction<'a> {
    /// Returns the fractions of natural light and of polarised light that a smooth surface reflects
    /// and transmits at the wavelength `nm`, or `None` at all other surfaces. `light` is the Stokes
    /// vector for a power of 1 of the light that arrives along `travel`, or the response of the
    /// camera to light that leaves along it.
    pub(crate) fn smooth_powers(&self, travel: DVec3, light: Stokes, nm: f64) -> Option<[PowerFractions; 2]> {
        let selects = match self.bsdf.model {
            Bsdf::Dielectric(_) | Bsdf::CoatedDielectric(_) => self.bsdf.class() == BsdfClass::Specular,
            Bsdf::ThinDielectric(_) | Bsdf::ThinFilm(_) => true,
            Bsdf::Absorber | Bsdf::Diffuse(_) | Bsdf::Fluorescent(_) | Bsdf::Translucent(_) | Bsdf::Mirror(_) => false,
            Bsdf::Conductor(_) | Bsdf::Crystal(_) | Bsdf::Grating(_) | Bsdf::Glossy(_) | Bsdf::Mix(_) => false,
        };
        if !selects {
            return None;
        }
        let [reflected, transmitted] = smooth_elements(self.bsdf, self.wo, self.sides, nm)?;
        let s_axis = StokesFrame::perpendicular(travel, self.frame.normal()).x;
        let Stokes([_, excess, ..]) = StokesFrame::canonical(travel).rotation_to(s_axis) * light;
        let powers = |excess: f64| {
            let of = |element: &DiattenuatingRetarder| {
                0.5 * ((1.0 + excess) * element.s + (1.0 - excess) * element.p).max(0.0)
            };
            PowerFractions { reflected: of(&reflected), transmitted: of(&transmitted) }
        };
        Some([powers(0.0), powers(excess)])
    }

    /// See [`PhotonPolarisation::scatter_at_smooth_surface`].
    #[inline(never)]
    fn scatter_polarised(
        &self,
        travel: DVec3,
        of_lane: impl Fn(usize) -> Stokes,
        wavelengths: &Wavelengths,
        transport: TransportMode,
        stream: &mut Stream,
    ) -> Option<Option<ScatteredRay>> {
        if self.bsdf.model.crystal().is_some() {
            return Some(scatter_at_crystal(self, wavelengths, transport, of_lane, stream));
        }
        self.smooth_powers(travel, of_lane(0), wavelengths.hero())?;
        let nothing = [PowerFractions { reflected: 0.0, transmitted: 0.0 }; 2];
        Some(scatter_by_powers(self, wavelengths, transport, stream, |lane, nm| {
            self.smooth_powers(travel, of_lane(lane), nm).unwrap_or(nothing)
        }))
    }

    /// Returns what this point does to the polarisation of a photon or of the light of a camera
    /// path, which scatters as `scattered` says.
    pub(crate) fn event_of(
        &self,
        scattered: &ScatteredRay,
        wavelengths: &Wavelengths,
        transport: TransportMode,
    ) -> ScatteringEvent<'a> {
        if self.bsdf.model.crystal().is_some() {
            let nm = wavelengths.nm[scattered.kept.unwrap_or(0)];
            return event_at_crystal(self, scattered.wave, transport, nm);
        }
        match transport {
            TransportMode::Importance => self.event_of_photon(scattered.direction, scattered.delta),
            TransportMode::Radiance => self.event_of_camera(scattered.direction, scattered.delta),
        }
    }

    /// Returns what this point does to the polarisation of a photon that continues in `direction`.
    pub(crate) fn event_of_photon(&self, direction: DVec3, delta: bool) -> ScatteringEvent<'a> {
        self.scattering_event(direction, [-self.incoming, direction], delta)
    }

    /// Returns what this point does to the polarisation of light from `direction` on a camera path.
    pub(crate) fn event_of_camera(&self, direction: DVec3, delta: bool) -> ScatteringEvent<'a> {
        self.scattering_event(direction, [direction, -self.incoming], delta)
    }

    fn scattering_event(
        &self,
        direction: DVec3,
        [to_source, to_receiver]: [DVec3; 2],
        delta: bool,
    ) -> ScatteringEvent<'a> {
        let event = if self.leads_back(direction) { ScatterEvent::Reflection } else { ScatterEvent::Transmission };
        let (sin, cos) = sin_cos(f64::from(self.bsdf.texels.axis_angle));
        let axes = self.frame.axes();
        let (normal, u) = (self.frame.normal(), axes.to_world(DVec3::new(cos, sin, 0.0)));
        let directions = SurfaceDirections { to_source, to_receiver, normal, u };
        let wi = self.frame.to_local(direction);
        ScatteringEvent::at_surface((self.bsdf, self.sides), (self.wo, wi), (event, delta), &directions)
    }
}
